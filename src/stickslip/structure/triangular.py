"""Solutions for many right-hand sides with the triangular factor of a sparse symmetric matrix.

SuperLU solves one column after the other. Here each number of the factor is read once for a block of columns, whose
rows are vectors of the processor. Neighbouring columns of the factor with the same rows form a panel, a dense matrix,
so that most of the work are products of dense matrices (supernodes: Ng, Peyton, Block sparse Cholesky algorithms on
advanced uniprocessor computers, SIAM J. Sci. Comput. 14 (1993) 1034-1056). Panels whose rows are zero in the
whole block, such as those of nodes far from the loaded ones, are passed over.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

# Columns of a block: 64 numbers are eight cache lines. 32 and 128 take the same time for a column (measured).
COLUMNS = 64
# chosen: L D L^T differs from the factors of SuperLU by no more than this fraction; round-off is 1e-14.
SYMMETRIC = 1e-10
# chosen: a wider panel is divided, because its part on the diagonal is solved column by column.
WIDEST_PANEL = 64
# chosen: for fewer columns the product of a panel costs less than its call.
LEAST_PANEL = 4

IndexArray = NDArray[np.int32]
LongArray = NDArray[np.int64]


@dataclass(frozen=True)
class TriangularFactor:
    """``P A P^T = L D L^T`` of a real symmetric matrix A (n, n).

    Panel k are the columns ``firsts[k]`` to ``firsts[k + 1]`` of L. Its rows begin with those of its columns; the
    others are ``rows[row_starts[k]]`` to ``rows[row_starts[k + 1]]``. ``values[value_starts[k]:]`` are its numbers row
    by row; those on and above the diagonal are not used. ``diagonal`` is D, and unknown i is in row ``place[i]`` of L.
    """

    firsts: LongArray
    row_starts: LongArray
    rows: IndexArray
    value_starts: LongArray
    values: FloatArray
    diagonal: FloatArray
    place: IndexArray

    @classmethod
    def of_superlu(cls, factor: Any) -> TriangularFactor | None:
        """That of a SuperLU object of a symmetric matrix, None where it exchanged rows, so that it is not symmetric."""
        place = np.asarray(factor.perm_r)
        if not np.array_equal(place, factor.perm_c):
            return None
        lower, upper = factor.L, factor.U
        diagonal = upper.diagonal()
        test = np.random.default_rng(0).uniform(0.5, 1.5, diagonal.size)
        expected = diagonal * (lower.T @ test)
        if not np.abs(upper @ test - expected).max() <= SYMMETRIC * np.abs(expected).max():
            return None
        lower.sort_indices()
        del upper
        return cls(*_panels(lower.indptr, lower.indices, lower.data), diagonal, place)

    def solve(self, right: FloatArray) -> FloatArray:
        """``A^-1 right`` of (n,) or (n, k)."""
        columns = right[:, None] if right.ndim == 1 else right
        answer = np.empty(columns.shape)
        ordered = np.empty((len(columns), min(COLUMNS, columns.shape[1])))
        for start in range(0, columns.shape[1], COLUMNS):
            part = columns[:, start : start + COLUMNS]
            block = ordered[:, : part.shape[1]] if part.shape[1] == ordered.shape[1] else np.empty(part.shape)
            block[self.place] = part
            solve_block(self.firsts, self.row_starts, self.rows, self.value_starts, self.values, self.diagonal, block)
            answer[:, start : start + COLUMNS] = block[self.place]
        return answer.reshape(right.shape)


def _panels(
    pointers: IndexArray, rows: IndexArray, values: FloatArray
) -> tuple[LongArray, LongArray, IndexArray, LongArray, FloatArray]:
    """The panels of a triangular matrix by columns, each from its diagonal on."""
    firsts = np.append(np.flatnonzero(_begins_panel(pointers, rows)), len(pointers) - 1)
    width = np.diff(firsts)
    below = np.diff(pointers)[firsts[:-1]] - width
    row_starts, value_starts = (np.append(0, np.cumsum(each)) for each in (below, width * (width + below)))
    panel_rows = np.empty(row_starts[-1], dtype=np.int32)
    panel_values = np.zeros(value_starts[-1])
    _fill_panels(pointers, rows, values, firsts, row_starts, panel_rows, value_starts, panel_values)
    return firsts, row_starts, panel_rows, value_starts, panel_values


@njit(cache=True, nogil=True)
def _begins_panel(pointers: IndexArray, rows: IndexArray) -> NDArray[np.bool_]:
    """(n,) whether a column begins a panel: its rows are not those of the column before it."""
    size = len(pointers) - 1
    begins = np.ones(size, dtype=np.bool_)
    width = 0
    for j in range(size):
        is_same = j > 0 and width < WIDEST_PANEL
        if is_same:
            before, here, count = pointers[j - 1] + 1, pointers[j], pointers[j + 1] - pointers[j]
            is_same = pointers[j] - before == count
            k = 0
            while is_same and k < count:
                is_same = rows[before + k] == rows[here + k]
                k += 1
        begins[j] = not is_same
        width = width + 1 if is_same else 1
    return begins


@njit(cache=True, nogil=True)
def _fill_panels(
    pointers: IndexArray,
    rows: IndexArray,
    values: FloatArray,
    firsts: LongArray,
    row_starts: LongArray,
    panel_rows: IndexArray,
    value_starts: LongArray,
    panel_values: FloatArray,
) -> None:
    """Copy the numbers of a matrix by columns to its panels."""
    for panel in range(len(firsts) - 1):
        first, width = firsts[panel], firsts[panel + 1] - firsts[panel]
        below = row_starts[panel + 1] - row_starts[panel]
        start = pointers[first] + width
        for i in range(below):
            panel_rows[row_starts[panel] + i] = rows[start + i]
        for column in range(width):
            begin = pointers[first + column]
            for i in range(width - column + below):
                panel_values[value_starts[panel] + (column + i) * width + column] = values[begin + i]


@njit(cache=True, nogil=True, fastmath={"contract"})
def _subtract(target: FloatArray, value: float, known: FloatArray) -> None:
    """``target -= value * known`` of rows (k,)."""
    for k in range(target.size):
        target[k] -= value * known[k]


@njit(cache=True, nogil=True, fastmath={"contract"})
def solve_block(
    firsts: LongArray,
    row_starts: LongArray,
    rows: IndexArray,
    value_starts: LongArray,
    values: FloatArray,
    diagonal: FloatArray,
    block: FloatArray,
) -> None:
    """``(L D L^T)^-1 block`` (n, k) in its place, for an array whose rows are contiguous."""
    n_panels, n_columns = len(firsts) - 1, block.shape[1]
    work = np.empty((np.diff(row_starts).max(), n_columns))
    for panel in range(n_panels):
        first, last = firsts[panel], firsts[panel + 1]
        source = block[first:last]
        if not source.any():
            continue
        width = last - first
        numbers = values[value_starts[panel] : value_starts[panel + 1]].reshape(-1, width)
        for j in range(width):
            for i in range(j + 1, width):
                _subtract(source[i], numbers[i, j], source[j])
        below = rows[row_starts[panel] : row_starts[panel + 1]]
        if width < LEAST_PANEL:
            for i in range(len(below)):
                for j in range(width):
                    _subtract(block[below[i]], numbers[width + i, j], source[j])
            continue
        product = work[: len(below)]
        np.dot(numbers[width:], source, product)
        for i in range(len(below)):
            _subtract(block[below[i]], 1.0, product[i])
    for panel in range(n_panels - 1, -1, -1):
        first, last = firsts[panel], firsts[panel + 1]
        target_rows, width = block[first:last], last - first
        numbers = values[value_starts[panel] : value_starts[panel + 1]].reshape(-1, width)
        below = rows[row_starts[panel] : row_starts[panel + 1]]
        for i in range(width):
            target = target_rows[i]
            for k in range(n_columns):
                target[k] /= diagonal[first + i]
        if width < LEAST_PANEL:
            for i in range(len(below)):
                for j in range(width):
                    _subtract(target_rows[j], numbers[width + i, j], block[below[i]])
        else:
            gathered = work[: len(below)]
            for i in range(len(below)):
                known, copied = block[below[i]], gathered[i]
                for k in range(n_columns):
                    copied[k] = known[k]
            target_rows -= np.dot(numbers[width:].T, gathered)
        for j in range(width - 1, -1, -1):
            for i in range(j + 1, width):
                _subtract(target_rows[j], numbers[i, j], target_rows[i])
