"""One place that factors sparse Hermitian matrices, checks the factor, and solves for many right-hand sides."""

from __future__ import annotations

import importlib.util
import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

from stickslip.core.errors import ConvergenceError, InputError, MissingPackageError, SingularMatrixError
from stickslip.core.threads import in_threads
from stickslip.core.validation import FloatArray, require_choice
from stickslip.structure.triangular import TriangularFactor

Backend = Literal["superlu", "pardiso"]

# An accurate factor of a stiffness matrix has a backward error of 1e-14 and an error of 1e-7 or less against an exact
# solution. A singular one still has a small backward error, but an error of about 1. The limits are between these.
RESIDUAL_LIMIT = 1e-10
SOLUTION_ERROR_LIMIT = 1e-3
# Above this size PARDISO is faster than SuperLU, by a factor that grows with the size.
PARDISO_SIZE = 40_000
# From this number of right-hand sides on the form of SuperLU's factor for many columns pays. Process time measured for
# a column, two blades: 2 ms against 12 ms of SuperLU (33,117 interior unknowns), 5 ms against 21 ms of PARDISO
# (56,118).
MANY_COLUMNS = 1000
# Time of a SuperLU factor of a slender and of a full solid mesh of 100,000 unknowns, measured (docs/performance.md).
SUPERLU_SECONDS, SUPERLU_SIZE, SUPERLU_GROWTH = (7.0, 50.0), 100_000, 1.9
_SINGULAR_ADVICE = (
    "A body or node without support is the usual cause: fix more nodes (or make them boundary nodes), or use a "
    "negative shift for free structures."
)


