"""The equations of a nonlinear mode: exact derivatives, also with damping that couples the modes."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from helpers import Blade
from stickslip.solve.harmonic import reduced
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.compliance import StuckStructure, stuck_structure
from stickslip.solve.harmonic.gain import SelfExcitation
from stickslip.solve.harmonic.mode_curve import ModeCurve
from stickslip.solve.path.problem import Plane, Step

MODE, GROWTH = 0, 12.0


def balance_of(blade: Blade, coupled: bool) -> tuple[Balance, StuckStructure]:
    """A balance with the force of a mode, and its structure."""
    damping = blade.superelement.damping
    assert damping is not None
    if coupled:
        damping = damping + 30.0 * blade.operator.T @ blade.operator
    superelement = ss.Superelement(blade.superelement.mass, blade.superelement.stiffness, damping)
    stuck = stuck_structure(superelement, blade.pairs, 2 * np.pi * 700.0, None)
    assert (stuck.modal_damping.ndim == 2) == coupled
    force = ss.Excitation.force(superelement.mass @ stuck.modes[:, MODE]).on(superelement, 3)
    return Balance(stuck.compliance(3), blade.pairs, force, 128), stuck


def matrix_of(stuck: StuckStructure) -> np.ndarray:
    """(n, n) modal damping."""
    return np.diag(stuck.modal_damping) if stuck.modal_damping.ndim == 1 else stuck.modal_damping


@pytest.mark.parametrize("coupled", [False, True])
def test_the_bordered_system_is_the_exact_derivative(blade: Blade, coupled: bool) -> None:
    balance, stuck = balance_of(blade, coupled)
    reference = float(stuck.circular_frequency[MODE])
    curve = ModeCurve(balance, MODE, float(matrix_of(stuck)[MODE, MODE]), reference)
    generator = np.random.default_rng(7)
    motion = np.zeros(blade.superelement.size)
    motion[:3] = 1.0, 0.2, -0.1
    start = curve.at(3e-5 * motion / np.linalg.norm(motion), 0.98 * reference, GROWTH)
    unknowns = start.unknowns + 0.05 * np.abs(start.unknowns).max() * generator.normal(size=start.unknowns.shape)
    point = curve.evaluate(unknowns, start.parameters * np.array([1.0, 1.0, 1.0, 1.1]))
    assert point.trial.contact.moves.any()
    weights = generator.normal(size=unknowns.shape) / np.abs(unknowns).max()
    plane = Plane(weights, 0.7, point.unknowns, float(point.parameters[0]))
    step = curve.linearised(point, plane).solve(point.residual, point.conditions, -0.03, 1e-10)
    small = 1e-6
    ahead, behind = (
        curve.evaluate(point.unknowns + sign * small * step.unknowns, point.parameters + sign * small * step.parameters)
        for sign in (1.0, -1.0)
    )
    residual = (ahead.residual - behind.residual) / (2 * small)
    # Newton's matrix neglects the coupling to modes far above (compliance.NEAR_RANGE).
    allowed = 2e-4 if coupled else 2e-5
    assert np.linalg.norm(residual + point.residual) < allowed * np.linalg.norm(point.residual)
    condition = (ahead.conditions - behind.conditions) / (2 * small)
    assert condition == pytest.approx(-point.conditions, rel=1e-4)
    assert (weights * step.unknowns).sum() + 0.7 * step.parameters[0] == pytest.approx(0.03, rel=1e-6)
    measured = (ahead.measured - behind.measured) / (2 * small)
    assert curve.measured_change(point, step) == pytest.approx(measured, rel=1e-4, abs=2e-5 * np.abs(measured).max())


def test_large_systems_have_the_step_of_small_ones(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without borders GMRES, or the factor of the inner matrix where it does not converge, gives the same step."""
    balance, stuck = balance_of(blade, False)
    reference = float(stuck.circular_frequency[MODE])
    curve = ModeCurve(balance, MODE, float(stuck.modal_damping[MODE]), reference)
    motion = np.zeros(blade.superelement.size)
    motion[MODE] = 5e-5
    point = curve.at(motion, 0.99 * reference, GROWTH)
    plane = Plane.fixed(point.unknowns, float(point.parameters[0]))

    def step() -> Step:
        return curve.linearised(point, plane).solve(point.residual, point.conditions, 0.01, 1e-8)

    direct = step()
    monkeypatch.setattr(reduced, "DIRECT_SIZE", 0)
    iterated = step()
    monkeypatch.setattr(reduced, "MAX_ITERATIONS", 1)
    factored, preconditioned = step(), step()
    assert np.abs(direct.parameters[1:]).min() > 0.0
    for other in (iterated, factored, preconditioned):
        assert other.parameters == pytest.approx(direct.parameters, rel=1e-4)
        size = np.linalg.norm(direct.unknowns)
        assert np.linalg.norm(other.unknowns - direct.unknowns) < 1e-4 * size


@pytest.mark.parametrize("coupled", [False, True])
def test_the_self_excited_gain_is_that_of_the_matrices(blade: Blade, coupled: bool) -> None:
    """Forces of the other modes and harmonics: the inverse of Z; the mode of the load has its stiffness alone."""
    balance, stuck = balance_of(blade, coupled)
    gain, omega = balance.excited(SelfExcitation(GROWTH, MODE)).compliance.gain, 0.97 * stuck.circular_frequency[MODE]
    assert balance.compliance.gain.growth == 0.0
    assert gain.growth == GROWTH
    force = np.random.default_rng(3).normal(size=(6, blade.superelement.size))
    answer, damping = gain.answer(omega, force), matrix_of(stuck) - GROWTH * np.eye(blade.superelement.size)
    for order in (1, 2, 3):
        x = order * omega
        matrix = np.diag(stuck.circular_frequency**2 - x**2) + 1j * x * damping
        if order == 1:
            matrix[MODE, MODE] = stuck.circular_frequency[MODE] ** 2
        cosine, sine = 2 * order - 2, 2 * order - 1
        expected = np.linalg.solve(matrix, force[cosine] - 1j * force[sine])
        assert answer[cosine] - 1j * answer[sine] == pytest.approx(expected, rel=1e-8, abs=1e-10 * abs(expected).max())
