"""A problem has one answer: upward and downward, with one and four threads, with twice the samples.

The quick tenth of benchmarks/same_answer.py, with its comparison of curves as curves; and tests of that comparison.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from helpers import benchmark_module

same_answer = benchmark_module("same_answer")
make = benchmark_module("torture_problems").make
Settings = benchmark_module("torture").Settings

PROBLEMS = [
    ("sdof", 4),
    ("plate", 0),
    ("gaps", 0),
    *(pytest.param(kind, 0, marks=pytest.mark.long) for kind in ("chain", "beam", "light", "aniso", "low")),  # 20 s
]


@pytest.mark.long
@pytest.mark.parametrize(("kind", "seed"), PROBLEMS)
def test_a_problem_has_one_answer(kind: str, seed: int) -> None:
    answers = same_answer.answers(make(kind, seed), Settings(3, "released"))
    assert {way: each.verdict for way, each in answers.items()} == dict.fromkeys(same_answer.WAYS, "same"), answers


@pytest.mark.long
@pytest.mark.parametrize(("kind", "seed", "coarse"), [("chain", 4, "downward"), ("close", 3, "twice the samples")])
def test_a_detail_between_the_points_of_one_way_is_no_other_branch(kind: str, seed: int, coarse: str) -> None:
    """They differ by 1.0 and 1.2 % of the plane, and agree with a quarter of the steps."""
    answers = same_answer.answers(make(kind, seed), Settings(3, "released"))
    expected = dict.fromkeys(same_answer.WAYS, "same") | {coarse: "steps"}
    assert {way: each.verdict for way, each in answers.items()} == expected, answers


def test_the_distance_to_a_curve_does_not_depend_on_its_points() -> None:
    line = np.column_stack([np.linspace(0.0, 1.0, 4), np.zeros(4)])
    points = np.array([[0.1, 0.0], [0.5, 0.02], [1.3, 0.4]])
    np.testing.assert_allclose(same_answer.distances(points, line), [0.0, 0.02, 0.5], atol=1e-15)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_ranges_of_folds_are_where_a_curve_goes_back(sign: float) -> None:
    frequency = np.array([1.0, 2.0, 3.0, 2.5, 2.6, 4.0])[:: int(sign)]
    ranges = same_answer.folded_ranges(frequency, 0.1)
    assert not same_answer.outside(np.array([2.5, 2.7, 3.0, 3.05]), ranges).any()
    assert same_answer.outside(np.array([2.3, 3.2]), ranges).all()


@pytest.mark.long
@pytest.mark.parametrize(("factor", "verdict"), [(1.005, "same"), (1.03, "different")])
def test_a_curve_that_is_three_per_cent_higher_is_another_one(factor: float, verdict: str) -> None:
    problem = make("sdof", 4)
    base, higher = problem.solve(), problem.solve()
    object.__setattr__(higher, "displacement", factor * higher.displacement)
    compared = same_answer.compare(problem, base, higher)
    assert compared.verdict == verdict
    assert compared.distance == pytest.approx(factor - 1.0, rel=0.5)


class Scripted:
    """A problem whose curves are a resonance; with 256 samples and usual steps the top is missing, or it is higher."""

    window_hz = (1.0, 2.0)
    structure = SimpleNamespace(output=np.ones(1))

    def __init__(self, factor: float) -> None:
        self._factor = factor

    def solve(self, *arguments: Any, **options: Any) -> Any:
        is_short, is_other = "continuation" in options, options.get("samples") == 256
        first_hz, last_hz = options.get("window_hz", self.window_hz)
        hertz = np.linspace(first_hz, last_hz, 401)
        amplitude = 1.0 / (1.0 + ((hertz - 1.5) / 0.01) ** 2)
        if is_other:
            amplitude *= self._factor
        keep = np.abs(hertz - 1.5) > (0.004 if is_other and not is_short else 0.0)
        hertz, amplitude = hertz[keep], amplitude[keep]
        return SimpleNamespace(
            converged=True,
            frequency_hz=hertz,
            n_points=hertz.size,
            amplitude=lambda output: amplitude,
            pairs=SimpleNamespace(released=True),
        )


@pytest.mark.slow
@pytest.mark.parametrize(("factor", "verdict"), [(1.0, "steps"), (1.03, "different")])
def test_a_difference_of_the_steps_is_no_difference_of_the_branches(factor: float, verdict: str) -> None:
    """Curves that agree with a quarter of the steps are one branch."""
    answers = same_answer.answers(Scripted(factor), Settings(3, "released"))
    assert [answers[way].verdict for way in same_answer.WAYS] == ["same", "same", verdict]


@pytest.mark.long
def test_only_stuck_pairs_with_other_retained_tractions_excuse_a_difference() -> None:
    """A mean displacement of all pairs that stick is another member of the continuum, if tractions are kept."""
    problem = make("sdof", 4)
    for mode, excused in (("kept", True), ("released", False)):
        one, two = problem.solve(mode), problem.solve(mode)
        moved = two.displacement.copy()
        moved[:, :, 0] += 0.1 * problem.preload[0] / problem.tangential_stiffness[0, 0] * np.array([1.0, 0.0, 0.0])
        object.__setattr__(two, "displacement", moved)
        stuck = float(one.frequency_hz[(one.contact_state[:, 0] == 0).argmax()])
        assert (one.contact_state[:, 0] == 0).any()
        assert same_answer.other_tractions(problem, one, two, stuck) == excused
        assert not same_answer.other_tractions(problem, one, one, stuck)


def test_the_table_counts_verdicts_of_each_way() -> None:
    alike = {"verdict": "same", "distance": 1e-3, "frequency_hz": 10.0}
    other = {"verdict": "different", "distance": 0.2, "frequency_hz": 12.0}
    missing = {"verdict": "not complete", "distance": math.nan, "frequency_hz": math.nan}
    row = dict(zip(same_answer.WAYS, (alike, other, missing), strict=True))
    lines = same_answer.table([{"kind": "sdof", "seed": 0} | row])
    assert lines[2] == "| sdof | 1 | 1 / 0 / 0 / 0 (0) | 0 / 0 / 0 / 1 (0) | 0 / 0 / 0 / 0 (1) | 1.0e-03 |"
    assert same_answer.differences([{"kind": "sdof", "seed": 0} | row]) == [
        "sdof 0, four threads: different, 0.2 of the plane at 12.000 Hz"
    ]
