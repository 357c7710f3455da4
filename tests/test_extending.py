"""docs/extending.md: every block of Python runs and gives what its comments promise."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

TEXT = (Path(__file__).parents[1] / "docs" / "extending.md").read_text(encoding="utf-8")
IN_THE_CODE = "Other additions"  # parts that no Python block of a user adds
SECTIONS = {part.split("\n", 1)[0]: part for part in TEXT.split("\n## ")[1:] if not part.startswith(IN_THE_CODE)}


def blocks(section: str) -> list[str]:
    """The Python blocks of a section."""
    return re.findall(r"```python\n(.*?)```", SECTIONS[section], flags=re.DOTALL)


def run(section: str) -> dict[str, Any]:
    """Run the blocks of a section one after the other; returns their names."""
    names: dict[str, Any] = {}
    for block in blocks(section):
        exec(compile(block, f"extending.md, {section}", "exec", dont_inherit=True), names)
    return names


def promised(section: str) -> list[str]:
    """What the comments behind ``print`` say."""
    return re.findall(r"^print\(.*\)  # (.+)$", "\n".join(blocks(section)), flags=re.MULTILINE)


# More than a second each.
SLOW = ("A new parameter",)


@pytest.mark.long
@pytest.mark.parametrize(
    "section", [pytest.param(each, marks=pytest.mark.slow if each in SLOW else ()) for each in SECTIONS]
)
def test_blocks_run_and_print_what_they_promise(
    section: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run(section)
    printed, exact = capsys.readouterr().out, [line for line in promised(section) if line not in WORDS]
    assert exact
    for line in exact:
        assert line.split(", ")[0] in printed


# Comments that say what is printed instead of printing it.
WORDS = ("(2H+1, n) N: mean, cos 1, sin 1",)


@pytest.mark.parametrize("section", SECTIONS)
def test_blocks_import_only_the_public_package(section: str) -> None:
    assert not re.search(r"(from|import) stickslip\.", "\n".join(blocks(section)))


def test_engine_order(capsys: pytest.CaptureFixture[str]) -> None:
    names = run("A new excitation")
    assert promised("A new excitation")[0] in capsys.readouterr().out.splitlines()
    unbalance = 1e-5 * 100.0**2
    expected = [[0, 0, 0, 0], [10 + unbalance, 0, -10, 0], [0, 10 + unbalance, 0, -10]]
    assert names["force"].coefficients(100.0) == pytest.approx(np.array(expected), abs=1e-12)


@pytest.mark.slow
def test_shallow_truss(capsys: pytest.CaptureFixture[str]) -> None:
    loads = run("A new analysis")["loads"]
    message, snap = capsys.readouterr().out.splitlines()
    assert message == promised("A new analysis")[0]
    assert float(snap.split()[-1]) == pytest.approx(2.0 / (3.0 * math.sqrt(3.0)), abs=6e-4)
    assert np.flatnonzero(np.diff(np.sign(np.diff(loads)))).size == 2  # it passes two folds
