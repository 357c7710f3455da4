"""Coriolis forces in the solver: linear and nonlinear response, adjoints, natural frequencies, and rejections."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence, rejects
from stickslip.solve.harmonic.compliance import stuck_structure

SIZE = 6
COS, SIN = np.zeros(SIZE), np.zeros(SIZE)
COS[[0, 4]], SIN[1] = (30.0, 20.0), 25.0


@pytest.fixture(scope="module")
def structure() -> Any:
    """Six unknowns, three of each of two pairs against the ground, with Coriolis forces as large as damping of 40 %."""
    random = np.random.default_rng(0)
    mass, stiffness, coriolis = (random.standard_normal((SIZE, SIZE)) for _ in range(3))
    mass = np.eye(SIZE) + 0.1 * mass @ mass.T
    stiffness = 1e5 * (np.eye(SIZE) + 0.2 * stiffness @ stiffness.T)
    return ss.Superelement(mass, stiffness, 2e-5 * stiffness + 2.0 * mass, gyroscopic=60.0 * (coriolis - coriolis.T))


def pairs_with(load: Any) -> Any:
    return ss.ContactPairs(np.eye(SIZE), 2e5, 1e5, 0.4, normal_load=load)


STUCK = np.diag(2 * [1e5, 1e5, 2e5])


def first_order(structure: Any, stiffness: Any) -> Any:
    """The matrix of ``(u, u')' = S (u, u')`` without damping."""
    forces = -np.linalg.solve(structure.mass, np.hstack([stiffness, structure.gyroscopic]))
    return np.vstack([np.eye(2 * SIZE)[SIZE:], forces])


def whirling_hz(structure: Any, stiffness: Any) -> Any:
    """All natural frequencies of the undamped structure, from its first-order form."""
    values = np.linalg.eigvals(first_order(structure, stiffness)).imag
    return np.sort(values[values > 0.0]) / (2.0 * np.pi)


@pytest.mark.long
def test_stuck_response_is_that_of_the_dynamic_stiffness(structure: Any) -> None:
    response = ss.forced_response(structure, pairs_with(1e4), COS, SIN, frequency_hz=(40.0, 90.0), harmonics=1)
    assert (response.contact_state == ss.ContactState.STUCK).all()
    for place in range(0, response.frequency_hz.size, 10):
        omega = 2.0 * np.pi * response.frequency_hz[place]
        matrix = structure.stiffness + STUCK - omega**2 * structure.mass + 1j * omega * structure.velocity_matrix
        expected = np.linalg.solve(matrix, COS - 1j * SIN)
        motion = response.displacement[place, :, 1] - 1j * response.displacement[place, :, 2]
        np.testing.assert_allclose(motion, expected, atol=1e-9 * np.abs(expected).max())
    assert response.stable is None
    assert "gyroscopic" in response.stability_message
    printed_sentence(response.stability_message)
    # Waves with and against the rotation differ, so the sign of the matrix matters.
    opposite = replace(structure, gyroscopic=-structure.gyroscopic)
    other = ss.forced_response(opposite, pairs_with(1e4), COS, SIN, frequency_hz=(40.0, 90.0), harmonics=1)
    assert abs(other.amplitude(np.eye(SIZE)[0]).max() / response.amplitude(np.eye(SIZE)[0]).max() - 1.0) > 0.1


def test_natural_frequencies_are_those_of_the_whirling_structure(structure: Any) -> None:
    response = ss.forced_response(structure, pairs_with(1e4), COS, SIN, frequency_hz=(40.0, 41.0), harmonics=1)
    stuck = whirling_hz(structure, structure.stiffness + STUCK)
    np.testing.assert_allclose(response.linear.stuck_frequency_hz, stuck, rtol=1e-10)
    np.testing.assert_allclose(
        response.linear.free_frequency_hz, whirling_hz(structure, structure.stiffness), rtol=1e-10
    )


def test_modal_damping_adds_to_coriolis_forces(structure: Any) -> None:
    undamped = replace(structure, damping=None)
    stuck = stuck_structure(undamped, pairs_with(1e4), 500.0, 0.01)
    expected = stuck.modes.T @ (stuck.damping + structure.gyroscopic) @ stuck.modes
    np.testing.assert_allclose(stuck.modal_damping, expected, atol=1e-10 * np.abs(expected).max())
    np.testing.assert_allclose(np.diag(expected), 0.02 * stuck.circular_frequency, rtol=1e-10)
    np.testing.assert_allclose(stuck.damping, stuck.damping.T, rtol=1e-12)


@pytest.mark.long
def test_slip_and_separation_are_those_of_time_integration(structure: Any) -> None:
    pairs, row = pairs_with([30.0, 20.0]), np.eye(SIZE)[0]
    response = ss.forced_response(structure, pairs, COS, SIN, frequency_hz=(60.0, 85.0), harmonics=9)
    assert response.converged
    assert set(response.contact_state.ravel()) >= {ss.ContactState.STICK_SLIP, ss.ContactState.SEPARATING}
    peak = int(response.amplitude(row).argmax())
    for place in {peak, len(response.frequency_hz) // 3}:
        start: dict[str, Any] = dict(ss.start_from_response(response, place))
        motion = ss.integrate_to_steady_state(
            structure, pairs, COS, SIN, float(response.frequency_hz[place]), 2000, tolerance=1e-8, **start
        )
        assert motion.converged
        assert response.amplitude(row)[place] == pytest.approx(motion.amplitude(row), rel=5e-4)
    dissipated = response.viscous_energy + response.dissipated_energy.sum(axis=1)
    np.testing.assert_allclose(response.input_energy, dissipated, rtol=1e-6)


def test_time_integration_conserves_energy_under_coriolis_forces_alone(structure: Any) -> None:
    # One period of a natural frequency, from a free whirling motion: it returns, and its energy does not change.
    undamped = replace(structure, damping=None)
    stiffness = structure.stiffness + STUCK
    values, vectors = np.linalg.eig(first_order(structure, stiffness))
    chosen = int(np.where(values.imag > 0.0, values.imag, np.inf).argmin())
    shape = 1e-5 * vectors[:, chosen] / np.abs(vectors[:SIZE, chosen]).max()
    motion = ss.integrate_to_steady_state(
        undamped, pairs_with(1e4), np.zeros(SIZE), np.zeros(SIZE), values[chosen].imag / (2.0 * np.pi), 2000,
        max_periods=1, initial_displacement=shape[:SIZE].real, initial_velocity=shape[SIZE:].real, spectral_radius=1.0,
    )  # fmt: skip
    energy = 0.5 * np.einsum("ti,ij,tj->t", motion.velocity, structure.mass, motion.velocity)
    energy += 0.5 * np.einsum("ti,ij,tj->t", motion.displacement, stiffness, motion.displacement)
    assert np.ptp(energy) < 1e-4 * energy.mean()
    np.testing.assert_allclose(motion.displacement[0], shape[:SIZE].real, atol=1e-3 * 1e-5)


def test_adjoints_are_those_of_a_matrix_without_symmetry(structure: Any) -> None:
    random, omega, harmonics = np.random.default_rng(1), 400.0, 3
    compliance = stuck_structure(structure, pairs_with(1e4), 500.0, None).compliance(harmonics)
    columns = np.array([0, 1, 4])
    newton = compliance.newton(omega, columns)
    deviation = random.standard_normal((2 * harmonics + 1, columns.size))
    weights = random.standard_normal((2 * harmonics + 1, SIZE))
    forward = float((weights * newton.apply(deviation)).sum())
    assert float((newton.apply_transposed(weights) * deviation).sum()) == pytest.approx(forward, rel=1e-12)
    full, modal = random.standard_normal((2 * harmonics + 1, SIZE)), random.standard_normal((2 * harmonics, SIZE))
    forward = float((modal * compliance.amplitude(omega, None, full)).sum())
    assert float((compliance.amplitude_transposed(omega, modal) * full).sum()) == pytest.approx(forward, rel=1e-11)
    for order in (1, 2, 3):  # the blocks of the Newton matrix are those of its products
        unit = np.zeros((2 * harmonics + 1, columns.size))
        unit[2 * order - 1, 1] = 1.0
        moved = newton.apply(unit)
        block = newton.block(order, np.arange(SIZE))[:, 1]
        np.testing.assert_allclose(moved[2 * order - 1] - 1j * moved[2 * order], block, atol=1e-18)


@pytest.mark.slow
def test_a_resonance_without_damping_is_that_of_the_whirling_structure(structure: Any) -> None:
    undamped = replace(structure, damping=None)
    first = whirling_hz(structure, structure.stiffness)[0]
    operator = np.zeros((3, SIZE))
    operator[0, 0] = operator[1, 1] = 1.0  # nothing changes the normal load
    pairs = ss.ContactPairs(operator, 2e5, 1e5, 0.4, normal_load=0.01)
    with rejects(ss.InputError, "modal_damping_ratio") as caught:
        ss.forced_response(undamped, pairs, COS, SIN, frequency_hz=(first - 0.5, first + 0.5))
    assert f"at {first:.3f} Hz" in str(caught.value)
    beside = ss.forced_response(undamped, pairs, COS, SIN, frequency_hz=(first + 1.0, first + 2.0), checks=False)
    assert beside.converged


@pytest.mark.slow
def test_analyses_without_coriolis_forces_reject_them(structure: Any, tmp_path: Any) -> None:
    pairs, row = pairs_with(50.0), np.eye(SIZE)[0]
    with rejects(ss.InputError, "superelement"):
        ss.nonlinear_mode(structure, pairs, 1, (1e-6, 1e-5))
    with rejects(ss.InputError, "superelement"):
        ss.quasi_static_mode(structure, pairs, 1, (1e-6, 1e-5))
    response = ss.forced_response(structure, pairs, COS, SIN, frequency_hz=(60.0, 62.0), harmonics=1, checks=False)
    with rejects(ss.InputError, "superelement"):
        ss.peak_gradients(structure, pairs, ss.Excitation.force(COS, SIN), response, row)
    with rejects(ss.InputError, "superelement"):
        ss.write_superelement(tmp_path / "any.npz", structure)
    with rejects(ss.InputError, "superelement"):
        free = replace(structure, stiffness=structure.stiffness - 1e6 * np.eye(SIZE))
        ss.forced_response(free, pairs, COS, SIN, frequency_hz=(60.0, 62.0))
    with rejects(ss.InputError, "gyroscopic"):
        replace(structure, gyroscopic=structure.mass)
    with rejects(ss.InputError, "damping"):
        replace(structure, damping=structure.velocity_matrix)
