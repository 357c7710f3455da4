"""Coulomb friction between the Fourier coefficients of the motion of a pair and those of its force, pair by pair.

Compiled, so that no array of all pairs and samples is written, and so that the digits of a pair do not depend on the
pairs beside it, nor on the threads that share them.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.coulomb_events import corrected_limit
from stickslip.contact.law.coulomb_kernel import CodeArray
from stickslip.contact.law.coulomb_period import CYCLES, Motion, settle_pair
from stickslip.core.compiled import njit
from stickslip.core.fourier import analysis_matrix, synthesis_matrix
from stickslip.core.validation import FloatArray

BoolArray = NDArray[np.bool_]

# Floor of a divisor: a pair that is never closed has no positive limit.
SMALLEST_LIMIT = 1e-300


class Series(NamedTuple):
    """Fourier series of so many samples: the wave of each coefficient, and the weights of its integral, (2H+1, n)."""

    waves: FloatArray
    weights: FloatArray


class Springs(NamedTuple):
    """Constants of friction, pair by pair: K (p, 2) N/m and over the larger one, T0 (p, 2) N, closed at rest (p,)."""

    stiffness: FloatArray
    ratios: FloatArray
    resting: FloatArray
    closed: BoolArray


class Tractions(NamedTuple):
    """What is filled, see :class:`stickslip.contact.law.coulomb_harmonics.HarmonicForce`."""

    force: FloatArray
    state: CodeArray
    deviates: BoolArray
    closure: FloatArray
    starts: FloatArray


@lru_cache(maxsize=32)
def series(harmonics: int, samples: int) -> Series:
    """The waves and weights of :mod:`stickslip.core.fourier`, which share their numbers with other calls."""
    return Series(
        np.ascontiguousarray(synthesis_matrix(harmonics, samples).T), analysis_matrix(harmonics, samples).copy()
    )


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract"})
def add_waves(coefficients: FloatArray, first: int, scale: float, waves: FloatArray, signal: FloatArray) -> None:
    """Add ``scale`` times the series of the coefficients from the ``first`` one to a signal (n,) or longer."""
    for q in range(first, waves.shape[0]):
        amplitude, wave = scale * coefficients[q], waves[q]
        for j in range(wave.shape[0]):
            signal[j] += amplitude * wave[j]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract"})
def integrate(signal: FloatArray, weights: FloatArray, coefficients: FloatArray) -> None:
    """Fill the coefficients of a signal (n,)."""
    for p in range(weights.shape[0]):
        weight, total = weights[p], 0.0
        for j in range(weight.shape[0]):
            total += weight[j] * signal[j]
        coefficients[p] = total


@njit(cache=True, nogil=True, error_model="numpy")
def add_drift(path: FloatArray, mean1: float, mean2: float, resting: FloatArray) -> None:
    """Let a path (2, n + 1) begin with the traction at rest (2,), and drift by one cycle's part of the mean force."""
    n = path.shape[1] - 1
    drift1, drift2 = mean1 / CYCLES, mean2 / CYCLES
    for j in range(n + 1):
        path[0, j] += resting[0] + drift1 * (j / n)
        path[1, j] += resting[1] + drift2 * (j / n)


@njit(cache=True, nogil=True, error_model="numpy")
def add_drifts(paths: FloatArray, means: FloatArray, resting: FloatArray) -> None:
    """:func:`add_drift` of all pairs."""
    for pair in range(paths.shape[0]):
        add_drift(paths[pair], means[pair, 0], means[pair, 1], resting[pair])


@njit(cache=True, nogil=True, error_model="numpy")
def fill_path(
    displacement: FloatArray, springs: Springs, pair: int, released: bool, waves: FloatArray, path: FloatArray
) -> tuple[float, float]:
    """Fill the path (2, n + 1) N of a pair, K (s - mean s), from (3, 2H+1) m, and give the mean that its slider sees.

    A released slider is at the mean. Else the path begins with the traction at rest, and drifts: each cycle adds the
    same part of the mean displacement.
    """
    n = path.shape[1] - 1
    for axis in range(2):
        path[axis, :] = 0.0
        add_waves(displacement[axis], 1, springs.stiffness[pair, axis], waves, path[axis])
        path[axis, n] = path[axis, 0]
    if released:
        return 0.0, 0.0
    mean1 = springs.stiffness[pair, 0] * displacement[0, 0]
    mean2 = springs.stiffness[pair, 1] * displacement[1, 0]
    add_drift(path, mean1, mean2, springs.resting[pair])
    return mean1, mean2


