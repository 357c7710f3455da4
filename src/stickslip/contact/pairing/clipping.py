"""Convex polygons in a plane, many at a time: clip one by another, and map points back into four-cornered parts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.structure.mesh import IntArray

_NEWTON_STEPS = 12  # chosen: more than quadratic convergence inside a convex cell needs


def clip(subject: FloatArray, window: FloatArray) -> tuple[FloatArray, IntArray]:
    """Intersections of convex polygons ``subject`` (c, 4, 2) with convex polygons ``window`` (c, 4, 2).

    Both run counter-clockwise; a triangle repeats a corner. Returns corners (c, v, 2), counter-clockwise, and their
    number (c,), 0 where nothing is left. Corners closer than 1e-9 of the subject's size count as one.

    Source: I. E. Sutherland, G. W. Hodgman, Reentrant polygon clipping, Commun. ACM 17 (1974) 32-42.
    """
    size = np.ptp(subject, axis=1).max(axis=1)
    polygon, count = subject, np.full(len(subject), subject.shape[1])
    for edge in range(window.shape[1]):
        start = window[:, edge]
        along = window[:, (edge + 1) % window.shape[1]] - start
        length = np.linalg.norm(along, axis=1)
        inward = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.where(length > 0.0, length, 1.0)[:, None]
        polygon, count = _cut(polygon, count, start, inward)
    return _without_doubles(polygon, count, 1e-9 * size)


def _cut(polygon: FloatArray, count: IntArray, start: FloatArray, inward: FloatArray) -> tuple[FloatArray, IntArray]:
    """The part of each polygon on the inward side of the line through ``start`` (c, 2)."""
    position = np.arange(polygon.shape[1])
    used = position < count[:, None]
    following = np.where(position + 1 < count[:, None], position + 1, 0)
    height = np.einsum("cvx,cx->cv", polygon - start[:, None], inward)
    next_height = np.take_along_axis(height, following, axis=1)
    next_corner = np.take_along_axis(polygon, following[..., None], axis=1)
    crosses = used & ((height > 0.0) & (next_height < 0.0) | (height < 0.0) & (next_height > 0.0))
    share = height / np.where(crosses, height - next_height, 1.0)
    crossing = polygon + share[..., None] * (next_corner - polygon)
    # Each corner yields itself if it is inside, then the crossing of the edge behind it.
    both = np.stack([polygon, crossing], axis=2).reshape(len(polygon), -1, 2)
    keep = np.stack([used & (height >= 0.0), crosses], axis=2).reshape(len(polygon), -1)
    return _packed(both, keep)


def _packed(corners: FloatArray, keep: NDArray[np.bool_]) -> tuple[FloatArray, IntArray]:
    """The corners in ``keep`` of each polygon moved to the front of its row."""
    count = keep.sum(axis=1)
    order = np.argsort(~keep, axis=1, kind="stable")[:, : max(int(count.max(initial=0)), 1)]
    return np.take_along_axis(corners, order[..., None], axis=1), count


def _without_doubles(polygon: FloatArray, count: IntArray, tolerance: FloatArray) -> tuple[FloatArray, IntArray]:
    """Drop corners at the position of the one before them, and polygons with less than three corners."""
    position = np.arange(polygon.shape[1])
    before = np.where(position > 0, position - 1, np.maximum(count, 1)[:, None] - 1)
    distance = np.linalg.norm(polygon - np.take_along_axis(polygon, before[..., None], axis=1), axis=2)
    packed, left = _packed(polygon, (position < count[:, None]) & (distance > tolerance[:, None]))
    return packed, np.where(left < 3, 0, left)


def corner_weights(corners: FloatArray, points: FloatArray) -> FloatArray:
    """(c, v, 4) weights with which ``corners`` (c, 4, 2) of parts give the ``points`` (c, v, 2) inside them.

    Area coordinates in a triangle (its last corner is repeated and has weight 0), the bilinear functions in a
    quadrilateral, with coordinates from Newton's iteration (one step in a parallelogram).
    """
    weights = np.zeros((*points.shape[:2], 4))
    triangle = (corners[:, 2] == corners[:, 3]).all(axis=1)
    weights[triangle, :, :3] = _area_coordinates(corners[triangle], points[triangle])
    s, t = np.moveaxis(_inverse_bilinear(corners[~triangle], points[~triangle]), -1, 0)
    weights[~triangle] = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=-1)
    return weights


def _area_coordinates(corners: FloatArray, points: FloatArray) -> FloatArray:
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    matrix = np.stack([first, second], axis=2)
    share = np.einsum("cab,cvb->cva", np.linalg.inv(matrix), points - corners[:, :1])
    return np.concatenate([1.0 - share.sum(axis=2, keepdims=True), share], axis=2)


def _inverse_bilinear(corners: FloatArray, points: FloatArray) -> FloatArray:
    """(c, v, 2) s and t of ``x = (1-s)(1-t) c0 + s(1-t) c1 + s t c2 + (1-s) t c3``."""
    base, first, second = corners[:, :1], corners[:, 1:2] - corners[:, :1], corners[:, 3:] - corners[:, :1]
    twist = corners[:, 2:3] - corners[:, 1:2] - second
    where = np.full_like(points, 0.5)
    for _ in range(_NEWTON_STEPS):
        s, t = where[..., :1], where[..., 1:]
        residual = base + s * first + t * second + s * t * twist - points
        matrix = np.stack([first + t * twist, second + s * twist], axis=-1)
        # Corners of a convex quadrilateral lie where the map is regular; the bound keeps early steps there.
        where = np.clip(where - np.linalg.solve(matrix, residual[..., None])[..., 0], -0.1, 1.1)
    return where
