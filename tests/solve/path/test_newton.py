"""Newton's method on curves of the plane: order of convergence, planes, shortened steps, and honest failure."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from plane_curves import PlaneCurve, circle, corner, s_curve

from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane


def test_it_converges_quadratically_on_a_fixed_parameter() -> None:
    errors: list[float] = []
    newton = Newton(circle(), NewtonSettings(1e-14), lambda number, error: errors.append(error))
    correction = newton.correct(circle().at(2.0, 0.6), Plane.fixed(np.array([2.0]), 0.6))
    assert correction.converged
    assert correction.point.x == pytest.approx(0.8, abs=1e-14)
    assert correction.point.y == 0.6
    # For f = x^2 - 0.64 the error after a step is exactly e^2 / (4 x^2) of the same function.
    for before, after in pairwise(errors[1:]):
        assert after <= 0.5 * before**2


def test_a_plane_constrains_the_correction_where_the_parameter_cannot() -> None:
    """At y = 1 the circle folds: no solution at y = 1.01, but one on the plane x = 0.05."""
    start = circle().at(0.05, 1.01)
    fixed = Newton(circle(), NewtonSettings()).correct(start, Plane.fixed(start.unknowns, 1.01))
    assert not fixed.converged
    held = Newton(circle(), NewtonSettings()).correct(start, Plane(np.array([1.0]), 0.0, start.unknowns, 0.0))
    assert held.converged
    assert held.point.y == pytest.approx(np.sqrt(1.0 - 0.05**2), abs=1e-9)


def test_a_full_step_that_overshoots_is_shortened() -> None:
    """Newton on arctan runs away from 3 with full steps."""
    curve = PlaneCurve(lambda x, y: np.arctan(x) - y, lambda x, y: (1.0 / (1.0 + x * x), -1.0))
    start = curve.at(3.0, 0.0)
    plane = Plane.fixed(start.unknowns, 0.0)
    assert Newton(curve, NewtonSettings()).correct(start, plane).converged
    assert not Newton(curve, NewtonSettings(fractions=(1.0,))).correct(start, plane).converged


def test_a_kink_is_crossed() -> None:
    curve = corner(5.0)
    start = curve.at(1.0, 0.0)
    correction = Newton(curve, NewtonSettings()).correct(start, Plane(np.array([1.0]), 0.0, start.unknowns, 0.0))
    assert correction.converged
    assert correction.point.y == pytest.approx(0.6)


def test_a_singular_system_ends_without_a_number() -> None:
    fold = s_curve().at(1.0 / np.sqrt(3.0), -1.0)
    correction = Newton(s_curve(), NewtonSettings()).correct(fold, Plane.fixed(fold.unknowns, -1.0))
    assert not correction.converged


def test_the_round_off_is_accepted_only_near_the_tolerance() -> None:
    """A residual that stays at 5e-9 whatever the step is."""
    curve = PlaneCurve(lambda x, y: 5e-9, lambda x, y: (1.0, 0.0))
    start = curve.at(1.0, 0.0)
    plane = Plane.fixed(start.unknowns, 0.0)
    assert Newton(curve, NewtonSettings(1e-9)).correct(start, plane).converged
    flat = PlaneCurve(lambda x, y: 5e-9, lambda x, y: (1e-5, 0.0))  # each step is 5e-4: the solution is elsewhere
    assert not Newton(flat, NewtonSettings(1e-9)).correct(flat.at(1.0, 0.0), plane).converged
    assert not Newton(curve, NewtonSettings(1e-11)).correct(start, plane).converged
    assert not Newton(curve, NewtonSettings(1e-9, round_off_factor=0.0)).correct(start, plane).converged


def test_a_correction_that_goes_round_ends_early() -> None:
    """No solution exists: every step is one over the kink, from 1 to -1 and back."""
    curve = PlaneCurve(lambda x, y: 0.01 + abs(x), lambda x, y: (float(np.sign(x)) or 1.0, -1.0))
    start = curve.at(1.0, 0.0)
    newton, plane = Newton(curve, NewtonSettings(fractions=(2.0,))), Plane.fixed(start.unknowns, 0.0)
    for patience, iterations in ((3, 3), (None, 12)):
        correction = newton.correct(start, plane, patience)
        assert (correction.converged, correction.iterations) == (False, iterations)


def test_a_correction_that_falls_slowly_goes_on() -> None:
    """A root of 10th order: each step leaves 0.9^10 = 0.35 of the residual, three leave 0.04."""
    curve = PlaneCurve(lambda x, y: x**10, lambda x, y: (10.0 * x**9, -1.0))
    start = curve.at(1.0, 0.0)
    correction = Newton(curve, NewtonSettings(1e-5)).correct(start, Plane.fixed(start.unknowns, 0.0), patience=3)
    assert (correction.converged, correction.iterations) == (True, 11)
