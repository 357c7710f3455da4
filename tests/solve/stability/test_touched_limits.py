"""Where pairs touch their limits, and which disturbances exceed them."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from stickslip.solve.stability.contact_steps import linear_steps
from stickslip.solve.stability.touched_limits import TouchedLimits

SAMPLES = 64
PHASE = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES


def limits_of(preload: float, varying: float = 0.0) -> tuple[TouchedLimits, np.ndarray]:
    """A pair with k = 1 N/m and friction 0.5 moves by 0.5 m along the first direction; its limit is 0.5 (preload -
    varying cos(phase)) N. Also the sense of a slider that follows at each touch."""
    pairs = ss.ContactPairs(np.eye(3), 1.0, 1.0, 0.5, preload=preload)
    motion = np.zeros((SAMPLES, 1, 3))
    motion[:, 0, 0] = 0.5 * np.cos(PHASE)
    motion[:, 0, 2] = -varying * np.cos(PHASE)
    limits = TouchedLimits.of(linear_steps(pairs, motion), np.array([0]), np.ones((1, 3)))
    return limits, limits.sense(pairs.cycle(motion).force[:, :, :2])


def beyond(preload: float, varying: float, tangential: float, normal: float = 0.0) -> np.ndarray:
    """Changes by a constant disturbance in the sense of sliders that follow: above 0 beyond the limit."""
    limits, sense = limits_of(preload, varying)
    motion = np.array([tangential, 0.0, normal])
    return np.asarray((limits.by_end @ motion + limits.by_start @ motion) * sense)


def test_a_touch_changes_the_traction_along_its_direction_alone() -> None:
    limits, _ = limits_of(preload=1.2, varying=0.4)
    np.testing.assert_allclose(np.abs(limits.direction[:, 0]), 1.0)
    np.testing.assert_allclose(limits.by_memory @ np.array([0.0, 1.0]), 0.0, atol=1e-12)
    np.testing.assert_allclose(limits.by_memory[:, 0], -limits.direction[:, 0])


def test_touches_are_in_the_order_of_their_steps_and_sample_0_is_the_last() -> None:
    """The traction is largest at the start of the motion."""
    limits, _ = limits_of(preload=1.0 - 1e-9)
    assert limits.step[-1] == SAMPLES
    assert (np.diff(limits.step) >= 0).all()
    assert SAMPLES // 2 in limits.step


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_limit_holds_one_sign(sign: float) -> None:
    """The limit is lower on one side: the pair slides until it only touches it there, and then shakes down."""
    change = beyond(1.2, 0.4, sign)
    assert change.size
    assert (np.sign(change) == sign).all()


def test_two_limits_hold_both_signs() -> None:
    change = beyond(1.0 - 1e-9, 0.0, 1.0)
    assert (change > 0.5).any()
    assert (change < -0.5).any()


def test_a_normal_force_moves_both_limits() -> None:
    """A larger one takes both limits away."""
    assert (beyond(1.0 - 1e-9, 0.0, 0.1, 1.0) < 0.0).all()


def test_sliders_follow_only_where_they_are_chosen() -> None:
    pairs = ss.ContactPairs(np.eye(3), 1.0, 1.0, 0.5, preload=1.0 - 1e-9)
    motion = np.zeros((SAMPLES, 1, 3))
    motion[:, 0, 0] = 0.5 * np.cos(PHASE)
    steps, springs = linear_steps(pairs, motion), np.ones((1, 3))
    limits = TouchedLimits.of(steps, np.array([0]), springs)
    every = limits.changed(steps, springs, np.ones(limits.step.size, dtype=bool))
    np.testing.assert_allclose(every.keep, steps.keep, atol=1e-8)
    np.testing.assert_allclose(every.by_end, steps.by_end, atol=1e-8)
    np.testing.assert_allclose(every.by_start, steps.by_start, atol=1e-8)
    last = limits.step == SAMPLES
    one = limits.changed(steps, springs, last).keep
    np.testing.assert_allclose(one[0], steps.keep[0], atol=1e-8)
    np.testing.assert_array_equal(one[1:], np.broadcast_to(np.eye(2), one[1:].shape))
