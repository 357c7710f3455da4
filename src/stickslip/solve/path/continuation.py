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

from stickslip.solve.path.arc_length import Metric, Tangent
from stickslip.solve.path.corrector import PATIENCE, Corrector, Known, parameter_of
from stickslip.solve.path.landmarks import ON_IT, VISIBLE, Landmark, LandmarkSource, first_crossed, is_long_near
from stickslip.solve.path.newton import Correction, Newton
from stickslip.solve.path.problem import PointT
from stickslip.solve.path.retreats import CameBack, Crossing, Retreats, around_corner, close_beyond, crossing_of
from stickslip.solve.path.stepping import (
    Accepted,
    BranchPoint,
    ContinuationSettings,
    Corner,
    Effort,
    Pace,
    Retreat,
    Revision,
    lengths_to_try,
)
from stickslip.solve.path.visited import Visited
from stickslip.solve.path.work import Work

# chosen: the largest number of retreats from steps that came back to the branch before it is lost, and of places where
# the branch is lost and continues close beyond.
MOST_RETREATS, MOST_CROSSINGS = 6, 6
# chosen: how often a step that passes the end, but from which Newton does not land on it, is halved.
MOST_LANDINGS = 8
# chosen: the step after a place where the branch was lost, over the first step.
BEYOND = 0.1
# chosen: how far the branch may go beyond its start, as a fraction of the range and of the start, before it folds and
# comes back: a range often begins between two folds.
LONGEST_EXCURSION = 0.5
# chosen: a branch that used its points runs back if it ends by more than this fraction of the range behind its furthest
# point.
RUNS_BACK = 0.01


