"""Products of a few vectors with a large matrix, which is read from memory once.

The products of a linear algebra library copy such a matrix into another order first, which takes longer than the
product itself. Four rows of the matrix at a time use each number of the vectors four times, and up to seven vectors
(the coefficients of three harmonics) each number of the matrix. With 2970 rows and columns and seven vectors, a matrix
of single precision takes 2.8 ms and one of double precision 4.4 ms (1.5 and 2.4 ms with two threads; two rows at a time
4.7 and 6.8 ms, the library 7 ms and more).

A symmetric matrix serves for products with few of its columns, which are rows of it (:func:`sums_of_rows`), without a
copy of these columns, which takes several times as long as the product.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.compiled import njit
from stickslip.core.threads import in_shares
from stickslip.core.validation import FloatArray

IndexArray = NDArray[np.int64]

# chosen: rows of a product in one thread at a time, and columns of a sum of rows, whose sums stay in the cache.
ROWS_AT_ONCE = 128
COLUMNS_AT_ONCE = 512
# chosen: numbers of a matrix for which one thread takes as long (80 us) as two threads need to begin and end together.
NUMBERS_AT_ONCE = 150_000
ROWS_TOGETHER = 4  # whose sums one pass over the vectors forms, see :func:`_multiply`
# chosen: vectors for which each number of the matrix is read once; more need more registers than the processor has.
VECTORS = 7


def row_products(matrix: NDArray[Any], vectors: FloatArray, rows: IndexArray | None = None) -> FloatArray:
    """``vectors @ matrix[rows]^T`` (c, r) for a matrix (m, k), vectors (c, k) and some rows (r,); None for all.

    The matrix may have single precision. Sums have double precision, because an iteration with rounded products does
    not reach its tolerance.

    Rows are divided among the threads of :func:`stickslip.core.threads.solver_threads`; the digits do not depend on
    their number.
    """
    chosen = np.arange(len(matrix)) if rows is None else rows
    answer = np.empty((len(vectors), len(chosen)), dtype=float)
    if len(chosen) == 0:
        return answer
    for part, given in _by_vectors(vectors, answer):
        multiply = _multiply_one if len(part) == 1 else _multiply
        work = np.empty((len(given), len(chosen)))
        in_shares(_shares(multiply, matrix, chosen, given, work), len(chosen), _rows_of_a_share(matrix.shape[1]))
        part[...] = work[: len(part)]
    return answer


def _rows_of_a_share(columns: int) -> int:
    """Rows of so many columns that a thread takes at a time: a multiple of those that are worked on together."""
    return max(ROWS_AT_ONCE, ROWS_TOGETHER * -(-NUMBERS_AT_ONCE // (ROWS_TOGETHER * max(columns, 1))))


def sums_of_rows(matrix: NDArray[Any], weights: FloatArray, rows: IndexArray) -> FloatArray:
    """``weights @ matrix[rows]`` (c, m) for a matrix (k, m), weights (c, r) and rows (r,), without a copy of the rows.

    Precision and threads as in :func:`row_products`. With half of all rows it takes as long as that with all.
    """
    answer = np.zeros((len(weights), matrix.shape[1]))
    if len(rows) == 0:
        return answer
    for part, given in _by_vectors(weights, answer, one=VECTORS):
        work = np.empty((VECTORS, matrix.shape[1]))
        in_shares(_shares(_add_rows, matrix, rows, given, work), matrix.shape[1], COLUMNS_AT_ONCE)
        part[...] = work[: len(part)]
    return answer


def _by_vectors(vectors: FloatArray, answer: FloatArray, one: int = 1) -> Iterator[tuple[FloatArray, FloatArray]]:
    """VECTORS rows of the answer at a time, and the vectors for them, with zeros beside them if there are fewer.

    Products with zeros take no more time than a loop over the vectors, which does not keep its sums in registers. A
    single vector has ``one`` row.
    """
    for first in range(0, len(vectors), VECTORS):
        count = min(VECTORS, len(vectors) - first)
        given = np.zeros((one if count == 1 else VECTORS, vectors.shape[1]))
        given[:count] = vectors[first : first + count]
        yield answer[first : first + count], given


def _shares(kernel: Any, *arrays: NDArray[Any]) -> Callable[[int, int], None]:
    """The work of a share of rows or columns."""
    return lambda start, stop: kernel(*arrays, start, stop)


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _multiply_one(
    matrix: NDArray[Any], rows: IndexArray, vectors: FloatArray, answer: FloatArray, start: int, stop: int
) -> None:
    """:func:`row_products` of one vector in the rows ``start`` to ``stop`` of the chosen ones."""
    vector = vectors[0]
    for row in range(start, stop):
        numbers, total = matrix[rows[row]], 0.0
        for i in range(vector.size):
            total += numbers[i] * vector[i]
        answer[0, row] = total


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _multiply(
    matrix: NDArray[Any], rows: IndexArray, vectors: FloatArray, answer: FloatArray, start: int, stop: int
) -> None:
    """:func:`row_products` of VECTORS vectors in the rows ``start`` to ``stop`` of the chosen ones.

    Where fewer than four are left, the last row stands for the missing ones.
    """
    a, b, c, d, e, f, g = vectors[0], vectors[1], vectors[2], vectors[3], vectors[4], vectors[5], vectors[6]
    for row in range(start, stop, ROWS_TOGETHER):
        last = stop - 1
        two, three, four = min(row + 1, last), min(row + 2, last), min(row + 3, last)
        row_1, row_2, row_3, row_4 = matrix[rows[row]], matrix[rows[two]], matrix[rows[three]], matrix[rows[four]]
        a_1 = b_1 = c_1 = d_1 = e_1 = f_1 = g_1 = 0.0
        a_2 = b_2 = c_2 = d_2 = e_2 = f_2 = g_2 = 0.0
        a_3 = b_3 = c_3 = d_3 = e_3 = f_3 = g_3 = 0.0
        a_4 = b_4 = c_4 = d_4 = e_4 = f_4 = g_4 = 0.0
        for i in range(vectors.shape[1]):
            w, x, y, z = row_1[i], row_2[i], row_3[i], row_4[i]
            a_1 += w * a[i]
            b_1 += w * b[i]
            c_1 += w * c[i]
            d_1 += w * d[i]
            e_1 += w * e[i]
            f_1 += w * f[i]
            g_1 += w * g[i]
            a_2 += x * a[i]
            b_2 += x * b[i]
            c_2 += x * c[i]
            d_2 += x * d[i]
            e_2 += x * e[i]
            f_2 += x * f[i]
            g_2 += x * g[i]
            a_3 += y * a[i]
            b_3 += y * b[i]
            c_3 += y * c[i]
            d_3 += y * d[i]
            e_3 += y * e[i]
            f_3 += y * f[i]
            g_3 += y * g[i]
            a_4 += z * a[i]
            b_4 += z * b[i]
            c_4 += z * c[i]
            d_4 += z * d[i]
            e_4 += z * e[i]
            f_4 += z * f[i]
            g_4 += z * g[i]
        answer[0, row], answer[1, row], answer[2, row], answer[3, row] = a_1, b_1, c_1, d_1
        answer[4, row], answer[5, row], answer[6, row] = e_1, f_1, g_1
        answer[0, two], answer[1, two], answer[2, two], answer[3, two] = a_2, b_2, c_2, d_2
        answer[4, two], answer[5, two], answer[6, two] = e_2, f_2, g_2
        answer[0, three], answer[1, three], answer[2, three], answer[3, three] = a_3, b_3, c_3, d_3
        answer[4, three], answer[5, three], answer[6, three] = e_3, f_3, g_3
        answer[0, four], answer[1, four], answer[2, four], answer[3, four] = a_4, b_4, c_4, d_4
        answer[4, four], answer[5, four], answer[6, four] = e_4, f_4, g_4


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _add_rows(
    matrix: NDArray[Any], rows: IndexArray, weights: FloatArray, answer: FloatArray, start: int, stop: int
) -> None:
    """:func:`sums_of_rows` of VECTORS vectors in the columns ``start`` to ``stop``; two rows at a time.

    The last row of an odd number has one of weight zero beside it.
    """
    count = len(rows)
    for begin in range(start, stop, COLUMNS_AT_ONCE):
        end = min(begin + COLUMNS_AT_ONCE, stop)
        answer[:, begin:end] = 0.0
        # slices of rows, which the compiler knows to be contiguous: half the time of rows of a slice
        a, b, c, d = answer[0, begin:end], answer[1, begin:end], answer[2, begin:end], answer[3, begin:end]
        e, f, g = answer[4, begin:end], answer[5, begin:end], answer[6, begin:end]
        for j in range(0, count, 2):
            other = min(j + 1, count - 1)
            first, second = matrix[rows[j], begin:end], matrix[rows[other], begin:end]
            v, w = weights[:, j], weights[:, other] if other > j else np.zeros(VECTORS)
            a_1, b_1, c_1, d_1, e_1, f_1, g_1 = v[0], v[1], v[2], v[3], v[4], v[5], v[6]
            a_2, b_2, c_2, d_2, e_2, f_2, g_2 = w[0], w[1], w[2], w[3], w[4], w[5], w[6]
            for i in range(end - begin):
                x, y = first[i], second[i]
                a[i] += x * a_1 + y * a_2
                b[i] += x * b_1 + y * b_2
                c[i] += x * c_1 + y * c_2
                d[i] += x * d_1 + y * d_2
                e[i] += x * e_1 + y * e_2
                f[i] += x * f_1 + y * f_2
                g[i] += x * g_1 + y * g_2
