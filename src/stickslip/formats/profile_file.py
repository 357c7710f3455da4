"""Reader of a measured line profile: a text file of two columns, position and height, with units."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.input_files import read_input
from stickslip.core.short_repr import short_repr
from stickslip.core.units import Quantity
from stickslip.core.validation import FloatArray

LARGEST_PROFILE = 200_000_000  # bytes: some 10 million points, where instruments write 10 to 100 thousand
SPACING_TOLERANCE = 0.01  # of one spacing: files contain rounded positions
# Heights and distances from atoms to mountains: squares of values outside would overflow or underflow.
HEIGHT_LIMIT, POSITION_LIMIT = 1e4, 1e9  # m
SPACING_RANGE = (1e-12, 1e4)  # m
_SEPARATOR = re.compile(r"\s*[,;]\s*|\s+")
_UNIT = re.compile(r"[\[(]\s*([A-Za-zµμ]+)\s*[\])]")
_COLUMNS = ("position", "height")


@dataclass(frozen=True)
class Profile:
    """Heights of a line at equal distances."""

    heights: FloatArray  # (n,) m
    spacing: float  # m
    units: tuple[str, str]  # of position and height, from the file or the caller

    __repr__ = short_repr


def read_profile(
    path: str | PathLike[str], position_unit: str | None = None, height_unit: str | None = None
) -> Profile:
    """The profile of a text file: position and height on each line, parted by comma, semicolon, tab or blanks.

    Lines that start with # and one line of column names may come first. Units are the arguments, or those in brackets
    in these lines for both columns, as in "x [mm], z [um]". Raises InputError for a file that cannot be read, a unit
    that is missing or contradicts the file, a line that is not two finite numbers, and unequal distances.
    """
    source = Path(path)
    heading, rows = _rows(source)
    units = _units(source, heading, (position_unit, height_unit))
    scale = [_metres(unit) for unit in units]
    numbers = np.array([values for _, values in rows], dtype=float).reshape(-1, 2)
    lines = [line for line, _ in rows]
    _require_size(source, lines, numbers, scale, units)
    spacing = scale[0] * _spacing(source, numbers[:, 0], lines)
    if not SPACING_RANGE[0] <= spacing <= SPACING_RANGE[1]:
        raise InputError(
            f"{source}: the points are {spacing:.3g} m apart, but the distance must be {SPACING_RANGE[0]:g} to "
            f"{SPACING_RANGE[1]:g} m. Check the unit of the position, {units[0]}."
        )
    return Profile(scale[1] * numbers[:, 1], spacing, units)


def _require_size(
    source: Path, lines: list[int], numbers: FloatArray, scale: list[float], units: tuple[str, str]
) -> None:
    """Raise InputError for a position or height (n, 2) in the unit of the file that no surface has."""
    for column, name in enumerate(_COLUMNS):
        limit = (POSITION_LIMIT, HEIGHT_LIMIT)[column] / scale[column]
        wrong = np.flatnonzero(np.abs(numbers[:, column]) > limit)
        if wrong.size:
            raise InputError(
                f"{source}, line {lines[wrong[0]]}: the {name} is {numbers[wrong[0], column]:g} {units[column]}, but "
                f"it must be within {limit:g} {units[column]}. Check the number and the unit."
            )


def _rows(source: Path) -> tuple[str, list[tuple[int, tuple[float, float]]]]:
    """Comments and column names, and (line number, the two numbers) of every other line."""
    heading: list[str] = []
    rows: list[tuple[int, tuple[float, float]]] = []
    for number, text in _lines(source):
        line = text.strip()
        if line.startswith("#"):
            if not rows:
                heading.append(line)
        elif line and not rows and _is_names(line):
            if any(not each.startswith("#") for each in heading):
                raise InputError(
                    f'{source}, line {number}: "{line[:40]}" is a second line of column names. {_EXPECTED_FORMAT}'
                )
            heading.append(line)
        elif line:
            rows.append((number, _two_numbers(source, number, line)))
    if len(rows) < 2:
        raise InputError(
            f"{source}: the file contains {len(rows)} lines of numbers, too few for a profile. {_EXPECTED_FORMAT}"
        )
    return " ".join(heading), rows


_EXPECTED_FORMAT = "A profile is a position and a height on each line, such as 0.5, 1.25; comments start with #."


def _lines(source: Path) -> Iterator[tuple[int, str]]:
    try:
        text = read_input(source, "Give the path of a profile.", LARGEST_PROFILE).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{source}: the file is not a text file in UTF-8. {_EXPECTED_FORMAT}") from error
    yield from enumerate(text.splitlines(), start=1)


def _is_names(line: str) -> bool:
    """Whether a line starts with a letter and no word of it is a number: names of columns, no damaged numbers."""
    words = [word for word in _SEPARATOR.split(line) if word]
    return line[0].isalpha() and not any(_number(word) is not None for word in words)


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _two_numbers(source: Path, number: int, line: str) -> tuple[float, float]:
    words = _SEPARATOR.split(line)
    if len(words) != 2:
        comma = " Write decimals with a point, not a comma." if line.count(",") > 1 else ""
        raise InputError(
            f'{source}, line {number}: "{line[:40]}" has {len(words)} columns, not 2.{comma} {_EXPECTED_FORMAT}'
        )
    values = []
    for name, word in zip(_COLUMNS, words, strict=True):
        value = _number(word)
        if value is None:
            raise InputError(f'{source}, line {number}: the {name} "{word[:40]}" is not a number. {_EXPECTED_FORMAT}')
        if not math.isfinite(value):
            raise InputError(
                f"{source}, line {number}: the {name} is {word}, but a profile must have no gaps. Fill them in the "
                "instrument's software, or cut out a part without gaps."
            )
        values.append(value)
    return values[0], values[1]


def _units(source: Path, heading: str, options: tuple[str | None, str | None]) -> tuple[str, str]:
    """Units of both columns. Raises InputError if one is missing, or given and file differ."""
    named = _UNIT.findall(heading)
    stated_units = tuple(named) if len(named) == 2 else (None, None)
    result = []
    for name, wanted, stated in zip(_COLUMNS, options, stated_units, strict=True):
        unit = wanted or stated
        if unit is None:
            raise InputError(
                f"{source}: the file does not state the unit of the {name}. Give it with --unit um (both "
                f"columns), --position-unit and --height-unit, or in a first line: # x [mm], z [um]."
            )
        if wanted and stated and _metres(wanted) != _metres(stated):
            raise InputError(
                f"{source}: the file states the {name} in {stated}, but the option specifies {wanted}. Omit the "
                "option, or correct the file if it is wrong."
            )
        result.append(unit)
    return result[0], result[1]


def _metres(unit: str) -> float:
    """One ``unit`` in m. Raises InputError if it is not a unit of length."""
    try:
        return Quantity("length", at_least=1e-15, at_most=1e9).parse(f"1 {unit}")
    except InputError as error:
        raise InputError(f'the unit "{unit}" {error}') from error


def _spacing(source: Path, position: FloatArray, lines: list[int]) -> float:
    """Mean distance of the points, in the unit of the file. Raises InputError unless all are equal and above 0."""
    steps = np.diff(position)
    wrong = np.flatnonzero(~(steps > 0))
    if wrong.size:
        raise InputError(
            f"{source}, line {lines[wrong[0] + 1]}: the position {position[wrong[0] + 1]:g} is not above that of the "
            f"previous line, {position[wrong[0]]:g}. Positions must increase from line to line."
        )
    spacing = float((position[-1] - position[0]) / steps.size)
    wrong = np.flatnonzero(np.abs(steps - spacing) > SPACING_TOLERANCE * spacing)
    if wrong.size:
        at = int(np.abs(steps - spacing).argmax())
        raise InputError(
            f"{source}, line {lines[at + 1]}: the position is {steps[at]:g} after that of the previous line, but the "
            f"mean distance is {spacing:g} ({wrong.size} of {steps.size} distances differ by more than "
            f"{100 * SPACING_TOLERANCE:g} %). Export the profile at equal distances, with enough digits."
        )
    return spacing
