"""A design in numbers: its keys, the cases of each evaluated design, and what an optimum is worth."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

import numpy as np

from stickslip.core.errors import ResultsFileError
from stickslip.core.files import whole_file
from stickslip.core.shown_numbers import small
from stickslip.core.units import Quantity
from stickslip.core.validation import FloatArray
from stickslip.results.band import STRESS_MEASURES, BandMeasure, Limit
from stickslip.results.sweep_table import SweepCurve

PEAK = "peak"
PEAK_FREQUENCY = "peak_frequency"
DESIGN_MEASURES = {
    each.name: each
    for each in (
        BandMeasure(PEAK, "peak_amplitude_m", "m", "Highest peak"),
        BandMeasure(PEAK_FREQUENCY, "peak_frequency_hz", "Hz", "Frequency of the highest peak"),
        *STRESS_MEASURES.values(),
    )
}
# A range over this factor or more is divided by factors, else by steps.
LOGARITHMIC_FROM = 10.0
COST = 1.05  # what "how sharp" refers to: the change of a key that costs 5 %
SAME_VALUE, SAME_PLACE = 0.01, 0.05  # chosen: two optima agree within 1 % of value, 5 % of each range
AT_BOUND = 1e-3  # chosen: fraction of the range
BETTER_POSSIBLE = "so a better optimum is possible"  # words of sentences that the page repeats as a warning
EQUALLY_HIGH = 0.01  # chosen: two peaks within 1 % of each other
ACTIVE = 0.01  # chosen: a limit within 1 % of its value
# Of a corner, the rise over twice the distance is twice as large; of a parabola, four times.
CORNER_RATIO = 2.8


@dataclass(frozen=True)
class DesignKey:
    """A key that a design varies between ``low`` and ``high`` (SI); ``start`` is its value in the study."""

    name: str
    quantity: Quantity
    low: float
    high: float
    start: float

    @property
    def is_logarithmic(self) -> bool:
        """Whether equal steps of the coordinate are equal factors."""
        return self.low > 0.0 and self.high >= LOGARITHMIC_FROM * self.low

    @property
    def unit(self) -> str:
        """The unit that texts show."""
        return self.quantity.shown_unit[0]

    def at(self, coordinate: float) -> float:
        """The value in SI at a coordinate from 0 (low) to 1 (high)."""
        if min(coordinate, 1.0 - coordinate) < 1e-9:  # a step to a bound, with its round-off
            return self.low if coordinate < 0.5 else self.high
        if self.is_logarithmic:
            value = self.low * (self.high / self.low) ** coordinate
        else:
            value = self.low + coordinate * (self.high - self.low)
        return float(f"{value:.12g}")

    def coordinate(self, value: float) -> float:
        """The coordinate of a value in SI."""
        if self.is_logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low) if value > 0.0 else -math.inf
        return (value - self.low) / (self.high - self.low)

    def slope(self, value: float) -> float:
        """Derivative of the value by the coordinate."""
        return value * math.log(self.high / self.low) if self.is_logarithmic else self.high - self.low

    def shown(self, value: float) -> float:
        """A value in the unit that texts show."""
        return value / self.quantity.shown_unit[1]

    def label(self, value: float) -> str:
        """A value in words, such as "500 N"."""
        return f"{self.shown(value):.5g} {self.unit}".rstrip()


@dataclass(frozen=True)
class DesignPeak:
    """A high peak of a case: amplitude in m, frequency in Hz, and their derivatives by keys (SI), where known."""

    amplitude_m: float
    frequency_hz: float
    by_amplitude: Mapping[str, float] = field(default_factory=dict)
    by_frequency_hz: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class DesignCase:
    """One load case of a design.

    name, file:
        of the case in the folder; file "" if there is none.
    failure:
        the reason why it does not count, or "".
    peaks:
        the high peaks, highest first.
    stresses:
        measure -> Pa, at the highest peak.
    """

    name: str
    file: str
    failure: str
    peaks: tuple[DesignPeak, ...] = ()
    stresses: Mapping[str, float] = field(default_factory=dict)
    curve: SweepCurve | None = None
    messages: tuple[str, ...] = ()

    def value(self, measure: str) -> float:
        """A measure in SI."""
        if measure == PEAK:
            return self.peaks[0].amplitude_m
        return self.peaks[0].frequency_hz if measure == PEAK_FREQUENCY else self.stresses[measure]


@dataclass(frozen=True, eq=False)
class Evaluation:
    """A design that was computed.

    stage:
        "sample", "start 1" and so on, "difference" or "sharpness".
    coordinates, values:
        (n_keys,) from 0 to 1 in the ranges; in SI.
    cases:
        one for each load case.
    objective:
        the worst value of the measure that is minimised, SI; NaN for a failed design.
    required:
        the worst value of the measure of each limit, SI.
    excess:
        largest violation of a limit, as a fraction of it; 0 if all are satisfied.
    gradient:
        "exact", "differences" (of some or all keys) or "none".
    """

    number: int
    stage: str
    coordinates: tuple[float, ...]
    values: tuple[float, ...]
    cases: tuple[DesignCase, ...]
    objective: float
    required: tuple[float, ...]
    excess: float
    gradient: str = "none"

    @property
    def failure(self) -> str:
        """The reason why the design does not count, or ""."""
        return next((case.failure for case in self.cases if case.failure), "")

    @property
    def is_allowed(self) -> bool:
        """Whether it has a result that satisfies all limits."""
        return not self.failure and self.excess == 0.0

    @property
    def rank(self) -> tuple[float, float]:
        """Smaller is better: allowed designs by objective, others by their violation."""
        if self.failure:
            return math.inf, math.inf
        return self.excess, self.objective


@dataclass(frozen=True)
class StartResult:
    """A descent of the optimiser: positions of its first and its best evaluation, its end in words, and whether its
    optimum agrees with the best one in value and in place."""

    first: int
    best: int
    message: str
    same_value: bool
    same_place: bool


@dataclass(frozen=True)
class Sharpness:
    """The change of the optimum along one key, all others constant.

    values, objective, excess:
        (n,) rising values of the key in SI, the objective in SI (NaN failed), and the violation of limits there.
    lower, upper:
        values in SI at which the objective is 5 % higher; None if the range ends first.
    shape:
        "smooth", "corner" or "bound".
    """

    key: str
    values: FloatArray
    objective: FloatArray
    excess: FloatArray
    lower: float | None
    upper: float | None
    shape: str

    @property
    def is_beside_failure(self) -> bool:
        """Whether the design next to the optimum, on one of its sides, has no result."""
        best = int(np.nanargmin(np.where(self.excess > 0.0, np.nan, self.objective)))
        return bool(np.isnan(self.objective[max(0, best - 1) : best + 2]).any())


@dataclass(frozen=True, eq=False)
class DesignResult:
    """The result of a design.

    keys, load_cases:
        what varied, and words for each load case.
    measure, limits:
        what was minimised under which limits.
    evaluations:
        every computed design, in order; ``best`` is the position of the optimum, None if no design satisfies the
        limits.
    starts, sharpness:
        the descents, and the neighbourhood of the optimum along each key.
    remarks:
        sentences on the optimum and on the search.
    cautions:
        sentences on the ranges that are known before anything is solved, such as the lock-up of a damper in them.
    """

    keys: tuple[DesignKey, ...]
    load_cases: tuple[str, ...]
    measure: BandMeasure
    limits: tuple[Limit, ...]
    evaluations: tuple[Evaluation, ...]
    best: int | None
    starts: tuple[StartResult, ...]
    sharpness: tuple[Sharpness, ...]
    remarks: tuple[str, ...]
    cautions: tuple[str, ...]

    @property
    def has_results(self) -> bool:
        """Whether a design has a result, allowed or not."""
        return not all(each.failure for each in self.evaluations)

    @property
    def optimum(self) -> Evaluation | None:
        """The best design, or None."""
        return None if self.best is None else self.evaluations[self.best]

    @property
    def nearest(self) -> Evaluation | None:
        """The design with the smallest violation, where no design satisfies the limits; else None."""
        has_one = self.best is None and self.has_results
        return min(self.evaluations, key=lambda each: each.rank) if has_one else None

    def violations(self, design: Evaluation) -> str:
        """How a design misses limits, in words; "" if it satisfies all."""
        words = (limit.violation(value) for limit, value in zip(self.limits, design.required, strict=True))
        return " and ".join(filter(None, words))

    def __repr__(self) -> str:
        best = self.optimum
        if best is None:
            words = "satisfies the limits" if self.has_results else "has a result"
            return f"DesignResult(no design of {len(self.evaluations)} {words})"
        values = ", ".join(
            f"{key.name} = {key.label(value)}" for key, value in zip(self.keys, best.values, strict=True)
        )
        return f"DesignResult({self.measure.name} {best.objective:.5g} {self.measure.unit} at {values})"

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Write one row for each design: stage, keys, objective and limits in SI, gradient, message.

        Raises ResultsFileError if the file cannot be written.
        """
        with (
            whole_file(Path(path), "table", ResultsFileError) as part,
            part.open("w", encoding="utf-8", newline="") as stream,
        ):
            writer = csv.writer(stream)
            required = [f"{each.measure.column} ({each.text})" for each in self.limits]
            names = (key.name for key in self.keys)
            writer.writerow(
                ["design", "stage", *names, self.measure.column, *required, "excess", "gradient", "cases", "message"]
            )
            for each in self.evaluations:
                cells = [*each.values, each.objective, *each.required, each.excess]
                numbers = ["" if math.isnan(value) else repr(value) for value in cells]
                cases = " ".join(case.name for case in each.cases)
                writer.writerow([each.number, each.stage, *numbers, each.gradient, cases, each.failure])


