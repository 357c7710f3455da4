"""Natural frequencies from elsewhere in a study file: what reads, what is rejected, and words of earlier versions."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.case.reference import MODE_COUNT
from stickslip.cli.main import app
from stickslip.core.errors import StudyFileError

GIVEN = '[reference]\nmode_frequencies = ["0.412 kHz", 0, 530.5]\nsource = "modal test"\n'


def test_frequencies_read_in_si_and_come_back() -> None:
    case = Case.from_text(GIVEN)
    assert case.reference is not None
    assert case.reference.mode_frequencies == (412.0, 0.0, 530.5)
    assert Case.from_text(case.to_text()) == case
    assert Case.from_mapping(case.to_dict()) == case


def test_a_new_study_file_has_none_and_shows_how_to_give_them() -> None:
    text = Case().to_text()
    assert "\n# [reference]\n" in text
    lines = text[text.index("# [reference]") :].splitlines()
    section = [line for line in lines if line.startswith(("# [ref", "# mode_frequencies =", "# source ="))]
    assert Case().reference is None
    assert Case.from_text("\n".join(line.removeprefix("# ") for line in section)).reference is not None


WRONG = {
    "too many": ("mode_frequencies", f"[{', '.join(['500'] * (MODE_COUNT + 1))}]"),
    "none": ("mode_frequencies", "[]"),
    "all zero": ("mode_frequencies", "[0, 0]"),
    "a length": ("mode_frequencies", '["412 mm"]'),
    "negative": ("mode_frequencies", "[412, -530]"),
    "one number": ("mode_frequencies", "412"),
    "no source": ("source", '" "'),
}


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG.keys())
def test_wrong_values_get_a_sentence_with_their_key(wrong: tuple[str, str]) -> None:
    key, value = wrong
    lines = [f"{key} = {value}" if line.startswith(key) else line for line in GIVEN.splitlines()]
    with rejects(StudyFileError, f"reference.{key}"):
        Case.from_text("\n".join(lines))


def test_a_reference_without_source_ends_the_command_before_anything_runs(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text('[reference]\nmode_frequencies = ["412 Hz"]\n', encoding="utf-8")
    result = CliRunner().invoke(app, ["run", str(path), "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    printed_sentence(result.stderr, "reference.source")
    assert not (tmp_path / "out").exists()
