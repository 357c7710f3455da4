"""Integration points of a face: the projected sides of the other face cut its sides into cells, and each cell has
points.

Shape functions of the other face have kinks at the borders of its sides. A rule for a complete side of the first face
integrates across them and so gives wrong nodal forces for a uniform pressure. On a cell, the intersection of one side
of each face, both sets of functions are smooth, and a low rule is exact: a uniform pressure then gives the exact nodal
forces of both faces, and the patch test passes to round-off where the sides are triangles or parallelograms.

Each convex part of a side (itself, or the parts between the nodes of a side with midside nodes) is projected on its own
mean plane together with the facing parts of the other face, clipped there, and taken back to the reference coordinates
of the side. The cells are polygons in these coordinates, so they tile the side whatever its shape, and areas add up.

Source: M. A. Puso, A 3D mortar method for solid mechanics, Int. J. Numer. Meth. Engng 59 (2004) 315-336 (cells by
clipping in a mean plane, sides with midside nodes in linear parts).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from stickslip.contact.pairing.clipping import clip, corner_weights
from stickslip.contact.pairing.projection import LARGEST_ANGLE_DEG
from stickslip.contact.pairing.surface_mesh import SurfaceMesh
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.mesh import IntArray
from stickslip.structure.shapes import side_shape_functions, square_rule, triangle_rule
from stickslip.structure.side_parts import SIDE_FACETS, SIDE_NODES

_SMALLEST_CELL = 1e-12  # of its side, in reference coordinates: smaller slivers are round-off
_DOUBLE_COVER = 1e-6  # of a side, in reference coordinates


@dataclass(frozen=True)
class IntegrationPoints:
    """Points of a face with the part of its area that each represents.

    Parameters
    ----------
    side:
        (q,) side of the face, in increasing order.
    weights:
        (q, 8) its shape functions at the point.
    points:
        (q, 3) m.
    area:
        (q,) m2.
    covered:
        (m,) fraction of each side, in its reference coordinates, that is in cells.
    """

    side: IntArray
    weights: FloatArray
    points: FloatArray
    area: FloatArray
    covered: FloatArray


def whole_side_points(surface: SurfaceMesh) -> IntegrationPoints:
    """Points of a rule for each complete side: 3 (6 nodes: 6) in a triangle, 2 x 2 (8 nodes: 3 x 3) in a
    quadrilateral."""
    side, corners, count = [], [], []
    for width, members in surface.by_width(np.arange(len(surface.sides))):
        n_corners = 3 if width in (3, 6) else 4
        polygon = np.pad(SIDE_NODES[width][:n_corners], ((0, 4 - n_corners), (0, 0)))
        side.append(members)
        corners.append(np.broadcast_to(polygon, (len(members), 4, 2)))
        count.append(np.full(len(members), n_corners))
    return _points(
        surface, np.concatenate(side), np.concatenate(corners), np.concatenate(count), int(surface.width.max())
    )


def cut_points(first: SurfaceMesh, second: SurfaceMesh, search_distance: float) -> IntegrationPoints:
    """Points of ``first`` in its cells with the facing sides of ``second`` within ``search_distance`` (m).

    Raises InputError where ``second`` covers a part of ``first`` twice.
    """
    side_1, reference, corners_1 = _parts(first)
    _, _, corners_2 = _parts(second)
    centre_1, centre_2 = corners_1.mean(axis=1), corners_2.mean(axis=1)
    radius_1, radius_2 = (
        np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
        for corners, centre in ((corners_1, centre_1), (corners_2, centre_2))
    )
    reach = search_distance + radius_1 + float(radius_2.max())
    near = cKDTree(centre_2).query_ball_point(centre_1, reach)
    part = np.repeat(np.arange(len(near)), [len(sides) for sides in near])
    other = np.fromiter((at for sides in near for at in sides), dtype=np.int64, count=len(part))
    normal_1, normal_2 = _normals(corners_1), _normals(corners_2)
    facing = -np.einsum("cx,cx->c", normal_1[part], normal_2[other]) >= np.cos(np.radians(LARGEST_ANGLE_DEG))
    height = np.abs(np.einsum("cx,cx->c", centre_2[other] - centre_1[part], normal_1[part]))
    close = facing & (height <= search_distance + radius_1[part] + radius_2[other])
    part, other = part[close], other[close]

    frame = _plane(corners_1, normal_1)[part]
    flat_1 = np.einsum("cvx,cax->cva", corners_1[part] - centre_1[part][:, None], frame)
    # Seen along the normal of the first face, the second one runs clockwise; its first corner becomes the last.
    flat_2 = np.einsum("cvx,cax->cva", corners_2[other][:, ::-1] - centre_1[part][:, None], frame)
    polygon, count = clip(flat_1, flat_2)
    nonempty = count > 0
    part, polygon, count = part[nonempty], polygon[nonempty], count[nonempty]
    cells = np.einsum("cvk,ckx->cvx", corner_weights(flat_1[nonempty], polygon), reference[part])
    answer = _points(first, side_1[part], cells, count, max(int(first.width.max()), int(second.width.max())))
    twice = np.flatnonzero(answer.covered > 1.0 + _DOUBLE_COVER)
    if twice.size:
        x, y, z = 1e3 * first.centre[twice[0]]
        raise InputError(
            f"the side of '{first.name}' at ({x:.4g}, {y:.4g}, {z:.4g}) mm is covered {answer.covered[twice[0]]:.3g} "
            f"times by '{second.name}' within the search distance of {1e3 * search_distance:.3g} mm ({twice.size} "
            "sides are): the second face has several layers there. Give a smaller search_distance, or remove the "
            "layers behind from the set."
        )
    return answer


def _parts(surface: SurfaceMesh) -> tuple[IntArray, FloatArray, FloatArray]:
    """Convex parts of all sides: side (p,), corners in its reference coordinates (p, 4, 2), and in m (p, 4, 3)."""
    side, reference, corners = [], [], []
    for width, members in surface.by_width(np.arange(len(surface.sides))):
        facets = SIDE_FACETS[width]
        side.append(np.repeat(members, len(facets)))
        reference.append(np.tile(SIDE_NODES[width][facets], (len(members), 1, 1)))
        corners.append(surface.points[surface.sides[members][:, facets]].reshape(-1, 4, 3))
    return np.concatenate(side), np.concatenate(reference), np.concatenate(corners)


def _normals(corners: FloatArray) -> FloatArray:
    """(p, 3) unit normals of parts (p, 4, 3), from their diagonals."""
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _plane(corners: FloatArray, normal: FloatArray) -> FloatArray:
    """(p, 2, 3) two unit vectors across the normal of each part; with it they make a right-handed set."""
    along = corners[:, 1] - corners[:, 0]
    along -= np.einsum("px,px->p", along, normal)[:, None] * normal
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    return np.stack([along, np.cross(normal, along)], axis=1)


def _points(surface: SurfaceMesh, side: IntArray, cells: FloatArray, count: IntArray, widest: int) -> IntegrationPoints:
    """Points in convex cells (c, v, 2) with ``count`` (c,) corners, in reference coordinates of sides (c,).

    Cells are split into quadrilaterals and a last triangle from their first corner. The rule is exact for the product
    of an area that varies linearly with shape functions of sides that have up to ``widest`` nodes.
    """
    quadratic = widest > 4
    of_square, of_triangle = square_rule(3 if quadratic else 2), triangle_rule(4 if quadratic else 2)
    sides, where, weight = [np.empty(0, dtype=np.int64)], [np.empty((0, 2))], [np.empty(0)]
    for corners in np.unique(count):
        members = np.flatnonzero(count == corners)
        for start in range(1, corners - 1, 2):
            split = [0, *range(start, min(start + 3, corners))]
            rule = of_square if len(split) == 4 else of_triangle
            points, weights = _mapped_rule(cells[members][:, split], *rule)
            sides.append(np.repeat(side[members], points.shape[1]))
            where.append(points.reshape(-1, 2))
            weight.append(weights.ravel())
    at, reference, share = np.concatenate(sides), np.concatenate(where), np.concatenate(weight)
    reference_area = np.where(np.isin(surface.width, (3, 6)), 0.5, 4.0)
    covered = np.bincount(at, share, minlength=len(surface.sides)) / reference_area
    large = np.flatnonzero(share > _SMALLEST_CELL * reference_area[at])
    order = large[np.argsort(at[large], kind="stable")]
    at, reference, share = at[order], reference[order], share[order]
    weights = surface.shape_weights(at, reference)
    area = share * _stretch(surface, at, reference)
    return IntegrationPoints(at, weights, surface.interpolate(surface.points, at, weights), area, covered)


def _mapped_rule(corners: FloatArray, where: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points (c, q, 2) and weights (c, q) of a reference rule in triangles or quadrilaterals (c, 3 or 4, 2)."""
    values, gradients = side_shape_functions(corners.shape[1], where)
    jacobian = np.einsum("qka,ckx->cqxa", gradients, corners)
    return np.einsum("qk,ckx->cqx", values, corners), weight * np.linalg.det(jacobian)


def _stretch(surface: SurfaceMesh, side: IntArray, where: FloatArray) -> FloatArray:
    """(q,) m2 of surface per unit of reference area."""
    stretch = np.empty(len(side))
    for width, members in surface.by_width(side):
        _, gradients = side_shape_functions(width, where[members])
        corners = surface.points[surface.sides[side[members], :width]]
        tangents = np.einsum("qka,qkx->qax", gradients, corners)
        stretch[members] = np.linalg.norm(np.cross(tangents[:, 0], tangents[:, 1]), axis=1)
    return stretch
