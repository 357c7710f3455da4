"""Retreats and crossings that would lead round again end the branch."""

from __future__ import annotations

from typing import Any

import pytest
from plane_curves import PlanePoint, s_curve, step

from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.corrector import Corrector
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.retreats import LONGER, SHORTER, CameBack, Retreats
from stickslip.solve.path.stepping import ContinuationSettings, Effort, Pace
from stickslip.solve.path.visited import Visited

SETTINGS = ContinuationSettings()


def test_no_second_retreat_takes_the_same_step_from_the_same_point() -> None:
    """First a shorter step, then longer ones up to the first step of a branch, each once."""
    curve, pace = s_curve(), Pace(SETTINGS.largest_step)
    visited: Visited[PlanePoint] = Visited()
    corrector = Corrector(Newton(curve, NewtonSettings()), 12.0, Effort(SETTINGS))
    retreats = Retreats(corrector, visited, SETTINGS, pace)
    for x in (-2.0, -1.998, -1.996):
        visited.add(curve.at(x, x**3 - x))
    length = (0.002**2 / 4.0 + (0.022 / 12.0) ** 2) ** 0.5  # |x| <= 2 is the scale of the motion

    steps = []
    while (onward := retreats.go_back(1)) is not None:
        steps.append(onward[1])
    assert steps == pytest.approx([SHORTER * length, LONGER * length, SETTINGS.first_step], rel=0.02)

    visited.truncate(2)
    visited.points[1] = curve.at(visited.points[1].x, visited.points[1].y)  # found again: another point
    visited.add(curve.at(-1.996, -(1.996**3) + 1.996))
    assert retreats.go_back(1) is not None


class LedBack(Branch[PlanePoint]):
    """A branch that no step takes on between y = 0.49 and a crossing, and that comes back from beyond it."""

    def _advance(self, point: PlanePoint, tangent: Any, bend: Any, step: float, landmark: float | None = None) -> Any:
        return super()._advance(point, tangent, bend, step, landmark) if self._is_passable(point) else None

    def _around_corner(self, point: PlanePoint, tangent: Any) -> Any:
        return None

    def _is_passable(self, point: PlanePoint) -> bool:
        self.message = "No step."
        return point.y < 0.49 or any(point.y >= each.after for each in self.crossings)

    def came_back(self) -> CameBack | None:
        """To the point at which the crossing begins."""
        if not self.crossings or self.points[-1].point.y <= self.crossings[0].after:
            return None
        return CameBack(sum(each.point.y <= self.crossings[0].before for each in self.points) - 1, same_direction=False)


def test_no_second_crossing_begins_at_the_same_point() -> None:
    curve = step(2.0, 1.0)  # not before the stop
    branch = LedBack(Newton(curve, NewtonSettings()), curve.at(1.0, 0.0), 1.0, SETTINGS)
    branch._retreats.came_back = branch.came_back  # type: ignore[method-assign]
    branch.follow()
    assert len(branch.crossings) == len(branch.retreats) == 1
    assert branch.lost
    assert branch.points[-1].point.y == branch.crossings[0].before
    assert branch.message == "No step."
