"""The highest of several ridges of peaks: its values, its low places, and how it is interpolated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

# A point left out has an interval of twice the length, whose interpolation has at least so many times the error (at a
# corner of the ridge), or where it is smooth and its slopes are known.
ERROR_OF_LEFT_OUT, ERROR_OF_SMOOTH = 2.0, 8.0
MORE_THAN_TWO, POSITIONS = 3, 9  # chosen: positions of an interval at which two lines are compared

# chosen: beyond this distance of a slope from that of the power law, in the logarithm over the interval, the square of
# a curve is interpolated. A node at the distance of three intervals has 0.05. Squares of points with a ratio of more
# than exp(LARGEST_RISE) have no common scale.
BENT, LARGEST_RISE = 0.05, 10.0


@dataclass(frozen=True)
class HighestPeak:
    """The highest peak at some values of the parameter, (n,) each; NaN, and ridge -1, where no ridge is known."""

    parameter: FloatArray
    amplitude: FloatArray
    frequency_hz: FloatArray
    ridge: NDArray[np.int64]


@dataclass(frozen=True)
class Optimum:
    """A value of the parameter with a low highest peak; ``edge`` names the end of the followed range at which it is,
    "" for a minimum inside."""

    parameter: float
    amplitude: float
    frequency_hz: float
    edge: str = ""

    @property
    def is_inside(self) -> bool:
        """Whether highest peaks are known on both sides."""
        return not self.edge


def optimum_at(top: HighestPeak, place: int) -> Optimum:
    """The highest peak at a position of the grid, with the end at which it is."""
    known = np.flatnonzero(top.ridge >= 0)
    edge = ""
    if place in (known[0], known[-1]):
        edge = "the lower end of the followed range" if place == known[0] else "the upper end of the followed range"
    elif (top.ridge[place - 1 : place + 2] < 0).any():
        edge = "the edge of a gap in which the highest peak is unknown"
    return Optimum(float(top.parameter[place]), float(top.amplitude[place]), float(top.frequency_hz[place]), edge)


def log_interpolated(
    places: FloatArray, curve: FloatArray, at: FloatArray, slopes: FloatArray | None = None
) -> FloatArray:
    """The logarithm of a curve (n,) over rising places (n,), at others between them (:func:`log_between`).

    ``slopes`` (n,) are known ones. Where there is none, or it is not a number, the slope is that of the parabola
    through three neighbours. Linear for two points without slopes, constant for one.
    """
    if places.size == 1:
        return np.full(at.size, curve[0])
    known = known_slopes(places, curve, slopes)
    left = np.clip(np.searchsorted(places, at, side="right") - 1, 0, places.size - 2)
    ends, heights, rises = ((array[left], array[left + 1]) for array in (places, curve, known))
    # A slope of neighbours is that of no square.
    return log_between(ends, heights, rises, at, squares=slopes is not None)


def known_slopes(places: FloatArray, curve: FloatArray, slopes: FloatArray | None) -> FloatArray:
    """(n,) ``slopes`` of a curve, and those of parabolas through three neighbours where they are not a number."""
    of_neighbours = np.gradient(curve, places, edge_order=2 if places.size > 2 else 1)
    return np.asarray(of_neighbours if slopes is None else np.where(np.isnan(slopes), of_neighbours, slopes))


def log_between(
    places: tuple[FloatArray, FloatArray],
    curve: tuple[FloatArray, FloatArray],
    slopes: tuple[FloatArray, FloatArray],
    at: FloatArray,
    squares: bool = True,
) -> FloatArray:
    """The logarithm of a curve at places between two others, or beyond, from its logarithms and slopes there.

    It is a cubic polynomial where the curve is close to the power law through both. Elsewhere, with ``squares``, the
    square of the curve is one if it stays above zero: where a peak falls to almost nothing, as ``sqrt((p - p_0)^2 +
    c^2)``, its square is smooth and its logarithm is not.
    """
    width = places[1] - places[0]
    fraction = (at - places[0]) / width
    rise = curve[1] - curve[0]
    logarithm = _cubic(0.0, rise, slopes[0] * width, slopes[1] * width, fraction)
    ratio = np.exp(2.0 * np.clip(rise, -LARGEST_RISE, LARGEST_RISE))
    square = _cubic(1.0, ratio, 2.0 * slopes[0] * width, 2.0 * ratio * slopes[1] * width, fraction)
    bent = np.maximum(np.abs(slopes[0] * width - rise), np.abs(slopes[1] * width - rise)) > BENT
    chosen = squares & bent & (square > 0.0) & (np.abs(rise) < LARGEST_RISE)
    return np.asarray(curve[0] + np.where(chosen, 0.5 * np.log(np.where(chosen, square, 1.0)), logarithm))


def _cubic(
    first: float | FloatArray, last: FloatArray, leaving: FloatArray, arriving: FloatArray, fraction: FloatArray
) -> FloatArray:
    """Hermite's polynomial with values and slopes at 0 and 1, at fractions."""
    chord, rest = last - first, 1.0 - fraction
    bent = fraction * rest * (rest * (leaving - chord) - fraction * (arriving - chord))
    return np.asarray(first + chord * fraction + bent)