@dataclass(frozen=True)
class Factor:
    """A factored matrix (n, n), and the backward error ``residual`` of its check."""

    size: int
    residual: float
    threads: int
    _solve: Callable[[FloatArray], FloatArray]
    dtype: type = float  # of the matrix: float, or complex
    _superlu: Any = None  # the SuperLU object of a real matrix

    def for_many_columns(self) -> Factor:
        """The same factor in the form that solves many columns several times faster; itself where there is none.

        The SuperLU object is released with this factor.
        """
        triangular = None if self._superlu is None else TriangularFactor.of_superlu(self._superlu)
        return self if triangular is None else replace(self, _solve=triangular.solve, _superlu=None)

    def solve(
        self,
        right_hand_sides: Any,
        block: int = 32,
        out: FloatArray | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> FloatArray:
        """``matrix^-1 @ right_hand_sides``: (n,) or (n, k), dense or sparse, into ``out`` (n, k) if it is given.

        Columns are solved in blocks, ``threads`` blocks at a time; ``progress`` receives the finished fraction.
        """
        if not scipy.sparse.issparse(right_hand_sides):
            dense: Any = np.asarray(right_hand_sides, dtype=self.dtype)
            if dense.ndim == 1:
                return self._solve(dense)
            columns: Any = dense
        else:
            columns = right_hand_sides.tocsc()
        solution = np.empty(columns.shape, dtype=self.dtype) if out is None else out
        starts = range(0, columns.shape[1], block)
        done = itertools.count(1)

        def solve_block(start: int) -> None:
            part = columns[:, start : start + block]
            part = part.toarray() if scipy.sparse.issparse(part) else np.ascontiguousarray(part)
            solution[:, start : start + block] = self._solve(part)
            if progress is not None:
                progress(next(done) / len(starts))

        in_threads(solve_block, starts, self.threads)
        return solution


def best_backend(size: int, columns: int = 0) -> Backend:
    """PARDISO where it is installed and faster, else SuperLU, which solves many ``columns`` faster."""
    if columns < MANY_COLUMNS and size >= PARDISO_SIZE and importlib.util.find_spec("pypardiso") is not None:
        return "pardiso"
    return "superlu"


def factor_forecast(size: int, backend: Backend) -> str:
    """A sentence on the factor of a solid mesh with ``size`` unknowns, with the expected time of SuperLU."""
    if backend == "pardiso" or size < PARDISO_SIZE:
        return f"factor of {size} unknowns"
    growth = (size / SUPERLU_SIZE) ** SUPERLU_GROWTH
    slender, full = (max(1, round(seconds * growth)) for seconds in SUPERLU_SECONDS)
    return (
        f"factor of {size} unknowns with SuperLU, from {slender} s (slender mesh) to {full} s (full body); "
        "the extra stickslip[pardiso] helps with full bodies"
    )


def factorize(matrix: Any, backend: Backend = "superlu", threads: int = 1) -> Factor:
    """Factor a sparse symmetric, or complex Hermitian, matrix (n, n) and check the factor on one exact solution.

    ``superlu`` comes with scipy; ``pardiso`` (several times faster beyond about 50,000 unknowns) needs the extra
    ``stickslip[pardiso]``, and factors real matrices only: SuperLU factors complex ones in any case.

    Raises
    ------
    InputError
        for a matrix that is not square, or a backend that does not exist; SingularMatrixError for a singular one.
    ConvergenceError
        when the backward error ``|A x - b| / (|A| |x| + |b|)`` of the check exceeds 1e-10.
    MissingPackageError
        if ``pardiso`` is requested and not installed.
    """
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or not matrix.shape[0]:
        raise InputError(f"the matrix must be square and not empty, but its shape is {matrix.shape}.")
    require_choice("backend", backend, get_args(Backend))
    dtype = complex if np.iscomplexobj(matrix) else float
    uses_superlu = backend == "superlu" or dtype is complex
    superlu = _superlu(matrix) if uses_superlu else None
    solve = _pardiso(matrix) if superlu is None else superlu.solve
    residual = checked_solver(matrix, solve, backend)
    # PARDISO has its own threads; several threads may use a SuperLU factor at a time.
    is_real = dtype is float
    return Factor(matrix.shape[0], residual, threads if uses_superlu else 1, solve, dtype, superlu if is_real else None)


def checked_solver(matrix: Any, solve: Callable[[FloatArray], FloatArray], name: str) -> float:
    """The backward error of a solver of a matrix, checked on one exact solution.

    Raises SingularMatrixError and ConvergenceError as :func:`factorize` does.
    """
    residual, solution_error = _errors(matrix, solve)
    if not solution_error <= SOLUTION_ERROR_LIMIT:
        # The digits of a larger error are round-off.
        size = f"{solution_error:.1e}" if solution_error < 1.0 else "above 1"
        raise SingularMatrixError(
            f"a matrix with {matrix.shape[0]} unknowns is singular or nearly so: the error of its factor for a test "
            f"solution is {size} (allowed: {SOLUTION_ERROR_LIMIT:.0e}). {_SINGULAR_ADVICE}"
        )
    if not residual <= RESIDUAL_LIMIT:
        raise ConvergenceError(
            f"the {name} factor of a matrix with {matrix.shape[0]} unknowns has a relative residual of "
            f"{residual:.1e} (allowed: {RESIDUAL_LIMIT:.0e}). Scale the matrix, or try the other backend."
        )
    return residual


def negative_pivots(matrix: Any) -> int:
    """Number of negative eigenvalues of a sparse Hermitian matrix: the negative pivots of its factor (Sylvester).

    Raises RuntimeError for a matrix that is singular to working accuracy.
    """
    # pivots from the diagonal alone keep rows and columns in one order, which the law of inertia needs
    options = {"SymmetricMode": True}
    factor = scipy.sparse.linalg.splu(
        scipy.sparse.csc_matrix(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options
    )
    return int((factor.U.diagonal().real < 0.0).sum())


def is_positive_definite(matrix: Any) -> bool:
    """Whether a sparse Hermitian matrix has only positive eigenvalues."""
    try:
        return negative_pivots(matrix) == 0
    except RuntimeError:
        return False


def _superlu(matrix: Any) -> Any:
    # The ordering and the diagonal pivots suit symmetric matrices: 2 to 4 times faster than SuperLU's defaults.
    try:
        return scipy.sparse.linalg.splu(
            scipy.sparse.csc_matrix(matrix),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        raise SingularMatrixError(
            f"a matrix with {matrix.shape[0]} unknowns is singular ({error}). {_SINGULAR_ADVICE}"
        ) from error


def _pardiso(matrix: Any) -> Callable[[FloatArray], FloatArray]:
    try:
        import pypardiso
    except ImportError as error:
        raise MissingPackageError(
            "backend 'pardiso' requires the package pypardiso: pip install 'stickslip[pardiso]', or use "
            "backend='superlu', which comes with scipy."
        ) from error
    # Type -2, real symmetric indefinite, reads the upper triangle: twice as fast as the general type, half the memory.
    solver = pypardiso.PyPardisoSolver(mtype=-2)
    upper = scipy.sparse.triu(matrix, format="csr")
    solver.factorize(upper)
    return lambda right_hand_side: np.asarray(solver.solve(upper, right_hand_side))


def _errors(matrix: Any, solve: Callable[[FloatArray], FloatArray]) -> tuple[float, float]:
    """Backward error and error of the solution, both relative and in the maximum norm, for a known, reproducible x."""
    # Entries near 1 give x a component along every rigid-body translation, which a singular stiffness loses.
    exact = np.random.default_rng(0).uniform(0.5, 1.5, matrix.shape[0]).astype(matrix.dtype)
    right_hand_side = matrix @ exact
    solution = solve(right_hand_side)
    largest_row = float(abs(matrix).sum(axis=1).max())
    scale = largest_row * float(np.abs(solution).max()) + float(np.abs(right_hand_side).max())
    residual = float(np.abs(matrix @ solution - right_hand_side).max()) / scale
    return residual, float(np.abs(solution - exact).max())
