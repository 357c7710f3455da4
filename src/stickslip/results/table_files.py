"""Tables as files: a folder of CSV files, an Excel workbook, or a MATLAB file. Complete or not at all."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.files import require_folder, whole_file
from stickslip.results.table import Cell, Column, Table

_WIDEST = 60  # letters of a column of a workbook
_MATLAB_NAME = 63  # letters of the longest name in MATLAB


def heading(column: Column) -> str:
    """Name and unit of a column, ``frequency [Hz]``."""
    return f"{column.name} [{column.unit}]" if column.unit and column.unit != "1" else column.name


def write_csv_tables(folder: Path, tables: Sequence[Table]) -> tuple[Path, ...]:
    """One file for each table, comma-separated text (UTF-8) with units in the heading, numbers with every digit.

    The folder is made. Raises OutputError or InputError if it or a file cannot be written.
    """
    require_folder(folder)
    files = []
    for table in tables:
        target = folder / f"{table.name}.csv"
        with whole_file(target, "table", InputError) as part, part.open("w", encoding="utf-8", newline="") as stream:
            writer = csv.writer(stream)
            writer.writerow([heading(column) for column in table.columns])
            writer.writerows([_text(cell) for cell in row] for row in table.rows)
        files.append(target)
    return tuple(files)


def write_workbook(path: Path, tables: Sequence[Table]) -> tuple[Path, ...]:
    """One Excel workbook with a sheet for each table, after a sheet that lists them.

    Words are never formulas, also if they begin with "=". Raises InputError if the file cannot be written.
    """
    from openpyxl import Workbook

    book = Workbook(write_only=True)
    listing = Table(
        "tables",
        "",
        (Column("table", "", [table.name for table in tables]), Column("meaning", "", [t.meaning for t in tables])),
    )
    for table in (listing, *tables):
        sheet = book.create_sheet(table.name)
        sheet.freeze_panes = "A2"
        for place, column in enumerate(table.columns):
            longest = max(len(heading(column)), *(len(_text(value)) for value in column.values), 8)
            sheet.column_dimensions[_letters(place)].width = min(longest, _WIDEST) + 2
        sheet.append([_excel_cell(sheet, heading(column), is_heading=True) for column in table.columns])
        for row in table.rows:
            sheet.append([_excel_cell(sheet, cell) for cell in row])
    with whole_file(path, "workbook", InputError) as part, part.open("wb") as stream:
        book.save(stream)
    return (path,)


def write_matlab(path: Path, tables: Sequence[Table]) -> tuple[Path, ...]:
    """One MATLAB file (version 5) with a structure for each table.

    ``load tables.mat``, then ``curve.frequency`` is a column (n, 1), ``curve.units.frequency`` its unit and
    ``curve.meaning`` words. Words are cell arrays, empty cells NaN; names are letters, digits and underscores. Raises
    InputError if the file cannot be written.
    """
    from scipy.io import savemat

    structures: dict[str, Any] = {}
    for table in tables:
        names = _matlab_names(table)
        content: dict[str, Any] = {name: _matlab_column(each) for name, each in zip(names, table.columns, strict=True)}
        units = {name: column.unit for name, column in zip(names, table.columns, strict=True)}
        structures[table.name] = {**content, "units": units, "meaning": table.meaning}
    with whole_file(path, "MATLAB file", InputError) as part, part.open("wb") as stream:
        savemat(stream, structures, long_field_names=True, do_compression=True)
    return (path,)


@dataclass(frozen=True)
class TableFormat:
    """A format of tables: the name of its file or folder beside results, and the function that writes it."""

    default_name: str
    write: Callable[[Path, Sequence[Table]], tuple[Path, ...]]


FORMATS = {
    "csv": TableFormat("tables", write_csv_tables),
    "xlsx": TableFormat("tables.xlsx", write_workbook),
    "mat": TableFormat("tables.mat", write_matlab),
}


def _text(cell: Cell) -> str:
    if cell is None:
        return ""
    return repr(cell) if isinstance(cell, float) else str(cell)


def _letters(place: int) -> str:
    from openpyxl.utils import get_column_letter

    return str(get_column_letter(place + 1))


def _excel_cell(sheet: Any, value: Cell, is_heading: bool = False) -> Any:
    from openpyxl.cell import WriteOnlyCell
    from openpyxl.cell.cell import ILLEGAL_CHARACTERS_RE
    from openpyxl.styles import Font

    plain = ILLEGAL_CHARACTERS_RE.sub(" ", value) if isinstance(value, str) else value
    cell = WriteOnlyCell(sheet, plain)
    if isinstance(value, str):
        cell.data_type = "s"  # openpyxl would make a formula of "=..."
    if is_heading:
        cell.font = Font(bold=True)
    return cell


def _matlab_names(table: Table) -> list[str]:
    """Names of the fields, each once."""
    names: list[str] = []
    for column in table.columns:
        plain = re.sub(r"\W+", "_", column.name, flags=re.ASCII).strip("_") or "column"
        plain = plain if plain[0].isalpha() else f"x{plain}"
        name, count = plain[:_MATLAB_NAME], 1
        while name in (*names, "units", "meaning"):
            count += 1
            name = f"{plain[: _MATLAB_NAME - 4]}_{count}"
        names.append(name)
    return names


def _matlab_column(column: Column) -> Any:
    """(n, 1) numbers, or a cell array of words."""
    if not column.is_text:
        numbers = [np.nan if value is None else value for value in column.values]
        return np.array(numbers, dtype=float)[:, None]
    cells = np.empty((len(column.values), 1), dtype=object)
    cells[:, 0] = ["" if value is None else value for value in column.values]
    return cells
