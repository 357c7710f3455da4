"""Projection of the matrices of a structure on its constraint modes and fixed-interface modes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from stickslip.core.errors import InputError, SingularMatrixError
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import in_threads
from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import natural_frequencies
from stickslip.structure.factor import MANY_COLUMNS, Backend, Factor, factor_forecast, factorize
from stickslip.structure.floating_parts import floating_message
from stickslip.structure.mesh import IntArray

# Columns of a matrix product at a time; each thread has this number in memory.
BLOCK = 64
# A larger boundary is reduced block by block: the product of the constraint modes with the mass, for each column two
# operations for each number of all of them, then takes longer than a second solution (docs/performance.md).
LARGE_BOUNDARY = MANY_COLUMNS


@dataclass(frozen=True)
class ReducedMatrices:
    """Dense matrices (n, n) of a reduction, its fixed-interface modes (n_interior, n_modes), and the factor of
    ``K_ii``; damping and gyroscopic matrix may be None."""

    mass: Any
    stiffness: Any
    damping: Any
    modes: Any
    factor: Factor
    gyroscopic: Any = None


def reduced_matrices(
    matrices: tuple[Any, Any, Any],
    node: IntArray,
    boundary: IntArray,
    interior: IntArray,
    n_modes: int,
    backend: Backend,
    threads: int,
    report: ProgressCallback,
    gyroscopic: Any = None,
) -> ReducedMatrices:
    """The reduction of sparse Hermitian matrices: stiffness, mass and damping (or None), real or complex.

    ``node`` is the node of each unknown, for messages; ``gyroscopic`` is skew-Hermitian, or None. Raises InputError,
    see :func:`craig_bampton`.
    """
    stiffness, mass, damping = matrices
    require_modes(n_modes, interior)
    stiffness_ii, stiffness_ib = stiffness[interior][:, interior], stiffness[interior][:, boundary]
    report(0.0, factor_forecast(len(interior), backend))
    try:
        factor = factorize(stiffness_ii, backend, threads)
    except SingularMatrixError as error:
        raise InputError(floating_message(stiffness_ii, node[interior])) from error
    size, n_boundary = len(boundary) + n_modes, len(boundary)
    if n_boundary >= LARGE_BOUNDARY and backend == "superlu" and factor.dtype is float:
        return _reduced_by_blocks(matrices, gyroscopic, boundary, interior, factor, n_modes, report)

    transformation: Any = np.empty((len(interior), size), dtype=factor.dtype)
    squared, transformation[:, n_boundary:] = fixed_interface_modes(
        stiffness_ii, mass[interior][:, interior], factor, n_modes, report
    )
    constraint = transformation[:, :n_boundary]
    solved = f"{n_boundary} constraint modes"
    factor.solve(-stiffness_ib, out=constraint, progress=lambda share: report(0.3 + 0.5 * share, solved))
    report(0.8, "reduced matrices")

    reduced_stiffness: Any = np.zeros((size, size), dtype=factor.dtype)
    for start in range(0, n_boundary, BLOCK):  # the product of all columns at once would copy them
        columns = slice(start, min(start + BLOCK, n_boundary))
        reduced_stiffness[:n_boundary, columns] = stiffness_ib.conj().T @ constraint[:, columns]
    _add_sparse(reduced_stiffness, stiffness[boundary][:, boundary])
    reduced_stiffness[n_boundary:, n_boundary:] = np.diag(squared)
    reduced_mass = _projected(mass, boundary, interior, transformation, threads)
    reduced_damping = None if damping is None else _projected(damping, boundary, interior, transformation, threads)
    whirl = None if gyroscopic is None else _projected(gyroscopic, boundary, interior, transformation, threads, -1)
    modes = transformation[:, n_boundary:].copy()
    return ReducedMatrices(reduced_mass, reduced_stiffness, reduced_damping, modes, factor, whirl)


def require_modes(n_modes: int, interior: IntArray) -> None:
    """Raise InputError for a number of modes that the interior does not have."""
    if not 0 <= n_modes < len(interior):
        raise InputError(
            f"n_modes is {n_modes}; with {len(interior)} interior unknowns it must be between 0 and "
            f"{len(interior) - 1}.",
            ("n_modes",),
        )


def fixed_interface_modes(
    stiffness: Any, mass: Any, factor: Factor, n_modes: int, report: ProgressCallback, by_blocks: bool = False
) -> tuple[FloatArray, Any]:
    """(n_modes,) squares of the circular frequencies and (n_interior, n_modes) mass-normalised modes of the interior.

    ``by_blocks`` as :func:`stickslip.structure.elasticity.natural_frequencies` has it.
    """
    report(0.2, f"{n_modes} fixed-interface modes")
    if not n_modes:
        return np.empty(0), np.empty((stiffness.shape[0], 0), dtype=factor.dtype)
    frequency_hz, modes = natural_frequencies(stiffness, mass, n_modes, shift=0.0, factor=factor, by_blocks=by_blocks)
    return (2.0 * np.pi * frequency_hz) ** 2, modes


def _reduced_by_blocks(
    matrices: tuple[Any, Any, Any],
    gyroscopic: Any,
    boundary: IntArray,
    interior: IntArray,
    factor: Factor,
    n_modes: int,
    report: ProgressCallback,
) -> ReducedMatrices:
    """:func:`reduced_matrices` of a large boundary: a block of constraint modes at a time.

    With ``W = A_ii Psi + A_ib`` of a block of columns the projection of a matrix A is ``A_bi Psi + A_bb + Psi^H W``,
    and ``Psi^H W = -K_bi (K_ii^-1 W)`` takes a second solution instead of a product with all constraint modes.
    """
    stiffness, mass, damping = matrices
    squared, modes = fixed_interface_modes(
        stiffness[interior][:, interior], mass[interior][:, interior], factor, n_modes, report
    )
    n_boundary, size = len(boundary), len(boundary) + n_modes
    coupling = stiffness[interior][:, boundary].tocsc()
    adjoint_coupling = coupling.conj().T.tocsr()
    factor = factor.for_many_columns()
    one_thread = replace(factor, threads=1)  # blocks run in parallel, not the columns of one
    projected: list[tuple[Any, Any, int, Any]] = [
        (
            matrix[interior][:, interior],
            matrix[interior][:, boundary].tocsc(),
            sign,
            np.zeros((size, size), factor.dtype),
        )
        for matrix, sign in ((mass, 1), (damping, 1), (gyroscopic, -1))
        if matrix is not None
    ]
    reduced_stiffness: Any = np.zeros((size, size), dtype=factor.dtype)

    def reduce_block(start: int) -> None:
        columns = slice(start, min(start + BLOCK, n_boundary))
        constraint = one_thread.solve(-coupling[:, columns].toarray(), BLOCK)
        reduced_stiffness[:n_boundary, columns] = adjoint_coupling @ constraint
        for inner, outer, sign, answer in projected:
            weighted = inner @ constraint + outer[:, columns].toarray()
            answer[:n_boundary, columns] = sign * (outer.conj().T @ constraint)
            answer[:n_boundary, columns] -= adjoint_coupling @ one_thread.solve(weighted, BLOCK)
            answer[n_boundary:, columns] = modes.conj().T @ weighted
        report(0.3 + 0.5 * columns.stop / n_boundary, f"{n_boundary} constraint modes")

    in_threads(reduce_block, range(0, n_boundary, BLOCK), factor.threads)
    report(0.8, "reduced matrices")
    _add_sparse(reduced_stiffness, stiffness[boundary][:, boundary])
    reduced_stiffness[n_boundary:, n_boundary:] = np.diag(squared)
    answers = iter(projected)
    return ReducedMatrices(
        _completed(mass, next(answers), boundary, modes),
        _hermitian(reduced_stiffness, 1),
        None if damping is None else _completed(damping, next(answers), boundary, modes),
        modes,
        factor,
        None if gyroscopic is None else _completed(gyroscopic, next(answers), boundary, modes),
    )


def _completed(matrix: Any, parts: tuple[Any, Any, int, Any], boundary: IntArray, modes: Any) -> Any:
    """The projection of a matrix from its columns of the boundary: with ``A_bb``, the columns and the block of the
    modes."""
    inner, _, sign, answer = parts
    count = len(boundary)
    _add_sparse(answer, matrix[boundary][:, boundary])
    answer[:count, count:] = sign * answer[count:, :count].conj().T
    answer[count:, count:] = modes.conj().T @ (inner @ modes)
    return _hermitian(answer, sign)


def _hermitian(matrix: Any, sign: int) -> Any:
    """A matrix with ``A^H = sign A`` but for round-off, without that; in its place."""
    for start in range(0, len(matrix), BLOCK):
        stop = min(start + BLOCK, len(matrix))
        mean = 0.5 * (matrix[start:stop, start:] + sign * matrix[start:, start:stop].conj().T)
        matrix[start:stop, start:] = mean
        matrix[start:, start:stop] = sign * mean.conj().T
    return matrix


def _projected(
    matrix: Any, boundary: IntArray, interior: IntArray, transformation: Any, threads: int, sign: Literal[1, -1] = 1
) -> Any:
    """``T^H A T`` of a sparse matrix with ``A^H = sign A``, and ``T = [I 0; transformation]`` in boundary and interior
    rows."""
    result = _congruence(matrix[interior][:, interior], transformation, threads, sign)
    coupling = matrix[interior][:, boundary].conj().T @ transformation
    result[: len(boundary)] += sign * coupling
    result[:, : len(boundary)] += coupling.conj().T
    del coupling
    _add_sparse(result, matrix[boundary][:, boundary])
    return result


def _add_sparse(dense: Any, part: Any) -> None:
    """Add a sparse matrix (k, k) to the first k rows and columns, without a dense copy of it."""
    entries = part.tocoo()
    dense[entries.row, entries.col] += entries.data


def _congruence(matrix: Any, basis: Any, threads: int, sign: Literal[1, -1]) -> Any:
    """``basis^H matrix basis`` (k, k) of a sparse matrix, block by block and one triangle only: its conjugate transpose
    is ``sign`` times itself."""
    size = basis.shape[1]
    answer = np.empty((size, size), dtype=basis.dtype)

    def rows_from(start: int) -> None:
        stop = min(start + BLOCK, size)
        answer[start:stop, start:] = sign * ((matrix @ basis[:, start:stop]).conj().T @ basis[:, start:])
        answer[stop:, start:stop] = sign * answer[start:stop, stop:].conj().T

    in_threads(rows_from, range(0, size, BLOCK), threads)
    return answer
