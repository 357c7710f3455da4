"""Texts of distributed inputs: what is read, central values, and study files that contain them."""

from __future__ import annotations

from pathlib import Path

import pytest

from law_studies import interface_text, write_masses, write_study
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.case.load import load_case, load_case_and_positions
from stickslip.case.scatter_text import central_sentences, scatter_text
from stickslip.core.errors import InputError, StickslipWarning, StudyFileError

FILE = """\
[study]
title = "Lots 1 .. 3 | of +- 0.1"
[friction]
coefficient = "0.3 +- 0.1"
[preload]
centrifugal_force = "400 N .. 0.6 kN"
[excitation]
mode = "same | single"
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "form", "parts", "centre"),
    [
        ("0.3 +- 0.1", "normal", ("0.3", "0.1"), "0.3"),
        ("500 ± 20 N", "normal", ("500 N", "20 N"), "500 N"),
        ("500 N +- 5 %", "normal", ("500 N", "5 %"), "500 N"),
        ("lognormal 500 N */ 1.3", "lognormal", ("500 N", "1.3"), "500 N"),
        ("0.2..0.4", "uniform", ("0.2", "0.4"), "0.3"),
        ("1 mm .. 2 cm", "uniform", ("1 mm", "2 cm"), "10.5 mm"),
        ("1e-10 m .. 1e-8 m log", "loguniform", ("1e-10 m", "1e-8 m"), "1e-09 m"),
        ("0.2 | 0.3|0.35", "listed", ("0.2", "0.3", "0.35"), "0.2"),
        ("single | same", "listed", ("single", "same"), "single"),
    ],
)
def test_forms_and_central_values(text: str, form: str, parts: tuple[str, ...], centre: str) -> None:
    scatter = scatter_text(text)
    assert scatter is not None
    assert (scatter.form, scatter.parts, scatter.centre) == (form, parts, centre)


@pytest.mark.parametrize("text", ["0.3", "500 N", "single", "1e-7 s", "-0.3"])
def test_plain_values_are_no_distributions(text: str) -> None:
    assert scatter_text(text) is None


@pytest.mark.parametrize(
    "text",
    [
        "0.3 +-",
        "+- 0.1",
        "0.3 +- x",
        "1 ... 2",
        "lognormal 0.3",
        "lognormal 0.3 */ 1.5 mm",
        "a |",
        "1 N .. ",
        "0.1 .. nan",
    ],
)
def test_incomplete_texts_are_rejected(text: str) -> None:
    with rejects(InputError):
        scatter_text(text)


def test_a_file_has_central_values_and_says_so(tmp_path: Path) -> None:
    case, places = load_case_and_positions(written(tmp_path, FILE))
    assert case == Case().replace(
        {
            "study.title": "Lots 1 .. 3 | of +- 0.1",
            "friction.coefficient": 0.3,
            "preload.centrifugal_force": 500,
            "excitation.mode": "same",
        }
    )
    assert places.scattered == {
        "friction.coefficient": "0.3 +- 0.1",
        "preload.centrifugal_force": "400 N .. 0.6 kN",
        "excitation.mode": "same | single",
    }
    for key, sentence in zip(places.scattered, central_sentences(places.scattered), strict=True):
        printed_sentence(sentence, key)
    with pytest.warns(StickslipWarning) as caught:
        assert load_case(tmp_path / "study.toml") == case
    assert tuple(str(each.message) for each in caught) == central_sentences(places.scattered)


def test_constants_of_a_law_may_be_distributed(tmp_path: Path) -> None:
    write_masses(tmp_path)
    path = write_study(tmp_path, interface_text("joint", "jenkins").replace('"1.5 N"', '"1.5 N +- 0.2 N"'))
    case, places = load_case_and_positions(path)
    assert case.sections["interfaces"]["joint"].constants.values["friction_limit"] == 1.5
    assert places.scattered == {"interfaces.joint.constants.friction_limit": "1.5 N +- 0.2 N"}


@pytest.mark.parametrize("line", ['coefficient = "0.3 +- "', 'coefficient = "20 .. 40"', 'coefficient = "1 mm .. 2 s"'])
def test_a_wrong_distribution_in_a_file_has_its_line(tmp_path: Path, line: str) -> None:
    with rejects(StudyFileError, "friction.coefficient"):
        load_case_and_positions(written(tmp_path, f"[friction]\n{line}\n"))
