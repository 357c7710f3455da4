"""Meshes of solid cells: points, cells of one kind or several, bodies and named sets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, argument_error, finite_array
from stickslip.structure.cell_kinds import (
    CELL_KINDS,
    CORNERS_OF_SIDE,
    KIND_OF_SIZE,
    CellKind,
    all_sides,
    outer_sides,
    single_sides,
)
from stickslip.structure.cell_kinds import IntArray as IntArray

EDGES = CELL_KINDS["hexahedron"].edges
# chosen: names of sets on one line.
SHOWN_NAMES = 6


@dataclass(frozen=True)
class CellBlock:
    """Cells (m, k) of one kind, named as in VTK and meshio, in VTK node order; ``body`` (m,) is the number of each
    cell's body."""

    kind: str
    cells: IntArray
    body: IntArray


@dataclass(frozen=True)
class Mesh:
    """Solid cells in VTK node order, in metres.

    Parameters
    ----------
    points:
        (n, 3) coordinates x, y, z in m; every node belongs to a cell.
    cells:
        (m, k) nodes of each cell, corners first; k says which kind they are: 4 tetra, 10 tetra10, 8 hexahedron,
        20 hexahedron20, 6 wedge, 15 wedge15, as VTK numbers their nodes. The midside nodes of bricks are those of the
        edges 0-1, 1-2, 2-3, 3-0, 4-5, 5-6, 6-7, 7-4, 0-4, 1-5, 2-6, 3-7. A tuple of such arrays is a mesh of several
        kinds, whose cells are numbered from 0 through all arrays.
    body:
        (n_cells,) number of the body that each cell belongs to; by default one body.
    node_sets:
        name -> (k,) node numbers. The nodes of a face set are added under its name, and those of an element set unless
        the name is taken.
    body_names:
        name of each body, which then has cells; by default "body", or "body 0", "body 1", ... where there are several.
    face_sets:
        name -> arrays (k, 3 | 4 | 6 | 8) of the nodes of cell sides: corners counter-clockwise seen from outside the
        cell, then the midside nodes between them.
    element_sets:
        name -> (k,) cell numbers.

    Raises
    ------
    InputError
        for coordinates that are not finite, cells of an unknown kind, node or cell numbers that do not exist, a node
        without a cell, a named body without one, arrays that contain no sides, and a cell that is inverted or flat.
    """

    points: FloatArray
    cells: IntArray | tuple[IntArray, ...]
    body: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    node_sets: Mapping[str, IntArray] = field(default_factory=dict)
    body_names: tuple[str, ...] = ()
    face_sets: Mapping[str, tuple[IntArray, ...]] = field(default_factory=dict)
    element_sets: Mapping[str, IntArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points = finite_array("points", self.points)
        if points.ndim != 2 or points.shape[1] != 3:
            raise InputError(
                f"points must have shape (n, 3), x, y, z of each node, but the shape is {points.shape}.",
                arguments=["points"],
            )
        object.__setattr__(self, "points", points)
        groups = _checked_cells(points, self.cells if isinstance(self.cells, tuple) else (self.cells,))
        object.__setattr__(self, "cells", groups if len(groups) > 1 else groups[0])
        self._take_bodies()
        n_cells = self.n_cells
        elements = {name: np.unique(_cell_numbers(name, cells, n_cells)) for name, cells in self.element_sets.items()}
        faces = {name: self._checked_faces(name, sides) for name, sides in self.face_sets.items()}
        nodes = {
            name: np.atleast_1d(node_numbers(f"node set '{name}'", numbers, len(points)))
            for name, numbers in self.node_sets.items()
        }
        for name, sides in faces.items():
            nodes[name] = np.unique(np.concatenate([side.ravel() for side in sides]))
        for name, cells in elements.items():
            nodes.setdefault(name, self.nodes_of_cells(cells))
        object.__setattr__(self, "element_sets", elements)
        object.__setattr__(self, "face_sets", faces)
        object.__setattr__(self, "node_sets", nodes)

    def __repr__(self) -> str:
        kinds = ", ".join(dict.fromkeys(kind for kind, _ in self.cell_arrays()))
        bodies = counted(np.unique(self.body).size, "body", "bodies")
        faces = f"; face sets: {names_in_short(self.face_sets)}" if self.face_sets else ""
        return (
            f"Mesh({self.n_nodes} nodes, {self.n_cells} cells ({kinds}) in {bodies}; "
            f"node sets: {names_in_short(self.node_sets)}{faces})"
        )

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.points)

    @property
    def n_cells(self) -> int:
        """Number of cells of all kinds."""
        return sum(len(cells) for _, cells in self.cell_arrays())

    @property
    def blocks(self) -> tuple[CellBlock, ...]:
        """The cells with their kinds and bodies, one block for each array of cells."""
        arrays = self.cell_arrays()
        bodies = np.split(self.body, np.cumsum([len(cells) for _, cells in arrays])[:-1])
        return tuple(CellBlock(kind, cells, body) for (kind, cells), body in zip(arrays, bodies, strict=True))

    def cell_arrays(self) -> list[tuple[str, IntArray]]:
        """Kind and cells (m, k) of each block."""
        groups = self.cells if isinstance(self.cells, tuple) else (self.cells,)
        return [(KIND_OF_SIZE[cells.shape[1]].name, cells) for cells in groups]

    def node_set(self, name: str) -> IntArray:
        """The nodes of a named set; raises InputError when it does not exist or is empty."""
        if name not in self.node_sets and name in self.body_names:
            known = ", ".join(sorted(self.node_sets)) or "none"
            raise InputError(
                f"'{name}' is the name of a body, not of a node or face set. A body can have a material, but forces, "
                "responses, constraints and joints require a part of it. Give a set of its nodes or sides, or for a "
                f"force or a response also a point or a node; the mesh has: {known}."
            )
        return named_nodes(self.node_sets, name)

    def nodes_of_cells(self, cells: IntArray) -> IntArray:
        """Nodes (k,) of cells given by their numbers, each once."""
        wanted = np.zeros(self.n_cells, dtype=bool)
        wanted[cells] = True
        arrays = [array for _, array in self.cell_arrays()]
        parts = np.split(wanted, np.cumsum([len(array) for array in arrays])[:-1])
        return np.unique(np.concatenate([array[part].ravel() for array, part in zip(arrays, parts, strict=True)]))

    def nodes_of_body(self, body: int) -> IntArray:
        """Nodes (k,) of the cells of a body."""
        return self.nodes_of_cells(np.flatnonzero(self.body == body))

    def sides(self, name: str) -> tuple[IntArray, ...]:
        """Sides (k, 3 | 4 | 6 | 8) of a face set, or the outer sides all of whose nodes lie in a node set.

        Corners run counter-clockwise seen from outside the body; midside nodes follow. Sides of two cells are inside
        the body and not included. Raises InputError if the set is missing, or if a node set contains no side.
        """
        if name in self.face_sets:
            return self.face_sets[name]
        return sides_in_nodes(name, self.node_set(name), self.n_nodes, self.cell_arrays())

    def outer_sides(self, body: int | None = None) -> tuple[IntArray, ...]:
        """Sides (k, 3 | 4 | 6 | 8) that one cell alone has: the free surface, of all bodies or of one."""
        wanted = [
            sides if body is None else sides[self.body[owners] == body]
            for sides, owners in outer_sides(self.cell_arrays())
        ]
        return tuple(sides for sides in wanted if len(sides))

    def bricks(self) -> IntArray:
        """Cells (m, 8) or (m, 20) of a mesh of bricks. Raises InputError for a mesh with other cells."""
        if isinstance(self.cells, tuple) or self.cells.shape[1] not in (8, 20):
            kinds = ", ".join(dict.fromkeys(kind for kind, _ in self.cell_arrays()))
            raise InputError(f"the mesh must have bricks of one kind, with 8 or 20 nodes; it has: {kinds}.")
        return self.cells

    def quadratic(self) -> Mesh:
        """The same bricks with a node in the middle of each edge (20-node serendipity cells).

        Corner nodes keep their numbers; a node set gains every edge node whose two ends it contains. Raises InputError
        for cells that are no bricks, and for face sets, which would lack the new nodes.
        """
        cells = self.bricks()
        if cells.shape[1] == 20:
            return self
        if self.face_sets:
            raise InputError("a mesh with face sets cannot be made quadratic; give node sets instead.")
        cell_edges = np.sort(cells[:, EDGES], axis=2)
        edges, position = np.unique(cell_edges.reshape(-1, 2), axis=0, return_inverse=True)
        middle = self.n_nodes + position.reshape(len(cells), len(EDGES))
        sets = {}
        for name, nodes in self.node_sets.items():
            inside = np.isin(edges, nodes).all(axis=1)
            sets[name] = np.concatenate([nodes, self.n_nodes + np.flatnonzero(inside)])
        return replace(
            self,
            points=np.vstack([self.points, self.points[edges].mean(axis=1)]),
            cells=np.hstack([cells, middle]),
            node_sets=sets,
        )

    def _take_bodies(self) -> None:
        """Set ``body`` and ``body_names``.

        Raises InputError for a cell of no body, a named body without cells, and a node without cells.
        """
        arrays = [cells for _, cells in self.cell_arrays()]
        n_cells = sum(map(len, arrays))
        body = np.asarray(self.body, dtype=np.int64)
        body = body if body.size else np.zeros(n_cells, dtype=np.int64)
        if body.shape != (n_cells,):
            raise InputError(
                f"body must have shape ({n_cells},), one number for each cell, but its shape is {body.shape}.",
                arguments=["body"],
            )
        count = int(body.max()) + 1
        names = tuple(self.body_names) or (("body",) if count == 1 else tuple(f"body {at}" for at in range(count)))
        if body.min() < 0 or count > len(names):
            raise InputError(
                f"a cell belongs to body {body.min() if body.min() < 0 else body.max()}, but body_names has "
                f"{len(names)} entries, which count from 0."
            )
        empty = np.setdiff1d(np.arange(len(names)), body)
        if self.body_names and empty.size:
            raise InputError(f"body '{names[empty[0]]}' has no cells; remove it.", arguments=["body"])
        lone = np.setdiff1d(np.arange(self.n_nodes), np.concatenate([cells.ravel() for cells in arrays]))
        if lone.size:
            raise InputError(
                f"node {lone[0]} belongs to no cell ({lone.size} nodes do not); remove such nodes.",
                arguments=["cells"],
            )
        object.__setattr__(self, "body", body)
        object.__setattr__(self, "body_names", names)

    def _checked_faces(self, name: str, sides: tuple[IntArray, ...]) -> tuple[IntArray, ...]:
        checked = tuple(node_numbers(f"face set '{name}'", side, self.n_nodes) for side in sides if len(side))
        if not checked or any(side.ndim != 2 or side.shape[1] not in CORNERS_OF_SIDE for side in checked):
            raise InputError(f"face set '{name}' must contain arrays (k, 3), (k, 4), (k, 6) or (k, 8) of sides.")
        return checked


