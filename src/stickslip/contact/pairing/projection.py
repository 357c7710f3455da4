"""Points of one face projected along their normals on the sides of another face.

The ray from a point p along its unit normal n intersects a side with shape functions N where ``sum N_k(xi, eta) x_k = p
+ g n``; Newton's iteration solves for xi, eta and the gap g. The ray has the direction of the smoothed normal of the
face of the point, not that to the closest point of the other face, for two reasons. The smoothed normal turns steadily,
so a point that slides over the edge of a facet does not jump as its closest point does. And the two points of a pair
then differ by ``g n`` alone, so that their forces along n are equal and opposite on one line: forces and moments
balance to round-off. Source: M. A. Puso, T. A. Laursen, A mortar segment-to-segment contact method for large
deformation solid mechanics, Comput. Methods Appl. Mech. Engrg. 193 (2004) 601-629 (averaged nodal normals).

A point beyond every side by less than the edge tolerance takes the shape functions of the nearest side beyond its
border: they still sum to 1 and still reproduce its position, so forces and moments balance there too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from stickslip.contact.pairing.surface_mesh import WIDEST_SIDE, SurfaceMesh
from stickslip.core.validation import FloatArray
from stickslip.structure.mesh import IntArray
from stickslip.structure.shapes import side_shape_functions

PAIRED, BEYOND_EDGE, TOO_FAR, NOT_FACING, OTHER_PART = 0, 1, 2, 3, 4  # indices in REASONS
REASONS = (
    "paired",
    "beyond the edge",
    "farther than the search distance",
    "on sides that do not face each other",
    "on other sides of the body, round a sharp edge",
)
LARGEST_ANGLE_DEG = 60.0  # between a normal and the reversed normal of the other face
_NEWTON_STEPS = 20  # chosen: more than quadratic convergence needs; without it there is no partner
_NEAREST_SIDES = 8  # searched for the reason why a point has no partner
_CONVERGED = 1e-10  # step in reference coordinates; quadratic convergence: the one before was about its square root
_ROUND_OFF = 1e-9  # in reference coordinates
_POINTS_AT_ONCE = 20000  # chosen: the arrays of their candidates stay below about 200 MB


@dataclass(frozen=True)
class Projection:
    """Projections of points (q,) on a surface.

    Parameters
    ----------
    reason:
        (q,) 0 with a partner, else an index in ``REASONS``.
    side, weights:
        (q,) and (q, 8) the side of the partner and its shape functions there; without meaning where there is none.
    gap:
        (q,) m along the normal to the side, infinite where the normal does not intersect its surface.
    overhang:
        (q,) m between the point and the border of the side, seen along the normal; 0 inside.
    """

    reason: IntArray
    side: IntArray
    weights: FloatArray
    gap: FloatArray
    overhang: FloatArray


def project(
    points: FloatArray, normal: FloatArray, surface: SurfaceMesh, search_distance: float, edge_tolerance: float
) -> Projection:
    """Project points (q, 3) along unit normals (q, 3) on a surface; lengths in m.

    A partner is within ``search_distance`` along the normal, in both directions, within ``edge_tolerance`` of the
    side's border, and on a side whose normal is opposite to the point's within ``LARGEST_ANGLE_DEG``. The nearest of
    several counts.
    """
    tree = cKDTree(surface.centre)
    limits = (search_distance, edge_tolerance)
    parts = []
    for start in range(0, max(len(points), 1), _POINTS_AT_ONCE):
        some = slice(start, start + _POINTS_AT_ONCE)
        parts.append(_project(points[some], normal[some], surface, tree, limits))
    return Projection(*(np.concatenate(part) for part in zip(*(vars(part).values() for part in parts), strict=True)))


def _project(
    points: FloatArray, normal: FloatArray, surface: SurfaceMesh, tree: cKDTree, limits: tuple[float, float]
) -> Projection:
    """:func:`project` of a few points; ``limits`` are its search distance and edge tolerance."""
    reach = sum(limits)
    point, side = _flat(tree.query_ball_point(points, reach + float(surface.radius.max())))
    close = np.linalg.norm(points[point] - surface.centre[side], axis=1) <= reach + surface.radius[side]
    best = _best(points, normal, surface, point[close], side[close], limits)
    unpaired = np.flatnonzero(best.reason != PAIRED)
    if unpaired.size:  # the sides nearest to unpaired points give the reason, at any distance
        count = min(_NEAREST_SIDES, len(surface.sides))
        nearest = np.asarray(tree.query(points[unpaired], k=count)[1]).reshape(len(unpaired), count)
        point, side = np.repeat(np.arange(len(unpaired)), count), nearest.ravel()
        why = _best(points[unpaired], normal[unpaired], surface, point, side, limits)
        for name, values in vars(best).items():
            values[unpaired] = getattr(why, name)
    return best


def _flat(lists: list[list[int]]) -> tuple[IntArray, IntArray]:
    """Point and side of each candidate."""
    count = np.array([len(sides) for sides in lists], dtype=np.int64)
    flat = np.fromiter((side for sides in lists for side in sides), dtype=np.int64, count=int(count.sum()))
    return np.repeat(np.arange(len(lists)), count), flat


def _best(
    points: FloatArray,
    normal: FloatArray,
    surface: SurfaceMesh,
    point: IntArray,
    side: IntArray,
    limits: tuple[float, float],
) -> Projection:
    """The best of the candidates (point, side) for each point: first those that pair, then the nearest."""
    search_distance, edge_tolerance = limits
    where, gap = _meet(points[point], normal[point], surface, side)
    overhang = _overhang(points[point], normal[point], surface, side, where)
    facing = -np.einsum("cx,cx->c", normal[point], surface.side_normal[side])
    reason = np.full(len(point), PAIRED)
    reason[np.abs(gap) > search_distance] = TOO_FAR
    reason[(overhang > edge_tolerance) | ~np.isfinite(gap)] = BEYOND_EDGE
    reason[facing < np.cos(np.radians(LARGEST_ANGLE_DEG))] = NOT_FACING
    distance = overhang + np.where(np.isfinite(gap), np.abs(gap), 0.0)
    # A side that faces away gives no reason about the edges of the others, so it comes last.
    rank = np.array([0, 1, 1, 2])[reason]
    order = np.lexsort((side, distance, rank, point))
    chosen = order[np.unique(point[order], return_index=True)[1]]
    count = len(points)
    answer = Projection(
        np.full(count, TOO_FAR), np.zeros(count, dtype=np.int64), np.zeros((count, WIDEST_SIDE)),
        np.full(count, np.inf), np.zeros(count),
    )  # fmt: skip
    at = point[chosen]
    answer.reason[at], answer.side[at] = reason[chosen], side[chosen]
    answer.weights[at] = surface.shape_weights(side[chosen], where[chosen])
    answer.gap[at], answer.overhang[at] = gap[chosen], overhang[chosen]
    return answer


def _meet(
    points: FloatArray, normal: FloatArray, surface: SurfaceMesh, side: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Intersections of rays with the (extended) sides: reference coordinates (c, 2) and gap (c,), infinite without
    one."""
    where, gap = np.zeros((len(side), 2)), np.full(len(side), np.inf)
    for width, members in surface.by_width(side):
        length = surface.radius[side[members]]
        corners = (surface.points[surface.sides[side[members], :width]] - points[members, None]) / length[:, None, None]
        unknown, converged = _newton(width, corners, normal[members])
        where[members] = unknown[:, :2]
        gap[members] = np.where(converged, unknown[:, 2] * length, np.inf)
    return where, gap


