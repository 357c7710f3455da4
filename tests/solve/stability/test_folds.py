"""What folds say about stability: sides, doubtful points, and the error of the multiplier at a fold."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.core.validation import FloatArray
from stickslip.solve.stability.folds import (
    FOLD_MARGIN,
    NEAR_FOLD,
    Fold,
    beside_folds_without_change,
    doubtful_range,
    folds_of,
    sided_counts,
)

EITHER = range(2)  # possible numbers of multipliers above 1 of a doubtful point
OMEGA: FloatArray = np.array([10.0 - (place - 2.25) ** 2 for place in range(5)])


def multiplier(*sizes: float) -> list[np.ndarray]:
    """One multiplier for each point."""
    return [np.array([size], dtype=complex) for size in sizes]


def test_a_fold_is_at_the_extremum_of_the_parabola() -> None:
    (fold,) = folds_of(OMEGA, multiplier(0.9, 0.95, 0.98, 1.03, 1.1))
    assert (fold.position, fold.omega) == pytest.approx((2.25, 10.0))
    assert fold.error == 0.0  # the multiplier passes 1 between the points


def test_the_distance_of_the_multiplier_from_1_at_a_fold_is_an_error() -> None:
    (fold,) = folds_of(OMEGA, multiplier(1.12, 1.1, 1.09, 1.08, 1.0))
    assert fold.error == pytest.approx(0.08)
    assert doubtful_range(0, [fold]) == doubtful_range(4, [fold]) == pytest.approx(FOLD_MARGIN * 0.08)
    assert doubtful_range(0, []) == NEAR_FOLD
    exact = Fold(6.0, 5.0, 0.0)
    assert doubtful_range(7, [fold, exact]) == NEAR_FOLD  # beyond another fold
    assert doubtful_range(0, [Fold(2.25, 10.0, 0.37)]) == NEAR_FOLD  # no error of any harmonics is so large


def test_doubtful_points_take_the_count_of_their_side() -> None:
    folds = [Fold(2.5, 10.0, 0.0), Fold(5.5, 9.0, 0.0)]
    counts = [0, 0, 1, 0, 1, 0, 1, 0]
    sure = [range(count, count + 1) for count in counts]
    possible = [sure[0], sure[1], EITHER, EITHER, sure[4], EITHER, EITHER, sure[7]]
    assert sided_counts(counts, possible, [True] * 8, folds) == [0, 0, 0, 1, 1, 1, 0, 0]


def test_a_multiplier_far_from_1_counts_beside_one_near_1() -> None:
    """A point of low 2 of the torture set, with multipliers 1.10 and 0.997: it was stable like its sure neighbour, and
    time integration leaves it."""
    assert sided_counts([0, 1, 0], [range(1), range(1, 3), range(1)], [False, True, False], []) == [0, 1, 0]


def test_without_a_sure_point_the_count_changes_at_each_fold() -> None:
    folds = [Fold(1.5, 10.0, 0.0), Fold(3.5, 9.0, 0.0)]
    assert sided_counts([1, 1, 0, 0, 1, 1], [EITHER] * 6, [True] * 6, folds) == [0, 0, 1, 1, 0, 0]
    assert sided_counts([0, 1, 0], [range(1), range(1, 2), range(1)], [False] * 3, []) == [0, 1, 0]


def test_a_wrinkle_of_an_unstable_part_is_unstable() -> None:
    """The multiplier is far from 1 at its folds, which are errors of the curve: no point between them is sure."""
    folds = [Fold(1.5, 10.0, 0.08), Fold(3.5, 9.0, 0.08)]
    near_one = [False, False, False, True, False, False]
    assert sided_counts([1, 1, 1, 0, 1, 1], [EITHER] * 6, near_one, folds) == [1] * 6


def places(positive: list[int], *folds: float) -> list[int]:
    """Points of doubtful stability beside the folds at these positions."""
    answer = beside_folds_without_change(
        positive, np.array([not each for each in positive]), [Fold(position, 10.0, 0.1) for position in folds]
    )
    return np.flatnonzero(answer).tolist()


def test_folds_at_which_the_number_changes_leave_no_doubt() -> None:
    assert places([0, 0, 0, 1, 1, 1, 0, 0, 0], 2.4, 5.6) == []


def test_a_change_that_comes_too_late_leaves_the_points_before_it_in_doubt() -> None:
    """Longer than the side before the fold, which begins with the curve."""
    assert places([0] * 10 + [1] * 4, 3.4) == [4, 5, 6, 7, 8, 9]
    assert places([1] * 4 + [0] * 10, 9.6) == [4, 5, 6, 7, 8, 9]


def test_a_wrinkle_without_any_change_is_in_doubt_and_not_what_surrounds_it() -> None:
    assert places([0] * 12, 4.5, 7.5) == [5, 6, 7]


def test_a_change_explains_one_fold() -> None:
    assert places([0] * 6 + [1] + [0] * 6, 6.2) == [7, 8, 9, 10, 11, 12]  # two changes beside one fold: none
    assert places([0] * 5 + [1] * 6, 3.2, 5.4) == [4]  # the other one has it


def test_a_change_without_a_fold_does_not_reach_beyond_a_wrinkle() -> None:
    assert places([0] * 5 + [1] * 5 + [0] * 20, 4.5, 20.5, 24.5) == [21, 22, 23, 24]


def test_a_fold_alone_leaves_its_shorter_side_in_doubt() -> None:
    assert places([0] * 12, 8.5) == [9, 10, 11]
    assert places([1] * 12, 8.5) == []  # an unstable point is unstable on both sides
