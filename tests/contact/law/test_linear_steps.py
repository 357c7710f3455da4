"""The linear steps of a law against its own steps, along a periodic motion with slip, stick and lift-off."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss

SAMPLES = 64
ANGLE = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES


def coulomb(springs: list[float], load: float) -> ss.CoulombLaw:
    return ss.CoulombLaw(
        np.array([3.0]), np.array([springs]), np.array([0.4]), np.array([load]), np.zeros(1), np.zeros((1, 2))
    )


LAWS = {
    "coulomb that opens": coulomb([2.0, 2.0], 1.0),
    "coulomb that stays closed": coulomb([2.0, 2.0], 2.5),
    "coulomb, unequal springs": coulomb([2.0, 1.2], 1.0),
    "exponential": ss.ExponentialContact(
        np.array([3.0]), np.array([[2.0, 2.0]]), np.array([0.4]), np.array([2.0]), np.zeros((1, 2))
    ),
    "jenkins": ss.JenkinsElement(
        np.array([[2.0, 1.0]]), np.array([[0.5, 0.4]]), np.array([1.0]), residual_traction=np.zeros((1, 2))
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_a_small_disturbance_changes_the_force_as_the_steps_say(law: Any) -> None:
    motion = np.stack([np.cos(ANGLE) + 0.2, 0.7 * np.sin(ANGLE), 0.5 * np.cos(2.0 * ANGLE + 0.4)], axis=1)[:, None]
    disturbance = 1e-7 * np.random.default_rng(3).standard_normal(motion.shape)
    disturbance[-1] = 0.0
    memory = law.memory_at_rest()
    for displacement in np.concatenate([motion] * 3):
        memory = law.step(displacement, memory).memory
    steps, disturbed, change = law.linear_steps(motion), memory, np.zeros((1, 2))
    for j in range(SAMPLES):
        plain, other = law.step(motion[j], memory), law.step(motion[j] + disturbance[j], disturbed)
        memory, disturbed = plain.memory, other.memory
        change = np.einsum("pab,pb->pa", steps.keep[j], change)
        change += np.einsum("pab,pb->pa", steps.by_end[j], disturbance[j])
        change += np.einsum("pab,pb->pa", steps.by_start[j], disturbance[j - 1])
        np.testing.assert_allclose((other.force - plain.force)[:, :2], change, atol=1e-11)


def test_a_spring_that_lifts_off_acts_as_long_as_it_is_closed() -> None:
    law = coulomb([2.0, 2.0], 1.0)
    motion = np.zeros((SAMPLES, 1, 3))
    motion[:, 0, 2] = np.cos(ANGLE)
    closed = 1.0 - np.arccos(1.0 / 3.0) / np.pi  # of the period, 1 + 3 cos > 0
    assert law.linear_steps(motion).normal.mean() / 3.0 == pytest.approx(closed, abs=1e-3)


def test_a_stop_acts_as_long_as_it_is_hit() -> None:
    law = ss.ElasticStop(np.array([5.0]), np.array([0.4]))
    motion = np.zeros((SAMPLES, 1, 3))
    motion[:, 0, 2] = np.cos(ANGLE)
    hit = np.arccos(0.4) / np.pi
    assert law.linear_steps(motion).normal.mean() / 5.0 == pytest.approx(hit, abs=2e-3)
