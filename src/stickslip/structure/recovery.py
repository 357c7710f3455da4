"""From the unknowns of a Craig-Bampton superelement back to the displacements of the full mesh."""

from __future__ import annotations

from copy import copy
from typing import Any, Protocol

import numpy as np
import scipy.linalg

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.factor import Backend, Factor, factorize
from stickslip.structure.mesh import IntArray
from stickslip.structure.superelement import Superelement

# chosen: each correction of a vibrating interior reduces its error by the square of the frequency over that of the
# first neglected mode, a factor of 10 or more.
CORRECTIONS = 3


# chosen: a further shape with less of its mass outside of constraint modes and modes is one of them, by round-off.
SAME_SHAPE = 1e-9

_BLOCK = 64  # chosen to bound the memory of a projection


class FullModel(Protocol):
    """A model that can be reduced and recovered: a :class:`Structure`, or matrices of another program."""

    @property
    def stiffness(self) -> Any:
        """csr (n_free, n_free)."""

    @property
    def mass(self) -> Any:
        """csr (n_free, n_free)."""

    @property
    def full_size(self) -> int:
        """Number of displacements, including constrained ones."""

    @property
    def free_unknowns(self) -> IntArray:
        """(n_free,) index of each unknown among all displacements."""

    @property
    def node(self) -> IntArray:
        """(n_free,) node of each unknown."""

    def unknowns_of(self, nodes: IntArray) -> IntArray:
        """(k, 3) unknowns x, y, z of nodes (k,)."""

    def expand(self, vectors: FloatArray) -> FloatArray:
        """Displacements (full_size, ...) from free unknowns (n_free, ...)."""

    def gather(self, load: FloatArray) -> FloatArray:
        """Forces (n_free, ...) on the unknowns from those (full_size, ...) on all displacements."""


def partition(structure: FullModel, boundary_nodes: IntArray) -> tuple[IntArray, IntArray]:
    """Free unknowns of the boundary nodes, in their order, and all others."""
    boundary = structure.unknowns_of(boundary_nodes).ravel()
    return boundary, np.setdiff1d(np.arange(structure.stiffness.shape[0]), boundary)


