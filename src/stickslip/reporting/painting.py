"""Which sides of a body are seen in a parallel projection, and in what order a painter must draw them.

Sides that look away are left out. The others are sampled at the pixels that they cover; a side that is hidden at all of
its pixels is left out too, and at each pixel the nearer side must be painted later. Sorting by the depth of the middle
alone would put a long side in front of a short one that hides it.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

IntArray = NDArray[np.int64]
Flags = NDArray[np.bool_]

PIXEL = 1.5  # px of the view: how finely sides are sampled
_SAME_DEPTH = 0.05  # pixels: neighbours have one depth at their common edge
_OWN_SLOPE = 3.0  # pixels that the depth of a side may change from a pixel's middle to its own


@dataclass(frozen=True)
class Painting:
    """``order`` (k,) numbers of the visible sides, the first to be painted first, and which pixels opaque ones cover.

    ``covered`` (rows, columns) are squares of ``PIXEL`` px from the upper left corner.
    """

    order: IntArray
    covered: Flags


@dataclass(frozen=True)
class _Samples:
    """Pixels (s,), numbered row by row, the side (s,) that covers each, and its depth (s,) there in pixels."""

    pixel: IntArray
    side: IntArray
    depth: FloatArray


def signed_areas(places: FloatArray, sides: IntArray) -> FloatArray:
    """(m,) px2 of sides (m, 4) at ``places`` (n, 2 or more), x right and y down: above 0 for sides that look here."""
    x, y = places[sides, 0], places[sides, 1]
    return np.asarray(-0.5 * ((x[:, 2] - x[:, 0]) * (y[:, 3] - y[:, 1]) - (x[:, 3] - x[:, 1]) * (y[:, 2] - y[:, 0])))


def paint(places: FloatArray, sides: IntArray, opaque: Flags, width: int, height: int) -> Painting:
    """The sides to draw and their order.

    Parameters
    ----------
    places:
        (n, 3) px: x to the right, y down, and depth towards the eye.
    sides:
        (m, 4) corners, counter-clockwise seen from outside; a triangle repeats its last corner.
    opaque:
        (m,) whether a side hides what is behind it.
    width, height:
        of the picture, px; sides outside of it are left out.
    """
    places, width, height = places / PIXEL, ceil(width / PIXEL), ceil(height / PIXEL)
    x, y = places[sides, 0], places[sides, 1]
    inside = (x.max(axis=1) > 0) & (x.min(axis=1) < width) & (y.max(axis=1) > 0) & (y.min(axis=1) < height)
    front = np.flatnonzero(inside & (signed_areas(places, sides) > 0.0))
    corners = places[sides[front]]
    samples = _sampled(corners, width, height)
    wall = np.full(width * height, -np.inf)
    hides = opaque[front][samples.side]
    np.maximum.at(wall, samples.pixel[hides], samples.depth[hides])
    seen = np.zeros(len(front), dtype=bool)
    seen[samples.side[samples.depth >= wall[samples.pixel] - _SAME_DEPTH]] = True
    # A side between the pixels is judged at the nearest one.
    small = np.setdiff1d(np.arange(len(front)), samples.side)
    middle = corners[small].mean(axis=1)
    column = np.clip(middle[:, 0], 0, width - 1).astype(np.int64)
    row = np.clip(middle[:, 1], 0, height - 1).astype(np.int64)
    seen[small] = middle[:, 2] >= wall[row * width + column] - _OWN_SLOPE
    order = _sorted(corners[:, :, 2].mean(axis=1), seen, _constraints(samples, seen))
    return Painting(front[order], np.isfinite(wall).reshape(height, width))


def _sampled(corners: FloatArray, width: int, height: int) -> _Samples:
    """Samples of sides (m, 4, 3) in pixels, each of them as two triangles, at the middles of the pixels."""
    low = np.ceil(corners[:, :, :2].min(axis=1) - 0.5).astype(np.int64).clip(0)
    high = np.floor(corners[:, :, :2].max(axis=1) - 0.5).astype(np.int64)
    size = (np.minimum(high, [width - 1, height - 1]) - low + 1).clip(0)
    count = size.prod(axis=1)
    side = np.repeat(np.arange(len(corners)), count)
    position = np.arange(len(side)) - np.repeat(np.cumsum(count) - count, count)
    column = low[side, 0] + position % np.maximum(size[side, 0], 1)
    row = low[side, 1] + position // np.maximum(size[side, 0], 1)
    found = np.zeros(len(side), dtype=bool)
    depth = np.full(len(side), -np.inf)
    for triangle in ((0, 1, 2), (0, 2, 3)):
        first, second, third = (corners[:, at] for at in triangle)
        edge, other = (second - first)[:, :2], (third - first)[:, :2]
        area = edge[:, 0] * other[:, 1] - edge[:, 1] * other[:, 0]
        flat = np.abs(area) < 1e-12
        scale = np.where(flat, 0.0, 1.0 / np.where(flat, 1.0, area))[side]
        px, py = column + 0.5 - first[side, 0], row + 0.5 - first[side, 1]
        along = (px * other[side, 1] - py * other[side, 0]) * scale
        across = (py * edge[side, 0] - px * edge[side, 1]) * scale
        within = ~flat[side] & (along >= 0.0) & (across >= 0.0) & (along + across <= 1.0)
        here = first[side, 2] + along * (second - first)[side, 2] + across * (third - first)[side, 2]
        depth = np.where(within, np.maximum(depth, here), depth)
        found |= within
    pixel = row * width + column
    return _Samples(pixel[found], side[found], depth[found])


def _constraints(samples: _Samples, seen: Flags) -> IntArray:
    """(c, 2) pairs of sides, the first of which must be painted before the second."""
    shown = seen[samples.side]
    pixel, side, depth = samples.pixel[shown], samples.side[shown], samples.depth[shown]
    if not pixel.size:
        return np.empty((0, 2), dtype=np.int64)
    order = np.lexsort((depth, pixel))
    pixel, side, depth = pixel[order], side[order], depth[order]
    last = np.flatnonzero(np.append(np.diff(pixel) != 0, True))
    nearest = last[np.searchsorted(last, np.arange(len(pixel)))]
    following = np.minimum(np.arange(len(pixel)) + 1, nearest)
    pairs = [np.column_stack([side, side[over]])[depth[over] - depth > _SAME_DEPTH] for over in (nearest, following)]
    code = np.unique(np.concatenate(pairs) @ np.array([len(seen), 1]))
    return np.column_stack(np.divmod(code, len(seen)))


def _sorted(depth: FloatArray, seen: Flags, before: IntArray) -> IntArray:
    """The seen sides so that every pair of ``before`` (c, 2) is kept, and from far to near where it leaves a choice.

    Sides that hide each other in a circle are painted by their depth.
    """
    waiting = np.bincount(before[:, 1], minlength=len(depth)).tolist()
    starts = np.searchsorted(before[:, 0], np.arange(len(depth) + 1)).tolist()
    later, far_first, keys = before[:, 1].tolist(), np.argsort(depth, kind="stable"), depth.tolist()
    candidates = [side for side in far_first.tolist() if seen[side]]
    ready = [(keys[side], side) for side in candidates if not waiting[side]]
    done, farthest = [False] * len(keys), iter(candidates)
    answer: list[int] = []
    while len(answer) < len(candidates):
        side = heapq.heappop(ready)[1] if ready else next(each for each in farthest if not done[each])
        if done[side]:
            continue
        done[side] = True
        answer.append(side)
        for other in later[starts[side] : starts[side + 1]]:
            waiting[other] -= 1
            if not waiting[other] and not done[other]:
                heapq.heappush(ready, (keys[other], other))
    return np.array(answer, dtype=np.int64)
