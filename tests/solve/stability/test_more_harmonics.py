"""A verdict that more harmonics do not confirm is doubtful; few points are checked, and the limits are exact."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

import stickslip as ss
from helpers import benchmark_module
from sentences import printed_sentence
from stickslip.solve.stability.more_harmonics import FIRST_POINTS, unconfirmed_points


class Checks:
    """Confirms all points but some, and counts what was asked."""

    def __init__(self, wrong: set[int]) -> None:
        self.wrong, self.asked = wrong, list[int]()

    def __call__(self, points: Sequence[int]) -> list[bool]:
        self.asked += points
        return [point not in self.wrong for point in points]


def test_the_limits_of_a_doubtful_range_are_exact_with_few_checks() -> None:
    wrong = set(range(31, 158))
    checks = Checks(wrong)
    doubtful = unconfirmed_points(np.ones(400, dtype=bool), np.ones(400, dtype=bool), checks)
    assert set(np.flatnonzero(doubtful).tolist()) == wrong
    assert len(checks.asked) == len(set(checks.asked)) < FIRST_POINTS + 1 + 2 * 7


def test_each_part_with_one_verdict_has_its_own_check() -> None:
    """An island of unstable points between the first ones is checked; its answer says nothing about its neighbours."""
    stable = np.ones(400, dtype=bool)
    stable[70:75] = False
    checks = Checks(set(range(70, 75)))
    doubtful = unconfirmed_points(stable, np.ones(400, dtype=bool), checks)
    assert np.flatnonzero(doubtful).tolist() == [70, 71, 72, 73, 74]
    assert any(70 <= point < 75 for point in checks.asked)


def test_points_where_nothing_moves_are_not_checked() -> None:
    moves = np.zeros(50, dtype=bool)
    moves[20:30] = True
    checks = Checks(set(range(50)))
    doubtful = unconfirmed_points(np.ones(50, dtype=bool), moves, checks)
    assert np.array_equal(doubtful, moves)
    assert set(checks.asked) <= set(range(20, 30))
    assert not unconfirmed_points(np.ones(50, dtype=bool), np.zeros(50, dtype=bool), checks).any()


def twins(harmonics: int, samples: int) -> ss.ForcedResponse:
    """Twins 0 of the torture set, where all five pairs rattle: closed for a third of the period."""
    problem = benchmark_module("torture_problems").make("twins", 0)
    response: ss.ForcedResponse = problem.solve(harmonics=harmonics, samples=samples, window_hz=(187.9, 188.5))
    return response


@pytest.mark.long
def test_a_multiplier_that_few_harmonics_feign_is_doubtful() -> None:
    """With 3 harmonics it is 1.55, and in time a disturbance of 1 % dies out; the error of the motion is 0.2 %, below
    that of a warning."""
    few = twins(3, 128)
    assert few.stable is not None
    assert few.doubtful is not None
    assert few.multipliers is not None
    assert not few.stable.any()
    assert few.multipliers[:, 0].real.min() > 1.5
    assert few.doubtful.all()
    (warning,) = few.warnings
    printed_sentence(warning, "doubtful", numbers=False)
    printed_sentence(few.stability_message, numbers=False)
    enough = twins(7, 256)
    assert enough.stable is not None
    assert enough.doubtful is not None
    assert enough.stable.all()
    assert not enough.doubtful.any()
    assert enough.warnings == ()
