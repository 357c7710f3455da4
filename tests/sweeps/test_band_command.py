"""``stickslip band``: exit codes, sentences, files; other commands use the central values of the same file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from band_cases import DAMPING, FORCE, linear_study
from sentences import printed_sentence
from stickslip.cli import main as cli

SAMPLES = ("--samples", 8, "--workers", 1)


def invoke(command: str, *arguments: object) -> Any:
    """Run the command line in this process."""
    return CliRunner().invoke(cli.app, [command, *(str(each) for each in arguments)])


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = linear_study(tmp_path)
    text = path.read_text(encoding="utf-8").replace('"2 mN"', '"1 mN .. 3 mN"')
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.long
def test_files_and_exit_code_of_a_band_that_worked(study: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    options = ("--scatter", f"{DAMPING}=1 % .. 3 %", "--limit", "peak_amplitude < 3 um", "--out", out, *SAMPLES)
    result = invoke("band", study, *options)
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("The highest peak is ")
    assert "".join(f"Wrote {out / name}\n" for name in ("band.csv", "band.nc", "band.html")) in result.stdout
    printed_sentence(result.stdout, "8 samples", numbers=False)
    assert "Note: " not in result.stderr
    header = (out / "band.csv").read_text(encoding="utf-8").split(",")
    assert header[1:3] == [FORCE, DAMPING]
    again = invoke("band", study, *options, "--quiet")
    assert (again.exit_code, again.stdout, again.stderr) == (0, "", "")


def test_other_commands_use_the_central_value_and_say_so(study: Path) -> None:
    result = invoke("check", study)
    assert result.exit_code == 0, result.output
    notes = [line for line in result.stderr.splitlines() if line.startswith("Note: ")]
    assert len(notes) == 1
    printed_sentence(notes[0], FORCE)
    assert "0.002 N" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        (("--scatter", DAMPING), "--scatter"),
        (("--scatter", f"{DAMPING}=1 % .. 2 %", "--scatter", f"{DAMPING}=1 % .. 3 %"), DAMPING),
        (("--scatter", f"{DAMPING}=1 % +- 1 %"), DAMPING),
        (("--scatter", f"{FORCE}=2 mN"), FORCE),
        (("--limit", "stress < 1 MPa"), "stress"),
        (("--samples", "30000"), "samples"),
        (("--workers", "2", "--scheduler", "tcp://h:1"), "--workers"),
    ],
)
def test_wrong_input_is_exit_2_without_results(study: Path, arguments: tuple[str, ...], key: str) -> None:
    out = study.parent / "out"
    result = invoke("band", study, *arguments, "--out", out, "--quiet")
    assert result.exit_code == 2
    printed_sentence(" ".join(result.stderr.split()), key)
    assert "Traceback" not in result.stderr
    assert not out.exists()


def test_a_file_without_distributions_needs_the_option(tmp_path: Path) -> None:
    result = invoke("band", linear_study(tmp_path), "--out", tmp_path / "out", "--quiet")
    assert result.exit_code == 2
    printed_sentence(" ".join(result.stderr.split()))


def test_a_distribution_of_the_file_that_is_not_allowed_has_its_line(study: Path) -> None:
    text = study.read_text(encoding="utf-8").replace("1 mN .. 3 mN", "2 mN +- 1 mN")
    study.write_text(text, encoding="utf-8")
    result = invoke("band", study, "--out", study.parent / "out", "--quiet")
    assert result.exit_code == 2
    line = text.splitlines().index('amplitude = "2 mN +- 1 mN"') + 1
    printed_sentence(" ".join(result.stderr.split()), f"line {line}: {FORCE}")
