"""The equations of a nonlinear mode: exact derivatives, also with damping that couples the modes."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from helpers import Blade
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.harmonic.gain import SelfExcitation
from stickslip.solve.harmonic.mode_curve import ModeCurve
from stickslip.solve.path.problem import Plane

MODE, GROWTH = 0, 12.0


def balance_of(blade: Blade, coupled: bool) -> tuple[Balance, float, float]:
    """A balance with the force of a mode, the frequency of this mode in rad/s, and its own damping."""
    damping = blade.superelement.damping
    if coupled:
        damping = damping + 30.0 * blade.operator.T @ blade.operator
    superelement = ss.Superelement(blade.superelement.mass, blade.superelement.stiffness, damping)
    stuck = stuck_structure(superelement, blade.pairs, 2 * np.pi * 700.0, None)
    assert (stuck.modal_damping.ndim == 2) == coupled
    force = ss.Excitation.force(superelement.mass @ stuck.modes[:, MODE]).on(superelement, 3)
    own = stuck.modal_damping[MODE] if stuck.modal_damping.ndim == 1 else stuck.modal_damping[MODE, MODE]
    return Balance(stuck.compliance(3), blade.pairs, force, 128), float(stuck.circular_frequency[MODE]), float(own)


@pytest.mark.parametrize("coupled", [False, True])
def test_the_bordered_system_is_the_exact_derivative(blade: Blade, coupled: bool) -> None:
    balance, reference, own = balance_of(blade, coupled)
    curve = ModeCurve(balance, MODE, own, reference)
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
    # Of the residual in metres: its scale is the amplitude, which changes along the step.
    sizes = ahead.modal_amplitude, behind.modal_amplitude
    residual = (sizes[0] * ahead.residual - sizes[1] * behind.residual) / (2 * small)
    wanted = point.modal_amplitude * point.residual
    assert np.linalg.norm(residual + wanted) < 5e-5 * np.linalg.norm(wanted)
    condition = (ahead.conditions - behind.conditions) / (2 * small)
    assert condition == pytest.approx(-point.conditions, rel=1e-4)
    assert (weights * step.unknowns).sum() + 0.7 * step.parameters[0] == pytest.approx(0.03, rel=1e-6)
    measured = (ahead.measured - behind.measured) / (2 * small)
    assert curve.measured_change(point, step) == pytest.approx(measured, rel=1e-4, abs=2e-5 * np.abs(measured).max())


@pytest.mark.parametrize("coupled", [False, True])
def test_the_self_excited_gain_is_that_of_the_matrices(blade: Blade, coupled: bool) -> None:
    """Forces of the other modes and harmonics: the inverse of Z; the mode of the load has its stiffness alone."""
    balance, reference, _ = balance_of(blade, coupled)
    stuck, gain = balance.compliance, balance.compliance.gain.excited(SelfExcitation(GROWTH, MODE))
    size = blade.superelement.size
    force = np.random.default_rng(3).normal(size=(6, size))
    modes = stuck_structure(
        ss.Superelement(blade.superelement.mass, blade.superelement.stiffness), blade.pairs, reference, None
    )
    assert stuck.gain.growth == 0.0
    assert gain.growth == GROWTH
    answer, omega = gain.answer(0.97 * reference, force), 0.97 * reference
    damping = np.zeros((size, size))
    for row in range(size):
        unit = np.zeros(size)
        unit[row] = 1.0
        damping[row, row] = balance.compliance.gain.viscous_form(unit)
    if coupled:
        for row in range(size):
            for column in range(row):
                pair = np.zeros(size)
                pair[[row, column]] = 1.0
                both = balance.compliance.gain.viscous_form(pair) - damping[row, row] - damping[column, column]
                damping[row, column] = damping[column, row] = 0.5 * both
    for order in (1, 2, 3):
        x = order * omega
        matrix = np.diag(modes.circular_frequency**2 - x**2).astype(complex) + 1j * x * damping
        matrix -= 1j * x * GROWTH * np.eye(size)
        if order == 1:
            matrix[MODE, MODE] = modes.circular_frequency[MODE] ** 2
        cosine, sine = 2 * order - 2, 2 * order - 1
        expected = np.linalg.solve(matrix, force[cosine] - 1j * force[sine])
        assert answer[cosine] - 1j * answer[sine] == pytest.approx(expected, rel=1e-8, abs=1e-10 * abs(expected).max())
