"""Eigenvalues of sparse matrices near a shift, with a bound on the work."""

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


def eigenpairs_near(
    matrix: Any, count: int, shift: float, factor: Factor, mass: Any = None
) -> tuple[FloatArray, FloatArray]:
    """The ``count`` solutions of ``A v = x M v`` nearest to ``shift``: values (count,) and vectors (n, count).

    The matrices are symmetric, or complex and Hermitian. ``factor`` is that of ``A - shift * M``; ``mass`` None is the
    identity. The start is the same in every call. Raises ConvergenceError where the iteration does not end after
    ``MOST_RESTARTS`` restarts.
    """
    size = matrix.shape[0]
    inverse = scipy.sparse.linalg.LinearOperator((size, size), matvec=factor.solve, dtype=factor.dtype)
    start = np.random.default_rng(0).standard_normal(size).astype(factor.dtype)
    try:
        # one thread and one start, so that modes, which are cached on disk, are the same in every run
        with threadpool_limits(limits=1):
            values, vectors = scipy.sparse.linalg.eigsh(
                matrix, count, mass, shift, OPinv=inverse, v0=start, maxiter=MOST_RESTARTS
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
