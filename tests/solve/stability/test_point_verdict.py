"""The verdict of one point: what its multipliers allow, and how far more harmonics may move them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stickslip.solve.stability.folds import NEAR_FOLD, Fold, doubtful_range, sided_counts
from stickslip.solve.stability.verdict import CHANGE_FACTOR, Verdict


def verdict(*values: complex) -> Verdict:
    """Multipliers with the complex conjugates of complex ones, and small errors by samples."""
    pairs = [each for value in values for each in ([value, value.conjugate()] if value.imag else [value])]
    return Verdict(np.array(pairs, dtype=complex), np.full(len(pairs), 1e-3))


def test_a_rattling_pair_that_more_harmonics_move_is_not_settled() -> None:
    """The largest multipliers of twins 5 of the torture set at 300.65 Hz with 11 and 22 harmonics: all are inside of
    the circle, but with 33 harmonics, and in time, the motion is unstable."""
    few, more = verdict(0.895 + 0.435j, -0.823 + 0.477j), verdict(0.895 + 0.435j, -0.806 + 0.548j)
    assert more.confirms(stable=True, distance=0.01)
    assert not more.moved_from(few).settles(stable=True)


@pytest.mark.parametrize("moved", [0.9, 1.1])
def test_a_multiplier_may_move_by_a_part_of_its_distance_from_the_circle(moved: float) -> None:
    distance = 0.05
    few = verdict(-(1.0 - distance) + moved * distance / CHANGE_FACTOR)
    assert verdict(-(1.0 - distance)).moved_from(few).settles(stable=True) == (moved < 1.0)


def test_a_complex_pair_may_rotate_unless_it_reaches_the_real_axis() -> None:
    few = verdict(0.997 * np.exp(0.25j))
    assert verdict(0.997 * np.exp(0.24j)).moved_from(few).settles(stable=True)
    assert not verdict(0.997 * np.exp(0.12j)).moved_from(few).settles(stable=True)
    assert not verdict(0.997 * np.exp(0.24j)).moved_from(verdict(0.99 * np.exp(0.24j))).settles(stable=True)


def test_folds_decide_about_a_multiplier_that_is_real_and_positive() -> None:
    assert verdict(0.99).moved_from(verdict(0.95)).settles(stable=True)


def test_a_motion_with_one_multiplier_that_is_surely_outside_is_unstable_whatever_the_others_do() -> None:
    few = verdict(-1.8, -0.3 + 0.9j)
    assert verdict(-1.9, 0.3 + 0.9j).moved_from(few).settles(stable=False)
    assert not verdict(-1.1, 0.3 + 0.9j).moved_from(few).settles(stable=False)


def test_small_multipliers_that_the_iteration_does_not_resolve_keep_their_error() -> None:
    few = verdict(-0.1)
    assert verdict(0.45 * 1j).moved_from(few).settles(stable=True)


def test_a_complex_pair_beside_1_may_be_a_real_multiplier_on_each_side_of_it() -> None:
    """Between two folds of two blades, the last two points before the second one have 0.9937 +- 0.0067i: errors of the
    harmonics join what would be 1.001 and 0.986. Points between them with 1.0145 lost their verdict to these."""
    pair = verdict(0.9937 + 0.0067j)
    assert pair.counts().positive == 0
    assert pair.possible(0.0156) == range(2)
    assert pair.possible(0.005) == range(1)
    assert pair.has_pair_near_one(0.0156)
    assert not pair.has_pair_near_one(0.005)
    folds = [Fold(0.6, 2.0, 0.0), Fold(4.7, 1.0, 0.013)]
    points = [verdict(0.9937 + 0.02j), *map(verdict, (1.0054, 1.0145, 1.0051)), pair, verdict(0.9936 + 0.0248j)]
    distances = [doubtful_range(place, folds) for place in range(len(points))]
    sided = sided_counts(
        [each.counts().positive for each in points],
        [each.possible(distance) for each, distance in zip(points, distances, strict=True)],
        [
            each.near_one(NEAR_FOLD) or each.has_pair_near_one(distance)
            for each, distance in zip(points, distances, strict=True)
        ],
        folds,
    )
    assert sided == [0, 1, 1, 1, 1, 0]


@pytest.mark.parametrize("size", [1.2, 1.8])
def test_a_growth_that_no_disturbance_fits_is_in_doubt_whatever_its_size(size: float) -> None:
    assert not replace(verdict(size), in_doubt=False).undecided
    assert replace(verdict(size), in_doubt=True).undecided
