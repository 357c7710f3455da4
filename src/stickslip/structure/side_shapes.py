"""Shape functions and integration rules of cell sides: triangles with 3 or 6 nodes, quadrilaterals with 4 or 8.

Triangles live on xi, eta >= 0, xi + eta <= 1; quadrilaterals on [-1, 1]^2. Nodes run corners first, counter-clockwise,
then the midside nodes: the first one stands between corners 0 and 1.
"""

from __future__ import annotations

import numpy as np

from stickslip.structure.mesh import IntArray
from stickslip.validation import FloatArray

_TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
_SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def _with_middles(corners: FloatArray) -> FloatArray:
    return np.vstack([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))])


# Number of nodes -> their reference coordinates (k, 2).
NODES = {3: _TRIANGLE, 4: _SQUARE, 6: _with_middles(_TRIANGLE), 8: _with_middles(_SQUARE)}
N_CORNERS = {3: 3, 4: 4, 6: 3, 8: 4}
# Convex parts (f, 4) whose corners are nodes of the side; a triangle repeats its last corner.
FACETS = {
    3: np.array([[0, 1, 2, 2]]),
    4: np.array([[0, 1, 2, 3]]),
    6: np.array([[0, 3, 5, 5], [3, 1, 4, 4], [5, 4, 2, 2], [3, 4, 5, 5]]),
    8: np.array([[0, 4, 7, 7], [4, 1, 5, 5], [5, 2, 6, 6], [6, 3, 7, 7], [4, 5, 6, 7]]),
}
# The nodes in the order in which the border passes them.
BORDER = {3: np.arange(3), 4: np.arange(4), 6: np.array([0, 3, 1, 4, 2, 5]), 8: np.array([0, 4, 1, 5, 2, 6, 3, 7])}


def side_functions(n_nodes: int, where: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values (q, k) and gradients (q, k, 2) of the functions of a side with k = ``n_nodes`` at points (q, 2)."""
    if N_CORNERS[n_nodes] == 3:
        values, gradients = _triangle(where)
        return (values, gradients) if n_nodes == 3 else _quadratic_triangle(values, gradients)
    return _bilinear(where) if n_nodes == 4 else _serendipity(where)


def _triangle(where: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Area coordinates (q, 3) and their constant gradients (q, 3, 2)."""
    values = np.column_stack([1.0 - where.sum(axis=1), where])
    return values, np.broadcast_to([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]], (len(where), 3, 2))


def _quadratic_triangle(area: FloatArray, slope: FloatArray) -> tuple[FloatArray, FloatArray]:
    following = np.roll(area, -1, axis=1)
    values = np.hstack([area * (2.0 * area - 1.0), 4.0 * area * following])
    middle = 4.0 * (slope * following[..., None] + area[..., None] * np.roll(slope, -1, axis=1))
    return values, np.concatenate([(4.0 * area - 1.0)[..., None] * slope, middle], axis=1)


def _bilinear(where: FloatArray) -> tuple[FloatArray, FloatArray]:
    first, second = 1.0 + where[:, :1] * _SQUARE[:, 0], 1.0 + where[:, 1:] * _SQUARE[:, 1]
    gradients = np.stack([_SQUARE[:, 0] * second, first * _SQUARE[:, 1]], axis=2)
    return 0.25 * first * second, 0.25 * gradients


