"""The benchmarks run: a row of the table, and the agreement that it prints."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import bench

    return bench


def test_a_row_has_all_cells_and_agrees_with_the_dense_newton(
    bench: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench, "pyharm_seconds", lambda problem: None)  # minutes, and an extra
    cells = bench.blade_row(10, quick=True)
    assert len(cells) == 10
    assert cells[1] == "9 / 2"
    assert float(cells[-1]) < 1e-8


def test_the_reference_finds_the_known_peak(bench: ModuleType) -> None:
    """198.44 um of first harmonic at 686.8 Hz, as in benchmarks/README.md, from a program that shares no code."""
    problem = bench.load_blade_problem(10)
    dense = sys.modules["dense_newton"]
    points = dense.DenseBalance(problem, harmonics=3, samples=128).sweep(*problem.window_hz)
    peak = max(dense.first_harmonic(point, problem.output) for point in points)
    assert 1e6 * peak == pytest.approx(198.44, abs=0.1)
