"""Eigenvalues of sparse matrices near a shift, with a bound on the work.

The iteration is that of scipy (ARPACK), one vector at a time; here are the bound and the search for copies of multiple
values. That of :mod:`stickslip.core.block_lanczos` is for factors that solve a block in little more time than one
vector. SuperLU solves column by column, and a block requires a quarter more of them (440 pairs: 176 instead of 142).
It also requires a shift below all values, and real matrices.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse.linalg
from threadpoolctl import threadpool_limits

from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.structure.factor import Factor

# Restarts of the iteration. Every structure of the tests and examples needs fewer than ten; scipy's own limit is ten
# times the number of unknowns, which takes hours where round-off prevents convergence because entries differ too much
# in size.
MOST_RESTARTS = 200


_SUBSPACE = 20  # vectors of the iteration for one solution: scipy's own number
# Test for a solution that was missed: its residual in a first iteration, the distances at which another one at full
# accuracy decides, and equality there.
_ROUGH, _FAR, _EQUAL = 1e-2, 1.05, 1e-6


def eigenpairs_near(
    matrix: Any, count: int, shift: float, factor: Factor, mass: Any = None
) -> tuple[FloatArray, FloatArray]:
    """The ``count`` solutions of ``A v = x M v`` nearest to ``shift``: values (count,) and vectors (n, count).

    The matrices are symmetric, or complex and Hermitian. ``factor`` is that of ``A - shift * M``; ``mass`` None is the
    identity. The start is the same in every call. A Krylov subspace has only one vector of each multiple eigenvalue but
    for round-off, so that three of four equal ones may be followed by the next larger one. Solutions that are
    M-orthogonal to those found are therefore searched until none is nearer; the last two of all n are not searched.
    Raises ConvergenceError where an iteration does not end after ``MOST_RESTARTS`` restarts.
    """
    values, vectors = _iterated(matrix, count, shift, factor, mass)
    while matrix.shape[0] - len(values) > 2:
        last = np.sort(np.abs(values - shift))[count - 1]
        found = _orthonormal(vectors, mass)
        value, _ = _iterated(matrix, 1, shift, factor, mass, found, _ROUGH)
        if abs(value[0] - shift) > _FAR * last:
            break
        value, vector = _iterated(matrix, 1, shift, factor, mass, found)
        if abs(value[0] - shift) >= (1.0 - _EQUAL) * last:
            break
        values, vectors = np.append(values, value), np.hstack([vectors, vector])
    nearest = np.sort(np.argsort(np.abs(values - shift), kind="stable")[:count])
    return values[nearest], vectors[:, nearest]


def _iterated(
    matrix: Any,
    count: int,
    shift: float,
    factor: Factor,
    mass: Any,
    found: tuple[FloatArray, FloatArray] | None = None,
    tolerance: float = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """Solutions of one Lanczos iteration. With ``found``, an M-orthonormal basis V (n, k) and M V, in the M-orthogonal
    complement of V: ``(1 - V V^H M) (A - shift M)^-1``. ``tolerance`` of the residual; 0: round-off. Raises
    ConvergenceError."""
    size = matrix.shape[0]

    def solve(force: FloatArray) -> FloatArray:
        answer = factor.solve(force)
        if found is None:
            return answer
        basis, weighted = found
        return np.asarray(answer - basis @ (weighted.conj().T @ answer))

    inverse = scipy.sparse.linalg.LinearOperator((size, size), matvec=solve, dtype=factor.dtype)
    start = np.random.default_rng(0 if found is None else found[0].shape[1]).standard_normal(size).astype(factor.dtype)
    subspace = None if found is None else min(_SUBSPACE, size - found[0].shape[1])
    try:
        # one thread and one start, so that modes, which are cached on disk, are the same in every run
        with threadpool_limits(limits=1):
            values, vectors = scipy.sparse.linalg.eigsh(
                matrix, count, mass, shift, v0=start, ncv=subspace, maxiter=MOST_RESTARTS, tol=tolerance, OPinv=inverse
            )
    except scipy.sparse.linalg.ArpackNoConvergence as error:
        raise ConvergenceError(
            f"only {len(error.eigenvalues)} of {count} eigenvalues of a matrix with {size} unknowns converged in "
            f"{MOST_RESTARTS} restarts. Its entries most likely differ too much in size: check the units of Young's "
            "modulus, density, lengths and contact stiffness. Otherwise request fewer, or a shift closer to the "
            "required ones."
        ) from error
    except scipy.sparse.linalg.ArpackError as error:
        raise ConvergenceError(
            f"the eigenvalues of a matrix with {size} unknowns cannot be computed: its entries most likely differ too "
            "much in size. Check the units of Young's modulus, density, lengths and contact stiffness."
        ) from error
    return np.asarray(values), np.asarray(vectors)


def _orthonormal(vectors: FloatArray, mass: Any) -> tuple[FloatArray, FloatArray]:
    """An M-orthonormal basis of the space of ``vectors`` (n, k), and M times it.

    Those of the iteration for complex matrices are not orthogonal where values are equal.
    """
    weighted = vectors if mass is None else mass @ vectors
    gram = np.linalg.cholesky(vectors.conj().T @ weighted)
    basis, weighted = (np.linalg.solve(gram, array.conj().T).conj().T for array in (vectors, weighted))
    return np.asarray(basis), np.asarray(weighted)
