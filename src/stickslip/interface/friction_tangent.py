"""Exact derivative of the periodic friction force: forward mode through the march, closed by a 2 x 2 solve."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from stickslip.interface.friction_kernel import (
    OPEN,
    SLIP,
    STICK,
    advance,
    associated_return,
    return_jacobian,
    slip_jacobian,
    stick_jacobian,
)
from stickslip.interface.friction_period import Motion, released_start, settle, sticks_released
from stickslip.validation import FloatArray

# |det(I - Phi)| below which the start of the period is taken from the transient instead of the fixed point.
SINGULAR = 1e-9


@njit(cache=True, nogil=True, error_model="numpy")
def march_tangent(
    motion: Motion,
    first: int,
    t1: float,
    t2: float,
    synthesis: FloatArray,
    scale: FloatArray,
    analysis: FloatArray,
    derivative: FloatArray,
    coefficients: FloatArray,
) -> tuple[float, float]:
    """March one period with the derivatives of the force; returns its end.

    ``derivative`` (2, 3 * width + 2), width = 2 H + 1: by the coefficients of t1, t2, n and, last, by the two
    components of the start; the start's on entry, the end's on return. ``scale`` = (k1, k2, mu kn).
    ``coefficients`` (width, 2, 3 * width + 2) gathers its Fourier analysis; an empty array asks for none.
    """
    path, limit, ratio1, ratio2, tractrix = motion.path, motion.limit, motion.ratio1, motion.ratio2, motion.tractrix
    n, width = synthesis.shape
    columns = derivative.shape[1]
    gather = coefficients.shape[0]
    jacobian = np.zeros((2, 6))
    previous = first
    for step in range(1, n + 1):
        j = first + step
        if j >= n:
            j -= n
        d1, d2 = path[0, j] - path[0, previous], path[1, j] - path[1, previous]
        new1, new2, code = advance(t1, t2, d1, d2, limit[previous], limit[j], ratio1, ratio2, tractrix)
        if code == OPEN:
            derivative[:] = 0.0
        elif code == STICK and limit[previous] > 0.0:
            for q in range(width):
                change = synthesis[j, q] - synthesis[previous, q]
                derivative[0, q] += scale[0] * change
                derivative[1, width + q] += scale[1] * change
        else:
            if code == SLIP:
                slip_jacobian(
                    t1, t2, d1, d2, limit[previous], limit[j],
                    new1, new2, ratio1, ratio2, tractrix, jacobian,
                )  # fmt: skip
            else:
                stick_jacobian(d1, d2, limit[previous], limit[j], jacobian)
            a11, a12, a21, a22 = jacobian[0, 0], jacobian[0, 1], jacobian[1, 0], jacobian[1, 1]
            for c in range(columns):
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
        if code != OPEN:
            for p in range(gather):
                weight = analysis[j, p]
                for row in range(2):
                    for c in range(columns):
                        coefficients[p, row, c] += weight * derivative[row, c]
        t1, t2, previous = new1, new2, j
    return t1, t2


@njit(cache=True, nogil=True, error_model="numpy")
def transient_start_derivative(
    motion: Motion,
    plain: int,
    synthesis: FloatArray,
    scale: FloatArray,
    analysis: FloatArray,
    derivative: FloatArray,
) -> None:
    """Fill ``derivative`` with that of the force after ``plain`` cycles from the released start."""
    path, limit, ratio1, ratio2 = motion.path, motion.limit, motion.ratio1, motion.ratio2
    width = synthesis.shape[1]
    derivative[:] = 0.0
    derivative[0, 1:width] = scale[0] * synthesis[0, 1:]
    derivative[1, width + 1 : 2 * width] = scale[1] * synthesis[0, 1:]
    t1, t2 = released_start(path, limit[0], ratio1, ratio2)
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
        t1, t2 = march_tangent(motion, 0, t1, t2, synthesis, scale, analysis, derivative, nothing)


@njit(cache=True, nogil=True, error_model="numpy")
def pair_tangent(
    motion: Motion,
    synthesis: FloatArray,
    analysis: FloatArray,
    scale: FloatArray,
    tangent: FloatArray,
) -> None:
    """Fill ``tangent`` (2, width, 3 * width): derivative of the tangential force coefficients of the periodic state.

    With b the derivative of the period's end at fixed start and Phi that by the start, the start of the periodic state
    moves by D = (I - Phi)^-1 b; where I - Phi is singular (no slip in the period), D keeps what the transient left.
    """
    n, width = synthesis.shape
    columns = 3 * width + 2
    force = np.empty((2, n))
    mode = np.empty(n, dtype=np.int8)
    first, t1, t2, _, plain = settle(motion, force, mode)
    derivative = np.zeros((2, columns))
    derivative[0, columns - 2] = derivative[1, columns - 1] = 1.0
    gathered = np.zeros((width, 2, columns))
    march_tangent(motion, first, t1, t2, synthesis, scale, analysis, derivative, gathered)
    start = np.zeros((2, columns - 2))
    if mode[first] != OPEN:
        balance = np.eye(2) - derivative[:, columns - 2 :]
        load = np.ascontiguousarray(derivative[:, : columns - 2])
        if abs(balance[0, 0] * balance[1, 1] - balance[0, 1] * balance[1, 0]) > SINGULAR:
            start = np.linalg.solve(balance, load)
        else:
            transient_start_derivative(motion, plain, synthesis, scale, analysis, derivative)
            start = np.ascontiguousarray(derivative[:, : columns - 2])
            if balance.any():
                start += np.linalg.pinv(balance, SINGULAR) @ (load - balance @ start)
    for row in range(2):
        for p in range(width):
            by1, by2 = gathered[p, row, columns - 2], gathered[p, row, columns - 1]
            for c in range(columns - 2):
                tangent[row, p, c] = gathered[p, row, c] + by1 * start[0, c] + by2 * start[1, c]


@njit(cache=True, nogil=True, error_model="numpy")
def tangent_pairs(
    paths: FloatArray,
    limits: FloatArray,
    ratios: FloatArray,
    scales: FloatArray,
    tractrix: bool,
    synthesis: FloatArray,
    analysis: FloatArray,
    tangents: FloatArray,
) -> None:
    """Fill tangents (n_pairs, 2, width, 3 * width) of the tangential forces; ``analysis`` is (n, width)."""
    width = synthesis.shape[1]
    for pair in range(limits.shape[0]):
        if sticks_released(paths[pair], limits[pair]):
            tangents[pair] = 0.0
            for q in range(1, width):
                tangents[pair, 0, q, q] = scales[pair, 0]
                tangents[pair, 1, q, width + q] = scales[pair, 1]
            continue
        motion = Motion(paths[pair], limits[pair], ratios[pair, 0], ratios[pair, 1], tractrix)
        pair_tangent(motion, synthesis, analysis, scales[pair], tangents[pair])
