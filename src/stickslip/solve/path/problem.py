"""Equations with parameters for Newton's method and the path: ``R(x, p) = 0`` and ``c(x, p) = 0``.

``x`` are the unknowns, ``R`` has as many equations. ``p`` are the free parameters (k,): none for a single solution, one
for a curve. Each further parameter brings one condition ``c``. A curve is followed along the first parameter.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np

from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray

NO_PARAMETERS = np.empty(0)  # of a single solution


class Point(Protocol):
    """A trial solution; a problem may add its own data."""

    @property
    def unknowns(self) -> FloatArray:
        """The unknowns x, an array of any shape."""

    @property
    def parameters(self) -> FloatArray:
        """(k,) free parameters; the first is that of the curve."""

    @property
    def residual(self) -> FloatArray:
        """R, with the shape of the unknowns."""

    @property
    def conditions(self) -> FloatArray:
        """(k - 1,) values of the conditions c; empty for a curve of one parameter."""

    @property
    def error(self) -> float:
        """Relative size of residual and conditions, which Newton's method compares with its tolerance."""

    @property
    def measured(self) -> FloatArray:
        """The motion whose norm measures a step along a curve."""


@dataclass(frozen=True)
class Plane:
    """The plane of a correction: ``sum(weights (x - x_0)) + parameter_weight (p_0 - target) = 0``.

    ``p_0`` is the first parameter.
    """

    weights: FloatArray  # shape of the unknowns
    parameter_weight: float
    unknowns_target: FloatArray  # shape of the unknowns
    parameter_target: float

    __repr__ = short_repr

    @classmethod
    def fixed(cls, unknowns: FloatArray, parameter: float) -> Plane:
        """The first parameter stays at ``parameter``."""
        return cls(np.zeros_like(unknowns), 1.0, unknowns, parameter)

    def defect(self, point: Point) -> float:
        """Left-hand side of the equation of the plane."""
        along = float(np.vdot(self.weights, point.unknowns - self.unknowns_target))
        return along + self.parameter_weight * (float(point.parameters[0]) - self.parameter_target)


@dataclass(frozen=True)
class Step:
    """A solution of the linearised equations: changes of the unknowns and of the parameters (k,).

    ``detail`` is data of the problem for the change of the measured motion.
    """

    unknowns: FloatArray
    parameters: FloatArray
    detail: Any = None

    __repr__ = short_repr


class Linearised(Protocol):
    """The equations of a problem and a plane, linearised at a point."""

    def solve(self, residual: FloatArray, conditions: FloatArray, plane: float, tolerance: float) -> Step:
        """The step for a residual, values of the conditions (k - 1,), and a defect of the plane.

        ``R_x dx + R_p dp = -residual``, ``c_x dx + c_p dp = -conditions`` and ``weights dx + parameter_weight dp_0 =
        -plane``, to a relative ``tolerance``. A singular system gives a step that is not finite.
        """


PointT = TypeVar("PointT", bound=Point)


class Problem(Protocol[PointT]):
    """Equations ``R(x, p) = 0``, ``c(x, p) = 0`` with unknowns ``x`` (n,) and parameters ``p`` (k,).

    ``c`` are ``k - 1`` conditions, so that the solutions are a curve; Newton's method and path following use nothing
    else of a problem. Its first parameter, in its own unit, is the one in which a branch has start and stop.
    """

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray) -> PointT:
        """The point with these unknowns and parameters (k,)."""

    def linearised(self, point: PointT, plane: Plane | None) -> Linearised:
        """The equations at a point with the rows of conditions and plane; no plane if there is no parameter."""

    def measured_change(self, point: PointT, step: Step) -> FloatArray:
        """Change of the measured motion along a step from ``point``."""

    def determined(self, unknowns: FloatArray) -> FloatArray:
        """A copy of the unknowns without the part that no equation depends on; norms and planes take this."""

    def named(self, parameter: float) -> str:
        """A value of the first parameter in words: "412.300 Hz", "80 % of the load"."""
