"""A sector of a disk with stuck contacts under a travelling wave: one Hermitian system for each harmonic.

Engine order k with N sectors gives harmonic h the lag ``phi_h = -2 pi h k / N`` to the next sector (forward; plus
backward), so its matrices are those of nodal diameter ``h k mod N``. A pair across the boundary has one side in the
next sector, which moves as ``e^{i phi_h} u``: ``B_h = B_here + e^{i phi_h} B_next``. The friction of the pairs of one
sector in time is then that of all sectors.

Source: E. P. Petrov, A method for use of cyclic symmetry properties in analysis of nonlinear multiharmonic vibrations
of bladed disks, J. Turbomach. 126 (2004) 175-183.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.cyclic.lagged_modes import LaggedModes
from stickslip.solve.excitation import TravellingWave, lag_of
from stickslip.solve.harmonic.compliance import Compliance, usual_near_range
from stickslip.solve.harmonic.damping import diagonal_modal_damping, modal_basis, modal_damping, modal_damping_matrix
from stickslip.solve.harmonic.gain import ComplexArray, CoupledGain, DiagonalGain
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.solve.harmonic.support import StaticResponse, mean_factor, require_support_at_rest
from stickslip.structure.cyclic_sector import CyclicSector
from stickslip.structure.substructure import rows_of_mean

Matrix = NDArray[Any]  # real or complex


@dataclass(frozen=True)
class LaggedStructure:
    """The sector with stuck contacts for one lag between sectors; Hermitian matrices (n, n), and the skew-Hermitian one
    of Coriolis forces or None.

    ``pairs`` are those of the mean, ``lag`` is ``e^{i phi}``, ``operator`` (m, n) gives the relative displacements of
    the pairs, ``modes`` (n, n) are mass-normalised, and ``modal_damping`` is (n,) if they diagonalise the damping, else
    (n, n) with the Coriolis forces.
    """

    pairs: ContactPairs
    highest_omega: float  # rad/s
    lag: complex
    mass: Matrix
    stiffness: Matrix
    damping: Matrix
    operator: Matrix
    circular_frequency: FloatArray
    modes: Matrix
    modal_damping: Matrix
    gyroscopic: Matrix | None = None

    @property
    def velocity_matrix(self) -> Matrix:
        """(n, n) N s/m, the damping and the gyroscopic matrix."""
        return self.damping if self.gyroscopic is None else self.damping + self.gyroscopic

    @cached_property
    def contact_modes(self) -> ComplexArray:
        """(m, n) relative displacements of the modes."""
        return np.asarray(self.operator @ self.modes, dtype=complex)

    @cached_property
    def closed(self) -> LinearLimit:
        """The sector with every contact that is closed at rest stuck."""
        return LinearLimit(self.circular_frequency, self.modes, self.modal_damping)

    @cached_property
    def free(self) -> LinearLimit:
        """The sector without contact."""
        return LinearLimit.of_matrices(self.mass, self.stiffness, self.velocity_matrix)


@dataclass(frozen=True)
class StuckSector:
    """The sector with stuck contacts, for balances with any number of harmonics.

    ``all_pairs`` have the operator (m, 2n) on the unknowns of this sector and of the next one; ``pairs``, ``mean`` and
    ``mean_restraint`` are those of the mean, which is the same in all sectors.
    """

    sector: CyclicSector
    wave: TravellingWave
    all_pairs: ContactPairs
    pairs: ContactPairs
    mean: StaticResponse
    mean_restraint: float
    highest_omega: float  # rad/s
    modal_damping_ratio: float | None
    _of_waves: dict[int, LaggedStructure] = field(default_factory=dict, repr=False)

    @cached_property
    def mean_contact(self) -> FloatArray:
        """(m, m) compliance of the pairs on the mean."""
        return np.asarray(self.pairs.operator @ self.mean.solve(self.pairs.operator.T))

    def of_order(self, order: int) -> LaggedStructure:
        """The structure of a harmonic; harmonics with the same lag share it."""
        waves = self.wave.waves(order) % self.sector.sectors
        if waves not in self._of_waves:
            self._of_waves[waves] = self._lagged(waves)
        return self._of_waves[waves]

    def _lagged(self, waves: int) -> LaggedStructure:
        matrices, lag = self.sector.lagged(waves), lag_of(waves, self.sector.sectors)
        here, following = np.hsplit(self.all_pairs.operator, 2)
        operator = here + lag * following
        springs = self.all_pairs.resting_stiffness()[:, None]
        frequency, modes = modal_basis(matrices.mass, matrices.stiffness + operator.conj().T @ (springs * operator))
        modal: Matrix | None
        if self.modal_damping_ratio is not None:
            modal = modal_damping(frequency, self.modal_damping_ratio, self.highest_omega)
            damping: Matrix = modal_damping_matrix(matrices.mass, modes, modal)
        else:
            assert matrices.damping is not None  # see sector_balances
            damping = matrices.damping
            modal = diagonal_modal_damping(damping, modes)
            if modal is None:
                modal = modes.conj().T @ damping @ modes
        if matrices.gyroscopic is not None:
            modal = _as_matrix(modal) + modes.conj().T @ matrices.gyroscopic @ modes
        return LaggedStructure(
            self.pairs, self.highest_omega, lag, matrices.mass, matrices.stiffness, damping, operator, frequency, modes,
            modal, matrices.gyroscopic,
        )  # fmt: skip

    def compliance(self, harmonics: int, near_range: float | None = None) -> Compliance:
        """The compliance for a number of harmonics; modes above ``near_range`` are springs in Newton's matrix.

        None is :func:`usual_near_range`.
        """
        parts = [self.of_order(order) for order in range(1, harmonics + 1)]
        if near_range is None:
            near_range = usual_near_range(parts[0].circular_frequency.size)
        highest = near_range * harmonics * self.highest_omega
        near = max(int(np.searchsorted(part.circular_frequency, highest)) for part in parts)
        frequency = np.array([part.circular_frequency for part in parts])
        if all(part.modal_damping.ndim == 1 for part in parts):
            modal = np.array([part.modal_damping for part in parts])
            gain: DiagonalGain | CoupledGain = DiagonalGain(frequency, modal, harmonics, near)
        else:
            gain = CoupledGain(frequency, np.array([_as_matrix(part.modal_damping) for part in parts]), harmonics, near)
        modes = LaggedModes([part.modes for part in parts], [part.contact_modes for part in parts], frequency, near)
        return Compliance(self, modes, gain)

    def expanded(self, coefficients: FloatArray) -> FloatArray:
        """Coefficients (..., 2H+1, 2n) of this sector and the next one, from those (..., 2H+1, n) of this one."""
        following = self.wave.shifted(coefficients.swapaxes(-1, -2), self.sector.sectors, 1).swapaxes(-1, -2)
        return np.concatenate([coefficients, following], axis=-1)


def stuck_sector(
    sector: CyclicSector,
    pairs: ContactPairs,
    wave: TravellingWave,
    highest_omega: float,
    modal_damping_ratio: float | None,
) -> StuckSector:
    """The stuck sector of pairs with the operator (m, 2n). Raises InputError for a sector without support at rest."""
    mean_structure, mean_pairs = sector.mean_structure(), pairs_on_mean(pairs)
    require_support_at_rest(mean_structure, mean_pairs)
    mean, restraint = mean_factor(mean_structure, mean_pairs)
    return StuckSector(sector, wave, pairs, mean_pairs, mean, restraint, highest_omega, modal_damping_ratio)


def wide_pairs(pairs: ContactPairs, size: int) -> ContactPairs:
    """The pairs with an operator (m, 2n): one of (m, n) has no side in the next sector. Raises InputError."""
    columns = pairs.operator.shape[1]
    if columns == 2 * size:
        return pairs
    if columns != size:
        raise InputError(
            f"operator has {columns} columns, but the sector has {size} unknowns; operator must have shape (3 * "
            f"n_pairs, {size}), or (3 * n_pairs, {2 * size}) with the unknowns of the next sector for pairs across the "
            "boundary.",
            arguments=["operator"],
        )
    wide = np.hstack([pairs.operator, np.zeros_like(pairs.operator)])
    return ContactPairs.with_laws(wide, pairs.laws, pairs.members)


def pairs_on_mean(pairs: ContactPairs) -> ContactPairs:
    """Pairs with the operator (m, n) of the mean, from those with (m, 2n)."""
    operator = rows_of_mean(pairs.operator, pairs.operator.shape[1] // 2)
    return ContactPairs.with_laws(operator, pairs.laws, pairs.members)


def _as_matrix(modal: Matrix) -> Matrix:
    return np.diag(modal) if modal.ndim == 1 else modal
