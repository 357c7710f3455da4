"""Curves f(x, y) = 0 in the plane as problems of the path: one unknown x, the parameter y."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.path.problem import NO_PARAMETERS, Plane, Step


@dataclass(frozen=True)
class PlanePoint:
    """A point of the plane."""

    x: float
    y: float
    value: float

    @property
    def unknowns(self) -> FloatArray:
        return np.array([self.x])

    @property
    def parameters(self) -> FloatArray:
        return np.array([self.y])

    @property
    def residual(self) -> FloatArray:
        return np.array([self.value])

    @property
    def conditions(self) -> FloatArray:
        return NO_PARAMETERS

    @property
    def error(self) -> float:
        return abs(self.value)

    @property
    def measured(self) -> FloatArray:
        return self.unknowns


@dataclass(frozen=True)
class PlaneCurve:
    """``function(x, y)`` and ``slopes(x, y)``, its two derivatives."""

    function: Callable[[float, float], float]
    slopes: Callable[[float, float], tuple[float, float]]

    def at(self, x: float, y: float) -> PlanePoint:
        return PlanePoint(x, y, self.function(x, y))

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray) -> PlanePoint:
        return self.at(float(unknowns[0]), float(parameters[0]))

    def linearised(self, point: PlanePoint, plane: Plane | None) -> PlaneSystem:
        assert plane is not None
        row = [float(plane.weights[0]), plane.parameter_weight]
        return PlaneSystem(np.array([self.slopes(point.x, point.y), row]))

    def measured_change(self, point: PlanePoint, step: Step) -> FloatArray:
        return step.unknowns

    def determined(self, unknowns: FloatArray) -> FloatArray:
        return unknowns.copy()

    def named(self, parameter: float) -> str:
        return f"y = {parameter:.3f}"


@dataclass(frozen=True)
class PlaneSystem:
    """Two equations."""

    matrix: FloatArray

    def solve(self, residual: FloatArray, conditions: FloatArray, plane: float, tolerance: float) -> Step:
        try:
            x, y = np.linalg.solve(self.matrix, [-float(residual[0]), -plane])
        except np.linalg.LinAlgError:
            x = y = np.nan
        return Step(np.array([x]), np.array([y]))


def circle() -> PlaneCurve:
    """x^2 + y^2 = 1."""
    return PlaneCurve(lambda x, y: x * x + y * y - 1.0, lambda x, y: (2.0 * x, 2.0 * y))


def lemniscate() -> PlaneCurve:
    """Bernoulli's, (x^2 + y^2)^2 = y^2 - x^2: its two leaves cross at the origin."""
    return PlaneCurve(
        lambda x, y: (x * x + y * y) ** 2 - y * y + x * x,
        lambda x, y: (4.0 * x * (x * x + y * y) + 2.0 * x, 4.0 * y * (x * x + y * y) - 2.0 * y),
    )


def corner(slope: float) -> PlaneCurve:
    """x = y up to y = 1/2, then a straight line of another slope: a kink, as where a time sample changes state."""
    return PlaneCurve(
        lambda x, y: x - (y if y < 0.5 else 0.5 + slope * (y - 0.5)),
        lambda x, y: (1.0, -1.0 if y < 0.5 else -slope),
    )


def step(place: float, height: float) -> PlaneCurve:
    """x = 1 + y, beyond a place higher: a curve that is not continuous."""
    return PlaneCurve(lambda x, y: x - (1.0 + y + (0.0 if y < place else height)), lambda x, y: (1.0, -1.0))


def s_curve() -> PlaneCurve:
    """y = x^3 - x, which folds at x = -1/sqrt(3) and x = 1/sqrt(3)."""
    return PlaneCurve(lambda x, y: x**3 - x - y, lambda x, y: (3.0 * x * x - 1.0, -1.0))


def line_beside_an_ellipse(
    centre: float = 0.021, half_x: float = 0.02, half_y: float = 0.04, middle: float = 10.5, slope: float = 0.2
) -> PlaneCurve:
    """``u ((u - c)^2 / a^2 + (y - m)^2 / b^2 - 1)``, u = x - 1 - s (y - m): a straight branch, an ellipse close by."""

    def ellipse(u: float, y: float) -> float:
        return ((u - centre) / half_x) ** 2 + ((y - middle) / half_y) ** 2 - 1.0

    def above(x: float, y: float) -> float:
        return x - 1.0 - slope * (y - middle)

    def slopes(x: float, y: float) -> tuple[float, float]:
        u = above(x, y)
        by_u = ellipse(u, y) + 2.0 * u * (u - centre) / half_x**2
        return by_u, 2.0 * u * (y - middle) / half_y**2 - slope * by_u

    return PlaneCurve(lambda x, y: above(x, y) * ellipse(above(x, y), y), slopes)
