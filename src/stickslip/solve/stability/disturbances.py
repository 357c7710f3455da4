"""Disturbances of one periodic motion, marched over a period, and the eigenvalues and eigenvectors of this march."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.law import BoolArray, IndexArray
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.validation import FloatArray
from stickslip.solve.stability.march import Period
from stickslip.solve.stability.model import StabilityModel
from stickslip.solve.stability.neutral import neutral_disturbances
from stickslip.solve.stability.touched_limits import TouchedLimits

ComplexArray = NDArray[np.complex128]
Marching = Callable[[FloatArray], tuple[FloatArray, FloatArray]]

# Up to this number of states all eigenvalues are computed; chosen: the march of as many columns costs as much as the
# first two blocks of the iteration.
DENSE_SIZE = 64
# The relative imaginary part below which a multiplier is real.
REAL = 1e-7
# The iteration ends when the largest multipliers satisfy their equation to this accuracy, or after MOST_BLOCKS; those
# below SMALLEST_SIZE matter for no verdict. The error of a multiplier is about the square of that of its equation
# where the eigenvectors are not far from orthogonal.
RITZ_TOLERANCE, MOST_BLOCKS, SMALLEST_SIZE = 1e-4, 6, 0.5
# Directions of a block with less than this fraction of its length are round-off, which would enter the basis twice.
SMALLEST_DIRECTION = 1e-8


@dataclass(frozen=True)
class DisturbanceModes:
    """Eigenvalues of one march, the largest first: all that matter, and often more.

    Attributes
    ----------
    values:
        (c,) the multipliers.
    changes:
        (t, c) changes of traction at the touches in the eigenvectors, of energy 1: those where sliders follow, and
        those that following would cause elsewhere; over the root of the spring, so that they are roots of energies too.
    """

    values: ComplexArray
    changes: ComplexArray


class Disturbances:
    """The march of disturbances over one period, without neutral ones, which have multipliers of exactly 1.

    Pairs that stick and touch their limits make it many marches, one for each choice of touches at which sliders
    follow. One march has them all: where touching pairs stick, states X become ``E X`` and would change their tractions
    at the touches by ``c X``. Pushes a there become ``W a`` and change what other touches (and they themselves) see by
    ``C a``. So sliders that follow at some touches push by ``a = (1 - C)^-1 c X``, and X becomes ``E X + W a``.

    Parameters
    ----------
    model:
        of the curve.
    steps:
        of all pairs.
    moving:
        (k,) pairs whose steps may differ from their resting springs.
    sticks:
        (k,) those of them that the solution calls stuck.
    touching:
        (k,) those of these that touch their limits.
    omega:
        rad/s of the excitation.

    Attributes
    ----------
    limits:
        the t touches, whose pairs are places among ``pairs``.
    pairs:
        those of the ``moving`` pairs that deviate from their springs.
    """

    def __init__(
        self,
        model: StabilityModel,
        steps: LinearSteps,
        moving: IndexArray,
        sticks: BoolArray,
        touching: BoolArray,
        omega: float,
    ) -> None:
        self._steps, left = _states_of(steps, moving, touching, model.springs)
        moving, sticks, touching = moving[left], sticks[left], touching[left]
        self._model, self.pairs, self._sticks, self._omega = model, moving, sticks, omega
        self._springs = model.springs[moving]
        self.limits = TouchedLimits.of(self._steps, np.flatnonzero(touching), self._springs)
        self._known: dict[bytes, DisturbanceModes] = {}
        self._period: Period | None = None
        if not moving.size:
            return
        base = self._with_touches(np.zeros(self.n_touches, dtype=bool))
        self._period = Period(model, base, moving, omega)
        self._scale = self._period.scale(model, omega)[:, None]
        self._of_end, self._of_start, self._samples = self._displacements_at_touches()
        size = self._period.size
        self._is_dense = size <= DENSE_SIZE
        # All states, or those of the structure, from which the iteration starts whatever the sliders do.
        columns = size if self._is_dense else 2 * model.frequency.size
        end, change = self._marched(np.eye(size, columns + self.n_touches), pushed=True)
        self._base: tuple[FloatArray, FloatArray] = end[:, :columns], change[:, :columns]
        self._pushed, self._change_of_pushes = end[:, columns:], change[:, columns:]

    @property
    def n_touches(self) -> int:
        """Number t of touches."""
        return self.limits.step.size

    def modes(self, follow: BoolArray) -> DisturbanceModes:
        """Those if the sliders of touching pairs ``follow`` (t,) at some touches and stick else."""
        key = follow.tobytes()
        if key not in self._known:
            self._known[key] = self._modes(follow)
        return self._known[key]

    def _modes(self, follow: BoolArray) -> DisturbanceModes:
        if self._period is None:
            values = stuck_multipliers(self._model, self._omega)
            return DisturbanceModes(values, np.zeros((0, values.size), dtype=complex))
        neutral = neutral_disturbances(
            self._model, self._with_touches(follow), self.pairs, self._sticks, self._omega, self._scale[:, 0]
        )

        def followed(end: FloatArray, change: FloatArray) -> tuple[FloatArray, FloatArray]:
            pushes = self._pushes(change, follow)
            return neutral.after(end + self._pushed[:, follow] @ pushes), (
                change + self._change_of_pushes[:, follow] @ pushes
            )

        def march(states: FloatArray) -> tuple[FloatArray, FloatArray]:
            return followed(*self._if_all_stick(neutral.before(states)))

        if self._is_dense:
            matrix, of_states = march(np.eye(self._period.size))
            values, vectors = np.linalg.eig(matrix)
            changes = of_states @ vectors
        else:
            values, changes = _largest(march, followed(*self._base)[0])
        order = np.argsort(-np.abs(values), kind="stable")
        return DisturbanceModes(values[order].astype(complex), changes[:, order].astype(complex))

    def _pushes(self, change: FloatArray, follow: BoolArray) -> FloatArray:
        """Pushes by sliders that ``follow``, from the changes (t, c) without them."""
        seen = self._change_of_pushes[np.ix_(follow, follow)]
        return np.asarray(np.linalg.solve(np.eye(len(seen)) - seen, change[follow]))

    def _if_all_stick(self, states: FloatArray) -> tuple[FloatArray, FloatArray]:
        """States (size, c) after a period in which all touching pairs stick, and the changes (t, c) they would see."""
        if self._is_dense:
            return self._base[0] @ states, self._base[1] @ states
        return self._marched(states, pushed=False)

    def _with_touches(self, follow: BoolArray) -> LinearSteps:
        return self.limits.changed(self._steps, self._springs, follow) if self.n_touches else self._steps

    def _displacements_at_touches(self) -> tuple[FloatArray, FloatArray, IndexArray]:
        """(t, p + r) twice, changes at touches by near coordinates and far patterns after and before each step, and the
        samples (s,) at which these are required."""
        model, limits = self._model, self.limits
        contact = np.hstack([model.near_contact, model.far_contact]).reshape(len(model.springs), 3, -1)
        here = contact[self.pairs[limits.pair]]
        samples = np.unique(np.concatenate([limits.step, np.maximum(limits.step - 1, 1)]))
        return np.einsum("ta,tas->ts", limits.by_end, here), np.einsum("ta,tas->ts", limits.by_start, here), samples

    def _marched(self, states: FloatArray, pushed: bool) -> tuple[FloatArray, FloatArray]:
        """As :meth:`_if_all_stick` by a march; if ``pushed``, with a push of energy 1 at one touch each in the last t
        columns."""
        assert self._period is not None
        limits, count = self.limits, self.n_touches if pushed else 0
        push = limits.unit[:, None] * limits.direction
        start = self._scale * states
        start[:, start.shape[1] - count :] = 0.0
        end, seen = self._period.march(start, self._samples, limits.step[:count], limits.pair[:count], push[:count])
        p = self._model.frequency.size
        at_start = np.vstack([start[:p], start[2 * p : p + seen.shape[1]]])
        memory = start[len(start) - 2 * self.pairs.size :].reshape(self.pairs.size, 2, -1)
        change = np.empty((self.n_touches, states.shape[1]))
        for touch, step in enumerate(limits.step):
            place = int(np.searchsorted(self._samples, step))
            before = at_start if step == 1 else seen[place - 1]
            change[touch] = self._of_end[touch] @ seen[place] + self._of_start[touch] @ before
            change[touch] += limits.by_memory[touch] @ memory[limits.pair[touch]]
        # A push remains in the memory of its pair.
        for one in range(count):
            later = np.flatnonzero((limits.pair == limits.pair[one]) & (limits.step > limits.step[one]))
            change[later, states.shape[1] - count + one] += limits.by_memory[later] @ push[one]
        return end / self._scale, change / limits.unit[:, None]


def is_real(values: ComplexArray) -> BoolArray:
    """Which of some multipliers are real."""
    return np.asarray(np.abs(values.imag) <= REAL * np.abs(values))


def stuck_multipliers(model: StabilityModel, omega: float) -> ComplexArray:
    """The multipliers ``exp(lambda T)`` of the modes of the stuck structure, the largest first."""
    count = model.modes
    matrix = np.zeros((2 * count, 2 * count))
    matrix[:count, count:] = np.eye(count)
    matrix[count:, :count] = -np.diag(model.frequency[:count] ** 2)
    matrix[count:, count:] = -model.damping[:count, :count]
    values = np.exp(2.0 * np.pi / omega * np.linalg.eigvals(matrix))
    return np.asarray(values[np.argsort(-np.abs(values), kind="stable")], dtype=complex)


def _states_of(
    steps: LinearSteps, moving: IndexArray, touching: BoolArray, springs: FloatArray
) -> tuple[LinearSteps, IndexArray]:
    """The steps of those of the ``moving`` pairs that deviate from their resting ``springs``, and their places there.

    A direction that sticks through the period loses its memory, unless its pair is ``touching`` in the other one: its
    force is that of its spring, without a state.
    """
    parts = LinearSteps(*(np.take(each, moving, axis=1) for each in _arrays(steps)))
    for axis in range(2):
        unit = np.zeros(2)
        unit[axis] = 1.0
        sticks = np.flatnonzero((parts.keep[:, :, axis] == unit).all(axis=(0, 2)) & ~touching)
        parts.keep[:, sticks, axis], parts.by_start[:, sticks, axis] = 0.0, 0.0
        parts.by_end[:, sticks, axis] = 0.0
        parts.by_end[:, sticks, axis, axis] = springs[moving[sticks], axis]
    at_rest = np.zeros((moving.size, 2, 3))
    at_rest[:, (0, 1), (0, 1)] = springs[moving, :2]
    remembers = parts.keep.any(axis=(0, 2, 3)) | parts.by_start.any(axis=(0, 2, 3))
    deviates = (parts.by_end != at_rest).any(axis=(0, 2, 3)) | (parts.normal != springs[moving, 2]).any(axis=0)
    left = np.flatnonzero(remembers | deviates)
    if left.size < moving.size:
        parts = LinearSteps(*(np.take(each, left, axis=1) for each in _arrays(parts)))
    return parts, left


def _arrays(steps: LinearSteps) -> tuple[FloatArray, ...]:
    """All arrays of the steps."""
    return steps.keep, steps.by_end, steps.by_start, steps.normal


def _largest(march: Marching, first: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """The largest eigenvalues, and the changes at touches in their eigenvectors, by a block Krylov iteration (Y. Saad,
    Numerical Methods for Large Eigenvalue Problems, 2011, sec. 6.2), started from the ``first`` march, that of the
    states of the structure.

    Sliders forget within a period, so one march leads from there nearly into the space of the largest multipliers.
    """
    block = _orthonormal(first, 0.0)
    basis = image = np.zeros((len(first), 0))
    changes = []
    values, vectors = np.zeros(0, dtype=complex), np.zeros((0, 0), dtype=complex)
    for _ in range(MOST_BLOCKS):
        moved, change = march(block)
        basis, image = np.hstack([basis, block]), np.hstack([image, moved])
        changes.append(change)
        values, vectors = np.linalg.eig(basis.T @ image)
        large = np.abs(values) > SMALLEST_SIZE
        errors = np.linalg.norm(image @ vectors[:, large] - basis @ (vectors[:, large] * values[large]), axis=0)
        if (errors <= RITZ_TOLERANCE).all():
            break
        block = _orthonormal(moved - basis @ (basis.T @ moved), float(np.linalg.norm(moved)))
        # Normalising small directions brings back parts of the basis.
        block, _ = np.linalg.qr(block - basis @ (basis.T @ block))
        if not block.size:
            break
    return values, np.asarray(np.hstack(changes) @ vectors)


def _orthonormal(block: FloatArray, size: float) -> FloatArray:
    """An orthonormal basis of the columns, without those that are round-off of a block of this norm."""
    directions, sizes, _ = np.linalg.svd(block, full_matrices=False)
    return np.asarray(directions[:, sizes > SMALLEST_DIRECTION * max(size, float(sizes[0]))])
