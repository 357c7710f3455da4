"""Reduction that keeps the relative displacements of those contact pairs alone that can move.

A pair that sticks all the time is a spring. With the springs k_r of such *resting* pairs in the stiffness, ``K_r = K +
B_r^T k_r B_r``, the other pairs are the boundary of a Craig-Bampton reduction, whose size is that of the moving part of
a joint: the static responses to forces on moving pairs, and the modes in which these are tied, are those of a structure
whose resting pairs stick. The lowest modes of the structure without contact join these modes, so that the limit without
contact has its resonances too.

The basis T of the reduction gives the relative displacements of all pairs, ``B T``. The matrices are ``T^T M T`` and
``T^T K T = T^T K_r T - (B_r T)^T k_r (B_r T)``: no spring of the contact is in them, as in any superelement.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Structure
from stickslip.structure.front_reduction import lowest_mesh_modes
from stickslip.structure.joined import NodePairs, stiffness_with_springs
from stickslip.structure.mesh import IntArray
from stickslip.structure.recovery import Recovery
from stickslip.structure.relative_model import RelativeModel
from stickslip.structure.relative_reduction import relative_superelement
from stickslip.structure.superelement import Superelement, require_moving

BLOCK = 64  # chosen: columns of the basis in memory at a time


def partial_superelement(
    structure: Structure,
    pairs: NodePairs,
    springs: FloatArray,
    moving: NDArray[np.bool_],
    other_nodes: IntArray,
    n_modes: int = 30,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Superelement:
    """Reduce a structure to other nodes, its ``moving`` pairs and some modes; the other pairs stick.

    Parameters
    ----------
    structure, pairs:
        the structure, and all of its contact pairs.
    springs:
        (3 * n_pairs,) N/m, t1, t2, n of each pair at rest, stuck; 0 for a pair that is open there.
    moving:
        (n_pairs,) the pairs that can slip, open or close.
    other_nodes:
        (k,) nodes that keep their displacements, such as those of forces and outputs.
    n_modes:
        number of modes with tied moving pairs, and of modes without contact.
    threads, progress:
        those of :func:`craig_bampton`.

    Returns
    -------
    Superelement
        without contact, with up to ``2 n_modes`` unknowns beside those of nodes and moving pairs. Its ``operator`` is
        that of all ``pairs``; its ``recovery`` is that of the structure with the springs of resting pairs.

    Raises
    ------
    InputError
        for springs or ``moving`` of another shape, no boundary, and the reasons of :func:`craig_bampton`.

    Source: R. R. Craig, M. C. C. Bampton, AIAA J. 6 (1968) 1313-1319, about the structure whose resting pairs stick.
    """
    n_pairs = len(pairs.first_nodes)
    chosen = require_moving(moving, n_pairs)
    stiffness = np.asarray(springs, dtype=float)
    if stiffness.shape != (3 * n_pairs,):
        raise InputError(
            f"springs must have shape ({3 * n_pairs},), t1, t2, n of each pair, but the shape is {stiffness.shape}.",
            arguments=["springs"],
        )
    rows = pairs.mesh_operator(structure.mesh.n_nodes).tocsr()
    resting = np.repeat(~chosen, 3)
    with_springs = stiffness_with_springs(structure, rows[resting], stiffness[resting])
    on_springs = replace(structure, stiffness=with_springs)
    base = _reduced(on_springs, pairs.subset(chosen), other_nodes, n_modes, threads, progress)
    recovery = base.recovery
    if n_modes:
        recovery = recovery.with_shapes(_free_shapes(structure, n_modes, recovery, threads))
    mass, stiff = recovery.extended(base.mass, base.stiffness)
    relative = _relative(rows, recovery)
    if chosen.any():  # exactly, without the round-off of the recovery
        own = base.operator(pairs.subset(chosen))
        relative[np.repeat(chosen, 3)] = np.pad(own, ((0, 0), (0, len(mass) - own.shape[1])))
    stiff -= relative[resting].T @ (stiffness[resting][:, None] * relative[resting])
    return Superelement(
        mass,
        0.5 * (stiff + stiff.T),
        boundary_nodes=base.boundary_nodes,
        recovery=recovery,
        joint_rows=rows,
        joint_operator=relative,
    )


def _reduced(
    structure: Structure,
    pairs: NodePairs,
    other_nodes: IntArray,
    n_modes: int,
    threads: int,
    progress: ProgressCallback | None,
) -> Superelement:
    """The reduction to other nodes and pairs, to their relative displacements where each has an own node."""
    if len(pairs.first_nodes):
        relative = RelativeModel.of(structure, pairs, other_nodes)
        if relative is not None:
            return relative_superelement(relative, pairs, other_nodes, n_modes, "superlu", threads, progress)
    nodes = np.union1d(pairs.nodes, other_nodes).astype(np.int64)
    # by fronts where the mesh is large: their factor solves for the many columns of the basis
    return craig_bampton(structure, nodes, n_modes, "superlu", threads, progress)


def _free_shapes(structure: Structure, count: int, recovery: Recovery, threads: int) -> FloatArray:
    """(n_free, count) the lowest modes without contact, in the unknowns of the model of a recovery."""
    with threadpool_limits(limits=1):  # as :func:`craig_bampton` has it
        _, modes = lowest_mesh_modes(structure, structure.stiffness, count, threads)
    model = recovery.model
    return model.unknowns_from(modes) if isinstance(model, RelativeModel) else modes


def _relative(rows: Any, recovery: Recovery) -> FloatArray:
    """``B T`` (m, n) of rows B (m, 3 * n_nodes)."""
    size = recovery.shape[1]
    answer = np.empty((rows.shape[0], size))
    for start in range(0, size, BLOCK):
        columns = np.eye(size, min(BLOCK, size - start), -start)
        answer[:, start : start + BLOCK] = rows @ (recovery @ columns)
    return answer
