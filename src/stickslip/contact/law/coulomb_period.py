"""March of the friction law over periods to the periodic state, and the exact derivative of that state.

Paths are in force units (K s without its mean, or T0 + K s from the state at rest), limits are
``mu * (N0 + kn * n)`` with their sign; see coulomb_kernel.
A period map sends the force at the first sample to the force one period later; it never expands distances, so its
fixed points form one connected set: a single point where the pair slips, all feasible slider positions where it sticks.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.coulomb_kernel import (
    OPEN,
    SLIP,
    STICK,
    CodeArray,
    Index,
    advance,
    associated_return,
    slip_jacobian,
)
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

# Closure |T_end - T_start| / max(mu N) at which a period counts as periodic: some hundred units of round-off.
CLOSURE_TOLERANCE = 1e-13
MAX_CYCLES = 300  # chosen: ends a march that does not become periodic; its closure is reported
# Plain cycles, which lead to the physical shakedown state, continue while each reduces the closure to this fraction or
# less.
FAST_RATIO = 0.1
# Newton continues while each step is shorter than this fraction of the last one; chosen close to 1, so that only steps
# that stagnate end it.
NEWTON_SHRINK = 0.9
# A pair counts as stuck if its slip in a period, in force units, is below this fraction of max(mu N).
SLIP_TOLERANCE = 1e-9


class Motion(NamedTuple):
    """Motion of a pair in a period: path (2, n) N, limit (n,) N with its sign, stiffness ratios, the update."""

    path: FloatArray
    limit: FloatArray
    ratio1: float
    ratio2: float
    tractrix: bool


@njit(cache=True, nogil=True, error_model="numpy")
def march(
    motion: Motion,
    first: Index,
    t1: float,
    t2: float,
    meeting_distance: float,
    force: FloatArray,
    mode: CodeArray,
) -> tuple[float, float]:
    """March one period from sample ``first`` with force (t1, t2); fills ``force``, ``mode``; returns its end.

    ``meeting_distance`` >= 0 stops the march as soon as it is within this distance of the trajectory in ``force``.
    """
    path, limit, ratio1, ratio2, tractrix = motion.path, motion.limit, motion.ratio1, motion.ratio2, motion.tractrix
    n = limit.shape[0]
    previous = first
    for step in range(1, n + 1):
        j = first + step
        if j >= n:
            j -= n
        d1, d2 = path[0, j] - path[0, previous], path[1, j] - path[1, previous]
        t1, t2, code = advance(t1, t2, d1, d2, limit[previous], limit[j], ratio1, ratio2, tractrix)
        if mode[j] == code and abs(t1 - force[0, j]) <= meeting_distance and abs(t2 - force[1, j]) <= meeting_distance:
            return force[0, first], force[1, first]
        force[0, j], force[1, j], mode[j] = t1, t2, code
        previous = j
    return t1, t2


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
                t1, t2, path[0, j] - path[0, i], path[1, j] - path[1, i], limit[i], limit[j],
                force[0, j], force[1, j], ratio1, ratio2, tractrix, jacobian,
            )  # fmt: skip
            a11, a12, a21, a22 = jacobian[0, 0], jacobian[0, 1], jacobian[1, 0], jacobian[1, 1]
            p11, p21 = a11 * p11 + a12 * p21, a21 * p11 + a22 * p21
            p12, p22 = a11 * p12 + a12 * p22, a21 * p12 + a22 * p22
        t1, t2 = force[0, j], force[1, j]
    return p11, p12, p21, p22


@njit(cache=True, nogil=True, error_model="numpy")
def start_of_path(path: FloatArray, limit: float, ratio1: float, ratio2: float) -> tuple[float, float]:
    """Force at sample 0 of the path, returned to the limit."""
    t1, t2 = path[0, 0], path[1, 0]
    if math.hypot(t1, t2) > limit:
        t1, t2, _ = associated_return(t1, t2, limit, ratio1, ratio2)
    return t1, t2


@njit(cache=True, nogil=True, error_model="numpy")
def sticks_throughout(path: FloatArray, limit: FloatArray) -> bool:
    """True if the pair stays closed and the path within its limit all period: the force is then the path itself."""
    for j in range(limit.shape[0]):
        if limit[j] <= 0.0 or path[0, j] ** 2 + path[1, j] ** 2 > limit[j] ** 2:
            return False
    return True


@njit(cache=True, nogil=True, error_model="numpy")
def slips(mode: CodeArray) -> bool:
    """True if any step slips."""
    for code in mode:  # noqa: SIM110  any() is slow to compile
        if code == SLIP:
            return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def newton_step(
    motion: Motion,
    t1: float,
    t2: float,
    end1: float,
    end2: float,
    force: FloatArray,
    mode: CodeArray,
) -> tuple[float, float, float]:
    """Newton step of the start (t1, t2) of a marched period that ended at (end1, end2), and its length (inf: none)."""
    p11, p12, p21, p22 = transfer(motion, t1, t2, force, mode)
    determinant = (1.0 - p11) * (1.0 - p22) - p12 * p21
    if not abs(determinant) > 1e-14:
        return 0.0, 0.0, math.inf
    r1, r2 = end1 - t1, end2 - t2
    step1 = ((1.0 - p22) * r1 + p12 * r2) / determinant
    step2 = ((1.0 - p11) * r2 + p21 * r1) / determinant
    return step1, step2, math.hypot(step1, step2)


@njit(cache=True, nogil=True, error_model="numpy")
def settle(
    motion: Motion,
    force: FloatArray,
    mode: CodeArray,
) -> tuple[Index, float, float, float, int]:
    """Periodic state of one pair: fills ``force`` (2, n) and ``mode`` (n,).

    Plain cycles from the start of the path come first. Where they converge slowly, Newton on the period map follows; as
    soon as its steps stop shrinking or it jumps into the stuck set, plain cycles continue from the last plain cycle.

    Returns the sample where the final march starts, the force there (t1, t2), the closure of the final march, and the
    number of plain cycles from the start of the path to the last march before Newton.
    """
    path, limit, ratio1, ratio2 = motion.path, motion.limit, motion.ratio1, motion.ratio2
    n = limit.shape[0]
    first_open, largest = np.int64(-1), 0.0
    for j in range(n):
        if limit[j] <= 0.0:
            first_open = np.int64(j)
        largest = max(largest, limit[j])
    for j in range(n):
        mode[j] = -1
    if first_open >= 0:
        # An open sample carries no force, whatever its history: one march from there is the periodic state.
        march(motion, first_open, 0.0, 0.0, -1.0, force, mode)
        return first_open, 0.0, 0.0, 0.0, 0
    t1, t2 = start_of_path(path, limit[0], ratio1, ratio2)
    meeting_distance = 1e-16 * largest
    plain, cycles, wait, patience = 0, 0, 0, 1
    previous = math.inf
    plain1, plain2 = t1, t2
    length = math.inf  # of the Newton step that led to this march; inf after a plain cycle
    while True:
        end1, end2 = march(motion, np.int64(0), t1, t2, meeting_distance, force, mode)
        cycles += 1
        closure = math.hypot(end1 - t1, end2 - t2) / largest
        newton = length < math.inf
        overshoot = newton and length > SLIP_TOLERANCE * largest and not slips(mode)
        if (closure <= CLOSURE_TOLERANCE and not overshoot) or cycles >= MAX_CYCLES:
            break
        if not newton:
            plain1, plain2 = end1, end2
            plain += 1
        step1, step2, next_length = 0.0, 0.0, math.inf
        if newton or (wait == 0 and closure > FAST_RATIO * previous):
            step1, step2, next_length = newton_step(motion, t1, t2, end1, end2, force, mode)
        good = next_length < 2.0 * largest
        if newton:
            good = good and not overshoot and next_length < NEWTON_SHRINK * length
        previous = closure
        if good:
            length = next_length
            t1, t2 = t1 + step1, t2 + step2
            size = math.hypot(t1, t2)
            if mode[0] == SLIP or size > limit[0]:
                t1, t2 = t1 * (limit[0] / size), t2 * (limit[0] / size)
            continue
        if newton:
            wait, patience = patience, 2 * patience
        else:
            wait = max(wait - 1, 0)
        t1, t2, length = plain1, plain2, math.inf
    return 0, t1, t2, closure, plain


@njit(cache=True, nogil=True, error_model="numpy")
def pair_state(path: FloatArray, limit: FloatArray, force: FloatArray, mode: CodeArray) -> int:
    """0 stuck, 1 stick-slip, 2 separating: from the converged period."""
    n = limit.shape[0]
    slip, largest = 0.0, 0.0
    for j in range(n):
        if mode[j] == OPEN:
            return OPEN
        largest = max(largest, limit[j])
        if mode[j] == SLIP:
            slip += math.hypot(
                path[0, j] - path[0, j - 1] - force[0, j] + force[0, j - 1],
                path[1, j] - path[1, j - 1] - force[1, j] + force[1, j - 1],
            )
    return SLIP if slip > SLIP_TOLERANCE * largest else STICK


@njit(cache=True, nogil=True, error_model="numpy")
def settle_pairs(
    paths: FloatArray,
    limits: FloatArray,
    ratios: FloatArray,
    tractrix: bool,
    forces: FloatArray,
    modes: CodeArray,
    states: CodeArray,
    deviates: NDArray[np.bool_],
    closures: FloatArray,
    starts: FloatArray,
) -> None:
    """Periodic state of every pair: fills forces (n_pairs, 2, n), modes (n_pairs, n) and the arrays (n_pairs,).

    ``starts`` (n_pairs, 4): the sample where the last march began, the force there, and the plain cycles before Newton.
    """
    for pair in range(limits.shape[0]):
        path, limit, force, mode = paths[pair], limits[pair], forces[pair], modes[pair]
        if sticks_throughout(path, limit):
            for j in range(limit.shape[0]):
                force[0, j], force[1, j], mode[j] = path[0, j], path[1, j], STICK
            states[pair], deviates[pair], closures[pair] = STICK, False, 0.0
            for k in range(4):
                starts[pair, k] = 0.0
            continue
        motion = Motion(path, limit, ratios[pair, 0], ratios[pair, 1], tractrix)
        first, t1, t2, closures[pair], plain = settle(motion, force, mode)
        starts[pair, 0], starts[pair, 1], starts[pair, 2], starts[pair, 3] = first, t1, t2, plain
        states[pair], deviates[pair] = pair_state(path, limit, force, mode), True