def _serendipity(where: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Corners: bilinear less half of the two midside functions beside them."""
    xi, eta = where.T
    half = 0.5 * np.ones_like(xi)
    middle = np.column_stack(
        [(1 - xi**2) * (1 - eta), (1 + xi) * (1 - eta**2), (1 - xi**2) * (1 + eta), (1 - xi) * (1 - eta**2)]
    )
    along_xi = np.column_stack([-xi * (1 - eta), half * (1 - eta**2), -xi * (1 + eta), -half * (1 - eta**2)])
    along_eta = np.column_stack([-half * (1 - xi**2), -eta * (1 + xi), half * (1 - xi**2), -eta * (1 - xi)])
    middle, slope = 0.5 * middle, np.stack([along_xi, along_eta], axis=2)
    values, gradients = _bilinear(where)
    values = values - 0.5 * (middle + np.roll(middle, 1, axis=1))
    gradients = gradients - 0.5 * (slope + np.roll(slope, 1, axis=1))
    return np.hstack([values, middle]), np.concatenate([gradients, slope], axis=1)


def triangle_rule(degree: int) -> tuple[FloatArray, FloatArray]:
    """Points (q, 2) inside the reference triangle and positive weights (q,) that sum to 1/2, exact to degree 2 or 4.

    Source: D. A. Dunavant, High degree efficient symmetrical Gaussian quadrature rules for the triangle, Int. J. Numer.
    Methods Eng. 21 (1985) 1129-1148; the six points of degree 4 are given by their closed form.
    """
    if degree == 2:
        far, weights = np.full(1, 2.0 / 3.0), np.full(1, 1.0 / 3.0)
    else:
        root = np.sqrt(38.0 - 44.0 * np.sqrt(0.4))
        near = (8.0 - np.sqrt(10.0) + np.array([1.0, -1.0]) * root) / 18.0
        far = 1.0 - 2.0 * near
        spread = np.sqrt(213125.0 - 53320.0 * np.sqrt(10.0))
        weights = (620.0 + np.array([1.0, -1.0]) * spread) / 3720.0
    near = 0.5 * (1.0 - far)
    orbit = [np.column_stack([near, near]), np.column_stack([far, near]), np.column_stack([near, far])]
    return np.vstack(orbit), 0.5 * np.tile(weights, 3)


def square_rule(order: int) -> tuple[FloatArray, FloatArray]:
    """Gauss product rule on [-1, 1]^2: points (order^2, 2) and weights (order^2,) that sum to 4."""
    abscissa, weight = np.polynomial.legendre.leggauss(order)
    points = np.stack(np.meshgrid(abscissa, abscissa, indexing="ij"), axis=-1).reshape(-1, 2)
    return points, np.outer(weight, weight).ravel()


def surface_vectors(sides: FloatArray, gradients: FloatArray) -> FloatArray:
    """(m, q, 3) vectors ``x_xi x x_eta`` of sides (m, k, 3): outward, as long as the area per reference area."""
    along_xi, along_eta = (np.einsum("qk,mkx->mqx", gradients[..., axis], sides) for axis in (0, 1))
    return np.cross(along_xi, along_eta)


def side_geometry(sides: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Area share of each node (m, k) in m2, and mean unit normal (m, 3), of sides given by their nodes (m, k, 3).

    On linear sides the share is ``integral of N_i dA``. On quadratic sides that integral is not positive at the
    corners, so the side's area is shared in proportion to ``integral of N_i^2 dA`` instead (diagonal scaling, as for
    lumped masses). The shares sum to the area of the side either way.
    """
    n_nodes = sides.shape[1]
    where, weight = triangle_rule(4) if N_CORNERS[n_nodes] == 3 else square_rule(3)
    values, gradients = side_functions(n_nodes, where)
    vectors = surface_vectors(sides, gradients)
    area = weight * np.linalg.norm(vectors, axis=2)
    if n_nodes in (3, 4):
        share = area @ values
    else:
        share = area @ values**2
        share *= (area.sum(axis=1) / share.sum(axis=1))[:, None]
    total = np.einsum("q,mqx->mx", weight, vectors)
    return share, total / np.linalg.norm(total, axis=1, keepdims=True)


def facet_corners(n_nodes: int) -> tuple[IntArray, FloatArray]:
    """Facets (f, 4) of a side as positions of its nodes, and their corners (f, 4, 2) in reference coordinates."""
    return FACETS[n_nodes], NODES[n_nodes][FACETS[n_nodes]]
