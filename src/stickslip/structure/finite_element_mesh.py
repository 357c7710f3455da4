"""Meshes of several kinds of solid cells in several bodies, as other programs write them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.structure.cell_kinds import CELL_KINDS, CORNERS_OF_SIDE, IntArray, outer_sides
from stickslip.structure.mesh import (
    Mesh,
    counted,
    named_nodes,
    names_in_short,
    node_numbers,
    require_upright,
    sides_in_nodes,
)


@dataclass(frozen=True)
class CellBlock:
    """Cells of one kind.

    Parameters
    ----------
    kind:
        name of the kind in VTK and meshio: tetra, tetra10, hexahedron, hexahedron20, wedge, wedge15.
    cells:
        (m, k) node numbers in VTK order.
    body:
        (m,) index of each cell's body in ``FiniteElementMesh.body_names``.
    """

    kind: str
    cells: IntArray
    body: IntArray


@dataclass(frozen=True)
class FiniteElementMesh:
    """Solid cells of several kinds and bodies, in metres.

    Cell numbers count from 0 through all blocks in their order.

    Parameters
    ----------
    points:
        (n, 3) coordinates x, y, z in m; every node belongs to a cell.
    blocks:
        the cells, one block for each kind or more.
    body_names:
        name of each body; every body has cells.
    node_sets:
        name -> (k,) node numbers. It also contains the nodes of each face set under its name, and those of each element
        set unless another set has the name.
    face_sets:
        name -> arrays (k, 3 | 4 | 6 | 8) of the nodes of cell sides: corners counter-clockwise seen from outside the
        cell, then the midside nodes between them.
    element_sets:
        name -> (k,) cell numbers.

    Raises
    ------
    InputError
        for coordinates that are not finite, an unknown kind, node or cell numbers that do not exist, a node or a body
        without a cell, a side that no cell has, and a cell that is inverted or flat.
    """

    points: FloatArray
    blocks: tuple[CellBlock, ...]
    body_names: tuple[str, ...] = ("body",)
    node_sets: Mapping[str, IntArray] = field(default_factory=dict)
    face_sets: Mapping[str, tuple[IntArray, ...]] = field(default_factory=dict)
    element_sets: Mapping[str, IntArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points = finite_array("points", self.points)
        if points.ndim != 2 or points.shape[1] != 3:
            raise InputError(f"points must have shape (n, 3), x, y, z of each node; found shape {points.shape}.")
        blocks = self._checked_blocks(points)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "blocks", blocks)
        object.__setattr__(self, "body_names", tuple(self.body_names))
        self._require_used()
        n_cells = self.n_cells
        elements = {name: np.unique(_cell_numbers(name, cells, n_cells)) for name, cells in self.element_sets.items()}
        faces = {name: self._checked_faces(name, sides) for name, sides in self.face_sets.items()}
        nodes = {
            name: np.atleast_1d(node_numbers(f"node set '{name}'", found, len(points)))
            for name, found in self.node_sets.items()
        }
        for name, sides in faces.items():
            nodes[name] = np.unique(np.concatenate([side.ravel() for side in sides]))
        for name, cells in elements.items():
            nodes.setdefault(name, self.nodes_of_cells(cells))
        object.__setattr__(self, "element_sets", elements)
        object.__setattr__(self, "face_sets", faces)
        object.__setattr__(self, "node_sets", nodes)

    def __repr__(self) -> str:
        kinds = ", ".join(dict.fromkeys(block.kind for block in self.blocks))
        return (
            f"FiniteElementMesh({self.n_nodes} nodes, {self.n_cells} cells ({kinds}) in "
            f"{counted(len(self.body_names), 'body', 'bodies')}; face sets: {names_in_short(self.face_sets)})"
        )

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.points)

    @property
    def n_cells(self) -> int:
        """Number of cells of all blocks."""
        return sum(len(block.cells) for block in self.blocks)

    @property
    def body(self) -> IntArray:
        """(n_cells,) index of each cell's body in ``body_names``."""
        return np.concatenate([block.body for block in self.blocks])

    def node_set(self, name: str) -> IntArray:
        """The nodes of a named set; raises InputError when it does not exist or is empty."""
        if name not in self.node_sets and name in self.body_names:
            known = ", ".join(sorted(self.node_sets)) or "none"
            raise InputError(
                f"'{name}' is the name of a body, no node or face set: its material can be given, but forces, "
                "responses, constraints and joints need a place on it. Give a set of its nodes or sides, or for a "
                f"force or a response also a point or a node; the mesh has: {known}."
            )
        return named_nodes(self.node_sets, name)

    def cell_arrays(self) -> list[tuple[str, IntArray]]:
        """Kind and cells (m, k) of each block."""
        return [(block.kind, block.cells) for block in self.blocks]

    def nodes_of_cells(self, cells: IntArray) -> IntArray:
        """Nodes (k,) of cells with these numbers, each once."""
        wanted = np.zeros(self.n_cells, dtype=bool)
        wanted[cells] = True
        ends = np.cumsum([len(block.cells) for block in self.blocks])[:-1]
        parts = zip(self.blocks, np.split(wanted, ends), strict=True)
        return np.unique(np.concatenate([block.cells[part].ravel() for block, part in parts]))

    def nodes_of_body(self, body: int) -> IntArray:
        """Nodes (k,) of the cells of a body."""
        return self.nodes_of_cells(np.flatnonzero(self.body == body))

    def sides(self, name: str) -> tuple[IntArray, ...]:
        """Sides (k, 3 | 4 | 6 | 8) of a face set, or the outer sides whose nodes are all in a node set.

        Raises InputError when there is no such set, or when a node set spans no side.
        """
        if name in self.face_sets:
            return self.face_sets[name]
        return sides_in_nodes(name, self.node_set(name), self.n_nodes, self.cell_arrays())

    def outer_sides(self, body: int | None = None) -> tuple[IntArray, ...]:
        """Sides (k, 3 | 4 | 6 | 8) of only one cell: the free surface, of all bodies or of one."""
        wanted = [
            sides if body is None else sides[self.body[owners] == body]
            for sides, owners in outer_sides(self.cell_arrays())
        ]
        return tuple(sides for sides in wanted if len(sides))

    def _checked_blocks(self, points: FloatArray) -> tuple[CellBlock, ...]:
        blocks: list[CellBlock] = []
        for block in self.blocks:
            if block.kind not in CELL_KINDS:
                raise InputError(f"'{block.kind}' is no kind of cell; there are: {', '.join(CELL_KINDS)}.")
            kind = CELL_KINDS[block.kind]
            cells = node_numbers(f"{block.kind} cells", block.cells, len(points))
            if cells.ndim != 2 or cells.shape[1] != kind.n_nodes:
                raise InputError(f"{block.kind} cells must have shape (m, {kind.n_nodes}); found {cells.shape}.")
            body = np.asarray(block.body, dtype=np.int64)
            if body.shape != (len(cells),):
                raise InputError(f"body must have shape ({len(cells)},), one number a cell; found {body.shape}.")
            require_upright(kind, points, cells, sum(len(before.cells) for before in blocks))
            if len(cells):
                blocks.append(CellBlock(block.kind, cells, body))
        if not blocks:
            raise InputError("the mesh has no solid cells; it must have at least one tetrahedron, wedge or hexahedron.")
        return tuple(blocks)

    def _require_used(self) -> None:
        """Raise InputError for a body without cells, a cell of no body, and a node without cells."""
        body = self.body
        if body.min() < 0 or body.max() >= len(self.body_names):
            raise InputError(
                f"a cell belongs to body {body.min() if body.min() < 0 else body.max()}, but body_names has "
                f"{len(self.body_names)} entries, which count from 0."
            )
        empty = np.setdiff1d(np.arange(len(self.body_names)), body)
        if empty.size:
            raise InputError(f"body '{self.body_names[empty[0]]}' has no cells; leave it out.")
        lone = np.setdiff1d(np.arange(self.n_nodes), np.concatenate([block.cells.ravel() for block in self.blocks]))
        if lone.size:
            raise InputError(f"node {lone[0]} belongs to no cell ({lone.size} nodes do not); leave such nodes out.")

    def _checked_faces(self, name: str, sides: tuple[IntArray, ...]) -> tuple[IntArray, ...]:
        checked = tuple(node_numbers(f"face set '{name}'", side, self.n_nodes) for side in sides if len(side))
        if not checked or any(side.ndim != 2 or side.shape[1] not in CORNERS_OF_SIDE for side in checked):
            raise InputError(f"face set '{name}' must hold arrays (k, 3), (k, 4), (k, 6) or (k, 8) of sides.")
        return checked


AnyMesh = Mesh | FiniteElementMesh


def _cell_numbers(name: str, value: IntArray, n_cells: int) -> IntArray:
    cells = np.atleast_1d(np.asarray(value, dtype=np.int64))
    bad = cells[(cells < 0) | (cells >= n_cells)]
    if bad.size:
        raise InputError(f"element set '{name}' names cell {bad[0]}, but the mesh has cells 0 to {n_cells - 1}.")
    return cells
