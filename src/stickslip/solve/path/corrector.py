"""Tangents, planes and corrections along a branch, and the scales that measure them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeAlias

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.path.arc_length import Metric, Tangent, chord_between
from stickslip.solve.path.newton import Correction, Newton
from stickslip.solve.path.problem import Linearised, Plane, Point, PointT
from stickslip.solve.path.stepping import Effort

# chosen: a correction of a step ends if so many iterations do not halve its error, and a shorter step is tried; the
# shortest has all iterations. Of damper 8 of the torture set (benchmarks/torture.py) this ends 669 of 682 corrections
# that fail, and 3 of 1,123 that would converge.
PATIENCE = 3
# Floor of the scale of the motion, whose square must not underflow.
SMALLEST_MOTION = 1e-150
# (point of a curve, parameters) -> the solution there where equations are linear, or a guess of it; None elsewhere.
Known: TypeAlias = Callable[[PointT, FloatArray], PointT | None]


class Corrector(Generic[PointT]):
    """Predicts points of a branch along its tangent and corrects them with Newton's method.

    ``width`` is the range of the parameter; ``effort`` counts the iterations; ``known`` gives the solution at other
    parameters where it needs no iteration (:data:`Known`).
    """

    def __init__(
        self, newton: Newton[PointT], width: float, effort: Effort, known: Known[PointT] | None = None
    ) -> None:
        self.problem = newton.problem
        self._known = known
        self._newton = newton
        self._width = width
        self._effort = effort
        self._largest = 0.0

    def measure(self, point: PointT) -> Metric:
        """The metric after ``point``."""
        self._largest = max(self._largest, float(np.linalg.norm(point.measured)), SMALLEST_MOTION)
        return Metric(self._largest, self._width)

    def direction_of(self, point: PointT, system: Linearised, along: float) -> Tangent:
        """Tangent at ``point`` from a Newton system; ``along``, its component across the plane, orients it."""
        still, unchanged = np.zeros_like(point.unknowns), np.zeros_like(point.conditions)
        step = system.solve(still, unchanged, -along, self._newton.settings.tangent)
        return Tangent(step.unknowns, self.problem.measured_change(point, step), step.parameters)

    def first_tangent(self, start: PointT, direction: float, first_step: float) -> Tangent | None:
        """Unit tangent at the start of a branch; None where the equations determine no direction."""
        plane = Plane.fixed(start.unknowns, parameter_of(start))
        tangent = self.direction_of(start, self.problem.linearised(start, plane), direction)
        if not (np.isfinite(tangent.parameters).all() and np.isfinite(tangent.measured).all()):
            return None
        if not start.measured.any():
            # A curve that starts at rest: the motion of its first steps is the scale.
            self._largest = first_step * self._width * float(np.linalg.norm(tangent.measured))
        return self.measure(start).unit(tangent)

    def plane(self, point: PointT, tangent: Tangent, step: float) -> Plane:
        """The plane across the tangent at its end; the unknowns are scaled so that both parts of the normal count."""
        normal = self.problem.determined(tangent.unknowns)
        size = max(float(np.linalg.norm(normal)), 1e-150)  # whose square is above zero: unknowns may be constant
        return Plane(
            normal / size**2,
            tangent.parameter / self._width**2,
            point.unknowns + step * tangent.unknowns,
            parameter_of(point) + step * tangent.parameter,
        )

    def guess(
        self, point: PointT, tangent: Tangent, bend: Tangent, step: float, landmark: float | None = None
    ) -> tuple[PointT, Plane]:
        """The predicted end of a step, and the plane of its correction: across the tangent, or at a ``landmark``."""
        ahead = tangent.times(step).plus(bend.times(0.5 * step**2))
        unknowns, parameters = point.unknowns + ahead.unknowns, point.parameters + ahead.parameters
        plane = self.plane(point, tangent, step)
        if landmark is not None:
            plane = Plane(np.zeros_like(unknowns), plane.parameter_weight, unknowns, landmark)
        if self._known is not None:
            at = parameters if landmark is None else np.append(landmark, parameters[1:])
            solution = self._known(point, at)
            if solution is not None:
                return solution, plane
        return self.problem.evaluate(unknowns, parameters), plane

    def correct(self, start: PointT, plane: Plane, patience: int | None = None) -> Correction[PointT]:
        """Newton's method, with its iterations counted."""
        correction = self._newton.correct(start, plane, patience)
        self._effort.spend(correction.iterations)
        return correction

    def land(self, before: PointT, after: PointT, end: float) -> Correction[PointT]:
        """Newton's method exactly at an end between two points."""
        chord = chord_between(before, after)
        share = (end - parameter_of(before)) / chord.parameter
        parameters = before.parameters + share * chord.parameters
        parameters[0] = end
        guess = before.unknowns + share * chord.unknowns
        return self.correct(self.problem.evaluate(guess, parameters), Plane.fixed(guess, end))


def parameter_of(point: Point) -> float:
    """The parameter of the curve at a point."""
    return float(point.parameters[0])
