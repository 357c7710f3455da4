"""Common data of the figures of a sweep: its table as arrays, and its cases grouped in lines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stickslip.core.plain_figure import BLUE, GREEN, INK, ORANGE, PURPLE, VERMILLION
from stickslip.core.shown_numbers import number, unit_on_page
from stickslip.core.validation import FloatArray
from stickslip.results.peaks import caution
from stickslip.results.sweep_table import SweepCurve, SweepRow, SweepTable, SweptKey, short_key

COLOURS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, INK)
DASHES = ("solid", "dash", "dot", "dashdot", "longdash")
MARKS = ("circle", "square", "diamond", "cross", "x", "pentagon", "hexagon")
# Cividis without its palest end, which is invisible on white paper.
SCALE = ((0.0, "#00224e"), (0.25, "#35456c"), (0.5, "#666970"), (0.75, "#948e77"), (1.0, "#c8b866"))
_FACTOR = 8.0  # chosen: two values that differ by more are on a logarithmic axis
LOAD_KEY = "preload.centrifugal_force"


@dataclass(frozen=True)
class Group:
    """Cases that differ in one key only: ``members`` (n,) rows in the order of that key, and words for the others."""

    label: str
    members: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SweepView:
    """A table, the curve of each row, and the excitation force of each row in N."""

    table: SweepTable
    curves: tuple[SweepCurve | None, ...]
    force_n: FloatArray

    def number(self, column: str) -> FloatArray:
        """(n_rows,) a measure, NaN where there is none."""
        return np.array(self.table.column(column), dtype=float)

    def usable(self) -> NDArray[np.bool_]:
        """(n_rows,) rows with a complete curve."""
        return np.array([row.converged for row in self.table.rows], dtype=bool)

    def inside(self) -> NDArray[np.bool_]:
        """(n_rows,) usable rows whose peak lies inside the computed range."""
        inside: NDArray[np.bool_] = self.usable() & (self.number("peak_bracketed") == 1.0)
        return inside

    def place_of(self, name: str) -> int | None:
        """Number of a key among the swept ones."""
        names = [key.name for key in self.table.keys]
        return names.index(name) if name in names else None

    @cached_property
    def positions(self) -> NDArray[np.int64]:
        """(n_rows, n_keys) position of each row's value in the values of the key; some combinations may have no row."""
        places = [{value: place for place, value in enumerate(key.values)} for key in self.table.keys]
        rows = [[place[value] for place, value in zip(places, row.values, strict=True)] for row in self.table.rows]
        return np.array(rows, dtype=np.int64).reshape(len(rows), len(places))

    def label(self, row: int, without: tuple[int, ...] = ()) -> str:
        """Words for a row: each key's last name and value, without some keys."""
        positions = self.positions[row]
        return ", ".join(
            f"{short_name(key)} {value_words(key, positions[place])}"
            for place, key in enumerate(self.table.keys)
            if place not in without
        )

    def groups(self, places: tuple[int, ...]) -> Iterator[Group]:
        """The rows in groups that differ only in the keys ``places``, in the order of their values."""
        positions = self.positions
        others = [place for place in range(len(self.table.keys)) if place not in places]
        _, first, member_of = np.unique(positions[:, others], axis=0, return_index=True, return_inverse=True)
        for group, row in enumerate(first):
            members = np.flatnonzero(member_of.ravel() == group)
            order = np.lexsort([_rank(self.table.keys[place])[positions[members, place]] for place in reversed(places)])
            yield Group(self.label(int(row), places), members[order])


def _rank(key: SweptKey) -> NDArray[np.int64]:
    """(n_values,) place of each value by size; choices keep their order."""
    return np.argsort(np.argsort(key.shown)) if key.shown else np.arange(len(key.values))


def peak_remark(row: SweepRow) -> str:
    """Why a case failed, and whether the peak of its row may not be the highest one."""
    note = caution(row.measures["peak_bracketed"] == 1.0, row.converged) if row.measures else ""
    failure = "" if row.converged else f"Failed: {row.message}"
    return " ".join(filter(None, [f"Peak: {note}." if note else "", failure]))


def value_words(key: SweptKey, position: int) -> str:
    """A value of a key with its unit, as pages write numbers."""
    if key.is_choice:
        return key.labels[position]
    return f"{number(key.shown[position], 6)} {unit_on_page(key.shown_unit)}".rstrip()


def short_name(key: SweptKey) -> str:
    """The key in words, as :func:`stickslip.results.sweep_table.short_key` says."""
    return short_key(key.name)


def axis_title(key: SweptKey) -> str:
    """Name of a key as in the study file, and its unit."""
    return with_unit(key.name, key)


def with_unit(name: str, key: SweptKey) -> str:
    """A name of a key with the unit of its shown values."""
    return f"{name}{', ' + unit_on_page(key.shown_unit) if key.shown_unit else ''}"


def is_logarithmic(values: FloatArray) -> bool:
    """Whether values are spaced by a factor rather than by a step."""
    ordered = np.unique(values)
    if ordered.size < 2 or ordered[0] <= 0:
        return False
    if ordered.size == 2:
        return bool(ordered[1] / ordered[0] > _FACTOR)
    steps, factors = np.diff(ordered), np.diff(np.log(ordered))
    return bool(steps.std() / steps.mean() > 2.0 * factors.std() / factors.mean() + 1e-3)
