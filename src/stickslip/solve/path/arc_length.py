"""Directions of a branch, measured by the norm of the motion and the parameter, each over its scale."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.path.problem import Point


@dataclass(frozen=True)
class Tangent:
    """Direction of the branch: changes of the unknowns, of the measured motion, and of the parameters (k,)."""

    unknowns: FloatArray
    measured: FloatArray
    parameters: FloatArray

    @property
    def parameter(self) -> float:
        """Change of the parameter of the curve."""
        return float(self.parameters[0])

    def times(self, factor: float) -> Tangent:
        """The direction with another length."""
        return Tangent(factor * self.unknowns, factor * self.measured, factor * self.parameters)

    def plus(self, other: Tangent) -> Tangent:
        """The sum of two directions."""
        return Tangent(
            self.unknowns + other.unknowns, self.measured + other.measured, self.parameters + other.parameters
        )


def chord_between(before: Point, after: Point) -> Tangent:
    """The change from one point to another."""
    return Tangent(
        after.unknowns - before.unknowns, after.measured - before.measured, after.parameters - before.parameters
    )


@dataclass(frozen=True)
class Metric:
    """Inner product of directions: norm of the motion over ``motion_scale``, and parameter over ``parameter_scale``."""

    motion_scale: float
    parameter_scale: float

    def product(self, first: Tangent, second: Tangent) -> float:
        """Scaled inner product."""
        motion = float(np.vdot(first.measured, second.measured))
        return motion / self.motion_scale**2 + first.parameter * second.parameter / self.parameter_scale**2

    def unit(self, tangent: Tangent) -> Tangent:
        """The direction with length 1."""
        return tangent.times(1.0 / math.sqrt(self.product(tangent, tangent)))

    def detour_deg(self, before: Point, after: Point, tangent: Tangent) -> float:
        """Twice the angle from the tangent to the chord of a step: on an arc this is how much the tangent turns.

        It is large where Newton converged to another part of the curve, whose tangent may be similar.
        """
        return 2.0 * self.angle_deg(chord_between(before, after), tangent)

    def angle_deg(self, first: Tangent, second: Tangent) -> float:
        """Angle between two directions."""
        cosine = self.product(self.unit(first), self.unit(second))
        return math.degrees(math.acos(min(1.0, max(-1.0, cosine))))
