"""One basis of a rotating structure for all speeds, of real matrices or of those of a nodal diameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.structure.elasticity import natural_frequencies
from stickslip.structure.factor import Backend, Factor, factorize
from stickslip.structure.mesh import IntArray
from stickslip.structure.reduced_matrices import BLOCK

Matrix = NDArray[Any]  # real or complex
# chosen: a change of the constraint modes with the speed is in the basis if its energy is above this fraction of the
# energy of the boundary motion that causes it: that of the square of a frequency without it.
LEAST_CHANGE = 1e-8
# chosen: parts of basis vectors below the root of this length squared are the same vector.
SAME_VECTOR = 1e-10


@dataclass(frozen=True)
class SpeedMatrices:
    """Sparse Hermitian matrices (n, n) at rest, and those for 1 rad/s: ``speed_stiffness`` kg, Hermitian, and
    ``coriolis`` kg, skew-Hermitian."""

    stiffness: Any
    mass: Any
    speed_stiffness: Any
    coriolis: Any

    def stiffness_at(self, omega: float) -> Any:
        """csr (n, n) N/m at a speed in rad/s."""
        return (self.stiffness + omega**2 * self.speed_stiffness).tocsr()


@dataclass(frozen=True)
class SpeedReduction:
    """The same matrices (k, k), dense, in a basis (n, k) of boundary unknowns, which come first, and ``modes``
    (n_interior, m); ``factor`` is that of the interior stiffness at rest."""

    mass: Matrix
    stiffness: Matrix
    speed_stiffness: Matrix
    coriolis: Matrix
    basis: Matrix
    modes: Matrix
    factor: Factor


def reduced_for_speeds(
    matrices: SpeedMatrices,
    boundary: IntArray,
    interior: IntArray,
    counts: tuple[int, int],
    top_omega: float,
    moved: NDArray[np.bool_],
    backend: Backend = "superlu",
    threads: int = 1,
) -> SpeedReduction:
    """Project matrices on one basis for the speeds from 0 to ``top_omega`` (rad/s).

    The basis is that of :func:`craig_bampton` at rest with ``counts[0]`` fixed-interface modes, and in addition
    ``counts[1]`` of those at the highest speed and the changes of the constraint modes from rest to there. ``moved``
    (n_boundary,) marks boundary unknowns of bodies that the speed changes. Parts that vectors have in common count
    once.
    """
    inner_mass = matrices.mass[interior][:, interior]
    ends = [
        _End(stiffness, inner_mass, boundary, interior, count, backend, threads)
        for stiffness, count in zip((matrices.stiffness, matrices.stiffness_at(top_omega)), counts, strict=True)
    ]
    vectors = np.hstack([ends[0].modes, ends[1].modes, _changes(ends[0], ends[1], moved)])
    modes = _ritz_vectors(vectors, ends[0].stiffness_ii, inner_mass)
    basis = np.zeros((matrices.mass.shape[0], len(boundary) + modes.shape[1]), dtype=modes.dtype)
    basis[boundary, np.arange(len(boundary))] = 1.0
    basis[interior] = np.hstack([ends[0].constraint, modes])
    mass, stiffness, speed_stiffness, coriolis = (
        _projected(matrix, basis)
        for matrix in (matrices.mass, matrices.stiffness, matrices.speed_stiffness, matrices.coriolis)
    )
    return SpeedReduction(
        _mended(mass), _mended(stiffness), _mended(speed_stiffness), 0.5 * (coriolis - coriolis.conj().T), basis, modes,
        ends[0].factor,
    )  # fmt: skip


class _End:
    """The parts of a Craig-Bampton basis at one end of the range of speeds."""

    def __init__(
        self, stiffness: Any, inner_mass: Any, boundary: Any, interior: Any, count: int, backend: Backend, threads: int
    ) -> None:
        self.stiffness_ii = stiffness[interior][:, interior]
        coupling = stiffness[interior][:, boundary]
        self.factor: Factor = factorize(self.stiffness_ii, backend, threads)
        self.modes = natural_frequencies(self.stiffness_ii, inner_mass, count, shift=0.0, factor=self.factor)[1]
        self.constraint = self.factor.solve(-coupling)
        self.boundary_stiffness = stiffness[boundary][:, boundary].toarray() + coupling.conj().T @ self.constraint


def _changes(rest: _End, top: _End, supported: NDArray[np.bool_]) -> Matrix:
    """(n_interior, k) combinations of the changes of the constraint modes whose energy is above LEAST_CHANGE.

    ``supported`` (n_boundary,) marks unknowns of bodies that the speed changes.
    """
    if not supported.any():
        return np.zeros((len(rest.modes), 0))
    change = (top.constraint - rest.constraint)[:, supported]
    energy, own = change.conj().T @ (rest.stiffness_ii @ change), rest.boundary_stiffness[np.ix_(supported, supported)]
    size, motions = scipy.linalg.eigh(_mended(energy), _mended(own))
    return np.asarray(change @ motions[:, size > LEAST_CHANGE])


def _ritz_vectors(vectors: Matrix, stiffness: Any, mass: Any) -> Matrix:
    """(n, k) mass-normalised vectors of the same space that diagonalise mass and stiffness."""
    vectors = vectors / np.sqrt(np.einsum("ij,ij->j", vectors.conj(), mass @ vectors).real)
    lengths, turns = scipy.linalg.eigh(vectors.conj().T @ (mass @ vectors))
    different = lengths > SAME_VECTOR * lengths[-1]
    vectors = vectors @ (turns[:, different] / np.sqrt(lengths[different]))
    # once more, without the round-off of vectors that nearly agree
    _, turns = scipy.linalg.eigh(vectors.conj().T @ (stiffness @ vectors), vectors.conj().T @ (mass @ vectors))
    return np.asarray(vectors @ turns)


def _projected(matrix: Any, basis: Matrix) -> Matrix:
    """``T^H A T`` (k, k) of a sparse matrix, a block of columns at a time."""
    size = basis.shape[1]
    answer = np.empty((size, size), dtype=basis.dtype)
    for start in range(0, size, BLOCK):
        answer[:, start : start + BLOCK] = basis.conj().T @ (matrix @ basis[:, start : start + BLOCK])
    return answer


def _mended(matrix: Matrix) -> Matrix:
    """A Hermitian matrix without the round-off of its products."""
    return np.asarray(0.5 * (matrix + matrix.conj().T))
