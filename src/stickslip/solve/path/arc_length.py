"""Directions of a branch, measured by the mass norm of the vibration and the frequency as shares of a picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial


@dataclass(frozen=True)
class Tangent:
    """Direction of the branch: changes of x (2H+1, m), of the modal amplitudes (2H, n), and of the frequency."""

    relative: FloatArray
    amplitude: FloatArray
    omega: float

    def times(self, factor: float) -> Tangent:
        """The direction with another length."""
        return Tangent(factor * self.relative, factor * self.amplitude, factor * self.omega)

    def plus(self, other: Tangent) -> Tangent:
        """The sum of two directions."""
        return Tangent(self.relative + other.relative, self.amplitude + other.amplitude, self.omega + other.omega)


def chord_between(before: Trial, after: Trial) -> Tangent:
    """The change from one point to another."""
    return Tangent(after.relative - before.relative, after.amplitude - before.amplitude, after.omega - before.omega)


@dataclass(frozen=True)
class Metric:
    """Inner product of directions: mass norm of the vibration over ``u_scale``, and frequency over ``w_scale``."""

    u_scale: float
    w_scale: float

    def product(self, first: Tangent, second: Tangent) -> float:
        """Scaled inner product."""
        vibration = float((first.amplitude * second.amplitude).sum())
        return vibration / self.u_scale**2 + first.omega * second.omega / self.w_scale**2

    def unit(self, tangent: Tangent) -> Tangent:
        """The direction with length 1."""
        return tangent.times(1.0 / math.sqrt(self.product(tangent, tangent)))

    def angle_deg(self, first: Tangent, second: Tangent) -> float:
        """Angle between two directions."""
        cosine = self.product(self.unit(first), self.unit(second))
        return math.degrees(math.acos(min(1.0, max(-1.0, cosine))))