def crossing(distance: Sequence[float], ratio: Sequence[float]) -> float | None:
    """The first distance at which a ratio, 1 at 0, reaches COST; linear between its points, None if it does not."""
    before, below = 0.0, 1.0
    for at, value in zip(distance, ratio, strict=True):
        if math.isnan(value):
            return None
        if value >= COST:
            return before + (at - before) * (COST - below) / (value - below)
        before, below = at, value
    return None


def shape_of(key: DesignKey, optimum: float, coordinates: FloatArray, ratio: FloatArray) -> str:
    """Whether the objective along a key is smooth at an optimum, has a corner, or ends at a bound.

    ``ratio`` (n,) at the ``coordinates`` (n,) to the objective of the optimum. At a corner, the rise on both sides is
    proportional to the distance; of a parabola, to its square.
    """
    if min(optimum, 1.0 - optimum) <= AT_BOUND:
        return "bound"
    for sign in (-1.0, 1.0):
        distance = sign * (coordinates - optimum)
        side = np.argsort(distance)
        side = side[distance[side] > 1e-9][:2]
        if side.size < 2:
            return "smooth"
        near, far = ratio[side] - 1.0
        stretch = distance[side[1]] / distance[side[0]]
        if not (near > 0.0 and far / near < CORNER_RATIO ** math.log2(stretch)):
            return "smooth"
    return "corner"


