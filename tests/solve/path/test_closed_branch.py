"""A branch within a range: it may pass its start, and a closed curve ends where it began."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from plane_curves import PlanePoint, circle

from sentences import printed_sentence
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings

CIRCLE = circle()


def branch(stop: float, within: tuple[float, float] | None) -> Branch[PlanePoint]:
    start = CIRCLE.at(math.cos(0.3), math.sin(0.3))
    result = Branch(Newton(CIRCLE, NewtonSettings()), start, stop, ContinuationSettings(), within=within)
    result.follow()
    return result


@pytest.mark.slow
@pytest.mark.parametrize("stop", [2.0, -2.0])
def test_a_closed_curve_ends_where_it_began(stop: float) -> None:
    whole = branch(stop, (-2.0, 2.0))
    assert whole.closed
    assert whole.complete
    printed_sentence(whole.message)
    angles = [math.atan2(each.point.y, each.point.x) for each in whole.points]
    turned = sum(abs((after - before + math.pi) % (2 * math.pi) - math.pi) for before, after in pairwise(angles))
    assert 2 * math.pi <= turned < 2 * math.pi + 0.5


def test_a_branch_ends_at_either_end_of_its_range() -> None:
    low = branch(2.0, (-0.5, 2.0))
    assert low.complete
    assert not low.closed
    assert low.points[-1].point.y == pytest.approx(-0.5)
    assert low.points[-1].point.x < 0.0


def test_without_a_range_a_branch_that_passes_its_start_is_incomplete() -> None:
    printed_sentence(branch(2.0, None).message)
