"""Neutral disturbances: all of them leave the march, and nothing else does."""

from __future__ import annotations

import numpy as np

import stickslip as ss
from periods import marched
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.stability.march import Period
from stickslip.solve.stability.model import StabilityModel, stability_model
from stickslip.solve.stability.neutral import Neutral, neutral_disturbances

SAMPLES, OMEGA = 64, 1.0
SPRINGS = np.array([[4.0, 4.0, 9.0], [3.0, 3.0, 8.0]])  # t1, t2, n of both pairs, N/m


def model_of_a_free_body() -> StabilityModel:
    """A mass that two pairs connect to a spring on the wall each, so stiff that they are far modes."""
    size = 9  # the mass, then the ends of both springs: x, y, z each
    stiffness = np.diag([0.0, 0.0, 0.0, *(6 * [3e4])])
    operator = np.zeros((6, size))
    for pair in range(2):
        operator[3 * pair : 3 * pair + 3, :3] = np.eye(3)
        operator[3 * pair : 3 * pair + 3, 3 + 3 * pair : 6 + 3 * pair] = -np.eye(3)
    structure = ss.Superelement(np.diag([1.0, 1.0, 1.0, *(6 * [0.1])]), stiffness, 0.05 * np.eye(size))
    pairs = ss.ContactPairs(operator, SPRINGS[:, 2], SPRINGS[:, :2], 0.3, normal_load=1.0)
    moves = np.tile([True, True, False], (2, 1))
    return stability_model(stuck_structure(structure, pairs, OMEGA, None), 3, moves, np.zeros((2, 3)))


def steps_with(touches: list[tuple[int, int, tuple[float, float]]], slides: bool = False) -> LinearSteps:
    """Both pairs stick; at a touch (pair, sample, direction) one loses what is along the direction. If it ``slides``,
    pair 0 slips through the period and remembers nothing."""
    keep = np.tile(np.eye(2), (SAMPLES, 2, 1, 1))
    if slides:
        keep[:, 0] = 0.0
    for pair, sample, direction in touches:
        keep[sample, pair] -= np.outer(direction, direction)
    by_end = np.zeros((SAMPLES, 2, 2, 3))
    by_end[..., :2] = keep * SPRINGS[:, None, :2]
    return LinearSteps(keep, by_end, -by_end, np.tile(SPRINGS[:, 2], (SAMPLES, 1)))


def both(steps: LinearSteps) -> tuple[np.ndarray, np.ndarray, Neutral]:
    """Multipliers with and without the neutral disturbances, and these."""
    model, moving = model_of_a_free_body(), np.arange(2)
    period = Period(model, steps, moving, OMEGA)
    scale = period.scale(model, OMEGA)
    neutral = neutral_disturbances(model, steps, moving, np.zeros(2, dtype=bool), OMEGA, scale)
    march = marched(period, np.diag(scale)) / scale[:, None]
    return (
        np.linalg.eigvals(march),
        np.linalg.eigvals(neutral.after(march @ neutral.before(np.eye(scale.size)))),
        neutral,
    )


def check_that_only_ones_leave(every: np.ndarray, others: np.ndarray, count: int) -> None:
    """``others`` are ``every`` with zeros in place of ``count`` ones, and contain no one."""
    assert (np.abs(every - 1.0) < 1e-6).sum() == count
    assert np.abs(others - 1.0).min() > 1e-3
    large = np.sort_complex(np.round(every[(np.abs(every) > 0.05) & (np.abs(every - 1.0) > 1e-6)], 6))
    np.testing.assert_allclose(np.sort_complex(np.round(others[np.abs(others) > 0.05], 6)), large, atol=2e-6)


def test_a_pair_that_touches_its_limit_in_one_direction_conserves_the_other() -> None:
    steps = steps_with([(0, 10, (0.6, 0.8)), (1, 20, (1.0, 0.0)), (1, 40, (0.0, 1.0))])
    every, others, neutral = both(steps)
    # Pair 1 touches in both directions. The body moves with its sliders along t1 and t2, along one of them with what
    # pair 0 conserves.
    assert (neutral.conserved.shape[1], neutral.free.shape[1]) == (1, 1)
    check_that_only_ones_leave(every, others, 2)


def test_what_a_free_body_takes_along_counts_once() -> None:
    steps = steps_with([(0, 10, (0.6, 0.8)), (1, 20, (0.6, 0.8))])
    every, others, neutral = both(steps)
    # Along the common direction nothing is conserved; across it both tractions are, and the body moves with both.
    assert (neutral.conserved.shape[1], neutral.free.shape[1]) == (2, 1)
    check_that_only_ones_leave(every, others, 3)


def test_a_body_drifts_over_flexible_faces_and_pairs_without_memory() -> None:
    """Far modes follow the drift without force, and a pair that slips through the period resists nothing: high 10 of
    the torture set kept a multiplier of 1 for both reasons."""
    touches = [(1, 20, (1.0, 0.0)), (1, 40, (0.0, 1.0))]
    every, others, neutral = both(steps_with(touches, slides=True))
    assert (neutral.conserved.shape[1], neutral.free.shape[1]) == (0, 2)
    check_that_only_ones_leave(every, others, 2)


def test_a_pair_that_sticks_supports_the_body() -> None:
    steps = steps_with([(0, 10, (1.0, 0.0)), (0, 30, (0.0, 1.0))])
    model = model_of_a_free_body()
    alone = LinearSteps(steps.keep[:, :1], steps.by_end[:, :1], steps.by_start[:, :1], steps.normal[:, :1])
    scale = Period(model, alone, np.array([0]), OMEGA).scale(model, OMEGA)
    neutral = neutral_disturbances(model, alone, np.array([0]), np.zeros(1, dtype=bool), OMEGA, scale)
    assert (neutral.conserved.shape[1], neutral.free.shape[1]) == (0, 0)
