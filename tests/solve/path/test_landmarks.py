"""Steps end on landmarks, so that narrow peaks of a curve in the plane are resolved, however low, and smooth parts are
not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import pytest
from plane_curves import PlaneCurve, PlanePoint

from sentences import printed_sentence
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.landmarks import Landmark, first_crossed
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings

WIDTH = 1e-4  # of the range from 0 to 1
PLACE = 0.61803


def peak(height: float, start: float = 0.0) -> PlaneCurve:
    """``1 + y/3 + height exp(-(2 (y - PLACE) / WIDTH)^2) + start exp(-25 y^2)``, a peak that no tangent foresees."""

    def top(y: float) -> float:
        return height * math.exp(-((2.0 * (y - PLACE) / WIDTH) ** 2))

    def begin(y: float) -> float:
        return start * math.exp(-25.0 * y * y)

    def slope(y: float) -> float:
        return 1.0 / 3.0 - 8.0 * (y - PLACE) / WIDTH**2 * top(y) - 50.0 * y * begin(y)

    return PlaneCurve(lambda x, y: x - 1.0 - y / 3.0 - top(y) - begin(y), lambda x, y: (1.0, -slope(y)))


@dataclass(frozen=True)
class Fixed:
    """The same landmarks everywhere."""

    landmarks: Sequence[Landmark]

    def of(self, point: PlanePoint) -> Sequence[Landmark]:
        return self.landmarks


def follow(curve: PlaneCurve, landmarks: Sequence[Landmark], backwards: bool = False) -> Branch[PlanePoint]:
    start, stop = (1.0, 0.0) if backwards else (0.0, 1.0)
    first = curve.at(-curve.function(0.0, start), start)
    newton = Newton(curve, NewtonSettings(tolerance=1e-12))
    branch = Branch(newton, first, stop, ContinuationSettings(), landmarks=Fixed(landmarks))
    branch.follow()
    assert branch.complete, branch.message
    return branch


def highest(branch: Branch[PlanePoint]) -> float:
    """Height of the curve near the peak over the straight line."""
    points = [each.point for each in branch.points]
    return max(point.x - 1.0 - point.y / 3.0 for point in points if abs(point.y - PLACE) < 0.1)


@pytest.mark.slow
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("height", [2.0, 1.0, 0.5])
def test_a_narrow_peak_is_resolved_where_a_landmark_is_near(height: float, backwards: bool) -> None:
    beside = Landmark(PLACE + 0.3 * WIDTH, WIDTH)
    assert highest(follow(peak(height), [], backwards)) < 0.01 * height
    assert highest(follow(peak(height), [beside], backwards)) == pytest.approx(height, rel=0.01)


@pytest.mark.slow
def test_a_low_peak_after_a_high_part_is_resolved() -> None:
    curve = peak(0.5, start=20.0)
    assert highest(follow(curve, [Landmark(PLACE + 0.3 * WIDTH, WIDTH)])) == pytest.approx(0.5, rel=0.01)


def test_a_branch_that_only_steps_across_a_landmark_continue_ends_there() -> None:
    """No point near the landmark converges: a peak there would be missed without a word."""

    def with_hole(x: float, y: float) -> float:
        return math.nan if abs(y - PLACE) < 2.0 * WIDTH else x - 1.0 - y / 3.0

    def followed(landmarks: Sequence[Landmark]) -> Branch[PlanePoint]:
        curve = PlaneCurve(with_hole, lambda x, y: (1.0, -1.0 / 3.0))
        newton = Newton(curve, NewtonSettings(tolerance=1e-12))
        branch = Branch(newton, curve.at(1.0, 0.0), 1.0, ContinuationSettings(), landmarks=Fixed(landmarks))
        branch.follow()
        return branch

    assert followed([]).complete
    lost = followed([Landmark(PLACE, WIDTH)])
    assert not lost.complete
    assert lost.points[-1].point.y == pytest.approx(PLACE - 2.0 * WIDTH, abs=1e-5)
    printed_sentence(lost.message)


def test_a_landmark_without_a_peak_costs_one_point() -> None:
    smooth = peak(0.0)
    without = len(follow(smooth, []).points)
    assert len(follow(smooth, [Landmark(PLACE, WIDTH)]).points) <= without + 1
    assert len(follow(smooth, [Landmark(PLACE, 1.0)]).points) == without


def test_the_first_landmark_in_the_direction_of_the_step() -> None:
    near, far, wide = Landmark(0.2, 0.01), Landmark(0.3, 0.01), Landmark(0.1, 2.0)
    assert first_crossed([far, near, wide], 0.0, 0.5) == near
    assert first_crossed([far, near, wide], 0.5, -0.5) == far
    assert first_crossed([far, near], 0.2, 0.05) is None  # on the nearer one, and short of the other
