"""Amplitudes of the stuck modes under harmonic forces: one complex gain a mode, or damping that couples the modes.

In mass-normalised modes of the stuck structure harmonic h satisfies ``Z_h q = f`` with the modal damping matrix C and
``Z_h = diag(w_j^2 - (h w)^2) + i h w C``. Coefficients are real, (2H, n) in the order cos 1, sin 1, cos 2, ...; complex
amplitudes are ``c - i s`` of ``c cos + s sin``. In a nonlinear mode :class:`SelfExcitation` changes ``Z_h``.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any, Protocol, Self

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

ComplexArray = NDArray[np.complex128]

# Coupled damping: the iteration over the coupling ends at this relative change, near round-off; after
# COUPLING_ITERATIONS without it the matrix is factored.
COUPLING_TOLERANCE = 1e-13
COUPLING_ITERATIONS = 60
NO_CORIOLIS = 1e-12  # chosen: a smaller skew-symmetric part of the damping, over its largest entry, is round-off


def to_complex(coefficients: FloatArray) -> ComplexArray:
    """Complex amplitudes ``c - i s`` (H, m) of coefficients without mean (2H, m)."""
    return np.asarray(coefficients[0::2] - 1j * coefficients[1::2])


def to_real(amplitudes: ComplexArray) -> FloatArray:
    """Coefficients without mean (2H, m) from complex amplitudes (H, m)."""
    coefficients = np.empty((2 * amplitudes.shape[0], amplitudes.shape[1]))
    coefficients[0::2] = amplitudes.real
    coefficients[1::2] = -amplitudes.imag
    return coefficients


def coupled(matrix: NDArray[Any], amplitudes: ComplexArray) -> ComplexArray:
    """Products (H, n) of a matrix (n, n) that all harmonics share, or of those (H, n, n) of each, with amplitudes."""
    if matrix.ndim == 2:
        return np.asarray(amplitudes @ matrix.T)
    return np.asarray(np.matmul(matrix, amplitudes[:, :, None])[:, :, 0])


def has_coriolis(damping: NDArray[Any]) -> bool:
    """Whether modal damping (..., n, n) has a skew-Hermitian part, beyond round-off: that of Coriolis forces."""
    skew = np.abs(damping - damping.conj().swapaxes(-1, -2)).max(initial=0.0)
    return bool(skew > NO_CORIOLIS * np.abs(damping).max(initial=0.0))


def times_gain(gain: ComplexArray, coefficients: FloatArray) -> FloatArray:
    """Coefficients (2H, m) after complex gains (H, m), or after gain matrices (H, m, m) that couple the columns."""
    if gain.ndim == 3:
        return to_real(np.matmul(gain, to_complex(coefficients)[:, :, None])[:, :, 0])
    answer = np.empty_like(coefficients)
    cosine, sine = coefficients[0::2], coefficients[1::2]
    answer[0::2] = gain.real * cosine + gain.imag * sine
    answer[1::2] = gain.real * sine - gain.imag * cosine
    return answer


def adjoint_gain(gain: ComplexArray) -> ComplexArray:
    """The gains (H, m), or gain matrices (H, m, m), of the adjoint, which is the transpose for real
    coefficients."""
    return np.asarray(gain.conj().swapaxes(-1, -2) if gain.ndim == 3 else gain.conj())


def with_gain(gain: ComplexArray, left: FloatArray, right: FloatArray) -> ComplexArray:
    """``left G right^T`` (m, k) of modes (m, p) and (k, p), for the gains (p,) or the gain matrix (p, p) of a
    harmonic."""
    real, imaginary = (left @ part if part.ndim == 2 else left * part for part in (gain.real, gain.imag))
    return np.asarray(real @ right.T + 1j * (imaginary @ right.T))


@dataclass(frozen=True)
class SelfExcitation:
    """The self-excitation that sustains a free vibration (docs/theory_modes.md).

    growth:
        1/s, the coefficient xi of the damping ``-xi M`` that is added to the structure.
    mode:
        index of a stuck mode. In the first harmonic its own ``Z`` is its stiffness alone: its inertia and its own
        damping are part of the load there. Otherwise ``Z`` would be singular in a linear mode.
    """

    growth: float
    mode: int


class _OwnStiffness:
    """Diagonal of ``Z_h``, (H, n): ``w_j^2 - (h w)^2 + i h w (c_j - xi)``, with its derivatives."""

    def __init__(self, squares: FloatArray, damping: FloatArray, harmonics: int, by: SelfExcitation | None) -> None:
        self._squares, self._damping, self._by = squares, damping, by
        self._order = np.arange(1, harmonics + 1)[:, None]

    def excited(self, by: SelfExcitation) -> _OwnStiffness:
        """The same under a self-excitation."""
        return _OwnStiffness(self._squares, self._damping, len(self._order), by)

    @property
    def growth(self) -> float:
        """The coefficient xi, 1/s."""
        return 0.0 if self._by is None else self._by.growth

    def at(self, omega: float) -> ComplexArray:
        """The diagonal at ``omega``."""
        x = self._order * omega
        return self._with_load(self._squares - x**2 + 1j * x * (self._damping - self.growth), 1.0)

    def by_frequency(self, omega: float) -> ComplexArray:
        """Derivative by ``omega``."""
        return self._with_load(-2.0 * self._order**2 * omega + 1j * self._order * (self._damping - self.growth), 0.0)

    def by_growth(self, omega: float) -> ComplexArray:
        """Derivative by xi."""
        return self._with_load(np.tile(-1j * omega * self._order.astype(complex), self._squares.size), 0.0)

    def _with_load(self, diagonal: ComplexArray, stiffness: float) -> ComplexArray:
        """The diagonal, or its derivative, without what the load contains; ``stiffness`` counts that of the mode."""
        if self._by is not None:
            diagonal[0, self._by.mode] = stiffness * self._squares[self._by.mode]
        return diagonal


class ModalGain(Protocol):
    """Modal amplitudes from modal forces at a circular frequency (rad/s)."""

    harmonics: int
    near_modes: int

    @property
    def growth(self) -> float:
        """Coefficient xi of the damping ``-xi M`` that is added, 1/s."""

    def excited(self, by: SelfExcitation) -> Self:
        """The gain under a self-excitation."""

    def transposed(self) -> Self:
        """The gain of the transposed matrices: the same but for Coriolis forces, which change their sign."""

    def answer(self, omega: float, force: FloatArray) -> FloatArray:
        """Modal amplitudes (2H, n) under modal forces (2H, n)."""

    def slope(self, omega: float, amplitude: FloatArray) -> FloatArray:
        """Derivative (2H, n) by ``omega`` of the amplitudes (2H, n) of :meth:`answer` at fixed force."""

    def growth_slope(self, omega: float, amplitude: FloatArray) -> FloatArray:
        """Derivative (2H, n) by xi of the amplitudes (2H, n) of :meth:`answer` at fixed force."""

    def near(self, omega: float) -> ComplexArray:
        """Gains of the lowest ``near_modes`` modes alone, for :func:`times_gain`."""

    def viscous_form(self, amplitude: FloatArray) -> FloatArray:
        """``q C q`` of each row of amplitudes (..., n), for damping that all harmonics share."""

    def viscous_power(self, amplitude: FloatArray) -> FloatArray:
        """(..., H) ``q C q`` of the complex amplitudes of each harmonic, from coefficients (..., 2H, n)."""


class _ModeGain:
    """Common parts of the two gains."""

    _own: _OwnStiffness
    _cached: Any  # what the gain computed at the last frequency; None before

    @property
    def growth(self) -> float:
        return self._own.growth

    def excited(self, by: SelfExcitation) -> Self:
        changed = copy(self)
        changed._own = self._own.excited(by)
        changed._cached = None  # it belongs to another self-excitation
        return changed


class DiagonalGain(_ModeGain):
    """Damping that the modes diagonalise: ``q_j = f_j / (w_j^2 - (h w)^2 + i h w c_j)``.

    Frequencies and damping are (n,), or (H, n) with those of each harmonic.
    """

    def __init__(self, circular_frequency: FloatArray, damping: FloatArray, harmonics: int, near_modes: int) -> None:
        self.harmonics = harmonics
        self.near_modes = near_modes
        self._own = _OwnStiffness(circular_frequency**2, damping, harmonics, None)
        self._damping = damping
        self._cached: tuple[float, ComplexArray] | None = None

    def transposed(self) -> Self:
        return self

    def _gain(self, omega: float) -> ComplexArray:
        """(H, n) gains; those of the last frequency are cached."""
        if self._cached is None or self._cached[0] != omega:
            self._cached = omega, np.asarray(1.0 / self._own.at(omega))
        return self._cached[1]

    def answer(self, omega: float, force: FloatArray) -> FloatArray:
        return times_gain(self._gain(omega), force)

    def slope(self, omega: float, amplitude: FloatArray) -> FloatArray:
        return times_gain(-self._gain(omega) * self._own.by_frequency(omega), amplitude)

    def growth_slope(self, omega: float, amplitude: FloatArray) -> FloatArray:
        return times_gain(-self._gain(omega) * self._own.by_growth(omega), amplitude)

    def near(self, omega: float) -> ComplexArray:
        return self._gain(omega)[:, : self.near_modes]

    def viscous_form(self, amplitude: FloatArray) -> FloatArray:
        return np.asarray(amplitude**2 @ self._damping)

    def viscous_power(self, amplitude: FloatArray) -> FloatArray:
        if self._damping.ndim == 1:
            return _of_both_parts(self.viscous_form(amplitude))
        return _of_both_parts((amplitude**2 * np.repeat(self._damping, 2, axis=0)).sum(axis=-1))


class CoupledGain(_ModeGain):
    """Damping ``C`` (n, n) that couples the modes, or a complex one (H, n, n) of each harmonic.

    It need not be Hermitian: its skew-Hermitian part are Coriolis forces, which do no work; the complex modes of a
    sector have it on the diagonal too. The lowest modes are solved together, the others by an iteration over their
    coupling: above the excitation their damping is a small part of their stiffness. Where the iteration does not
    converge the whole system is factored.
    """

    def __init__(self, circular_frequency: FloatArray, damping: FloatArray, harmonics: int, near_modes: int) -> None:
        self.harmonics = harmonics
        self._damping = damping
        self.near_modes = near_modes
        own = np.einsum("...ii->...i", damping).real
        self._own = _OwnStiffness(circular_frequency**2, own, harmonics, None)
        self._coupling = damping - own[..., None] * np.eye(damping.shape[-1])
        self._far_coupling = self._coupling.copy()
        self._far_coupling[..., :near_modes, :near_modes] = 0.0
        self._order = np.arange(1, harmonics + 1)[:, None]
        self._cached: tuple[float, ComplexArray, ComplexArray] | None = None

    def transposed(self) -> Self:
        changed = copy(self)
        for name in ("_damping", "_coupling", "_far_coupling"):
            setattr(changed, name, getattr(self, name).swapaxes(-1, -2))
        changed._cached = None  # it belongs to the other matrices
        return changed

    def _inner(self, omega: float) -> tuple[ComplexArray, ComplexArray]:
        """Inverse (H, p, p) of the near block and gains (H, n - p) of the far diagonal; those of the last frequency are
        cached."""
        if self._cached is None or self._cached[0] != omega:
            p, own = self.near_modes, self._own.at(omega)
            block = 1j * (self._order * omega)[:, :, None] * self._coupling[..., :p, :p]
            block[:, np.arange(p), np.arange(p)] += own[:, :p]
            self._cached = omega, np.asarray(np.linalg.inv(block), dtype=complex), np.asarray(1.0 / own[:, p:])
        return self._cached[1], self._cached[2]

    def _solve(self, omega: float, force: ComplexArray) -> ComplexArray:
        near, far = self._inner(omega)
        x, p = self._order * omega, self.near_modes

        def inner(load: ComplexArray) -> ComplexArray:
            return np.hstack([np.matmul(near, load[:, :p, None])[:, :, 0], far * load[:, p:]])

        amplitude = inner(force)
        for _ in range(COUPLING_ITERATIONS):
            improved = inner(force - 1j * x * coupled(self._far_coupling, amplitude))
            change = np.linalg.norm(improved - amplitude)
            amplitude = improved
            if change <= COUPLING_TOLERANCE * np.linalg.norm(amplitude):
                return amplitude
        matrices = 1j * x[:, :, None] * self._coupling + np.eye(force.shape[1]) * self._own.at(omega)[:, None, :]
        return np.array([scipy.linalg.solve(matrix, load) for matrix, load in zip(matrices, force, strict=True)])

    def answer(self, omega: float, force: FloatArray) -> FloatArray:
        return to_real(self._solve(omega, to_complex(force)))

    def slope(self, omega: float, amplitude: FloatArray) -> FloatArray:
        motion = to_complex(amplitude)
        change = self._own.by_frequency(omega) * motion + 1j * self._order * coupled(self._coupling, motion)
        return to_real(self._solve(omega, -change))

    def growth_slope(self, omega: float, amplitude: FloatArray) -> FloatArray:
        return to_real(self._solve(omega, -self._own.by_growth(omega) * to_complex(amplitude)))

    def near(self, omega: float) -> ComplexArray:
        return self._inner(omega)[0]

    def viscous_form(self, amplitude: FloatArray) -> FloatArray:
        return np.asarray(((amplitude @ self._damping) * amplitude).sum(axis=-1))

    def viscous_power(self, amplitude: FloatArray) -> FloatArray:
        if self._damping.ndim == 2:
            return _of_both_parts(self.viscous_form(amplitude))
        motion = amplitude[..., 0::2, :] - 1j * amplitude[..., 1::2, :]
        return np.asarray((motion.conj() * np.einsum("hij,...hj->...hi", self._damping, motion)).sum(axis=-1).real)


def _of_both_parts(form: FloatArray) -> FloatArray:
    """(..., H) sums of a quadratic form (..., 2H) of the cosines and of the sines."""
    return np.asarray(form[..., 0::2] + form[..., 1::2])
