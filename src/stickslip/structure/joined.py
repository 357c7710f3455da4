"""Structures with closed contact pairs, tied (nodes merged) or stuck (springs), for frequencies."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.mesh import IntArray
from stickslip.structure.superelement import Superelement, moves_freely


class NodePairs(Protocol):
    """A joint for this module: nodes and weights of its pairs, and its operators to relative displacements t1, t2,
    n."""

    @property
    def nodes(self) -> IntArray: ...

    @property
    def first_nodes(self) -> IntArray: ...

    @property
    def first_weights(self) -> FloatArray: ...

    @property
    def second_nodes(self) -> IntArray: ...

    @property
    def second_weights(self) -> FloatArray: ...

    @property
    def first_node(self) -> IntArray: ...

    @property
    def second_node(self) -> IntArray: ...

    @property
    def is_matching(self) -> bool: ...

    def subset(self, chosen: NDArray[np.bool_]) -> NodePairs: ...

    def mesh_operator(self, n_nodes: int) -> Any: ...

    def operator(self, superelement: Superelement) -> FloatArray: ...


def tie_matrix(followers: IntArray, leaders: IntArray, weights: FloatArray, size: int) -> Any:
    """csr T (size, size - k) with ``u = T q``: unknown ``followers[i]`` is ``sum_j weights[i, j] u[leaders[i, j]]``.

    ``followers`` (k,), ``leaders`` and ``weights`` (k, b); a row of zero weights constrains its follower to zero.
    Raises InputError if an unknown would follow twice, or leads and follows.
    """
    used = weights != 0.0
    if len(np.unique(followers)) != len(followers) or np.intersect1d(leaders[used], followers).size:
        raise InputError(
            "a node is the follower in more than one contact pair (the second node if all pairs connect node to node, "
            "otherwise the first one), or the leader in one pair and the follower in another; such pairs cannot be "
            "tied. Give springs instead."
        )
    leads = np.ones(size, dtype=bool)
    leads[followers] = False
    column = np.cumsum(leads) - 1
    row, position = np.nonzero(used)
    rows = np.concatenate([np.flatnonzero(leads), followers[row]])
    columns = np.concatenate([column[leads], column[leaders[row, position]]])
    entries = np.concatenate([np.ones(leads.sum()), weights[row, position]])
    return scipy.sparse.csr_matrix((entries, (rows, columns)), shape=(size, size - len(followers)))


def _tie_matrix(model: Structure | Superelement, pairs: NodePairs) -> Any:
    """The tie matrix of all pairs: second nodes follow first ones, or first nodes follow points of the second face.

    Pairs whose relative displacements are unknowns have none.
    """
    if isinstance(model, Superelement) and model.joint_operator is not None:
        raise InputError(
            "a superelement that keeps the moving pairs alone has no unknowns of the other ones, so its pairs cannot "
            "be tied. Give springs instead.",
            arguments=["springs"],
        )
    if isinstance(model, Superelement) and model.joint_rows is not None:
        pairs.operator(model)  # rejects other pairs
        return np.delete(np.eye(model.size), model.joint_unknowns, axis=1)
    if pairs.is_matching:
        followers, leaders, weights = pairs.second_node, pairs.first_node[:, None], np.ones((len(pairs.first_node), 1))
    elif (np.count_nonzero(pairs.first_weights, axis=1) > 1).any():
        raise InputError(
            "contact pairs at integration points cannot be tied one by one, because their first side is a point among "
            "several nodes. Give springs, or pair the nodes of the face."
        )
    else:
        followers, leaders, weights = pairs.first_node, pairs.second_nodes, pairs.second_weights
    # An entry without weight may contain any number, also that of a node without unknowns: the follower replaces it.
    leaders = np.where(weights != 0.0, leaders, followers[:, None])
    leading = _unknowns(model, leaders.ravel()).reshape(*leaders.shape, 3).swapaxes(1, 2)
    return tie_matrix(
        _unknowns(model, followers).ravel(),
        leading.reshape(-1, leaders.shape[1]),
        np.repeat(weights, 3, axis=0),
        model.stiffness.shape[0],
    )


def _unknowns(model: Structure | Superelement, nodes: IntArray) -> IntArray:
    """(k, 3) unknowns of nodes (k,)."""
    if isinstance(model, Structure):
        return model.unknowns_of(nodes)
    return np.stack([model.unknowns_of(node) for node in nodes])


def stiffness_with_springs(structure: Structure, rows: Any, springs: FloatArray) -> Any:
    """csr ``K + B^T diag(springs) B`` (n_free, n_free) of rows B (m, 3 * n_nodes) and springs (m,) N/m."""
    operator = structure.of_unknowns(rows)
    return (structure.stiffness + operator.T @ (scipy.sparse.diags(springs) @ operator)).tocsr()


def joined_modes(
    model: Structure | Superelement, pairs: NodePairs, count: int, springs: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies (count,) in Hz with closed contact, and modes (n_full, count) on the full mesh.

    Without ``springs`` the pairs are tied: ``T^T K T v = (2 pi f)^2 T^T M T v``. With ``springs`` (3 * n_pairs,) in
    N/m, in the order t1, t2, n of each pair, they are stuck: ``(K + B^T diag(springs) B) v = (2 pi f)^2 M v``. A pair
    that is open has springs of 0. A body that moves freely has modes at 0 Hz (:func:`moves_freely`).
    Modes of a superelement without recovery stay in its own unknowns.

    In node-to-node pairs the second nodes follow. Otherwise each first node follows the paired point of the second
    face, or is constrained on the ground; first sides among several nodes need springs.

    Raises InputError for a wrong number of springs, for pairs that cannot be tied, and from the factor if the structure
    has no support.
    """
    if springs is None:
        tie = _tie_matrix(model, pairs)
        stiffness = tie.T @ model.stiffness @ tie
        frequency_hz, modes = natural_frequencies(stiffness, tie.T @ model.mass @ tie, count)
        frequency_hz[moves_freely(stiffness, modes)] = 0.0
        modes = tie @ modes
    else:
        if isinstance(model, Structure):
            operator = model.of_unknowns(pairs.mesh_operator(model.mesh.n_nodes))
        else:
            operator = pairs.operator(model)
        if np.shape(springs) != (operator.shape[0],):
            raise InputError(
                f"springs must have shape ({operator.shape[0]},), t1, t2, n of each pair, but the shape is "
                f"{np.shape(springs)}.",
                arguments=["springs"],
            )
        stiffness = model.stiffness + operator.T @ (scipy.sparse.diags(springs) @ operator)
        frequency_hz, modes = natural_frequencies(stiffness, model.mass, count)
        frequency_hz[moves_freely(stiffness, modes)] = 0.0
    if isinstance(model, Structure):
        return frequency_hz, model.expand(modes)
    return frequency_hz, modes if model.recovery is None else model.recovery @ modes
