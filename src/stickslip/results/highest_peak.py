"""The highest of several ridges of peaks: its values, its low places, and how it is interpolated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

# A point left out has an interval of twice the length, whose interpolation has at least so many times the error (at a
# corner of the ridge), or where it is smooth and its slopes are known.
ERROR_OF_LEFT_OUT, ERROR_OF_SMOOTH = 2.0, 16.0


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
    return log_between(ends, heights, rises, at)


def known_slopes(places: FloatArray, curve: FloatArray, slopes: FloatArray | None) -> FloatArray:
    """(n,) ``slopes`` of a curve, and those of parabolas through three neighbours where they are not a number."""
    of_neighbours = np.gradient(curve, places, edge_order=2 if places.size > 2 else 1)
    return np.asarray(of_neighbours if slopes is None else np.where(np.isnan(slopes), of_neighbours, slopes))


def log_between(
    places: tuple[FloatArray, FloatArray],
    curve: tuple[FloatArray, FloatArray],
    slopes: tuple[FloatArray, FloatArray],
    at: FloatArray,
) -> FloatArray:
    """The logarithm of a curve at places between two others, or beyond, from its logarithms and slopes there.

    With the square over that of the power law through both, ``q``, a cubic polynomial, it is that of the power law and
    ``log(q) / 2``. Where the curve is close to the power law this is the cubic polynomial of the logarithms; where it
    falls to almost nothing, as ``sqrt((p - p_0)^2 + c^2)``, the square is smooth and the logarithm is not. Where ``q``
    is not above zero, it is the polynomial of the logarithms.
    """
    width = places[1] - places[0]
    fraction = (at - places[0]) / width
    steepness = (curve[1] - curve[0]) / width
    rises = (slopes[0] - steepness) * width, (slopes[1] - steepness) * width
    rest = 1.0 - fraction
    bent = fraction * rest * (rest * rises[0] - fraction * rises[1])
    square = 1.0 + 2.0 * bent
    bent = np.where(square > 0.0, 0.5 * np.log(np.where(square > 0.0, square, 1.0)), bent)
    return np.asarray(curve[0] + steepness * width * fraction + bent)


def left_out_errors(places: FloatArray, curve: FloatArray, slopes: FloatArray | None = None) -> FloatArray:
    """(n,) distance of each point from the interpolation through all others (:func:`log_interpolated`), 0 at ends."""
    errors = np.zeros(places.size)
    for i in range(1, places.size - 1):
        others = np.arange(places.size) != i
        known = None if slopes is None else slopes[others]
        errors[i] = abs(log_interpolated(places[others], curve[others], places[i : i + 1], known)[0] - curve[i])
    return errors


def interpolation_errors(
    places: FloatArray, curve: FloatArray, at: FloatArray, slopes: FloatArray | None = None
) -> FloatArray:
    """Estimated errors of :func:`log_interpolated` at places between the first and the last point (n,): from the points
    left out on both sides, 0 at a point. Between two points alone it is their difference."""
    if places.size == 1:
        return np.zeros(at.size)
    left_out = left_out_errors(places, curve, slopes) / ERROR_OF_LEFT_OUT
    errors = np.maximum(left_out[:-1], left_out[1:]) if places.size > 2 else np.abs(np.diff(curve))
    left = np.clip(np.searchsorted(places, at, side="right") - 1, 0, places.size - 2)
    fraction = np.clip((at - places[left]) / (places[left + 1] - places[left]), 0.0, 1.0)
    return np.asarray(4.0 * fraction * (1.0 - fraction) * errors[left])


def larger_neighbour(places: FloatArray, values: FloatArray, at: FloatArray) -> FloatArray:
    """The larger one of the values of the points on both sides; at a point its own value."""
    tolerance = 1e-12
    left = np.clip(np.searchsorted(places, at + tolerance, side="right") - 1, 0, places.size - 1)
    right = np.clip(np.searchsorted(places, at - tolerance), 0, places.size - 1)
    return np.asarray(np.maximum(values[left], values[right]))
