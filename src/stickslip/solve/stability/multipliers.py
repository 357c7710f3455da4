"""The Floquet multipliers of one periodic motion: eigenvalues of the march over one period."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import ContactState, IndexArray
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.fourier import synthesis_matrix
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.stability.contact_steps import linear_steps
from stickslip.solve.stability.march import Period
from stickslip.solve.stability.model import StabilityModel
from stickslip.solve.stability.neutral import neutral_disturbances

ComplexArray = NDArray[np.complex128]
Marching = Callable[[FloatArray], FloatArray]

# Up to this number of states all eigenvalues are computed; chosen: the march of as many columns costs as much as the
# first two blocks of the iteration.
DENSE_SIZE = 64
# The iteration ends when the largest multipliers satisfy their equation to this accuracy, or after MOST_BLOCKS; those
# below SMALLEST_SIZE matter for no verdict. The error of a multiplier is about the square of that of its equation
# where the eigenvectors are not far from orthogonal.
RITZ_TOLERANCE, MOST_BLOCKS, SMALLEST_SIZE = 1e-4, 6, 0.5
# Directions of a block with less than this fraction of its length are round-off, which would enter the basis twice.
SMALLEST_DIRECTION = 1e-8
# The relative imaginary part below which a multiplier is real.
REAL = 1e-7
# chosen: a smaller growth in a period is within the error of the samples.
GROWS = 1e-3


class PointMultipliers:
    """The multipliers of a solution, from a march over a period in so many samples.

    A pair that sticks through the period is its springs: its slider is no state and has no multiplier 1. Neutral
    disturbances are omitted.

    A slider that has shaken down and only touches its limit follows a disturbance that goes farther, and does not come
    back. So it follows one that grows to one side, of a real multiplier above 0. One that changes its sign or rotates
    moves it once and does not touch it again until it is larger: if such a one seems to grow, the multipliers of
    touching pairs that stick decide.

    Attributes
    ----------
    values:
        the largest first; all that matter, and often more.
    """

    def __init__(self, model: StabilityModel, pairs: ContactPairs, trial: Trial, samples: int) -> None:
        # No cached properties: until Python 3.12 they share a lock, and threads would wait for each other.
        self._model, self._trial = model, trial
        self._moving = np.flatnonzero(trial.contact.moves.any(axis=1))
        self._touching = self._moving[:0]
        self._sticking: ComplexArray | None = None
        if not self._moving.size:
            self.values = stuck_multipliers(model, trial.omega)
            return
        self._steps = _steps_of_period(pairs, trial, samples)
        stuck = self._moving[trial.contact.state[self._moving] == ContactState.STUCK]
        self._touching = stuck[self._steps.keep[:, stuck].any(axis=(0, 2, 3))]
        self.values = _values_of(model, self._steps, self._moving, trial)
        to_one_side = _is_to_one_side(self.values)
        if self._touching.size and (np.abs(self.values[~to_one_side]) > 1.0).any():
            self._sticking = self._values_if_touching_pairs_stick()
            others = self._sticking[~_is_to_one_side(self._sticking)]
            self.values = _sorted(np.concatenate([self.values[to_one_side], others]))

    def may_leave_to_one_side(self) -> bool:
        """Whether a disturbance that takes touching pairs away from their limits would grow, beyond round-off.

        It meets a structure in which these pairs stick, of which ``values``, whose sliders follow, say nothing. A pair
        that touches both limits, or several that touch theirs with opposite disturbances, may still hold it.
        """
        if not self._touching.size:
            return False
        sticking = self._values_if_touching_pairs_stick() if self._sticking is None else self._sticking
        return bool((sticking[_is_to_one_side(sticking)].real > 1.0 + GROWS).any())

    def _values_if_touching_pairs_stick(self) -> ComplexArray:
        """The multipliers if stuck pairs that touch their limit stick there too; it changes the steps."""
        self._steps.keep[:, self._touching] = np.eye(2)
        return _values_of(self._model, self._steps, self._moving, self._trial)


def _steps_of_period(pairs: ContactPairs, trial: Trial, samples: int) -> LinearSteps:
    """The steps of all pairs through the period of a solution."""
    coefficients = trial.relative.T.reshape(pairs.n_pairs, 3, -1)
    harmonics = coefficients.shape[2] // 2
    return linear_steps(pairs, np.moveaxis(coefficients @ synthesis_matrix(harmonics, samples).T, 2, 0))


def _is_to_one_side(values: ComplexArray) -> NDArray[np.bool_]:
    """Which multipliers are those of a disturbance that remains on one side: real ones above 0."""
    return is_real(values) & (values.real > 0.0)


def is_real(values: ComplexArray) -> NDArray[np.bool_]:
    """Which of some multipliers are real."""
    return np.asarray(np.abs(values.imag) <= REAL * np.abs(values))


def _values_of(model: StabilityModel, steps: LinearSteps, moving: IndexArray, trial: Trial) -> ComplexArray:
    """The eigenvalues of the march over the steps of all pairs, of which some are ``moving``."""
    steps, moving = _states_of(steps, moving, model.springs)
    if not moving.size:
        return stuck_multipliers(model, trial.omega)
    period = Period(model, steps, moving, trial.omega)
    scale = period.scale(model, trial.omega)
    sticks = trial.contact.state[moving] == ContactState.STUCK
    neutral = neutral_disturbances(model, steps, moving, sticks, trial.omega, scale)

    def march(scaled: FloatArray) -> FloatArray:
        moved = period.march(scale[:, None] * neutral.before(scaled)) / scale[:, None]
        return neutral.after(moved)

    if period.size <= DENSE_SIZE:
        return _sorted(np.linalg.eigvals(march(np.eye(period.size))))
    return _sorted(_largest(march, period.size, 2 * model.frequency.size))


def _sorted(values: NDArray[Any]) -> ComplexArray:
    """The largest first."""
    return np.asarray(values[np.argsort(-np.abs(values), kind="stable")], dtype=complex)


def stuck_multipliers(model: StabilityModel, omega: float) -> ComplexArray:
    """The multipliers ``exp(lambda T)`` of the modes of the stuck structure, the largest first."""
    count = model.modes
    matrix = np.zeros((2 * count, 2 * count))
    matrix[:count, count:] = np.eye(count)
    matrix[count:, :count] = -np.diag(model.frequency[:count] ** 2)
    matrix[count:, count:] = -model.damping[:count, :count]
    return _sorted(np.exp(2.0 * np.pi / omega * np.linalg.eigvals(matrix)))


def _states_of(steps: LinearSteps, moving: IndexArray, springs: FloatArray) -> tuple[LinearSteps, IndexArray]:
    """The steps of those of the ``moving`` pairs that deviate from their resting ``springs``, and which they are.

    A direction that sticks through the period loses its memory: its force is that of its spring, without a state.
    """
    parts = LinearSteps(*(np.take(each, moving, axis=1) for each in _arrays(steps)))
    for axis in range(2):
        unit = np.zeros(2)
        unit[axis] = 1.0
        sticks = np.flatnonzero((parts.keep[:, :, axis] == unit).all(axis=(0, 2)))
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
    return parts, moving[left]


def _arrays(steps: LinearSteps) -> tuple[FloatArray, ...]:
    """All arrays of the steps."""
    return steps.keep, steps.by_end, steps.by_start, steps.normal


def _largest(march: Marching, size: int, count: int) -> ComplexArray:
    """The largest eigenvalues by a block Krylov iteration (Y. Saad, Numerical Methods for Large Eigenvalue Problems,
    2011, sec. 6.2), started from disturbances of the ``count`` states of the structure.

    Sliders forget within a period, so one march leads from there nearly into the space of the largest multipliers.
    """
    start = np.zeros((size, count))
    start[:count] = np.eye(count)
    block = _orthonormal(march(start), 0.0)
    basis = image = np.zeros((size, 0))
    values = np.zeros(0, dtype=complex)
    for _ in range(MOST_BLOCKS):
        basis, image = np.hstack([basis, block]), np.hstack([image, march(block)])
        values, vectors = np.linalg.eig(basis.T @ image)
        errors = np.linalg.norm(image @ vectors - basis @ (vectors * values), axis=0)
        if (errors[np.abs(values) > SMALLEST_SIZE] <= RITZ_TOLERANCE).all():
            break
        latest = image[:, -block.shape[1] :]
        block = _orthonormal(latest - basis @ (basis.T @ latest), float(np.linalg.norm(latest)))
        # Normalising small directions brings back parts of the basis.
        block, _ = np.linalg.qr(block - basis @ (basis.T @ block))
        if not block.size:
            break
    return values


def _orthonormal(block: FloatArray, size: float) -> FloatArray:
    """An orthonormal basis of the columns, without those that are round-off of a block of this norm."""
    directions, sizes, _ = np.linalg.svd(block, full_matrices=False)
    return np.asarray(directions[:, sizes > SMALLEST_DIRECTION * max(size, float(sizes[0]))])
