"""Percentiles, limits and curves of samples, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.stats

from band_tables import band_table
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.results.band import (
    MEASURES,
    curve_band,
    drawn_pieces,
    exceedance,
    highest_branch,
    limit_of,
    percentiles,
)
from stickslip.results.sweep_table import SweepCurve

PEAK = MEASURES["peak_amplitude"]


def curve(frequency: list[float], amplitude: list[float], part: list[int] | None = None) -> SweepCurve:
    return SweepCurve(
        np.array(frequency), np.array(amplitude), np.ones(len(frequency), bool), np.array(part or [0] * len(frequency))
    )


def test_percentiles_of_evenly_distributed_samples_are_those_of_the_distribution() -> None:
    """Peaks proportional to a force that is uniform between 1 and 3 N, one sample in each n-th part."""
    table = band_table((1.0 + 2.0 * (np.arange(64) + 0.5) / 64).tolist())
    result = percentiles(PEAK, table)
    assert result.values == pytest.approx((1.1, 2.0, 2.9), rel=1e-12)
    assert result.count == 64
    for (low, high), value in zip(result.intervals, result.values, strict=True):
        assert not low > value
        assert not high < value
    assert np.isnan(result.intervals[0][0])  # 64 samples have no lower bound for 5 %
    # of 64 samples, the 24th and the 41st contain the median: P(24 <= B(64, 1/2) < 41) is the first above 95 %
    assert result.intervals[1] == pytest.approx((1.0 + 2.0 * 23.5 / 64, 1.0 + 2.0 * 40.5 / 64))
    assert scipy.stats.binom.cdf(40, 64, 0.5) - scipy.stats.binom.cdf(23, 64, 0.5) > 0.95


def test_failed_samples_are_counted_out_of_percentiles() -> None:
    result = percentiles(PEAK, band_table([1.0, None, 2.0, 3.0, None]))
    assert (result.values[1], result.count) == (2.0, 3)
    assert np.isnan(percentiles(PEAK, band_table([None, None])).values).all()


def test_the_interval_of_a_probability_is_that_of_clopper_and_pearson() -> None:
    limit = limit_of("peak_amplitude < 2.5 m")
    result = exceedance(limit, band_table([1.0, 2.0, 3.0, 4.0]))
    assert (result.exceeded, result.undecided, result.count, result.probability) == (2, 0, 4, 0.5)
    beta = scipy.stats.beta
    assert result.interval == pytest.approx((beta.ppf(0.025, 2, 3), beta.ppf(0.975, 3, 2)))


def test_undecided_samples_widen_the_interval_to_both_outcomes() -> None:
    """A failed sample, and a curve that rises at its end below the limit; one above the limit is decided."""
    limit = limit_of("peak_amplitude < 2.5 m")
    result = exceedance(limit, band_table([1.0, None, 2.0, 3.0], at_end=(2, 3)))
    assert (result.exceeded, result.undecided, result.probability) == (1, 2, 0.5)
    beta = scipy.stats.beta
    assert result.interval == pytest.approx((beta.ppf(0.025, 1, 4), beta.ppf(0.975, 4, 1)))
    lower = exceedance(limit_of("peak_amplitude > 2.5 m"), band_table([1.0, 2.0, 3.0], at_end=(0, 2)))
    assert (lower.exceeded, lower.undecided) == (1, 1)  # the open peak of 3 m is above, that of 1 m may be
    frequency = exceedance(limit_of("peak_frequency > 470 Hz"), band_table([1.0, 2.0], at_end=(1,)))
    assert (frequency.exceeded, frequency.undecided) == (1, 1)
    stress = exceedance(limit_of("stress < 3 TPa"), band_table([1.0, 2.0, 3.0], at_end=(2,), with_stress=True))
    assert (stress.exceeded, stress.undecided) == (1, 1)  # that of another peak beyond the end may be lower
    nothing = exceedance(limit, band_table([None, None]))
    assert np.isnan(nothing.probability)
    assert nothing.interval == (0.0, 1.0)


def test_limits_are_si() -> None:
    limit = limit_of(" upward_peak_amplitude<0.2 mm ")
    assert (limit.measure.column, limit.is_upper, limit.value) == ("upward_peak_amplitude_m", True, 2e-4)
    assert limit_of("peak_frequency > 0.45 kHz").value == 450.0
    assert limit_of("alternating_stress < 300 MPa").value == 3e8


@pytest.mark.parametrize(
    "text",
    ["peak < 1 mm", "peak_amplitude <= 1 mm", "peak_amplitude 1 mm", "peak_amplitude < 0.2", "peak_amplitude < 5 Hz",
     "peak_amplitude < -1 mm", "peak_frequency > nan Hz", "stress < 1 mm", "strain < 1 MPa", "",
     "stress < ", "peak_amplitude <", "peak_frequency >  "],
)  # fmt: skip
def test_unknown_limits_are_rejected(text: str) -> None:
    with rejects(InputError, "limits"):
        limit_of(text)


def test_a_violation_has_the_digits_that_distinguish_value_and_limit() -> None:
    limit = limit_of("stress < 1 MPa")
    assert limit.violation(1e6) == ""
    words = "instead of at most 1 MPa (largest von Mises stress at the peak)"
    assert limit.violation(24.4e6) == f"24.4 MPa {words}"
    assert limit.violation(1.000012e6) == f"1.00001 MPa {words}"
    assert limit_of("peak_frequency > 440 Hz").violation(400.0).startswith("400 Hz instead of at least 440 Hz")


def test_a_folded_curve_counts_with_its_highest_branch() -> None:
    folded = curve([1.0, 3.0, 2.0, 4.0], [0.0, 2.0, 3.0, 1.0])
    # branches: rises 0 to 2 on (1, 3), back from 2 to 3 on (3, 2), falls 3 to 1 on (2, 4)
    grid = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5])
    expected = [np.nan, 0.0, 0.5, 3.0, 2.5, 2.0, 1.5, 1.0, np.nan]
    np.testing.assert_allclose(highest_branch(folded, grid), expected)
    np.testing.assert_allclose(highest_branch(curve([4.0, 1.0], [1.0, 4.0]), grid[1:8]), 5.0 - grid[1:8])


def test_the_flank_of_a_resonance_is_nearly_exact_between_few_points() -> None:
    """Steps of 14 % of the peak, as samples of a band have them: 10 % too high between them with straight lines."""
    phase = np.linspace(-1.5, 1.5, 22)
    known = curve((10.0 + 0.1 * np.tan(phase)).tolist(), np.cos(phase).tolist())
    between = 0.5 * (phase[1:] + phase[:-1])
    grid, exact = 10.0 + 0.1 * np.tan(between), np.cos(between)
    straight = np.interp(grid, known.frequency_hz, known.amplitude_m)
    assert np.abs(straight / exact - 1.0).max() > 0.1
    found = highest_branch(known, grid)
    np.testing.assert_allclose(found, exact, rtol=0.01)
    flank = np.abs(between) > 1.2
    np.testing.assert_allclose(found[flank], exact[flank], rtol=0.004)
    back = curve(known.frequency_hz[::-1].tolist(), known.amplitude_m[::-1].tolist())
    np.testing.assert_allclose(highest_branch(back, grid), found, rtol=1e-12)


def test_between_two_points_no_amplitude_is_outside_of_theirs() -> None:
    """A step, a point at rest, and two points at one frequency."""
    heights = [1.0, 1.0, 5.0, 5.0, 0.1]
    found = highest_branch(curve([1.0, 2.0, 3.0, 4.0, 5.0], heights), np.linspace(1.0, 5.0, 81))
    low, high = np.minimum(heights[:-1], heights[1:]), np.maximum(heights[:-1], heights[1:])
    interval = np.minimum(np.arange(81) // 20, 3)
    assert (found >= low[interval] - 1e-12).all()
    assert (found <= high[interval] + 1e-12).all()
    resting = highest_branch(curve([1.0, 2.0, 3.0], [0.0, 1.0, 2.0]), np.array([1.0, 1.5, 2.5]))
    np.testing.assert_allclose(resting, [0.0, 0.5, 1.5])
    upright = highest_branch(curve([1.0, 2.0, 2.0, 3.0], [1.0, 1.0, 4.0, 1.0]), np.array([1.5, 2.0, 2.5]))
    np.testing.assert_allclose(upright, [1.0, 4.0, 2.5])


def test_the_drawn_line_of_a_sample_is_that_of_the_percentiles() -> None:
    phase = np.linspace(-1.5, 1.5, 22)
    known = curve((10.0 + 0.1 * np.tan(phase)).tolist(), np.cos(phase).tolist())
    ((at, drawn),) = drawn_pieces(known, 4)
    assert at.size == 4 * 21 + 1
    np.testing.assert_allclose(drawn, highest_branch(known, at), rtol=1e-12)
    np.testing.assert_allclose(drawn[::4], known.amplitude_m, rtol=1e-12)
    folded = curve([1.0, 3.0, 2.0, 4.0, 5.0, 5.0], [1.0, 2.0, 3.0, 1.0, 1.0, 2.0], [0, 0, 0, 0, 1, 1])
    ends = [(x[0], x[-1], y[0], y[-1]) for x, y in drawn_pieces(folded, 4)]
    # between folds, in ascending order; nothing across the gap from 4 to 5; an upright step as it is
    assert ends == [(1.0, 3.0, 1.0, 2.0), (2.0, 3.0, 3.0, 2.0), (2.0, 4.0, 3.0, 1.0), (5.0, 5.0, 1.0, 2.0)]


def test_a_gap_between_parts_has_no_amplitude() -> None:
    parted = curve([1.0, 2.0, 3.0, 4.0], [1.0, 1.0, 2.0, 2.0], [0, 0, 1, 1])
    grid = np.array([1.5, 2.0, 2.5, 3.0, 3.5])
    np.testing.assert_allclose(highest_branch(parted, grid), [1.0, 1.0, np.nan, 2.0, 2.0])
    band = curve_band([parted, curve([1.0, 2.5, 4.0], [3.0, 3.0, 3.0])])
    assert band is not None
    place = int(np.flatnonzero(band.frequency_hz == 2.5)[0])
    assert (band.count[place], band.amplitude_m[1, place]) == (1, 3.0)
    assert band.count[0] == 2


def test_the_band_of_proportional_curves_is_proportional() -> None:
    shape = [1.0, 4.0, 2.0, 1.0]
    factors = 1.0 + 2.0 * (np.arange(32) + 0.5) / 32
    band = curve_band([curve([10.0, 11.0, 12.0, 14.0], [factor * each for each in shape]) for factor in factors])
    assert band is not None
    expected = highest_branch(curve([10.0, 11.0, 12.0, 14.0], shape), band.frequency_hz)
    np.testing.assert_allclose(band.amplitude_m, np.outer((1.1, 2.0, 2.9), expected), rtol=1e-12)
    assert curve_band([]) is None
