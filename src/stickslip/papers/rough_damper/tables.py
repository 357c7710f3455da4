"""Tables of the study: one form for the page, a CSV file each, and one NetCDF file with all of them and the curves."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.core.errors import ResultsFileError
from stickslip.core.files import whole_file
from stickslip.papers.rough_damper.records import Solved
from stickslip.results.netcdf import netcdf_bytes

if TYPE_CHECKING:
    import xarray

Cell = str | float | int


@dataclass(frozen=True)
class Column:
    """A column: name of the file, unit ("" for words and pure numbers), heading of the page."""

    name: str
    unit: str
    heading: str


@dataclass(frozen=True)
class Table:
    """Rows of words and numbers, SI or in the unit of the column; ``name`` is that of its file."""

    name: str
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"table {self.name}: a row of {len(row)} cells for {len(self.columns)} columns.")


def columns(*parts: str) -> tuple[Column, ...]:
    """Columns of texts "name|unit|heading"."""
    return tuple(Column(*part.split("|")) for part in parts)


def write_csv(table: Table, folder: Path) -> Path:
    """One CSV file; the head row has names with units. Raises ResultsFileError."""
    target = folder / f"{table.name}.csv"
    with (
        whole_file(target, "table", ResultsFileError) as part,
        part.open("w", newline="", encoding="utf-8") as stream,
    ):
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([f"{column.name} [{column.unit}]" if column.unit else column.name for column in table.columns])
        writer.writerows(table.rows)
    return target


def write_netcdf(tables: Sequence[Table], solved: Sequence[Solved], target: Path) -> Path:
    """One NetCDF-4 file: a group for each table, and a group "curves/NNN" for each curve. Raises ResultsFileError."""
    parts: list[tuple[str, xarray.Dataset]] = [(f"tables/{table.name}", _table_dataset(table)) for table in tables]
    parts += [(f"curves/{number:03d}", _curve_dataset(one)) for number, one in enumerate(solved)]
    content = netcdf_bytes(parts)
    with whole_file(target, "numbers of the study", ResultsFileError) as part:
        part.write_bytes(content)
    return target


def _table_dataset(table: Table) -> xarray.Dataset:
    import xarray

    data: dict[str, Any] = {}
    for place, column in enumerate(table.columns):
        cells = [row[place] for row in table.rows]
        words = any(isinstance(cell, str) for cell in cells)
        values = np.array([str(cell) for cell in cells], dtype=object) if words else np.array(cells, dtype=float)
        data[column.name] = (("row",), values, {"units": column.unit, "long_name": _plain(column.heading)})
    return xarray.Dataset(data, attrs={"caption": table.caption})


def _curve_dataset(one: Solved) -> xarray.Dataset:
    import xarray

    data = {
        "frequency": (("point",), one.frequency_hz, {"units": "Hz"}),
        "amplitude": (("point",), one.amplitude_m, {"units": "m", "long_name": "tip, 0-to-peak, mean included"}),
        "stable": (("point",), one.stable.astype(float), {"long_name": "1 if small disturbances decay"}),
        "friction_energy": (("point",), one.energy_j, {"units": "J", "long_name": "per cycle, all pairs"}),
        "state_count": (("point", "state"), one.counts.astype(float), {"long_name": "stuck, stick-slip, separating"}),
        "pair_state": (("pair",), one.pair_state.astype(float), {"long_name": "at the peak"}),
        "pair_energy": (("pair",), one.pair_energy_j, {"units": "J", "long_name": "per cycle at the peak"}),
        "pair_position": (("pair", "axis"), one.pair_position, {"units": "m"}),
        "pair_face": (("pair",), one.pair_face.astype(float), {"long_name": "0 left, 1 right"}),
    }
    s = one.setting
    labels = {"choice": s.choice, "excitation": s.excitation, "law": s.law, "force_n": s.force, "load_n": s.load}
    return xarray.Dataset(data, attrs={**labels, "fractal_dimension": s.dimension, "fractal_roughness_m": s.scale})


def _plain(heading: str) -> str:
    return re.sub(r"<[^>]+>", "", heading)
