"""Disturbances of one periodic motion, marched over a period, and the eigenvalues and eigenvectors of this march."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.law import BoolArray, IndexArray
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.validation import FloatArray
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


class Disturbances:
    """The march of disturbances over one period, without neutral ones, which have multipliers of exactly 1.

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
    omega:
        rad/s of the excitation.

    Attributes
    ----------
    values:
        the multipliers, the largest first; all that matter, and often more.
    """

    def __init__(
        self, model: StabilityModel, steps: LinearSteps, moving: IndexArray, sticks: BoolArray, omega: float
    ) -> None:
        steps, left = _states_of(steps, moving, model.springs)
        moving, sticks = moving[left], sticks[left]
        self._contact = np.hstack([model.near_contact, model.far_contact])
        self._period = None
        if not moving.size:
            self.values = stuck_multipliers(model, omega)
            return
        self._period = Period(model, steps, moving, omega)
        self._scale = self._period.scale(model, omega)[:, None]
        self._neutral = neutral_disturbances(model, steps, moving, sticks, omega, self._scale[:, 0])
        if self._period.size <= DENSE_SIZE:
            self._basis = np.eye(self._period.size)
            values, vectors = np.linalg.eig(self._march(self._basis))
        else:
            values, vectors, self._basis = _largest(self._march, self._period.size, 2 * model.frequency.size)
        order = np.argsort(-np.abs(values), kind="stable")
        self.values, self._vectors = values[order].astype(complex), vectors[:, order]

    def relative_motion(self, places: IndexArray, samples: IndexArray, pairs: IndexArray) -> FloatArray:
        """(s, q, 3, c) relative displacements of q pairs at ``samples`` 1 to n, ascending, in the disturbances of c
        real multipliers, which have these ``places`` among the values. A pair must deviate from its springs."""
        assert self._period is not None
        disturbances = self._basis @ self._vectors[:, places].real
        both = self._period.displacements(self._scale * self._neutral.before(disturbances), samples)
        rows = (3 * pairs[:, None] + np.arange(3)).ravel()
        return np.asarray((self._contact[rows] @ both).reshape(samples.size, pairs.size, 3, -1))

    def _march(self, scaled: FloatArray) -> FloatArray:
        assert self._period is not None
        moved = self._period.march(self._scale * self._neutral.before(scaled)) / self._scale
        return self._neutral.after(moved)


def stuck_multipliers(model: StabilityModel, omega: float) -> ComplexArray:
    """The multipliers ``exp(lambda T)`` of the modes of the stuck structure, the largest first."""
    count = model.modes
    matrix = np.zeros((2 * count, 2 * count))
    matrix[:count, count:] = np.eye(count)
    matrix[count:, :count] = -np.diag(model.frequency[:count] ** 2)
    matrix[count:, count:] = -model.damping[:count, :count]
    values = np.exp(2.0 * np.pi / omega * np.linalg.eigvals(matrix))
    return np.asarray(values[np.argsort(-np.abs(values), kind="stable")], dtype=complex)


def _states_of(steps: LinearSteps, moving: IndexArray, springs: FloatArray) -> tuple[LinearSteps, IndexArray]:
    """The steps of those of the ``moving`` pairs that deviate from their resting ``springs``, and their places there.

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
    return parts, left


def _arrays(steps: LinearSteps) -> tuple[FloatArray, ...]:
    """All arrays of the steps."""
    return steps.keep, steps.by_end, steps.by_start, steps.normal


def _largest(march: Marching, size: int, count: int) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """The largest eigenvalues, their eigenvectors in a basis, and this basis, by a block Krylov iteration (Y. Saad,
    Numerical Methods for Large Eigenvalue Problems, 2011, sec. 6.2), started from disturbances of the ``count`` states
    of the structure.

    Sliders forget within a period, so one march leads from there nearly into the space of the largest multipliers.
    """
    start = np.zeros((size, count))
    start[:count] = np.eye(count)
    block = _orthonormal(march(start), 0.0)
    basis = image = np.zeros((size, 0))
    values, vectors = np.zeros(0, dtype=complex), np.zeros((0, 0), dtype=complex)
    for _ in range(MOST_BLOCKS):
        basis, image = np.hstack([basis, block]), np.hstack([image, march(block)])
        values, vectors = np.linalg.eig(basis.T @ image)
        large = np.abs(values) > SMALLEST_SIZE
        errors = np.linalg.norm(image @ vectors[:, large] - basis @ (vectors[:, large] * values[large]), axis=0)
        if (errors <= RITZ_TOLERANCE).all():
            break
        latest = image[:, -block.shape[1] :]
        block = _orthonormal(latest - basis @ (basis.T @ latest), float(np.linalg.norm(latest)))
        # Normalising small directions brings back parts of the basis.
        block, _ = np.linalg.qr(block - basis @ (basis.T @ block))
        if not block.size:
            break
    return values, vectors, basis


def _orthonormal(block: FloatArray, size: float) -> FloatArray:
    """An orthonormal basis of the columns, without those that are round-off of a block of this norm."""
    directions, sizes, _ = np.linalg.svd(block, full_matrices=False)
    return np.asarray(directions[:, sizes > SMALLEST_DIRECTION * max(size, float(sizes[0]))])
