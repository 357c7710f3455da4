"""``stickslip design``: exit codes, sentences, files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from design_cases import LIMIT, FakeSolver, closed_form, jenkins_file
from sentences import printed_sentence
from stickslip.cli import main as cli
from stickslip.sweeps import design as designs
from stickslip.sweeps import design_cases
from sweep_cases import quick_file

FEW = ("--samples", 3, "--starts", 2, "--workers", 1)


def invoke(*arguments: object) -> Any:
    """Run the command line in this process."""
    return CliRunner().invoke(cli.app, ["design", *(str(each) for each in arguments)])


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(design_cases, "solve_design", FakeSolver(closed_form))
    return jenkins_file(tmp_path)


@pytest.mark.slow
def test_files_and_exit_code_of_a_design_that_worked(study: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    options = ("--over", f"{LIMIT}=2 N:15 N", "--subject-to", "peak_frequency > 17 Hz", "--out", out, *FEW)
    result = invoke(study, *options)
    assert result.exit_code == 0, result.output
    names = ("design.csv", "optimum.toml", "design.html")
    assert result.stdout.startswith("".join(f"Wrote {out / name}\n" for name in names))
    assert f"  {LIMIT}  3.0" in result.stdout
    assert "Highest peak" in result.stdout
    assert "There was one start only" in result.stdout
    again = invoke(study, *options, "--quiet")
    assert (again.exit_code, again.stdout) == (0, "")


@pytest.mark.long
def test_limits_without_a_design_are_exit_3(study: Path, tmp_path: Path) -> None:
    limit = ("--subject-to", "peak < 1 um")
    result = invoke(study, "--over", f"{LIMIT}=2 N:15 N", *limit, "--out", tmp_path / "out", *FEW)
    assert result.exit_code == 3
    assert (tmp_path / "out" / "design.html").exists()
    printed_sentence(result.stderr.splitlines()[-1], LIMIT, numbers=False)


def test_a_design_without_any_result_is_exit_3_and_has_its_files(
    study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(design_cases, "solve_design", FakeSolver(lambda limit: []))
    result = invoke(study, "--over", f"{LIMIT}=2 N:15 N", "--out", tmp_path / "out", *FEW)
    assert result.exit_code == 3
    assert [f"Wrote {tmp_path / 'out' / name}" in result.stdout for name in ("design.csv", "design.html")] == [True] * 2
    printed_sentence(result.stderr.splitlines()[-1])


@pytest.mark.slow
def test_a_range_in_which_the_damper_locks_is_named_before_anything_is_solved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none_solved(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(designs, "design", none_solved)
    over = ("--over", "geometry.platform_angle=15deg:60deg", "--over", "friction.coefficient=0.2:0.8")
    result = invoke(quick_file(tmp_path), *over, "--out", tmp_path / "out", *FEW)
    (note,) = (line for line in result.stderr.splitlines() if line.startswith("Note: Friction locks"))
    printed_sentence(note)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        (("--over", LIMIT), "--over"),
        (("--over", f"{LIMIT}=2 N"), LIMIT),
        (("--over", f"{LIMIT}=5 N:2 N"), LIMIT),
        (("--over", f"{LIMIT}=-5 N:2 N"), LIMIT),
        (("--over", "friction.coeficient=0.1:0.2"), "friction.coefficient"),
        (("--over", f"{LIMIT}=2 N:3 N", "--minimise", "mass"), "minimise"),
        (("--over", f"{LIMIT}=2 N:3 N", "--subject-to", "stress < 1 MPa"), "stress"),
        (("--over", f"{LIMIT}=2 N:3 N", "--worst-of", "forces.push.amplitude"), "--worst-of"),
        (("--over", f"{LIMIT}=2 N:3 N", "--workers", "2", "--scheduler", "tcp://h:1"), "--workers"),
    ],
)
def test_wrong_input_is_exit_2_without_results(study: Path, arguments: tuple[str, ...], key: str) -> None:
    out = study.parent / "out"
    result = invoke(study, *arguments, "--out", out, "--quiet")
    assert result.exit_code == 2
    printed_sentence(" ".join(result.stderr.split()), key)
    assert "Traceback" not in result.stderr
    assert not out.exists()
