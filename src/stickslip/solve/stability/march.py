"""One period of the disturbed motion: the near coordinates between samples, the laws by their linear steps.

Between samples the forces on the near coordinates vary linearly (first-order hold), so a structure whose pairs all
stick has exactly the multipliers of its modes. The forces at the end of a step follow from the displacements there, and
these from the forces: one small linear system for each step, in the near coordinates and the far patterns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.contact.law.law import IndexArray
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray
from stickslip.solve.stability.model import StabilityModel

# Fast coordinates have no damping of their own, and their sizes change with each contact event by their phase, which no
# reduced model predicts: without damping they have false multipliers outside of the unit circle, other ones for each
# number of samples. The damping is RELAXATION / omega times the rate of the force of the current contact (Newmark's
# gamma = 1/2 + relaxation / step, N. M. Newmark, J. Eng. Mech. Div. 85 (1959) 67). Chosen: 1 % of critical at ten times
# the excitation and 0.1 % at the excitation. A joint that slides has no such force, so it gets no dashpot across it.
RELAXATION = 2e-3
# What a pair does in a step: its slider stays, its force depends on the end alone, or both.
STAYS, MEMORYLESS, GENERAL = 0, 1, 2
KindArray = NDArray[np.int8]


@dataclass(frozen=True)
class FreeStep:
    """``(q, v)_(j+1) = advance (q, v, g)_j + by_end g_(j+1)`` of the near coordinates under forces g."""

    advance: FloatArray  # (2p, 3p)
    by_end: FloatArray  # (2p, p)


def free_step(model: StabilityModel, time_step: float, omega: float) -> FreeStep:
    """The step of the near coordinates in ``time_step`` s under an excitation at ``omega`` rad/s."""
    p = model.frequency.size
    slow, fast = np.arange(model.modes), np.arange(model.modes, p)
    advance, by_end = np.zeros((2 * p, 3 * p)), np.zeros((2 * p, p))
    for group, parts in (
        (slow, _held(model.frequency[slow], model.damping[np.ix_(slow, slow)], time_step)),
        (fast, _newmark(model.frequency[fast], np.diag(model.damping)[fast], time_step, RELAXATION / omega)),
    ):
        both = np.concatenate([group, p + group])
        advance[np.ix_(both, both)] = parts[0]
        advance[np.ix_(both, 2 * p + group)], by_end[np.ix_(both, group)] = parts[1], parts[2]
    return FreeStep(advance, by_end)


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


def _newmark(
    frequency: FloatArray, damping: FloatArray, time_step: float, relaxation: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Newmark's method for each coordinate alone; its coupling to others by damping is omitted."""
    h, gamma = time_step, 0.5 + relaxation / time_step
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
    """The march over one period of disturbances ``(q, v, s, d)``: p + p + r + 2k states with k moving pairs.

    d is the deviation of the tangential force from the resting springs; it stays while a pair sticks.

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
        free = free_step(model, 2.0 * np.pi / omega / samples, omega)
        self._p, self._r, self._k = model.frequency.size, model.far_contact.shape[1], moving.size
        self._springs = np.ascontiguousarray(model.springs[moving])
        contact = np.hstack([model.near_contact, model.far_contact])[rows].reshape(self._k, 3, -1)
        arrays = (steps.keep, steps.by_end, steps.by_start, steps.normal)
        keep, by_end, by_start, normal = (np.ascontiguousarray(each) for each in arrays)
        kinds = np.empty(normal.shape, dtype=np.int8)
        _classify(keep, by_end, by_start, self._springs, kinds)
        size = self._p + self._r
        forms, changed = np.empty((samples, size, size)), np.empty(samples, dtype=np.bool_)
        _prepare(contact, by_end, normal, self._springs, forms, changed)
        matrices = forms[changed]
        of_near = np.ascontiguousarray(free.by_end[: self._p])
        matrices[:, : self._p] = of_near @ matrices[:, : self._p]
        matrices += np.eye(size)
        self._arguments = (
            contact, kinds, keep, by_end, by_start, normal, self._springs, free.advance, free.by_end, of_near,
            np.ascontiguousarray(forms[:, : self._p]), np.linalg.inv(matrices), np.cumsum(changed) - 1,
        )  # fmt: skip

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

    def march(
        self, states: FloatArray, samples: IndexArray, step: IndexArray, pair: IndexArray, push: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """States (size, c) one period later, and (s, p + r, c) the near coordinates and far patterns at ``samples``
        from 1 to n, ascending.

        In the last t columns one deviation each gets a ``push`` (t, 2) N in a ``step`` (t,), 1 to n, ascending; such a
        ``pair`` (t,) must stick through the period.
        """
        seen = np.empty((samples.size, self._p + self._r, states.shape[1]))
        end: FloatArray = _march(
            np.ascontiguousarray(states), samples, seen, step, pair, push, self._p, *self._arguments
        )
        return end, seen


@njit(cache=True, nogil=True, error_model="numpy")
def _gathered(rows: FloatArray, values: FloatArray, count: int) -> FloatArray:
    """``rows^T values`` of the first ``count`` rows; a function of its own compiles once."""
    product: FloatArray = np.dot(rows[:count].T, values[:count])
    return product


@njit(cache=True, nogil=True, error_model="numpy")
def _copy(source: FloatArray, first: int, count: int, factor: float, target: FloatArray, place: int) -> None:
    """Write ``factor`` times ``count`` rows of ``source`` from ``first`` on to ``target``; loops compile quicker than
    slices."""
    for row in range(count):
        for c in range(source.shape[1]):
            target[place + row, c] = factor * source[first + row, c]


@njit(cache=True, nogil=True, error_model="numpy")
def _classify(
    keep: FloatArray, by_end: FloatArray, by_start: FloatArray, springs: FloatArray, kinds: KindArray
) -> None:
    """Fill the kinds (n, k) of the steps."""
    for j in range(kinds.shape[0]):
        for pair in range(kinds.shape[1]):
            stays, memoryless = True, True
            for a in range(2):
                for b in range(2):
                    unit = 1.0 if a == b else 0.0
                    stays &= keep[j, pair, a, b] == unit
                    memoryless &= keep[j, pair, a, b] == 0.0
                for b in range(3):
                    spring = springs[pair, a] if a == b else 0.0
                    stays &= by_end[j, pair, a, b] == spring and by_start[j, pair, a, b] == -spring
                    memoryless &= by_start[j, pair, a, b] == 0.0
            kinds[j, pair] = STAYS if stays else MEMORYLESS if memoryless else GENERAL


@njit(cache=True, nogil=True, error_model="numpy")
def _prepare(
    contact: FloatArray,
    by_end: FloatArray,
    normal: FloatArray,
    springs: FloatArray,
    forms: FloatArray,
    changed: NDArray[np.bool_],
) -> None:
    """Fill ``X^T S_j X`` of the n samples, and which of them differ from the one before; S_j is the stiffness of the
    deviation.

    From sample to sample only the pairs whose stiffness changes contribute.
    """
    pairs, size = contact.shape[0], contact.shape[2]
    change, before = np.zeros((3, 3)), np.zeros((pairs, 3, 3))
    rows, force = np.empty((3 * pairs, size)), np.empty((3 * pairs, size))
    form = np.zeros((size, size))
    for j in range(normal.shape[0]):
        count = 0
        for pair in range(pairs):
            same = True
            for a in range(3):
                for b in range(3):
                    value = normal[j, pair] if b == 2 else 0.0
                    if a < 2:
                        value = by_end[j, pair, a, b]
                    if a == b:
                        value -= springs[pair, a]
                    change[a, b] = value - before[pair, a, b]
                    same &= change[a, b] == 0.0
                    before[pair, a, b] = value
            if same:
                continue
            for a in range(3):
                for column in range(size):
                    rows[count + a, column] = contact[pair, a, column]
                    force[count + a, column] = (
                        change[a, 0] * contact[pair, 0, column]
                        + change[a, 1] * contact[pair, 1, column]
                        + change[a, 2] * contact[pair, 2, column]
                    )
            count += 3
        if count:
            form += _gathered(rows, force, count)
        forms[j], changed[j] = form, count > 0 or j == 0


@njit(cache=True, nogil=True, error_model="numpy")
def _march(
    start: FloatArray,
    samples: IndexArray,
    seen: FloatArray,
    pushed_step: IndexArray,
    pushed_pair: IndexArray,
    push: FloatArray,
    p: int,
    contact: FloatArray,
    kinds: KindArray,
    keep: FloatArray,
    by_end: FloatArray,
    by_start: FloatArray,
    normal: FloatArray,
    springs: FloatArray,
    advance: FloatArray,
    force_end: FloatArray,
    of_near: FloatArray,
    forms: FloatArray,
    inverses: FloatArray,
    which: IndexArray,
) -> FloatArray:
    """States (size, c) one period after ``start``, which is at sample 0; fills the displacements ``seen`` (s, size, c)
    at some ``samples`` (s,); pushes pairs that stay, in the last columns."""
    n, pairs, size, columns = normal.shape[0], normal.shape[1], contact.shape[2], start.shape[1]
    # Constants of another type: numba would compile _copy for each of them.
    zero, one, two, three = np.int64(0), np.int64(1), np.int64(2), np.int64(3)
    rows, values = np.empty((3 * pairs, size)), np.empty((3 * pairs, columns))
    listed = np.empty(pairs, dtype=np.int64)
    directions = contact.reshape(3 * pairs, size)
    both, memory = np.empty((size, columns)), np.empty((2 * pairs, columns))
    _copy(start, zero, p, 1.0, both, zero)
    _copy(start, 2 * p, size - p, 1.0, both, p)
    _copy(start, p + size, 2 * pairs, 1.0, memory, zero)
    relative = np.dot(directions, both)
    # The force at sample 0, and the part of it of the pairs that stay.
    staying, known = np.zeros((size, columns)), np.empty((size, columns))
    for pair in range(pairs):
        _copy(memory, 2 * pair, two, 1.0, values, 3 * pair)
        _copy(relative, 3 * pair + 2, one, normal[0, pair] - springs[pair, 2], values, 3 * pair + 2)
    state = np.empty((3 * p, columns))
    _copy(start, zero, 2 * p, 1.0, state, zero)
    _copy(_gathered(directions, values, 3 * pairs), zero, p, -1.0, state, 2 * p)
    place, pushes, count = 0, 0, 0
    for pair in range(pairs):
        if kinds[1 % n, pair] == STAYS:
            _copy(directions, 3 * pair, two, 1.0, rows, count)
            _copy(memory, 2 * pair, two, 1.0, values, count)
            count += 2
    if count:
        staying += _gathered(rows, values, count)
    for step in range(1, n + 1):
        j, after = step % n, (step + 1) % n
        while pushes < len(pushed_step) and pushed_step[pushes] == step:
            pair, column = pushed_pair[pushes], columns - len(pushed_step) + pushes
            for a in range(2):
                memory[2 * pair + a, column] += push[pushes, a]
                for row in range(size):
                    staying[row, column] += push[pushes, a] * directions[3 * pair + a, row]
            pushes += 1
        # What the deviations at the end do not depend on.
        count = 0
        for pair in range(pairs):
            if kinds[j, pair] != GENERAL:
                continue
            _copy(directions, 3 * pair, two, 1.0, rows, count)
            for a in range(2):
                k0, k1 = keep[j, pair, a, 0], keep[j, pair, a, 1]
                # The memory is the deviation from the resting springs, not the traction.
                s0 = by_start[j, pair, a, 0] + k0 * springs[pair, 0]
                s1 = by_start[j, pair, a, 1] + k1 * springs[pair, 1]
                s2 = by_start[j, pair, a, 2]
                for c in range(columns):
                    values[count + a, c] = (
                        k0 * memory[2 * pair, c] + k1 * memory[2 * pair + 1, c] + s0 * relative[3 * pair, c]
                        + s1 * relative[3 * pair + 1, c] + s2 * relative[3 * pair + 2, c]
                    )  # fmt: skip
            _copy(values, count, two, 1.0, memory, 2 * pair)
            count += 2
        past = staying
        if count:
            past = staying + _gathered(rows, values, count)
        motion, moved_by = np.dot(advance, state), np.dot(of_near, past[:p])
        for row in range(size):
            for c in range(columns):
                known[row, c] = motion[row, c] - moved_by[row, c] if row < p else -past[row, c]
        both = np.dot(inverses[which[j]], known)
        if place < len(samples) and samples[place] == step:
            seen[place] = both
            place += 1
        force = np.dot(forms[j], both)
        force += past[:p]
        motion -= np.dot(force_end, force)
        _copy(motion, zero, 2 * p, 1.0, state, zero)
        _copy(force, zero, p, -1.0, state, 2 * p)
        # Displacements of the pairs whose memory depends on them, or does in the next step.
        count = 0
        for pair in range(pairs):
            here, there = kinds[j, pair], kinds[after, pair]
            if here == GENERAL or there == GENERAL or (here == MEMORYLESS and there == STAYS) or step == n:
                _copy(directions, 3 * pair, three, 1.0, rows, 3 * count)
                listed[count] = pair
                count += 1
        if count:
            moved = np.dot(rows[: 3 * count], both)
            for each in range(count):
                _copy(moved, 3 * each, three, 1.0, relative, 3 * listed[each])
        for each in range(count):
            pair = listed[each]
            if kinds[j, pair] == STAYS:
                continue
            for a in range(2):
                s0, s1, s2 = by_end[j, pair, a, 0], by_end[j, pair, a, 1], by_end[j, pair, a, 2]
                if a == 0:
                    s0 -= springs[pair, 0]
                else:
                    s1 -= springs[pair, 1]
                past_part = 1.0 if kinds[j, pair] == GENERAL else 0.0
                for c in range(columns):
                    memory[2 * pair + a, c] = (
                        past_part * memory[2 * pair + a, c] + s0 * relative[3 * pair, c]
                        + s1 * relative[3 * pair + 1, c] + s2 * relative[3 * pair + 2, c]
                    )  # fmt: skip
        # Sliders that begin or cease to stay.
        count = 0
        for pair in range(pairs):
            here, there = kinds[j, pair], kinds[after, pair]
            if (here == STAYS) != (there == STAYS):
                _copy(directions, 3 * pair, two, 1.0, rows, count)
                _copy(memory, 2 * pair, two, 1.0 if there == STAYS else -1.0, values, count)
                count += 2
        if count:
            staying += _gathered(rows, values, count)
    end = np.empty(start.shape)
    _copy(state, zero, 2 * p, 1.0, end, zero)
    _copy(both, p, size - p, 1.0, end, 2 * p)
    _copy(memory, zero, 2 * pairs, 1.0, end, p + size)
    return end
