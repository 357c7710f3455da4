"""Craig-Bampton reduction of a large joint to the relative displacements of its pairs, cached on disk."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.core.progress import ProgressCallback
from stickslip.structure.cache import Arrays, cached_arrays, input_digest
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Structure
from stickslip.structure.factor import Backend
from stickslip.structure.joined import NodePairs
from stickslip.structure.mesh import IntArray
from stickslip.structure.recovery import Recovery
from stickslip.structure.relative_model import RelativeModel
from stickslip.structure.superelement import Superelement

# chosen: a joint whose nodes have fewer unknowns than this keeps the displacements of both sides. From about 330 pairs
# of two nodes on, half of these unknowns save most of the time of the reduction and of the modes (docs/performance.md).
LARGE_JOINT = 2000


def relative_model(structure: Structure, pairs: NodePairs, other_nodes: IntArray) -> RelativeModel | None:
    """The model of a joint whose reduction to relative displacements saves time; None for any other joint.

    It is large, each of its pairs has an own node, and the reduction has fewer unknowns than that to all nodes. Raises
    InputError for pairs with nodes that are not free.
    """
    nodes = np.union1d(pairs.nodes, other_nodes)
    if 3 * nodes.size < LARGE_JOINT or len(pairs.first_nodes) + len(other_nodes) >= nodes.size:
        return None
    return RelativeModel.of(structure, pairs, other_nodes)


def relative_superelement(
    model: RelativeModel,
    pairs: NodePairs,
    other_nodes: IntArray,
    n_modes: int,
    backend: Backend = "superlu",
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Superelement:
    """Reduce a structure to other nodes, the relative displacements of its pairs, and ``n_modes`` modes.

    ``u = T [u_o; x; q]``: the displacements u_o of ``other_nodes``, three unknowns for each pair ``x = B u`` and the
    amplitudes q of the fixed-interface modes, for which the pairs are tied and the other nodes fixed. Static responses
    to forces on the pairs and on the other nodes are exact, as in :func:`craig_bampton`.

    Parameters
    ----------
    model, pairs, other_nodes:
        the :class:`RelativeModel` of these pairs and of (k,) other nodes.
    n_modes, backend, threads, progress:
        those of :func:`craig_bampton`.

    Returns
    -------
    Superelement
        with ``3 k + 3 n_pairs + n_modes`` unknowns, whose ``operator`` is valid for these pairs alone.

    Raises
    ------
    InputError
        for other nodes that are repeated or fixed, a mode count out of range, and a tied structure that can move
        freely.

    Source: the interface displacements of Craig and Bampton (1968) with the change of variables ``x = B u``.
    """
    nodes = np.concatenate([other_nodes, model.own_nodes])
    reduced = craig_bampton(model, nodes, n_modes, backend, threads, progress)
    return _with_joint(model, pairs, other_nodes, reduced.mass, reduced.stiffness, reduced.recovery)


def cached_relative_superelement(
    model: RelativeModel,
    pairs: NodePairs,
    other_nodes: IntArray,
    n_modes: int,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Superelement:
    """:func:`relative_superelement` with SuperLU, from the disk if it was computed before."""
    made: list[Superelement] = []

    def compute() -> Arrays:
        made.append(relative_superelement(model, pairs, other_nodes, n_modes, "superlu", threads, progress))
        new = made[0]
        return {"mass": new.mass, "stiffness": new.stiffness, "modes": new.recovery.modes}

    change = model.transformation
    parts = (change.indptr, change.indices, change.data, np.array([n_modes]))
    arrays = cached_arrays("relative", input_digest(model.base, other_nodes, model.own_nodes, *parts), compute)
    if made:
        return made[0]
    recovery = Recovery(model, np.concatenate([other_nodes, model.own_nodes]), arrays["modes"])
    return _with_joint(model, pairs, other_nodes, arrays["mass"], arrays["stiffness"], recovery)


def _with_joint(
    model: RelativeModel, pairs: NodePairs, other_nodes: IntArray, mass: Any, stiffness: Any, recovery: Any
) -> Superelement:
    """The superelement with the rows of its pairs."""
    rows = pairs.mesh_operator(model.base.mesh.n_nodes)
    return Superelement(mass, stiffness, boundary_nodes=other_nodes, recovery=recovery, joint_rows=rows)
