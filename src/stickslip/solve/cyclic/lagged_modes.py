"""Complex modes of a sector with stuck contacts, those of its own nodal diameter for each harmonic."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.gain import ComplexArray, to_complex, to_real
from stickslip.solve.harmonic.harmonic_modes import IndexArray

Matrix = NDArray[Any]  # real or complex


class LaggedModes:
    """Modes of the harmonics 1 to H, see :class:`stickslip.solve.harmonic.harmonic_modes.HarmonicModes`.

    Parameters
    ----------
    modes, contact:
        (n, n) and (m, n) of each harmonic, the modes and their relative displacements.
    circular_frequency:
        (H, n) rad/s.
    near:
        number of modes that are not springs in Newton's matrix.
    """

    def __init__(
        self, modes: Sequence[Matrix], contact: Sequence[ComplexArray], circular_frequency: FloatArray, near: int
    ) -> None:
        self._modes, self._contact, self._near = modes, contact, near
        far: dict[int, ComplexArray] = {}  # harmonics of one lag share their arrays
        for part, frequency in zip(contact, circular_frequency, strict=True):
            if id(part) not in far:
                beyond = part[:, near:]
                far[id(part)] = np.asarray((beyond / frequency[near:] ** 2) @ beyond.conj().T)
        self._far = [far[id(part)] for part in contact]
        self._cached: tuple[bytes, FloatArray, list[NewtonPart]] | None = None

    def of_force(self, force: FloatArray) -> FloatArray:
        """``Phi_h^H p_h``."""
        return _adjoint_products(self._modes, force)

    def of_contact(self, force: FloatArray) -> FloatArray:
        """``(B_h Phi_h)^H f_h``."""
        return _adjoint_products(self._contact, force)

    def relative(self, amplitude: FloatArray, out: FloatArray) -> None:
        """``B_h Phi_h q_h``."""
        motions = zip(self._contact, to_complex(amplitude), strict=True)
        out[:] = to_real(np.array([contact @ motion for contact, motion in motions]))

    def displacement(self, amplitude: FloatArray) -> FloatArray:
        """``Phi_h q_h``."""
        answer = np.empty_like(amplitude)
        for place, modes in enumerate(self._modes):
            motion = amplitude[..., 2 * place, :] - 1j * amplitude[..., 2 * place + 1, :]
            moved = motion @ modes.T
            answer[..., 2 * place, :], answer[..., 2 * place + 1, :] = moved.real, -moved.imag
        return answer

    def newton(self, mean_contact: FloatArray, columns: IndexArray, gain: ComplexArray) -> LaggedNewton:
        """See :class:`stickslip.solve.harmonic.harmonic_modes.HarmonicModes`."""
        key = columns.tobytes()
        if self._cached is None or self._cached[0] != key:
            self._cached = key, mean_contact[columns], self._of_columns(columns)
        _, mean, parts = self._cached
        return LaggedNewton(mean, parts, gain)

    def low_rank(self, rows: IndexArray, columns: IndexArray, gain: ComplexArray, compliance: float) -> None:
        """None: the harmonics have different modes."""
        return

    def _of_columns(self, columns: IndexArray) -> list[NewtonPart]:
        """The parts of the harmonics for some columns; harmonics of one lag share theirs."""
        parts: dict[int, NewtonPart] = {}
        for contact, far in zip(self._contact, self._far, strict=True):
            if id(contact) not in parts:
                near = np.ascontiguousarray(contact[:, : self._near])
                parts[id(contact)] = NewtonPart(far[:, columns], near, near[columns])
        return [parts[id(contact)] for contact in self._contact]


@dataclass(frozen=True)
class NewtonPart:
    """One harmonic: ``far`` (m, k) springs of far modes; near modes at all rows (m, p) and at the columns (k, p)."""

    far: ComplexArray
    left: ComplexArray
    right: ComplexArray


@dataclass(frozen=True)
class LaggedNewton:
    """``A_h = V_h g_h V_h^H`` and the springs of the far modes, see
    :class:`stickslip.solve.harmonic.harmonic_modes.NewtonOperator`; ``gain`` is (H, p) or (H, p, p).
    """

    mean: FloatArray  # (k, m)
    parts: Sequence[NewtonPart]
    gain: ComplexArray

    def apply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation: (2H+1, m) from (2H+1, k)."""
        answer = np.empty((len(deviation), self.mean.shape[1]))
        answer[0] = deviation[0] @ self.mean
        harmonics = zip(self.parts, self.gain, to_complex(deviation[1:]), strict=True)
        # The conjugate of d^H V, without a conjugate copy of the modes.
        moved = [
            part.left @ _times(gain, (force.conj() @ part.right).conj()) + part.far @ force
            for part, gain, force in harmonics
        ]
        answer[1:] = to_real(np.array(moved))
        return answer

    def apply_at(self, deviation: FloatArray, rows: IndexArray) -> FloatArray:
        """A @ deviation at some rows: (2H+1, r) from (2H+1, k)."""
        return self.apply(deviation)[:, rows]

    def apply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: (2H+1, k) from (2H+1, m); that of complex amplitudes is the adjoint."""
        answer = np.empty((len(weights), self.mean.shape[0]))
        answer[0] = self.mean @ weights[0]
        harmonics = zip(self.parts, self.gain, to_complex(weights[1:]), strict=True)
        moved = [
            part.right @ _times(gain.conj().T, (weight.conj() @ part.left).conj()) + (weight.conj() @ part.far).conj()
            for part, gain, weight in harmonics
        ]
        answer[1:] = to_real(np.array(moved))
        return answer

    def block(self, order: int, rows: IndexArray) -> ComplexArray:
        """``A_h`` (rows, k) of harmonic ``order`` >= 1."""
        part, gain = self.parts[order - 1], self.gain[order - 1]
        left = part.left[rows] @ gain if gain.ndim == 2 else part.left[rows] * gain
        return np.asarray(left @ part.right.conj().T + part.far[rows])


def _times(gain: ComplexArray, amplitude: ComplexArray) -> ComplexArray:
    """A diagonal (p,) or a matrix (p, p) times amplitudes (p,)."""
    return np.asarray(gain @ amplitude if gain.ndim == 2 else gain * amplitude)


def _adjoint_products(matrices: Sequence[Matrix], force: FloatArray) -> FloatArray:
    """``A_h^H f_h`` (2H, n) of matrices (k, n) and coefficients (2H, k)."""
    # The conjugate of f^H A, without a conjugate copy of the matrix.
    parts = zip(matrices, to_complex(force), strict=True)
    return to_real(np.array([(part.conj() @ matrix).conj() for matrix, part in parts]))
