"""Unsupported parts of a model: motions without strain energy, counted from the stiffness matrix alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse
import scipy.sparse.csgraph
from numpy.typing import NDArray

from stickslip.core.errors import InputError, SingularMatrixError
from stickslip.core.validation import FloatArray
from stickslip.structure.factor import factorize
from stickslip.structure.lanczos import eigenpairs_near
from stickslip.structure.mesh import IntArray
from stickslip.structure.superelement import Superelement

# Eigenvalues of a stiffness scaled to a largest diagonal entry of one: motions without strain are at 1e-16 to 2e-12,
# the softest bending of the blades of the two-blade case at 4e-3.
ZERO_ENERGY = 1e-9
RIGID_MOTIONS = 6
# A body moves without strain only as a rigid one if its strainless motions miss the six rigid ones by less than this.
_RIGID_RESIDUAL = 1e-3
_DENSE_SIZE = 600
_SHIFT = 1e-6


def parts_of(matrix: Any) -> IntArray:
    """(n,) number of the connected part of each unknown; unknowns with a common entry belong to one part."""
    graph = abs(scipy.sparse.csr_matrix(matrix))  # entries may be complex
    return np.asarray(scipy.sparse.csgraph.connected_components(graph, directed=False)[1], dtype=np.int64)


def strainless_motions(stiffness: Any, typical: FloatArray | float | None = None) -> FloatArray:
    """(n, k) motions v of one connected part with ``K v = 0``, at most 8 of them for a sparse matrix.

    ``typical`` (n,) or a number: stiffness to scale the unknowns with, so that different units compare; by default the
    diagonal, which must not be zero.
    """
    scale = 1.0 / np.sqrt(stiffness.diagonal() if typical is None else np.full(stiffness.shape[0], typical))
    size = stiffness.shape[0]
    if size <= _DENSE_SIZE or not scipy.sparse.issparse(stiffness):
        dense = stiffness.toarray() if scipy.sparse.issparse(stiffness) else stiffness
        value, vector = scipy.linalg.eigh(scale[:, None] * dense * scale)
    else:
        scaled = scipy.sparse.diags(scale) @ stiffness @ scipy.sparse.diags(scale)
        factor = factorize(scaled + _SHIFT * scipy.sparse.identity(size))
        value, vector = eigenpairs_near(scaled, RIGID_MOTIONS + 2, -_SHIFT, factor)
    return np.asarray(scale[:, None] * vector[:, value < ZERO_ENERGY])


def unsupported_unknowns(stiffness: Any) -> IntArray:
    """(k,) unknowns of the connected parts of a sparse stiffness (n, n) that move without strain."""
    part = parts_of(stiffness)
    floating = []
    for number in range(int(part.max()) + 1):
        mine = np.flatnonzero(part == number)
        try:
            factorize(stiffness[mine][:, mine])
        except SingularMatrixError:
            floating.append(mine)
    return np.concatenate([np.empty(0, dtype=np.int64), *floating])


def floating_message(stiffness: Any, node: IntArray) -> str:
    """A message on the parts that make a stiffness (n, n) with constrained boundary nodes singular; ``node`` (n,) names
    its unknowns."""
    part, floating = parts_of(stiffness), unsupported_unknowns(stiffness)
    if not floating.size:
        return (
            f"the stiffness of the {stiffness.shape[0]} unknowns between the boundary nodes is singular or nearly so, "
            "although each of its connected parts is constrained; its entries differ too much in size."
        )
    numbers = list(dict.fromkeys(part[floating].tolist()))
    first = floating[part[floating] == numbers[0]]
    return (
        f"the stiffness is singular with all boundary nodes fixed: {len(numbers)} of {part.max() + 1} connected parts "
        f"are unsupported. The first has {named_nodes(node[first])} and "
        f"{strainless_motions(stiffness[first][:, first]).shape[1]} motions without strain. Choose enough of its nodes "
        "as boundary nodes (three that are not in one line), or fix it."
    )


def named_nodes(node: IntArray) -> str:
    """The name of a group of nodes in messages."""
    unique = np.unique(node)
    shown = ", ".join(str(label) for label in unique[:3])
    return f"{unique.size} nodes ({shown}{', ...' if unique.size > 3 else ''})"


def require_rigid_bodies(
    stiffness: FloatArray,
    part: IntArray,
    node: IntArray,
    contact: NDArray[np.bool_],
    position: FloatArray | None = None,
) -> None:
    """Raise InputError where a stiffness is singular and rigid bodies with contact do not explain it.

    Parameters
    ----------
    stiffness:
        (n, n) dense.
    part, node:
        (n,) part and node of each unknown; below 0 for unknowns that are not displacements of a node.
    contact:
        (n,) whether a contact may support an unknown. A part without any must not move without strain.
    position:
        optional, (n / 3, 3) m of nodes whose unknowns x, y, z follow each other. The strainless motions of a part with
        contact must then be rigid ones; otherwise there may be six at most.
    """
    # A node of a body with few supports may move freely by itself, so all displacements have the same scale.
    typical = np.diagonal(stiffness).copy()
    typical[node >= 0] = typical[node >= 0].max(initial=0.0)
    for number in np.unique(part):
        mine = np.flatnonzero(part == number)
        motions = strainless_motions(stiffness[np.ix_(mine, mine)], typical[mine])
        count = motions.shape[1]
        if not count:
            continue
        what = f"the connected part with {named_nodes(node[mine])} can move in {count} ways without strain"
        if not contact[mine].any():
            raise InputError(
                f"the stiffness is singular: {what}, and no contact supports it. Fix it, connect it, or include its "
                "nodes in a contact face."
            )
        if count > RIGID_MOTIONS:
            raise InputError(
                f"the stiffness is singular: {what}, but a body in one piece has {RIGID_MOTIONS}. It is a mechanism, "
                "or entries that connect its nodes are missing."
            )
        if position is not None and _misfit(motions, position, mine) > _RIGID_RESIDUAL:
            raise InputError(
                f"the stiffness is singular: {what}, and not as a rigid body. It is a mechanism, such as a hinge or "
                "bricks that share single nodes; or the positions of its nodes are those of another model."
            )


def _misfit(motions: FloatArray, position: FloatArray, unknowns: IntArray) -> float:
    """Largest part of unit motions (k, m) at ``unknowns`` that no rigid-body motion of the nodes explains."""
    centred = position - position.mean(axis=0)
    turned = np.cross(np.eye(3)[None], (centred / max(float(np.abs(centred).max()), 1e-300))[:, None])
    rigid = np.hstack([np.tile(np.eye(3), (len(position), 1)), turned.transpose(0, 2, 1).reshape(-1, 3)])[unknowns]
    left, value, _ = np.linalg.svd(rigid, full_matrices=False)
    left = left[:, value > 1e-10 * value[0]]
    unit = motions / np.linalg.norm(motions, axis=0)
    return float(np.linalg.norm(unit - left @ (left.T @ unit), axis=0).max())


def require_contact_bodies(superelement: Superelement, contact_nodes: IntArray) -> None:
    """Reject a superelement whose singular stiffness the rigid bodies of ``contact_nodes`` do not explain.

    Raises InputError, which names the part, for a part that can move without strain and has no contact node, and for a
    mechanism: more than six such motions of one part, or motions that are not those of a rigid body.
    """
    boundary = superelement.boundary_nodes
    node = np.full(superelement.size, -1, dtype=np.int64)
    node[: 3 * len(boundary)] = np.repeat(boundary, 3)
    whole = 3 * len(boundary) == superelement.size
    require_rigid_bodies(
        superelement.stiffness,
        parts_of(superelement.stiffness),
        node,
        np.isin(node, contact_nodes),
        superelement.positions if whole else None,
    )
