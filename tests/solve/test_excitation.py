"""Excitations: closed forms of one mass, base motion against absolute coordinates, sums, refusals."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from sentences import rejects

MASS, STIFFNESS, DASHPOT = 2.0, 5e5, 40.0
ROW = np.array([1.0, 0.0, 0.0])


def receptance(omega: np.ndarray) -> np.ndarray:
    """u / p of the mass with its contact stuck, complex amplitudes c - i s."""
    return np.asarray(1.0 / (STIFFNESS + 1e5 - omega**2 * MASS + 1j * omega * DASHPOT))


def response_to(excitation: ss.Excitation, harmonics: int = 1) -> ss.ForcedResponse:
    """Three uncoupled directions of one mass; the contact adds 1e5 N/m along t1 and never slips."""
    structure = ss.Superelement(MASS * np.eye(3), STIFFNESS * np.eye(3), DASHPOT * np.eye(3))
    pairs = ss.ContactPairs(np.eye(3), 1e5, 1e5, 0.3, 1e9)
    return ss.forced_response(structure, pairs, excitation, frequency_hz=(60.0, 110.0), harmonics=harmonics, samples=64)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("excitation", "force"),
    [
        (ss.Excitation.force(3.0 * ROW), lambda omega: 3.0),
        (ss.Excitation.force(0.0 * ROW, 3.0 * ROW), lambda omega: -3.0j),
        (ss.Excitation.base_motion(ROW, 9.81), lambda omega: -MASS * 9.81),
        (ss.Excitation.base_motion(ROW, 1e-3, kind="displacement"), lambda omega: MASS * omega**2 * 1e-3),
        (ss.Excitation.unbalance(ROW, [0.0, 1.0, 0.0], 1e-4), lambda omega: 1e-4 * omega**2),
        (
            ss.Excitation.force(3.0 * ROW) + ss.Excitation.unbalance(ROW, [0.0, 1.0, 0.0], 1e-4),
            lambda omega: 3.0 + 1e-4 * omega**2,
        ),
    ],
)
def test_closed_form_of_one_mass(excitation: ss.Excitation, force: object) -> None:
    response = response_to(excitation)
    assert response.converged, response.message
    omega = 2 * np.pi * response.frequency_hz
    expected = receptance(omega) * force(omega)  # type: ignore[operator]
    _, cosine, sine = response.coefficients(ROW).T
    assert cosine - 1j * sine == pytest.approx(expected, rel=1e-8)
    assert response.residual.max() < 1e-9
    linear = 2 * np.pi * response.linear.frequency_hz
    limit = np.einsum("pic,i->pc", response.linear.stuck, ROW)
    expected = receptance(linear) * force(linear)  # type: ignore[operator]
    assert limit[:, 1] - 1j * limit[:, 2] == pytest.approx(expected, rel=1e-8)


def test_base_motion_equals_absolute_coordinates() -> None:
    """Two masses in a row on a moving support that a very heavy third mass moves: relative against absolute motion."""
    chain = 1e5 * np.array([[2.0, -1.0], [-1.0, 1.0]])
    mass = np.diag([1.0, 1.5])
    omega, acceleration = 2 * np.pi * 37.0, 4.0
    relative = np.linalg.solve(chain - omega**2 * mass, -mass @ np.ones(2) * acceleration)
    base = -acceleration / omega**2
    # Absolute: K_bb u - w^2 M u = k_base * u_base.
    absolute = np.linalg.solve(chain - omega**2 * mass, np.array([1e5 * base, 0.0]))
    assert absolute - base == pytest.approx(relative)
    force = ss.Excitation.base_motion([1.0, 1.0], acceleration).on(ss.Superelement(mass, chain), 1)
    assert force.coefficients(omega)[1] == pytest.approx(-mass @ np.ones(2) * acceleration)


def test_an_unbalance_turns() -> None:
    structure = ss.Superelement(np.eye(3), np.eye(3))
    force = ss.Excitation.unbalance(ROW, [0.0, 1.0, 0.0], 2.0).on(structure, 3)
    coefficients = force.coefficients(5.0)
    assert coefficients[1] == pytest.approx([50.0, 0.0, 0.0])
    assert coefficients[2] == pytest.approx([0.0, 50.0, 0.0])
    assert not coefficients[3:].any()
    assert force.slope(5.0) == pytest.approx(2.0 * coefficients / 5.0)
    assert not force.is_constant


@pytest.mark.slow
def test_several_harmonics_excite_their_own() -> None:
    cos = np.zeros((3, 2))
    cos[0] = [3.0, 1.0]
    response = response_to(ss.Excitation.force(cos), harmonics=2)
    omega = 2 * np.pi * response.frequency_hz
    assert response.harmonic_amplitude(ROW, 2) == pytest.approx(np.abs(receptance(2 * omega)), rel=1e-8)


@pytest.mark.slow
def test_words_and_arrays_as_before() -> None:
    both = ss.Excitation.force(ROW) + ss.Excitation.base_motion(ROW, 9.81)
    assert repr(both) == "Excitation(harmonic force and base acceleration of 9.81 m/s2; 3 unknowns)"
    old, new = (
        ss.forced_response(
            ss.Superelement(np.eye(3), 1e5 * np.eye(3), np.eye(3)),
            ss.ContactPairs(np.eye(3), 1e5, 1e5, 0.3, 1e9),
            *force,
            frequency_hz=(60.0, 70.0),
            harmonics=1,
            samples=64,
        )
        for force in ((ROW, 2 * ROW), (ss.Excitation.force(ROW, 2 * ROW),))
    )
    assert np.array_equal(old.displacement, new.displacement)
    assert new.settings["excitation"] == "harmonic force"


@pytest.mark.parametrize(
    ("make", "keys"),
    [
        (lambda: ss.Excitation.base_motion(ROW, -1.0), ("amplitude",)),
        (lambda: ss.Excitation.base_motion(ROW, 1.0, kind="jerk"), ("kind",)),  # type: ignore[arg-type]
        (lambda: ss.Excitation.base_motion(np.ones((3, 2)), 1.0), ("direction",)),
        (
            lambda: ss.Excitation.unbalance(ROW, [1.0], 1.0),
            ("first", "second"),
        ),
        (lambda: ss.Excitation.unbalance(ROW, ROW, 0.0), ("mass_times_radius",)),
        (lambda: ss.Excitation.force([[[1.0]]]), ("cos",)),
        (lambda: ss.Excitation.force(ROW, [1.0]), ("sin",)),
        (lambda: response_to(ss.Excitation.force([1.0])), ("excitation",)),
        (lambda: response_to(ss.Excitation.force(np.ones((3, 2)))), ("excitation",)),
        (lambda: response_to(ss.Excitation.force(0.0 * ROW)), ("excitation",)),
    ],
)
def test_what_is_no_excitation_is_rejected(make: object, keys: tuple[str, ...]) -> None:
    with rejects(ss.InputError, *keys):
        make()  # type: ignore[operator]
