"""A stuck pair that touches its limit holds a disturbance towards it alone: one away from it may grow."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

import stickslip as ss

OUTER = np.array(
    [[137762.0, 4564.6, 67126.4], [4564.6, 207932.0, 12757.1], [67126.4, 12757.1, 133081.0]]
)  # N/m, of the first mass to the ground
INNER = np.array(
    [[232139.5, -35274.75, 142691.03], [-35274.75, 374123.2, -18450.15], [142691.03, -18450.15, 192535.6]]
)  # N/m, between the masses
DIRECTIONS = np.array(
    [
        [-0.27771, 0.78255, -0.55723], [-0.65109, -0.57982, -0.48979], [-0.70637, 0.22679, 0.67052],
        [-0.08994, -0.87931, 0.46767], [0.90119, 0.12806, 0.41407], [-0.42399, 0.4587, 0.78091],
        [-0.32603, -0.92291, -0.2048], [0.84388, -0.18648, -0.50308], [0.42611, -0.33685, 0.83962],
    ]
)  # fmt: skip
FORCE = np.array([-0.89852, -1.00989, -0.89258, -1.7101, 0.26789, 1.40774])


def two_masses() -> tuple[ss.Superelement, ss.ContactPairs]:
    """Two masses in a chain, the second one on three pairs, of which one has a gap."""
    mass = np.diag([0.99292] * 3 + [1.50475] * 3)
    stiffness = np.block([[OUTER + INNER, -INNER], [-INNER, INNER]])
    squares, modes = scipy.linalg.eigh(stiffness, mass)
    damping = mass @ (modes * (2.0 * 0.0079150 * np.sqrt(squares))) @ modes.T @ mass
    operator = np.hstack([np.zeros((9, 3)), DIRECTIONS])
    pairs = ss.ContactPairs(operator, 19516.44, 14248.57, 0.39633, preload=np.array([-5.71179, 18.09305, 20.76924]))
    return ss.Superelement(mass, stiffness, 0.5 * (damping + damping.T)), pairs


@pytest.fixture(scope="module")
def response() -> ss.ForcedResponse:
    superelement, pairs = two_masses()
    response = ss.forced_response(superelement, pairs, FORCE, frequency_hz=(29.0, 33.0), harmonics=11, samples=512)
    assert response.converged, response.message
    return response


def growth_of_a_disturbance(response: ss.ForcedResponse, point: int) -> float:
    """Growth in a period with which time integration leaves a point."""
    superelement, pairs = two_masses()
    motion = ss.integrate_to_steady_state(
        superelement, pairs, FORCE, 0.0 * FORCE, float(response.frequency_hz[point]), steps_per_period=500,
        max_periods=150, **ss.start_from_response(response, point),
    )  # fmt: skip
    return float((motion.period_change[90] / motion.period_change[60]) ** (1.0 / 30.0))


@pytest.mark.slow
def test_a_point_that_a_disturbance_away_from_the_limit_leaves_is_unstable(response: ss.ForcedResponse) -> None:
    """Multipliers with a slider that follows are 0.977."""
    assert response.stable is not None
    assert response.doubtful is not None
    assert response.multipliers is not None
    touching = (response.frequency_hz > 31.53) & (response.frequency_hz < 31.65)
    touching &= (response.contact_state[:, 1:] == ss.ContactState.STUCK).all(axis=1)
    assert touching.sum() >= 5
    assert not response.stable[touching].any()
    assert not response.doubtful[touching].any()
    points = np.flatnonzero(touching)
    point = int(points[np.abs(response.frequency_hz[points] - 31.536).argmin()])
    assert growth_of_a_disturbance(response, point) == pytest.approx(
        float(response.multipliers[point, 0].real), abs=0.01
    )


@pytest.mark.slow
def test_a_point_with_slip_smaller_than_a_disturbance_is_doubtful(response: ss.ForcedResponse) -> None:
    """The third pair slips by 3e-5 of its motion; the slip holds disturbances that are smaller."""
    assert response.stable is not None
    assert response.doubtful is not None
    before = (response.frequency_hz > 31.5302) & (response.frequency_hz < 31.5308)
    before &= response.contact_state[:, 2] == ss.ContactState.STICK_SLIP
    points = np.flatnonzero(before & response.stable)
    assert points.size >= 2
    assert response.doubtful[points].all()
    assert "may grow" in response.stability_message
    assert growth_of_a_disturbance(response, int(points[-1])) > 1.03


@pytest.mark.slow
def test_a_motion_with_a_period_doubling_of_pairs_that_stick_is_unstable() -> None:
    """A mass between a stop and a pair that touches its limit: the slider that follows has -0.988, the one that sticks
    -1.072, and time integration ends in a motion of twice the period. (The other directions move nothing.)"""
    square = (2.0 * np.pi * 10.0) ** 2
    superelement = ss.Superelement(
        np.eye(3), np.diag([1.0, 400.0, 400.0]) * square, np.diag([0.02, 0.4, 0.4]) * np.sqrt(square)
    )
    operator = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    tangential = np.array([[1e-6, 1e-6], [1.0, 1.0]]) * square
    preload = np.array([-0.15, 2.0 * 0.1634797402172416]) * square
    pairs = ss.ContactPairs(operator, np.array([3.0, 1e-3]) * square, tangential, [1e-6, 0.5], preload)
    force = np.array([square, 0.0, 0.0])
    response = ss.forced_response(
        superelement, pairs, force, frequency_hz=(29.372121957526513, 29.4), harmonics=15, samples=512
    )
    assert response.stable is not None
    assert response.doubtful is not None
    assert response.multipliers is not None
    assert response.contact_state[0].tolist() == [ss.ContactState.SEPARATING, ss.ContactState.STUCK]
    assert response.multipliers[0, 0].real == pytest.approx(-1.072, abs=2e-3)
    assert not response.stable[0]
    assert response.doubtful[0]
    start = ss.start_from_response(response, 0)
    start["initial_displacement"] = 1.01 * start["initial_displacement"]
    motion = ss.integrate_to_steady_state(
        superelement, pairs, force, 0.0 * force, float(response.frequency_hz[0]), steps_per_period=500,
        max_periods=150, **start,
    )  # fmt: skip
    assert motion.period_change[-1] > 0.5
