"""The modes of the stuck structure as the balance uses them, harmonic by harmonic.

A structure has the same matrices, and so the same real modes, in every harmonic (:class:`SharedModes`). In a sector of
a disk each harmonic has those of its own nodal diameter (:mod:`stickslip.solve.cyclic.lagged_modes`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.gain import ComplexArray, times_gain

IndexArray = NDArray[np.int64]


class NewtonOperator(Protocol):
    """``A`` for the Newton matrix: all m rows, and the columns on which the deviation can change (k of them).

    Modes far above the excitation are springs here (see :data:`stickslip.solve.harmonic.compliance.NEAR_RANGE`).
    """

    @property
    def mean(self) -> FloatArray:
        """(k, m) A of the mean."""

    def apply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation: (2H+1, m) from (2H+1, k)."""

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

    def apply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: (2H+1, k) from (2H+1, m); that of complex amplitudes is the adjoint."""
        answer = np.empty((weights.shape[0], self.far.shape[0]))
        answer[0] = self.mean @ weights[0]
        near = times_gain(
            self.gain.conj().swapaxes(-1, -2) if self.gain.ndim == 3 else self.gain.conj(), weights[1:] @ self.left
        )
        answer[1:] = weights[1:] @ self.far.T + near @ self.right.T
        return answer

    def block(self, order: int, rows: IndexArray) -> ComplexArray:
        """``A_h`` (rows, k) of harmonic ``order`` >= 1."""
        gain, left = self.gain[order - 1], self.left[rows]
        real, imaginary = (left @ part if part.ndim == 2 else left * part for part in (gain.real, gain.imag))
        return np.asarray(real @ self.right.T + self.far[:, rows].T + 1j * (imaginary @ self.right.T))


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
    """

    def __init__(self, modes: FloatArray, contact: FloatArray, circular_frequency: FloatArray, near: int) -> None:
        self.modes, self.contact = modes, contact
        far = contact[:, near:]
        self._far = (far / circular_frequency[near:] ** 2) @ far.T
        self._near_contact = np.ascontiguousarray(contact[:, :near])
        self._cached: tuple[bytes, FloatArray, FloatArray] | None = None

    def of_force(self, force: FloatArray) -> FloatArray:
        """See :class:`HarmonicModes`."""
        return np.asarray(force @ self.modes)

    def of_contact(self, force: FloatArray) -> FloatArray:
        """See :class:`HarmonicModes`; most forces are on few rows."""
        columns = np.flatnonzero(force.any(axis=0))
        if 2 * columns.size < force.shape[1]:
            return np.asarray(force[:, columns] @ self.contact[columns])
        return np.asarray(force @ self.contact)

    def relative(self, amplitude: FloatArray, out: FloatArray) -> None:
        """See :class:`HarmonicModes`."""
        np.matmul(amplitude, self.contact.T, out=out)

    def displacement(self, amplitude: FloatArray) -> FloatArray:
        """See :class:`HarmonicModes`."""
        shape = amplitude.shape
        return np.asarray((amplitude.reshape(-1, shape[-1]) @ self.modes.T).reshape(shape))

    def newton(self, mean_contact: FloatArray, columns: IndexArray, gain: ComplexArray) -> NewtonCompliance:
        """See :class:`HarmonicModes`."""
        key = columns.tobytes()
        if self._cached is None or self._cached[0] != key:
            self._cached = key, mean_contact[columns], self._far[columns]
        _, mean, far = self._cached
        return NewtonCompliance(mean, far, self._near_contact, self._near_contact[columns], gain)
