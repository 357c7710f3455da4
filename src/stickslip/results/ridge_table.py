"""The table of a ridge of peaks, one row for each peak."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from stickslip.results.table import Column, Table, column_of

if TYPE_CHECKING:
    from stickslip.results.peak_ridge import PeakRidge


def ridge_table(ridge: PeakRidge, name: str) -> Table:
    """The peaks of a ridge, with the number of harmonics and the estimated error of each if they are known."""
    columns = (
        column_of(ridge.parameter_name, ridge.parameter_unit, ridge.parameter),
        column_of(f"amplitude of {ridge.output_name}", "m", ridge.amplitude),
        column_of("frequency", "Hz", ridge.frequency_hz),
        *_trust_columns(ridge),
        column_of("ridge", "", ridge.ridge + 1),
        column_of("corner", "", ridge.is_corner),
        column_of("pairs stuck", "", ridge.pairs_stuck),
        column_of("pairs stick-slip", "", ridge.pairs_stick_slip),
        column_of("pairs separating", "", ridge.pairs_separating),
    )
    return Table(name, f"peaks against {ridge.parameter_name}, 0-to-peak", columns)


def _trust_columns(ridge: PeakRidge) -> Iterator[Column]:
    if ridge.point_harmonics is not None:
        yield column_of("harmonics", "", ridge.point_harmonics)
    if ridge.estimated_error is not None:
        yield column_of("estimated error", "", ridge.estimated_error)
