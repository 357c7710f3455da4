"""Reading a table: a text file whose first line names its columns with their units, such as "pressure [MPa]"."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from stickslip.core.errors import ImportFileError, InputError
from stickslip.core.input_files import read_input
from stickslip.core.units import Quantity

LARGEST_TABLE = 10_000_000  # bytes; measured stiffness has some ten lines
_SEPARATOR = re.compile(r"\s*[,;\t]\s*")
_HEADING = re.compile(r'"?(\w+)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?"?')
_LONGEST_SHOWN = 60


def read_table(path: str, columns: Mapping[str, Quantity], entry: str) -> dict[str, tuple[float, ...]]:
    """The columns of a file in SI units, by name.

    Columns are parted by comma, semicolon or tab, and may come in any order; lines that start with # are comments.
    ``entry`` is the key of the study file that names the file. Raises ImportFileError with the line.
    """
    wanted = "The first line names the columns, " + ", ".join(
        f"{name} [{quantity.si_unit}]" if quantity.si_unit else name for name, quantity in columns.items()
    )
    wanted += "; each further line contains their numbers."
    try:
        text = read_input(Path(path), wanted, LARGEST_TABLE).decode("utf-8-sig")
    except InputError as error:
        raise ImportFileError(f"{entry}: {error}", (entry,)) from error
    except UnicodeDecodeError as error:
        raise ImportFileError(f"{entry}: {path} is not a text file in UTF-8. {wanted}", (entry,)) from error
    lines = [(number, line.strip()) for number, line in enumerate(text.splitlines(), start=1)]
    rows = [(number, _SEPARATOR.split(line)) for number, line in lines if line and not line.startswith("#")]
    where = f"{entry}: {path}, line {rows[0][0] if rows else 1}:"
    if len(rows) < 2:
        raise ImportFileError(f"{where} the file contains no table. {wanted}", (entry,))
    units = _units(rows[0][1], columns, f"{where} ", wanted, entry)
    values: dict[str, list[float]] = {name: [] for name, _ in units}
    for number, words in rows[1:]:
        where = f"{entry}: {path}, line {number}:"
        if len(words) != len(units):
            raise ImportFileError(
                f"{where} there are {len(words)} entries, but the first line names {len(units)} columns.", (entry,)
            )
        for word, (name, unit) in zip(words, units, strict=True):
            try:
                values[name].append(columns[name].parse(f"{word} {unit}".strip()))
            except InputError as error:
                raise ImportFileError(f'{where} {name} = "{word[:_LONGEST_SHOWN]}" {error}', (entry,)) from error
    return {name: tuple(values[name]) for name in columns}


def _units(
    words: list[str], columns: Mapping[str, Quantity], where: str, wanted: str, entry: str
) -> list[tuple[str, str]]:
    """Name and unit of each column of a file, from its first line."""
    headings: list[tuple[str, str]] = []
    for number, word in enumerate(words, start=1):
        match = _HEADING.fullmatch(word)
        name, unit = ("", "") if match is None else (match[1], match[2] or "")
        if name not in columns or name in dict(headings):
            # Without the words of the file: it may be another file than this study is allowed to show.
            wrong = (
                f"{name} is there twice" if name in dict(headings) else f"entry {number} names no column of this table"
            )
            raise ImportFileError(f"{where}{wrong}. {wanted}", (entry,))
        if columns[name].si_unit and not unit:
            raise ImportFileError(
                f"{where}{name} has no unit. Write it in brackets, such as {name} [{columns[name].si_unit}].", (entry,)
            )
        headings.append((name, unit))
    lacking = [name for name in columns if name not in dict(headings)]
    if lacking:
        raise ImportFileError(f"{where}there is no column {lacking[0]}. {wanted}", (entry,))
    return headings
