"""Cell sides on their reference triangle or square: nodes, border and convex parts.

The coordinates and the order of the nodes are those of :func:`stickslip.structure.shapes.side_shape_functions`:
triangles on x, y >= 0, x + y <= 1, squares on [-1, 1]^2; corners counter-clockwise, then the middles of the edges.
"""

from __future__ import annotations

import numpy as np

from stickslip.core.validation import FloatArray

_TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])  # corners of the reference triangle
_SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])  # corners of the reference square


def _with_middles(corners: FloatArray) -> FloatArray:
    return np.vstack([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))])


# Number of nodes of a side -> their reference coordinates (k, 2).
SIDE_NODES = {3: _TRIANGLE, 4: _SQUARE, 6: _with_middles(_TRIANGLE), 8: _with_middles(_SQUARE)}
# Its nodes in the order in which the border passes them.
SIDE_BORDER = {3: np.arange(3), 4: np.arange(4), 6: np.array([0, 3, 1, 4, 2, 5]), 8: np.array([0, 4, 1, 5, 2, 6, 3, 7])}
# Convex parts (f, 4) that tile it, with nodes as corners; a triangle repeats its last corner.
SIDE_FACETS = {
    3: np.array([[0, 1, 2, 2]]),
    4: np.array([[0, 1, 2, 3]]),
    6: np.array([[0, 3, 5, 5], [3, 1, 4, 4], [5, 4, 2, 2], [3, 4, 5, 5]]),
    8: np.array([[0, 4, 7, 7], [4, 1, 5, 5], [5, 2, 6, 6], [6, 3, 7, 7], [4, 5, 6, 7]]),
}
