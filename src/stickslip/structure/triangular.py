"""Solutions for many right-hand sides with the triangular factor of a sparse symmetric matrix.

SuperLU solves one column after the other. Here each number of the factor is read once for a block of columns, whose
rows are vectors of the processor; rows that are zero in the whole block, such as those of nodes far from the loaded
ones, are passed over. On the two blades with 440 pairs (31,803 unknowns, 8.3 million numbers of the factor) a block of
64 columns takes a fifth of the time of SuperLU.
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


@dataclass(frozen=True)
class TriangularFactor:
    """``P A P^T = L D L^T`` of a real symmetric matrix A (n, n).

    ``pointers``, ``rows``, ``values`` are L by columns, each from its diagonal of 1 on; ``diagonal`` is D, and
    unknown i is in row ``place[i]`` of L.
    """

    pointers: NDArray[np.int32]
    rows: NDArray[np.int32]
    values: FloatArray
    diagonal: FloatArray
    place: NDArray[np.int32]

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
        return cls(lower.indptr, lower.indices, lower.data, diagonal, place)

    def solve(self, right: FloatArray) -> FloatArray:
        """``A^-1 right`` of (n,) or (n, k)."""
        columns = right[:, None] if right.ndim == 1 else right
        answer = np.empty(columns.shape)
        ordered = np.empty((len(columns), min(COLUMNS, columns.shape[1])))
        for start in range(0, columns.shape[1], COLUMNS):
            part = columns[:, start : start + COLUMNS]
            block = ordered[:, : part.shape[1]] if part.shape[1] == ordered.shape[1] else np.empty(part.shape)
            block[self.place] = part
            solve_block(self.pointers, self.rows, self.values, self.diagonal, block)
            answer[:, start : start + COLUMNS] = block[self.place]
        return answer.reshape(right.shape)


@njit(cache=True, nogil=True, fastmath={"contract"})
def solve_block(
    pointers: NDArray[np.int32],
    rows: NDArray[np.int32],
    values: FloatArray,
    diagonal: FloatArray,
    block: FloatArray,
) -> None:
    """``(L D L^T)^-1 block`` (n, k) in its place."""
    size, width = block.shape
    for j in range(size):
        source = block[j]
        is_zero = True
        for k in range(width):
            if source[k] != 0.0:
                is_zero = False
                break
        if is_zero:
            continue
        for entry in range(pointers[j] + 1, pointers[j + 1]):
            value, target = values[entry], block[rows[entry]]
            for k in range(width):
                target[k] -= value * source[k]
    for j in range(size - 1, -1, -1):
        target = block[j]
        for k in range(width):
            target[k] /= diagonal[j]
        for entry in range(pointers[j] + 1, pointers[j + 1]):
            value, source = values[entry], block[rows[entry]]
            for k in range(width):
                target[k] -= value * source[k]
