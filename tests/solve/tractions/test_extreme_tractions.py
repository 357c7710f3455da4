"""Optimised residual tractions: known optima of functions, gradients beside differences, grids of whole curves."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any, cast

import numpy as np
import pytest

import stickslip as ss
from stickslip.results.peaks import peaks
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.harmonic.traction_sensitivity import Quantity
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.setting_up import Balances, prepare_balances
from stickslip.solve.tractions import extreme_tractions
from stickslip.solve.tractions.extreme_tractions import PeakOverTractions, TractionPeak, highest, local_extreme, lowest

# Three unknowns of one or two pairs with slip and variable normal load. Only t1 of the second pair moves.
STIFFNESS = 1e6 * np.array([[3.0, -1.0, 0.2], [-1.0, 2.5, -0.5], [0.2, -0.5, 2.0]])
STRUCTURE = ss.Superelement(np.diag([1.0, 0.6, 0.8]), STIFFNESS)
OPERATOR = np.array(
    [[0.0, 1.0, 0.1], [0.2, 0.1, 0.0], [0.0, 0.1, 1.0], [0.7, 0.1, 0.2], [0.0, 0.0, 0.0], [0.3, 0.0, 0.6]]
)
LIMIT = 0.3 * np.array([60.0, 50.0])
OUTPUT = np.array([0.0, 1.0, 0.0])
DAMPING, HARMONICS = 0.01, 3
# Of a peak between the points of its curve.
RESOLUTION = 2e-3


def joint(count: int, traction: np.ndarray | None = None) -> ss.ContactPairs:
    load = (LIMIT / 0.3)[:count]
    return ss.ContactPairs(OPERATOR[: 3 * count], 1e6, 1.5e6, 0.3, load, traction)


def curve(count: int, traction: np.ndarray | None = None, **options: Any) -> ss.ForcedResponse:
    return ss.forced_response(
        STRUCTURE, joint(count, traction), np.array([30.0, 0.0, 0.0]), frequency_hz=(222.0, 275.0),
        harmonics=HARMONICS, samples=128, modal_damping_ratio=DAMPING, **options,
    )  # fmt: skip


def balances(count: int, samples: int) -> Balances:
    force = ss.Excitation.force(np.array([30.0, 0.0, 0.0]))
    still, highest_omega = joint(count, np.zeros((count, 2))), 2.0 * np.pi * 275.0
    return prepare_balances(
        STRUCTURE, still, force, highest_omega, HARMONICS, samples, DAMPING, "tractrix", lambda words: None
    )


@dataclass(frozen=True)
class Known:
    """Stands for the peak of a solved model: two extremes that are known functions of the tractions of one pair."""

    functions: tuple[Callable[[np.ndarray], tuple[float, np.ndarray]], ...]
    reach: float = math.inf

    def at(self, traction: np.ndarray) -> TractionPeak:
        extremes = tuple(
            Quantity(value, slope, np.zeros_like(slope)) for value, slope in (each(traction) for each in self.functions)
        )
        return TractionPeak(traction, cast("Any", None), cast("tuple[Quantity, Quantity]", extremes))

    def moved(self, start: TractionPeak, traction: np.ndarray, halvings: int = 0) -> TractionPeak | None:
        return None if np.abs(traction - start.traction).max() > self.reach else self.at(traction)


def bowl(centre: tuple[float, float], floor: float) -> Callable[[np.ndarray], tuple[float, np.ndarray]]:
    """``floor + |T - centre|^2`` and its gradient."""
    return lambda traction: (
        floor + float(((traction - centre) ** 2).sum()),
        2.0 * (traction - np.array([centre])),
    )


def extreme(known: Known, select: extreme_tractions.Selection, limit: float = 1.0) -> TractionPeak:
    start = known.at(np.array([[0.1, 0.2]]))
    return local_extreme(cast("PeakOverTractions", known), start, select, np.array([limit]))


def test_the_lowest_of_one_bowl_is_its_bottom_inside_and_the_nearest_point_outside() -> None:
    inside = Known((bowl((0.4, -0.3), 1.0), bowl((0.4, -0.3), 0.5)))
    assert extreme(inside, lowest).traction == pytest.approx(np.array([[0.4, -0.3]]), abs=1e-3)
    outside = Known((bowl((3.0, -4.0), 1.0), bowl((0.0, 0.0), 0.5)))
    assert extreme(outside, lowest).traction == pytest.approx(np.array([[0.6, -0.8]]), abs=0.02)


def test_the_lowest_of_two_bowls_is_where_both_agree() -> None:
    """``min max(1 + |T - e1|^2, 1 + |T + e1|^2) = 2`` at zero: a kink, where gradients of equal weights cancel."""
    both = Known((bowl((1.0, 0.0), 1.0), bowl((-1.0, 0.0), 1.0)))
    found = extreme(both, lowest)
    assert found.amplitude == pytest.approx(2.0, rel=2e-4)
    assert np.abs(found.traction).max() < 0.02


def test_the_lowest_of_two_planes_is_between_their_extreme_tractions() -> None:
    """``max(1 + T1, 1 - T1)``: all weights but one lead to a limit of the pair, yet the lowest value is at zero."""

    def plane(sign: float) -> Callable[[np.ndarray], tuple[float, np.ndarray]]:
        return lambda traction: (1.0 + sign * float(traction[0, 0]), np.array([[sign, 0.0]]))

    found = extreme(Known((plane(1.0), plane(-1.0))), lowest)
    assert found.amplitude == pytest.approx(1.0, rel=1e-6)


def test_the_highest_of_a_bowl_is_opposite_its_bottom_on_the_limit() -> None:
    found = extreme(Known((bowl((0.3, 0.4), 1.0), bowl((0.3, 0.4), 0.0))), highest, limit=2.0)
    assert found.traction == pytest.approx(np.array([[-1.2, -1.6]]), abs=0.25)
    assert found.amplitude == pytest.approx(1.0 + 2.5**2, rel=2e-3)


def test_a_peak_that_gets_lost_on_long_steps_is_followed_with_short_ones() -> None:
    """Steps stay below the length of a lost one, so that the way of 0.58 ends within a tenth of it."""
    found = extreme(Known((bowl((0.4, -0.3), 1.0), bowl((0.4, -0.3), 0.5)), reach=0.05), lowest)
    assert found.traction == pytest.approx(np.array([[0.4, -0.3]]), abs=0.06)


def test_tractions_without_effect_stay() -> None:
    def flat(traction: np.ndarray) -> tuple[float, np.ndarray]:
        return 1.0, np.zeros_like(traction)

    assert extreme(Known((flat, flat)), highest).traction.tolist() == [[0.1, 0.2]]


def peaks_over_tractions(count: int, samples: int) -> tuple[PeakOverTractions, TractionPeak]:
    """The peak as a function of the tractions, and the peak without them, from a whole curve."""
    every, still = balances(count, samples), np.zeros((count, 2))
    tops = PeakOverTractions(every, HARMONICS, OUTPUT, (1350.0, 1750.0), NewtonSettings(tolerance=1e-12))
    response = curve(count, still)
    point = int(response.amplitude(OUTPUT).argmax())
    relative = (response.pairs.operator @ response.displacement[point]).T
    omega = 2.0 * np.pi * float(response.frequency_hz[point])
    start = tops.near(still, FrequencyCurve(every.with_harmonics(HARMONICS)).at(relative, omega))
    assert start is not None
    return tops, start


@pytest.mark.slow
def test_the_gradient_is_that_of_peaks_solved_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Central differences over 0.02 % of the limit, with the peak inside a smooth piece of the sampled force: 1e-5."""
    monkeypatch.setattr(extreme_tractions, "LAST_RISE", 1e-14)  # the peak itself, so that its place does not matter
    tops, still = peaks_over_tractions(1, 2048)
    traction = np.array([[4.2, -8.0]])
    top = tops.moved(still, traction)
    assert top is not None
    assert not top.peak.is_corner
    higher = max(top.extremes, key=lambda each: each.value).derivative
    for axis in range(2):
        step = np.zeros_like(traction)
        step[0, axis] = 1e-4 * LIMIT[0]
        above, below = tops.moved(top, traction + step), tops.moved(top, traction - step)
        assert above is not None
        assert below is not None
        difference = (above.amplitude - below.amplitude) / (2.0 * step.sum())
        assert difference == pytest.approx(higher[0, axis], abs=1e-5 * np.abs(higher).max())


