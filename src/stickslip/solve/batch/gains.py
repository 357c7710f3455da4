"""Modal amplitudes of many structures: the gains of :mod:`stickslip.solve.harmonic.gain` with a leading axis of curves.

Amplitudes are complex, (B, n, H), ``c - i s`` of ``c cos + s sin``, for B curves, n modes and H harmonics.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.gain import ComplexArray
from stickslip.solve.harmonic.harmonic_modes import IndexArray


class Gain(Protocol):
    """The gains of B curves, each at its own frequency."""

    def answer(self, force: ComplexArray) -> ComplexArray:
        """Amplitudes (B, n, H) under modal forces (B, n, H)."""

    def slope(self, amplitude: ComplexArray) -> ComplexArray:
        """Derivative (B, n, H) of the amplitudes by the circular frequency at fixed force."""

    def transposed(self, weights: ComplexArray) -> ComplexArray:
        """The adjoint of :meth:`answer`, for weights (B, n, H) of real coefficients."""

    def between(self, left: FloatArray, right: FloatArray) -> FloatArray:
        """``left G right^T`` (B, 2H, i, k) of modes (B, i, n) and (B, k, n): real and imaginary part of harmonic 1, of
        harmonic 2, ..."""

    def take(self, chosen: IndexArray) -> Gain:
        """The gains of some curves."""


class Stiffness(Protocol):
    """The modal equations of B curves."""

    def at(self, omega: FloatArray) -> Gain:
        """The gains at circular frequencies (B,) rad/s."""

    def take(self, chosen: IndexArray) -> Stiffness:
        """The equations of some curves."""


@dataclass(frozen=True)
class DiagonalStiffness:
    """Modes without coupling: squares (B, n) of the natural frequencies, damping (B, n) in 1/s, H harmonics."""

    squares: FloatArray
    damping: FloatArray
    harmonics: int

    def at(self, omega: FloatArray) -> DiagonalGain:
        """The gains at circular frequencies (B,) rad/s."""
        order = np.arange(1.0, self.harmonics + 1)
        x = order * omega[:, None, None]
        damped = 1j * self.damping[:, :, None]
        own = self.squares[:, :, None] - x**2 + x * damped
        return DiagonalGain(np.asarray(1.0 / own), order * (damped - 2.0 * x))

    def take(self, chosen: IndexArray) -> DiagonalStiffness:
        """The equations of some curves."""
        return DiagonalStiffness(self.squares[chosen], self.damping[chosen], self.harmonics)


@dataclass(frozen=True)
class DiagonalGain:
    """Gains (B, n, H), and the derivative (B, n, H) of their inverse by the frequency; see :class:`Gain`."""

    gain: ComplexArray
    by_omega: ComplexArray

    def answer(self, force: ComplexArray) -> ComplexArray:
        return self.gain * force

    def slope(self, amplitude: ComplexArray) -> ComplexArray:
        return -self.gain * self.by_omega * amplitude

    def transposed(self, weights: ComplexArray) -> ComplexArray:
        return self.gain.conj() * weights

    def between(self, left: FloatArray, right: FloatArray) -> FloatArray:
        parts = self.gain.view(float).transpose(0, 2, 1)[:, :, None, :]
        return np.asarray((left[:, None] * parts) @ right.transpose(0, 2, 1)[:, None])

    def take(self, chosen: IndexArray) -> DiagonalGain:
        return DiagonalGain(self.gain[chosen], self.by_omega[chosen])


@dataclass(frozen=True)
class CoupledStiffness:
    """Symmetric damping (B, n, n) in 1/s that couples the modes, with squares (B, n) of the natural frequencies."""

    squares: FloatArray
    damping: FloatArray
    harmonics: int

    def at(self, omega: FloatArray) -> CoupledGain:
        """The gains at circular frequencies (B,) rad/s."""
        x = np.arange(1.0, self.harmonics + 1) * omega[:, None]
        matrix = 1j * x[:, :, None, None] * self.damping[:, None]
        own = np.arange(self.squares.shape[1])
        matrix[:, :, own, own] += self.squares[:, None] - (x**2)[:, :, None]
        return CoupledGain(np.asarray(np.linalg.inv(matrix), dtype=complex), self.damping, omega)

    def take(self, chosen: IndexArray) -> CoupledStiffness:
        """The equations of some curves."""
        return CoupledStiffness(self.squares[chosen], self.damping[chosen], self.harmonics)


@dataclass(frozen=True)
class CoupledGain:
    """Gain matrices (B, H, n, n), with damping (B, n, n) at frequencies (B,); see :class:`Gain`."""

    gain: ComplexArray
    damping: FloatArray
    omega: FloatArray

    def answer(self, force: ComplexArray) -> ComplexArray:
        return _by_harmonic(self.gain, force)

    def slope(self, amplitude: ComplexArray) -> ComplexArray:
        order = np.arange(1.0, amplitude.shape[2] + 1)
        change = 1j * order * (self.damping @ amplitude) - 2.0 * order**2 * self.omega[:, None, None] * amplitude
        return -_by_harmonic(self.gain, change)

    def transposed(self, weights: ComplexArray) -> ComplexArray:
        return _by_harmonic(self.gain.conj().swapaxes(2, 3), weights)

    def between(self, left: FloatArray, right: FloatArray) -> FloatArray:
        count, harmonics = self.gain.shape[:2]
        answer = np.empty((count, 2 * harmonics, left.shape[1], right.shape[1]))
        across = right.transpose(0, 2, 1)[:, None]
        answer[:, 0::2] = left[:, None] @ self.gain.real @ across
        answer[:, 1::2] = left[:, None] @ self.gain.imag @ across
        return answer

    def take(self, chosen: IndexArray) -> CoupledGain:
        return CoupledGain(self.gain[chosen], self.damping[chosen], self.omega[chosen])


def _by_harmonic(matrices: ComplexArray, vectors: ComplexArray) -> ComplexArray:
    """Products (B, n, H) of matrices (B, H, n, n) with vectors (B, n, H)."""
    product = matrices @ vectors.transpose(0, 2, 1)[..., None]
    return np.ascontiguousarray(product[..., 0].transpose(0, 2, 1))
