"""A table of results: columns of equal length with names and units."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.core.errors import InputError

Cell = float | int | str | None


@dataclass(frozen=True)
class Column:
    """Values of one quantity; ``unit`` is "" for words and counts. None and NaN are empty cells."""

    name: str
    unit: str
    values: Sequence[Cell]

    @property
    def is_text(self) -> bool:
        """Whether some value is a word."""
        return any(isinstance(value, str) for value in self.values)


@dataclass(frozen=True)
class Table:
    """Columns of equal length under a name of lower-case letters and underscores, and its meaning in words."""

    name: str
    meaning: str
    columns: tuple[Column, ...]

    def __post_init__(self) -> None:
        if len({len(column.values) for column in self.columns}) != 1:
            raise InputError(f'the columns of the table "{self.name}" must have one length.')

    @property
    def rows(self) -> Iterator[tuple[Cell, ...]]:
        """Cells, row by row."""
        return zip(*(column.values for column in self.columns), strict=True)


def column_of(name: str, unit: str, values: Any) -> Column:
    """A column of plain numbers and words; a number that is not finite is an empty cell."""
    return Column(name, unit, tuple(_cell(value) for value in values))


def _cell(value: Any) -> Cell:
    plain = value.item() if isinstance(value, np.generic) else value
    if isinstance(plain, bool):
        return int(plain)
    if isinstance(plain, float):
        return plain if np.isfinite(plain) else None
    return plain if plain is None or isinstance(plain, int | str) else str(plain)
