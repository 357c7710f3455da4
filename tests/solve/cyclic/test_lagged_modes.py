"""The complex compliance of a sector against the inverse of its dynamic stiffness."""

from typing import Any

import numpy as np
import pytest

from sectors import SmallDisk
from stickslip.solve.cyclic.balances import sector_balances
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.gain import CoupledGain, DiagonalGain, to_complex

OMEGA, HARMONICS = 500.0, 4


@pytest.fixture(
    params=[(None, False), (0.02, False), (None, True), (0.02, True)],
    ids=["matrix", "ratio", "matrix and Coriolis", "ratio and Coriolis"],
)
def stuck(request: Any) -> Any:
    ratio, whirls = request.param
    disk = SmallDisk.of(6, damped=ratio is None, whirls=whirls)
    wave = Excitation.travelling_wave(1, disk.force_cos, disk.force_sin)
    return sector_balances(
        disk.sector, disk.pairs, wave, OMEGA, HARMONICS, HARMONICS, 64, ratio, "tractrix", lambda words: None
    ).stuck


def dynamic_stiffness(stuck: Any, order: Any) -> Any:
    """``Z_h`` with all springs of the pairs, and ``B_h``."""
    part = stuck.of_order(order)
    springs = part.operator.conj().T @ (stuck.pairs.resting_stiffness()[:, None] * part.operator)
    x = order * OMEGA
    return part.stiffness + springs - x**2 * part.mass + 1j * x * part.velocity_matrix, part.operator


@pytest.mark.parametrize("near_range", [np.inf, 0.3])
def test_amplitudes_are_those_of_the_dynamic_stiffness(stuck: Any, near_range: Any) -> None:
    random = np.random.default_rng(0)
    compliance = stuck.compliance(HARMONICS, near_range)
    deviation, force = random.standard_normal((9, 6)), random.standard_normal((9, 9))
    amplitude = compliance.amplitude(OMEGA, compliance.external(force), deviation)
    motion = to_complex(compliance.displacement(amplitude, deviation)[1:])
    relative = to_complex(compliance.relative(amplitude, deviation)[1:])
    for order in range(1, HARMONICS + 1):
        stiffness, operator = dynamic_stiffness(stuck, order)
        load = to_complex(force[1:])[order - 1] - operator.conj().T @ to_complex(deviation[1:])[order - 1]
        expected = np.linalg.solve(stiffness, load)
        np.testing.assert_allclose(motion[order - 1], expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())
        np.testing.assert_allclose(relative[order - 1], operator @ expected, rtol=1e-9, atol=1e-16)
    step = 1e-3
    ahead, behind = (
        compliance.gain.answer(OMEGA + each, -compliance._modes.of_contact(deviation[1:])) for each in (step, -step)
    )
    here = compliance.gain.answer(OMEGA, -compliance._modes.of_contact(deviation[1:]))
    slope = compliance.gain.slope(OMEGA, here)
    np.testing.assert_allclose(slope, (ahead - behind) / (2.0 * step), rtol=1e-5, atol=1e-6 * np.abs(slope).max())


def test_newton_operator(stuck: Any) -> None:
    random = np.random.default_rng(1)
    columns = np.array([0, 2, 5])
    newton = stuck.compliance(HARMONICS, near_range=np.inf).newton(OMEGA, columns)
    deviation, weights = random.standard_normal((9, 3)), random.standard_normal((9, 6))
    applied = newton.apply(deviation)
    assert np.vdot(weights, applied) == pytest.approx(np.vdot(newton.apply_transposed(weights), deviation), rel=1e-10)
    for order in range(1, HARMONICS + 1):
        stiffness, operator = dynamic_stiffness(stuck, order)
        exact = operator @ np.linalg.solve(stiffness, operator.conj().T)
        rows = np.array([1, 2, 4])
        np.testing.assert_allclose(newton.block(order, rows), exact[np.ix_(rows, columns)], rtol=1e-8)
        expected = exact[:, columns] @ to_complex(deviation[1:])[order - 1]
        np.testing.assert_allclose(to_complex(applied[1:])[order - 1], expected, rtol=1e-8)


def test_far_modes_are_springs_in_newtons_matrix(stuck: Any) -> None:
    newton = stuck.compliance(1, near_range=1.3).newton(OMEGA, np.arange(6))
    part = stuck.of_order(1)
    near = int(np.searchsorted(part.circular_frequency, 1.3 * OMEGA))
    gain = 1.0 / part.circular_frequency**2
    far = (part.contact_modes[:, near:] * gain[near:]) @ part.contact_modes[:, near:].conj().T
    np.testing.assert_allclose(newton.parts[0].far, far, rtol=1e-10)
    assert 0 < near < len(gain)


def test_each_harmonic_has_its_own_gain(stuck: Any) -> None:
    compliance = stuck.compliance(HARMONICS)
    whirls = stuck.of_order(1).gyroscopic is not None
    expected = DiagonalGain if stuck.modal_damping_ratio and not whirls else CoupledGain
    assert isinstance(compliance.gain, expected)
    amplitude = np.random.default_rng(2).standard_normal((3, 2 * HARMONICS, 9))
    power = compliance.gain.viscous_power(amplitude)
    for order in range(1, HARMONICS + 1):
        part = stuck.of_order(order)
        motion = (amplitude[:, 2 * order - 2] - 1j * amplitude[:, 2 * order - 1]) @ part.modes.T
        exact = np.einsum("pi,ij,pj->p", motion.conj(), part.damping, motion).real
        np.testing.assert_allclose(power[:, order - 1], exact, rtol=1e-9)
