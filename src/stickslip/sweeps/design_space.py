"""The box of a design: its keys and load cases, the check of its geometry, and its low-discrepancy samples."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.stats

from stickslip.case.case import Case
from stickslip.case.key_ranges import Limits, continuous_quantity, rising_range
from stickslip.core.errors import InputError, StickslipError, StudyFileError, concerning
from stickslip.core.validation import FloatArray
from stickslip.model.layout import Layout
from stickslip.model.model import load_joint, set_up
from stickslip.results.design import DesignKey
from stickslip.results.sweep_table import SweptKey, Value
from stickslip.sweeps.axes import Vary, study_value, swept_keys
from stickslip.sweeps.plan import case_hashes, require_one_curve

Range = str | Limits
MOST_KEYS = 8  # chosen: the number of samples that fill a box grows with a power of the number of keys
MOST_LOAD_CASES = 64  # chosen: each evaluation of a design solves all of them
CHECKED_SAMPLES = 32  # chosen: designs inside the box that are checked before the first solution, beside its corners
_SEED = 20_251_002  # of the scrambling: the same command evaluates the same designs


@dataclass(frozen=True)
class LoadCase:
    """Keys that make a load case of a study, as texts for a study file, and words; both empty for the study itself."""

    words: str
    values: Mapping[str, Value]


@dataclass(frozen=True)
class DesignSpace:
    """A case, the keys that vary, and the load cases of which the worst counts."""

    case: Case
    keys: tuple[DesignKey, ...]
    load_cases: tuple[LoadCase, ...]

    @classmethod
    def of(cls, case: Case, over: Mapping[str, Range], worst_of: Vary) -> DesignSpace:
        """Raises InputError for keys, ranges or load cases that cannot be used."""
        require_one_curve(case, "design")
        if not over:
            raise InputError(
                "no key to design is given. Give at least one, for example preload.centrifugal_force=50 N:5 kN.",
                arguments=["over"],
            )
        if len(over) > MOST_KEYS:
            raise InputError(
                f"over has {len(over)} keys, but at most {MOST_KEYS} are allowed. Design the most important ones; "
                "analysis.gradients shows them.",
                arguments=["over"],
            )
        keys = tuple(_design_key(case, name, limits) for name, limits in over.items())
        both = [name for name in over if name in worst_of]
        if both:
            raise InputError(f"{both[0]} cannot be designed and vary between load cases. Remove one of both.", both)
        return cls(case, keys, tuple(_load_cases(case, worst_of)))

    def values(self, coordinates: FloatArray) -> tuple[float, ...]:
        """The values of the keys in SI at coordinates (n,)."""
        return tuple(key.at(float(at)) for key, at in zip(self.keys, coordinates, strict=True))

    def case_at(self, values: Sequence[float], load_case: LoadCase) -> Case:
        """The validated case of a design. Raises StudyFileError."""
        changes = {key.name: key.quantity.stored(value) for key, value in zip(self.keys, values, strict=True)}
        return self.case.replace({**changes, **load_case.values})

    @property
    def start(self) -> FloatArray | None:
        """Coordinates of the study itself; None if it is outside of the box."""
        at = np.array([key.coordinate(key.start) for key in self.keys])
        return at if ((at >= 0.0) & (at <= 1.0)).all() else None

    def samples(self, count: int) -> FloatArray:
        """(count, n_keys) scrambled Sobol points; more contain those of fewer."""
        sobol = scipy.stats.qmc.Sobol(len(self.keys), scramble=True, seed=np.random.default_rng(_SEED))
        points: FloatArray = sobol.random_base2(max(count - 1, 1).bit_length())[:count]
        return points

    def require_valid_box(self) -> None:
        """Raise InputError if a corner of the box, or one of the samples inside, is no valid design: its keys
        contradict each other, its parts do not fit, or its contact has no stiffness."""
        corners = np.array(list(itertools.product((0.0, 1.0), repeat=len(self.keys))))
        layouts: dict[str, Layout] = {}
        wrong: list[tuple[str, StickslipError]] = []
        points = np.vstack([corners, self.samples(CHECKED_SAMPLES)])
        for point in points:
            values = self.values(point)
            for load_case in self.load_cases:
                try:
                    self._check(values, load_case, layouts)
                except StickslipError as error:
                    named = [f"{key.name} = {key.label(value)}" for key, value in zip(self.keys, values, strict=True)]
                    wrong.append((", ".join([*named, *filter(None, [load_case.words])]), error))
                    break
        if wrong:
            where, first = wrong[0]
            reason = " ".join(line.strip() for line in str(first).splitlines()[isinstance(first, StudyFileError) :])
            raise InputError(
                f"{len(wrong)} of {len(points)} designs at the corners of the ranges and inside are not valid; nothing "
                f"was solved. The first, {where}: {reason} Narrow the ranges.",
                [key.name for key in self.keys],
            )

    def _check(self, values: Sequence[float], load_case: LoadCase, layouts: dict[str, Layout]) -> None:
        case = self.case_at(values, load_case)
        structure = case_hashes(case)[1]
        if structure not in layouts:
            layouts[structure] = set_up(case).layout
        load_joint(case, layouts[structure])


def _design_key(case: Case, name: str, limits: Range) -> DesignKey:
    """A key with its range. Raises InputError."""
    kind = continuous_quantity(name, case, "a design")
    given = tuple(part.strip() for part in limits.split(":")) if isinstance(limits, str) else tuple(limits)
    if len(given) != 2 or not all(str(each) for each in given):
        raise InputError(f'{name} has the range "{limits}", but it must be FROM:TO.', arguments=[name])
    return DesignKey(name, kind, *rising_range(name, kind, given), _own_value(case, name))


def _own_value(case: Case, name: str) -> float:
    """The value of a key in the study. Raises InputError if it has none."""
    section, entry, table, key = Case.parts_of_key(name)
    holder = case.sections.get(section)
    if isinstance(holder, Mapping):
        holder = holder.get(entry)
    value = getattr(holder, table).values.get(key) if table and holder is not None else getattr(holder, key, None)
    if not isinstance(value, float | int):
        raise InputError(
            f"{name} has no value in the study, so a design cannot begin there. Give the key a value.",
            arguments=[name],
        )
    return float(value)


def _load_cases(case: Case, worst_of: Vary) -> Iterator[LoadCase]:
    """Every combination of the values. Raises InputError, StudyFileError for a combination that is not valid."""
    if not worst_of:
        yield LoadCase("", {})
        return
    keys: tuple[SweptKey, ...] = swept_keys(worst_of, case)
    places = list(itertools.product(*(range(len(key.values)) for key in keys)))
    if len(places) > MOST_LOAD_CASES:
        raise InputError(f"worst_of has {len(places)} load cases; at most {MOST_LOAD_CASES} are allowed.")
    for row in places:
        chosen = list(zip(keys, row, strict=True))
        values = {key.name: study_value(key, place) for key, place in chosen}
        words = ", ".join(f"{key.name} = {key.labels[place]}" for key, place in chosen)
        with concerning(*values):
            case.replace(values)
        yield LoadCase(words, values)
