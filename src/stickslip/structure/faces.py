"""Areas and outward normals that belong to the nodes of a face."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.shapes import side_rule, side_shape_functions


def face_geometry(mesh: Mesh, name: str) -> tuple[IntArray, FloatArray, FloatArray]:
    """Nodes (k,) of a face set, the area (k,) in m2 that each node represents, and its outward unit normal (k, 3).

    On sides of three or four nodes the area is ``integral of N_i dA``. With midside nodes that integral is zero or
    negative at the corners, so the area of the side is distributed in proportion to ``integral of N_i^2 dA`` instead
    (diagonal scaling, as for lumped masses). The areas sum to the area of the face in both cases. The normal of a node
    is the mean of the sides around it, weighted with these areas. Nodes are in the order of the set.

    Raises InputError if the set is missing, empty, or contains no complete side of a cell.
    """
    nodes = mesh.node_set(name)
    area, normal = node_geometry(mesh.points, mesh.sides(name))
    return nodes, area[nodes], normal[nodes]


def node_geometry(points: FloatArray, groups: Iterable[IntArray]) -> tuple[FloatArray, FloatArray]:
    """Area (n_nodes,) in m2 and mean unit normal (n_nodes, 3) of all nodes from groups of sides (m, k); zero off the
    sides. :func:`face_geometry` has the weights."""
    area = np.zeros(len(points))
    normal = np.zeros((len(points), 3))
    for sides in groups:
        share, direction = side_geometry(points[sides])
        np.add.at(area, sides, share)
        np.add.at(normal, sides, share[:, :, None] * direction[:, None, :])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return area, np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)


def side_geometry(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Area of each node (m, k), and mean unit normal (m, 3), of sides with nodes (m, k, 3)."""
    n_nodes = points.shape[1]
    where, weight = side_rule(n_nodes)
    values, gradients = side_shape_functions(n_nodes, where)
    along_xi, along_eta = (np.einsum("qk,mkx->mqx", gradients[..., axis], points) for axis in (0, 1))
    area_vector = np.cross(along_xi, along_eta)
    element_area = weight * np.linalg.norm(area_vector, axis=2)
    if n_nodes in (3, 4):
        share = element_area @ values
    else:
        share = element_area @ values**2
        share *= (element_area.sum(axis=1) / share.sum(axis=1))[:, None]
    total = np.einsum("q,mqx->mx", weight, area_vector)
    return share, total / np.linalg.norm(total, axis=1, keepdims=True)
