"""Follow a branch of solutions along the first parameter of a problem by pseudo-arc length, through folds.

Steps and angles are measured in ``(motion / motion_scale, parameter / width)``: ``motion_scale`` is the largest norm of
the measured motion so far and ``width`` the range of the parameter, so a step is a fraction of the plot. (For a joint
the measured motion is the vibration of the whole structure; the relative displacements of the pairs would be a poor
measure, since they have a kink wherever a pair begins to slip.)

Source of the method: H. B. Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems" (1977).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Generic

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.path.arc_length import Metric, Tangent, chord_between
from stickslip.solve.path.landmarks import ON_IT, VISIBLE, Landmark, LandmarkSource, first_crossed, is_long_near
from stickslip.solve.path.newton import Correction, Newton
from stickslip.solve.path.problem import Linearised, Plane, Point, PointT
from stickslip.solve.path.stepping import (
    Accepted,
    BranchPoint,
    ContinuationSettings,
    Corner,
    Effort,
    Pace,
    Retreat,
    Revision,
    growing_lengths,
    lengths_to_try,
)
from stickslip.solve.path.visited import Visited

# Relative accuracy of a tangent, which is only a prediction.
TANGENT_TOLERANCE = 1e-4
# Two solutions are the same point of a curve within this fraction of the chord that came near, or of their size: the
# legs of a sharp corner, where the branch turns by 180 degrees, are that close only at the tip.
SAME_POINT, SAME_POINT_OF_SIZE = 0.02, 1e-8
# chosen: the largest number of retreats from steps that came back to the branch; the factor of the next steps, and that
# after a second retreat to the same point.
MOST_RETREATS = 6
SHORTER, LONGER = 0.25, 4.0
# A step beyond a corner differs from the direction in which the branch came by at least this angle.
LEAST_TURN_DEG = 2.0
# chosen: how far the branch may go beyond its start, as a fraction of the range and of the start, before it folds and
# comes back: a range often begins between two folds.
LONGEST_EXCURSION = 0.5
# Floor of the scale of the motion, whose square must not underflow.
SMALLEST_MOTION = 1e-150
# A branch counts as reversed after this number of points on its old path: at first the legs of a sharp corner are too
# close to each other for Newton to distinguish them.
POINTS_BACK = 4


class Branch(Generic[PointT]):
    """The branch from ``start`` to the value ``stop`` of the parameter.

    ``follow()`` walks along it and returns its points. ``on_event`` receives each accepted point, retreats (points are
    removed because they are on another curve), and corners. No step crosses one of the ``landmarks``
    (:mod:`stickslip.solve.path.landmarks`) without a point on it. Afterwards ``complete`` is True if the
    branch ends at the stop, ``message`` describes its end; ``retreats`` and ``corners`` are the parameters of those
    events. ``revise`` may solve each new point again, with other equations, before the branch goes on from there.

    With ``within``, a range of the parameter that contains start and stop, the branch may turn and pass its start: it
    is complete where it leaves the range, or where it comes back to its start in the same direction; ``closed`` is then
    True.
    """

    def __init__(
        self,
        newton: Newton[PointT],
        start: PointT,
        stop: float,
        settings: ContinuationSettings,
        on_event: Callable[[Accepted[PointT] | Retreat | Corner], None] | None = None,
        landmarks: LandmarkSource[PointT] | None = None,
        within: tuple[float, float] | None = None,
        revise: Callable[[PointT, Tangent], Revision[PointT]] | None = None,
    ) -> None:
        self._problem = newton.problem
        self._start = start
        self._stop = stop
        self._newton = newton
        self._settings = settings
        self._on_event = on_event or (lambda event: None)
        self._source = landmarks
        self._revise = revise or (lambda point, along: Revision(point))
        self._landmarks: Sequence[Landmark] = ()  # as seen from the last point
        self._origin = _parameter(start)
        self._direction = math.copysign(1.0, stop - self._origin)
        self._within = within
        self._width = abs(stop - self._origin) if within is None else within[1] - within[0]
        self._largest = 0.0
        self._visited: Visited[PointT] = Visited()
        self._back: list[int] = []
        self._last_target: PointT | None = (
            None  # target of the last retreat, and the number of earlier ones with this target
        )
        self._again = 0
        self._pace = Pace(settings.largest_step)
        self._effort = Effort(settings)
        self.points: list[BranchPoint[PointT]] = []
        self.retreats: list[float] = []
        self.corners: list[float] = []
        self.complete = self.closed = False
        self.message = "The branch has no points yet."

    def follow(self) -> list[BranchPoint[PointT]]:
        """Follow to the stop, or as far as possible; returns the points of the branch."""
        self._accept(BranchPoint(self._start, 0))
        tangent = self._first_tangent()
        if tangent is None:
            self.message = (
                f"The equations are singular at the start, {self._name_of(self._start)}: no direction of the curve is "
                "determined there. Start elsewhere."
            )
            return self.points
        bend, step = tangent.times(0.0), self._settings.first_step
        for _ in range(self._settings.max_points - 1):
            point = self.points[-1].point
            if self._effort.stall:
                self.message = f"The curve makes no progress at {self._name_of(point)}: {self._effort.stall}"
                return self.points
            outcome = self._advance_to_landmark(point, tangent, bend, min(step, self._pace.limit))
            if outcome is None:
                outcome = self._around_corner(point, tangent)
            if outcome is None:
                return self.points
            correction, turned, length, step = outcome
            self._pace.advance(length)
            self._effort.cover(length)
            reached = _parameter(correction.point)
            end = self._end_passed(reached)
            if end is not None:
                landed, iterations = self._land(point, correction.point, end)
                self.complete = True
                self.message = "The branch reached the stop."
                self._accept(BranchPoint(landed, iterations + correction.iterations))
                return self.points
            beyond = (self._origin - reached) * self._direction
            if self._within is None and beyond > LONGEST_EXCURSION * min(self._width, abs(self._origin)):
                self.message = (
                    f"The branch turned back and left the range through its start; at "
                    f"{self._name_of(correction.point)} it had not come back. Start from the other end (swap start and "
                    "stop), or widen the range."
                )
                return self.points
            revision = self._revise(correction.point, turned)
            self._accept(BranchPoint(revision.point, correction.iterations))
            target = self._retreat_target()
            if self.closed:
                self.complete = True
                self.message = "The branch is a closed curve."
                return self.points
            if target is None and revision.system is not None:
                direction = self._direction_of(revision.point, revision.system, 1.0)
                tangent = self._measure(revision.point).unit(direction)
                bend = tangent.times(0.0)
                continue
            if target is None:
                bend = turned.plus(tangent.times(-1.0)).times(1.0 / length)
                tangent = turned
                continue
            if len(self.retreats) == MOST_RETREATS:
                self.message = (
                    f"The branch returned to a part already computed {MOST_RETREATS + 1} times, the last time at "
                    f"{self._name_of(self.points[-1].point)}: other solutions are too close to it. Use more samples, "
                    "fewer harmonics, or more damping."
                )
                return self.points
            tangent, step = self._retreat(target)
            bend = tangent.times(0.0)
        self.message = (
            f"{self._settings.max_points} points were not enough; the branch reached only "
            f"{self._name_of(self.points[-1].point)}. Raise max_points or narrow the range."
        )
        return self.points

    def _end_passed(self, reached: float) -> float | None:
        """The stop, or the end of the range, if a parameter is beyond it."""
        if (reached - self._stop) * self._direction >= 0.0:
            return self._stop
        if self._within is not None and not self._within[0] <= reached <= self._within[1]:
            return self._within[0] if reached < self._within[0] else self._within[1]
        return None

    def _name_of(self, point: PointT) -> str:
        return self._problem.named(_parameter(point))

    def _accept(self, point: BranchPoint[PointT]) -> None:
        self.points.append(point)
        self._visited.add(point.point)
        self._on_event(Accepted(point.point, len(self.points)))

    def _retreat_target(self) -> int | None:
        """The target of a retreat because the last step came back to the branch; None if the point is new.

        On a second round of a loop in the same direction it is the point before the first of the loop; after a
        reversal, the point that the branch came back to first. Newton, constrained to the plane through the earlier
        point and started on the chord, decides whether that point is on the present curve or on one beside it.
        """
        points = self._visited.points
        metric = self._measure(points[-1])
        chord = chord_between(points[-2], points[-1])
        for index, share in self._visited.near_last_chord(metric.motion_scale, metric.parameter_scale):
            before, earlier = points[-2], points[index]
            guess = self._problem.evaluate(
                before.unknowns + share * chord.unknowns, before.parameters + share * chord.parameters
            )
            correction = self._correct(guess, self._plane(earlier, chord, 0.0))
            if not (correction.converged and self._same(correction.point, earlier, chord)):
                continue
            if metric.product(chord, chord_between(earlier, points[index + 1])) > 0.0:
                self.closed = self._within is not None and index <= 1
                return max(index - 1, 0)
            self._back.append(index)
            return self._back[0] if len(self._back) == POINTS_BACK else None
        self._back.clear()
        return None

    def _same(self, first: PointT, second: PointT, chord: Tangent) -> bool:
        """Whether two solutions are one point of a curve with the direction ``chord``."""

        def size(unknowns: FloatArray) -> float:
            return float(np.linalg.norm(self._problem.determined(unknowns)))

        allowed = SAME_POINT * size(chord.unknowns) + SAME_POINT_OF_SIZE * size(second.unknowns)
        allowed_parameter = SAME_POINT * abs(chord.parameter) + SAME_POINT_OF_SIZE * abs(_parameter(second))
        away = size(first.unknowns - second.unknowns)
        return away <= allowed and abs(_parameter(first) - _parameter(second)) <= allowed_parameter

    def _retreat(self, last: int) -> tuple[Tangent, float]:
        """Remove the points after ``last``; returns the tangent there and the next step.

        It is shorter than the step that left the branch; where shorter steps came back to the same point, it is longer,
        to pass it.
        """
        points = self._visited.points
        metric = self._measure(points[-1])
        onward = chord_between(points[last], points[last + 1])
        length = math.sqrt(metric.product(onward, onward))
        self._again = self._again + 1 if self._retreated_near(points[last], length, metric) else 0
        self._last_target = points[last]
        self.retreats.append(_parameter(points[last]))
        self._on_event(Retreat(_parameter(points[last]), last + 1))
        if self._again == 0:
            step = max(SHORTER * length, self._settings.smallest_step)
            self._pace.slow_down(step)
        else:
            step = min(LONGER**self._again * length, self._settings.first_step)
            self._pace.relax()
        del self.points[last + 1 :]
        self._visited.truncate(last + 1)
        self._back.clear()
        system = self._problem.linearised(points[last], self._plane(points[last], onward, 0.0))
        return metric.unit(self._direction_of(points[last], system, 1.0)), step

    def _retreated_near(self, point: PointT, length: float, metric: Metric) -> bool:
        """Whether the last retreat went to a point within a few steps of this one."""
        if self._last_target is None:
            return False
        away = chord_between(self._last_target, point)
        return metric.product(away, away) <= (LONGER * length) ** 2

    def _measure(self, point: PointT) -> Metric:
        """The metric after ``point``."""
        self._largest = max(self._largest, float(np.linalg.norm(point.measured)), SMALLEST_MOTION)
        return Metric(self._largest, self._width)

    def _direction_of(self, point: PointT, system: Linearised, along: float) -> Tangent:
        """Tangent at ``point`` from a Newton system; ``along``, its component across the plane, orients it."""
        step = system.solve(np.zeros_like(point.unknowns), np.zeros_like(point.conditions), -along, TANGENT_TOLERANCE)
        return Tangent(step.unknowns, self._problem.measured_change(point, step), step.parameters)

    def _first_tangent(self) -> Tangent | None:
        plane = Plane.fixed(self._start.unknowns, self._origin)
        system = self._problem.linearised(self._start, plane)
        tangent = self._direction_of(self._start, system, self._direction)
        if not (np.isfinite(tangent.parameters).all() and np.isfinite(tangent.measured).all()):
            return None
        if not self._start.measured.any():
            # A curve that starts at rest: the motion of its first steps is the scale.
            self._largest = self._settings.first_step * self._width * float(np.linalg.norm(tangent.measured))
        return self._measure(self._start).unit(tangent)

    def _plane(self, point: PointT, tangent: Tangent, step: float) -> Plane:
        """The plane across the tangent at its end; the unknowns are scaled so that both parts of the normal count."""
        normal = self._problem.determined(tangent.unknowns)
        size = max(float(np.linalg.norm(normal)), 1e-150)  # whose square is above zero: unknowns may be constant
        return Plane(
            normal / size**2,
            tangent.parameter / self._width**2,
            point.unknowns + step * tangent.unknowns,
            _parameter(point) + step * tangent.parameter,
        )

    def _advance_to_landmark(
        self, point: PointT, tangent: Tangent, bend: Tangent, step: float
    ) -> tuple[Correction[PointT], Tangent, float, float] | None:
        """One accepted step (:meth:`_advance`) that ends on the first landmark it would cross."""
        self._landmarks = self._source.of(point) if self._source else ()
        crossed = first_crossed(self._landmarks, _parameter(point), step * tangent.parameter)
        if crossed is None:
            return self._advance(point, tangent, bend, step)
        cut = (crossed.value - _parameter(point)) / tangent.parameter
        if cut < self._settings.smallest_step:
            return self._advance(point, tangent, bend, step)
        outcome = self._advance(point, tangent, bend, cut, crossed.value)
        if outcome is None or outcome[2] != cut:
            return outcome
        # Nothing narrow was there: the next step is that of a curve without the landmark.
        correction, turned, length, after = outcome
        return correction, turned, length, max(after, step * min(1.0, after / length))

    def _advance(
        self, point: PointT, tangent: Tangent, bend: Tangent, step: float, landmark: float | None = None
    ) -> tuple[Correction[PointT], Tangent, float, float] | None:
        """One accepted step: point, tangent, length, and next length; None (and a message) if none succeeds.

        ``bend`` is the change of the tangent over the last step per length: the guess follows the curvature. Where no
        shorter step succeeds, a corner that turns back is ahead, and the plane across the tangent does not intersect
        the branch there; that of a longer step may intersect it behind the next corner. A step that ends on a
        ``landmark`` has its plane at that parameter: one across the tangent may miss a peak there.
        """
        settings, reason = self._settings, ""
        last: tuple[Correction[PointT], Tangent, float, float] | None = None
        for length in lengths_to_try(step, settings):
            guess, plane = self._guess(point, tangent, bend, length)
            if landmark is not None and length == step:
                plane = Plane(np.zeros_like(guess.unknowns), plane.parameter_weight, guess.unknowns, landmark)
            correction = self._correct(guess, plane)
            if not correction.converged:
                reason = reason or f"Newton stopped at a relative residual of {correction.point.error:.1e}"
                continue
            # The last system of the correction is that of the point, except for the last Newton step.
            system = correction.system or self._problem.linearised(correction.point, plane)
            turned = self._direction_of(correction.point, system, 1.0)
            metric = self._measure(correction.point)
            angle = max(metric.angle_deg(turned, tangent), metric.detour_deg(point, correction.point, tangent))
            angle = max(angle, self._local_angle_deg(metric, point, correction.point, tangent, turned))
            candidate = (
                correction,
                metric.unit(turned),
                length,
                settings.next_step(length, correction.iterations, angle),
            )
            if angle <= settings.largest_angle_deg and self._jumped(point, correction.point):
                reason = reason or "each step crossed a narrow peak"
                last = last or candidate  # if no shorter step ends before the peak
                continue
            if angle <= settings.largest_angle_deg:
                if length > step:
                    self.corners.append(_parameter(point))
                    self._on_event(Corner(_parameter(point)))
                return candidate
            reason = f"the branch turned by {angle:.0f} degrees"
            if length < 4.0 * settings.smallest_step:
                last = candidate  # a corner, if no step passes it
        if last is None:
            self.message = (
                f"The solver lost the branch at {self._name_of(point)}: {reason} even at the smallest step "
                f"({settings.smallest_step:g} of the range). Try more samples, fewer harmonics, or a lower force."
            )
        return last

    def _around_corner(
        self, point: PointT, tangent: Tangent
    ) -> tuple[Correction[PointT], Tangent, float, float] | None:
        """A step in the direction that the equations have beyond a corner; None if there is none.

        Where every step along the tangent fails, the equations change just ahead, and the branch continues along the
        tangent of the piece beyond, in the one of its two directions that does not lead back.
        """
        settings = self._settings
        for length in growing_lengths(4.0 * settings.smallest_step, settings.first_step):
            beyond, plane = self._guess(point, tangent, tangent.times(0.0), length)
            metric = self._measure(point)
            ahead = self._direction_of(beyond, self._problem.linearised(beyond, plane), 1.0)
            if not np.isfinite(ahead.measured).all():
                continue
            for side in (1.0, -1.0):
                direction = metric.unit(ahead).times(side)
                correction = self._correct(*self._guess(point, direction, direction.times(0.0), length))
                if not correction.converged or correction.system is None:
                    continue
                turned = metric.unit(self._direction_of(correction.point, correction.system, 1.0))
                chord = chord_between(point, correction.point)
                back = metric.angle_deg(chord, tangent.times(-1.0))
                if back > LEAST_TURN_DEG and metric.angle_deg(chord, turned) <= settings.largest_angle_deg:
                    self.corners.append(_parameter(point))
                    self._on_event(Corner(_parameter(point)))
                    return correction, turned, length, length
        return None

    def _correct(self, start: PointT, plane: Plane) -> Correction[PointT]:
        """Newton's method, with its iterations counted."""
        correction = self._newton.correct(start, plane)
        self._effort.spend(correction.iterations)
        return correction

    def _guess(self, point: PointT, tangent: Tangent, bend: Tangent, step: float) -> tuple[PointT, Plane]:
        """The predicted end of a step, and the plane of its correction."""
        ahead = tangent.times(step).plus(bend.times(0.5 * step**2))
        guess = self._problem.evaluate(point.unknowns + ahead.unknowns, point.parameters + ahead.parameters)
        return guess, self._plane(point, tangent, step)

    def _local_angle_deg(
        self, metric: Metric, before: PointT, after: PointT, tangent: Tangent, turned: Tangent
    ) -> float:
        """Angle of a step that is long compared with a peak near it, measured by the motion there; else 0.

        A peak that is low compared with the highest one so far turns the curve too little to be resolved otherwise.
        """
        if not is_long_near(self._landmarks, _parameter(before), _parameter(after)):
            return 0.0
        scale = max(float(np.linalg.norm(each.measured)) for each in (before, after))
        local = Metric(max(scale, VISIBLE * metric.motion_scale), metric.parameter_scale)
        return max(local.angle_deg(turned, tangent), local.detour_deg(before, after, tangent))

    def _jumped(self, before: PointT, after: PointT) -> bool:
        """Whether a step ends beyond a landmark: its plane may intersect the curve on the far side of a peak."""
        start, end = _parameter(before), _parameter(after)
        crossed = first_crossed(self._landmarks, start, end - start)
        return crossed is not None and abs(end - crossed.value) > ON_IT * crossed.width

    def _land(self, before: PointT, after: PointT, end: float) -> tuple[PointT, int]:
        """The solution exactly at an end; the point beyond it if that does not converge."""
        share = (end - _parameter(before)) / (_parameter(after) - _parameter(before))
        guess = before.unknowns + share * (after.unknowns - before.unknowns)
        parameters = before.parameters + share * (after.parameters - before.parameters)
        parameters[0] = end
        start = self._problem.evaluate(guess, parameters)
        correction = self._correct(start, Plane.fixed(guess, end))
        return (correction.point, correction.iterations) if correction.converged else (after, 0)


def _parameter(point: Point) -> float:
    return float(point.parameters[0])
