"""A study file as a case."""

from __future__ import annotations

import warnings
from os import PathLike
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from stickslip.case import toml_text as case_file
from stickslip.case.case import Case
from stickslip.case.consistency import RANGE_KEYS
from stickslip.case.law_constants import TABLE_FILE
from stickslip.case.scatter_text import central_sentences, split_scatter
from stickslip.case.template import metadata_of
from stickslip.core.errors import InputError, StickslipWarning, StudyFileError
from stickslip.core.units import Count, Quantity

# Frequency range of a file without one, Hz, for a command that proposes one.
NO_RANGE = dict(zip(RANGE_KEYS, (1.0, 2.0), strict=True))


def load_case(path: str | PathLike[str]) -> Case:
    """Read and validate a study file. Raises StudyFileError with one line for each error in the file.

    A distributed input has its central value in the case (a StickslipWarning names both); ``ss.band(path)`` uses the
    distribution.
    """
    case, places = load_case_and_positions(path)
    for sentence in central_sentences(places.scattered):
        warnings.warn(sentence, StickslipWarning, stacklevel=2)
    return case


def load_case_and_positions(path: str | PathLike[str], needs_range: bool = True) -> tuple[Case, case_file.KeyPositions]:
    """:func:`load_case` without warnings, and the lines of the keys of the file, for errors after reading.

    Unless it ``needs_range``, a file without frequency range has :data:`NO_RANGE` for a command that proposes one.
    """
    text = case_file.read_text(path)
    data, lines = case_file.parse_toml(text, str(path)), case_file.key_lines(text)
    if not needs_range:
        data = _with_some_range(data)
    try:
        central, scattered = split_scatter(data, _may_scatter)
    except InputError as error:
        line = case_file.KeyPositions(str(path), data, lines).line(error.keys[0])
        where = f"line {line}: " if line else ""
        raise StudyFileError(f"{path}: 1 error.\n  {where}{error}", error.keys) from error
    places = case_file.KeyPositions(str(path), data, lines, scattered=scattered)
    try:
        return Case.in_folder(central, Path(path).resolve().parent, places.source, lines), places
    except StudyFileError as error:
        named = [f'\n  {key} = "{scattered[key]}" has this central value.' for key in error.keys if key in scattered]
        raise error.reworded(f"{error}{''.join(named)}") from error


def _with_some_range(data: dict[str, Any]) -> dict[str, Any]:
    """The content of a file, with :data:`NO_RANGE` if it is about a structure of the user's own without range."""
    structure, solver = data.get("structure"), data.get("solver", {})
    is_own = isinstance(structure, dict) and structure.get("kind", "two-blade") != "two-blade"
    return {**data, "solver": {**NO_RANGE, **solver}} if is_own and isinstance(solver, dict) else data


def has_range(case: Case) -> bool:
    """Whether the file of a case has a frequency range."""
    return (case.solver.frequency_start, case.solver.frequency_stop) != tuple(NO_RANGE.values())


def _may_scatter(path: tuple[str, ...]) -> bool:
    """Whether a key of the file may have a distribution: a quantity, a count or a choice, or a constant of a law."""
    section, _, table, key = Case.parts_of_key(".".join(path))
    if table:
        return key != TABLE_FILE
    if key not in Case.allowed_keys().get(section, ()):
        return False
    model, field = Case.field_of(section, key)
    has_numbers = any(isinstance(entry, Quantity | Count) for entry in metadata_of(model, key))
    return has_numbers or any(get_origin(each) is Literal for each in (field.annotation, *get_args(field.annotation)))
