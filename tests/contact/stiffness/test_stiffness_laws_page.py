"""docs/theory_stiffness_laws.md: its example prints what it promises, and its table is that of the stored results."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from helpers import benchmark_module

TEXT = (Path(__file__).parents[3] / "docs" / "theory_stiffness_laws.md").read_text(encoding="utf-8")


def test_the_example_prints_what_it_promises(capsys: pytest.CaptureFixture[str]) -> None:
    (block,) = re.findall(r"<!-- tested -->\n```python\n(.*?)```", TEXT, flags=re.DOTALL)
    exec(compile(block, "theory_stiffness_laws.md", "exec", dont_inherit=True), {})
    promised = re.findall(r"^print\(.*\)  # ([^,\n]+)", block, flags=re.MULTILINE)
    assert capsys.readouterr().out.splitlines() == promised


@pytest.mark.slow
@pytest.mark.parametrize("law", ["`persson`", "p / (0.45 Sq)", "`fractal`, `consistent`"])
def test_the_table_is_that_of_the_stored_boundary_elements(law: str) -> None:
    laws = benchmark_module("laws_against_boundary_elements")
    rows, _ = laws.read("test")
    ratio = laws.ratios(laws.LAWS[law], rows)
    row = next(line for line in TEXT.splitlines() if line.startswith(f"| {law} |"))
    _, without, least, median, largest, within, _ = [cell.strip() for cell in row.strip("|").split("|")]
    found = ratio[ratio > 0]
    assert int(without) == ratio.size - found.size
    assert [float(least), float(median), float(largest)] == pytest.approx(
        [found.min(), np.median(np.nan_to_num(ratio)), found.max()], rel=0.05
    )
    assert within.startswith(f"{(np.abs(np.log(found)) < np.log(2)).sum()} of {ratio.size} ")
