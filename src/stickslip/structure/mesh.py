"""Hexahedral meshes: points, cells, bodies and named node sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.errors import InputError
from stickslip.validation import FloatArray, finite_array

IntArray = NDArray[np.int64]

# Local numbering of VTK hexahedra: corners 0-3 counter-clockwise seen from the side of corners 4-7.
CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float
)
EDGES = np.array(
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]], dtype=np.int64
)
# Corners of each side, counter-clockwise seen from outside, then the midside nodes of the 20-node cell between them.
SIDES = np.array(
    [
        [0, 3, 2, 1, 11, 10, 9, 8],
        [4, 5, 6, 7, 12, 13, 14, 15],
        [0, 1, 5, 4, 8, 17, 12, 16],
        [1, 2, 6, 5, 9, 18, 13, 17],
        [2, 3, 7, 6, 10, 19, 14, 18],
        [3, 0, 4, 7, 11, 16, 15, 19],
    ],
    dtype=np.int64,
)
# The three neighbours of each corner in an order that makes their edge vectors right-handed.
_CORNER_NEIGHBOURS = np.array(
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]], dtype=np.int64
)


@dataclass(frozen=True)
class Mesh:
    """Hexahedra in VTK node order, in metres.

    Parameters
    ----------
    points:
        (n, 3) coordinates x, y, z in m.
    cells:
        (m, 8) bricks, or (m, 20) bricks with midside nodes: eight corners, then the nodes of the edges 0-1, 1-2, 2-3,
        3-0, 4-5, 5-6, 6-7, 7-4, 0-4, 1-5, 2-6, 3-7.
    body:
        (m,) number of the body that each cell belongs to; one body when left out.
    node_sets:
        name -> (k,) node numbers.

    Raises
    ------
    InputError
        for coordinates that are not finite, node numbers that do not exist, or a cell that is inverted or flat.
    """

    points: FloatArray
    cells: IntArray
    body: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    node_sets: Mapping[str, IntArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points = finite_array("points", self.points)
        if points.ndim != 2 or points.shape[1] != 3:
            raise InputError(f"points must have shape (n, 3), x, y, z of each node; found shape {points.shape}.")
        cells = _node_numbers("cells", self.cells, len(points))
        if cells.ndim != 2 or cells.shape[1] not in (8, 20) or not len(cells):
            raise InputError(
                f"cells must have shape (m, 8) for bricks or (m, 20) for bricks with midside nodes; "
                f"found shape {cells.shape}."
            )
        body = np.asarray(self.body, dtype=np.int64)
        if not body.size:
            body = np.zeros(len(cells), dtype=np.int64)
        if body.shape != (len(cells),):
            raise InputError(f"body must have shape ({len(cells)},), one number a cell; found shape {body.shape}.")
        sets = {
            name: np.atleast_1d(_node_numbers(f"node set '{name}'", nodes, len(points)))
            for name, nodes in self.node_sets.items()
        }
        _require_upright(points, cells)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "cells", cells)
        object.__setattr__(self, "body", body)
        object.__setattr__(self, "node_sets", sets)

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.points)

    def node_set(self, name: str) -> IntArray:
        """The nodes of a named set; raises InputError when it does not exist or is empty."""
        known = ", ".join(sorted(self.node_sets)) or "none"
        if name not in self.node_sets:
            raise InputError(f"the mesh has no node set '{name}'; it has: {known}.")
        nodes = self.node_sets[name]
        if not nodes.size:
            raise InputError(f"node set '{name}' is empty; give it at least one node, or use another of: {known}.")
        return nodes

    def sides_within(self, name: str) -> IntArray:
        """(k, 4) or (k, 8) nodes of the cell sides that lie wholly in a node set, seen from outside the body.

        Corners run counter-clockwise; in 20-node cells the four midside nodes follow. Sides that two cells share
        are inside the body and left out. Raises InputError when the set is missing, empty, or spans no side.
        """
        member = np.zeros(self.n_nodes, dtype=bool)
        member[self.node_set(name)] = True
        width = 4 if self.cells.shape[1] == 8 else 8
        sides = self.cells[:, SIDES[:, :width]].reshape(-1, width)
        sides = sides[member[sides].all(axis=1)]
        if len(sides):
            _, first, count = np.unique(np.sort(sides[:, :4], axis=1), axis=0, return_index=True, return_counts=True)
            sides = sides[np.sort(first[count == 1])]
        if not len(sides):
            raise InputError(
                f"no side of a cell has all its nodes in node set '{name}' ({member.sum()} nodes); a face set must "
                "hold every node of the sides that make up the face, midside nodes included."
            )
        return np.asarray(sides, dtype=np.int64)

    def sides(self, name: str) -> tuple[IntArray, ...]:
        """:meth:`sides_within` as a tuple of one array: the form that meshes of several kinds of cells share."""
        return (self.sides_within(name),)

    def quadratic(self) -> Mesh:
        """The same bricks with a node in the middle of each edge (20-node serendipity cells).

        Corner nodes keep their numbers; a node set gains every edge node whose two ends it holds.
        """
        if self.cells.shape[1] == 20:
            return self
        cell_edges = np.sort(self.cells[:, EDGES], axis=2)
        edges, position = np.unique(cell_edges.reshape(-1, 2), axis=0, return_inverse=True)
        middle = self.n_nodes + position.reshape(len(self.cells), len(EDGES))
        sets = {}
        for name, nodes in self.node_sets.items():
            inside = np.isin(edges, nodes).all(axis=1)
            sets[name] = np.concatenate([nodes, self.n_nodes + np.flatnonzero(inside)])
        return Mesh(
            points=np.vstack([self.points, self.points[edges].mean(axis=1)]),
            cells=np.hstack([self.cells, middle]),
            body=self.body,
            node_sets=sets,
        )


def _node_numbers(name: str, value: ArrayLike, n_nodes: int) -> IntArray:
    """Return ``value`` as integers after checking that each is the number of a node; raises InputError."""
    array = np.asarray(value)
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"{name} must hold node numbers (integers), but its type is {array.dtype}.")
    array = array.astype(np.int64)
    bad = array[(array < 0) | (array >= n_nodes)]
    if bad.size:
        raise InputError(
            f"{name} names node {bad[0]}, but the mesh has nodes 0 to {n_nodes - 1}; numbers count from 0."
        )
    return array


def _require_upright(points: FloatArray, cells: IntArray) -> None:
    """Raise InputError unless the Jacobian at every corner of every cell is positive."""
    corner = points[cells[:, :8]]
    edge = corner[:, _CORNER_NEIGHBOURS] - corner[:, :, None, :]
    volume = np.linalg.det(edge)
    bad = np.flatnonzero(volume.min(axis=1) <= 1e-12 * np.abs(volume).max(axis=1))
    if bad.size:
        centre = 1e3 * corner[bad[0]].mean(axis=0)
        raise InputError(
            f"cell {bad[0]} (centre at {centre[0]:.3g}, {centre[1]:.3g}, {centre[2]:.3g} mm) is inverted or flat: its "
            f"corner Jacobian falls to {volume[bad[0]].min():.3g} m3 and must stay above 0; {bad.size} of {len(cells)} "
            "cells are like this. Check the order of its nodes and the dimensions that shape it."
        )
