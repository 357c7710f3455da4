"""Hexahedral meshes: points, cells, bodies and named node sets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.structure.cell_kinds import CELL_KINDS, KIND_OF_SIZE, CellKind, all_sides, single_sides
from stickslip.structure.cell_kinds import IntArray as IntArray

EDGES = CELL_KINDS["hexahedron"].edges
# chosen: names of sets on one line.
SHOWN_NAMES = 6


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
        cells = node_numbers("cells", self.cells, len(points))
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
            name: np.atleast_1d(node_numbers(f"node set '{name}'", nodes, len(points)))
            for name, nodes in self.node_sets.items()
        }
        require_upright(KIND_OF_SIZE[cells.shape[1]], points, cells)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "cells", cells)
        object.__setattr__(self, "body", body)
        object.__setattr__(self, "node_sets", sets)

    def __repr__(self) -> str:
        bodies = counted(np.unique(self.body).size, "body", "bodies")
        return (
            f"Mesh({self.n_nodes} nodes, {self.n_cells} cells ({self.kind.name}) in {bodies}; "
            f"node sets: {names_in_short(self.node_sets)})"
        )

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.points)

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return len(self.cells)

    @property
    def kind(self) -> CellKind:
        """Kind of all its cells: bricks with 8 or 20 nodes."""
        return KIND_OF_SIZE[self.cells.shape[1]]

    def node_set(self, name: str) -> IntArray:
        """The nodes of a named set; raises InputError when it does not exist or is empty."""
        return named_nodes(self.node_sets, name)

    def cell_arrays(self) -> list[tuple[str, IntArray]]:
        """Kind and cells (m, k) of each block of cells of one kind; here one block."""
        return [(self.kind.name, self.cells)]

    def sides(self, name: str) -> tuple[IntArray, ...]:
        """:meth:`sides_within` as a tuple with one array, as meshes of several kinds of cells return it."""
        return (self.sides_within(name),)

    def sides_within(self, name: str) -> IntArray:
        """(k, 4) or (k, 8) nodes of the cell sides whose nodes are all in a node set, seen from outside the body.

        Corners run counter-clockwise; in 20-node cells the four midside nodes follow. Sides of two cells are inside the
        body and not included. Raises InputError if the set is missing, empty, or contains no side.
        """
        (sides,) = sides_in_nodes(name, self.node_set(name), self.n_nodes, self.cell_arrays())
        return sides

    def quadratic(self) -> Mesh:
        """The same bricks with a node in the middle of each edge (20-node serendipity cells).

        Corner nodes keep their numbers; a node set gains every edge node whose two ends it contains.
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


def names_in_short(names: Iterable[str]) -> str:
    """The first names, and the number of others."""
    known = sorted(names)
    more = len(known) - SHOWN_NAMES
    return ", ".join(known[:SHOWN_NAMES]) + (f" and {more} more" if more > 0 else "") or "none"


def counted(count: int, one: str, many: str) -> str:
    """A number with its word: 1 body, 2 bodies."""
    return f"{count} {one if count == 1 else many}"


def node_numbers(name: str, value: ArrayLike, n_nodes: int) -> IntArray:
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


def named_nodes(node_sets: Mapping[str, IntArray], name: str) -> IntArray:
    """The nodes of a named set; raises InputError when it does not exist or is empty."""
    known = ", ".join(sorted(node_sets)) or "none"
    if name not in node_sets:
        raise InputError(f"the mesh has no node set '{name}'; it has: {known}.")
    nodes = node_sets[name]
    if not nodes.size:
        raise InputError(f"node set '{name}' is empty; give it at least one node, or use another of: {known}.")
    return nodes


def sides_in_nodes(name: str, nodes: IntArray, n_nodes: int, cells: list[tuple[str, IntArray]]) -> tuple[IntArray, ...]:
    """Sides (k, 3 | 4 | 6 | 8) of cells, seen from outside, whose nodes are all in the set and that belong to only one
    cell.

    Raises InputError where there is none.
    """
    member = np.zeros(n_nodes, dtype=bool)
    member[nodes] = True
    inside = [side[member[side].all(axis=1)] for side, _ in all_sides(cells)]
    single = [side[keep] for side, keep in zip(inside, single_sides(inside), strict=True)]
    sides = tuple(side for side in single if len(side))
    if not sides:
        raise InputError(
            f"no side of a cell has all its nodes in node set '{name}' ({member.sum()} nodes); a face set must "
            "hold every node of the sides that make up the face, midside nodes included."
        )
    return sides


def require_upright(kind: CellKind, points: FloatArray, cells: IntArray, first_cell: int = 0) -> None:
    """Raise InputError unless the Jacobian at every corner of every cell (m, k) is positive.

    ``first_cell`` is the number of the first of them in messages.
    """
    volume = kind.corner_jacobians(points[cells])
    bad = np.flatnonzero(volume.min(axis=1) <= 1e-12 * np.abs(volume).max(axis=1))
    if bad.size:
        centre = 1e3 * points[cells[bad[0], : kind.n_corners]].mean(axis=0)
        raise InputError(
            f"cell {first_cell + bad[0]} (centre at {centre[0]:.3g}, {centre[1]:.3g}, {centre[2]:.3g} mm) is inverted "
            f"or flat: its corner Jacobian falls to {volume[bad[0]].min():.3g} m3 and must stay above 0; {bad.size} of "
            f"{len(cells)} cells are like this. Check the order of its nodes and the dimensions that shape it."
        )
