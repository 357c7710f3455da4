"""Structures whose contact pairs are held together: tied (nodes merged) or stuck (springs), for frequencies."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import scipy.sparse

from stickslip.errors import InputError
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.mesh import IntArray
from stickslip.structure.superelement import Superelement
from stickslip.validation import FloatArray


class NodePairs(Protocol):
    """What a joint must tell: its node pairs, and its operators to relative displacements t1, t2, n."""

    @property
    def first_node(self) -> IntArray: ...

    @property
    def second_node(self) -> IntArray: ...

    def mesh_operator(self, n_nodes: int) -> Any: ...

    def operator(self, superelement: Superelement) -> FloatArray: ...


def tie_matrix(first: IntArray, second: IntArray, size: int) -> Any:
    """csr T (size, size - k) with ``u = T q``: the unknowns ``second`` (k,) follow the unknowns ``first`` (k,).

    Raises InputError when an unknown would follow two others, or leads and follows.
    """
    if len(np.unique(second)) != len(second) or np.intersect1d(first, second).size:
        raise InputError(
            "a node is in more than one contact pair as the second (blade) node, or is a first and a second node; "
            "such pairs cannot be tied one to one."
        )
    leads = np.ones(size, dtype=bool)
    leads[second] = False
    column = np.cumsum(leads) - 1
    column[second] = column[first]
    return scipy.sparse.csr_matrix((np.ones(size), (np.arange(size), column)), shape=(size, size - len(second)))


def joined_modes(
    model: Structure | Superelement, pairs: NodePairs, count: int, springs: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies (count,) in Hz with closed contact, and modes (n_full, count) on the full mesh.

    Without ``springs`` the pairs are tied: ``T^T K T v = (2 pi f)^2 T^T M T v``. With ``springs`` (3 * n_pairs,) in
    N/m, in the order t1, t2, n of each pair, they are stuck: ``(K + B^T diag(springs) B) v = (2 pi f)^2 M v``.
    Modes of a superelement without recovery stay in its own unknowns.

    Raises InputError for springs of the wrong number, and from the factor where the structure is not held.
    """
    if isinstance(model, Structure):
        first, second = model.unknowns_of(pairs.first_node), model.unknowns_of(pairs.second_node)
        operator = pairs.mesh_operator(model.mesh.n_nodes)[:, model.free_unknowns]
    else:
        first = np.stack([model.unknowns_of(node) for node in pairs.first_node])
        second = np.stack([model.unknowns_of(node) for node in pairs.second_node])
        operator = pairs.operator(model)
    size = model.stiffness.shape[0]
    if springs is None:
        tie = tie_matrix(first.ravel(), second.ravel(), size)
        frequency_hz, modes = natural_frequencies(tie.T @ model.stiffness @ tie, tie.T @ model.mass @ tie, count)
        modes = tie @ modes
    else:
        if np.shape(springs) != (operator.shape[0],):
            raise InputError(
                f"springs must have shape ({operator.shape[0]},), t1, t2, n of each pair; found {np.shape(springs)}."
            )
        contact = operator.T @ (scipy.sparse.diags(springs) @ operator)
        frequency_hz, modes = natural_frequencies(model.stiffness + contact, model.mass, count)
    if isinstance(model, Structure):
        return frequency_hz, model.expand(modes)
    return frequency_hz, modes if model.recovery is None else model.recovery @ modes
