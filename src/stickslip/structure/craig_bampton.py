"""Craig-Bampton reduction: boundary nodes stay, constraint modes and fixed-interface modes represent the interior."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from stickslip.core.errors import InputError, SingularMatrixError
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import in_threads
from stickslip.core.validation import FloatArray
from stickslip.structure.cache import cached_tied_modes
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.factor import (
    MANY_COLUMNS,
    PARDISO_SIZE,
    Backend,
    Factor,
    checked_solver,
    factor_forecast,
    factorize,
)
from stickslip.structure.floating_parts import floating_message
from stickslip.structure.joined import NodePairs, joined_modes
from stickslip.structure.mesh import IntArray
from stickslip.structure.multifrontal import condensed
from stickslip.structure.recovery import FullModel, Recovery, partition
from stickslip.structure.superelement import Superelement

# Columns of a matrix product at a time; each thread has this number in memory.
BLOCK = 64
# A larger boundary is reduced block by block: the product of the constraint modes with the mass, for each column two
# operations for each number of all of them, then takes longer than a second solution (docs/performance.md).
LARGE_BOUNDARY = MANY_COLUMNS
# chosen: from this number of interior unknowns on a mesh is eliminated by fronts (docs/performance.md).
LARGE_INTERIOR = PARDISO_SIZE


def craig_bampton(
    structure: FullModel,
    boundary_nodes: ArrayLike,
    n_modes: int = 30,
    backend: Backend = "superlu",
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Superelement:
    """Reduce a structure to its boundary nodes and ``n_modes`` fixed-interface modes.

    ``u_i = Psi u_b + Phi q`` with the constraint modes ``Psi = -K_ii^-1 K_ib`` and the modes
    ``K_ii Phi = M_ii Phi Lambda`` (mass-normalised). Reduced stiffness ``diag(K_bb + K_bi Psi, Lambda)``, reduced mass
    with ``M_bq = Psi^T M_ii Phi + M_bi Phi`` and ``M_qq = I``; a damping matrix is projected as the mass is.

    Parameters
    ----------
    structure:
        a structure, or the matrices of another program (:class:`MatrixModel`).
    boundary_nodes:
        nodes to keep, in the order of the unknowns: node ``boundary_nodes[i]`` owns unknowns 3i, 3i + 1, 3i + 2.
    n_modes:
        number of fixed-interface modes; their amplitudes are the last unknowns. 0 gives the Guyan reduction.
    backend, threads:
        how to factor, and how many blocks of columns to work on at a time
        (:func:`stickslip.structure.factor.factorize`). With SuperLU the numbers are the same for any ``threads``.
    progress:
        called with the finished fraction and a sentence, for a large mesh with the expected time of its factor.

    Returns
    -------
    Superelement
        with 3 * n_boundary + n_modes unknowns and a ``recovery`` of shape (full_size, n) to the full model.

    Raises
    ------
    InputError
        for an empty boundary, a node that is repeated, fixed or does not exist, a mode count out of range, and a
        boundary that leaves a body free to move (singular ``K_ii``): the message names the unsupported part.

    Source: R. R. Craig, M. C. C. Bampton, Coupling of substructures for dynamic analyses, AIAA J. 6 (1968) 1313-1319.
    """
    # The last digits of a matrix product depend on the threads of the linear algebra, and a curve that folds amplifies
    # them to 1e-6. Therefore each product has one thread, and several products run at a time.
    with threadpool_limits(limits=1):
        return _reduced(structure, boundary_nodes, n_modes, backend, threads, progress)


def _reduced(
    structure: FullModel,
    boundary_nodes: ArrayLike,
    n_modes: int,
    backend: Backend,
    threads: int,
    progress: ProgressCallback | None,
) -> Superelement:
    """:func:`craig_bampton` with one thread for each product of the linear algebra."""
    nodes = checked_boundary(boundary_nodes)
    boundary, interior = partition(structure, nodes)
    report = progress or (lambda fraction, detail: None)
    damping, mesh = getattr(structure, "damping", None), getattr(structure, "mesh", None)
    matrices = (structure.stiffness, structure.mass, damping)
    is_large = len(boundary) >= LARGE_BOUNDARY or len(interior) >= LARGE_INTERIOR
    if is_large and backend == "superlu" and damping is None and mesh is not None:
        _require_modes(n_modes, interior)
        of_mesh = structure.node, mesh.points
        reduced = _reduced_by_fronts(matrices, of_mesh, boundary, interior, n_modes, threads, report)
    else:
        reduced = reduced_matrices(matrices, structure.node, boundary, interior, n_modes, backend, threads, report)
    recovery = Recovery(structure, nodes, reduced.modes, backend, threads, reduced.factor)
    return Superelement(reduced.mass, reduced.stiffness, reduced.damping, boundary_nodes=nodes, recovery=recovery)


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
    _require_modes(n_modes, interior)
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
    squared, transformation[:, n_boundary:] = _fixed_interface_modes(matrices, interior, factor, n_modes, report)
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


def _require_modes(n_modes: int, interior: IntArray) -> None:
    """Raise InputError for a number of modes that the interior does not have."""
    if not 0 <= n_modes < len(interior):
        raise InputError(
            f"n_modes is {n_modes}; with {len(interior)} interior unknowns it must be between 0 and "
            f"{len(interior) - 1}.",
            ("n_modes",),
        )


def _reduced_by_fronts(
    matrices: tuple[Any, Any, Any],
    of_mesh: tuple[IntArray, FloatArray],
    boundary: IntArray,
    interior: IntArray,
    n_modes: int,
    threads: int,
    report: ProgressCallback,
) -> ReducedMatrices:
    """:func:`reduced_matrices` of stiffness and mass of a mesh with a large boundary, without constraint modes.

    ``of_mesh`` are the node of each unknown and the positions of the nodes. See
    :mod:`stickslip.structure.multifrontal`; ``Psi^T M_ii Phi = -K_bi K_ii^-1 M_ii Phi`` of the modes.
    """
    stiffness, mass, _ = matrices
    count, inner_stiffness = len(boundary), stiffness[interior][:, interior]
    report(0.0, f"condensation of {len(interior)} unknowns")
    try:
        fronts, (reduced_stiffness, reduced_mass) = condensed(
            (stiffness, mass), *of_mesh, boundary, interior, n_modes, threads,
            lambda done: report(0.7 * done, f"condensation of {len(interior)} unknowns"),
        )  # fmt: skip
        residual = checked_solver(inner_stiffness, fronts.solve, "multifrontal")
    except SingularMatrixError as error:
        raise InputError(floating_message(inner_stiffness, of_mesh[0][interior])) from error
    factor = Factor(len(interior), residual, threads, fronts.solve)
    squared, modes = _fixed_interface_modes(matrices, interior, factor, n_modes, lambda _, words: report(0.7, words))
    weighted = mass[interior][:, interior] @ modes
    coupling = mass[boundary][:, interior] @ modes - stiffness[boundary][:, interior] @ factor.solve(weighted)
    reduced_mass[:count, count:], reduced_mass[count:, :count] = coupling, coupling.T
    corner = modes.T @ weighted
    reduced_mass[count:, count:] = 0.5 * (corner + corner.T)
    reduced_stiffness[count:, count:] = np.diag(squared)
    return ReducedMatrices(reduced_mass, reduced_stiffness, None, modes, factor)


def _fixed_interface_modes(
    matrices: tuple[Any, Any, Any], interior: IntArray, factor: Factor, n_modes: int, report: ProgressCallback
) -> tuple[FloatArray, Any]:
    """(n_modes,) squares of the circular frequencies and (n_interior, n_modes) mass-normalised modes."""
    report(0.2, f"{n_modes} fixed-interface modes")
    if not n_modes:
        return np.empty(0), np.empty((len(interior), 0), dtype=factor.dtype)
    inner_stiffness, inner_mass = (each[interior][:, interior] for each in matrices[:2])
    frequency_hz, modes = natural_frequencies(inner_stiffness, inner_mass, n_modes, shift=0.0, factor=factor)
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
    squared, modes = _fixed_interface_modes(matrices, interior, factor, n_modes, report)
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


def checked_boundary(boundary_nodes: ArrayLike) -> IntArray:
    """Boundary nodes as integers after checking that they come once; raises InputError."""
    nodes = np.asarray(boundary_nodes).ravel()
    if not nodes.size or not np.issubdtype(nodes.dtype, np.integer):
        raise InputError(
            "boundary_nodes must be node numbers (integers), and at least one.", arguments=["boundary_nodes"]
        )
    unique, count = np.unique(nodes, return_counts=True)
    if count.max() > 1:
        raise InputError(
            f"boundary_nodes names node {unique[count.argmax()]} {count.max()} times; name it once.",
            arguments=["boundary_nodes"],
        )
    return nodes.astype(np.int64)


@dataclass(frozen=True)
class ReductionRow:
    """One mode before and after reduction.

    Difference and modal assurance are not a number for a body that moves freely: its frequency is 0 Hz, and its
    modes are any combination of its motions.
    """

    mode: int
    full_hz: float
    reduced_hz: float
    difference_percent: float
    mac: float


def reduction_table(
    structure: Structure,
    superelement: Superelement,
    pairs: NodePairs,
    count: int = 10,
    springs: FloatArray | None = None,
) -> tuple[ReductionRow, ...]:
    """Frequencies of the full and the reduced model with tied contact, or stuck contact when ``springs`` are given.

    ``springs`` (3 * n_pairs,) N/m, t1, t2, n of each pair; 0 for a pair that is open. The difference is
    ``100 (reduced / full - 1)`` and the modal assurance criterion ``|a.b|^2 / (a.a b.b)`` compares the modes on the
    full mesh; neither is a number for rigid-body modes. Raises InputError for a superelement without recovery.
    """
    if superelement.recovery is None:
        raise InputError("reduction_table requires a superelement with a recovery, such as that of craig_bampton.")
    if springs is None:
        full_hz, full = cached_tied_modes(structure, pairs, count)
    else:
        full_hz, full = joined_modes(structure, pairs, count, springs)
    reduced_hz, reduced = joined_modes(superelement, pairs, count, springs)
    product = np.einsum("ij,ij->j", full, reduced)
    mac = product**2 / (np.einsum("ij,ij->j", full, full) * np.einsum("ij,ij->j", reduced, reduced))
    elastic = np.minimum(full_hz, reduced_hz) > 0.0
    mac[~elastic] = np.nan
    difference = np.full(count, np.nan)
    difference[elastic] = 100.0 * (reduced_hz[elastic] / full_hz[elastic] - 1.0)
    columns = zip(full_hz, reduced_hz, difference, mac, strict=True)
    return tuple(ReductionRow(place + 1, *map(float, cells)) for place, cells in enumerate(columns))
