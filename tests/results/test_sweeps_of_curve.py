"""Slow sweeps along curves whose folds are known: a Duffing oscillator, polygons, ends and instability."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.results.peaks import Peak, peaks
from stickslip.results.sweeps_of_curve import SlowSweep, stable_between_folds, sweeps

RATIO, CUBIC, FORCE = 0.01, -0.02, 0.05


def duffing(n: int = 4001) -> tuple[np.ndarray, np.ndarray]:
    """Frequency and amplitude of ``u'' + 2 z u' + u + c u^3 = F cos(w t)`` with one harmonic, along the curve.

    ``(1 + 3/4 c a^2 - w^2)^2 + (2 z w)^2 = (F / a)^2`` (A. H. Nayfeh, D. T. Mook, Nonlinear Oscillations, 1979, 4.1).
    """
    largest = np.roots([0.75 * CUBIC * RATIO**2 * 4, 0, 4 * RATIO**2 * (1 - RATIO**2), 0, -(FORCE**2)])
    top = float(min(root.real for root in largest if abs(root.imag) < 1e-9 and root.real > 0))
    a = top * np.sin(np.linspace(0.02, np.pi / 2, n // 2))
    middle, width = 1 + 0.75 * CUBIC * a**2 - 2 * RATIO**2, (FORCE / a) ** 2 - 4 * RATIO**2 * (1 + 0.75 * CUBIC * a**2)
    root = np.sqrt(np.maximum(width + 4 * RATIO**4, 0.0))
    below, above = np.sqrt(np.maximum(middle - root, 1e-4)), np.sqrt(middle + root)
    inside = below > 0.5
    return np.concatenate([below[inside], above[-2::-1]]), np.concatenate([a[inside], a[-2::-1]])


def both(frequency: np.ndarray, amplitude: np.ndarray, stable: np.ndarray | None = None) -> dict[str, SlowSweep]:
    return {each.direction: each for each in sweeps(frequency, amplitude, stable)}


def top(each: SlowSweep) -> Peak:
    assert each.peak is not None
    return each.peak


def test_a_softening_duffing_oscillator_jumps_up_below_and_down_at_the_tip() -> None:
    frequency, amplitude = duffing()
    folds = np.flatnonzero(np.diff(np.sign(np.diff(frequency)))) + 1
    high, low = sorted(frequency[folds], reverse=True)
    found = both(frequency, amplitude)
    (up,), (down,) = found["up"].jumps, found["down"].jumps
    assert (up.frequency_hz, down.frequency_hz) == pytest.approx((high, low), rel=1e-5)
    # the exact equation holds on both sides of each jump
    for jump in (up, down):
        for a in (jump.amplitude_from, jump.amplitude_to):
            w = jump.frequency_hz
            assert a * np.hypot(1 + 0.75 * CUBIC * a**2 - w**2, 2 * RATIO * w) == pytest.approx(FORCE, rel=2e-2)
    assert up.amplitude_to > 1.3 * up.amplitude_from
    assert down.amplitude_to < 0.7 * down.amplitude_from
    # the tip is met on the way down only; the way up begins its upper branch at the jump
    assert found["down"].peak == peaks(frequency, amplitude)[0]
    assert top(found["up"]).amplitude == up.amplitude_to
    assert top(found["up"]).frequency_hz == up.frequency_hz
    assert top(found["up"]).bracketed
    assert top(found["up"]).amplitude < 0.9 * top(found["down"]).amplitude


def test_a_curve_without_folds_has_one_peak_and_no_jump() -> None:
    frequency = np.linspace(400.0, 500.0, 60)
    amplitude = 1.0 / (1.0 + ((frequency - 452.3) / 4.0) ** 2)
    highest = peaks(frequency, amplitude)[0]
    for each in sweeps(frequency, amplitude):
        assert (each.jumps, each.gaps_hz, each.leaves_at_hz, each.peak) == ((), (), None, highest)
        assert sorted(each.points()) == list(range(60))
    rising = sweeps(frequency, frequency)
    assert [each.peak for each in rising] == [peaks(frequency, frequency)[0]] * 2
    assert not top(rising[0]).bracketed


# Corners of curves: frequency, and amplitude that counts along the curve.
ONE_FOLD_PAIR = (0.0, 5.0, 3.0, 8.0)
NESTED = (0.0, 6.0, 4.0, 5.0, 3.0, 9.0)  # the second fold lies below the first
STAIRS = (0.0, 4.0, 3.0, 6.0, 5.0, 9.0)
LOOPS = (0.0, 5.0, 1.0, 7.0, 2.0, 9.0)  # the second fold lies above the first, the second valley above the first


def polygon(corners: tuple[float, ...], per_side: int = 40) -> np.ndarray:
    """Points along straight sides; the corners are points."""
    sides = [np.linspace(a, b, per_side, endpoint=False) for a, b in pairwise(corners)]
    return np.concatenate([*sides, [corners[-1]]])


@pytest.mark.parametrize(
    ("corners", "up", "down"),
    [
        (ONE_FOLD_PAIR, [(5.0, 1.0, 2.4)], [(3.0, 2.0, 0.6)]),
        # from 6 the only part ahead that reaches so far is the last; from 3 downward only the first
        (NESTED, [(6.0, 1.0, 4.5)], [(3.0, 4.0, 0.5)]),
        (STAIRS, [(4.0, 1.0, 7 / 3), (6.0, 3.0, 4.25)], [(5.0, 4.0, 8 / 3), (3.0, 2.0, 0.75)]),
        # two parts pass 5 on the way up, and 2 on the way down: the nearest along the curve
        (LOOPS, [(5.0, 1.0, 2 + 4 / 6), (7.0, 3.0, 4 + 5 / 7)], [(2.0, 4.0, 2 + 1 / 6), (1.0, 2.0, 0.2)]),
    ],
)
def test_jumps_between_straight_parts_and_the_direction_of_the_walk_does_not_matter(
    corners: tuple[float, ...], up: list[tuple[float, ...]], down: list[tuple[float, ...]]
) -> None:
    frequency = 100.0 + polygon(corners)
    along = np.linspace(0.0, len(corners) - 1.0, frequency.size)
    found = both(frequency, along)
    reverse = both(frequency[::-1], along[::-1])
    for direction, wanted in (("up", up), ("down", down)):
        for each in (found[direction], reverse[direction]):
            actual = [(jump.frequency_hz - 100.0, jump.amplitude_from, jump.amplitude_to) for jump in each.jumps]
            np.testing.assert_allclose(actual, wanted, atol=0.06)
            assert each.leaves_at_hz is None
            assert each.gaps_hz == ()
        last = frequency.size - 1
        assert [last - jump.place_to for jump in reverse[direction].jumps] == pytest.approx(
            [jump.place_to for jump in found[direction].jumps]
        )
        assert top(reverse[direction]).amplitude == pytest.approx(top(found[direction]).amplitude)
        assert (np.diff(frequency[found[direction].points()]) * (1 if direction == "up" else -1) > 0).all()


def test_middle_parts_are_unstable_and_stability_from_outside_wins() -> None:
    frequency = 100.0 + polygon(ONE_FOLD_PAIR)
    along = np.linspace(0.0, 3.0, frequency.size)
    by_folds = stable_between_folds(frequency)
    assert np.array_equal(by_folds, (along <= 1.0) | (along >= 2.0))
    # the upper part is unstable up to 2.7 along the curve (6.5 in frequency): from the fold at 5 no motion is stable
    part = by_folds & ~((along > 1.5) & (along < 2.7))
    up = both(frequency, along, part)["up"]
    assert up.jumps == ()
    ((first, last),) = up.gaps_hz
    assert (first, last) == pytest.approx((105.0, 106.5), abs=0.15)
    # the way down loses stability at 6.5; the lower part comes no higher than 5, so there is a gap too
    down = both(frequency, along, part)["down"]
    assert down.gaps_hz[0] == pytest.approx((106.5, 105.0), abs=0.15)
    assert down.jumps == ()


def test_stability_lost_without_a_fold_is_a_gap_or_a_jump_to_a_stable_part() -> None:
    frequency = np.linspace(100.0, 110.0, 101)
    amplitude = 1.0 + np.linspace(0.0, 1.0, 101)
    stable = ~((frequency > 103.95) & (frequency < 106.05))
    up, down = sweeps(frequency, amplitude, stable)
    assert up.gaps_hz[0] == pytest.approx((103.9, 106.1))
    assert down.gaps_hz[0] == pytest.approx((106.1, 103.9))
    assert not set(np.flatnonzero(~stable)) & set(up.points())
    # at an edge of the gap the amplitude may be higher inside it
    hump = np.where(frequency <= 105.0, frequency - 100.0, 110.0 - frequency)
    assert not top(sweeps(frequency, hump, stable)[0]).bracketed
    # a folded curve whose lower part loses stability at 104 before its fold at 105: the upper part takes over there
    folded = 100.0 + polygon(ONE_FOLD_PAIR)
    along = np.linspace(0.0, 3.0, folded.size)
    (jump,) = both(folded, along, stable_between_folds(folded) & ~((along > 0.81) & (along < 1.5)))["up"].jumps
    assert (jump.frequency_hz, jump.amplitude_to) == pytest.approx((104.0, 2.2), abs=0.1)


def test_stability_that_changes_one_point_beside_the_fold_moves_no_jump() -> None:
    frequency, amplitude = duffing(801)
    flags = stable_between_folds(frequency)
    exact = both(frequency, amplitude)
    edges = np.flatnonzero(np.diff(flags.astype(int)))
    for shift in (0, 1):
        moved = flags.copy()
        moved[edges + shift] = ~moved[edges + shift]
        found = both(frequency, amplitude, moved)
        for direction in ("up", "down"):
            assert [jump.frequency_hz for jump in found[direction].jumps] == pytest.approx(
                [jump.frequency_hz for jump in exact[direction].jumps], rel=1e-12
            )


def test_a_curve_that_ends_early_past_a_fold_leaves_the_sweep_there() -> None:
    frequency = 100.0 + polygon((0.0, 5.0, 3.0))
    amplitude = np.linspace(1.0, 3.0, frequency.size)
    up, down = sweeps(frequency, amplitude)
    assert up.leaves_at_hz == pytest.approx(105.0, abs=0.05)
    assert up.jumps == ()
    assert not top(up).bracketed
    # the way down can begin only where the computed stable part begins
    assert down.jumps == ()
    assert frequency[down.points()[0]] == 105.0
    assert not top(down).bracketed


def test_a_curve_without_a_stable_point_has_no_sweep() -> None:
    for each, gap in zip(sweeps([1.0, 2.0], [1.0, 1.0], [False, False]), ((1.0, 2.0), (2.0, 1.0)), strict=True):
        assert (each.runs, each.peak, each.gaps_hz, each.points().size) == ((), None, (gap,), 0)


def test_wrong_arrays_are_rejected() -> None:
    with rejects(InputError, "stable"):
        sweeps([1.0, 2.0], [1.0, 1.0], [True])
    with rejects(InputError, "frequency_hz", "amplitude"):
        sweeps([1.0, 2.0], [1.0])


def test_a_sweep_jumps_where_the_curve_is_interrupted() -> None:
    """Two straight parts that overlap from 4 to 5; between 8 and 9 there is nothing."""
    frequency = np.concatenate([np.linspace(0.0, 5.0, 26), np.linspace(4.0, 8.0, 21), np.linspace(9.0, 10.0, 6)])
    part = np.repeat([0, 1, 2], [26, 21, 6])
    amplitude = 1.0 + part
    up, down = sweeps(100.0 + frequency, amplitude, np.ones(53, dtype=bool), part)
    assert [(jump.frequency_hz, jump.amplitude_from, jump.amplitude_to) for jump in up.jumps] == [(105.0, 1.0, 2.0)]
    assert [(jump.frequency_hz, jump.amplitude_from, jump.amplitude_to) for jump in down.jumps] == [(104.0, 2.0, 1.0)]
    assert up.gaps_hz == ((108.0, 109.0),)
    assert down.gaps_hz == ((109.0, 108.0),)


def test_no_peak_lies_across_an_interruption() -> None:
    frequency, amplitude = np.arange(8.0), np.array([1.0, 2.0, 5.0, 3.0, 1.0, 2.0, 1.5, 1.0])
    whole = peaks(frequency, amplitude)
    assert [(peak.point, peak.bracketed) for peak in whole] == [(2, True), (5, True)]
    cut = peaks(frequency, amplitude, [0, 0, 0, 1, 1, 1, 1, 1])
    assert [(peak.point, peak.bracketed) for peak in cut] == [(2, False), (5, True)]
