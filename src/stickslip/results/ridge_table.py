"""The table of a ridge of peaks, one row for each peak."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from stickslip.results.table import Column, Table, column_of

# Arrays of a ridge -> heading and unit; those that are None have no column.
POINT_COLUMNS = {
    "amplitude": ("amplitude of {}", "m"),
    "frequency_hz": ("frequency", "Hz"),
    "point_harmonics": ("harmonics", ""),
    "estimated_error": ("estimated error", ""),
    "ridge": ("ridge", ""),
    "is_corner": ("corner", ""),
    "pairs_stuck": ("pairs stuck", ""),
    "pairs_stick_slip": ("pairs stick-slip", ""),
    "pairs_separating": ("pairs separating", ""),
}


def ridge_table(name: str, parameter: Column, output_name: str, points: Mapping[str, Any]) -> Table:
    """The peaks against a parameter; ``points`` are the arrays of :data:`POINT_COLUMNS`, ridges numbered from 1."""
    columns = [
        column_of(words.format(output_name), unit, points[key])
        for key, (words, unit) in POINT_COLUMNS.items()
        if points[key] is not None
    ]
    return Table(name, f"peaks against {parameter.name}, 0-to-peak", (parameter, *columns))