class Branch(Generic[PointT]):
    """The branch from ``start`` to the value ``stop`` of the parameter.

    ``follow()`` walks along it and returns its points. ``on_event`` receives each accepted point, retreats (points are
    removed because they are on another curve), and corners. No step crosses one of the ``landmarks``
    (:mod:`stickslip.solve.path.landmarks`) without a point on it. Afterwards ``complete`` is True if the
    branch ends at the stop, ``lost`` if it ends because no step succeeds, or runs back when it has used its points
    (``ran_out``); ``message`` describes its end. ``retreats`` and ``corners`` are the parameters of those events,
    ``crossings`` the places where the branch was lost and continues close beyond. ``revise`` may solve each new point
    again, with other equations, before the branch continues.
    The branch also ends at the limit of the ``work`` on all branches that share it, and where an effort does not pay,
    of which one of its iterations has a ``cost`` of so many usual ones. Where the equations are linear, ``known`` gives
    its points without iteration.

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
        work: Work | None = None,
        known: Known[PointT] | None = None,
        cost: float = 1.0,
    ) -> None:
        self._problem = newton.problem
        self._start = start
        self._stop = stop
        self._settings = settings
        self._on_event = on_event or (lambda event: None)
        self._source = landmarks
        self._revise = revise or (lambda point, along: Revision(point))
        self._landmarks: Sequence[Landmark] = ()  # as seen from the last point
        self._origin = parameter_of(start)
        self._direction = math.copysign(1.0, stop - self._origin)
        self._within = within
        self._width = abs(stop - self._origin) if within is None else within[1] - within[0]
        self._visited: Visited[PointT] = Visited()
        self._pace = Pace(settings.largest_step)
        self._effort = Effort(settings, work, cost)
        self._corrector = Corrector(newton, self._width, self._effort, known)
        self._retreats = Retreats(self._corrector, self._visited, settings, self._pace)
        self.points: list[BranchPoint[PointT]] = []
        self.retreats: list[float] = []
        self.corners: list[float] = []
        self.crossings: list[Crossing] = []
        self._crossed: list[tuple[PointT, float]] = []  # where they begin, and their directions
        self._most_retreats = MOST_RETREATS
        self._steps = iter(range(settings.max_points - 1))
        self.complete = self.closed = self.lost = self.ran_out = False
        self.message = "The branch has no points yet."

    def __repr__(self) -> str:
        limits = f"{self._problem.named(self._origin)} to {self._problem.named(self._stop)}"
        return f"<Branch from {limits}, {len(self.points)} points: {self.message}>"

    def follow(self) -> list[BranchPoint[PointT]]:
        """Follow to the stop, or as far as possible; returns the points of the branch."""
        tangent = self._corrector.first_tangent(self._start, self._direction, self._settings.first_step)
        self._accept(BranchPoint(self._start, 0, tangent))
        if tangent is None:
            self.message = (
                f"The equations are singular at the start, {self._name_of(self._start)}: no direction of the curve is "
                "determined there. Start elsewhere."
            )
            return self.points
        beyond: tuple[Tangent, float] | None = tangent, self._settings.first_step
        while beyond is not None:
            beyond = self._beyond() if self._walk(*beyond) else None
        return self.points

    def _walk(self, tangent: Tangent, step: float) -> bool:
        """Walk on, to the end of the branch or to where it is ``lost``; True if it may go on close beyond."""
        self.lost = True  # unless an end is reached
        bend, landings = tangent.times(0.0), MOST_LANDINGS
        for _ in self._steps:
            point = self.points[-1].point
            if self._effort.stall:
                self.message = f"The curve makes no progress at {self._name_of(point)}: {self._effort.stall}"
                return False
            outcome = self._advance_to_landmark(point, tangent, bend, min(step, self._pace.limit))
            if outcome is None:
                outcome = self._around_corner(point, tangent)
            if outcome is None:
                return True
            correction, turned, length, step = outcome
            self._pace.advance(length)
            reached = parameter_of(correction.point)
            self._effort.cover(length, (reached - self._origin) / self._width)
            end = self._end_passed(reached)
            if end is not None:
                landed = self._corrector.land(point, correction.point, end)
                if not landed.converged and landings > 0:
                    landings, step = landings - 1, 0.5 * length  # the end is nearer from the next points
                    continue
                self.complete, self.lost = True, False
                self.message = "The branch reached the stop."
                last = landed if landed.converged else correction  # else one beyond the stop
                self._accept(BranchPoint(last.point, landed.iterations + correction.iterations))
                return False
            beyond = (self._origin - reached) * self._direction
            if self._within is None and beyond > LONGEST_EXCURSION * min(self._width, abs(self._origin)):
                self.message = (
                    f"The branch turned back and left the range through its start; at "
                    f"{self._name_of(correction.point)} it had not returned. Start from the other end (swap start and "
                    "stop), or widen the range."
                )
                return False
            resolved = self._accept_revised(correction, turned)
            came_back = self._retreats.came_back()
            if came_back is not None and self._is_closed_by(came_back):
                self.closed = self.complete = True
                self.lost = False
                self.message = "The branch is a closed curve."
                return False
            if came_back is None and resolved is not None:
                tangent, bend = resolved, resolved.times(0.0)
                continue
            if came_back is None:
                bend = turned.plus(tangent.times(-1.0)).times(1.0 / length)
                tangent = turned
                continue
            onward = self._retreat(came_back.target) if len(self.retreats) < self._most_retreats else None
            if onward is None:
                self.message = (
                    f"The branch returned to a part already computed {len(self.retreats) + 1} times, the last time at "
                    f"{self._name_of(self.points[-1].point)}: other solutions are too close to it. Use more samples, "
                    "fewer harmonics, or more damping."
                )
                return True
            tangent, step = onward
            bend = tangent.times(0.0)
        # A curve may begin again beyond a branch that runs back; one that advances needs more points.
        ahead = [self._direction * parameter_of(each.point) for each in self.points]
        self.ran_out, self.lost = True, ahead[-1] < max(ahead) - RUNS_BACK * self._width
        self.message = (
            f"{self._settings.max_points} points were not enough; the branch reached only "
            f"{self._name_of(self.points[-1].point)}. Raise max_points or narrow the range."
        )
        return False

    def _beyond(self) -> tuple[Tangent, float] | None:
        """Go on close beyond a place where the branch is lost: tangent and next step there; None if it has ended."""
        if len(self.crossings) == MOST_CROSSINGS:
            return None
        last = len(self.points) - 1
        ahead = [self._direction * parameter_of(each.point) for each in self.points]
        furthest = int(np.argmax(ahead))
        here = self.points[last].point
        travel = math.copysign(1.0, ahead[last] - ahead[max(last - 1, 0)])
        for index, sign in ((furthest, 1.0), (last, travel)):
            edge, direction = self.points[index].point, sign * self._direction
            if any(edge is before and direction == onward for before, onward in self._crossed):
                continue  # this crossing led back
            found = close_beyond(self._corrector, (edge, here), direction, self._settings)
            if found is None or self._end_passed(parameter_of(found.point)) or self._jumped(edge, found.point):
                continue
            self._crossed.append((edge, direction))
            self.crossings.append(crossing_of([each.point for each in self.points[index:]], found.point))
            if index < last:
                self._remove_after(index)
            tangent = self._corrector.first_tangent(found.point, direction, self._settings.first_step)
            if tangent is None:
                return None
            self._effort.renew()
            self._pace.relax()
            self._retreats.forget()
            self._most_retreats = len(self.retreats) + MOST_RETREATS
            return self._accept_revised(found, tangent) or tangent, BEYOND * self._settings.first_step
        return None

    def _accept_revised(self, correction: Correction[PointT], tangent: Tangent) -> Tangent | None:
        """Accept a new point, or the one in its place; the tangent there if that moved."""
        revision, moved = self._revise(correction.point, tangent), None
        if revision.system is not None:
            direction = self._corrector.direction_of(revision.point, revision.system, 1.0)
            moved = self._corrector.measure(revision.point).unit(direction)
        self._accept(BranchPoint(revision.point, correction.iterations, moved or tangent))
        return moved

    def _is_closed_by(self, came_back: CameBack) -> bool:
        """Whether the branch, which may pass its start, came back to it in the same direction."""
        return self._within is not None and came_back.same_direction and came_back.target == 0

    def _retreat(self, target: int) -> tuple[Tangent, float] | None:
        """Remove the points after ``target``; returns the tangent there and the next step, None if it is not new."""
        onward = self._retreats.go_back(target)
        if onward is not None:
            self.retreats.append(parameter_of(self.points[target].point))
            self._remove_after(target)
        return onward

    def _remove_after(self, target: int) -> None:
        self._on_event(Retreat(parameter_of(self.points[target].point), target + 1))
        del self.points[target + 1 :]
        self._visited.truncate(target + 1)

    def _around_corner(
        self, point: PointT, tangent: Tangent
    ) -> tuple[Correction[PointT], Tangent, float, float] | None:
        """A step beyond a corner where none along the tangent succeeds."""
        outcome = around_corner(self._corrector, point, tangent, self._settings)
        if outcome is not None:
            self._pass_corner(point)
        return outcome

    def _pass_corner(self, point: PointT) -> None:
        self.corners.append(parameter_of(point))
        self._on_event(Corner(parameter_of(point)))

    def _end_passed(self, reached: float) -> float | None:
        """The stop, or the end of the range, if a parameter is beyond it."""
        if (reached - self._stop) * self._direction >= 0.0:
            return self._stop
        if self._within is not None and not self._within[0] <= reached <= self._within[1]:
            return self._within[0] if reached < self._within[0] else self._within[1]
        return None

    def _name_of(self, point: PointT) -> str:
        return self._problem.named(parameter_of(point))

    def _accept(self, point: BranchPoint[PointT]) -> None:
        self.points.append(point)
        self._visited.add(point.point)
        self._on_event(Accepted(point.point, len(self.points)))

    def _advance_to_landmark(
        self, point: PointT, tangent: Tangent, bend: Tangent, step: float
    ) -> tuple[Correction[PointT], Tangent, float, float] | None:
        """One accepted step (:meth:`_advance`) that ends on the first landmark it would cross."""
        self._landmarks = self._source.of(point) if self._source else ()
        crossed = first_crossed(self._landmarks, parameter_of(point), step * tangent.parameter)
        if crossed is None:
            return self._advance(point, tangent, bend, step)
        cut = (crossed.value - parameter_of(point)) / tangent.parameter
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
            at = landmark if length == step else None
            guess, plane = self._corrector.guess(point, tangent, bend, length, at)
            is_shortest = 0.5 * length < settings.smallest_step
            correction = self._corrector.correct(guess, plane, None if is_shortest else PATIENCE)
            if not correction.converged:
                reason = reason or f"Newton stopped at a relative residual of {correction.point.error:.1e}"
                continue
            # The last system of the correction is that of the point, except for the last Newton step.
            system = correction.system or self._problem.linearised(correction.point, plane)
            turned = self._corrector.direction_of(correction.point, system, 1.0)
            metric = self._corrector.measure(correction.point)
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
                continue
            if angle <= settings.largest_angle_deg:
                if length > step:
                    self._pass_corner(point)
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

    def _local_angle_deg(
        self, metric: Metric, before: PointT, after: PointT, tangent: Tangent, turned: Tangent
    ) -> float:
        """Angle of a step that is long compared with a peak near it, measured by the motion there; else 0.

        A peak that is low compared with the highest one so far turns the curve too little to be resolved otherwise.
        """
        if not is_long_near(self._landmarks, parameter_of(before), parameter_of(after)):
            return 0.0
        scale = max(float(np.linalg.norm(each.measured)) for each in (before, after))
        local = Metric(max(scale, VISIBLE * metric.motion_scale), metric.parameter_scale)
        return max(local.angle_deg(turned, tangent), local.detour_deg(before, after, tangent))

    def _jumped(self, before: PointT, after: PointT) -> bool:
        """Whether a step ends beyond a landmark: its plane may intersect the curve on the far side of a peak."""
        start, end = parameter_of(before), parameter_of(after)
        crossed = first_crossed(self._landmarks, start, end - start)
        return crossed is not None and abs(end - crossed.value) > ON_IT * crossed.width
