"""The two linear limits of a joint: every contact that is closed at rest stuck, and no contact at all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.results.linear_curves import LinearCurves
from stickslip.results.peaks import Peak, peaks
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic.damping import modal_basis
from stickslip.solve.harmonic.gain import ComplexArray, has_coriolis, to_complex
from stickslip.structure.gyroscopic import gyroscopic_modes
from stickslip.structure.superelement import moves_freely

LEAST_SHARE = 1e-8  # chosen: a smaller modal force, over the largest one, is round-off
# chosen: points of a linear curve, and those on each side of a natural frequency.
UNIFORM, BESIDE = 121, 18
ON_RESONANCE = 1e-6  # chosen: the linear curves have no point nearer to a natural frequency, relative to it
# chosen: Coriolis forces couple this number of the lowest modes in natural frequencies; the response has all modes
WHIRLING_MODES = 150
POSSIBLY_RIGID = 1e-4  # chosen: slower modes, over the highest frequency, are tested for strain


class Limit(Protocol):
    """A linear limit as results show it."""

    @property
    def natural_hz(self) -> FloatArray:
        """(n,) natural frequencies."""

    @property
    def rigid(self) -> NDArray[np.bool_]:
        """(n,) whether a mode is a motion of a free body."""

    def damping_ratio(self, window_hz: tuple[float, float]) -> float | None:
        """Largest modal damping ratio inside a window; None without modes there."""

    def peaks(self, window_hz: tuple[float, float], force: ExcitationForce, output: FloatArray) -> list[Peak]:
        """The peaks of an output in a window, highest first; not bracketed at an end."""

    def response_to(self, omega: FloatArray, force: ExcitationForce) -> FloatArray:
        """Displacement coefficients (n_frequencies, n, 2H+1) under an excitation; the mean is zero."""


def elastic_hz(limit: Limit) -> FloatArray:
    """Hz, rising: the natural frequencies of a limit without motions of free bodies."""
    return limit.natural_hz[~limit.rigid]


@dataclass(frozen=True)
class Resonant:
    """Natural frequencies, and the motions in them: the modes, or whirling ones if Coriolis forces couple these.

    Attributes
    ----------
    circular_frequency:
        (n,) rad/s, ascending.
    shapes:
        (n, n), one in each column; complex if they whirl, and scaled as :func:`gyroscopic_modes` says.
    half_power_width:
        (n,) rad/s between the points of half the power around each natural frequency.
    """

    circular_frequency: FloatArray
    shapes: NDArray[Any]
    half_power_width: FloatArray

    @classmethod
    def of(cls, circular_frequency: FloatArray, modes: NDArray[Any], modal_damping: NDArray[Any]) -> Resonant:
        """From modes (n, n), and the damping with Coriolis forces in them, see :class:`LinearLimit`."""
        if modal_damping.ndim == 1:
            return cls(circular_frequency, modes, modal_damping)
        diagonal = np.diag(modal_damping).real.copy()
        if not has_coriolis(modal_damping):
            return cls(circular_frequency, modes, diagonal)
        whirling = 0.5 * (modal_damping - modal_damping.conj().T)
        near = slice(0, WHIRLING_MODES)
        frequency, turns = gyroscopic_modes(circular_frequency[near], whirling[near, near])
        own = (modal_damping - whirling)[near, near]
        width = np.einsum("ij,ij->j", turns.conj(), own @ turns).real
        frequency, width = (
            np.append(frequency, circular_frequency[WHIRLING_MODES:]),
            np.append(width, diagonal[WHIRLING_MODES:]),
        )
        order = np.argsort(frequency, kind="stable")
        shapes = np.hstack([modes[:, near] @ turns, modes[:, WHIRLING_MODES:]])
        return cls(frequency[order], shapes[:, order], width[order])

    def damping_ratio(self, chosen: Any) -> FloatArray:
        """Width over twice the frequency of the chosen ones, which must be above 0."""
        return np.asarray(self.half_power_width[chosen] / (2.0 * self.circular_frequency[chosen]))


class LinearLimit:
    """Harmonic response of ``M u'' + C u' + K u = p`` for many frequencies from one eigen-decomposition.

    Matrices and modes may be complex and Hermitian; :meth:`modal` and the frequencies are then those of a harmonic.

    ``C`` may couple the modes, and need not be symmetric: with Coriolis forces the natural frequencies and motions are
    those of ``resonant``. With the projected ``C = D + O`` (diagonal and rest) the modal amplitudes solve ``(w^2 -
    x^2 + i x D) q = f - i x O q``, iterated to 1e-10; where the iteration does not converge the full complex system is
    solved.
    """

    def __init__(
        self,
        circular_frequency: FloatArray,
        modes: FloatArray,
        modal_damping: FloatArray,
        rigid: NDArray[np.bool_] | None = None,
    ) -> None:
        """From mass-normalised modes (n, n); ``modal_damping`` (n,) if they diagonalise the damping, else (n, n).

        ``rigid`` (n,) marks modes of bodies that move freely; None for none.
        """
        self.circular_frequency, self.modes = circular_frequency, modes
        self.rigid: NDArray[np.bool_] = np.zeros(circular_frequency.size, dtype=bool) if rigid is None else rigid
        if modal_damping.ndim == 1:
            self._diagonal, self._coupling = modal_damping, None
        else:
            self._diagonal = np.diag(modal_damping).real.copy()
            self._coupling = modal_damping - np.diag(self._diagonal)
        self.resonant = Resonant.of(circular_frequency, modes, modal_damping)

    @classmethod
    def of_matrices(cls, mass: FloatArray, stiffness: FloatArray, damping: FloatArray) -> LinearLimit:
        """The limit of a structure given by its matrices (n, n)."""
        return cls.of_modes(*modal_basis(mass, stiffness), stiffness, damping)

    @classmethod
    def of_modes(
        cls, circular_frequency: FloatArray, modes: FloatArray, stiffness: FloatArray, damping: FloatArray
    ) -> LinearLimit:
        """The limit of a structure whose mass-normalised modes (n, n) are known."""
        return cls._with_rigid(circular_frequency, modes, stiffness, modes.conj().T @ damping @ modes)

    @classmethod
    def undamped(cls, circular_frequency: FloatArray, modes: FloatArray, stiffness: FloatArray) -> LinearLimit:
        """The limit of a structure without damping whose mass-normalised modes (n, p), all or some, are known."""
        return cls._with_rigid(circular_frequency, modes, stiffness, np.zeros(circular_frequency.size))

    @classmethod
    def _with_rigid(
        cls, circular_frequency: FloatArray, modes: FloatArray, stiffness: FloatArray, modal_damping: FloatArray
    ) -> LinearLimit:
        """The limit with the motions of free bodies among its modes."""
        # The round-off of a frequency of zero is far below this fraction of the highest one.
        slow = circular_frequency <= POSSIBLY_RIGID * circular_frequency.max()
        rigid = np.zeros(slow.size, dtype=bool)
        rigid[slow] = moves_freely(stiffness, modes[:, slow])
        return cls(circular_frequency, modes, modal_damping, rigid)

    @property
    def natural_hz(self) -> FloatArray:
        """(n,) natural frequencies."""
        return self.resonant.circular_frequency / (2.0 * np.pi)

    def with_damping(self, damping: FloatArray) -> LinearLimit:
        """The same modes with another damping matrix (n, n)."""
        modal = self.modes.conj().T @ damping @ self.modes
        return LinearLimit(self.circular_frequency, self.modes, modal, self.rigid)

    def with_damping_root(self, root: FloatArray) -> LinearLimit:
        """The same modes with the damping ``R R^T`` of a root (n, r)."""
        shares = self.modes.T @ root
        return LinearLimit(self.circular_frequency, self.modes, shares @ shares.T, self.rigid)

    def moved_by(self, force: ExcitationForce) -> NDArray[np.bool_]:
        """(H, n) whether a harmonic of the force moves a mode (of ``resonant``), beyond round-off."""
        shares = np.abs(sum(np.abs(array[1:] @ self.resonant.shapes) for _, array in force.terms))
        return np.asarray(np.maximum(shares[0::2], shares[1::2]) > LEAST_SHARE * shares.max(initial=0.0))

    def damping_ratio(self, window_hz: tuple[float, float]) -> float | None:
        """Largest modal damping ratio of the modes inside a window; None without modes there."""
        low, high = min(window_hz), max(window_hz)
        inside = (self.natural_hz >= low) & (self.natural_hz <= high)
        if not inside.any():
            return None
        return float(self.resonant.damping_ratio(inside).max())

    def response_to(self, omega: FloatArray, force: ExcitationForce) -> FloatArray:
        """Displacement coefficients (n_frequencies, n, 2H+1) under an excitation; the mean is zero."""
        answer = np.zeros((omega.size, self.modes.shape[0], 2 * force.harmonics + 1))
        for power, array in force.terms:
            highest = (int(np.flatnonzero(array.any(axis=1)).max(initial=0)) + 1) // 2
            rows = 2 * highest + 1
            answer[:, :, :rows] += (omega**power)[:, None, None] * self.response(omega, array[:rows])
        return answer

    def output_to(self, omega: FloatArray, force: ExcitationForce, output: FloatArray) -> FloatArray:
        """Coefficients (n_frequencies, 2H+1) of ``output @ u`` under an excitation; the mean is zero."""
        row, answer = output @ self.modes, np.zeros((omega.size, 2 * force.harmonics + 1))
        for power, array in force.terms:
            modal = to_complex(array[1:] @ self.modes)
            for order in np.flatnonzero(modal.any(axis=1)) + 1:
                signal = omega**power * (row @ self.modal(order * omega, modal[order - 1]))
                answer[:, 2 * order - 1] += signal.real
                answer[:, 2 * order] -= signal.imag
        return answer

    def peaks(self, window_hz: tuple[float, float], force: ExcitationForce, output: FloatArray) -> list[Peak]:
        """The peaks of an output in a window, highest first; not bracketed at an end."""
        frequency_hz = refined_grid(window_hz, self.natural_hz)
        signal = self.output_to(2.0 * np.pi * frequency_hz, force, output)
        return peaks(frequency_hz, periodic_amplitude(signal))

    def response(self, omega: FloatArray, force: FloatArray) -> FloatArray:
        """Displacement coefficients (n_frequencies, n, 2H+1) under ``force`` (2H+1, n); the mean is zero."""
        amplitudes = to_complex(force[1:])
        answer = np.zeros((omega.size, force.shape[1], force.shape[0]))
        for order in np.flatnonzero(np.abs(amplitudes).any(axis=1)) + 1:
            motion = _product(self.modes, self.modal(order * omega, self.modes.conj().T @ amplitudes[order - 1]))
            answer[:, :, 2 * order - 1] = motion.real.T
            answer[:, :, 2 * order] = -motion.imag.T
        return answer

    def modal(self, x: FloatArray, force: ComplexArray) -> ComplexArray:
        """Modal amplitudes (n_modes, n_frequencies), complex."""
        gain = 1.0 / (self.circular_frequency[:, None] ** 2 - x**2 + 1j * x * self._diagonal[:, None])
        modal = gain * force[:, None]
        if self._coupling is None:
            return modal
        for _ in range(40):
            improved = gain * (force[:, None] - 1j * x * _product(self._coupling, modal))
            change = np.abs(improved - modal).max(axis=0)
            modal = improved
            if (change <= 1e-10 * np.abs(modal).max(axis=0)).all():
                return modal
        for k in np.flatnonzero(~(change <= 1e-10 * np.abs(modal).max(axis=0))):
            matrix = np.diag(1.0 / gain[:, k]) + 1j * x[k] * self._coupling
            modal[:, k] = scipy.linalg.solve(matrix, force)
        return modal


def _product(matrix: FloatArray, amplitudes: ComplexArray) -> ComplexArray:
    """``matrix @ amplitudes`` without a complex copy of the real matrix, which would double the work."""
    return np.asarray(matrix @ amplitudes.real + 1j * (matrix @ amplitudes.imag))


def linear_curves(
    stuck: Limit,
    free: Limit,
    force: ExcitationForce,
    window_hz: tuple[float, float],
    shown_modes: int = 12,
    uniform: int = UNIFORM,
    beside: int = BESIDE,
) -> LinearCurves:
    """Stuck and free response to ``force`` over the window, refined around their natural frequencies; ``uniform`` and
    ``beside`` as in :func:`refined_grid`."""
    natural_hz = np.concatenate([stuck.natural_hz, free.natural_hz])
    frequency_hz = refined_grid(window_hz, natural_hz, uniform, beside)
    # Not a resonance itself, also of a higher harmonic: without damping the response has no bound there.
    resonances_hz = np.divide.outer(natural_hz, np.arange(1, force.harmonics + 1)).ravel()
    low, high = min(window_hz), max(window_hz)
    near = (resonances_hz > (1.0 - 2.0 * ON_RESONANCE) * low) & (resonances_hz < (1.0 + 2.0 * ON_RESONANCE) * high)
    resonances_hz = np.append(resonances_hz[near], np.inf)
    distance = np.abs(np.subtract.outer(frequency_hz, resonances_hz)).min(axis=1)
    frequency_hz = frequency_hz[distance > ON_RESONANCE * frequency_hz]
    omega = 2.0 * np.pi * frequency_hz
    return LinearCurves(
        frequency_hz=frequency_hz,
        stuck=stuck.response_to(omega, force),
        free=free.response_to(omega, force),
        stuck_frequency_hz=stuck.natural_hz[:shown_modes],
        free_frequency_hz=free.natural_hz[~free.rigid][:shown_modes],
    )


def refined_grid(
    window_hz: tuple[float, float], natural_hz: FloatArray, uniform: int = UNIFORM, beside: int = BESIDE
) -> FloatArray:
    """``uniform`` points with extra ones, denser towards each natural frequency inside the window: ``beside`` of them
    on each side."""
    low, high = min(window_hz), max(window_hz)
    offsets = np.concatenate([-np.geomspace(2e-2, 2e-5, beside), np.geomspace(2e-5, 2e-2, beside)])
    inside = natural_hz[(natural_hz > low) & (natural_hz < high)]
    grid = np.concatenate([np.linspace(low, high, uniform), *(centre * (1.0 + offsets) for centre in inside)])
    return np.unique(grid[(grid >= low) & (grid <= high)])
