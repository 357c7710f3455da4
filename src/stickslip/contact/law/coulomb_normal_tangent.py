"""Exact derivative of the normal force of pairs with springs that separate."""

from __future__ import annotations

from stickslip.contact.law.coulomb_tangent import Basis, IndexArray
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray


@njit(cache=True, nogil=True, error_model="numpy")
def normal_tangent(limit: FloatArray, normal_stiffness: float, basis: Basis, tangent: FloatArray) -> None:
    """Fill ``tangent`` (width, width): normal force coefficients by those of n; ``k_n`` acts while the limit is > 0."""
    n, width = basis.synthesis.shape
    tangent[:] = 0.0
    start = 0
    while start < n:
        if limit[start] <= 0.0:
            start += 1
            continue
        end = start + 1
        while end < n and limit[end] > 0.0:
            end += 1
        if end - start == n:
            for p in range(width):
                tangent[p, p] = normal_stiffness
            return
        for p in range(width):
            for q in range(width):
                tangent[p, q] += normal_stiffness * (basis.products[end, p, q] - basis.products[start, p, q])
        start = end
    for j in range(n):
        i = j - 1 if j > 0 else n - 1
        if (limit[i] > 0.0) != (limit[j] > 0.0):
            gather_opening(basis, i, j, limit[i], limit[j], normal_stiffness, tangent)


@njit(cache=True, nogil=True, error_model="numpy")
def gather_opening(
    basis: Basis, i: int, j: int, first: float, last: float, normal_stiffness: float, tangent: FloatArray
) -> None:
    """Add the correction of the normal force where its limit passes zero between the samples ``i`` and ``j``.

    ``first last / (2 |first - last|)``, at the instant of the passage (:func:`corrected_limit`).
    """
    square = (first - last) ** 2
    theta, value = first / (first - last), 0.5 * first * last / abs(first - last)
    sign = 0.5 if first < last else -0.5
    by_first, by_last = sign * last * last / square, -sign * first * first / square
    turn_first, turn_last = -last / square, first / square
    for p in range(tangent.shape[0]):
        place = (1.0 - theta) * basis.analysis[i, p] + theta * basis.analysis[j, p]
        slope = (basis.analysis[j, p] - basis.analysis[i, p]) * value
        for q in range(tangent.shape[1]):
            change = (place * by_first + slope * turn_first) * basis.synthesis[i, q]
            change += (place * by_last + slope * turn_last) * basis.synthesis[j, q]
            tangent[p, q] += normal_stiffness * change


@njit(cache=True, nogil=True, error_model="numpy")
def normal_tangents(
    limits: FloatArray,
    normal_stiffness: FloatArray,
    basis: Basis,
    chosen: IndexArray,
    tangents: FloatArray,
) -> None:
    """Fill the derivative of N by n of the ``chosen`` pairs in ``tangents`` (k, 3, 2H+1, 3, 2H+1)."""
    for k in range(len(chosen)):
        normal_tangent(limits[chosen[k]], normal_stiffness[chosen[k]], basis, tangents[k, 2, :, 2, :])
