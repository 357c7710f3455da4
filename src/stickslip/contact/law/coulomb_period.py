"""March of the friction law over periods to the state after many cycles, in which slip has become periodic.

Paths are in force units (K s without its mean, or T0 + K s from the state at rest), limits are
``mu * (N0 + kn * n)`` with their sign; see coulomb_kernel.

A period map P sends the force at the first sample to the force one period later. It never expands distances, so its
fixed points form one connected set: a single point where the pair slips, all feasible slider positions where it sticks.
With a the force that the slider at its initial position would give, the state after C cycles is taken as

    y = a + C (P(y) - y),

one implicit step over all cycles. It has exactly one solution, which moves continuously with path and limit: y = a for
a pair that sticks, the feasible y nearest to a, but for 1/C, for one that shakes down, and the fixed point, but for
1/C, for one that slips on. The limit of plain cycles is not used: where a pair is about to slip to both sides, it jumps
across the direction of slip from what is kept in sticking to nothing (docs/theory_friction.md).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stickslip.contact.law.coulomb_events import corrected_samples
from stickslip.contact.law.coulomb_kernel import (
    OPEN,
    SLIP,
    STICK,
    CodeArray,
    advance,
    associated_return,
    return_jacobian,
    slip_jacobian,
)
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

# C: tractions of pairs that slip have lost their start but for this fraction; chosen far below errors of samples, and
# far above round-off, which C multiplies.
CYCLES = 1e6
# Relative residual of y, over C, that counts as solved; the largest number of marches of Newton on y, and that without
# improvement which ends it.
SOLVED, MOST_MARCHES, PATIENCE = 1e-14, 40, 4
# chosen: where Newton fails, halvings of the distance to the state after one cycle; the factor to the cycles of the
# next stage, and that which ends the attempts.
HALVINGS, STAGE, LEAST_STAGE = 40, 30.0, 1.02
# A pair counts as stuck if its slip in a period, in force units, is below this fraction of max(mu N). chosen: ten times
# 1 / C; of 6,000 random pairs near shakedown none had a slip between 6e-6, creep of the last cycle, and 1.9e-4.
SLIP_TOLERANCE = 10.0 / CYCLES


class Motion(NamedTuple):
    """Motion of a pair in a period: path (2, n + 1) N, limit (n,) N with its sign, stiffness ratios, the update.

    The path ends where the next period begins: ``mean1 / C``, ``mean2 / C`` beyond its start.
    """

    path: FloatArray
    mean1: float  # N, force of the mean displacement that all cycles together have reached
    mean2: float
    limit: FloatArray
    ratio1: float
    ratio2: float
    tractrix: bool


@njit(cache=True, nogil=True, error_model="numpy")
def march(motion: Motion, t1: float, t2: float, again: bool, force: FloatArray, mode: CodeArray) -> None:
    """March one period from sample 0 with force (t1, t2); fills ``force`` and ``mode``, whose sample 0 is the end.

    ``again``: both contain an earlier march of the same motion. If the march meets it to the last bit, in force and
    code, the rest of the period is the same and stays.
    """
    path, limit, ratio1, ratio2, tractrix = motion.path, motion.limit, motion.ratio1, motion.ratio2, motion.tractrix
    n = limit.shape[0]
    for step in range(1, n + 1):
        i, j = step - 1, step % n
        d1, d2 = path[0, step] - path[0, i], path[1, step] - path[1, i]
        t1, t2, code = advance(t1, t2, d1, d2, limit[i], limit[j], ratio1, ratio2, tractrix)
        if again and mode[j] == code and t1 == force[0, j] and t2 == force[1, j]:
            return
        force[0, j], force[1, j], mode[j] = t1, t2, code


@njit(cache=True, nogil=True, error_model="numpy")
def transfer(
    motion: Motion,
    t1: float,
    t2: float,
    force: FloatArray,
    mode: CodeArray,
) -> tuple[float, float, float, float]:
    """Derivative Phi (11, 12, 21, 22) of the period map along the trajectory from sample 0 with force (t1, t2)."""
    path, limit, ratio1, ratio2, tractrix = motion.path, motion.limit, motion.ratio1, motion.ratio2, motion.tractrix
    n = limit.shape[0]
    jacobian = np.zeros((2, 6))
    p11, p12, p21, p22 = 1.0, 0.0, 0.0, 1.0
    for step in range(1, n + 1):
        j = step % n
        i = step - 1
        if mode[j] == SLIP:
            slip_jacobian(
                t1, t2, path[0, step] - path[0, i], path[1, step] - path[1, i], limit[i], limit[j],
                ratio1, ratio2, tractrix, jacobian,
            )  # fmt: skip
            a11, a12, a21, a22 = jacobian[0, 0], jacobian[0, 1], jacobian[1, 0], jacobian[1, 1]
            p11, p21 = a11 * p11 + a12 * p21, a21 * p11 + a22 * p21
            p12, p22 = a11 * p12 + a12 * p22, a21 * p12 + a22 * p22
        t1, t2 = force[0, j], force[1, j]
    return p11, p12, p21, p22


@njit(cache=True, nogil=True, error_model="numpy")
def sticks_throughout(motion: Motion) -> bool:
    """True if the pair stays closed and path and mean within its limit, in the last cycle and in the period after it.

    The force is then the path, without its drift, and the mean.
    """
    path, limit = motion.path, motion.limit
    n = limit.shape[0]
    drift1, drift2 = path[0, n] - path[0, 0], path[1, n] - path[1, 0]
    for step in range(n + 1):
        most = limit[step % n]
        force1, force2 = path[0, step] + motion.mean1, path[1, step] + motion.mean2
        if most <= 0.0 or force1**2 + force2**2 > most**2 or (force1 + drift1) ** 2 + (force2 + drift2) ** 2 > most**2:
            return False
    return True


@njit(cache=True, nogil=True, error_model="numpy")
def start_force(motion: Motion, y1: float, y2: float) -> tuple[float, float]:
    """Force at sample 0 of a slider that would give (y1, y2) there: within the limit."""
    limit = motion.limit[0]
    if limit <= 0.0:
        return 0.0, 0.0
    if math.hypot(y1, y2) <= limit:
        return y1, y2
    t1, t2, _ = associated_return(y1, y2, limit, motion.ratio1, motion.ratio2)
    return t1, t2


@njit(cache=True, nogil=True, error_model="numpy")
def start_jacobian(motion: Motion, y1: float, y2: float) -> tuple[float, float, float, float, float, float]:
    """Derivatives of :func:`start_force`: t1 by y1, y2, t2 by y1, y2, t1 and t2 by the limit at sample 0."""
    limit = motion.limit[0]
    if limit <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if math.hypot(y1, y2) <= limit:
        return 1.0, 0.0, 0.0, 1.0, 0.0, 0.0
    t1, t2, x = associated_return(y1, y2, limit, motion.ratio1, motion.ratio2)
    r11, r12, r21, r22, l1, l2 = return_jacobian(t1, t2, x, limit, motion.ratio1, motion.ratio2)
    return r11, r12, r21, r22, l1, l2


@njit(cache=True, nogil=True, error_model="numpy")
def initial_force(motion: Motion, cycles: float) -> tuple[float, float]:
    """Force a at sample 0 of the slider at its initial position, and the part of the mean that comes before the cycles.

    All cycles together walk the whole mean; with fewer of them, each as long, the rest of it lies before them.
    """
    before = 1.0 - cycles / CYCLES
    return motion.path[0, 0] + before * motion.mean1, motion.path[1, 0] + before * motion.mean2


@njit(cache=True, nogil=True, error_model="numpy")
def solve_stage(
    motion: Motion, y1: float, y2: float, cycles: float, enough: float, force: FloatArray, mode: CodeArray
) -> tuple[float, float, bool]:
    """Solve ``y = a + cycles (P(y) - y)`` by Newton from (y1, y2): y, and whether the residual came below ``enough``.

    ``force`` and ``mode`` are then those of the march from y. A y outside of the limit at sample 0 starts on it
    (:func:`start_force`).
    """
    a1, a2 = initial_force(motion, cycles)
    best, since = math.inf, 0
    for _ in range(MOST_MARCHES):
        t1, t2 = start_force(motion, y1, y2)
        march(motion, t1, t2, True, force, mode)
        f1, f2 = y1 - a1 - cycles * (force[0, 0] - y1), y2 - a2 - cycles * (force[1, 0] - y2)
        size = math.hypot(f1, f2)
        if size <= enough:
            return y1, y2, True
        since = 0 if size < best else since + 1
        best = min(best, size)
        if since > PATIENCE:
            break
        p11, p12, p21, p22 = transfer(motion, t1, t2, force, mode)
        r11, r12, r21, r22, _, _ = start_jacobian(motion, y1, y2)
        j11 = 1.0 + cycles * (1.0 - p11 * r11 - p12 * r21)
        j12 = -cycles * (p11 * r12 + p12 * r22)
        j21 = -cycles * (p21 * r11 + p22 * r21)
        j22 = 1.0 + cycles * (1.0 - p21 * r12 - p22 * r22)
        determinant = j11 * j22 - j12 * j21
        y1 -= (j22 * f1 - j12 * f2) / determinant
        y2 -= (j11 * f2 - j21 * f1) / determinant
    return y1, y2, False


@njit(cache=True, nogil=True, error_model="numpy")
def staged(motion: Motion, largest: float, force: FloatArray, mode: CodeArray) -> tuple[float, float]:
    """The state after the cycles by stages of more and more of them, each of which starts from the last.

    For one cycle the right side of ``y = (a + c P(y)) / (1 + c)`` halves distances, so its iteration converges from
    anywhere. Where no stage with more cycles converges, the state is that of the last stage; the closure shows it.
    """
    a1, a2 = initial_force(motion, 1.0)
    y1, y2 = a1, a2
    for _ in range(HALVINGS):
        t1, t2 = start_force(motion, y1, y2)
        march(motion, t1, t2, True, force, mode)
        y1, y2 = 0.5 * (a1 + force[0, 0]), 0.5 * (a2 + force[1, 0])
    cycles, factor = 1.0, STAGE
    while cycles < CYCLES and factor > LEAST_STAGE:
        wanted = min(CYCLES, factor * cycles)
        next1, next2, solved = solve_stage(motion, y1, y2, wanted, SOLVED * wanted * largest, force, mode)
        if solved:
            y1, y2, cycles, factor = next1, next2, wanted, STAGE
        else:
            factor = math.sqrt(factor)
    return y1, y2


@njit(cache=True, nogil=True, error_model="numpy")
def settle(motion: Motion, force: FloatArray, mode: CodeArray) -> tuple[float, float, float, float]:
    """State after the cycles: fills ``force`` (2, n) and ``mode`` (n,) with the period that follows them.

    Returns y, with which the last cycle starts, and the force at the start of the period.
    """
    n = motion.limit.shape[0]
    largest, opens = 0.0, False
    for j in range(n):
        largest = max(largest, motion.limit[j])
        if motion.limit[j] <= 0.0:
            opens = True
    a1, a2 = initial_force(motion, 1.0)
    t1, t2 = start_force(motion, a1, a2)
    march(motion, t1, t2, False, force, mode)
    y1, y2 = force[0, 0], force[1, 0]
    if opens:
        # An open sample carries no force, so the end of a period does not depend on its start.
        march(motion, y1, y2, True, force, mode)
        return y1, y2, y1, y2
    # From the end of one cycle, which is near where the pair slips far.
    y1, y2, solved = solve_stage(motion, y1, y2, CYCLES, SOLVED * CYCLES * largest, force, mode)
    if not solved:
        y1, y2 = staged(motion, largest, force, mode)
        t1, t2 = start_force(motion, y1, y2)
        march(motion, t1, t2, True, force, mode)
    # The period after the cycles: a pair that slips far to both sides has forgotten its start altogether.
    end1, end2 = force[0, 0], force[1, 0]
    march(motion, end1, end2, True, force, mode)
    return y1, y2, end1, end2


@njit(cache=True, nogil=True, error_model="numpy")
def pair_state(motion: Motion, t1: float, t2: float, force: FloatArray, mode: CodeArray) -> int:
    """0 stuck, 1 stick-slip, 2 separating: from the period that starts with (t1, t2)."""
    path, n = motion.path, motion.limit.shape[0]
    slip, largest = 0.0, 0.0
    for step in range(1, n + 1):
        i, j = step - 1, step % n
        if mode[j] == OPEN:
            return OPEN
        largest = max(largest, motion.limit[j])
        if mode[j] == SLIP:
            slip1, slip2 = path[0, step] - path[0, i] - force[0, j] + t1, path[1, step] - path[1, i] - force[1, j] + t2
            slip += math.hypot(slip1, slip2)
        t1, t2 = force[0, j], force[1, j]
    return SLIP if slip > SLIP_TOLERANCE * largest else STICK


@njit(cache=True, nogil=True, error_model="numpy")
def settle_pair(
    motion: Motion, force: FloatArray, samples: FloatArray, mode: CodeArray, start: FloatArray
) -> tuple[int, bool, float]:
    """State of a pair after the cycles: fills force and samples (2, n), mode (n,) and start (4,).

    ``samples`` are the forces with corrections, so that their sum is the integral (:func:`corrected_samples`).
    ``start`` is y, with which the last cycle starts, and in which pairs that have shaken down still touch their limit,
    and the force with which that cycle ends. Returns the code of the state, whether the force is another than that of
    the springs, and N, what the period changes.
    """
    path, limit, mean1, mean2 = motion.path, motion.limit, motion.mean1, motion.mean2
    n = limit.shape[0]
    if sticks_throughout(motion):
        for j in range(n):
            share = j / n
            force[0, j] = path[0, j] - share * (path[0, n] - path[0, 0]) + mean1
            force[1, j] = path[1, j] - share * (path[1, n] - path[1, 0]) + mean2
            samples[0, j], samples[1, j], mode[j] = force[0, j], force[1, j], STICK
        start[0], start[1] = path[0, 0] + mean1, path[1, 0] + mean2
        start[2], start[3] = start[0], start[1]
        return STICK, False, 0.0
    start[0], start[1], t1, t2 = settle(motion, force, mode)
    start[2], start[3] = t1, t2
    corrected_samples(path, limit, t1, t2, force, mode, samples)
    change1, change2 = force[0, 0] - t1, force[1, 0] - t2
    for j in range(n):  # sample 0 is that of the end
        share = 2.0 if j == 0 else 1.0 + j / n
        samples[0, j] -= share * change1
        samples[1, j] -= share * change2
    return pair_state(motion, t1, t2, force, mode), True, math.hypot(change1, change2)


@njit(cache=True, nogil=True, error_model="numpy")
def settle_pairs(
    paths: FloatArray,
    means: FloatArray,
    limits: FloatArray,
    ratios: FloatArray,
    tractrix: bool,
    forces: FloatArray,
    modes: CodeArray,
    states: CodeArray,
    closures: FloatArray,
) -> None:
    """State of every pair after the cycles: fills forces (n_pairs, 2, n), modes (n_pairs, n), states and closures N."""
    samples, start = np.empty((2, limits.shape[1])), np.empty(4)
    for pair in range(limits.shape[0]):
        mean1, mean2 = means[pair, 0], means[pair, 1]
        motion = Motion(paths[pair], mean1, mean2, limits[pair], ratios[pair, 0], ratios[pair, 1], tractrix)
        states[pair], _, closures[pair] = settle_pair(motion, forces[pair], samples, modes[pair], start)