@cache
def band_of(count: int) -> ss.TractionBand:
    band = curve(count, traction_band=OUTPUT).traction_band
    assert band is not None
    return band


def directions(pair: int, count: int) -> Iterator[np.ndarray]:
    for angle in 2.0 * np.pi * np.arange(count) / count:
        yield 0.999 * LIMIT[pair] * np.array([math.cos(angle), math.sin(angle)])


def grid(count: int) -> Iterator[np.ndarray]:
    """Directions of the first pair; for two pairs with tractions of the second along the one direction in which it
    moves."""
    if count == 1:
        yield from (fraction * each[None] for each in directions(0, 24) for fraction in (0.5, 1.0))
        return
    for each, second in product(directions(0, 24), (-0.999, 0.0, 0.999)):
        yield np.vstack([each, [second * LIMIT[1], 0.0]])


@pytest.mark.long
@pytest.mark.parametrize("count", [1, 2])
def test_a_grid_of_tractions_has_the_same_extremes(count: int) -> None:
    """48 or 72 tractions: none is outside, and the extreme ones come as close as the spacing of the grid allows. The
    curves of the band are whole ones."""
    low, high = band_of(count).peak_range(OUTPUT)
    tops, there = peaks_over_tractions(count, 128)
    found = []
    for traction in grid(count):
        after = tops.moved(there, traction)
        assert after is not None
        found.append(after.amplitude)
        there = after
    assert low * (1.0 - RESOLUTION) <= min(found)
    assert max(found) <= high * (1.0 + RESOLUTION)
    assert min(found) - low < 0.05 * (high - low)
    assert high - max(found) < 0.05 * (high - low)


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2])
def test_the_optimised_band_is_not_narrower_than_that_to_first_order(count: int) -> None:
    band = band_of(count)
    tops = {each.name: peaks(each.frequency_hz, each.amplitude)[0].amplitude for each in band.curves(OUTPUT)}
    to_first_order = [top for name, top in tops.items() if "optimised" not in name]
    low, high = band.peak_range(OUTPUT)
    assert low <= min(to_first_order)
    assert high >= max(to_first_order)
    assert band.raised_peaks is not None
    assert band.lowered_peaks is not None
    assert high == pytest.approx(band.raised_peaks.max(), rel=RESOLUTION)
    assert low == pytest.approx(band.lowered_peaks.min(), rel=RESOLUTION)
    if count == 1:  # the estimate misses the lowest peak, which is not opposite the highest one
        assert low < (1.0 - 2.0 * RESOLUTION) * min(to_first_order)
