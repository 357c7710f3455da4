"""Repair of wrong steps of a branch: retreat from one that returned, step around a corner."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

import numpy as np

from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.solve.path.arc_length import Metric, Tangent, chord_between
from stickslip.solve.path.corrector import PATIENCE, SMALLEST_MOTION, Corrector, parameter_of
from stickslip.solve.path.newton import Correction
from stickslip.solve.path.problem import Plane, PointT
from stickslip.solve.path.stepping import ContinuationSettings, Pace, growing_lengths
from stickslip.solve.path.visited import Visited

# Two solutions are the same point of a curve within this fraction of the chord that came near, or of their size: the
# legs of a sharp corner, where the branch turns by 180 degrees, are that close only at the tip.
SAME_POINT, SAME_POINT_OF_SIZE = 0.02, 1e-8
# chosen: the factor of the step after a retreat, and that after a second retreat to the same point.
SHORTER, LONGER = 0.25, 4.0
# A step beyond a corner differs from the direction in which the branch came by at least this angle.
LEAST_TURN_DEG = 2.0
# A branch counts as reversed after this number of points on its old path: at first the legs of a sharp corner are too
# close to each other for Newton to distinguish them.
POINTS_BACK = 4


@dataclass(frozen=True)
class CameBack:
    """The last step came back to the branch: ``target``, the index of the last point before the loop or reversal.

    ``same_direction`` is True where a second round of a loop begins, False after a reversal.
    """

    target: int
    same_direction: bool


class Retreats(Generic[PointT]):
    """Finds steps of a branch that came back to its ``visited`` points, and goes back to where they left it."""

    def __init__(
        self, corrector: Corrector[PointT], visited: Visited[PointT], settings: ContinuationSettings, pace: Pace
    ) -> None:
        self._corrector = corrector
        self._visited = visited
        self._settings = settings
        self._pace = pace
        self._back: list[int] = []  # points of the branch to which the last points came back, against its direction
        # Target of the last retreat, and the number of earlier ones with this target.
        self._last_target: PointT | None = None
        self._again = 0
        self._tried: list[tuple[PointT, float]] = []  # targets of all retreats, and the steps from there

    def came_back(self) -> CameBack | None:
        """Whether the last step came back to the branch; None if its point is new.

        On a second round of a loop in the same direction the target is the point before the first of the loop; after a
        reversal, the point that the branch came back to first. Newton, constrained to the plane through the earlier
        point and started on the chord, decides whether that point is on the present curve or on one beside it.
        """
        corrector, points = self._corrector, self._visited.points
        metric = corrector.measure(points[-1])
        chord = chord_between(points[-2], points[-1])
        for index, share in self._visited.near_last_chord(metric.motion_scale, metric.parameter_scale):
            before, earlier = points[-2], points[index]
            guess = corrector.problem.evaluate(
                before.unknowns + share * chord.unknowns, before.parameters + share * chord.parameters
            )
            correction = corrector.correct(guess, corrector.plane(earlier, chord, 0.0), PATIENCE)
            if not (correction.converged and self._same(correction.point, earlier, chord)):
                continue
            if metric.product(chord, chord_between(earlier, points[index + 1])) > 0.0:
                return CameBack(max(index - 1, 0), same_direction=True)
            self._back.append(index)
            return CameBack(self._back[0], same_direction=False) if len(self._back) == POINTS_BACK else None
        self._back.clear()
        return None

    def go_back(self, last: int) -> tuple[Tangent, float] | None:
        """The tangent and the next step at the point ``last``, before the points after it are removed.

        It is shorter than the step that left the branch; where shorter steps came back to the same point, it is longer,
        to pass it. None where an earlier retreat took the same step from this point: the branch would go round again.
        """
        corrector, points = self._corrector, self._visited.points
        metric = corrector.measure(points[-1])
        onward = chord_between(points[last], points[last + 1])
        length = math.sqrt(metric.product(onward, onward))
        self._again = self._again + 1 if self._retreated_near(points[last], length, metric) else 0
        self._last_target = points[last]
        if self._again == 0:
            step = max(SHORTER * length, self._settings.smallest_step)
            self._pace.slow_down(step)
        else:
            step = min(LONGER**self._again * length, self._settings.first_step)
            self._pace.relax()
        if any(target is points[last] and math.isclose(step, earlier) for target, earlier in self._tried):
            return None
        self._tried.append((points[last], step))
        self.forget()
        system = corrector.problem.linearised(points[last], corrector.plane(points[last], onward, 0.0))
        return metric.unit(corrector.direction_of(points[last], system, 1.0)), step

    def forget(self) -> None:
        """The last points are no reversal: the branch continues elsewhere."""
        self._back.clear()

    def _same(self, first: PointT, second: PointT, chord: Tangent) -> bool:
        """Whether two solutions are one point of a curve with the direction ``chord``."""

        def size(unknowns: FloatArray) -> float:
            return float(np.linalg.norm(self._corrector.problem.determined(unknowns)))

        allowed = SAME_POINT * size(chord.unknowns) + SAME_POINT_OF_SIZE * size(second.unknowns)
        allowed_parameter = SAME_POINT * abs(chord.parameter) + SAME_POINT_OF_SIZE * abs(parameter_of(second))
        away = size(first.unknowns - second.unknowns)
        return away <= allowed and abs(parameter_of(first) - parameter_of(second)) <= allowed_parameter

    def _retreated_near(self, point: PointT, length: float, metric: Metric) -> bool:
        """Whether the last retreat went to a point within a few steps of this one."""
        if self._last_target is None:
            return False
        away = chord_between(self._last_target, point)
        return metric.product(away, away) <= (LONGER * length) ** 2


@dataclass(frozen=True)
class Crossing:
    """A place where the branch was lost and continues close beyond.

    before, after:
        parameters of the last point before it, and of the first one beyond.
    motion:
        distance of the two in the measured motion, over the motion before.
    left_out:
        parameter of the last point of a part of the branch that begins there and was lost; None without such a part.
    highest:
        largest motion on this part, over the motion before; 0 without it.
    """

    before: float
    after: float
    motion: float
    left_out: float | None
    highest: float


def crossing_of(part: Sequence[PointT], beyond: PointT) -> Crossing:
    """The crossing from the first point of a lost ``part`` of a branch to a solution, which may have more
    coefficients."""
    edge = part[0]
    rows = max(len(edge.measured), len(beyond.measured))
    size = max(float(np.linalg.norm(edge.measured)), SMALLEST_MOTION)
    return Crossing(
        parameter_of(edge),
        parameter_of(beyond),
        float(np.linalg.norm(with_rows(beyond.measured, rows) - with_rows(edge.measured, rows))) / size,
        parameter_of(part[-1]) if len(part) > 1 else None,
        max((float(np.linalg.norm(each.measured)) for each in part[1:]), default=0.0) / size,
    )


def close_beyond(
    corrector: Corrector[PointT], near: Sequence[PointT], direction: float, settings: ContinuationSettings
) -> Correction[PointT] | None:
    """A solution beyond the first of the points ``near``, no farther from it than a first step; None without one.

    Corners finer than the smallest step, with loops and legs too close to each other for Newton's method, end a branch
    that continues just beyond. The parameter is fixed there: no direction of the branch enters.
    """
    edge = near[0]
    for length in growing_lengths(4.0 * settings.smallest_step, settings.first_step):
        metric = corrector.measure(edge)
        parameters = edge.parameters.copy()
        parameters[0] += direction * length * metric.parameter_scale
        for start in near:
            plane = Plane.fixed(start.unknowns, parameters[0])
            correction = corrector.correct(corrector.problem.evaluate(start.unknowns, parameters), plane)
            if not correction.converged:
                continue
            away = chord_between(edge, correction.point)
            if metric.product(away, away) <= settings.first_step**2:
                return correction
    return None


def around_corner(
    corrector: Corrector[PointT], point: PointT, tangent: Tangent, settings: ContinuationSettings
) -> tuple[Correction[PointT], Tangent, float, float] | None:
    """A step in the direction that the equations have beyond a corner; None if there is none.

    Where every step along the tangent fails, the equations change just ahead, and the branch continues along the
    tangent of the piece beyond, in the one of its two directions that does not lead back. Returns point, tangent,
    length, and next length.
    """
    for length in growing_lengths(4.0 * settings.smallest_step, settings.first_step):
        beyond, plane = corrector.guess(point, tangent, tangent.times(0.0), length)
        metric = corrector.measure(point)
        ahead = corrector.direction_of(beyond, corrector.problem.linearised(beyond, plane), 1.0)
        if not np.isfinite(ahead.measured).all():
            continue
        for side in (1.0, -1.0):
            direction = metric.unit(ahead).times(side)
            correction = corrector.correct(*corrector.guess(point, direction, direction.times(0.0), length))
            if not correction.converged or correction.system is None:
                continue
            turned = metric.unit(corrector.direction_of(correction.point, correction.system, 1.0))
            chord = chord_between(point, correction.point)
            back = metric.angle_deg(chord, tangent.times(-1.0))
            if back > LEAST_TURN_DEG and metric.angle_deg(chord, turned) <= settings.largest_angle_deg:
                return correction, turned, length, length
    return None
