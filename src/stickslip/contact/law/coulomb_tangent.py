"""Exact derivative of the periodic friction force: forward mode through the march, closed by a 2 x 2 solve."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stickslip.contact.law.coulomb_kernel import (
    OPEN,
    SLIP,
    STICK,
    Index,
    advance,
    associated_return,
    return_jacobian,
    slip_jacobian,
    stick_jacobian,
)
from stickslip.contact.law.coulomb_period import Motion, start_of_path, sticks_throughout
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

# |det(I - Phi)| below which the transient, not the fixed point, gives the start of the period: round-off of a rank 1
# matrix is far below.
SINGULAR = 1e-9
# A pair that shakes down to the limit at two samples creeps there: touching both determines its state. Where it sticks
# within this fraction of the limit, after slip in earlier cycles, the touch counts as slip in the derivative.
TOUCH = 1e-8


class Basis(NamedTuple):
    """Sampled Fourier basis, width = 2 H + 1: synthesis and analysis (n, width), and running sums over the samples.

    ``weights[j]`` (n + 1, width) sums the analysis of the samples before j, ``products[j]`` (n + 1, width, width) its
    products with the synthesis: what a linear law gives over any run of samples.
    """

    synthesis: FloatArray
    analysis: FloatArray
    weights: FloatArray
    products: FloatArray


@njit(cache=True, nogil=True, error_model="numpy")
def gather_stick(
    basis: Basis,
    anchor: Index,
    last: Index,
    scale: FloatArray,
    derivative: FloatArray,
    coefficients: FloatArray,
) -> None:
    """Gather the samples after ``anchor`` to ``last`` of a pair that sticks, and carry ``derivative`` along.

    There the derivative is that at the anchor plus ``k (synthesis[j] - synthesis[anchor])``, so its Fourier analysis
    follows from running sums. ``last <= anchor`` runs through the end of the period; no ``coefficients``, no gathering.
    """
    synthesis, weights, products = basis.synthesis, basis.weights, basis.products
    n, width = synthesis.shape
    for p in range(coefficients.shape[0]):
        weight = weights[last + 1, p] - weights[anchor + 1, p]
        if last <= anchor:
            weight += weights[n, p]
        for row in range(2):
            for c in range(derivative.shape[1]):
                coefficients[p, row, c] += weight * derivative[row, c]
        for q in range(width):
            product = products[last + 1, p, q] - products[anchor + 1, p, q]
            if last <= anchor:
                product += products[n, p, q]
            product -= weight * synthesis[anchor, q]
            coefficients[p, 0, q] += scale[0] * product
            coefficients[p, 1, width + q] += scale[1] * product
    for q in range(width):
        change = synthesis[last, q] - synthesis[anchor, q]
        derivative[0, q] += scale[0] * change
        derivative[1, width + q] += scale[1] * change


@njit(cache=True, nogil=True, error_model="numpy")
def march_tangent(
    motion: Motion,
    first: Index,
    t1: float,
    t2: float,
    basis: Basis,
    scale: FloatArray,
    touching: bool,
    derivative: FloatArray,
    coefficients: FloatArray,
) -> tuple[float, float]:
    """March one period with the derivatives of the force; returns its end. ``touching``: see TOUCH.

    ``derivative`` (2, 3 * width + 2), width = 2 H + 1: by the coefficients of t1, t2, n and, last, by the two
    components of the start; the start's on entry, the end's on return. ``scale`` = (k1, k2, mu kn).
    ``coefficients`` (width, 2, 3 * width + 2) gathers its Fourier analysis; an empty array asks for none.
    """
    path, limit, ratio1, ratio2, tractrix = motion.path, motion.limit, motion.ratio1, motion.ratio2, motion.tractrix
    n = limit.shape[0]
    columns = derivative.shape[1]
    gather = coefficients.shape[0]
    # Samples that neither stick nor are open, for one matrix product at the end.
    slip_derivatives = np.empty((n if gather else 0, 2, columns))
    slip_weights = np.empty((n if gather else 0, gather))
    count = 0
    jacobian = np.zeros((2, 6))
    previous, anchor = first, np.int64(-1)
    for step in range(1, n + 1):
        j = first + step
        if j >= n:
            j -= n
        d1, d2 = path[0, j] - path[0, previous], path[1, j] - path[1, previous]
        new1, new2, code = advance(t1, t2, d1, d2, limit[previous], limit[j], ratio1, ratio2, tractrix)
        if code == STICK and touching and math.hypot(new1, new2) > limit[j] * (1.0 - TOUCH):
            code = SLIP
        if code == STICK and limit[previous] > 0.0:
            if anchor < 0:
                anchor = np.int64(previous)
        else:
            if anchor >= 0:
                gather_stick(basis, anchor, previous, scale, derivative, coefficients)
                anchor = np.int64(-1)
            if code == OPEN:
                derivative[:] = 0.0
            else:
                if code == SLIP:
                    slip_jacobian(
                        t1, t2, d1, d2, limit[previous], limit[j],
                        new1, new2, ratio1, ratio2, tractrix, jacobian,
                    )  # fmt: skip
                else:
                    stick_jacobian(d1, d2, limit[previous], limit[j], jacobian)
                carry(basis, previous, j, scale, jacobian, derivative)
                if gather:
                    store_sample(basis, j, derivative, slip_derivatives[count], slip_weights[count])
                    count += 1
        t1, t2, previous = new1, new2, j
    if anchor >= 0:
        gather_stick(basis, anchor, previous, scale, derivative, coefficients)
    if count:
        flat = slip_derivatives[:count].reshape(count, 2 * columns)
        product = np.dot(slip_weights[:count].T, flat)
        for p in range(gather):
            for row in range(2):
                for c in range(columns):
                    coefficients[p, row, c] += product[p, row * columns + c]
    return t1, t2


@njit(cache=True, nogil=True, error_model="numpy")
def store_sample(
    basis: Basis, j: Index, derivative: FloatArray, slip_derivatives: FloatArray, slip_weights: FloatArray
) -> None:
    """Copy ``derivative`` (2, columns) and the analysis weights of sample ``j``; loops compile quicker than slices."""
    for row in range(2):
        for c in range(derivative.shape[1]):
            slip_derivatives[row, c] = derivative[row, c]
    for p in range(slip_weights.shape[0]):
        slip_weights[p] = basis.analysis[j, p]


@njit(cache=True, nogil=True, error_model="numpy")
def carry(
    basis: Basis, previous: Index, j: Index, scale: FloatArray, jacobian: FloatArray, derivative: FloatArray
) -> None:
    """Carry ``derivative`` over a step with ``jacobian`` (2, 6) from sample ``previous`` to sample ``j``."""
    synthesis = basis.synthesis
    width = synthesis.shape[1]
    a11, a12, a21, a22 = jacobian[0, 0], jacobian[0, 1], jacobian[1, 0], jacobian[1, 1]
    for c in range(derivative.shape[1]):
        old1, old2 = derivative[0, c], derivative[1, c]
        derivative[0, c] = a11 * old1 + a12 * old2
        derivative[1, c] = a21 * old1 + a22 * old2
    for row in range(2):
        for axis in range(2):
            factor = jacobian[row, 2 + axis] * scale[axis]
            for q in range(width):
                derivative[row, axis * width + q] += factor * (synthesis[j, q] - synthesis[previous, q])
        before, after = jacobian[row, 4] * scale[2], jacobian[row, 5] * scale[2]
        for q in range(width):
            derivative[row, 2 * width + q] += after * synthesis[j, q] + before * synthesis[previous, q]


@njit(cache=True, nogil=True, error_model="numpy")
def transient_start_derivative(
    motion: Motion,
    plain: Index,
    basis: Basis,
    scale: FloatArray,
    released: bool,
    derivative: FloatArray,
) -> None:
    """Fill ``derivative`` with the derivative of the force after ``plain`` cycles from the start of the path.

    A ``released`` path does not depend on the mean displacement, a path relative to rest does.
    """
    path, limit, ratio1, ratio2 = motion.path, motion.limit, motion.ratio1, motion.ratio2
    synthesis = basis.synthesis
    width = synthesis.shape[1]
    derivative[:] = 0.0
    for q in range(1 if released else 0, width):
        derivative[0, q] = scale[0] * synthesis[0, q]
        derivative[1, width + q] = scale[1] * synthesis[0, q]
    t1, t2 = start_of_path(path, limit[0], ratio1, ratio2)
    if math.hypot(path[0, 0], path[1, 0]) > limit[0]:
        _, _, x = associated_return(path[0, 0], path[1, 0], limit[0], ratio1, ratio2)
        r11, r12, r21, r22, l1, l2 = return_jacobian(t1, t2, x, limit[0], ratio1, ratio2)
        for c in range(2 * width):
            old1, old2 = derivative[0, c], derivative[1, c]
            derivative[0, c], derivative[1, c] = r11 * old1 + r12 * old2, r21 * old1 + r22 * old2
        for q in range(width):
            derivative[0, 2 * width + q] = l1 * scale[2] * synthesis[0, q]
            derivative[1, 2 * width + q] = l2 * scale[2] * synthesis[0, q]
    nothing = np.zeros((0, 2, derivative.shape[1]))
    for _ in range(plain):
        t1, t2 = march_tangent(motion, np.int64(0), t1, t2, basis, scale, False, derivative, nothing)


@njit(cache=True, nogil=True, error_model="numpy")
def pair_tangent(
    motion: Motion,
    basis: Basis,
    scale: FloatArray,
    released: bool,
    period_start: FloatArray,
    tangent: FloatArray,
) -> None:
    """Fill ``tangent`` (2, width, 3 * width): derivative of the tangential force coefficients of the periodic state.

    ``period_start`` (4,) is the result of :func:`stickslip.contact.law.coulomb_period.settle_pairs` for this motion.

    With b the derivative of the period's end at fixed start and Phi that by the start, the start of the periodic state
    moves by D = (I - Phi)^-1 b; where I - Phi is singular (no slip in the period), D is that of the transient.
    """
    width = basis.synthesis.shape[1]
    columns = 3 * width + 2
    first, plain = np.int64(period_start[0]), np.int64(period_start[3])
    derivative = np.zeros((2, columns))
    derivative[0, columns - 2] = derivative[1, columns - 1] = 1.0
    fourier = np.zeros((width, 2, columns))
    march_tangent(motion, first, period_start[1], period_start[2], basis, scale, bool(plain > 0), derivative, fourier)
    start = np.zeros((2, columns - 2))
    if motion.limit[first] > 0.0:
        b11, b12 = 1.0 - derivative[0, columns - 2], -derivative[0, columns - 1]
        b21, b22 = -derivative[1, columns - 2], 1.0 - derivative[1, columns - 1]
        determinant = b11 * b22 - b12 * b21
        size = b11 * b11 + b12 * b12 + b21 * b21 + b22 * b22
        if abs(determinant) > SINGULAR:
            for c in range(columns - 2):
                start[0, c] = (b22 * derivative[0, c] - b12 * derivative[1, c]) / determinant
                start[1, c] = (b11 * derivative[1, c] - b21 * derivative[0, c]) / determinant
        else:
            left = np.zeros((2, columns))
            transient_start_derivative(motion, plain, basis, scale, released, left)
            for c in range(columns - 2):
                start[0, c], start[1, c] = left[0, c], left[1, c]
                if size > 0.0:
                    # I - Phi has rank 1 here: its pseudo-inverse is its transpose over the square of its norm.
                    r1 = derivative[0, c] - b11 * left[0, c] - b12 * left[1, c]
                    r2 = derivative[1, c] - b21 * left[0, c] - b22 * left[1, c]
                    start[0, c] += (b11 * r1 + b21 * r2) / size
                    start[1, c] += (b12 * r1 + b22 * r2) / size
    for row in range(2):
        for p in range(width):
            by1, by2 = fourier[p, row, columns - 2], fourier[p, row, columns - 1]
            for c in range(columns - 2):
                tangent[row, p, c] = fourier[p, row, c] + by1 * start[0, c] + by2 * start[1, c]


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


@njit(cache=True, nogil=True, error_model="numpy")
def tangent_pairs(
    paths: FloatArray,
    limits: FloatArray,
    ratios: FloatArray,
    scales: FloatArray,
    normal_stiffness: FloatArray,
    tractrix: bool,
    released: bool,
    basis: Basis,
    starts: FloatArray,
    tangents: FloatArray,
) -> None:
    """Fill ``tangents`` (n_pairs, 3, width, 3, width), zero on entry, with the derivatives of T1, T2 and N."""
    width = basis.synthesis.shape[1]
    tangential = np.empty((2, width, 3 * width))
    for pair in range(limits.shape[0]):
        normal_tangent(limits[pair], normal_stiffness[pair], basis, tangents[pair, 2, :, 2, :])
        if sticks_throughout(paths[pair], limits[pair]):
            for q in range(1 if released else 0, width):
                tangents[pair, 0, q, 0, q] = scales[pair, 0]
                tangents[pair, 1, q, 1, q] = scales[pair, 1]
            continue
        motion = Motion(paths[pair], limits[pair], ratios[pair, 0], ratios[pair, 1], tractrix)
        pair_tangent(motion, basis, scales[pair], released, starts[pair], tangential)
        for row in range(2):
            for p in range(width):
                for c in range(3 * width):
                    tangents[pair, row, p, c // width, c % width] = tangential[row, p, c]
