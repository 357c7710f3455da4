"""Areas and outward normals that belong to the nodes of a face."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from stickslip.structure.mesh import IntArray
from stickslip.structure.side_shapes import side_geometry
from stickslip.validation import FloatArray


class FaceMesh(Protocol):
    """What the faces of a mesh are found from."""

    @property
    def points(self) -> FloatArray: ...

    @property
    def n_nodes(self) -> int: ...

    def node_set(self, name: str) -> IntArray: ...

    def sides(self, name: str) -> tuple[IntArray, ...]: ...


def face_geometry(mesh: FaceMesh, name: str) -> tuple[IntArray, FloatArray, FloatArray]:
    """Nodes (k,) of a face set, the area (k,) in m2 that each node stands for, and its outward unit normal (k, 3).

    The areas are those of :func:`stickslip.structure.side_shapes.side_geometry` and sum to the area of the face. A
    node's normal is the mean of the sides around it, weighted with these areas. Nodes keep the order of the set.

    Raises InputError when the set is missing, empty, or holds no whole side of a cell.
    """
    area, normal = np.zeros(mesh.n_nodes), np.zeros((mesh.n_nodes, 3))
    for sides in mesh.sides(name):
        share, direction = side_geometry(mesh.points[sides])
        np.add.at(area, sides, share)
        np.add.at(normal, sides, share[:, :, None] * direction[:, None, :])
    nodes = mesh.node_set(name)
    length = np.linalg.norm(normal[nodes], axis=1, keepdims=True)
    return nodes, area[nodes], np.divide(normal[nodes], length, out=np.zeros_like(normal[nodes]), where=length > 0.0)
