"""The lines of a measured surface for a fit of its roughness, with their range of lags: checked, and detrended."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.contact.stiffness.detrended_lines import without_trend
from stickslip.contact.stiffness.random_lines import LineSet
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, real_number, require_allowed

FEWEST_POINTS = 100  # on a line; a tenth of it then has six lags
MOST_POINTS = 100_000  # on a line; chosen to limit the time, since every simulated surface has as many
FRACTION_OF_LENGTH = 0.1  # longest lag: longer ones vary so much between surfaces that they contain no information on D
FIRST_LAG = 2  # in spacings: at one spacing instrument and sampling have the largest effect
MOST_LINES = 32  # of a map in each direction; neighbouring lines contain nearly the same information
BEYOND = 100.0  # default of longest wave over line length: longer ones are straight lines, which are removed
LONGEST_BEYOND = 1e4  # limit of longest wave over line length as an argument: the heights do not contain longer waves

Interval = tuple[float, float]


@dataclass(frozen=True)
class MeasuredLines:
    """The detrended lines of one direction."""

    lines: FloatArray  # (n, points)
    place: LineSet
    trend_fraction: float  # fraction of the variance about the mean height in the trend


def line_sets(heights: FloatArray, spacing: float | Sequence[float]) -> tuple[MeasuredLines, ...]:
    """The lines along x, and for a map along y as well where there are enough points. Raises InputError."""
    if heights.ndim not in (1, 2):
        raise InputError(
            f"heights must be a line (n,) or a map (n_y, n_x), but its shape is {heights.shape}.", arguments=["heights"]
        )
    grid = heights[None] if heights.ndim == 1 else heights
    if max(grid.shape) > MOST_POINTS:
        raise InputError(
            f"heights has {max(grid.shape)} points on a line, but {MOST_POINTS} is the largest number for simulated "
            "surfaces. Give a part of it, or each second or third point.",
            arguments=["heights"],
        )
    steps = _spacings(spacing, heights.ndim)
    parts = []
    for along_x, lines in ((True, grid), (False, grid.T)):
        beside, along = steps if along_x else steps[::-1]
        if lines.shape[1] >= FEWEST_POINTS:
            chosen = np.unique(np.linspace(0, lines.shape[0] - 1, min(MOST_LINES, lines.shape[0])).astype(int))
            place = LineSet(lines.shape[1], along, beside * chosen.astype(float), along_x)
            parts.append(_detrended(lines[chosen], place))
    if not parts:
        raise InputError(
            f"heights has {max(grid.shape)} points on a line, but a fit of D and G requires {FEWEST_POINTS} or more. "
            "Measure a longer line or with a smaller spacing.",
            arguments=["heights"],
        )
    return tuple(parts)


def _detrended(lines: FloatArray, place: LineSet) -> MeasuredLines:
    centred = lines - lines.mean(axis=1, keepdims=True)
    flat = without_trend(centred)
    total, rest = float(np.mean(centred**2)), float(np.mean(flat**2))
    if not rest > 1e-24 * max(total, float(np.mean(lines**2))):
        raise InputError(
            "the heights are on straight lines, so they contain no roughness. Check the column, the unit, and whether "
            "the instrument's resolution is finer than the roughness."
        )
    return MeasuredLines(flat, place, 1.0 - rest / total)


def _spacings(spacing: float | Sequence[float], dimensions: int) -> tuple[float, float]:
    """(along y, along x) in m."""
    values = np.atleast_1d(finite_array("spacing", spacing))
    if values.shape not in {(1,), (dimensions,)} or not np.all(values > 0):
        allowed = "one length above 0 m" + (" or two, (along y, along x)" if dimensions == 2 else "")
        raise InputError(f"spacing is {spacing!r}, but it must be {allowed}.", arguments=["spacing"])
    return float(values[0]), float(values[-1])


def longest_wave_of(longest_wave: float | None, parts: tuple[MeasuredLines, ...]) -> float:
    """The longest wave of the fit in m: the argument, or ``BEYOND`` lengths of the line. Raises InputError."""
    length = max(part.place.points * part.place.spacing for part in parts)
    if longest_wave is None:
        return BEYOND * length
    wave = real_number("longest_wave", longest_wave)
    least, most = 10.0 * min(part.place.spacing for part in parts), LONGEST_BEYOND * length
    allowed = f"at least ten spacings, {least:g} m, and at most {LONGEST_BEYOND:g} lengths of the line, {most:g} m"
    require_allowed("longest_wave", wave, least <= wave <= most, allowed)
    return wave


def scale_range_of(scales: Interval | None, parts: tuple[MeasuredLines, ...]) -> Interval:
    """Shortest and longest lag of the fit in m: the argument, or those of the line. Raises InputError."""
    step = min(part.place.spacing for part in parts)
    length = max(part.place.points * part.place.spacing for part in parts)
    if scales is None:
        return FIRST_LAG * step, FRACTION_OF_LENGTH * length
    values = finite_array("scales", scales)
    if values.shape != (2,) or not step <= values[0] < values[1] <= 0.5 * length:
        raise InputError(
            f"scales is {scales!r}, but it must be a shortest and a longest lag, between the spacing, {step:g} m, and "
            f"half the length, {0.5 * length:g} m.",
            arguments=["scales"],
        )
    return float(values[0]), float(values[1])
