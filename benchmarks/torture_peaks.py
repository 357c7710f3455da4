"""Whether a curve stepped over a resonance: an independent search with other starts and much shorter steps.

``search`` solves the same equations again

* around each natural frequency of the linear limits inside the range, stuck and free: ten half-power widths to both
  sides, from a first point of its own, with steps of at most a quarter of the smallest width there. Overlapping parts
  of the range are solved at once;
* over the complete range in the opposite direction, with a quarter of the default largest step.

A maximum of such a curve (not its ends) is a missed peak if it is more than 1 % higher than the highest point of the
tested curve near it, and no warning of the tested curve names its frequency. "Near" is the part of the range just
described, and for the complete range a fiftieth of it on both sides; where the tested curve enters or leaves this
part, it counts with its linear interpolation. Maxima below 1 % of the highest amplitude are invisible in a plot and do
not count. Curves of the search that end early count as far as they go; ``Search.incomplete`` is their number.

What it cannot see: a resonance narrower than about a hundredth of the range that is away from all stuck and free
natural frequencies (a mode of a joint that another resonance makes slip or open); a resonance that the search steps
over too, because it begins outside of these parts of the range; isolated curves, except if a new start meets one by
chance, which then counts as missed. It compares one output, with the harmonics and samples of the tested curve, and so
says nothing about their number.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from torture_problems import Problem, ResidualTraction, Resonance
from torture_structures import FloatArray

import stickslip as ss

Progress = Callable[[float, str], None]

WIDTHS_BESIDE = 10.0  # half-power widths on both sides of a natural frequency
STEPS_PER_WIDTH = 4.0
FINER = 4.0  # shorter steps over the complete range
NEAR_FRACTION = 0.02  # of the complete range
MOST_POINTS = 4000
HIGHER = 1.01  # a missed peak exceeds the tested curve by this factor
LEAST_HEIGHT = 0.01  # of the highest amplitude
NAMED_WITHIN = 2e-3  # a warning names a peak if its frequency differs by less than this fraction


@dataclass(frozen=True)
class MissedPeak:
    """A peak that the tested curve does not have, its amplitude and the one of the tested curve near it in m."""

    frequency_hz: float
    amplitude: float
    tested_amplitude: float


@dataclass(frozen=True)
class Search:
    """The missed peaks, the number of curves of the search, and how many of them are not complete."""

    missed: list[MissedPeak]
    curves: int
    incomplete: int


@dataclass(frozen=True)
class Curve:
    """Frequency in Hz and amplitude in m along a curve, and the warnings of the solver."""

    frequency_hz: FloatArray
    amplitude: FloatArray
    warnings: tuple[str, ...]

    def highest_between(self, low_hz: float, high_hz: float) -> float:
        """Highest amplitude in a part of the range, its ends included; 0 if the curve is never there."""
        highest = 0.0
        inside = (self.frequency_hz >= low_hz) & (self.frequency_hz <= high_hz)
        if inside.any():
            highest = float(self.amplitude[inside].max())
        before, after = self.frequency_hz[:-1], self.frequency_hz[1:]
        for edge in (low_hz, high_hz):
            crossed = np.flatnonzero((before - edge) * (after - edge) < 0.0)
            fraction = (edge - before[crossed]) / (after[crossed] - before[crossed])
            at_edge = self.amplitude[crossed] + fraction * (self.amplitude[crossed + 1] - self.amplitude[crossed])
            highest = max([highest, *at_edge.tolist()])
        return highest

    def names(self, frequency_hz: float) -> bool:
        """Whether a warning names a frequency."""
        lists = re.findall(r"((?:[\d.]+, )*[\d.]+(?:, \.\.\.)?) Hz", " ".join(self.warnings))
        named = [float(number) for words in lists for number in re.findall(r"\d+\.?\d*", words)]
        return any(abs(each - frequency_hz) <= NAMED_WITHIN * frequency_hz for each in named)


def curve_of(problem: Problem, response: ss.ForcedResponse) -> Curve:
    """The curve of the output of a problem."""
    amplitude = response.amplitude(problem.structure.output)
    return Curve(response.frequency_hz, amplitude, tuple(response.warnings))


def search(
    problem: Problem, tested: Curve, residual_traction: ResidualTraction, harmonics: int, progress: Progress
) -> Search:
    """Peaks that a tested curve of a problem does not have; see the head of this file."""
    default = ss.ContinuationSettings()
    complete_range = (problem.window_hz[1], problem.window_hz[0])
    parts = [*parts_of(problem.resonances, problem.window_hz), (complete_range, default.largest_step / FINER)]
    missed, incomplete = [], 0
    for part_hz, largest_step in parts:
        settings = ss.ContinuationSettings(
            largest_step=min(largest_step, default.largest_step),
            first_step=min(largest_step, default.first_step),
            max_points=MOST_POINTS,
        )
        try:
            response = problem.solve(residual_traction, part_hz, harmonics, continuation=settings, progress=progress)
        except ss.ConvergenceError:
            incomplete += 1
            continue
        incomplete += not response.converged
        near_hz = NEAR_FRACTION * abs(part_hz[1] - part_hz[0]) if part_hz == complete_range else np.inf
        missed += higher_maxima(curve_of(problem, response), tested, part_hz, near_hz)
    return Search(distinct(missed), len(parts), incomplete)


def higher_maxima(fine: Curve, tested: Curve, part_hz: tuple[float, float], near_hz: float) -> list[MissedPeak]:
    """Maxima of a finer curve that a tested curve does not have within ``near_hz`` inside a part of the range."""
    low, high = sorted(part_hz)
    inner = fine.amplitude[1:-1]
    missed = []
    for top in 1 + np.flatnonzero((inner >= fine.amplitude[:-2]) & (inner > fine.amplitude[2:])):
        hertz, amplitude = float(fine.frequency_hz[top]), float(fine.amplitude[top])
        near = tested.highest_between(max(low, hertz - near_hz), min(high, hertz + near_hz))
        is_visible = amplitude >= LEAST_HEIGHT * tested.amplitude.max()
        if is_visible and amplitude > HIGHER * near and not tested.names(hertz):
            missed.append(MissedPeak(hertz, amplitude, near))
    return missed


def parts_of(
    resonances: Sequence[Resonance], window_hz: tuple[float, float]
) -> Iterator[tuple[tuple[float, float], float]]:
    """Parts of the range around natural frequencies, and their largest step as a fraction of the part."""
    low, high = sorted(window_hz)
    parts: list[tuple[float, float, float]] = []
    for each in resonances:  # in order of their frequency
        begin = max(low, each.frequency_hz - WIDTHS_BESIDE * each.width_hz)
        end = min(high, each.frequency_hz + WIDTHS_BESIDE * each.width_hz)
        width = each.width_hz
        while parts and begin <= parts[-1][1]:
            earlier = parts.pop()
            begin, end, width = min(begin, earlier[0]), max(end, earlier[1]), min(width, earlier[2])
        parts.append((begin, end, width))
    for begin, end, width in parts:
        yield (begin, end), width / STEPS_PER_WIDTH / (end - begin)


def distinct(missed: Sequence[MissedPeak]) -> list[MissedPeak]:
    """One for each frequency, the highest."""
    answer: list[MissedPeak] = []
    for each in sorted(missed, key=lambda peak: -peak.amplitude):
        if all(abs(each.frequency_hz - other.frequency_hz) > NAMED_WITHIN * other.frequency_hz for other in answer):
            answer.append(each)
    return answer
