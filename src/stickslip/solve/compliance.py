"""How the structure with every contact closed and stuck answers to forces on the pairs, harmonic by harmonic.

With ``Kbar = K + B^T k B`` and ``Z_h(w) = Kbar - (h w)^2 M + i h w C`` the compliance of the pairs is
``A_h(w) = B Z_h^-1 B^T`` and the linear stuck response ``r_h = B Z_h^-1 P_h``; complex amplitudes are ``c - i s`` of
``c cos + s sin``. The mean (h = 0) is different: a stuck pair carries no mean traction (its slider sits at the mean
displacement), so ``k`` holds only the normal springs there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.interface.contact_pairs import ContactPairs
from stickslip.solve.damping import (
    diagonal_modal_damping,
    modal_basis,
    modal_damping,
    modal_damping_matrix,
    stuck_stiffness_matrix,
)
from stickslip.structure.superelement import Superelement
from stickslip.validation import FloatArray

ComplexArray = NDArray[np.complex128]
IndexArray = NDArray[np.int64]

# A body that only friction holds (a free damper along its axis) has no unique mean position. A spring of this fraction
# of the tangential contact stiffness, on the mean alone, holds it; results do not depend on it (docs/theory.md).
MEAN_RESTRAINT = 1e-6


class Compliance(Protocol):
    """What the balance needs from the stuck linear structure; all arrays in SI units, m = 3 * n_pairs rows.

    Coefficient arrays are (2H+1, m) in the order mean, cos 1, sin 1, ...
    """

    harmonics: int
    mean_restraint: float

    def block(self, omega: float, order: int, rows: IndexArray, columns: IndexArray) -> ComplexArray:
        """``A_h`` for harmonic ``order`` >= 1 on the given rows and columns."""

    def mean_block(self, rows: IndexArray, columns: IndexArray) -> FloatArray:
        """``A_0`` on the given rows and columns."""

    def displacement(self, omega: float, force: FloatArray, deviation: FloatArray) -> FloatArray:
        """All unknowns (2H+1, n) under the external ``force`` (2H+1, n) and ``-B^T deviation``."""

    def relative(self, omega: float, force: FloatArray | None, deviation: FloatArray) -> FloatArray:
        """``B u`` (2H+1, m) of :meth:`displacement`; ``force`` None means none."""

    def displacement_slope(self, omega: float, force: FloatArray, deviation: FloatArray) -> FloatArray:
        """Derivative of :meth:`displacement` with respect to ``omega``."""


def to_complex(coefficients: FloatArray) -> ComplexArray:
    """Complex amplitudes ``c - i s`` (H, m) of the harmonics of coefficients (2H+1, m)."""
    return np.asarray(coefficients[1::2] - 1j * coefficients[2::2])


def times_gain(gain: ComplexArray, harmonics: FloatArray) -> FloatArray:
    """Coefficients (2H, m) of the harmonics (cos 1, sin 1, ...) after complex gains (H, m), in real arithmetic."""
    answer = np.empty_like(harmonics)
    cosine, sine = harmonics[0::2], harmonics[1::2]
    answer[0::2] = gain.real * cosine + gain.imag * sine
    answer[1::2] = gain.real * sine - gain.imag * cosine
    return answer


def to_real(mean: FloatArray, amplitudes: ComplexArray) -> FloatArray:
    """Coefficients (2H+1, m) from the mean (m,) and complex amplitudes (H, m)."""
    coefficients = np.empty((2 * amplitudes.shape[0] + 1, amplitudes.shape[1]))
    coefficients[0] = mean
    coefficients[1::2] = amplitudes.real
    coefficients[2::2] = -amplitudes.imag
    return coefficients


@dataclass(frozen=True)
class MeanCompliance:
    """The static answer with normal springs only: ``(K + B^T diag(0, 0, k_n) B)^-1``, and the restraint it needed."""

    inverse: FloatArray  # (n, n)
    restraint: float

    @classmethod
    def build(cls, superelement: Superelement, pairs: ContactPairs) -> MeanCompliance:
        """Factor the mean system; a body that only friction holds gets ``MEAN_RESTRAINT``. Raises InputError if it
        stays singular."""
        springs = pairs.stuck_stiffness().reshape(-1, 3)
        for restraint in (0.0, MEAN_RESTRAINT):
            scaled = springs * np.array([restraint, restraint, 1.0])
            matrix = superelement.stiffness + pairs.operator.T @ (scaled.reshape(-1, 1) * pairs.operator)
            scale = 1.0 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
            squares, vectors = scipy.linalg.eigh(matrix * np.outer(scale, scale))
            if squares[0] > 1e-11 * squares[-1]:
                vectors = vectors * scale[:, None]
                return cls((vectors / squares) @ vectors.T, restraint)
        raise InputError(
            "the structure with all contacts closed and stuck is singular to working accuracy: some body can move "
            "freely, or the contact is many orders stiffer than the structure. Fix the body somewhere, check that the "
            "contact operator couples it to the rest, or lower the contact stiffness: a joint a thousand times stiffer "
            "than what it joins is rigid."
        )


class ModalCompliance:
    """Compliance from one eigen-decomposition of the stuck structure; needs damping that its modes diagonalise."""

    def __init__(
        self,
        pairs: ContactPairs,
        mean: MeanCompliance,
        circular_frequency: FloatArray,
        modes: FloatArray,
        modal_damping: FloatArray,
        harmonics: int,
    ) -> None:
        self.harmonics = harmonics
        self.mean_restraint = mean.restraint
        self._mean = mean.inverse
        self._modes = modes
        self._squares = circular_frequency**2
        self._damping = modal_damping
        self._operator = pairs.operator
        self._contact_modes = pairs.operator @ modes
        self._mean_contact = pairs.operator @ mean.inverse @ pairs.operator.T

    def _gain(self, omega: float) -> ComplexArray:
        """(H, n_modes) modal gains 1/(w_j^2 - (h w)^2 + i h w c_j)."""
        x = np.arange(1, self.harmonics + 1)[:, None] * omega
        return np.asarray(1.0 / (self._squares - x**2 + 1j * x * self._damping))

    def _modal_force(self, force: FloatArray | None, deviation: FloatArray) -> FloatArray:
        """(2H, n_modes) coefficients of the harmonics of the modal forces."""
        modal = -(deviation[1:] @ self._contact_modes)
        if force is not None:
            loaded = np.flatnonzero(force[1:].any(axis=1))
            modal[loaded] += force[1 + loaded] @ self._modes
        return modal

    def block(self, omega: float, order: int, rows: IndexArray, columns: IndexArray) -> ComplexArray:
        gain = self._gain(omega)[order - 1]
        left, right = self._contact_modes[rows], self._contact_modes[columns].T
        return np.asarray((left * gain.real) @ right + 1j * ((left * gain.imag) @ right))

    def mean_block(self, rows: IndexArray, columns: IndexArray) -> FloatArray:
        return self._mean_contact[np.ix_(rows, columns)]

    def displacement(self, omega: float, force: FloatArray, deviation: FloatArray) -> FloatArray:
        modal = times_gain(self._gain(omega), self._modal_force(force, deviation))
        mean = self._mean @ (force[0] - deviation[0] @ self._operator)
        return np.vstack([mean, modal @ self._modes.T])

    def relative(self, omega: float, force: FloatArray | None, deviation: FloatArray) -> FloatArray:
        modal = times_gain(self._gain(omega), self._modal_force(force, deviation))
        mean = -self._mean_contact @ deviation[0]
        if force is not None and force[0].any():
            mean += self._operator @ (self._mean @ force[0])
        return np.vstack([mean, modal @ self._contact_modes.T])

    def displacement_slope(self, omega: float, force: FloatArray, deviation: FloatArray) -> FloatArray:
        order = np.arange(1, self.harmonics + 1)[:, None]
        slope = -(self._gain(omega) ** 2) * (-2.0 * order**2 * omega + 1j * order * self._damping)
        modal = times_gain(slope, self._modal_force(force, deviation))
        return np.vstack([np.zeros(self._modes.shape[0]), modal @ self._modes.T])


class DirectCompliance:
    """Compliance by a direct factor of ``Z_h`` at each frequency: for damping that couples the stuck modes."""

    def __init__(
        self,
        superelement: Superelement,
        pairs: ContactPairs,
        mean: MeanCompliance,
        stiffness: FloatArray,
        damping: FloatArray,
        harmonics: int,
    ) -> None:
        self.harmonics = harmonics
        self.mean_restraint = mean.restraint
        self._mean = mean.inverse
        self._operator = pairs.operator
        self._mean_contact = pairs.operator @ mean.inverse @ pairs.operator.T
        self._mass, self._stiffness, self._damping = superelement.mass, stiffness, damping
        self._cache: dict[int, tuple[float, tuple[ComplexArray, NDArray[np.int32]], ComplexArray]] = {}

    def _factor(self, omega: float, order: int) -> tuple[tuple[ComplexArray, NDArray[np.int32]], ComplexArray]:
        """LU of ``Z_h`` and ``Z_h^-1 B^T``, kept for the frequency asked last."""
        kept = self._cache.get(order)
        if kept is None or kept[0] != omega:
            x = order * omega
            matrix = self._stiffness - x**2 * self._mass + 1j * x * self._damping
            factor = scipy.linalg.lu_factor(matrix)
            kept = (omega, factor, scipy.linalg.lu_solve(factor, self._operator.T.astype(complex)))
            self._cache[order] = kept
        return kept[1], kept[2]

    def block(self, omega: float, order: int, rows: IndexArray, columns: IndexArray) -> ComplexArray:
        _, answers = self._factor(omega, order)
        return np.asarray(self._operator[rows] @ answers[:, columns])

    def mean_block(self, rows: IndexArray, columns: IndexArray) -> FloatArray:
        return self._mean_contact[np.ix_(rows, columns)]

    def displacement(self, omega: float, force: FloatArray, deviation: FloatArray) -> FloatArray:
        load = force - deviation @ self._operator
        amplitudes = np.array(
            [
                scipy.linalg.lu_solve(self._factor(omega, order)[0], row)
                for order, row in enumerate(to_complex(load), start=1)
            ]
        )
        return to_real(self._mean @ load[0], amplitudes)

    def relative(self, omega: float, force: FloatArray | None, deviation: FloatArray) -> FloatArray:
        if force is None:
            force = np.zeros((deviation.shape[0], self._mass.shape[0]))
        return np.asarray(self.displacement(omega, force, deviation) @ self._operator.T)

    def displacement_slope(self, omega: float, force: FloatArray, deviation: FloatArray) -> FloatArray:
        displacement = to_complex(self.displacement(omega, force, deviation))
        slopes = np.empty_like(displacement)
        for order in range(1, self.harmonics + 1):
            change = -2.0 * order**2 * omega * self._mass + 1j * order * self._damping
            slopes[order - 1] = -scipy.linalg.lu_solve(self._factor(omega, order)[0], change @ displacement[order - 1])
        return to_real(np.zeros(self._mass.shape[0]), slopes)


@dataclass(frozen=True)
class StuckStructure:
    """The structure with every contact closed and stuck, ready for the balance."""

    compliance: Compliance
    circular_frequency: FloatArray  # (n,) rad/s, ascending
    damping: FloatArray  # (n, n) N s/m, also where modal ratios were given


def stuck_structure(
    superelement: Superelement,
    pairs: ContactPairs,
    harmonics: int,
    highest_omega: float,
    modal_damping_ratio: float | None,
) -> StuckStructure:
    """Build the compliance of the stuck structure for a number of harmonics.

    ``modal_damping_ratio`` gives the stuck modes one ratio (see :func:`stickslip.solve.damping.modal_damping`;
    ``highest_omega`` in rad/s is the highest excitation); None uses ``superelement.damping`` (zero if absent).
    Raises InputError for an operator of another size, for both kinds of damping at once, or a singular structure.
    """
    n = superelement.size
    if pairs.operator.shape[1] != n:
        raise InputError(
            f"operator has {pairs.operator.shape[1]} columns, but the superelement has {n} unknowns; "
            "operator must have shape (3 * n_pairs, n)."
        )
    if modal_damping_ratio is not None and superelement.damping is not None:
        raise InputError("give either a damping matrix in the superelement or modal_damping_ratio, not both.")
    mean = MeanCompliance.build(superelement, pairs)
    stiffness = stuck_stiffness_matrix(superelement, pairs)
    frequency, modes = modal_basis(superelement.mass, stiffness)
    modal: FloatArray | None
    if modal_damping_ratio is not None:
        modal = modal_damping(frequency, modal_damping_ratio, highest_omega)
        damping = modal_damping_matrix(superelement.mass, modes, modal)
    elif superelement.damping is None:
        damping, modal = np.zeros((n, n)), np.zeros(n)
    else:
        damping = superelement.damping
        modal = diagonal_modal_damping(damping, modes)
    compliance: Compliance
    if modal is not None:
        compliance = ModalCompliance(pairs, mean, frequency, modes, modal, harmonics)
    else:
        compliance = DirectCompliance(superelement, pairs, mean, stiffness, damping, harmonics)
    return StuckStructure(compliance, frequency, damping)
