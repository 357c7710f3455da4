"""The estimate of the pairs that can move, against a closed form and against curves."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.cubic_spring import CubicSpring
from stickslip.core.validation import FloatArray
from stickslip.solve import moving_pairs
from stickslip.solve.moving_pairs import estimated_moving_pairs

OMEGA, STIFFNESS = 1000.0, 1e6


def joint(load: FloatArray) -> ContactPairs:
    """Pairs that one mode moves along t1 by its amplitude, with a limit of 0.5 times their load."""
    shape = np.tile([[1.0], [0.0], [0.0]], (load.size, 1))
    return ContactPairs(shape, STIFFNESS, STIFFNESS, 0.5, load)


def moving(load: list[float], force: float, ratio: float, window: tuple[float, float] = (900.0, 1100.0)) -> list[bool]:
    pairs = joint(np.array(load))
    return [
        bool(each)
        for each in estimated_moving_pairs(pairs, np.array([OMEGA]), np.array([force]), np.array([ratio]), window)
    ]


def test_without_slip_the_amplitude_is_that_of_the_damping() -> None:
    """a = f / (2 zeta w^2) = 1e-4 m for 0.2 N and 1e-3: a pair moves where k a exceeds mu N / 1.25."""
    amplitude = 0.2 / (2.0 * 1e-3 * OMEGA**2)
    slips_at = amplitude * STIFFNESS / 0.5  # N of load
    assert moving([1.3 * slips_at, 1.2 * slips_at, 1e9], 0.2, 1e-3) == [False, True, False]


def test_friction_bounds_the_amplitude() -> None:
    """pi f a = 4 mu N (a - mu N / k), so a = mu N / k / (1 - pi f / (4 mu N)) of one pair without damping: 2 mu N / k
    for a force of 2 mu N / pi. A second pair sticks there up to 1.25 times that."""
    limit = 10.0
    force = 2.0 * limit / np.pi
    amplitude = 2.0 * limit / STIFFNESS
    for share, expected in ((1.0 / 1.2, True), (1.0 / 1.3, False)):
        other = 2.0 * amplitude * STIFFNESS / share
        if expected is False:
            assert moving([2.0 * limit, other], force, 0.0) == [True, False]
        else:
            assert moving([2.0 * limit, other], force, 0.0) == [True, True]


def test_unbounded_motion_moves_all_pairs() -> None:
    """A force above 4 / pi times the slip limit, without damping."""
    assert moving([20.0, 1e3], 1e4, 0.0) == [True, True]


def test_at_least_the_pair_that_moves_first_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    assert moving([1e6, 1e7], 1e-3, 1e-2) == [True, False]
    # also where no mode is in reach of the range
    assert moving([1e6, 1e7], 1e-3, 1e-2, (10.0, 20.0)) == [True, False]
    monkeypatch.setattr(moving_pairs, "DOUBLINGS", 1)
    assert moving([1e300, 1e300], 1e-3, 1e-2) == [True, True]


def test_pairs_of_laws_without_friction_always_move() -> None:
    springs = CubicSpring(np.full((1, 3), STIFFNESS), np.zeros((1, 3)))
    friction = joint(np.array([1e6, 1e7]))
    pairs = ContactPairs.with_laws(np.tile([[1.0], [0.0], [0.0]], (3, 1)), [friction.coulomb, springs])
    found = estimated_moving_pairs(pairs, np.array([OMEGA]), np.array([1e-3]), np.array([1e-2]), (900.0, 1100.0))
    assert found.tolist() == [True, False, True]
