"""A stuck pair that nearly touches a second limit: where it slips the curve turns, and no multiplier passes 1."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

import stickslip as ss

# Three masses in a chain on four pairs, of which one has a gap: a random problem of a reviewer.
INNER = np.array(
    [[160726.113115, -29660.716424, -68952.330917], [-29660.716424, 191901.499084, -43411.00216],
     [-68952.330917, -43411.00216, 139917.887372]]
)  # fmt: skip
MIDDLE = np.array(
    [[111440.285008, 96720.598602, -18212.364578], [96720.598602, 479325.532589, -76317.292839],
     [-18212.364578, -76317.292839, 73774.472196]]
)  # fmt: skip
OUTER = np.array(
    [[345854.430521, -16722.918462, -51772.891294], [-16722.918462, 73583.745791, 55487.899211],
     [-51772.891294, 55487.899211, 285439.72704]]
)  # fmt: skip
DIRECTIONS = np.array(
    [
        [[-0.514477, 0.112774, 0.850056], [0.019058, -0.989566, 0.142817], [0.857292, 0.089677, 0.50696]],
        [[-0.557787, -0.786946, 0.263798], [0.680572, -0.615584, -0.397339], [0.475074, -0.042097, 0.878938]],
        [[-0.076996, 0.744181, 0.663525], [-0.917969, -0.312635, 0.244115], [0.389107, -0.5903, 0.707207]],
        [[-0.922961, -0.111025, 0.368534], [-0.218198, -0.63784, -0.738613], [0.31707, -0.762124, 0.564476]],
    ]
)
MASS_OF_PAIR = [1, 2, 0, 2]
FORCE = np.array([-1.222653, 0.011557, 0.772436, 1.975991, 1.319757, 0.386532, 0.987776, -0.118645, -0.855783])


def three_masses() -> tuple[ss.Superelement, ss.ContactPairs]:
    mass = np.diag(np.repeat([1.420292, 1.98053, 0.953101], 3))
    zero = np.zeros((3, 3))
    stiffness = np.block(
        [[OUTER + MIDDLE, -MIDDLE, zero], [-MIDDLE, MIDDLE + INNER, -INNER], [zero, -INNER, INNER]]
    )  # fmt: skip
    squares, modes = scipy.linalg.eigh(stiffness, mass)
    damping = mass @ (modes * (2.0 * 0.00566426 * np.sqrt(squares))) @ modes.T @ mass
    operator = np.zeros((4, 3, 9))
    for pair, place in enumerate(MASS_OF_PAIR):
        operator[pair, :, 3 * place : 3 * place + 3] = DIRECTIONS[pair]
    tangential = np.array([78940.928, 51538.0609, 79561.9581, 36337.0963])
    pairs = ss.ContactPairs(
        operator.reshape(12, 9), np.array([61842.024, 53420.8574, 135138.8555, 101084.1293]),
        np.column_stack([tangential, tangential]), np.array([0.720783, 0.565014, 0.509273, 0.623788]),
        preload=np.array([-12.378827, 5.091871, 3.3602, 6.799753]),
    )  # fmt: skip
    return ss.Superelement(mass, stiffness, 0.5 * (damping + damping.T)), pairs


@pytest.mark.slow
def test_points_before_a_second_limit_are_in_doubt() -> None:
    """Their multipliers are 0.956 +- 0.105i, and time integration leaves them by 1.083 in a period, as it does the
    points beyond with 1.09."""
    superelement, pairs = three_masses()
    response = ss.forced_response(superelement, pairs, FORCE, frequency_hz=(32.57, 32.597), harmonics=15, samples=512)
    assert response.stable is not None
    assert response.doubtful is not None
    rise = np.diff(response.frequency_hz)
    turn = int(np.flatnonzero((rise[1:] < 0.0) & (rise[:-1] > 0.0))[0]) + 1
    unstable = int(np.flatnonzero(~response.stable)[0])
    assert unstable > turn + 5
    assert response.stable[turn:unstable].all()
    assert response.doubtful[turn - 3 : unstable].all()
    assert not response.doubtful[:3].any()
    point = (turn + unstable) // 2
    motion = ss.integrate_to_steady_state(
        superelement, pairs, FORCE, 0.0 * FORCE, float(response.frequency_hz[point]), steps_per_period=1000,
        max_periods=60, **ss.start_from_response(response, point),
    )  # fmt: skip
    growth = float((motion.period_change[40] / motion.period_change[20]) ** 0.05)
    assert growth == pytest.approx(1.09, abs=0.02)
