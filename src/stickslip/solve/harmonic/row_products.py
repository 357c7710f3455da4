"""Products of a few vectors with a large matrix, which is read from memory once.

The products of a linear algebra library copy such a matrix into another order first, which takes longer than the
product itself. Two rows of the matrix at a time use each number of the vectors twice, and up to seven vectors (the
coefficients of three harmonics) each number of the matrix. With 2970 rows and columns and seven vectors, a matrix of
single precision takes 5.4 ms and one of double precision 7.8 ms, on a crowded machine. The library takes 14 ms, and row
by row, six vectors and then the seventh, it is 15 ms.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.compiled import njit
from stickslip.core.threads import in_shares
from stickslip.core.validation import FloatArray

# chosen: rows of a product in one thread at a time.
ROWS_AT_ONCE = 128
# chosen: vectors for which each number of the matrix is read once; more need more registers than the processor has.
VECTORS = 7


def row_products(matrix: NDArray[Any], vectors: FloatArray) -> FloatArray:
    """``vectors @ matrix^T`` (c, m) for a matrix (m, k) and vectors (c, k).

    The matrix may have single precision. Sums have double precision, because an iteration with rounded products does
    not reach its tolerance.

    Rows are divided among the threads of :func:`stickslip.core.threads.solver_threads`; the digits do not depend on
    their number.
    """
    answer = np.empty((len(vectors), len(matrix)), dtype=float)
    if len(matrix) == 0:
        return answer
    for first in range(0, len(vectors), VECTORS):
        count = min(VECTORS, len(vectors) - first)
        # Products with zeros take no more time than a loop over the vectors, which does not keep its sums in registers.
        given = np.zeros((1 if count == 1 else VECTORS, vectors.shape[1]))
        given[:count] = vectors[first : first + count]
        part = np.empty((len(given), len(matrix)))
        multiply = _multiply_one if count == 1 else _multiply
        in_shares(_of_rows(multiply, matrix, given, part), len(matrix), ROWS_AT_ONCE)
        answer[first : first + count] = part[:count]
    return answer


def _of_rows(multiply: Any, *arrays: NDArray[Any]) -> Callable[[int, int], None]:
    """The work of a share of rows."""
    return lambda start, stop: multiply(*arrays, start, stop)


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _multiply_one(matrix: NDArray[Any], vectors: FloatArray, answer: FloatArray, start: int, stop: int) -> None:
    """:func:`row_products` of one vector in the rows ``start`` to ``stop`` of the matrix."""
    vector = vectors[0]
    for row in range(start, stop):
        numbers, total = matrix[row], 0.0
        for i in range(vector.size):
            total += numbers[i] * vector[i]
        answer[0, row] = total


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _multiply(matrix: NDArray[Any], vectors: FloatArray, answer: FloatArray, start: int, stop: int) -> None:
    """:func:`row_products` of VECTORS vectors in the rows ``start`` to ``stop`` of the matrix.

    The last row of an odd number is one pair with itself.
    """
    a, b, c, d, e, f, g = vectors[0], vectors[1], vectors[2], vectors[3], vectors[4], vectors[5], vectors[6]
    for row in range(start, stop, 2):
        other = min(row + 1, stop - 1)
        first, second = matrix[row], matrix[other]
        a_1 = b_1 = c_1 = d_1 = e_1 = f_1 = g_1 = 0.0
        a_2 = b_2 = c_2 = d_2 = e_2 = f_2 = g_2 = 0.0
        for i in range(vectors.shape[1]):
            x, y = first[i], second[i]
            a_1 += x * a[i]
            b_1 += x * b[i]
            c_1 += x * c[i]
            d_1 += x * d[i]
            e_1 += x * e[i]
            f_1 += x * f[i]
            g_1 += x * g[i]
            a_2 += y * a[i]
            b_2 += y * b[i]
            c_2 += y * c[i]
            d_2 += y * d[i]
            e_2 += y * e[i]
            f_2 += y * f[i]
            g_2 += y * g[i]
        answer[0, row], answer[1, row], answer[2, row], answer[3, row] = a_1, b_1, c_1, d_1
        answer[4, row], answer[5, row], answer[6, row] = e_1, f_1, g_1
        answer[0, other], answer[1, other], answer[2, other], answer[3, other] = a_2, b_2, c_2, d_2
        answer[4, other], answer[5, other], answer[6, other] = e_2, f_2, g_2
