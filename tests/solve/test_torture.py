"""A quick tenth of the torture set (benchmarks/torture.py): which curves are complete today, and which end.

The table is what the solver does, with 3 harmonics and 128 samples: "ends" is a defect that the message admits. A
better solver changes a line to "complete". Curves that end after a minute of search (damper 0 and 2) are left to the
benchmark.
"""

from __future__ import annotations

from typing import Literal

import pytest

import stickslip as ss
from helpers import benchmark_module
from sentences import printed_sentence
from stickslip.solve.evidence import Evidence
from stickslip.solve.settled_motion import SettledMotion

make = benchmark_module("torture_problems").make

Outcome = Literal["complete", "ends"]

QUICK: dict[tuple[str, int], Outcome] = {
    ("sdof", 4): "complete",
    ("plate", 0): "complete",
    ("stiff", 3): "complete",
    ("aniso", 1): "complete",
    ("aniso", 3): "complete",
    ("gaps", 2): "complete",
    ("high", 3): "complete",
    ("low", 0): "complete",
}
SLOW: dict[tuple[str, int], Outcome] = {
    ("close", 2): "complete",
    ("chain", 0): "complete",
    ("sdof", 3): "complete",
    ("sdof", 11): "complete",
    ("beam", 0): "complete",
    ("beam", 12): "complete",
    ("twins", 1): "complete",
    ("twins", 2): "complete",
    ("damper", 1): "complete",
    ("damper", 3): "complete",
    ("damper", 4): "complete",
    ("damper", 9): "complete",
    ("light", 0): "complete",
    ("multi", 0): "complete",
    ("multi", 3): "complete",
    ("multi", 4): "complete",
    ("wide", 6): "complete",
    ("stiff", 0): "complete",
    ("high", 9): "complete",
    ("narrow", 0): "complete",
    ("narrow", 4): "complete",
}


def test_the_table_has_all_classes() -> None:
    assert {kind for kind, _ in (*QUICK, *SLOW)} == set(benchmark_module("torture_problems").SET_KINDS)


@pytest.mark.parametrize(
    ("repeats", "given_by", "verdict"),
    [(None, None, "unsettled"), (3, None, "unsettled"), (1, 96, "few harmonics"), (1, None, "early")],
)
def test_the_verdict_on_an_end_is_that_of_its_time_integration(
    repeats: int | None, given_by: int | None, verdict: str
) -> None:
    """And not that of an earlier place, which a warning describes."""
    settled = SettledMotion(96, given_by, 768, 0.016, 0.13)
    words = Evidence(100.0, 300, 1e-2, 0.5, repeats, 2e-3, 3, settled).words()
    earlier = Evidence(90.0, 300, 1e-2, 0.5, None if repeats == 1 else 1).words()
    ended = benchmark_module("torture").ended
    assert ended(f"The curve ends. {words}", (earlier,)) == verdict
    assert ended("The warnings name the places.", (words,)) == verdict


def assert_outcome(kind: str, seed: int, outcome: Outcome) -> None:
    """The curve covers its range, or a message gives the reason and the frequency of its end."""
    problem = make(kind, seed)
    start_hz, stop_hz = problem.window_hz
    reason = ""
    try:
        response = problem.solve()
    except ss.ConvergenceError as error:
        actual, reason = "ends", str(error)
    else:
        assert response.frequency_hz[0] == pytest.approx(start_hz, rel=1e-9)
        actual = "complete" if response.converged else "ends"
        _, _, reason = response.message.partition(". ")  # the first sentence is about the first point
        if response.converged:
            assert (response.frequency_hz[-1] - stop_hz) * (stop_hz - start_hz) > -1e-9 * start_hz**2
    assert actual == outcome, reason
    assert outcome == "complete" or " Hz" in reason


@pytest.mark.long
@pytest.mark.parametrize(("kind", "seed", "outcome"), [(*problem, outcome) for problem, outcome in QUICK.items()])
def test_a_curve_is_complete_or_says_why_it_ends(kind: str, seed: int, outcome: Outcome) -> None:
    assert_outcome(kind, seed, outcome)


@pytest.mark.long
@pytest.mark.parametrize(("kind", "seed", "outcome"), [(*problem, outcome) for problem, outcome in SLOW.items()])
def test_a_longer_curve_is_complete_or_says_why_it_ends(kind: str, seed: int, outcome: Outcome) -> None:
    assert_outcome(kind, seed, outcome)


@pytest.mark.long
def test_a_curve_that_leaves_through_its_start_and_comes_back_says_so() -> None:
    problem = make("beam", 12)
    response = problem.solve()
    outside = response.frequency_hz < min(problem.window_hz) - 0.1
    outside |= response.frequency_hz > max(problem.window_hz) + 0.1
    assert response.converged
    assert outside.any()
    printed_sentence("\n".join(response.warnings), numbers=False)


@pytest.mark.slow
def test_contact_thousands_of_times_stiffer_than_the_structure_takes_few_iterations() -> None:
    """Newton's matrix without the inertia of the modes at the contact converged ever slower: 22,124 iterations."""
    problem = make("stiff", 12)
    response = problem.solve(checks=False)
    assert response.converged
    assert float(response.provenance["solve_work"].split()[0]) < 4 * response.n_points