def _newton(width: int, corners: FloatArray, normal: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """xi, eta, g (c, 3) of ``sum N_k(xi, eta) x_k = g n`` for corners (c, k, 3), and whether (c,) it converged."""
    unknown = np.zeros((len(corners), 3))
    if width in (3, 6):
        unknown[:, :2] = 1.0 / 3.0
    converged = np.zeros(len(corners), dtype=bool)
    active = np.arange(len(corners))
    for _ in range(_NEWTON_STEPS):
        values, gradients = side_shape_functions(width, unknown[active, :2])
        tangents = np.einsum("cka,ckx->cxa", gradients, corners[active])
        matrix = np.concatenate([tangents, -normal[active, :, None]], axis=2)
        # A ray parallel to the side has no intersection.
        regular = np.abs(np.linalg.det(matrix)) > 1e-9
        active = active[regular]
        residual = np.einsum("ck,ckx->cx", values[regular], corners[active]) - unknown[active, 2:] * normal[active]
        step = np.linalg.solve(matrix[regular], residual[..., None])[..., 0]
        # Steps are bounded: far outside a distorted side the map folds back and a full step would diverge.
        unknown[active] -= step * np.minimum(1.0, 2.0 / np.maximum(np.abs(step[:, :2]).max(axis=1), 2.0))[:, None]
        arrived = np.abs(step).max(axis=1) < _CONVERGED
        converged[active[arrived]] = True
        active = active[~arrived]
        if not active.size:
            break
    return unknown, converged


def _overhang(
    points: FloatArray, normal: FloatArray, surface: SurfaceMesh, side: IntArray, where: FloatArray
) -> FloatArray:
    """(c,) m from points to the borders of sides in the plane across the normal; 0 where the ray intersects the
    side."""
    triangle = np.isin(surface.width[side], (3, 6))
    in_triangle = np.minimum(where.min(axis=1), 1.0 - where.sum(axis=1)) >= -_ROUND_OFF
    inside = np.where(triangle, in_triangle, np.abs(where).max(axis=1) <= 1.0 + _ROUND_OFF)
    overhang = np.zeros(len(side))
    outside = np.flatnonzero(~inside)
    start = surface.border(side[outside]) - points[outside, None]
    start -= np.einsum("ckx,cx->ck", start, normal[outside])[..., None] * normal[outside, None]
    along = np.roll(start, -1, axis=1) - start
    squared = np.einsum("ckx,ckx->ck", along, along)
    share = -np.einsum("ckx,ckx->ck", start, along) / np.where(squared > 0.0, squared, 1.0)
    nearest = start + np.clip(share, 0.0, 1.0)[..., None] * along
    overhang[outside] = np.linalg.norm(nearest, axis=2).min(axis=1)
    return overhang
