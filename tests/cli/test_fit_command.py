"""The command ``stickslip fit``: what it prints and writes, and what it rejects."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from sentences import printed_sentence
from stickslip.cli.main import app
from stickslip.contact.law.loop_fit import loop_force

HEAD = "displacement [mm], force [kN]"


def invoke(*arguments: object) -> Any:
    return CliRunner().invoke(app, ["fit", *map(str, arguments)])


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Three cycles of 1 mm: 2e6 N/m, 500 N, 0.3 mm of backlash."""
    along = 1e-3 * np.sin(2.0 * np.pi * np.arange(5 * 200) / 200.0)
    force = loop_force(along, 2e6, 500.0, 3e-4)
    return write(tmp_path, along[400:], force[400:])


def write(folder: Path, along: np.ndarray, force: np.ndarray, head: str = HEAD) -> Path:
    path = folder / "loops.csv"
    lines = [f"{1e3 * x!r}, {1e-3 * f!r}" for x, f in zip(along.tolist(), force.tolist(), strict=True)]
    path.write_text("\n".join(["# of a test rig", head, *lines]), encoding="utf-8")
    return path


@pytest.mark.slow
def test_prints_constants_energy_and_lines_of_a_study_file(file: Path, tmp_path: Path) -> None:
    result = invoke(file, "--normal-load", "1 kN", "--predict", "1.5 kN", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    values = dict(re.findall(r"^  (\w[\w ]+?)  +([-\d.e+]+)", result.stdout, flags=re.MULTILINE))
    assert float(values["tangential stiffness"]) == pytest.approx(2e6, rel=1e-3)
    assert float(values["friction limit"]) == pytest.approx(500.0, rel=1e-3)
    assert float(values["friction coefficient"]) == pytest.approx(0.5, rel=1e-3)
    assert float(values["backlash"]) == pytest.approx(0.3, rel=1e-2)
    predicted = float(re.search(r"([\d.]+) J per cycle", result.stdout).group(1))  # type: ignore[union-attr]
    assert predicted == pytest.approx(4.0 * 750.0 * (1e-3 - 750.0 / 2e6 - 1.5e-4), rel=1e-2)
    assert 'law = "jenkins"' in result.stdout
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "fitted_loops.csv",
        "fitted_loops.png",
        "fitted_loops.svg",
    ]


BAD = {
    "no column": ("displacement [mm], load [kN]", None),
    "no units": ("displacement, force", None),
    "wrong unit": ("displacement [s], force [kN]", None),
    "nan": (HEAD, "0.1, nan"),
    "three entries": (HEAD, "0.1, 0.2, 0.3"),
    "no cycle": (HEAD, ""),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_end_in_a_sentence(case: str, tmp_path: Path) -> None:
    head, line = BAD[case]
    along = np.linspace(0.0, 1e-3, 40)
    path = write(tmp_path, along, 2e5 * along, head)
    if line:
        path.write_text(path.read_text(encoding="utf-8") + f"\n{line}\n", encoding="utf-8")
    result = invoke(path)
    assert result.exit_code == 2
    printed_sentence(result.stderr)


@pytest.mark.parametrize("options", [("--normal-load", "90"), ("--predict", "90 N"), ("--normal-load", "-1 N")])
def test_bad_loads_end_in_a_sentence(options: tuple[str, str], file: Path) -> None:
    result = invoke(file, *options)
    assert result.exit_code == 2
    printed_sentence(result.stderr)


def test_a_file_that_does_not_exist(tmp_path: Path) -> None:
    result = invoke(tmp_path / "none.csv")
    assert result.exit_code == 2
    printed_sentence(result.stderr)
