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


@pytest.mark.slow
def test_points_that_a_disturbance_to_one_side_leaves_are_doubtful() -> None:
    """Multipliers with a slider that follows are 0.977; time integration leaves these points by 5 % in a period."""
    superelement, pairs = two_masses()
    response = ss.forced_response(superelement, pairs, FORCE, frequency_hz=(29.0, 33.0), harmonics=11, samples=512)
    assert response.converged, response.message
    assert response.stable is not None
    touching = (response.frequency_hz > 31.53) & (response.frequency_hz < 31.65)
    touching &= (response.contact_state[:, 1:] == ss.ContactState.STUCK).all(axis=1)
    touching &= response.stable
    assert touching.sum() >= 2
    assert response.doubtful is not None
    assert response.doubtful[touching].all()
    assert "may grow" in response.stability_message
    point = int(np.flatnonzero(touching)[0])
    motion = ss.integrate_to_steady_state(
        superelement, pairs, FORCE, 0.0 * FORCE, float(response.frequency_hz[point]), steps_per_period=500,
        max_periods=150, **ss.start_from_response(response, point),
    )  # fmt: skip
    growth = (motion.period_change[90] / motion.period_change[60]) ** (1.0 / 30.0)
    assert growth == pytest.approx(1.057, abs=0.01)