def left_out_errors(places: FloatArray, curve: FloatArray, slopes: FloatArray | None = None) -> FloatArray:
    """(n,) distance of each point from the interpolation through all others (:func:`log_interpolated`), 0 at ends."""
    errors = np.zeros(places.size)
    for i in range(1, places.size - 1):
        others = np.arange(places.size) != i
        known = None if slopes is None else slopes[others]
        errors[i] = abs(log_interpolated(places[others], curve[others], places[i : i + 1], known)[0] - curve[i])
    return errors


def slope_differences(places: FloatArray, curve: FloatArray, slopes: FloatArray | None) -> FloatArray:
    """(n-1,) largest distance, between two points, of the line with known slopes from that with those of neighbours."""
    if slopes is None or places.size < MORE_THAN_TWO:
        return np.zeros(places.size - 1)
    at = places[:-1] + np.linspace(0.0, 1.0, POSITIONS)[:, None] * np.diff(places)
    lines = (log_interpolated(places, curve, at.ravel(), each) for each in (slopes, None))
    return np.asarray(np.abs(next(lines) - next(lines)).reshape(at.shape).max(axis=0))


def interpolation_errors(
    places: FloatArray, curve: FloatArray, at: FloatArray, slopes: FloatArray | None = None
) -> FloatArray:
    """Estimated errors of :func:`log_interpolated` at places between the first and the last point (n,): from the points
    left out on both sides, 0 at a point. Between two points alone it is their difference."""
    if places.size == 1:
        return np.zeros(at.size)
    left_out = left_out_errors(places, curve, slopes) / ERROR_OF_LEFT_OUT
    differences = slope_differences(places, curve, slopes)
    errors = (
        np.maximum(np.maximum(left_out[:-1], left_out[1:]), differences) if places.size > 2 else np.abs(np.diff(curve))
    )
    left = np.clip(np.searchsorted(places, at, side="right") - 1, 0, places.size - 2)
    fraction = np.clip((at - places[left]) / (places[left + 1] - places[left]), 0.0, 1.0)
    return np.asarray(4.0 * fraction * (1.0 - fraction) * errors[left])


def larger_neighbour(places: FloatArray, values: FloatArray, at: FloatArray) -> FloatArray:
    """The larger one of the values of the points on both sides; at a point its own value."""
    tolerance = 1e-12
    left = np.clip(np.searchsorted(places, at + tolerance, side="right") - 1, 0, places.size - 1)
    right = np.clip(np.searchsorted(places, at - tolerance), 0, places.size - 1)
    return np.asarray(np.maximum(values[left], values[right]))