def _checked_cells(points: FloatArray, groups: tuple[IntArray, ...]) -> tuple[IntArray, ...]:
    """The arrays of cells that are not empty."""
    checked: list[IntArray] = []
    for group in groups:
        cells = node_numbers("cells", group, len(points))
        if cells.ndim != 2 or cells.shape[1] not in KIND_OF_SIZE:
            kinds = ", ".join(f"{size} {kind.name}" for size, kind in KIND_OF_SIZE.items())
            raise InputError(
                f"cells must have shape (m, k) with k nodes each: {kinds}, but the shape is {cells.shape}.",
                arguments=["cells"],
            )
        require_upright(KIND_OF_SIZE[cells.shape[1]], points, cells, sum(map(len, checked)))
        if len(cells):
            checked.append(cells)
    if not checked:
        raise InputError("the mesh has no solid cells; it must have at least one tetrahedron, wedge or hexahedron.")
    return tuple(checked)


def _cell_numbers(name: str, value: IntArray, n_cells: int) -> IntArray:
    cells = np.atleast_1d(np.asarray(value, dtype=np.int64))
    bad = cells[(cells < 0) | (cells >= n_cells)]
    if bad.size:
        raise InputError(f"element set '{name}' names cell {bad[0]}, but the mesh has cells 0 to {n_cells - 1}.")
    return cells


