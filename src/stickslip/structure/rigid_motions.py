"""Motions without strain: how many each part of a mesh has, and whether it is hinged.

The strain energy of a mesh is zero exactly when every region of cells that hang together by whole sides moves as a
rigid body, regions agree at the nodes that they share, and held displacements are zero. Counting such motions is linear
algebra with six unknowns a region, so the zero eigenvalues of the stiffness are known before it is assembled.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph

from stickslip.structure.cell_kinds import CORNERS_OF_SIDE, all_sides
from stickslip.structure.finite_element_mesh import FiniteElementMesh
from stickslip.structure.mesh import IntArray
from stickslip.structure.model_facts import connected_parts
from stickslip.validation import FloatArray

_MOST_REGIONS = 200
_RANK_TOLERANCE = 1e-8


@dataclass(frozen=True)
class PartMotions:
    """One connected part of a mesh.

    Parameters
    ----------
    cells:
        (k,) its cells.
    n_regions:
        regions of cells that hang together by whole sides; more than one are joined at single nodes or edges.
    rigid:
        motions that the held displacements leave to it as one rigid body, 0 to 6.
    strainless:
        all motions without strain, rigid ones included: zero eigenvalues of its stiffness. None where the part has too
        many regions to count them.
    """

    cells: IntArray
    n_regions: int
    rigid: int
    strainless: int | None

    @property
    def is_hinged(self) -> bool:
        """Whether regions of it can move against each other without strain, which no contact of bodies explains."""
        return self.strainless is None or self.strainless > self.rigid


def part_motions(mesh: FiniteElementMesh, fixed_unknowns: IntArray) -> tuple[PartMotions, ...]:
    """Motions of each connected part with displacements held at positions among the 3 * n_nodes displacements."""
    cells = [block.cells for block in mesh.blocks]
    part, region = connected_parts(cells), _regions(mesh)
    answer = []
    for number in range(int(part.max()) + 1):
        mine = np.flatnonzero(part == number)
        regions = np.unique(region[mine])
        nodes = [mesh.nodes_of_cells(mine[region[mine] == each]) for each in regions]
        rigid = _free_motions(mesh.points, [np.unique(np.concatenate(nodes))], fixed_unknowns)
        if len(regions) == 1:
            strainless: int | None = rigid
        elif len(regions) > _MOST_REGIONS:
            strainless = None
        else:
            strainless = _free_motions(mesh.points, nodes, fixed_unknowns)
        answer.append(PartMotions(mine, len(regions), rigid, strainless))
    return tuple(answer)


def _regions(mesh: FiniteElementMesh) -> IntArray:
    """Number of the region (n_cells,) of each cell; cells that share a side belong to one region."""
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


def _free_motions(points: FloatArray, regions: list[IntArray], fixed_unknowns: IntArray) -> int:
    """Motions of rigid regions (arrays of nodes) that agree at shared nodes and keep the held displacements at zero."""
    everything = np.concatenate(regions)
    own = points[everything]
    centre, size = own.mean(axis=0), float(np.ptp(own, axis=0).max())
    nodes, count = np.unique(everything, return_counts=True)
    rows: list[FloatArray] = []

    def motion(node: int, region: int) -> FloatArray:
        """(3, 6 * n_regions): displacement of a node from the translations and rotations of its region."""
        x, y, z = (points[node] - centre) / size
        block = np.zeros((3, 6 * len(regions)))
        block[:, 6 * region : 6 * region + 6] = [[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]]
        return block

    members = [set(region.tolist()) for region in regions]
    for node in nodes[count > 1].tolist():
        sharing = [at for at, member in enumerate(members) if node in member]
        rows += [motion(node, sharing[0]) - motion(node, other) for other in sharing[1:]]
    held = fixed_unknowns[np.isin(fixed_unknowns // 3, nodes)]
    for unknown in held.tolist():
        region = next(at for at, member in enumerate(members) if unknown // 3 in member)
        rows.append(motion(unknown // 3, region)[unknown % 3][None])
    rank = np.linalg.matrix_rank(_compact(rows), tol=_RANK_TOLERANCE) if rows else 0
    return 6 * len(regions) - int(rank)


def _compact(rows: list[FloatArray]) -> FloatArray:
    """Gram matrix of the rows, divided by their number: the same rank in a small square matrix."""
    matrix = np.concatenate(rows)
    return np.asarray(matrix.T @ matrix / len(matrix))
