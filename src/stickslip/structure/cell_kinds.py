"""The solid cells that meshes are made of: reference nodes, sides and orientation, in VTK node order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class CellKind:
    """One kind of cell.

    Tetrahedra live on the reference cell ``x, y, z >= 0, x + y + z <= 1``, wedges on ``x, y >= 0, x + y <= 1,
    -1 <= z <= 1``, bricks on ``[-1, 1]^3``.

    Parameters
    ----------
    name:
        name in VTK and meshio.
    nodes:
        (k, 3) reference coordinates, corners first, then the middles of ``edges`` in their order.
    n_corners:
        number of corners; equal to k without midside nodes.
    edges:
        (e, 2) corners at the ends of each edge.
    sides:
        nodes of each side, corners counter-clockwise seen from outside, then the midside nodes between them; the order
        of the sides is that of the face numbers of Abaqus and CalculiX.
    corner_neighbours:
        (n_corners, 3) the ends of the three edges at each corner, in the order that makes them right-handed.
    """

    name: str
    nodes: FloatArray
    n_corners: int
    edges: IntArray
    sides: tuple[IntArray, ...]
    corner_neighbours: IntArray

    @property
    def n_nodes(self) -> int:
        """Number of nodes of one cell."""
        return len(self.nodes)

    @property
    def is_quadratic(self) -> bool:
        """Whether its edges have midside nodes."""
        return self.n_nodes > self.n_corners

    def corner_jacobians(self, cells: FloatArray) -> FloatArray:
        """(m, n_corners) m3: the volume spanned by the edges at each corner of cells (m, k, 3); below 0 if inverted."""
        corner = cells[:, : self.n_corners]
        edge = corner[:, self.corner_neighbours] - corner[:, :, None, :]
        return np.asarray(np.linalg.det(edge))


def _kinds(
    linear: str, quadratic: str, corners: list[list[int]], edges: list[list[int]], sides: list[list[int]]
) -> tuple[CellKind, CellKind]:
    """The linear and the quadratic kind of one shape, from its corners, edges and the corners of its sides."""
    corner = np.array(corners, dtype=float)
    edge = np.array(edges, dtype=np.int64)
    middle = {frozenset(ends): len(corners) + position for position, ends in enumerate(edges)}
    around = [
        np.array(side + [middle[frozenset(pair)] for pair in zip(side, side[1:] + side[:1], strict=True)])
        for side in sides
    ]
    neighbours = np.array([_right_handed(corner, edges, at) for at in range(len(corners))])
    nodes = np.vstack([corner, corner[edge].mean(axis=1)])
    flat = tuple(np.array(side) for side in sides)
    return (
        CellKind(linear, corner, len(corner), edge, flat, neighbours),
        CellKind(quadratic, nodes, len(corner), edge, tuple(around), neighbours),
    )


def _right_handed(corner: FloatArray, edges: list[list[int]], at: int) -> list[int]:
    ends = [first + second - at for first, second in edges if at in (first, second)]
    if np.linalg.det(corner[ends] - corner[at]) < 0.0:
        ends[1], ends[2] = ends[2], ends[1]
    return ends


_TETRAHEDRA = _kinds(
    "tetra",
    "tetra10",
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
    [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
)
_WEDGES = _kinds(
    "wedge",
    "wedge15",
    [[0, 0, -1], [1, 0, -1], [0, 1, -1], [0, 0, 1], [1, 0, 1], [0, 1, 1]],
    [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
    [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]],
)
_HEXAHEDRA = _kinds(
    "hexahedron",
    "hexahedron20",
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]],
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
)

CELL_KINDS = {kind.name: kind for kind in (*_TETRAHEDRA, *_WEDGES, *_HEXAHEDRA)}
# No two kinds have the same number of nodes.
KIND_OF_SIZE = {kind.n_nodes: kind for kind in CELL_KINDS.values()}
CORNERS_OF_SIDE = {3: 3, 4: 4, 6: 3, 8: 4}  # nodes of a side -> corners of it


def all_sides(cells: Sequence[tuple[str, IntArray]]) -> tuple[tuple[IntArray, IntArray], ...]:
    """Every side of every cell of blocks (kind, (m, k)): sides (s, width) and numbers (s,) of their cells.

    One entry for each number of nodes of a side; cell by cell, cells numbered through the blocks. Inner sides come
    once from each of their two cells.
    """
    by_size: dict[int, tuple[list[IntArray], list[IntArray]]] = {}
    first = 0
    for name, block in cells:
        for width in sorted({len(side) for side in CELL_KINDS[name].sides}):
            local = np.array([side for side in CELL_KINDS[name].sides if len(side) == width])
            sides, owners = by_size.setdefault(width, ([], []))
            sides.append(block[:, local].reshape(-1, width))
            owners.append(np.repeat(np.arange(first, first + len(block)), len(local)))
        first += len(block)
    return tuple((np.concatenate(sides), np.concatenate(owners)) for _, (sides, owners) in sorted(by_size.items()))


def single_sides(groups: Sequence[IntArray]) -> tuple[NDArray[np.bool_], ...]:
    """For each array of sides (s, width): which of them (s,) have corners that no other side of any array has."""
    answer = [np.zeros(len(group), dtype=bool) for group in groups]
    for n_corners in (3, 4):
        members = [at for at, group in enumerate(groups) if CORNERS_OF_SIDE[group.shape[1]] == n_corners]
        if not members:
            continue
        corners = np.sort(np.concatenate([groups[at][:, :n_corners] for at in members]), axis=1)
        _, position, count = np.unique(corners, axis=0, return_inverse=True, return_counts=True)
        single = np.split(count[position.ravel()] == 1, np.cumsum([len(groups[at]) for at in members])[:-1])
        for at, flags in zip(members, single, strict=True):
            answer[at] = flags
    return tuple(answer)


def outer_sides(cells: Sequence[tuple[str, IntArray]]) -> tuple[tuple[IntArray, IntArray], ...]:
    """Sides (s, width) of only one cell, and numbers (s,) of their cells; entries as in :func:`all_sides`."""
    tables = all_sides(cells)
    single = single_sides([sides for sides, _ in tables])
    return tuple((sides[keep], owners[keep]) for (sides, owners), keep in zip(tables, single, strict=True))
