"""From the unknowns of a Craig-Bampton superelement back to the displacements of the full mesh."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from stickslip.structure.factor import Backend, Factor, factorize
from stickslip.structure.mesh import IntArray
from stickslip.validation import FloatArray


class FullModel(Protocol):
    """What a model must tell to be reduced and recovered: a :class:`Structure`, or matrices of another program."""

    @property
    def stiffness(self) -> Any:
        """csr (n_free, n_free)."""

    @property
    def mass(self) -> Any:
        """csr (n_free, n_free)."""

    @property
    def full_size(self) -> int:
        """Number of displacements, held ones included."""

    @property
    def free_unknowns(self) -> IntArray:
        """(n_free,) position of each unknown among all displacements."""

    @property
    def node(self) -> IntArray:
        """(n_free,) node of each unknown."""

    def unknowns_of(self, nodes: IntArray) -> IntArray:
        """(k, 3) unknowns x, y, z of nodes (k,)."""

    def expand(self, vectors: FloatArray) -> FloatArray:
        """Displacements (full_size, ...) from free unknowns (n_free, ...)."""


def partition(structure: FullModel, boundary_nodes: IntArray) -> tuple[IntArray, IntArray]:
    """Free unknowns of the boundary nodes, in their order, and all others."""
    boundary = structure.unknowns_of(boundary_nodes).ravel()
    return boundary, np.setdiff1d(np.arange(structure.stiffness.shape[0]), boundary)


class Recovery:
    """``recovery @ reduced``: displacements (3 * n_nodes, k) of the mesh, fixed ones zero, from unknowns (n, k).

    Interior displacements are ``Phi q - K_ii^-1 K_ib u_b``, solved when they are asked for: the dense matrix would be
    the largest array of all. The factor of ``K_ii`` is kept, but not stored with a pickled recovery.
    """

    def __init__(
        self,
        structure: FullModel,
        boundary_nodes: IntArray,
        modes: FloatArray,
        backend: Backend = "superlu",
        threads: int = 1,
        factor: Factor | None = None,
    ) -> None:
        self.modes = modes
        self._structure = structure
        self._boundary, self._interior = partition(structure, boundary_nodes)
        self._backend, self._threads = backend, threads
        self._factor = factor

    @property
    def shape(self) -> tuple[int, int]:
        """Displacements of the mesh, unknowns of the superelement."""
        return self._structure.full_size, len(self._boundary) + self.modes.shape[1]

    def __matmul__(self, reduced: FloatArray) -> FloatArray:
        stiffness = self._structure.stiffness[self._interior]
        if self._factor is None:
            self._factor = factorize(stiffness[:, self._interior], self._backend, self._threads)
        count = len(self._boundary)
        free = np.empty((stiffness.shape[1], *reduced.shape[1:]))
        free[self._boundary] = reduced[:count]
        free[self._interior] = self.modes @ reduced[count:]
        free[self._interior] -= self._factor.solve(stiffness[:, self._boundary] @ reduced[:count])
        return self._structure.expand(free)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_factor": None}
