"""Parts of a mesh that ties connect, and the number of their motions without strain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph

from stickslip.structure.constraints import Constraints
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.rigid_motions import PartMotions, part_motions, rigid_fields, zero_motions

_ROUND_OFF = 1e-9  # of the terms of a condition; elimination amplifies that of the coordinates


@dataclass(frozen=True)
class SupportedGroup:
    """Connected parts of a mesh that ties connect.

    Parameters
    ----------
    parts:
        the parts, each connected by its own elements.
    cells:
        (k,) cells of all of them.
    free:
        motions of the parts as rigid bodies that constraints and ties allow.
    """

    parts: tuple[PartMotions, ...]
    cells: IntArray
    free: int


def supported_groups(
    mesh: Mesh, fixed_unknowns: IntArray, constraints: Constraints | None = None, spring_constraints: Any = None
) -> tuple[SupportedGroup, ...]:
    """Groups of parts with constraints at indices among the 3 * n_nodes displacements, and with ties.

    ``spring_constraints``: csr (k, 3 * n_nodes) rows of further motions that are constrained, those of springs at
    reference nodes.
    """
    parts = part_motions(mesh, fixed_unknowns)
    if constraints is None or (spring_constraints is None and not constraints.dependent_unknowns.size):
        return tuple(SupportedGroup((part,), part.cells, part.rigid) for part in parts)
    owner = np.empty(mesh.n_nodes, dtype=np.int64)
    for number, part in enumerate(parts):
        owner[mesh.nodes_of_cells(part.cells)] = number
    zero, dependent = constraints.zero_unknowns, constraints.dependent_unknowns
    # rows u_d - sum T u_f of the dependent displacements, and u of those that are zero
    chosen = np.concatenate([dependent, zero])
    unit = scipy.sparse.csr_matrix(
        (np.ones(len(chosen)), (np.arange(len(chosen)), chosen)), shape=(len(chosen), 3 * mesh.n_nodes)
    )
    rows = (unit - constraints.rows(chosen)).tocsr()
    if spring_constraints is not None:
        rows = scipy.sparse.vstack([rows, spring_constraints]).tocsr()
    group = _groups(rows, owner, len(parts))
    centre = np.array([mesh.points[owner == number].mean(axis=0) for number in range(len(parts))])
    size = np.array([float(np.ptp(mesh.points[owner == number], axis=0).max()) for number in range(len(parts))])
    fields = rigid_fields(mesh.points, owner, centre, size)
    conditions = (rows @ fields).tocsr()
    # What rigid motions satisfy is round-off, which would count as a condition where a group has no other one.
    conditions = conditions.multiply(abs(conditions) > _ROUND_OFF * (abs(rows) @ abs(fields))).tocsr()
    conditions.eliminate_zeros()
    answer = []
    for number in range(int(group.max()) + 1):
        members = np.flatnonzero(group == number)
        columns = (6 * members[:, None] + np.arange(6)).ravel()
        answer.append(
            SupportedGroup(
                tuple(parts[each] for each in members),
                np.concatenate([parts[each].cells for each in members]),
                zero_motions(conditions[:, columns].tocsr(), len(members)),
            )
        )
    return tuple(answer)


def _groups(rows: scipy.sparse.csr_matrix, owner: IntArray, n_parts: int) -> IntArray:
    """(n_parts,) number of the group of each part: parts with unknowns in one equation belong to one group."""
    entries = rows.tocoo()
    first = np.full(rows.shape[0], -1, dtype=np.int64)
    part = owner[entries.col // 3]
    first[entries.row] = part  # any of its parts
    graph = scipy.sparse.coo_matrix((np.ones(len(part)), (part, first[entries.row])), shape=(n_parts, n_parts))
    return np.asarray(scipy.sparse.csgraph.connected_components(graph, directed=False)[1], dtype=np.int64)