class Recovery:
    """``recovery @ reduced``: displacements (3 * n_nodes, k) of the mesh, fixed ones zero, from unknowns (n, k).

    Interior displacements are ``Phi q - K_ii^-1 K_ib u_b``, solved on demand: the dense matrix would be the largest
    array of all. The factor of ``K_ii`` is cached, but not stored with a pickled recovery.
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

    @property
    def model(self) -> FullModel:
        """The model that was reduced."""
        return self._structure

    def __matmul__(self, reduced: FloatArray) -> FloatArray:
        return self._structure.expand(self._free(reduced))

    def _free(self, reduced: FloatArray) -> FloatArray:
        """(n_free, ...) free displacements from unknowns (n, ...)."""
        count = len(self._boundary)
        free = np.empty((self._structure.stiffness.shape[0], *reduced.shape[1:]))
        free[self._boundary] = reduced[:count]
        free[self._interior] = self.modes @ reduced[count:]
        free[self._interior] -= self._solve(self._coupling() @ reduced[:count])
        return free

    def with_shapes(self, shapes: FloatArray) -> Recovery:
        """The recovery of a reduction whose modes span further shapes (n_free, k) too.

        The part of a shape beside the constraint modes, ``f_i + K_ii^-1 K_ib f_b``, is a motion with fixed boundary;
        with the modes it gives others by the method of Rayleigh and Ritz.
        """
        inside = self._interior
        beside = shapes[inside] + self._solve(self._coupling() @ shapes[self._boundary])
        stiffness, mass = (matrix[inside][:, inside] for matrix in (self._structure.stiffness, self._structure.mass))
        length, whole = (
            np.sqrt(np.einsum("ij,ij->j", each, matrix @ each))
            for each, matrix in ((beside, mass), (shapes, self._structure.mass))
        )
        own = length**2 > SAME_SHAPE * whole**2
        if not own.any():
            return self
        beside = beside[:, own] / length[own]
        for _ in range(2):  # the second time for round-off; no direction of the modes is lost
            beside = beside - self.modes @ (self.modes.T @ (mass @ beside))
        squares, turns = scipy.linalg.eigh(beside.T @ (mass @ beside))
        chosen = squares > SAME_SHAPE
        basis = np.hstack([self.modes, beside @ (turns[:, chosen] / np.sqrt(squares[chosen]))])
        modes = basis @ scipy.linalg.eigh(basis.T @ (stiffness @ basis), basis.T @ (mass @ basis))[1]
        changed = copy(self)
        changed.modes, changed._factor = modes, self._factor  # a copy has no factor, as a pickled one
        return changed

    def extended(self, mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mass and stiffness (n, n) of the unknowns of this recovery, from those of one with the same boundary."""
        inside, boundary, count, size = self._interior, self._boundary, len(self._boundary), self.shape[1]
        full_mass, full_stiffness = self._structure.mass[inside], self._structure.stiffness[inside]
        weighted = full_mass[:, inside] @ self.modes
        answer = np.zeros((2, size, size))
        answer[:, :count, :count] = mass[:count, :count], stiffness[:count, :count]
        coupling = full_mass[:, boundary].T @ self.modes - self._coupling().T @ self._solve(weighted)
        answer[0, :count, count:], answer[0, count:, :count] = coupling, coupling.T
        answer[0, count:, count:] = self.modes.T @ weighted
        answer[1, count:, count:] = self.modes.T @ (full_stiffness[:, inside] @ self.modes)
        return answer[0], answer[1]

    def vibrating(self, reduced: FloatArray, squares: FloatArray) -> FloatArray:
        """(n_free, k) free displacements of harmonic motions (n, k) with circular frequencies squared ``squares`` (k,).

        The interior is in equilibrium with its inertia beyond the modes of the reduction too: corrections
        ``-K_ii^-1 (K - w^2 M) u`` without their part in these modes, each smaller by ``w^2`` over the next eigenvalue.
        """
        stiffness, mass, inside = self._structure.stiffness, self._structure.mass, self._interior
        inner_mass = mass[inside][:, inside]
        weighted = inner_mass @ self.modes
        free = self._free(reduced)
        for _ in range(CORRECTIONS):
            unbalance = (stiffness @ free - (mass @ free) * squares)[inside]
            unbalance -= weighted @ (self.modes.T @ unbalance)
            change = self._solve(unbalance)
            free[inside] -= change - self.modes @ (weighted.T @ change)
        return np.asarray(self._structure.expand(free)[self._structure.free_unknowns])

    def with_omitted_modes(self, reduced: FloatArray, load: FloatArray, omega: float = 0.0) -> FloatArray:
        """Displacements (3 * n_nodes, 2H+1) of the mesh with the static part of the modes that the reduction omits.

        ``u = T reduced + [0; K_ii^-1 - Phi Lambda^-1 Phi^T] (f + (k omega)^2 M T reduced)`` for each harmonic k: the
        omitted modes follow load and inertia as springs without mass. For constant loads this is exact; stresses near a
        distributed load require it.

        Parameters
        ----------
        reduced:
            (n, 2H+1) coefficients mean, cos 1, sin 1, ... of the unknowns.
        load:
            (3 * n_nodes, 2H+1) N on the full mesh, forces of boundary nodes included.
        omega:
            circular frequency in rad/s.

        Source: mode-acceleration method, R. R. Craig, A. J. Kurdila, Fundamentals of Structural Dynamics, 2nd ed.
        (2006).
        """
        plain = self._free(reduced)
        inner = self._interior
        harmonic = (np.arange(reduced.shape[1]) + 1) // 2
        right = (self._structure.gather(load) + (self._structure.mass @ plain) * (harmonic * omega) ** 2)[inner]
        omitted = self._solve(right)
        if self.modes.shape[1]:
            inner_stiffness = self._structure.stiffness[inner][:, inner]
            squared = np.einsum("ij,ij->j", self.modes, inner_stiffness @ self.modes)
            omitted = omitted - self.modes @ ((self.modes.T @ right) / squared[:, None])
        plain[inner] += omitted
        return self._structure.expand(plain)

    def project(self, load: FloatArray) -> FloatArray:
        """``T^T f`` (n, k) of loads f (3 * n_nodes, k) in N on the full mesh, T the transformation of this recovery.

        ``T^T f = [f_b - K_bi K_ii^-1 f_i; Phi^T f_i]``: the statically equivalent load of the boundary, so that the
        boundary's static displacements are exact for loads anywhere, and the force on each mode. Parts of a load on
        constrained displacements go into the support. As rows, the result gives ``f . u`` from the unknowns.
        """
        return self._project(self._structure.gather(load))

    def projected(self, matrix: Any) -> FloatArray:
        """``T^T A T`` (n, n) of a sparse matrix (n_free, n_free) of the free unknowns, a block of columns at a time."""
        size = self.shape[1]
        answer = np.empty((size, size))
        for start in range(0, size, _BLOCK):
            columns = np.eye(size)[:, start : start + _BLOCK]
            answer[:, start : start + _BLOCK] = self._project(matrix @ self._free(columns))
        return answer

    def _project(self, free: FloatArray) -> FloatArray:
        """``T^T f`` of forces (n_free, k) on the free unknowns."""
        inside = free[self._interior]
        boundary = free[self._boundary] - self._coupling().T @ self._solve(inside)
        return np.concatenate([boundary, self.modes.T @ inside])

    def _coupling(self) -> Any:
        """csr ``K_ib``."""
        return self._structure.stiffness[self._interior][:, self._boundary]

    def _solve(self, right: FloatArray) -> FloatArray:
        """``K_ii^-1 right``."""
        if self._factor is None:
            inner = self._structure.stiffness[self._interior][:, self._interior]
            self._factor = factorize(inner, self._backend, self._threads)
        return self._factor.solve(right)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_factor": None}


def reduced_load(superelement: Superelement, load: FloatArray) -> FloatArray:
    """``T^T f`` (n, k) of loads f (3 * n_nodes, k) in N on the full mesh (:meth:`Recovery.project`).

    Raises InputError for a superelement without a recovery that can project, and for a load of another length.
    """
    recovery = superelement.recovery
    if not isinstance(recovery, Recovery):
        raise InputError("reduced_load requires a superelement with a recovery, such as that of craig_bampton.")
    if np.shape(load)[0] != recovery.shape[0]:
        raise InputError(
            f"load has {np.shape(load)[0]} rows, but the mesh has {recovery.shape[0]} displacements (3 of each node).",
            arguments=["load"],
        )
    return recovery.project(load)