@njit(cache=True, nogil=True, error_model="numpy")
def fill_limits(
    displacements: FloatArray,
    friction_coefficient: FloatArray,
    normal_stiffness: FloatArray,
    offset_force: FloatArray,
    waves: FloatArray,
    limits: FloatArray,
    start: int,
    stop: int,
) -> None:
    """Fill ``mu (N0 + kn n)`` (p, n) N of the pairs ``start`` to ``stop``, which have linear normal springs."""
    for pair in range(start, stop):
        limit, closing = limits[pair], displacements[pair, 2]
        friction, stiffness = friction_coefficient[pair], normal_stiffness[pair]
        limit[:] = friction * (offset_force[pair] + stiffness * closing[0])
        add_waves(closing, 1, friction * stiffness, waves, limit)


@njit(cache=True, nogil=True, error_model="numpy")
def fill_tractions(
    displacements: FloatArray,
    limits: FloatArray,
    springs: Springs,
    tractrix: bool,
    released: bool,
    fourier: Series,
    result: Tractions,
    start: int,
    stop: int,
) -> None:
    """Fill what the pairs ``start`` to ``stop`` carry in t1 and t2: displacements (p, 3, 2H+1) m, limits (p, n) N."""
    n, width = limits.shape[1], displacements.shape[2]
    path, traction, samples = np.empty((2, n + 1)), np.empty((2, n)), np.empty((2, n))
    mode = np.empty(n, dtype=np.int8)
    for pair in range(start, stop):
        displacement, limit, force = displacements[pair], limits[pair], result.force[pair]
        mean1, mean2 = fill_path(displacement, springs, pair, released, fourier.waves, path)
        motion = Motion(path, mean1, mean2, limit, springs.ratios[pair, 0], springs.ratios[pair, 1], tractrix)
        state, deviates, closure = settle_pair(motion, traction, samples, mode, result.starts[pair])
        largest = limit.max()
        if not springs.closed[pair]:
            deviates = largest > 0.0
        result.state[pair], result.deviates[pair] = state, deviates
        result.closure[pair] = closure / max(largest, SMALLEST_LIMIT)
        for axis in range(2):
            if deviates or not springs.closed[pair]:
                integrate(samples[axis], fourier.weights, force[axis])
                if not released:
                    force[axis, 0] -= springs.resting[pair, axis]
                continue
            # the springs of a pair that sticks, without round-off
            for p in range(width):
                force[axis, p] = springs.stiffness[pair, axis] * displacement[axis, p]
            if released:
                force[axis, 0] = 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def opens(limit: FloatArray) -> bool:
    """Whether a pair opens in the period; its limit (n,) may not be finite."""
    count = 0
    for most in limit:
        if most <= 0.0:
            count += 1
    return count > 0


@njit(cache=True, nogil=True, error_model="numpy")
def fill_normal_forces(
    displacements: FloatArray,
    limits: FloatArray,
    friction_coefficient: FloatArray,
    normal_stiffness: FloatArray,
    offset_force: FloatArray,
    normal_load: FloatArray,
    weights: FloatArray,
    forces: FloatArray,
    start: int,
    stop: int,
) -> None:
    """Fill the normal forces of ``forces`` (p, 3, 2H+1) N, less the load at rest, of the pairs ``start`` to ``stop``.

    ``limits`` (p, n) N are those of :func:`fill_limits`.
    """
    pressed = np.empty(limits.shape[1])
    for pair in range(start, stop):
        limit, force, stiffness = limits[pair], forces[pair, 2], normal_stiffness[pair]
        if opens(limit):
            corrected_limit(limit, pressed)
            for j in range(pressed.shape[0]):
                pressed[j] = pressed[j] / friction_coefficient[pair] - normal_load[pair]
            integrate(pressed, weights, force)
            continue
        for p in range(force.shape[0]):
            force[p] = stiffness * displacements[pair, 2, p]
        # a gap that stays closed: N = k_n n - gap force, zero at rest
        force[0] += min(offset_force[pair], 0.0)
