"""Percentiles of the curves and peaks of many samples, and probabilities that limits are exceeded."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.stats
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from stickslip.core.errors import InputError
from stickslip.core.shown_numbers import SHOWN, number, small
from stickslip.core.units import Quantity
from stickslip.core.validation import FloatArray
from stickslip.results.influence import CONFIDENCE
from stickslip.results.sweep_table import SweepCurve, SweepTable

PERCENTILES = (5.0, 50.0, 95.0)
GRID_POINTS = 1001  # chosen: frequencies of the band of curves, dense where the curves have many points


@dataclass(frozen=True)
class BandMeasure:
    """A result of each sample: its column of the table, unit and words."""

    name: str
    column: str
    unit: str
    words: str

    def of(self, table: SweepTable) -> FloatArray:
        """(n,) its values in SI; NaN for failed samples."""
        values = np.array(table.column(self.column), dtype=float)
        values[[not row.converged for row in table.rows]] = np.nan
        return values


MEASURES = {
    each.name: each
    for each in (
        BandMeasure("peak_amplitude", "peak_amplitude_m", "m", "Highest peak"),
        BandMeasure("peak_frequency", "peak_frequency_hz", "Hz", "Frequency of the highest peak"),
        BandMeasure("upward_peak_amplitude", "upward_peak_amplitude_m", "m", "Peak of a slow sweep up"),
        BandMeasure("upward_peak_frequency", "upward_peak_frequency_hz", "Hz", "Frequency of that peak, sweep up"),
        BandMeasure("downward_peak_amplitude", "downward_peak_amplitude_m", "m", "Peak of a slow sweep down"),
        BandMeasure(
            "downward_peak_frequency", "downward_peak_frequency_hz", "Hz", "Frequency of that peak, sweep down"
        ),
    )
}
STRESS, ALTERNATING_STRESS = "stress", "alternating_stress"
# At the highest peak, away from contacts and loads; samples have them where a limit asks for one.
STRESS_MEASURES: dict[str, BandMeasure] = {
    each.name: each
    for each in (
        BandMeasure(STRESS, "stress_pa", "Pa", "Largest von Mises stress at the peak"),
        BandMeasure(ALTERNATING_STRESS, "alternating_stress_pa", "Pa", "Largest alternating stress at the peak"),
    )
}
LIMITED_MEASURES = MEASURES | STRESS_MEASURES


@dataclass(frozen=True, eq=False)
class TractionRange:
    """Peaks of the case with central inputs over the residual tractions of its pairs, which are no inputs.

    peak, low, high:
        m: its highest peak, and the lowest and highest one over extreme residual tractions.
    curves:
        frequency in Hz and amplitude in m, 0-to-peak, of each of these tractions.
    """

    peak: float
    low: float
    high: float
    curves: tuple[tuple[FloatArray, FloatArray], ...]


@dataclass(frozen=True)
class Percentiles:
    """Percentiles of a measure: ``values`` for each of PERCENTILES, and ``intervals`` that contain those of the
    population with a confidence of 95 % (order statistics; NaN where the samples give no bound).

    ``count`` of all samples have the measure.
    """

    measure: BandMeasure
    values: tuple[float, ...]
    intervals: tuple[tuple[float, float], ...]
    count: int


def percentiles(measure: BandMeasure, table: SweepTable) -> Percentiles:
    """The percentiles of a measure over the samples that have it.

    Sample k of n in order is the quantile (k - 1/2) / n, as fits low-discrepancy points: one in each n-th part.
    """
    values = measure.of(table)
    values = values[np.isfinite(values)]
    if not values.size:
        return Percentiles(measure, (np.nan,) * 3, ((np.nan, np.nan),) * 3, 0)
    quantiles = np.percentile(values, PERCENTILES, method="hazen")
    intervals = (
        scipy.stats.quantile_test(values, p=0.01 * percent).confidence_interval(CONFIDENCE) for percent in PERCENTILES
    )
    ends = tuple((float(each.low), float(each.high)) for each in intervals)
    return Percentiles(measure, tuple(map(float, quantiles)), ends, values.size)


@dataclass(frozen=True)
class Limit:
    """A requirement such as ``peak_amplitude < 0.2 mm``: the text, its measure, sign and value in SI."""

    text: str
    measure: BandMeasure
    is_upper: bool
    value: float

    def violation(self, value: float) -> str:
        """How a value in SI misses the limit, in shown units with as many digits as distinguish the two; "" if it
        satisfies it."""
        if not (value > self.value if self.is_upper else value < self.value):
            return ""
        factor, unit = SHOWN[self.measure.unit]
        both = ((number(factor * value, digits), number(factor * self.value, digits)) for digits in range(4, 17))
        found, allowed = next((each for each in both if each[0] != each[1]), (repr(value), repr(self.value)))
        bound = "most" if self.is_upper else "least"
        return f"{found} {unit} instead of at {bound} {allowed} {unit} ({small(self.measure.words)})"


_QUANTITIES = {
    "m": Quantity("length", example='"0.2 mm"', above=0.0),
    "Hz": Quantity("frequency", example='"440 Hz"', above=0.0),
    "Pa": Quantity("pressure", example='"300 MPa"', above=0.0),
}
_LIMIT = re.compile(r"\s*([\w.]+)\s*([<>])(?!=)\s*(.*?)\s*")


def limit_of(
    text: str, measures: Mapping[str, BandMeasure] = LIMITED_MEASURES, of: str = "band", argument: str = "limits"
) -> Limit:
    """A limit from its text, of one of the ``measures`` ``of`` a band or design. Raises InputError."""
    match = _LIMIT.fullmatch(text)
    names = ", ".join(measures)
    if match is None:
        raise InputError(
            f'the limit "{text}" must be a measure, < or >, and a value with its unit, for example '
            f'"{next(iter(measures))} < 0.2 mm". Measures are {names}.',
            arguments=[argument],
        )
    measure = measures.get(match[1])
    if measure is None:
        raise InputError(
            f'the limit "{text}" is of {match[1]}, which is not a measure of a {of}. Measures are {names}.',
            arguments=[argument],
        )
    quantity = _QUANTITIES[measure.unit]
    if not match[3]:
        whole = f"{measure.name} {match[2]} {quantity.example.strip(chr(34))}"
        raise InputError(
            f'the limit "{text}" has no value after {match[2]}. Write for example "{whole}".', arguments=[argument]
        )
    try:
        value = quantity.parse(match[3])
    except InputError as error:
        raise InputError(f'the limit "{text}": {match[3]} {error}', arguments=[argument]) from error
    return Limit(text, measure, match[2] == "<", value)


def wants_stress(limits: Iterable[Limit]) -> bool:
    """Whether a limit is of a stress."""
    return any(limit.measure.name in STRESS_MEASURES for limit in limits)


@dataclass(frozen=True)
class Exceedance:
    """The probability that a limit is exceeded.

    exceeded:
        number of samples beyond the limit.
    undecided:
        number of samples that failed, or whose largest amplitude is at an end of the range. There an upper limit of the
        amplitude that is exceeded already is decided.
    count:
        number of all samples.
    probability:
        fraction of the decided samples; NaN if there is none.
    interval:
        contains the probability with a confidence of 95 % (C. J. Clopper, E. S. Pearson, Biometrika 26, 1934); for its
        lower end the undecided samples are within the limit, for its upper end beyond.
    """

    limit: Limit
    exceeded: int
    undecided: int
    count: int
    probability: float
    interval: tuple[float, float]


def exceedance(limit: Limit, table: SweepTable) -> Exceedance:
    """The probability that a limit is exceeded."""
    values = limit.measure.of(table)
    beyond = values > limit.value if limit.is_upper else values < limit.value
    is_open = np.array(table.column("peak_bracketed"), dtype=float) != 1.0
    # the true peak is not lower than the largest amplitude, so one that is beyond an upper limit already is decided
    undecided = is_open & (beyond != limit.is_upper if limit.measure.unit == "m" else True)
    undecided |= np.isnan(values)
    exceeded, open_count, count = int((beyond & ~undecided).sum()), int(undecided.sum()), values.size
    decided = count - open_count
    low = scipy.stats.binomtest(exceeded, count).proportion_ci(CONFIDENCE, "exact").low
    high = scipy.stats.binomtest(exceeded + open_count, count).proportion_ci(CONFIDENCE, "exact").high
    probability = exceeded / decided if decided else np.nan
    return Exceedance(limit, exceeded, open_count, count, probability, (float(low), float(high)))


@dataclass(frozen=True, eq=False)
class CurveBand:
    """Percentiles of the amplitude over the frequency.

    frequency_hz:
        (n_points,) common frequencies.
    amplitude_m:
        (3, n_points) for each of PERCENTILES; each curve counts with its highest branch. NaN without a curve.
    count:
        (n_points,) number of complete curves at each frequency.
    """

    frequency_hz: FloatArray
    amplitude_m: FloatArray
    count: NDArray[np.int64]


def curve_band(curves: Sequence[SweepCurve]) -> CurveBand | None:
    """The band of complete curves; None without one."""
    if not curves:
        return None
    every = np.unique(np.concatenate([curve.frequency_hz for curve in curves]))
    places = np.linspace(0.0, every.size - 1.0, min(GRID_POINTS, every.size))
    grid = np.interp(places, np.arange(every.size), every)
    heights = np.stack([highest_branch(curve, grid) for curve in curves])
    count = np.isfinite(heights).sum(axis=0)
    amplitude = np.full((len(PERCENTILES), grid.size), np.nan)
    for heights_here in np.unique(count[count > 0]):
        columns = count == heights_here
        present = np.sort(heights[:, columns], axis=0)[:heights_here]  # NaN is last
        amplitude[:, columns] = np.percentile(present, PERCENTILES, axis=0, method="hazen")
    return CurveBand(grid, amplitude, count)


def highest_branch(curve: SweepCurve, grid: FloatArray) -> FloatArray:
    """(n_points,) the largest amplitude of a curve at each frequency of an ascending grid.

    On the flank of a resonance the inverse of the amplitude is nearly a straight line over the frequency. It is
    interpolated between folds by monotone cubic pieces (F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17 (1980)
    238-246), so no value is outside of those of the two points beside it. NaN at frequencies that the curve does not
    pass.
    """
    result = np.full(grid.size, -np.inf)
    for frequency, amplitude in _between_folds(curve):
        inside = slice(np.searchsorted(grid, frequency[0], "left"), np.searchsorted(grid, frequency[-1], "right"))
        result[inside] = np.maximum(result[inside], _interpolated(frequency, amplitude, grid[inside]))
    result[np.isneginf(result)] = np.nan
    return result


def drawn_pieces(curve: SweepCurve, parts: int) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Frequencies and amplitudes (n,) of a curve between its folds and interruptions, each step in so many ``parts``,
    with the interpolation of :func:`highest_branch`."""
    for frequency, amplitude in _between_folds(curve):
        steps = np.arange(parts * (frequency.size - 1) + 1) / parts
        at = np.interp(steps, np.arange(frequency.size), frequency)
        # On an upright piece all places have one frequency, and the interpolation has no line between them.
        upright = frequency[0] == frequency[-1]
        yield (frequency, amplitude) if upright else (at, _interpolated(frequency, amplitude, at))


def _between_folds(curve: SweepCurve) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Frequencies and amplitudes (n,) of the pieces of a curve, with at least two points, along which its frequency
    changes in one direction or not; those of an ascending frequency."""
    way = np.sign(np.diff(curve.frequency_hz))
    joined = np.diff(curve.part) == 0
    ends = np.flatnonzero((np.diff(way) != 0) | ~joined[1:] | ~joined[:-1]) + 1
    for first, last in itertools.pairwise([0, *ends.tolist(), way.size]):
        if first < last and joined[first]:
            frequency, amplitude = curve.frequency_hz[first : last + 1], curve.amplitude_m[first : last + 1]
            forward = 1 if frequency[0] <= frequency[-1] else -1
            yield frequency[::forward], amplitude[::forward]


def _interpolated(frequency: FloatArray, amplitude: FloatArray, at: FloatArray) -> FloatArray:
    """The amplitude at frequencies of a piece of a curve; linear between two points, and where it is zero."""
    if frequency[0] == frequency[-1]:
        return np.full(at.size, amplitude.max())
    if frequency.size == 2 or not amplitude.all():
        return np.interp(at, frequency, amplitude)
    return np.asarray(1.0 / PchipInterpolator(frequency, 1.0 / amplitude)(at))