def optimum_sentences(result: DesignResult) -> Iterator[str]:
    """Where the optimum is: interior, on a bound, at a limit, or where two peaks or load cases are equally high."""
    best = result.optimum
    if best is None:
        return
    on_bound = [
        f"{key.name} = {key.label(value)}"
        for key, at, value in zip(result.keys, best.coordinates, best.values, strict=True)
        if min(at, 1.0 - at) <= AT_BOUND
    ]
    active = [
        limit.text
        for limit, value in zip(result.limits, best.required, strict=True)
        if abs(value / limit.value - 1.0) <= ACTIVE
    ]
    equal = list(_equally_high(result, best))
    corners = [each.key for each in result.sharpness if each.shape == "corner"]
    if on_bound:
        yield f"The optimum is on a bound: {', '.join(on_bound)}. A wider range may give a better design."
    if active:
        yield f"The optimum is at the limit {', '.join(active)}."
    if equal:
        yield f"The optimum is at a switch: {' and '.join(equal)} are equally high within {100 * EQUALLY_HIGH:g} %."
    if corners and not equal:
        yield (
            f"The optimum is at a corner along {', '.join(corners)}: the {small(result.measure.words)} rises with a "
            "finite slope to both sides."
        )
    edges = [each.key for each in result.sharpness if each.is_beside_failure]
    if edges:
        yield f"Beside the optimum, designs along {', '.join(edges)} have no result; it may be at their edge."
    if not (on_bound or active or equal or corners or edges):
        yield "The optimum is interior: no bound, no limit, and one highest peak."


def _equally_high(result: DesignResult, best: Evaluation) -> Iterator[str]:
    """The highest peaks, or load cases, within EQUALLY_HIGH of the worst, if there are two or more."""
    rows = []
    for case, words in zip(best.cases, result.load_cases or ("",), strict=True):
        where = f" of {words}" if words else ""
        if result.measure.name == PEAK:
            rows += [(peak.amplitude_m, f"the peak at {peak.frequency_hz:.1f} Hz{where}") for peak in case.peaks]
        else:
            rows.append((case.value(result.measure.name), f"the value{where}"))
    high = [words for value, words in rows if value >= best.objective * (1.0 - EQUALLY_HIGH)]
    if len(high) > 1:
        yield from high


def agreement_sentence(result: DesignResult) -> str:
    """Number of descents that agree with the best one."""
    count, value = len(result.starts), sum(each.same_value for each in result.starts)
    place = sum(each.same_place for each in result.starts)
    if count == 1:
        return f"There was one start only, {BETTER_POSSIBLE}: use more samples and starts."
    words = f"{value} of {count} starts reach the same optimum within {100 * SAME_VALUE:g} % of its value"
    if place < value:
        words += f", {place} of them at the same design"
    warning = f" Only one start leads to it, {BETTER_POSSIBLE}: use more samples and starts."
    return f"{words}.{warning if value == 1 else ''}"
