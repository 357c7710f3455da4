"""Exact derivative of the periodic friction force: forward mode through the march, closed by a 2 x 2 solve."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.coulomb_events import NO_ONSET, event_jacobian, onset_before_lift_off_jacobian
from stickslip.contact.law.coulomb_kernel import (
    OPEN,
    SLIP,
    STICK,
    Index,
    elastic_step,
    slip_jacobian,
    stick_jacobian,
)
from stickslip.contact.law.coulomb_period import CYCLES, Motion, start_force, start_jacobian, sticks_throughout
from stickslip.contact.law.coulomb_series import Springs, fill_path
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

IndexArray = NDArray[np.int64]

# Two cycles are the same if the force at their start differs by less than this fraction, round-off.
SAME_CYCLE = 1e-11


class Basis(NamedTuple):
    """Sampled Fourier basis, width = 2 H + 1: synthesis and analysis (n, width), and running sums over the samples.

    ``waves`` (width, n) are the synthesis in another order.
    ``weights[j]`` (n + 1, width) sums the analysis of the samples before j, ``products[j]`` (n + 1, width, width) its
    products with the synthesis: what a linear law gives over any run of samples. ``ramps`` (n + 1, width) does so for a
    drift that grows from 0 to 1 over the period, which takes the place of the mean.
    """

    waves: FloatArray
    synthesis: FloatArray
    analysis: FloatArray
    weights: FloatArray
    products: FloatArray
    ramps: FloatArray


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
    synthesis, weights, products, ramps = basis.synthesis, basis.weights, basis.products, basis.ramps
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
            if q == 0:
                product = ramps[last + 1, p] - ramps[anchor + 1, p] - weight * anchor / n
                if last <= anchor:  # the end of the period, where the drift is 1, is the sample 0
                    product += ramps[n, p] + basis.analysis[0, p]
            coefficients[p, 0, q] += scale[0] * product
            coefficients[p, 1, width + q] += scale[1] * product
    for q in range(width):
        change = synthesis[last, q] - synthesis[anchor, q]
        if q == 0:
            change = ((last - anchor) if last > anchor else (n + last - anchor)) / n
        derivative[0, q] += scale[0] * change
        derivative[1, width + q] += scale[1] * change


@njit(cache=True, nogil=True, error_model="numpy")
def march_tangent(
    motion: Motion,
    t1: float,
    t2: float,
    basis: Basis,
    scale: FloatArray,
    limit_slope: FloatArray,
    derivative: FloatArray,
    coefficients: FloatArray,
) -> tuple[float, float]:
    """March one period from sample 0 with the derivatives of the force; returns the force at the end.

    ``derivative`` (2, 3 * width + 2), width = 2 H + 1: by the coefficients of t1, t2, n and, last, by the two
    components of the start; the start's on entry, the end's on return. ``scale`` = (k1, k2), and ``limit_slope`` (n,)
    N/m is the derivative of the limit at a sample by the closing there.
    ``coefficients`` (width, 2, 3 * width + 2) gathers its Fourier analysis, with the corrections of events; an empty
    array (0, 2, 3 * width + 2) gathers nothing.
    """
    path, limit, ratio1, ratio2, tractrix = motion.path, motion.limit, motion.ratio1, motion.ratio2, motion.tractrix
    n = limit.shape[0]
    columns, width = derivative.shape[1], coefficients.shape[0]
    # Samples that neither stick nor are open, for one matrix product at the end.
    slip_derivatives = np.empty((n if width else 0, 2, columns))
    slip_weights = np.empty((n if width else 0, width))
    count = 0
    jacobian, local = np.zeros((2, 6)), np.zeros((3, 6))
    anchor = np.int64(-1)
    for step in range(1, n + 1):
        i, j = np.int64(step - 1), np.int64(step % n)
        d1, d2 = path[0, step] - path[0, i], path[1, step] - path[1, i]
        new1, new2, code = elastic_step(t1, t2, d1, d2, limit[i], limit[j])
        if code == STICK and limit[i] > 0.0:
            if anchor < 0:
                anchor = i
        else:
            if anchor >= 0:
                gather_stick(basis, anchor, i, scale, derivative, coefficients)
                anchor = np.int64(-1)
            if code == SLIP:
                new1, new2 = slip_jacobian(
                    t1, t2, d1, d2, limit[i], limit[j], ratio1, ratio2, tractrix, jacobian
                )  # fmt: skip
            elif code == STICK:
                stick_jacobian(d1, d2, limit[i], limit[j], jacobian)
            if width:
                theta, c1, c2 = event_jacobian(t1, t2, d1, d2, limit[i], limit[j], new1, new2, code, jacobian, local)
                if theta > 0.0:
                    gather_event(basis, i, j, theta, c1, c2, local, scale, limit_slope, derivative, coefficients)
            if code == OPEN:
                if width and limit[i] > 0.0:
                    place, c1, c2 = onset_before_lift_off_jacobian(t1, t2, d1, d2, limit[i], limit[j], local)
                    if place != NO_ONSET:
                        gather_event(basis, i, j, place, c1, c2, local, scale, limit_slope, derivative, coefficients)
                derivative[:] = 0.0
            else:
                carry(basis, i, j, scale, limit_slope, jacobian, derivative)
                if width:
                    store_sample(basis, j, derivative, slip_derivatives[count], slip_weights[count])
                    count += 1
        t1, t2 = new1, new2
    if anchor >= 0:
        gather_stick(basis, anchor, np.int64(0), scale, derivative, coefficients)
    if count:
        flat = slip_derivatives[:count].reshape(count, 2 * columns)
        product = np.dot(slip_weights[:count].T, flat)
        for p in range(width):
            for row in range(2):
                for c in range(columns):
                    coefficients[p, row, c] += product[p, row * columns + c]
    return t1, t2


@njit(cache=True, nogil=True, error_model="numpy")
def gather_event(
    basis: Basis,
    i: Index,
    j: Index,
    theta: float,
    c1: float,
    c2: float,
    local: FloatArray,
    scale: FloatArray,
    limit_slope: FloatArray,
    derivative: FloatArray,
    coefficients: FloatArray,
) -> None:
    """Gather the correction (c1, c2) of an event in the step from sample ``i`` to sample ``j``.

    It counts at its instant between the two; ``local`` is that of :func:`event_jacobian`.
    """
    synthesis, analysis = basis.synthesis, basis.analysis
    width, columns = synthesis.shape[1], derivative.shape[1]
    rows = np.empty((3, columns))
    for k in range(3):
        for c in range(columns):
            rows[k, c] = local[k, 0] * derivative[0, c] + local[k, 1] * derivative[1, c]
        for axis in range(2):
            factor = local[k, 2 + axis] * scale[axis]
            rows[k, axis * width] += factor / synthesis.shape[0]
            for q in range(1, width):
                rows[k, axis * width + q] += factor * (synthesis[j, q] - synthesis[i, q])
        before, after = local[k, 4] * limit_slope[i], local[k, 5] * limit_slope[j]
        for q in range(width):
            rows[k, 2 * width + q] += after * synthesis[j, q] + before * synthesis[i, q]
    for p in range(width):
        place = (1.0 - theta) * analysis[i, p] + theta * analysis[j, p]
        slope = analysis[j, p] - analysis[i, p]
        for c in range(columns):
            coefficients[p, 0, c] += place * rows[0, c] + slope * c1 * rows[2, c]
            coefficients[p, 1, c] += place * rows[1, c] + slope * c2 * rows[2, c]


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
    basis: Basis,
    previous: Index,
    j: Index,
    scale: FloatArray,
    limit_slope: FloatArray,
    jacobian: FloatArray,
    derivative: FloatArray,
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
            derivative[row, axis * width] += factor / synthesis.shape[0]
            for q in range(1, width):
                derivative[row, axis * width + q] += factor * (synthesis[j, q] - synthesis[previous, q])
        before, after = jacobian[row, 4] * limit_slope[previous], jacobian[row, 5] * limit_slope[j]
        for q in range(width):
            derivative[row, 2 * width + q] += after * synthesis[j, q] + before * synthesis[previous, q]


@njit(cache=True, nogil=True, error_model="numpy")
def creeping_tangent(
    motion: Motion,
    t1: float,
    t2: float,
    basis: Basis,
    scale: FloatArray,
    limit_slope: FloatArray,
    released: bool,
    ends: FloatArray,
    tangent: FloatArray,
) -> None:
    """Fill ``tangent`` (2, width, 3 * width) where the period after the cycles is not their last one again.

    A pair that has shaken down still creeps by 1 / C a cycle, which can decide whether a sample slips. The period
    starts with (t1, t2), whose derivatives are ``ends`` (2, 3 * width), and does not contain the creep itself.
    """
    n, width = basis.synthesis.shape
    derivative, fourier = ends.copy(), np.zeros((width, 2, 3 * width))
    for c in (0, width):
        for row in range(2):
            derivative[row, c] *= CYCLES  # by the drift of one cycle
    march_tangent(motion, t1, t2, basis, scale, limit_slope, derivative, fourier)
    for c in range(3 * width):
        share = 1.0
        if c == 0 or c == width:
            share = 0.0 if released else 1.0 / CYCLES
        for row in range(2):
            creep = share * derivative[row, c] - ends[row, c]
            for p in range(width):
                creeping = basis.weights[n, p] + basis.ramps[n, p] + basis.analysis[0, p]
                tangent[row, p, c] = share * fourier[p, row, c] - creep * creeping


@njit(cache=True, nogil=True, error_model="numpy")
def pair_tangent(
    motion: Motion,
    basis: Basis,
    scale: FloatArray,
    limit_slope: FloatArray,
    released: bool,
    start: FloatArray,
    tangent: FloatArray,
) -> None:
    """Fill ``tangent`` (2, width, 3 * width): derivative of the tangential force coefficients after the cycles.

    ``start`` (4,) is y and P of :func:`stickslip.contact.law.coulomb_period.settle_pairs` for this motion. The last
    cycle starts with the force T(y, l) at a limit l and ends with P; with b the derivative of P by the motion at fixed
    T, and Phi that by T, ``y = a + C (P - y)`` gives ``(I + C (I - Phi T_y)) dy = da + C (b + Phi T_l dl)``. The period
    after it starts with P. Only if both are the same, the analysis of the last cycle is that of the period.
    """
    width = basis.synthesis.shape[1]
    columns = 3 * width + 2
    derivative = np.zeros((2, columns))
    derivative[0, columns - 2] = derivative[1, columns - 1] = 1.0
    creeps = math.hypot(start[2] - start[0], start[3] - start[1]) > SAME_CYCLE * math.hypot(start[2], start[3])
    gathered = 0 if creeps else width
    fourier = np.zeros((gathered, 2, columns))
    t1, t2 = start_force(motion, start[0], start[1])
    march_tangent(motion, t1, t2, basis, scale, limit_slope, derivative, fourier)
    r11, r12, r21, r22, l1, l2 = start_jacobian(motion, start[0], start[1])
    p11, p12 = derivative[0, columns - 2], derivative[0, columns - 1]
    p21, p22 = derivative[1, columns - 2], derivative[1, columns - 1]
    s11, s12, s21, s22 = p11 * r11 + p12 * r21, p11 * r12 + p12 * r22, p21 * r11 + p22 * r21, p21 * r12 + p22 * r22
    j11, j12, j21, j22 = 1.0 + CYCLES * (1.0 - s11), -CYCLES * s12, -CYCLES * s21, 1.0 + CYCLES * (1.0 - s22)
    determinant = j11 * j22 - j12 * j21
    ends = np.empty((2, columns - 2))
    # The columns of the tangential means are those of the drift in one of the cycles that reached them.
    for c in (0, width):
        share = 0.0 if released else 1.0 / CYCLES
        for row in range(2):
            derivative[row, c] *= share
            for p in range(gathered):
                fourier[p, row, c] *= share
    for c in range(columns - 2):
        b1, b2 = derivative[0, c], derivative[1, c]
        a1, a2 = 0.0, 0.0  # of the slider at its initial position: the path at sample 0, released without its mean
        if c < width:
            a1 = scale[0] * basis.synthesis[0, c] if c > 0 else 0.0
        elif c < 2 * width:
            a2 = scale[1] * basis.synthesis[0, c - width] if c > width else 0.0
        else:
            by_limit = limit_slope[0] * basis.synthesis[0, c - 2 * width]
            b1 += (p11 * l1 + p12 * l2) * by_limit
            b2 += (p21 * l1 + p22 * l2) * by_limit
        y1, y2 = a1 + CYCLES * b1, a2 + CYCLES * b2
        y1, y2 = (j22 * y1 - j12 * y2) / determinant, (j11 * y2 - j21 * y1) / determinant
        ends[0, c], ends[1, c] = b1 + s11 * y1 + s12 * y2, b2 + s21 * y1 + s22 * y2
        for row in range(2):
            for p in range(gathered):
                by1, by2 = fourier[p, row, columns - 2], fourier[p, row, columns - 1]
                tangent[row, p, c] = fourier[p, row, c] + by1 * ends[0, c] + by2 * ends[1, c]
    if creeps:
        creeping_tangent(motion, start[2], start[3], basis, scale, limit_slope, released, ends, tangent)


@njit(cache=True, nogil=True, error_model="numpy")
def traction_tangents(
    displacements: FloatArray,
    limits: FloatArray,
    springs: Springs,
    limit_slopes: FloatArray,
    tractrix: bool,
    released: bool,
    basis: Basis,
    starts: FloatArray,
    chosen: IndexArray,
    tangents: FloatArray,
    start: int,
    stop: int,
) -> None:
    """Fill the derivatives of T1 and T2 of the ``chosen`` pairs ``start`` to ``stop``.

    ``tangents`` (k, 3, width, 3, width) of all that are chosen are zero on entry.
    ``limit_slopes`` (n_pairs, n) N/m are the derivatives of the ``limits`` (n_pairs, n) by the closing at each sample.
    """
    n, width = basis.synthesis.shape
    tangential, path = np.empty((2, width, 3 * width)), np.empty((2, n + 1))
    for k in range(start, stop):
        pair, tangent = chosen[k], tangents[k]
        ratio1, ratio2, scale = springs.ratios[pair, 0], springs.ratios[pair, 1], springs.stiffness[pair]
        mean1, mean2 = fill_path(displacements[pair], springs, pair, released, basis.waves, path)
        motion = Motion(path, mean1, mean2, limits[pair], ratio1, ratio2, tractrix)
        if sticks_throughout(motion):
            for q in range(1 if released else 0, width):
                tangent[0, q, 0, q] = scale[0]
                tangent[1, q, 1, q] = scale[1]
            continue
        pair_tangent(motion, basis, scale, limit_slopes[pair], released, starts[pair], tangential)
        for row in range(2):
            for p in range(width):
                for by in range(3):
                    for q in range(width):
                        tangent[row, p, by, q] = tangential[row, p, by * width + q]
