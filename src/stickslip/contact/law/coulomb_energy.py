"""Energy that friction dissipates in one period, step by step, from the converged forces."""

from __future__ import annotations

import math

from stickslip.contact.law.coulomb_kernel import (
    OPEN,
    SLIP,
    STICK,
    CodeArray,
    inverse_mean_limit,
    slide_frame,
    slip_onset,
    turned,
)
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

# Three-point Gauss rule on [0, 1].
_OFFSET = 0.5 * math.sqrt(0.6)
_NODES = (0.5 - _OFFSET, 0.5, 0.5 + _OFFSET)
_WEIGHTS = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


@njit(cache=True, nogil=True, error_model="numpy")
def tractrix_work(
    s1: float, s2: float, d1: float, d2: float, rest: float, limit_onset: float, limit_end: float
) -> float:
    """k times the work of friction on the slider over the sliding fraction ``rest`` of a step.

    The slider moves along T at the rate ``(|d| cos(phi) - dlambda/dx) / k >= 0``. The work is the integral of lambda
    times this rate; no term of the Gauss sum is negative.
    """
    _, _, length, a, b = slide_frame(s1, s2, d1, d2)
    length *= rest
    change = limit_end - limit_onset
    total = 0.0
    for node in range(3):
        x = _NODES[node]
        limit = limit_onset + x * change
        inverse, _, _ = inverse_mean_limit(limit_onset, limit)
        cosine, _ = turned(a, b, math.exp(-length * x * inverse))
        total += _WEIGHTS[node] * limit * max(length * cosine - change, 0.0)
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def step_dissipation(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    new1: float,
    new2: float,
    k1: float,
    k2: float,
    tractrix: bool,
) -> float:
    """Energy of a step that slips or lifts off, J; forces in N, ``d = K ds``."""
    if limit_end <= 0.0:
        # Lift-off: only the part of the step before the limit reaches zero counts; T is zero there too.
        closed = limit_start / (limit_start - limit_end)
        d1, d2, limit_end = d1 * closed, d2 * closed, 0.0
    elif limit_start <= 0.0:
        closed = limit_end / (limit_end - limit_start)
        d1, d2, limit_start = d1 * closed, d2 * closed, 0.0
    theta = slip_onset(t1, t2, d1, d2, limit_start, limit_end) if limit_start > 0.0 else 0.0
    onset = limit_start + theta * (limit_end - limit_start)
    rest = 1.0 - theta
    if tractrix and k1 == k2 and limit_start > 0.0:
        if onset <= 0.0:
            return 0.0
        work: float = tractrix_work(t1 + theta * d1, t2 + theta * d2, d1, d2, rest, onset, limit_end)
        return work / k1
    # Straight slider path at the mean limit: exact from touchdown on, second order elsewhere.
    return 0.5 * (onset + limit_end) * math.hypot((t1 + d1 - new1) / k1, (t2 + d2 - new2) / k2)


@njit(cache=True, nogil=True, error_model="numpy")
def dissipate_pairs(
    paths: FloatArray,
    limits: FloatArray,
    springs: FloatArray,
    tractrix: bool,
    forces: FloatArray,
    modes: CodeArray,
    states: CodeArray,
    energy: FloatArray,
) -> None:
    """Fill energy (n_pairs,) J from the converged periods; stuck pairs get exactly 0."""
    n_pairs, n = limits.shape
    for pair in range(n_pairs):
        energy[pair] = 0.0
        if states[pair] == STICK:
            continue
        path, limit, force, mode = paths[pair], limits[pair], forces[pair], modes[pair]
        for step in range(1, n + 1):
            i, j = step - 1, step % n
            if mode[j] == SLIP or (mode[j] == OPEN and limit[i] > 0.0):
                d1, d2 = path[0, step] - path[0, i], path[1, step] - path[1, i]
                energy[pair] += step_dissipation(
                    force[0, i], force[1, i], d1, d2, limit[i], limit[j], force[0, j], force[1, j],
                    springs[pair, 0], springs[pair, 1], tractrix,
                )  # fmt: skip
