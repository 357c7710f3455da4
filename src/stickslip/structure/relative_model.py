"""A structure in the relative displacements of its contact pairs, for the reduction of large joints.

A boundary of both sides of each pair has six unknowns for each pair. The forces of a joint depend on the relative
displacements ``x = B u`` alone, three for each pair. Each pair therefore has an *own* node, on which no other pair
depends, and ``x`` replaces the displacements of these nodes: ``u = T v``, where v contains ``x`` and all other
displacements of the mesh. T is square, sparse and invertible, so no motion is lost. The pairs are the boundary of
a Craig-Bampton reduction of ``T^T K T`` and ``T^T M T``; its fixed-interface modes are those of the structure whose
pairs are tied.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Structure
from stickslip.structure.joined import NodePairs
from stickslip.structure.mesh import IntArray, Mesh

# Allowed error of the inverse of the part of own nodes in the relative displacements, which are products of unit
# vectors; chosen: far above their round-off, far below any weight of a node.
_INVERSE_ERROR = 1e-9


@dataclass(frozen=True)
class RelativeModel:
    """A structure with the relative displacements of pairs in the place of the displacements of their own nodes.

    Parameters
    ----------
    base:
        the structure.
    own_nodes:
        (n_pairs,) the node of each pair whose displacements x, y, z are replaced by the relative displacements t1, t2,
        n of the pair.
    transformation:
        csr T (n_free, n_free) with ``u = T v``.
    rows:
        csr (3 * n_pairs, n_free) with ``x = B u``.
    """

    base: Structure
    own_nodes: IntArray
    transformation: Any
    rows: Any

    @classmethod
    def of(cls, structure: Structure, pairs: NodePairs, other_nodes: IntArray) -> RelativeModel | None:
        """The model of all pairs; None where a pair has no own node.

        An own node is a side of one pair alone, without a weight, and is free in each direction. ``other_nodes``, such
        as those of forces, keep their displacements, so they are not own nodes. Raises InputError for pairs with nodes
        that are not free, as a reduction to the displacements of these nodes does.
        """
        structure.unknowns_of(pairs.nodes)
        own_nodes = _own_nodes(pairs, other_nodes)
        if own_nodes is None:
            return None
        own = structure.unknowns_of(own_nodes).ravel()
        size = structure.stiffness.shape[0]
        operator = structure.of_unknowns(pairs.mesh_operator(structure.mesh.n_nodes)).tocsr()
        part = operator[:, own]
        # Three unknowns of a pair belong to its own node: each block of the inverse is that of a block.
        blocks = np.stack([part[3 * i : 3 * i + 3, 3 * i : 3 * i + 3].toarray() for i in range(len(own_nodes))])
        inverse = scipy.sparse.block_diag(np.linalg.inv(blocks), format="csr")
        if abs(inverse @ part - scipy.sparse.identity(len(own))).max() > _INVERSE_ERROR:
            return None  # other nodes follow an own node, so that a pair depends on that of another one
        others = np.ones(size)
        others[own] = 0.0
        place = scipy.sparse.csr_matrix((np.ones(len(own)), (own, np.arange(len(own)))), shape=(size, len(own)))
        rest = scipy.sparse.diags(others)
        transformation = rest + place @ inverse @ (place.T - operator @ rest)
        return cls(structure, own_nodes, transformation.tocsr(), operator)

    @cached_property
    def stiffness(self) -> Any:
        """csr ``T^T K T``."""
        return (self.transformation.T @ self.base.stiffness @ self.transformation).tocsr()

    @cached_property
    def mass(self) -> Any:
        """csr ``T^T M T``."""
        return (self.transformation.T @ self.base.mass @ self.transformation).tocsr()

    @property
    def mesh(self) -> Mesh:
        """The mesh of the structure."""
        return self.base.mesh

    @property
    def full_size(self) -> int:
        """Number of displacements of the mesh, fixed ones included."""
        return self.base.full_size

    @property
    def free_unknowns(self) -> IntArray:
        """(n_free,) index of each unknown of the structure among all displacements."""
        return self.base.free_unknowns

    @property
    def node(self) -> IntArray:
        """(n_free,) node of each unknown; for those of a pair its own node."""
        return self.base.node

    def unknowns_of(self, nodes: IntArray) -> IntArray:
        """(k, 3) unknowns of nodes (k,): x, y, z, or t1, t2, n of the pair of an own node."""
        return self.base.unknowns_of(nodes)

    def expand(self, vectors: FloatArray) -> FloatArray:
        """Displacements (full_size, ...) of the mesh from unknowns (n_free, ...)."""
        return self.base.expand(self.transformation @ vectors)

    def unknowns_from(self, vectors: FloatArray) -> FloatArray:
        """``T^-1 u`` (n_free, ...) of displacements (n_free, ...) of the structure."""
        answer = vectors.copy()
        answer[self.base.unknowns_of(self.own_nodes).ravel()] = self.rows @ vectors
        return answer

    def gather(self, load: FloatArray) -> FloatArray:
        """``T^T f`` (n_free, ...) of forces (full_size, ...) on the mesh."""
        return np.asarray(self.transformation.T @ self.base.gather(load))


def _own_nodes(pairs: NodePairs, other_nodes: IntArray) -> IntArray | None:
    """(n_pairs,) an own node of each pair, None if one has none."""
    sides = [(pairs.first_nodes, pairs.first_weights), (pairs.second_nodes, pairs.second_weights)]
    node, count = np.unique(np.concatenate([nodes[weights != 0.0] for nodes, weights in sides]), return_counts=True)
    possible = np.setdiff1d(node[count == 1], other_nodes)
    own = np.full(len(pairs.first_nodes), -1, dtype=np.int64)
    for nodes, weights in sides:
        allowed = np.isin(nodes, possible) & (weights == 1.0)
        chosen = nodes[np.arange(len(own)), allowed.argmax(axis=1)]
        own = np.where((own < 0) & allowed.any(axis=1), chosen, own)
    return None if (own < 0).any() else own
