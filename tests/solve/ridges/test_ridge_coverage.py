"""Which part of a range ridges cover, and whether they enclose the minimum."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from stickslip.solve.ridges.ridge_coverage import merged, middle_of_gap, passes_through, place_on, rise_below
from stickslip.solve.ridges.ridge_line import RidgeLine

LOADS = np.array([10.0, 20.0, 40.0, 80.0])


def test_intervals_that_touch_are_one() -> None:
    assert merged([(5.0, 8.0), (1.0, 3.0), (2.0, 4.0), (8.0, 9.0)]) == [(1.0, 4.0), (5.0, 9.0)]


def test_the_longest_gap_comes_first_and_each_is_tried_once() -> None:
    followed = [(1.0, 2.0), (3.0, 4.0), (16.0, 20.0), (20.1, 30.0)]
    assert middle_of_gap(followed, set()) == pytest.approx(8.0)
    assert middle_of_gap(followed, {8.0}) == pytest.approx(np.sqrt(6.0))
    assert middle_of_gap(followed, {8.0, 2.5}) is None


def test_a_minimum_is_enclosed_where_the_peak_rises_far_below_it() -> None:
    stuck = np.zeros(4, dtype=bool)
    assert rise_below(LOADS, np.array([3.0, 1.0, 2.0, 3.0]), stuck, 0.0).is_certain
    assert not rise_below(LOADS, np.array([2.0, 1.0, 2.0, 9.0]), stuck, 9.0).is_certain
    assert not rise_below(LOADS, np.array([1.0, 2.0, 3.0, 4.0]), stuck, 9.0).is_certain


def test_a_smaller_rise_is_enough_at_the_end_itself_towards_a_higher_free_peak() -> None:
    """The rough casting: at 60 N its peak is 1.33 times the minimum at 243 N, without contact 4.3 times."""
    stuck = np.zeros(4, dtype=bool)
    rise = rise_below(LOADS, np.array([1.33, 1.1, 1.0, 2.0]), stuck, 4.3)
    assert rise.is_enough
    assert not rise.is_certain
    assert (rise.at_end, rise.most, rise.free) == pytest.approx((1.33, 1.33, 4.3))
    # A dip, a peak that falls towards the end, and one above that without contact.
    assert not rise_below(LOADS, np.array([1.2, 1.1, 1.0, 2.0]), stuck, 4.3).is_enough
    assert not rise_below(LOADS, np.array([1.3, 1.4, 1.0, 2.0]), stuck, 4.3).is_enough
    assert not rise_below(LOADS, np.array([1.33, 1.1, 1.0, 2.0]), stuck, 0.0).is_enough


def test_a_stuck_node_of_the_excitation_encloses_nothing() -> None:
    """The notch at 40 is low because the excitation does not reach the mode there, not by friction."""
    highest = np.array([2.0, 1.5, 0.1, 3.0])
    assert rise_below(LOADS, highest, np.zeros(4, dtype=bool), 0.0).is_certain
    assert not rise_below(LOADS, highest, np.array([False, False, True, False]), 0.0).is_certain
    assert rise_below(LOADS, highest, np.ones(4, dtype=bool), 0.0).is_certain


def test_a_ridge_passes_through_a_point_within_its_estimated_error() -> None:
    """Two searches of one flat peak in gross slip, with other harmonics: 3 % apart in amplitude, 0.1 % in frequency."""

    def point(load: float, amplitude: float, omega: float, error: float) -> SimpleNamespace:
        peak = SimpleNamespace(amplitude=amplitude, omega=omega)
        return SimpleNamespace(parameter=load, peak=peak, estimates={5: error}, harmonics=5)

    ridge = [point(load, 1.0, 100.0, 0.0) for load in LOADS]
    line = RidgeLine(np.log(LOADS), np.zeros(4), np.full(4, np.nan), np.zeros(4, dtype=bool))
    assert passes_through(ridge, line, point(15.0, 1.03, 100.1, 0.04))  # type: ignore[arg-type]
    assert not passes_through(ridge, line, point(15.0, 1.03, 100.1, 0.001))  # type: ignore[arg-type]
    assert not passes_through(ridge, line, point(15.0, 1.03, 101.0, 0.04))  # type: ignore[arg-type]


def test_a_peak_between_two_points_of_a_ridge_is_its_next_one() -> None:
    """Peaks with the amplitude of the line, some with the motion of the ridge, and one with that of another mode."""

    def point(load: float, height: float, shape: list[float]) -> SimpleNamespace:
        return SimpleNamespace(
            parameter=load, peak=SimpleNamespace(amplitude=height), harmonics=1, shape=np.array([[0.0, 0.0], shape])
        )

    ridge = [point(load, 1.0, [1.0, 0.1 * place]) for place, load in enumerate(LOADS)]
    line = RidgeLine(np.log(LOADS), np.zeros(4), np.zeros(4), np.zeros(4, dtype=bool))

    def place(load: float, height: float, shape: list[float]) -> int | None:
        return place_on(ridge, line, point(load, height, shape))  # type: ignore[arg-type]

    assert place(28.0, 1.01, [1.0, 0.15]) == 2
    assert place(28.0, 1.1, [1.0, 0.15]) is None
    assert place(28.0, 1.01, [0.2, 1.0]) is None
    assert place(5.0, 1.0, [1.0, 0.0]) is None
    assert place(100.0, 1.0, [1.0, 0.3]) is None
