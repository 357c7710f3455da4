"""Which disturbances a touched friction limit holds."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from stickslip.solve.stability.contact_steps import linear_steps
from stickslip.solve.stability.touched_limits import TouchedLimits

SAMPLES = 64
PHASE = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES


def limits_of(preload: float, varying: float = 0.0) -> TouchedLimits:
    """A pair with k = 1 N/m and friction 0.5 moves by 0.5 m along the first direction; its limit is 0.5 (preload -
    varying cos(phase)) N."""
    pairs = ss.ContactPairs(np.eye(3), 1.0, 1.0, 0.5, preload=preload)
    motion = np.zeros((SAMPLES, 1, 3))
    motion[:, 0, 0] = 0.5 * np.cos(PHASE)
    motion[:, 0, 2] = -varying * np.cos(PHASE)
    return TouchedLimits.of(pairs, pairs.cycle(motion), linear_steps(pairs, motion), np.array([0]))


def motion_of(limits: TouchedLimits, tangential: float, normal: float = 0.0) -> np.ndarray:
    """A constant disturbance."""
    motion = np.zeros((limits.samples.size, 1, 3, 1))
    motion[:, 0, 0], motion[:, 0, 2] = tangential, normal
    return motion


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_limit_holds_one_sign(sign: float) -> None:
    """The limit is lower on one side: the pair slides until it only touches it there, and then shakes down."""
    limits = limits_of(preload=1.2, varying=0.4)
    assert (limits.traction[:, 0] > 0.0).all()
    assert limits.traction.size
    assert limits.is_left_by(motion_of(limits, sign), np.ones(1)).tolist() == [True]


def test_two_limits_hold_both_signs() -> None:
    limits = limits_of(preload=1.0 - 1e-9)
    assert (limits.traction[:, 0] > 0.0).any()
    assert (limits.traction[:, 0] < 0.0).any()
    assert limits.is_left_by(motion_of(limits, 1.0), np.ones(1)).tolist() == [False]


def test_a_normal_force_moves_both_limits() -> None:
    """Towards the pair both limits go away; with the other sign both come."""
    limits = limits_of(preload=1.0 - 1e-9)
    assert limits.is_left_by(motion_of(limits, 0.1, 1.0), np.ones(1)).tolist() == [True]


def test_a_disturbance_that_grows_is_smaller_at_the_start() -> None:
    """The step at sample 0 ends the period: the disturbance at its start belongs to the same period."""
    limits = limits_of(preload=1.2, varying=0.4)
    assert (limits.here == limits.samples.size - 1).any()
    assert limits.is_left_by(motion_of(limits, -1.0), np.array([1.05])).tolist() == [True]