def names_in_short(names: Iterable[str]) -> str:
    """The first names, and the number of others."""
    ordered = sorted(names)
    more = len(ordered) - SHOWN_NAMES
    return ", ".join(ordered[:SHOWN_NAMES]) + (f" and {more} more" if more > 0 else "") or "none"


def counted(count: int, one: str, many: str) -> str:
    """A number with its word: 1 body, 2 bodies."""
    return f"{count} {one if count == 1 else many}"


def node_numbers(name: str, value: ArrayLike, n_nodes: int) -> IntArray:
    """Return ``value`` as integers after checking that each is the number of a node; raises InputError."""
    array = np.asarray(value)
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise argument_error(name, f"{name} must contain node numbers (integers), but its type is {array.dtype}.")
    array = array.astype(np.int64)
    bad = array[(array < 0) | (array >= n_nodes)]
    if bad.size:
        raise argument_error(
            name, f"{name} names node {bad[0]}, but the mesh has nodes 0 to {n_nodes - 1}; numbers count from 0."
        )
    return array


def named_nodes(node_sets: Mapping[str, IntArray], name: str) -> IntArray:
    """The nodes of a named set; raises InputError when it does not exist or is empty."""
    names = ", ".join(sorted(node_sets)) or "none"
    if name not in node_sets:
        raise InputError(f"the mesh has no node set '{name}'; it has: {names}.")
    nodes = node_sets[name]
    if not nodes.size:
        raise InputError(f"node set '{name}' is empty; give it at least one node, or use another of: {names}.")
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
            f"no side of a cell has all its nodes in node set '{name}' ({member.sum()} nodes); a face set must contain "
            "each node of the sides of the face, including midside nodes."
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
            f"or flat: its smallest corner Jacobian is {volume[bad[0]].min():.3g} m3, but it must be above 0 "
            f"({bad.size} of {len(cells)} cells are like this). Check the order of its nodes and the dimensions of the "
            "part."
        )
