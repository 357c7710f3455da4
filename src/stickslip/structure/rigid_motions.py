"""Motions without strain: their number for each part of a mesh, and whether it is hinged.

The strain energy of a mesh is zero exactly when every region of cells connected by complete sides moves as a rigid
body, regions agree at common nodes, and constrained displacements are zero. Counting such motions is linear algebra
with six unknowns a region, and gives the number of zero eigenvalues of the stiffness before it is assembled.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph

from stickslip.core.validation import FloatArray
from stickslip.structure.cell_kinds import CORNERS_OF_SIDE, all_sides
from stickslip.structure.factor import negative_pivots
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.model_facts import connected_parts

_MOST_REGIONS = 200  # up to which motions are counted with a dense matrix
# Zero eigenvalues of the Gram matrix of the conditions; long chains of regions have nonzero ones of 1e-10.
_RANK_TOLERANCE = 1e-12
_FLAT = 1e-8  # fraction of the length of a row of points below which they are on one line


@dataclass(frozen=True)
class PartMotions:
    """One connected part of a mesh.

    Parameters
    ----------
    cells:
        (k,) its cells.
    n_regions:
        regions of cells connected by complete sides; several are joined at single nodes or edges.
    rigid:
        motions as one rigid body that the constraints allow, 0 to 6.
    strainless:
        all motions without strain, including rigid ones: zero eigenvalues of its stiffness.
    """

    cells: IntArray
    n_regions: int
    rigid: int
    strainless: int

    @property
    def is_hinged(self) -> bool:
        """Whether regions of it can move against each other without strain, which no contact of bodies explains."""
        return self.strainless > self.rigid


def part_motions(mesh: Mesh, fixed_unknowns: IntArray) -> tuple[PartMotions, ...]:
    """Motions of each connected part with constraints at indices among the 3 * n_nodes displacements."""
    cells = [block.cells for block in mesh.blocks]
    part, region = connected_parts(cells), _regions(mesh)
    answer = []
    for number in range(int(part.max()) + 1):
        mine = np.flatnonzero(part == number)
        regions = np.unique(region[mine])
        nodes = [mesh.nodes_of_cells(mine[region[mine] == each]) for each in regions]
        rigid = _free_motions(mesh.points, [np.unique(np.concatenate(nodes))], fixed_unknowns)
        stiff = _joined_regions(mesh.points, nodes)
        strainless = rigid if len(stiff) == 1 else _free_motions(mesh.points, stiff, fixed_unknowns)
        answer.append(PartMotions(mine, len(regions), rigid, strainless))
    return tuple(answer)


def _regions(mesh: Mesh) -> IntArray:
    """Number of the region (n_cells,) of each cell; cells with a common side belong to one region."""
    rows, columns = [], []
    for n_corners in (3, 4):
        groups = [entry for entry in all_sides(mesh.cell_arrays()) if CORNERS_OF_SIDE[entry[0].shape[1]] == n_corners]
        if not groups:
            continue
        corners = np.sort(np.concatenate([sides[:, :n_corners] for sides, _ in groups]), axis=1)
        owner = np.concatenate([cell for _, cell in groups])
        _, first, position = np.unique(corners, axis=0, return_index=True, return_inverse=True)
        rows.append(owner)
        columns.append(owner[first[position.ravel()]])
    row, column = np.concatenate(rows), np.concatenate(columns)
    graph = scipy.sparse.coo_matrix((np.ones(len(row), dtype=np.int8), (row, column)), shape=(mesh.n_cells,) * 2)
    return np.asarray(scipy.sparse.csgraph.connected_components(graph, directed=False)[1], dtype=np.int64)


def _joined_regions(points: FloatArray, regions: list[IntArray]) -> list[IntArray]:
    """Regions (arrays of nodes) after joining all that have three or more common nodes not on one line."""
    while len(regions) > 1:
        node = np.concatenate(regions)
        owner = np.repeat(np.arange(len(regions)), [len(region) for region in regions])
        has = scipy.sparse.csr_matrix((np.ones(len(node)), (owner, node)), shape=(len(regions), len(points)))
        shared = scipy.sparse.triu(has @ has.T, k=1).tocoo()
        pairs = np.column_stack([shared.row, shared.col])[shared.data > 2]
        stiff = [pair for pair in pairs.tolist() if _spans_a_plane(points, regions[pair[0]], regions[pair[1]])]
        if not stiff:
            break
        row, column = np.array(stiff).T
        graph = scipy.sparse.coo_matrix((np.ones(len(row)), (row, column)), shape=(len(regions),) * 2)
        count, group = scipy.sparse.csgraph.connected_components(graph, directed=False)
        order, sizes = np.argsort(group[owner], kind="stable"), np.bincount(group[owner], minlength=count)
        regions = [np.unique(part) for part in np.split(node[order], np.cumsum(sizes)[:-1])]
    return regions


def _spans_a_plane(points: FloatArray, first: IntArray, second: IntArray) -> bool:
    """Whether the common nodes of two regions are not on one line, so that the regions cannot turn about it."""
    places = points[np.intersect1d(first, second)]
    return int(np.linalg.matrix_rank(places - places[0], tol=_FLAT * float(np.ptp(places, axis=0).max()))) > 1


def _free_motions(points: FloatArray, regions: list[IntArray], fixed_unknowns: IntArray) -> int:
    """Motions of rigid regions (arrays of nodes) that agree at common nodes and satisfy the constraints."""
    node = np.concatenate(regions)
    owner = np.repeat(np.arange(len(regions)), [len(region) for region in regions])
    order = np.argsort(node, kind="stable")
    node, owner = node[order], owner[order]
    # about the centre of each region and relative to its size, so that small regions far from the origin count like
    # others
    centre = np.array([points[region].mean(axis=0) for region in regions])
    size = np.array([float(np.ptp(points[region], axis=0).max()) for region in regions])
    again = np.flatnonzero(node[1:] == node[:-1])
    # each region agrees with the one before it that has the node
    agree = rigid_fields(points[node[again]], owner[again], centre, size)
    agree = agree - rigid_fields(points[node[again]], owner[again + 1], centre, size)
    constrained = fixed_unknowns[np.isin(fixed_unknowns // 3, node)]
    owner_of_constrained = owner[np.searchsorted(node, constrained // 3)]
    constrained_motions = rigid_fields(points[constrained // 3], owner_of_constrained, centre, size)[
        3 * np.arange(constrained.size) + constrained % 3
    ]
    return zero_motions(scipy.sparse.vstack([agree, constrained_motions]).tocsr(), len(regions))


def zero_motions(conditions: Any, n_regions: int) -> int:
    """Number of motions of rigid regions that satisfy conditions (m, 6 * n_regions), csr rows on their motions."""
    if not conditions.nnz:
        return 6 * n_regions
    gram = (conditions.T @ conditions).tocsr()
    gram /= gram.diagonal().max()
    if n_regions > _MOST_REGIONS:
        return _zero_eigenvalues(gram)
    return 6 * n_regions - int(np.linalg.matrix_rank(gram.toarray(), tol=_RANK_TOLERANCE))


def _zero_eigenvalues(gram: Any) -> int:
    """Eigenvalues of a large sparse Gram matrix below the tolerance: negative pivots of the shifted one (Sylvester)."""
    return negative_pivots(gram - _RANK_TOLERANCE * scipy.sparse.identity(gram.shape[0]))


def rigid_fields(places: FloatArray, region: IntArray, centre: FloatArray, size: FloatArray) -> Any:
    """(3 k, 6 n_regions) sparse: displacements of k places from translations and rotations of the region of each."""
    x, y, z = ((places - centre[region]) / size[region, None]).T
    zero, one = np.zeros(len(places)), np.ones(len(places))
    blocks = np.array([[one, zero, zero, zero, z, -y], [zero, one, zero, -z, zero, x], [zero, zero, one, y, -x, zero]])
    row = 3 * np.arange(len(places))[None, None] + np.arange(3)[:, None, None] + np.zeros((1, 6, 1), dtype=np.int64)
    column = 6 * region[None, None] + np.arange(6)[None, :, None] + np.zeros((3, 1, 1), dtype=np.int64)
    shape = (3 * len(places), 6 * len(centre))
    return scipy.sparse.coo_matrix((blocks.ravel(), (row.ravel(), column.ravel())), shape=shape).tocsr()
