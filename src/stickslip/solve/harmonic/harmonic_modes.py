"""The modes of the stuck structure as the balance uses them, harmonic by harmonic.

A structure has the same matrices, and so the same real modes, in every harmonic (:class:`SharedModes`). In a sector of
a disk each harmonic has those of its own nodal diameter (:mod:`stickslip.solve.cyclic.lagged_modes`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.gain import ComplexArray, adjoint_gain, times_gain, with_gain
from stickslip.solve.harmonic.large_newton import (
    LargeNewtonCompliance,
    MeanDifference,
    mean_difference,
)
from stickslip.solve.harmonic.row_products import row_products

IndexArray = NDArray[np.int64]

# chosen: joints of fewer rows are solved as quickly in double precision, without a preconditioner of low rank
# (docs/performance.md).
LARGE_ROWS = 1000


class NewtonOperator(Protocol):
    """``A`` for the Newton matrix: all m rows, and the columns on which the deviation can change (k of them).

    Modes far above the excitation are springs here (see :data:`stickslip.solve.harmonic.compliance.NEAR_RANGE`).
    """

    @property
    def mean(self) -> FloatArray:
        """(k, m) A of the mean."""

    def apply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation: (2H+1, m) from (2H+1, k)."""

    def apply_at(self, deviation: FloatArray, rows: IndexArray) -> FloatArray:
        """A @ deviation at some rows: (2H+1, r) from (2H+1, k)."""

    def apply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: (2H+1, k) from (2H+1, m)."""

    def block(self, order: int, rows: IndexArray) -> ComplexArray:
        """``A_h`` (rows, k) of harmonic ``order`` >= 1."""


class HarmonicModes(Protocol):
    """Mass-normalised modes of each harmonic; n modes, m rows of pairs, coefficients (2H, ...) without the mean."""

    def of_force(self, force: FloatArray) -> FloatArray:
        """(2H, n) modal forces of forces (2H, n) on the unknowns."""

    def of_contact(self, force: FloatArray) -> FloatArray:
        """(2H, n) modal forces of forces (2H, m) on the pairs."""

    def relative(self, amplitude: FloatArray, out: FloatArray) -> None:
        """Write the relative displacements (2H, m) of amplitudes (2H, n) to ``out``."""

    def displacement(self, amplitude: FloatArray) -> FloatArray:
        """(..., 2H, n) displacements of amplitudes (..., 2H, n)."""

    def newton(self, mean_contact: FloatArray, columns: IndexArray, gain: ComplexArray) -> NewtonOperator:
        """A for deviations on ``columns``, with the compliance (m, m) of the mean and the gains of the near modes."""

    def low_rank(
        self, rows: IndexArray, columns: IndexArray, gain: ComplexArray, compliance: float
    ) -> LowRankCompliance | None:
        """The near modes that are softer than a ``compliance`` in m/N in any harmonic, at ``rows`` and for deviations
        on ``columns``; None if the harmonics have different modes."""


@dataclass(frozen=True)
class NewtonCompliance:
    """``A`` of modes that all harmonics share, see :class:`NewtonOperator`."""

    mean: FloatArray  # (k, m)
    far: FloatArray  # (k, m) static compliance of the far modes
    left: FloatArray  # (m, p) near modes at all rows
    right: FloatArray  # (k, p) near modes at the columns
    gain: ComplexArray  # (H, p) or (H, p, p)

    def apply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation: (2H+1, m) from (2H+1, k)."""
        answer = np.empty((deviation.shape[0], self.far.shape[1]))
        answer[0] = deviation[0] @ self.mean
        near = times_gain(self.gain, deviation[1:] @ self.right)
        np.matmul(deviation[1:], self.far, out=answer[1:])
        answer[1:] += near @ self.left.T
        return answer

    def apply_at(self, deviation: FloatArray, rows: IndexArray) -> FloatArray:
        """A @ deviation at some rows: (2H+1, r) from (2H+1, k)."""
        return self.apply(deviation)[:, rows]

    def apply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: (2H+1, k) from (2H+1, m); that of complex amplitudes is the adjoint."""
        answer = np.empty((weights.shape[0], self.far.shape[0]))
        answer[0] = self.mean @ weights[0]
        near = times_gain(adjoint_gain(self.gain), weights[1:] @ self.left)
        answer[1:] = weights[1:] @ self.far.T + near @ self.right.T
        return answer

    def block(self, order: int, rows: IndexArray) -> ComplexArray:
        """``A_h`` (rows, k) of harmonic ``order`` >= 1."""
        return with_gain(self.gain[order - 1], self.left[rows], self.right) + self.far[:, rows].T


@dataclass(frozen=True)
class LocalCompliance:
    """The compliance within groups of r consecutive rows, the same in each: ``mean`` and ``far`` (r, r) m/N, that of
    the harmonics."""

    mean: FloatArray
    far: FloatArray


@dataclass(frozen=True)
class LowRankCompliance:
    """``A_0 = L G L^T`` of each harmonic, and ``L L^T`` of the mean; m rows of moving pairs and k of the unknowns.

    ``mean`` (m, c_0) and ``left`` (m, c) are L at these rows, ``mean_right`` and ``right`` at those of the unknowns;
    ``gain`` is (H, c) or (H, c, c). Amplitudes are (c_0 + 2 H c,). A ``local`` compliance is added to it.
    """

    mean: FloatArray
    mean_right: FloatArray
    left: FloatArray
    right: FloatArray
    gain: ComplexArray
    local: LocalCompliance | None = None

    def relative(self, amplitude: FloatArray) -> FloatArray:
        """``L z`` (2H+1, m) of amplitudes."""
        first, rest = np.split(amplitude, [self.mean.shape[1]])
        return np.vstack([self.mean @ first, rest.reshape(-1, self.left.shape[1]) @ self.left.T])

    def amplitude(self, deviation: FloatArray) -> FloatArray:
        """``G L^T v`` of unknowns (2H+1, k)."""
        return np.append(deviation[0] @ self.mean_right, times_gain(self.gain, deviation[1:] @ self.right))


class SharedModes:
    """Real modes of the stuck structure that all harmonics share.

    Parameters
    ----------
    modes, contact:
        (n, n) and (m, n), the modes and their relative displacements.
    circular_frequency:
        (n,) rad/s.
    near:
        number of modes that are not springs in Newton's matrix.
    mean_shapes:
        returns the softest shapes (m, c) of the mean, with the roots of their compliance as lengths.
    rest:
        (m, m) m/N, static compliance of modes that are not among these; all of these are then near.
    difference:
        what the mean has beside the compliance of the modes that are not near, if it is known.
    """

    def __init__(
        self,
        modes: FloatArray,
        contact: FloatArray,
        circular_frequency: FloatArray,
        near: int,
        mean_shapes: Callable[[], FloatArray],
        rest: FloatArray | None = None,
        difference: MeanDifference | None = None,
    ) -> None:
        self.modes, self.contact, self.mean_shapes = modes, np.ascontiguousarray(contact), mean_shapes
        self._circular_frequency, self._rest = circular_frequency, rest
        all_near = near == contact.shape[1]  # then one array, also of the difference of KeptModes
        self._near_contact = self.contact if all_near else np.ascontiguousarray(contact[:, :near])
        self._many_rows = len(contact) >= LARGE_ROWS and rest is None
        self._cached: tuple[bytes, FloatArray, FloatArray] | None = None
        self._difference: tuple[MeanDifference | None] | None = None if difference is None else (difference,)

    @cached_property
    def _far(self) -> FloatArray:
        """(m, m) static compliance of the modes that are springs in Newton's matrix."""
        if self._rest is not None:
            return self._rest
        near = self._near_contact.shape[1]
        far = self.contact[:, near:]
        return np.asarray((far / self._circular_frequency[near:] ** 2) @ far.T)

    @cached_property
    def _single_far(self) -> NDArray[np.float32]:
        return np.ascontiguousarray(self._far, dtype=np.float32)

    @cached_property
    def _by_mode(self) -> FloatArray:
        """(n, m) modes at the contact, one in each row."""
        return np.ascontiguousarray(self.contact.T)

    @property
    def has_mean(self) -> bool:
        """Whether these modes contain the mean of a large joint, so that it needs no compliance of its own."""
        return len(self.contact) >= LARGE_ROWS and self._difference is not None and self._difference[0] is not None

    def of_force(self, force: FloatArray) -> FloatArray:
        """See :class:`HarmonicModes`."""
        return np.asarray(force @ self.modes)

    def of_contact(self, force: FloatArray) -> FloatArray:
        """See :class:`HarmonicModes`; most forces are on few rows."""
        columns = np.flatnonzero(force.any(axis=0))
        if 2 * columns.size < force.shape[1]:
            return np.asarray(force[:, columns] @ self.contact[columns])
        if self._many_rows:
            return row_products(self._by_mode, force)
        return np.asarray(force @ self.contact)

    def relative(self, amplitude: FloatArray, out: FloatArray) -> None:
        """See :class:`HarmonicModes`."""
        if self._many_rows:
            out[...] = row_products(self.contact, amplitude)
        else:
            np.matmul(amplitude, self.contact.T, out=out)

    def displacement(self, amplitude: FloatArray) -> FloatArray:
        """See :class:`HarmonicModes`."""
        shape = amplitude.shape
        return np.asarray((amplitude.reshape(-1, shape[-1]) @ self.modes.T).reshape(*shape[:-1], -1))

    def low_rank(
        self, rows: IndexArray, columns: IndexArray, gain: ComplexArray, compliance: float
    ) -> LowRankCompliance:
        """See :class:`HarmonicModes`."""
        own = np.abs(gain if gain.ndim == 2 else np.einsum("hii->hi", gain)).max(axis=0)
        chosen = np.flatnonzero(own * (self._near_contact**2).sum(axis=0) > compliance)
        part = gain[:, chosen] if gain.ndim == 2 else gain[:, chosen[:, None], chosen]
        mean, left = self.mean_shapes(), self._near_contact[:, chosen]
        return LowRankCompliance(mean[rows], mean[columns], left[rows], left[columns], part)

    def newton(self, mean_contact: FloatArray, columns: IndexArray, gain: ComplexArray) -> NewtonOperator:
        """See :class:`HarmonicModes`."""
        near = self._near_contact
        # an operator with all modes is that of an adjoint solution, whose factor has no residual to correct it
        has_far = self._rest is not None or near.shape[1] < self.contact.shape[1]
        if len(mean_contact) >= LARGE_ROWS and has_far:
            difference = self._mean_difference(mean_contact)
            part = mean_contact if difference is None else difference
            return LargeNewtonCompliance(part, self._single_far, columns, near, near[columns], gain)
        key = columns.tobytes()
        if self._cached is None or self._cached[0] != key:
            self._cached = key, mean_contact[columns], self._far[columns]
        _, mean, far = self._cached
        return NewtonCompliance(mean, far, near, near[columns], gain)

    def _mean_difference(self, mean_contact: FloatArray) -> MeanDifference | None:
        """See :func:`mean_difference`; computed once."""
        if self._difference is None:
            self._difference = (mean_difference(mean_contact, self._far),)
        return self._difference[0]
