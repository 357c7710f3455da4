"""Products of a few vectors with a large matrix, which is read from memory once.

The products of a linear algebra library copy such a matrix into another order first, which takes longer than the
product itself (2970 rows, 2500 columns, six vectors: 10 ms; here 7.6 ms, and 5.3 ms if the numbers of the matrix have
single precision).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.compiled import njit
from stickslip.core.threads import in_shares
from stickslip.core.validation import FloatArray

# chosen: rows of a product in one thread at a time.
ROWS_AT_ONCE = 128
# chosen: vectors for which each number of the matrix is read once; more need more registers than the processor has.
VECTORS = 6


def row_products(matrix: NDArray[Any], vectors: FloatArray) -> FloatArray:
    """``vectors @ matrix^T`` (c, m) for a matrix (m, k), row by row, and vectors (c, k).

    The matrix may have single precision. Sums have double precision, because an iteration with rounded products does
    not reach its tolerance.

    Rows are divided among the threads of :func:`stickslip.core.threads.solver_threads`; the digits do not depend on
    their number.
    """
    answer = np.empty((len(vectors), len(matrix)), dtype=float)
    given = np.ascontiguousarray(vectors)
    in_shares(lambda start, stop: _multiply(matrix, given, answer, start, stop), len(matrix), ROWS_AT_ONCE)
    return answer


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _multiply(matrix: NDArray[Any], vectors: FloatArray, answer: FloatArray, start: int, stop: int) -> None:
    """:func:`row_products` in the rows ``start`` to ``stop`` of the matrix."""
    count, size = vectors.shape
    grouped = count - count % VECTORS
    for row in range(start, stop):
        numbers = matrix[row]
        for first in range(0, grouped, VECTORS):
            a, b, c = vectors[first], vectors[first + 1], vectors[first + 2]
            d, e, f = vectors[first + 3], vectors[first + 4], vectors[first + 5]
            sum_a = sum_b = sum_c = sum_d = sum_e = sum_f = 0.0
            for i in range(size):
                number = numbers[i]
                sum_a += number * a[i]
                sum_b += number * b[i]
                sum_c += number * c[i]
                sum_d += number * d[i]
                sum_e += number * e[i]
                sum_f += number * f[i]
            answer[first, row], answer[first + 1, row], answer[first + 2, row] = sum_a, sum_b, sum_c
            answer[first + 3, row], answer[first + 4, row], answer[first + 5, row] = sum_d, sum_e, sum_f
        for column in range(grouped, count):
            vector = vectors[column]
            total = 0.0
            for i in range(size):
                total += numbers[i] * vector[i]
            answer[column, row] = total
