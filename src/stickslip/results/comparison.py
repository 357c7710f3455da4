"""Several results beside each other: measures with differences to the first one, and inputs that differ."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.results.measures import SUMMARY_COLUMNS
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.sweep_table import SweepCurve, curve_and_measures, short_key
from stickslip.results.table import Table, column_of

_LONGEST_NAME = 60  # chosen: letters, in one line of a legend
_CHECKSUM = re.compile(r"_[0-9a-f]{12}$")  # as stickslip.sweeps.plan.case_name ends
_DIGITS = re.compile(r"(?<![\w.])\d+\.\d{3,}(?:e[-+]?\d+)?")  # numbers with more digits than a name needs


@dataclass(frozen=True, eq=False)
class Compared:
    """A result under a short name."""

    name: str
    response: ForcedResponse
    study: StudyRecord

    def curve_and_measures(self) -> tuple[SweepCurve, dict[str, float]]:
        """The amplitude curve, and the measures that are defined, by the names of :data:`MEASURES`."""
        curve, measures = curve_and_measures(self.response, self.study)
        return curve, measures | dict(_stress_measures(self.study))


@dataclass(frozen=True)
class ComparedMeasure:
    """A measure of each result (None where it is not defined), in SI units.

    ``differences`` are ``value / first - 1``, None without both values or with a first value of zero.
    """

    name: str
    unit: str
    meaning: str
    values: tuple[float | None, ...]

    @property
    def differences(self) -> tuple[float | None, ...]:
        first = self.values[0]
        return tuple(None if value is None or not first else value / first - 1.0 for value in self.values)


def compared_measures(measures: Sequence[Mapping[str, float]]) -> tuple[ComparedMeasure, ...]:
    """Each measure that at least one result has, in the order of the summary."""
    about = {name: (unit, meaning) for name, (unit, meaning, _) in SUMMARY_COLUMNS.items()}
    about |= {
        "largest_von_mises_pa": ("Pa", "largest von Mises stress of the cycle, away from contacts and loads"),
        "alternating_stress_pa": ("Pa", "largest alternating stress, away from contacts and loads"),
        "smallest_safety_factor": ("1", "smallest safety factor of the Goodman check"),
    }
    return tuple(
        ComparedMeasure(name, unit, meaning, tuple(each.get(name) for each in measures))
        for name, (unit, meaning) in about.items()
        if any(name in each for each in measures)
    )


def differing_inputs(studies: Sequence[StudyRecord]) -> dict[str, tuple[str | None, ...]]:
    """Key of a study file -> its value in each study as it is written there, None where absent; equal ones omitted.

    Keys are dotted, such as ``interfaces.lid.normal_load``. Raises InputError for inputs that are no study file.
    """
    flat = [study.input_values() for study in studies]
    keys = dict.fromkeys(key for each in flat for key in each)
    values = {key: tuple(each.get(key) for each in flat) for key in keys}
    return {key: row for key, row in values.items() if len(set(row)) > 1}


def names_of_cases(names: Sequence[str], studies: Sequence[StudyRecord]) -> tuple[str, ...]:
    """Names for cases of a sweep, whose folders end in a checksum: the inputs that differ, as "speed 3000 rpm" or,
    where the key alone says too little, "friction coefficient 0.2".

    Numbers have four digits if the names then still differ. Where these are long or equal, the ``names`` of the folders
    remain, without their checksums if they then differ.
    """
    inputs = differing_inputs(studies)
    words = [short_key(key) for key in inputs]
    described = [
        ", ".join(f"{word} {'none' if value is None else value}" for word, value in zip(words, row, strict=True))
        for row in zip(*inputs.values(), strict=True)
    ]
    for each in ([_DIGITS.sub(_rounded, text) for text in described], described):
        if each and len(set(each)) == len(names) and max(map(len, each)) <= _LONGEST_NAME:
            return tuple(each)
    plain = tuple(_CHECKSUM.sub("", name) for name in names)
    return plain if len(set(plain)) == len(names) else tuple(names)


def _rounded(found: re.Match[str]) -> str:
    return f"{float(found.group()):.4g}"


def comparison_tables(compared: Sequence[Compared]) -> tuple[Table, ...]:
    """Measures with differences to the first result, inputs that differ, and the curves, in SI units."""
    both = [each.curve_and_measures() for each in compared]
    names = [each.name for each in compared]
    rows = compared_measures([numbers for _, numbers in both])
    inputs = differing_inputs([each.study for each in compared])
    measures = [
        column_of("measure", "", [row.name for row in rows]),
        column_of("unit", "", [row.unit for row in rows]),
        column_of("meaning", "", [row.meaning for row in rows]),
        *(column_of(name, "", [row.values[at] for row in rows]) for at, name in enumerate(names)),
        *(
            column_of(f"{name} over {names[0]} - 1", "1", [row.differences[at] for row in rows])
            for at, name in enumerate(names[1:], start=1)
        ),
    ]
    keys = [column_of("key", "", list(inputs))]
    keys += [column_of(name, "", [row[at] for row in inputs.values()]) for at, name in enumerate(names)]
    curves = [
        column_of("result", "", [name for name, (curve, _) in zip(names, both, strict=True) for _ in curve.part]),
        column_of("frequency", "Hz", np.concatenate([curve.frequency_hz for curve, _ in both])),
        column_of("amplitude", "m", np.concatenate([curve.amplitude_m for curve, _ in both])),
        column_of("stable", "", np.concatenate([curve.stable for curve, _ in both])),
    ]
    return (
        Table("measures", "measures at the highest peak of each result", tuple(measures)),
        Table("inputs", "inputs that differ", tuple(keys)),
        Table("curves", "amplitude of the response of each result, 0-to-peak", tuple(curves)),
    )


def amplitude_at(curve: SweepCurve, frequency_hz: FloatArray) -> FloatArray:
    """(k,) m, the largest amplitude of a curve at frequencies (k,); NaN outside of its range.

    The curve may fold; between neighbouring points it is straight, and parts that are not joined have a gap.
    """
    largest = np.full(np.shape(frequency_hz), np.nan)
    joined = np.diff(curve.part) == 0
    starts = zip(curve.frequency_hz[:-1][joined], curve.amplitude_m[:-1][joined], strict=True)
    stops = zip(curve.frequency_hz[1:][joined], curve.amplitude_m[1:][joined], strict=True)
    for (first_hz, first), (last_hz, last) in zip(starts, stops, strict=True):
        low, high = sorted((first_hz, last_hz))
        here = (frequency_hz >= low) & (frequency_hz <= high)
        share = (frequency_hz[here] - first_hz) / (last_hz - first_hz) if high > low else np.ones(int(here.sum()))
        largest[here] = np.fmax(largest[here], first + share * (last - first))
    return largest


def _stress_measures(study: StudyRecord) -> Iterator[tuple[str, float]]:
    if study.stress is None:
        return
    names = {"largest von Mises stress": "largest_von_mises_pa", "alternating stress": "alternating_stress_pa"}
    yield from ((names[row.quantity], row.value) for row in study.stress.extremes if row.quantity in names)
    if study.stress.goodman:
        yield "smallest_safety_factor", min(row.value for row in study.stress.goodman)
