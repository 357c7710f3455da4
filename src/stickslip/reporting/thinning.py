"""Fewer points for the same picture: the points of a curve that determine its shape, including its first and last."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

_FINEST = 2e-4  # of the figure: below a pixel
_COARSEST = 2e-2  # of the figure: the tolerance of a page with very many curves


@dataclass(frozen=True)
class Thinned:
    """Indices of the drawn points of each curve, and the largest distance of other points from the line, as a fraction
    of the figure."""

    indices: tuple[NDArray[np.int64], ...]
    tolerance: float


def thinned(curves: Sequence[tuple[FloatArray, FloatArray]], largest_total: int) -> Thinned:
    """Points to draw of curves (x, y) in one figure, at most about ``largest_total``.

    All points remain if they fit. Otherwise the tolerance grows until they do, up to 2 % of the figure; ends and
    largest values always stay. Method: U. Ramer (1972), D. H. Douglas and T. K. Peucker (1973).
    """
    everything = tuple(np.arange(x.size, dtype=np.int64) for x, _ in curves)
    if sum(indices.size for indices in everything) <= largest_total:
        return Thinned(everything, 0.0)
    width = max(max(float(x.max()) for x, _ in curves) - min(float(x.min()) for x, _ in curves), 1e-300)
    height = max(max(float(y.max()) for _, y in curves), 1e-300)
    tolerance = _FINEST
    while True:
        indices = tuple(_shape_points(x / width, y / height, tolerance) for x, y in curves)
        if sum(each.size for each in indices) <= largest_total or tolerance >= _COARSEST:
            return Thinned(indices, tolerance)
        tolerance = min(2.0 * tolerance, _COARSEST)


def _shape_points(x: FloatArray, y: FloatArray, tolerance: float) -> NDArray[np.int64]:
    keep = np.zeros(x.size, dtype=bool)
    fixed = sorted({0, int(y.argmax()), x.size - 1})
    keep[fixed] = True
    open_spans = list(itertools.pairwise(fixed))
    while open_spans:
        first, last = open_spans.pop()
        if last - first < 2:
            continue
        distance = _distance(x[first : last + 1], y[first : last + 1])
        farthest = int(distance.argmax())
        if distance[farthest] > tolerance:
            middle = first + farthest
            keep[middle] = True
            open_spans += [(first, middle), (middle, last)]
    return np.flatnonzero(keep)


def _distance(x: FloatArray, y: FloatArray) -> FloatArray:
    """Distance of each point from the segment between the first and the last one."""
    along_x, along_y = x[-1] - x[0], y[-1] - y[0]
    length = along_x**2 + along_y**2
    share = np.zeros_like(x) if length == 0 else ((x - x[0]) * along_x + (y - y[0]) * along_y) / length
    share = np.clip(share, 0.0, 1.0)
    distance: FloatArray = np.hypot(x - x[0] - share * along_x, y - y[0] - share * along_y)
    return distance
