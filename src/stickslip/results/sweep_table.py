"""The table of a sweep: one row for each case, with its keys, its measures at the peak, and its message."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.errors import InputError, ResultsFileError
from stickslip.core.files import whole_file
from stickslip.core.validation import FloatArray
from stickslip.results.measures import SUMMARY_COLUMNS, summary
from stickslip.results.netcdf import netcdf_bytes
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.sweeps_of_curve import Flags

if TYPE_CHECKING:
    import xarray

Value = float | int | str

MEASURES = tuple(SUMMARY_COLUMNS)
_WHOLE = frozenset({"peak_bracketed", "pairs_stuck", "pairs_stick_slip", "pairs_separating"})


class Again(StrEnum):
    """Why a quick curve of a sample was no result, so that it was solved again."""

    HARMONICS = "harmonics"
    SAMPLES = "samples"
    EARLY = "early"

    @property
    def quantity(self) -> str:
        """What was too large; "" for a curve that ended early."""
        return {
            Again.HARMONICS: "the estimated error by neglected harmonics",
            Again.SAMPLES: "the residual with doubled samples",
            Again.EARLY: "",
        }[self]

    def words(self) -> str:
        """The reason of several samples."""
        return f"{self.quantity} was too large" if self.quantity else "the curve ended early"

    def sentence(self, fraction: float) -> str:
        """The reason of one sample, with the fraction of the motion that was too large."""
        return f"{self.quantity} is {100.0 * fraction:.2g} %"


# Sections whose keys need their name: the coefficient of the friction, the amplitude of the excitation.
_NAMING = frozenset({"friction", "excitation", "damper", "material", "roughness"})


def short_key(name: str) -> str:
    """Last part of ``section.key`` in words; with its section where one word alone may mean anything."""
    section, key = name.split(".", 1)
    words = key.replace(".", " ").replace("_", " ")
    return f"{section} {words}" if section in _NAMING and " " not in words else words


@dataclass(frozen=True)
class SweptKey:
    """A key of the study file that a sweep varies.

    name:
        ``section.key``.
    unit:
        unit of ``values``: SI, "" for pure numbers, counts and choices.
    values:
        (n,) floats in SI, counts, or choices.
    shown, shown_unit:
        (n,) the same numbers in the unit that engineers use, or () for choices.
    labels:
        (n,) words for each value, such as "500 N".
    """

    name: str
    unit: str
    values: tuple[Value, ...]
    shown: tuple[float, ...]
    shown_unit: str
    labels: tuple[str, ...]

    @property
    def is_choice(self) -> bool:
        """Whether the values are words."""
        return not self.shown


@dataclass(frozen=True, eq=False)
class SweepCurve:
    """Amplitude curve of one case: (n_points,) Hz and (n_points,) m, 0-to-peak, in the order of the curve.

    ``stable`` (n_points,) says which points are drawn as stable (:attr:`ForcedResponse.stable_points`), ``part``
    (n_points,) to which uninterrupted part they belong (:attr:`ForcedResponse.part`).
    """

    frequency_hz: FloatArray
    amplitude_m: FloatArray
    stable: Flags
    part: NDArray[np.int64]


@dataclass(frozen=True)
class SweepRow:
    """One case of a sweep.

    name:
        short readable name with the hash of the inputs.
    values:
        its value of each swept key.
    converged:
        whether the curve is complete.
    message:
        the end of the curve, or the reason why there is no result.
    measures:
        column of ``MEASURES`` -> number, without those that are not defined; empty for a case without result.
    warnings:
        messages of the study and of the solver.
    file:
        its results file, relative to the folder of the sweep; "" if there is none.
    solved_again:
        why its quick curves were no result, in words; "" for a case that was solved once.
    again_because:
        the kinds of these reasons, in their order.
    """

    name: str
    values: tuple[Value, ...]
    converged: bool
    message: str
    measures: Mapping[str, float]
    warnings: tuple[str, ...] = ()
    file: str = ""
    solved_again: str = ""
    again_because: tuple[Again, ...] = ()


@dataclass(frozen=True)
class SweepTable:
    """All cases of a sweep in the order of their values, the last key running fastest.

    ``further`` are measures beside ``MEASURES``: column -> (unit, meaning).
    """

    keys: tuple[SweptKey, ...]
    rows: tuple[SweepRow, ...]
    further: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns: case, one for each key, the measures, converged, message, warnings, file."""
        names = (key.name for key in self.keys)
        return ("case", *names, *self._measures, "converged", "message", "warnings", "file")

    @property
    def _measures(self) -> tuple[str, ...]:
        return (*MEASURES, *self.further)

    @property
    def failed(self) -> tuple[SweepRow, ...]:
        """Rows of the cases without a result or with an incomplete curve."""
        return tuple(row for row in self.rows if not row.converged)

    def column(self, name: str) -> list[Any]:
        """One column as a list; a measure that is not defined is NaN. Raises InputError for an unknown name."""
        if name not in self.columns:
            raise InputError(f'the table has no column "{name}". Its columns are {", ".join(self.columns)}.')
        place = self.columns.index(name)
        return [cells[place] for cells in self._cells()]

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Write comma-separated text (UTF-8), numbers in SI with every digit, cells without value empty.

        Written completely or not at all. Raises ResultsFileError if the file cannot be written.
        """
        with (
            whole_file(Path(path), "table", ResultsFileError) as part,
            part.open("w", encoding="utf-8", newline="") as stream,
        ):
            writer = csv.writer(stream)
            writer.writerow(self.columns)
            for cells in self._cells():
                named = zip(self.columns, cells, strict=True)
                writer.writerow([_csv_cell(name, cell) for name, cell in named])

    def to_dataset(self) -> xarray.Dataset:
        """The table along the dimension ``case``: every column is a variable with units and long_name."""
        import xarray

        cells = list(self._cells())
        about = {key.name: (key.unit or "1", f"{key.name} of the study file") for key in self.keys}
        about |= {name: (unit, meaning) for name, (unit, meaning, _) in SUMMARY_COLUMNS.items()}
        about |= self.further
        about |= {
            "converged": ("1", "1 if the curve is complete"),
            "message": ("", "message of the case at its end"),
            "warnings": ("", "warnings of the study and of the solver"),
            "file": ("", "results file, relative to the folder of the sweep"),
            "case": ("", "name of the case"),
        }
        data = {}
        for place, name in enumerate(self.columns):
            unit, meaning = about[name]
            values = [row[place] for row in cells]
            array = np.array(values, dtype=object if isinstance(values[0], str) else None)
            array = array.astype(np.int8) if array.dtype == bool else array
            data[_variable_name(name)] = (
                ("case",),
                array,
                {"units": unit, "long_name": meaning} if unit else {"long_name": meaning},
            )
        return xarray.Dataset(data, attrs={"title": "Sweep of stickslip, one entry for each case"})

    def to_netcdf(self, path: str | PathLike[str]) -> None:
        """Write ``to_dataset`` as NetCDF-4, completely or not at all. Raises ResultsFileError."""
        content = netcdf_bytes([("", self.to_dataset())])
        with whole_file(Path(path), "table", ResultsFileError) as part:
            part.write_bytes(content)

    def _cells(self) -> Iterator[tuple[Any, ...]]:
        for row in self.rows:
            measures = (row.measures.get(name, float("nan")) for name in self._measures)
            yield (row.name, *row.values, *measures, row.converged, row.message, " ".join(row.warnings), row.file)


def _variable_name(column: str) -> str:
    """The name of a column in NetCDF, where "/" parts groups; bodies of mesh files may have it in their names."""
    return column.replace("/", "%2F")


def _csv_cell(name: str, cell: Any) -> str:
    if isinstance(cell, bool):
        return "yes" if cell else "no"
    if isinstance(cell, float):
        if np.isnan(cell):
            return ""
        return str(int(cell)) if name in _WHOLE else repr(cell)
    return str(cell)


def curve_and_measures(response: ForcedResponse, study: StudyRecord) -> tuple[SweepCurve, dict[str, float]]:
    """Amplitude curve of a study's response output, and those of its measures that are defined. Raises InputError."""
    row = study.outputs[study.response_output]
    measures = summary(response, row)
    numbers = {name: entry[2](measures) for name, entry in SUMMARY_COLUMNS.items()}
    cells = {name: float(number) for name, number in numbers.items() if number is not None}
    return SweepCurve(response.frequency_hz, response.amplitude(row), response.stable_points, response.part), cells
