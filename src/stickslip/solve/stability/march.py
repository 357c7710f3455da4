"""One period of the disturbed motion: the near coordinates exactly between samples, the laws by their linear steps.

Between samples the forces on the near coordinates vary linearly (first-order hold), so a structure whose pairs all
stick has exactly the multipliers of its modes. The forces at the end of a step follow from the displacements there, and
these from the forces: one small linear system for each step, in the near coordinates and the far patterns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from stickslip.contact.law.law import IndexArray
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray
from stickslip.solve.stability.model import StabilityModel

# Linear variation between samples becomes unstable where a coordinate moves by pi in a step. Coordinates that are
# faster than FASTEST in a step are integrated by Newmark's method, whose parameter gamma = 1/2 + DISSIPATION removes a
# tenth of their amplitude in a step and 1e-3 of the critical damping at the excitation (N. M. Newmark, J. Eng. Mech.
# Div. 85 (1959) 67).
FASTEST, DISSIPATION = 1.5, 0.05


@dataclass(frozen=True)
class FreeStep:
    """``(q, v)_(j+1) = advance (q, v)_j + by_start g_j + by_end g_(j+1)`` of the near coordinates under forces g."""

    advance: FloatArray  # (2p, 2p)
    by_start: FloatArray  # (2p, p)
    by_end: FloatArray  # (2p, p)


def free_step(model: StabilityModel, time_step: float) -> FreeStep:
    """The step of the near coordinates in ``time_step`` s."""
    p = model.frequency.size
    slow = np.flatnonzero(model.frequency * time_step <= FASTEST)
    fast = np.flatnonzero(model.frequency * time_step > FASTEST)
    advance, by_start, by_end = np.zeros((2 * p, 2 * p)), np.zeros((2 * p, p)), np.zeros((2 * p, p))
    for group, parts in (
        (slow, _held(model.frequency[slow], model.damping[np.ix_(slow, slow)], time_step)),
        (fast, _newmark(model.frequency[fast], np.diag(model.damping)[fast], time_step)),
    ):
        both = np.concatenate([group, p + group])
        advance[np.ix_(both, both)] = parts[0]
        by_start[np.ix_(both, group)], by_end[np.ix_(both, group)] = parts[1], parts[2]
    return FreeStep(advance, by_start, by_end)


def _held(frequency: FloatArray, damping: FloatArray, time_step: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Exact for a force that varies linearly: the matrix exponential of the coordinates, the force and its change."""
    p = frequency.size
    matrix = np.zeros((4 * p, 4 * p))
    one = np.eye(p)
    matrix[:p, p : 2 * p] = time_step * one
    matrix[p : 2 * p, :p] = -time_step * np.diag(frequency**2)
    matrix[p : 2 * p, p : 2 * p] = -time_step * damping
    matrix[p : 2 * p, 2 * p : 3 * p] = time_step * one
    matrix[2 * p : 3 * p, 3 * p :] = one
    # Velocities in units of displacement per step keep the entries of one size.
    scale = np.concatenate([np.full(p, 1.0), np.full(p, 1.0 / time_step), np.full(2 * p, 1.0 / time_step**2)])
    power = scipy.linalg.expm(matrix * (scale / scale[:, None])) / (scale / scale[:, None])
    by_end = power[: 2 * p, 3 * p :]
    return power[: 2 * p, : 2 * p], power[: 2 * p, 2 * p : 3 * p] - by_end, by_end


