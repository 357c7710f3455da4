"""Compiled assembly of the Newton systems of many curves."""

from __future__ import annotations

from stickslip.contact.law.law import IndexArray
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray


@njit(cache=True, nogil=True, error_model="numpy")
def fill_systems(
    tangents: FloatArray,
    inputs: IndexArray,
    part: IndexArray,
    direction: IndexArray,
    mean: FloatArray,
    blocks: FloatArray,
    given: FloatArray,
    matrix: FloatArray,
    right: FloatArray,
) -> None:
    """Fill ``I + D A`` and ``D given`` of G curves, of which each has K rows.

    Parameters
    ----------
    tangents:
        (T, 3, W, 3, W) N/m, derivatives D of the deviations of the moving pairs of all curves.
    inputs:
        (G, k) position in ``tangents`` of the moving pairs of a curve.
    part, direction:
        (G, K) the pair among these k, and the direction, of each row on which the deviation can change.
    mean, blocks:
        (G, 3 k, K) and (G, 2H, 3 k, K) m/N: compliance of the moving pairs under forces in these rows, on the mean, and
        its real and imaginary parts of each harmonic.
    given:
        (G, 3 k, W, 2) m, two relative displacements.
    matrix:
        (G, W K + 1, W K + 1), zero on entry; coefficient p of row r is row ``p K + r``. The last row and column remain.
    right:
        (G, W K + 1, 2) filled with ``D given``.
    """
    n_rows, width = part.shape[1], tangents.shape[2]
    for b in range(len(part)):
        for r in range(n_rows):
            i, t, a = 3 * part[b, r], inputs[b, part[b, r]], direction[b, r]
            for p in range(width):
                row = matrix[b, p * n_rows + r]
                first = second = 0.0
                for c in range(3):
                    derivative = tangents[t, a, p, c]
                    for q in range(width):
                        first += derivative[q] * given[b, i + c, q, 0]
                        second += derivative[q] * given[b, i + c, q, 1]
                    of_mean = mean[b, i + c]
                    for s in range(n_rows):
                        row[s] += derivative[0] * of_mean[s]
                    # Complex amplitudes are c - i s: x_c = a d_c + b d_s and x_s = a d_s - b d_c for A = a + i b.
                    for h in range(width // 2):
                        cosine, sine = derivative[2 * h + 1], derivative[2 * h + 2]
                        real, imaginary = blocks[b, 2 * h, i + c], blocks[b, 2 * h + 1, i + c]
                        by_cosine = row[(2 * h + 1) * n_rows : (2 * h + 2) * n_rows]
                        by_sine = row[(2 * h + 2) * n_rows : (2 * h + 3) * n_rows]
                        for s in range(n_rows):
                            by_cosine[s] += cosine * real[s] - sine * imaginary[s]
                            by_sine[s] += cosine * imaginary[s] + sine * real[s]
                row[p * n_rows + r] += 1.0
                right[b, p * n_rows + r, 0], right[b, p * n_rows + r, 1] = first, second
