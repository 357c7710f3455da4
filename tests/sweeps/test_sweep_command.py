"""``stickslip sweep``: exit codes, sentences, and what is printed where."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from own_cases import mesh_case
from sentences import printed_sentence
from stickslip.cli import main as cli
from stickslip.cli import many_cases
from stickslip.sweeps import work
from sweep_cases import quick_case, quick_file

LOAD = "preload.centrifugal_force"


def invoke(*arguments: object) -> Any:
    """Run the command line in this process."""
    return CliRunner().invoke(cli.app, ["sweep", *(str(each) for each in arguments)])


@pytest.mark.long
def test_files_and_exit_code_of_a_sweep_that_worked(tmp_path: Path) -> None:
    file, out = quick_file(tmp_path), tmp_path / "out"
    arguments = (file, "--vary", f"{LOAD}=600 N,650", "--out", out, "--workers", 1)
    result = invoke(*arguments)
    assert result.exit_code == 0, result.stderr
    written = "".join(f"Wrote {out / name}\n" for name in ("sweep.csv", "sweep.nc", "sweep.html"))
    assert result.stdout.startswith(written)
    printed_sentence(result.stdout[len(written) :], LOAD)
    assert "Cases: 2 of 2" in result.stderr
    again = invoke(*arguments, "--quiet")
    assert (again.exit_code, again.stdout, again.stderr) == (0, "", "")
    printed_sentence(invoke(*arguments).stdout[len(written) :], "2 of them")


@pytest.mark.long
def test_failed_cases_are_exit_3_with_the_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, out = quick_file(tmp_path), tmp_path / "out"
    rough = "roughness.fractal_dimension=2.4,2.001"
    result = invoke(file, "--vary", rough, "--out", out, "--workers", 1, "--quiet")
    assert result.exit_code == 3
    assert result.stdout == ""
    printed_sentence(result.stderr, "fractal_dimension-2.001_", str(out / "sweep.csv"))
    assert (out / "sweep.csv").read_text(encoding="utf-8").count("\n") == 3
    monkeypatch.setattr(many_cases, "SHOWN_FAILURES", 0)
    monkeypatch.setattr(work, "solve", None)  # nothing is solved again
    printed_sentence(invoke(file, "--vary", rough, "--out", out, "--workers", 1, "--quiet").stderr)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        (("--vary", LOAD), "--vary"),
        (("--vary", f"{LOAD}=1", "--vary", f"{LOAD}=2"), LOAD),
        (("--vary", f"{LOAD}=-1"), LOAD),
        (("--vary", "solver.samples=1000,2"), "solver.samples"),
        (("--vary", "solver.largest_step=1e-3"), "solver.largest_step"),
        (("--vary", f"{LOAD}=5", "--workers", "2", "--scheduler", "tcp://h:1"), "--workers"),
        (("--vary", f"{LOAD}=5", "--workers", "0"), "--workers"),
        ((), "--vary"),
    ],
)
def test_wrong_input_is_exit_2_without_results(tmp_path: Path, arguments: tuple[str, ...], key: str) -> None:
    out = tmp_path / "out"
    result = invoke(quick_file(tmp_path), *arguments, "--out", out)
    assert result.exit_code == 2
    printed = " ".join(result.stderr.split())
    assert key in printed
    if printed.startswith("Error: "):  # the other sentences are those of the package that reads the command line
        printed_sentence(printed)
    assert "Traceback" not in result.stderr
    assert not list(out.glob("*"))


def test_a_sweep_none_of_whose_cases_can_be_solved_is_wrong_input(tmp_path: Path) -> None:
    result = invoke(quick_file(tmp_path), "--vary", "geometry.damper_length=40 mm,50 mm", "--out", tmp_path / "out")
    assert result.exit_code == 2
    printed_sentence(result.stderr, "damper_length")


@pytest.mark.slow
@pytest.mark.parametrize("missing", ["interfaces.sole.second", "interfaces.lid.first"])
def test_a_set_that_the_mesh_lacks_ends_the_sweep_before_the_first_case(tmp_path: Path, missing: str) -> None:
    file = tmp_path / "study.toml"
    file.write_text(mesh_case().replace({missing: "nowhere"}).to_text(), encoding="utf-8")
    out = tmp_path / "out"
    result = invoke(file, "--vary", "forces.push.amplitude=0.1 N,0.2 N", "--out", out)
    assert result.exit_code == 2
    printed_sentence(result.stderr.rpartition("Error: ")[2], "nowhere")
    assert list(out.glob("*")) == []


def test_a_folder_that_cannot_be_made_is_reported(tmp_path: Path) -> None:
    file = quick_file(tmp_path)
    result = invoke(file, "--vary", f"{LOAD}=600", "--out", file / "out")
    assert result.exit_code == 2
    printed_sentence(result.stderr, str(file / "out"))
    assert quick_case().to_text() == file.read_text(encoding="utf-8")