def _newmark(frequency: FloatArray, damping: FloatArray, time_step: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Newmark's method for each coordinate alone; its coupling to others by damping is left out."""
    h, gamma = time_step, 0.5 + DISSIPATION
    beta = 0.25 * (0.5 + gamma) ** 2
    # Rows q, v of the columns q, v, force at the start, force at the end.
    start = np.stack([-(frequency**2), -damping, np.ones_like(frequency), np.zeros_like(frequency)])
    zero, one = np.zeros_like(frequency), np.ones_like(frequency)
    q = np.stack([one, h * one, zero, zero]) + h**2 * (0.5 - beta) * start
    v = np.stack([zero, one, zero, zero]) + h * (1.0 - gamma) * start
    end = np.stack([zero, zero, zero, one]) - damping * v - frequency**2 * q
    end /= 1.0 + damping * gamma * h + beta * h**2 * frequency**2
    q, v = q + beta * h**2 * end, v + gamma * h * end
    matrices = [np.vstack([np.diag(q[column]), np.diag(v[column])]) for column in range(4)]
    return np.hstack(matrices[:2]), matrices[2], matrices[3]


class Period:
    """The march over one period of disturbances ``(q, v, s, T)``: p + p + r + 2k states with k moving pairs.

    Parameters
    ----------
    model:
        of the curve.
    steps:
        of the moving pairs alone.
    moving:
        (k,) the moving pairs.
    omega:
        rad/s of the excitation.
    """

    def __init__(self, model: StabilityModel, steps: LinearSteps, moving: IndexArray, omega: float) -> None:
        samples = len(steps.normal)
        rows = (3 * moving[:, None] + np.arange(3)).ravel()
        free = free_step(model, 2.0 * np.pi / omega / samples)
        self._p, self._r, self._k = model.frequency.size, model.far_contact.shape[1], moving.size
        self._contact = np.ascontiguousarray(np.hstack([model.near_contact, model.far_contact])[rows])
        self._steps = tuple(
            np.ascontiguousarray(each) for each in (steps.keep, steps.by_end, steps.by_start, steps.normal)
        )
        self._springs = model.springs[moving]
        self._free = tuple(np.ascontiguousarray(each) for each in (free.advance, free.by_start, free.by_end))
        weight = np.eye(self._p + self._r)
        weight[: self._p, : self._p] = free.by_end[: self._p]
        self._forms, self._inverses = np.empty((2, samples, *weight.shape))
        _prepare(self._contact, *self._steps[1::2], self._springs, weight, self._forms, self._inverses)
        self._weight = weight

    @property
    def size(self) -> int:
        """Number of states."""
        return int(2 * self._p + self._r + 2 * self._k)

    def scale(self, model: StabilityModel, omega: float) -> FloatArray:
        """(size,) units of the states whose squares are energies, so that lengths of states have a meaning."""
        springs = self._springs[:, :2].ravel()
        return np.concatenate(
            [
                1.0 / np.maximum(model.frequency, omega),
                np.ones(self._p + self._r),
                np.sqrt(np.where(springs > 0.0, springs, 1.0)),
            ]
        )

    def march(self, states: FloatArray) -> FloatArray:
        """States (size, c) one period later."""
        after = np.ascontiguousarray(states)
        return np.asarray(
            _march(
                after, self._p, self._contact, *self._steps, self._springs, *self._free, self._weight, self._forms,
                self._inverses,
            )
        )  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy")
def _prepare(
    contact: FloatArray,
    by_end: FloatArray,
    normal: FloatArray,
    springs: FloatArray,
    weight: FloatArray,
    forms: FloatArray,
    inverses: FloatArray,
) -> None:
    """Fill ``X^T S_j X`` and ``(I + W X^T S_j X)^-1`` of the n samples; S_j is the stiffness of the deviation."""
    size = contact.shape[1]
    force = np.empty_like(contact)
    for j in range(normal.shape[0]):
        for pair in range(normal.shape[1]):
            row = 3 * pair
            for a in range(2):
                s0, s1, s2 = by_end[j, pair, a, 0], by_end[j, pair, a, 1], by_end[j, pair, a, 2]
                if a == 0:
                    s0 -= springs[pair, 0]
                else:
                    s1 -= springs[pair, 1]
                for c in range(size):
                    force[row + a, c] = s0 * contact[row, c] + s1 * contact[row + 1, c] + s2 * contact[row + 2, c]
            change = normal[j, pair] - springs[pair, 2]
            for c in range(size):
                force[row + 2, c] = change * contact[row + 2, c]
        form = contact.T @ force
        forms[j] = form
        inverses[j] = np.linalg.inv(np.eye(size) + weight @ form)


@njit(cache=True, nogil=True, error_model="numpy")
def _march(
    start: FloatArray,
    p: int,
    contact: FloatArray,
    keep: FloatArray,
    by_end: FloatArray,
    by_start: FloatArray,
    normal: FloatArray,
    springs: FloatArray,
    advance: FloatArray,
    force_start: FloatArray,
    force_end: FloatArray,
    weight: FloatArray,
    forms: FloatArray,
    inverses: FloatArray,
) -> FloatArray:
    """States (size, c) one period after ``start``, which is at sample 0."""
    n, pairs, size, columns = normal.shape[0], normal.shape[1], contact.shape[1], start.shape[1]
    transposed = np.ascontiguousarray(contact.T)
    motion = start[: 2 * p].copy()
    both = np.vstack((start[:p], start[2 * p : p + size]))
    traction = start[p + size :].copy()
    relative = contact @ both
    deviation = np.empty_like(relative)
    for pair in range(pairs):
        for a in range(2):
            deviation[3 * pair + a] = traction[2 * pair + a] - springs[pair, a] * relative[3 * pair + a]
        deviation[3 * pair + 2] = (normal[0, pair] - springs[pair, 2]) * relative[3 * pair + 2]
    force = -(transposed @ deviation)[:p]
    deviation[:] = 0.0
    for step in range(1, n + 1):
        j = step % n
        for pair in range(pairs):
            row, memory = 3 * pair, 2 * pair
            for a in range(2):
                k0, k1 = keep[j, pair, a, 0], keep[j, pair, a, 1]
                s0, s1, s2 = by_start[j, pair, a, 0], by_start[j, pair, a, 1], by_start[j, pair, a, 2]
                for c in range(columns):
                    deviation[row + a, c] = (
                        k0 * traction[memory, c] + k1 * traction[memory + 1, c]
                        + s0 * relative[row, c] + s1 * relative[row + 1, c] + s2 * relative[row + 2, c]
                    )  # fmt: skip
        past = transposed @ deviation
        motion = advance @ motion + force_start @ force
        known = -(weight @ past)
        known[:p] += motion[:p]
        both = inverses[j] @ known
        force = -(forms[j, :p] @ both + past[:p])
        motion += force_end @ force
        relative = contact @ both
        for pair in range(pairs):
            row, memory = 3 * pair, 2 * pair
            for a in range(2):
                s0, s1, s2 = by_end[j, pair, a, 0], by_end[j, pair, a, 1], by_end[j, pair, a, 2]
                for c in range(columns):
                    traction[memory + a, c] = (
                        deviation[row + a, c]
                        + s0 * relative[row, c] + s1 * relative[row + 1, c] + s2 * relative[row + 2, c]
                    )  # fmt: skip
    return np.vstack((motion, both[p:size], traction))
