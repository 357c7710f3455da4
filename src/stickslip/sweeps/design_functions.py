"""From evaluated designs to the functions of the optimiser: logarithms of peaks, frequencies and stresses.

Each high peak of each load case is a function of its own, so that the optimiser sees the corner where another peak
becomes the highest. Peaks are in the order of their frequencies. An absent one repeats the highest, lower by FAR_BELOW.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.results.band import STRESS_MEASURES, Limit
from stickslip.results.design import PEAK, PEAK_FREQUENCY, DesignCase, DesignPeak, Evaluation
from stickslip.sweeps.design_cases import DesignCases, Request
from stickslip.sweeps.design_task import MOST_PEAKS
from stickslip.sweeps.minimax import Functions

FAR_BELOW = math.log(2.0)
# chosen: the optimiser satisfies limits with this room, in logarithms, because it stops within its tolerance of them.
ROOM = 5e-4
FAR_FROM_LIMIT = 0.7  # chosen: of the limit of a stress
DIFFERENCE_STEP = 0.01  # chosen: of the range of a key, to both sides
Ask = Callable[[list[Request]], list[Evaluation]]


class DesignFunctions:
    """The functions and constraints of a design for one descent, with their derivatives by the coordinates.

    Derivatives of peaks and their frequencies are those of :func:`stickslip.peak_gradients`; central differences of
    whole solutions replace what has none: stresses, peaks at a corner, and keys without a derivative.
    """

    def __init__(self, cases: DesignCases, ask: Ask, stage: str) -> None:
        self._cases, self._ask, self._stage = cases, ask, stage
        self.visited: list[Evaluation] = []

    def values(self, point: FloatArray) -> Functions | None:
        """Functions and constraints at coordinates (n,); None for a failed design."""
        evaluation = self._at(point)
        if evaluation.failure:
            return None
        return self._functions(evaluation)

    def slopes(self, point: FloatArray) -> Functions:
        """Derivatives (m, n) and (k, n) at coordinates (n,); zero for a failed design."""
        evaluation, size = self._at(point), len(self._cases.space.keys)
        if evaluation.failure:
            return Functions(np.zeros((self._n_functions, size)), np.zeros((self._n_constraints, size)))
        columns = [self._exact_column(evaluation, place) for place in range(size)]
        missing = [place for place in range(size) if np.isnan(columns[place]).any()]
        if missing:
            differences = self._differences(evaluation, missing)
            for place, column in zip(missing, differences, strict=True):
                columns[place] = np.where(np.isnan(columns[place]), column, columns[place])
            self._cases.used_differences(evaluation, self._words(missing))
        table = np.column_stack(columns)
        return Functions(table[: self._n_functions], table[self._n_functions :])

    def _words(self, missing: Sequence[int]) -> str:
        return f"differences by {', '.join(self._cases.space.keys[place].name for place in missing)}"

    def _at(self, point: FloatArray) -> Evaluation:
        evaluation = self._ask([Request(point, self._stage, wants_gradients=True)])[0]
        self.visited.append(evaluation)
        return evaluation

    @property
    def _n_functions(self) -> int:
        return len(self._cases.space.load_cases) * self._slots(self._cases.requirements.measure.name)

    @property
    def _n_constraints(self) -> int:
        names = [limit.measure.name for limit in self._cases.requirements.limits]
        return len(self._cases.space.load_cases) * sum(map(self._slots, names))

    @staticmethod
    def _slots(measure: str) -> int:
        return MOST_PEAKS if measure == PEAK else 1

    def _functions(self, evaluation: Evaluation) -> Functions:
        requirements = self._cases.requirements
        functions = [value for case in evaluation.cases for value in _logarithms(case, requirements.measure.name)]
        constraints = [
            _room(limit, value)
            for limit in requirements.limits
            for case in evaluation.cases
            for value in _logarithms(case, limit.measure.name)
        ]
        return Functions(np.array(functions), np.array(constraints))

    def _exact_column(self, evaluation: Evaluation, place: int) -> FloatArray:
        """Derivatives of all functions and constraints by a coordinate; NaN for those without."""
        key, requirements = self._cases.space.keys[place], self._cases.requirements
        by_coordinate = key.slope(evaluation.values[place])

        def column(measure: str) -> list[float]:
            slopes = [each for case in evaluation.cases for each in _slopes(case, measure, key.name)]
            return [slope * by_coordinate for slope in slopes]

        rows = column(requirements.measure.name)
        for limit in requirements.limits:
            slopes = column(limit.measure.name)
            if _is_far(limit, evaluation):
                slopes = [by_coordinate * _slopes(case, PEAK, key.name)[0] for case in evaluation.cases]
            rows += [-slope if limit.is_upper else slope for slope in slopes]
        return np.array(rows)

    def _differences(self, evaluation: Evaluation, places: Sequence[int]) -> list[FloatArray]:
        """Central differences by coordinates, one-sided at a bound or beside a failed design; zero between two."""
        at = np.array(evaluation.coordinates)
        requests = []
        for place in places:
            for sign in (-1.0, 1.0):
                moved = at.copy()
                moved[place] = min(1.0, max(0.0, at[place] + sign * DIFFERENCE_STEP))
                requests.append(Request(moved, "difference"))
        sides = iter(self._ask(requests))
        columns = []
        for place in places:
            pair = [each if not each.failure else evaluation for each in (next(sides), next(sides))]
            width = pair[1].coordinates[place] - pair[0].coordinates[place]
            low, high = (self._beside(evaluation, each) for each in pair)
            columns.append((high - low) / width if width > 0.0 else np.zeros(low.size))
        return columns

    def _beside(self, evaluation: Evaluation, other: Evaluation) -> FloatArray:
        """Functions and constraints of another evaluation, each peak being the one that is nearest in frequency."""
        matched = []
        for case, neighbour in zip(evaluation.cases, other.cases, strict=True):
            peaks = tuple(
                min(neighbour.peaks, key=lambda each: abs(each.frequency_hz - peak.frequency_hz)) for peak in case.peaks
            )
            matched.append(DesignCase("", "", "", peaks, neighbour.stresses))
        values = self._functions(Evaluation(0, "", other.coordinates, other.values, tuple(matched), 0.0, (), 0.0))
        return np.concatenate([values.functions, values.constraints])


def _is_far(limit: Limit, evaluation: Evaluation) -> bool:
    """Whether a stress is so far below its limit that the slope of a peak does for its own, which takes two further
    solutions for each key: the constraint then has no effect on the next step."""
    if limit.measure.name not in STRESS_MEASURES or not limit.is_upper:
        return False
    return all(case.value(limit.measure.name) < FAR_FROM_LIMIT * limit.value for case in evaluation.cases)


def _room(limit: Limit, logarithm: float) -> float:
    """Positive if a limit is satisfied."""
    room = math.log(limit.value) - logarithm
    return (room if limit.is_upper else -room) - ROOM


def _in_slots(case: DesignCase) -> list[tuple[DesignPeak, float]]:
    """A peak and its shift for each slot, by frequency; absent ones follow the highest."""
    ordered = sorted(case.peaks, key=lambda each: each.frequency_hz)
    rows = [(peak, 0.0) for peak in ordered]
    return rows + [(case.peaks[0], FAR_BELOW)] * (MOST_PEAKS - len(rows))


def _logarithms(case: DesignCase, measure: str) -> list[float]:
    """The logarithms of a measure: one for each slot of a peak, or one."""
    if measure == PEAK:
        return [math.log(peak.amplitude_m) - shift for peak, shift in _in_slots(case)]
    return [math.log(case.value(measure))]


def _slopes(case: DesignCase, measure: str, key: str) -> list[float]:
    """Derivatives of the same by a key in SI; NaN if they are not known."""
    if measure == PEAK:
        return [peak.by_amplitude.get(key, math.nan) / peak.amplitude_m for peak, _ in _in_slots(case)]
    highest = case.peaks[0]
    if measure == PEAK_FREQUENCY:
        return [highest.by_frequency_hz.get(key, math.nan) / highest.frequency_hz]
    return [math.nan]
