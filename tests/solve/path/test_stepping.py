"""A branch that costs much and hardly advances ends with a sentence."""

from __future__ import annotations

import math

import pytest
from plane_curves import PlaneCurve, s_curve

from sentences import printed_sentence
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.stepping import (
    ITERATIONS_PER_POINT,
    MOST_IN_SLICE,
    STALL_ITERATIONS,
    STALL_LENGTH,
    ContinuationSettings,
    Effort,
)


def comb(height: float, pitch: float) -> PlaneCurve:
    """``x = 1 + y`` up to y = 1/2, then with a wave on it: a comb of as many folds as ``pitch`` fits into the rest."""

    def phase(y: float) -> float:
        return max(y - 0.5, 0.0) / pitch

    return PlaneCurve(
        lambda x, y: x - 1.0 - y - height * (1.0 - math.cos(phase(y))),
        lambda x, y: (1.0, -1.0 - (height / pitch) * math.sin(phase(y))),
    )


@pytest.mark.slow
def test_a_branch_that_hardly_advances_ends_with_a_sentence() -> None:
    """Without a limit it follows every tooth for as many points as allowed."""
    curve, count = comb(height=3e-5, pitch=1e-5), [0]

    def counted(iteration: int, error: float) -> None:
        count[0] += 1

    newton = Newton(curve, NewtonSettings(tolerance=1e-13), counted)
    branch = Branch(newton, curve.at(1.0, 0.0), 1.0, ContinuationSettings(max_points=100_000))
    points = branch.follow()
    assert not branch.complete
    printed_sentence(branch.message, "y = 0.5", numbers=False)
    assert points[-1].point.y > 0.5
    assert count[0] < 2 * STALL_ITERATIONS


@pytest.mark.slow
def test_a_branch_that_never_leaves_a_slice_of_the_range_ends_with_a_sentence() -> None:
    """Its waves are so high that it covers much of the plot, but of the parameter a thousandth."""
    settings = ContinuationSettings(max_points=400)
    curve = comb(height=0.2, pitch=1e-5)
    branch = Branch(Newton(curve, NewtonSettings()), curve.at(1.0, 0.0), 1.0, settings)
    points = branch.follow()
    assert branch.lost
    assert len(points) < settings.max_points
    printed_sentence(branch.message, "y = 0.5", "1 %", numbers=False)


def test_the_iterations_of_a_slice_count_over_all_visits() -> None:
    effort = Effort(ContinuationSettings(max_points=100))
    most = MOST_IN_SLICE * 100 * ITERATIONS_PER_POINT
    for visit in range(2):
        effort.spend(int(most / 2))
        effort.cover(STALL_LENGTH, 0.505)
        effort.spend(1)
        effort.cover(STALL_LENGTH, 0.1 * visit)
    assert effort.stall == ""
    effort.spend(1)
    effort.cover(STALL_LENGTH, 0.508)
    assert f"{most + 1:.0f} iterations" in effort.stall


def test_a_branch_that_advances_has_no_limit_but_that_of_its_points() -> None:
    curve = s_curve()
    newton = Newton(curve, NewtonSettings())
    branch = Branch(newton, curve.at(-2.0, -6.0), 6.0, ContinuationSettings())
    branch.follow()
    assert branch.complete
    assert repr(newton) == f"<Newton method for {type(curve).__name__}, tolerance 1e-09>"
    assert repr(branch) == (
        f"<Branch from {curve.named(-6.0)} to {curve.named(6.0)}, {len(branch.points)} points: {branch.message}>"
    )


@pytest.mark.parametrize("length", [0.0, 0.9 * STALL_LENGTH, STALL_LENGTH])
def test_the_recent_iterations_count_since_the_last_part_of_the_plot(length: float) -> None:
    effort = Effort(ContinuationSettings())
    effort.spend(STALL_ITERATIONS)
    assert effort.stall == ""
    effort.cover(length, 0.5)
    effort.spend(1)
    assert bool(effort.stall) == (length < STALL_LENGTH)


def test_all_iterations_have_a_limit_too() -> None:
    effort = Effort(ContinuationSettings(max_points=10))
    for step in range(10):
        effort.spend(ITERATIONS_PER_POINT)
        effort.cover(STALL_LENGTH, step * STALL_LENGTH)
    assert effort.stall == ""
    effort.spend(1)
    printed_sentence(effort.stall, f"{10 * ITERATIONS_PER_POINT + 1} iterations")


def test_an_iteration_with_more_harmonics_counts_as_several() -> None:
    effort = Effort(ContinuationSettings(), cost=7.0)
    effort.spend(STALL_ITERATIONS // 7)
    assert effort.stall == ""
    effort.spend(1)
    assert effort.stall
