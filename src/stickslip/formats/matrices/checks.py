"""Checks of matrices of another program: symmetric, finite, positive semidefinite."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse

from stickslip.core.errors import InputError
from stickslip.structure.mesh import IntArray

# Text files of other programs have 9 digits or more, single precision 7.
ASYMMETRY = 1e-6
# Up to this size all eigenvalues are computed; it takes less than a second.
DENSE_SIZE = 1000


def checked_matrix(name: str, value: Any, node: IntArray, direction: IntArray) -> tuple[Any, str]:
    """``value`` as a csr matrix that passes both checks below, and a sentence on changes to it.

    Damping may be indefinite, so it is checked for symmetry only. Raises InputError.
    """
    matrix, message = _symmetric_sparse(name, value)
    if name != "damping":
        _require_definite(name, matrix, node, direction)
    return matrix, message


def _symmetric_sparse(name: str, value: Any) -> tuple[Any, str]:
    """``value`` as a symmetric csr matrix (n, n), and a sentence on changes to it ("" for none).

    A matrix with only one stored triangle is completed; round-off asymmetry below 1e-6 is removed. Raises InputError
    for a matrix that is not square, real, finite, or clearly neither triangular nor symmetric.
    """
    if np.ndim(value) != 2 or value.shape[0] != value.shape[1] or not value.shape[0]:
        raise InputError(f"{name} must be a square matrix with one row or more, but its shape is {np.shape(value)}.")
    if value.dtype.kind not in "fiub":
        kind = "complex" if value.dtype.kind == "c" else str(value.dtype)
        raise InputError(
            f"{name} must contain real numbers, but it is {kind}. Give structural damping as a viscous damping matrix."
        )
    matrix = scipy.sparse.csr_matrix(value, dtype=float)
    matrix.sum_duplicates()
    bad = np.flatnonzero(~np.isfinite(matrix.data))
    if bad.size:
        entries = matrix.tocoo()
        row, column = entries.row[bad[0]], entries.col[bad[0]]
        raise InputError(
            f"{name}[{row}, {column}] is {matrix.data[bad[0]]}; each entry must be a finite number ({bad.size} of "
            f"{matrix.nnz} are not)."
        )
    matrix.eliminate_zeros()
    lower, upper = scipy.sparse.tril(matrix, -1, format="csr"), scipy.sparse.triu(matrix, 1, format="csr")
    if bool(lower.nnz) != bool(upper.nnz):
        which = "lower" if lower.nnz else "upper"
        half = lower if lower.nnz else upper
        completed = scipy.sparse.csr_matrix(matrix + half.T)
        return completed, f"{name}: the file contains only the {which} triangle; the other one is its mirror image."
    difference = abs(matrix - matrix.T).tocoo()
    largest = float(np.abs(matrix.data).max(initial=0.0))
    if difference.nnz and difference.data.max() > ASYMMETRY * largest:
        worst = int(difference.data.argmax())
        i, j = int(difference.row[worst]), int(difference.col[worst])
        raise InputError(
            f"{name} must be symmetric, but entry [{i}, {j}] = {matrix[i, j]:.6g} and entry [{j}, {i}] = "
            f"{matrix[j, i]:.6g}, counted from 0, differ by {difference.data[worst] / largest:.1e} of the largest "
            f"entry (allowed: {ASYMMETRY:.0e}). These matrices must not contain gyroscopic or follower terms."
        )
    return scipy.sparse.csr_matrix(0.5 * (matrix + matrix.T)), ""


def _require_definite(name: str, matrix: Any, node: IntArray, direction: IntArray) -> None:
    """Raise InputError for a symmetric csr matrix that is clearly not positive semidefinite.

    Cheap necessary conditions are always checked: no negative diagonal, no off-diagonal entry above the geometric mean
    of its diagonals (``|a_ij| <= sqrt(a_ii a_jj)``). Up to 1000 unknowns all eigenvalues are checked. A stiffness with
    a zero on its diagonal has an unsupported unknown, and is rejected.
    """
    diagonal = matrix.diagonal()
    largest = float(diagonal.max(initial=0.0))
    low = np.flatnonzero(diagonal <= 0.0) if name == "stiffness" else np.flatnonzero(diagonal < -1e-12 * largest)
    if low.size or largest <= 0.0:
        worst = int(low[0]) if low.size else 0
        allowed = "above 0" if name == "stiffness" else "0 or above, and at least one above 0"
        raise InputError(
            f"{name}[{worst}, {worst}] ({_unknown(worst, node, direction)}) is {diagonal[worst]:.6g}; the diagonal "
            f"must be {allowed} ({low.size} of {len(diagonal)} entries are not). Is this the {name} matrix, and "
            "are all its unknowns connected?"
        )
    entries = scipy.sparse.triu(matrix, 1).tocoo()
    bound = np.sqrt(np.maximum(diagonal[entries.row], 0.0) * np.maximum(diagonal[entries.col], 0.0))
    bad = np.flatnonzero(np.abs(entries.data) > bound * (1.0 + 1e-6) + 1e-12 * largest)
    if bad.size:
        i, j, value = int(entries.row[bad[0]]), int(entries.col[bad[0]]), entries.data[bad[0]]
        raise InputError(
            f"{name} is not positive semidefinite: entry [{i}, {j}] ({_unknown(i, node, direction)} and "
            f"{_unknown(j, node, direction)}) is {value:.6g}, but with diagonal entries {diagonal[i]:.6g} and "
            f"{diagonal[j]:.6g} the limit is {bound[bad[0]]:.6g} ({bad.size} entries exceed it). Was a "
            "triangle added twice, or an index shifted by one?"
        )
    if len(diagonal) <= DENSE_SIZE:
        # Scaling by the diagonal makes unknowns of different units comparable, and keeps the signs.
        scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
        lowest = float(np.linalg.eigvalsh(scale[:, None] * matrix.toarray() * scale)[0])
        if lowest < -1e-6:
            raise InputError(
                f"{name} is not positive semidefinite: scaled to a diagonal of ones it has the eigenvalue {lowest:.3g} "
                "(allowed: -1e-6). Was the diagonal or a triangle counted twice, or is it another matrix?"
            )


def _unknown(row: int, node: IntArray, direction: IntArray) -> str:
    """Name of an unknown in messages."""
    words = ("x", "y", "z", "rotation x", "rotation y", "rotation z", "other")
    return f"node {node[row]}, {words[direction[row]]}"
