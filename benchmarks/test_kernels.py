"""Timings of the kernels: ``python -m pytest benchmarks/test_kernels.py``. Ratios and trends, never a bound."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from blade_problem import load_blade_problem

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import harmonic_force, harmonic_tangent
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.structure.superelement import Superelement

HARMONICS, SAMPLES = 3, 128
Benchmark = Callable[..., Any]


@pytest.fixture(scope="module")
def trial() -> tuple[Balance, Trial]:
    """The blade with 110 contacts under a motion in which nearly all slip."""
    problem = load_blade_problem(110)
    pairs = ContactPairs(
        problem.contact_operator(),
        problem.normal_stiffness,
        problem.tangential_stiffness,
        problem.friction_coefficient,
        problem.preload,
    )
    omega = np.pi * sum(problem.window_hz)  # at the stuck resonance
    structure = Superelement(problem.mass, problem.stiffness, problem.damping)
    stuck = stuck_structure(structure, pairs, 2.0 * np.pi * problem.window_hz[1], None)
    force = np.zeros((2 * HARMONICS + 1, problem.size))
    force[1], force[2] = problem.force_cos, problem.force_sin
    balance = Balance(stuck.compliance(HARMONICS), pairs, ExcitationForce(((0, force),)), SAMPLES)
    return balance, balance.evaluate(0.2 * balance.linear(omega), omega)


def coefficients(balance: Balance, trial: Trial) -> np.ndarray:
    return np.ascontiguousarray(trial.relative.T).reshape(balance.pairs.n_pairs, 3, -1)


def test_friction_force(benchmark: Benchmark, trial: tuple[Balance, Trial]) -> None:
    balance, point = trial
    motion = coefficients(balance, point)
    answer = benchmark(harmonic_force, motion, balance.pairs, SAMPLES)
    assert (answer.state > 0).sum() > 60


def test_friction_tangent(benchmark: Benchmark, trial: tuple[Balance, Trial]) -> None:
    balance, point = trial
    motion = coefficients(balance, point)
    force = harmonic_force(motion, balance.pairs, SAMPLES)
    moving = np.flatnonzero(force.deviates)
    benchmark(harmonic_tangent, motion, balance.pairs, SAMPLES, moving, "tractrix", force.period_start)


def test_residual(benchmark: Benchmark, trial: tuple[Balance, Trial]) -> None:
    balance, point = trial
    benchmark(balance.evaluate, point.relative, point.omega)


def test_correction(benchmark: Benchmark, trial: tuple[Balance, Trial]) -> None:
    balance, point = trial
    curve = FrequencyCurve(balance)
    start = curve.at(point.relative, point.omega)
    newton, plane = Newton(curve, NewtonSettings()), Plane.fixed(point.relative, point.omega)
    assert benchmark(newton.correct, start, plane).converged
