"""All sectors of a disk with stuck contacts, and the balance of their friction, in the waves of the tuned disk.

No matrix has the size of the ring: N nodal diameters cost N times the work of one sector, and an iteration of the curve
costs a Fourier transform over the sectors more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.cyclic.full_ring import joined_pairs
from stickslip.solve.cyclic.ring_waves import (
    BladeChange,
    MistunedGain,
    RingModes,
    RingStatic,
    from_standing,
    products,
    to_sectors,
)
from stickslip.solve.cyclic.stuck_sector import pairs_on_mean
from stickslip.solve.excitation import ExcitationForce, TravellingWave, lag_of
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.compliance import NEAR_RANGE, Compliance
from stickslip.solve.harmonic.damping import modal_basis, modal_damping
from stickslip.solve.harmonic.gain import ComplexArray
from stickslip.solve.harmonic.support import (
    StaticResponse,
    mean_factor,
    only_friction_supports,
    require_support_at_rest,
    restrained,
)
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.cyclic_sector import CyclicSector


@dataclass(frozen=True)
class StuckRing:
    """All sectors with stuck contacts; the arrays have a row for each of D + 1 waves, see :class:`RingModes`.

    ``pairs`` are those of all sectors; the operator of the pairs is in the waves, so their own one is empty.
    ``output`` (D+1, 1, n) is the row of the amplitudes of :meth:`outputs`.
    """

    pairs: ContactPairs
    mean: StaticResponse
    mean_restraint: float
    highest_omega: float  # rad/s
    circular_frequency: FloatArray
    modal_damping: FloatArray
    modes: ComplexArray
    contact: ComplexArray
    change: BladeChange
    static: RingStatic
    output: ComplexArray

    @property
    def mean_contact(self) -> FloatArray:
        """Empty: the mean response of a disk is :attr:`static`."""
        return np.empty((0, 0))

    def compliance(self, harmonics: int) -> RingCompliance:
        """The compliance for a number of harmonics; modes above NEAR_RANGE are springs in Newton's matrix."""
        highest = NEAR_RANGE * harmonics * self.highest_omega
        near = int((self.circular_frequency <= highest).sum(axis=1).max())
        gain = MistunedGain(self.circular_frequency, self.modal_damping, harmonics, near, self.change)
        modes = RingModes(self.modes, self.contact, self.circular_frequency, near, self.change, self.static)
        return RingCompliance(self, modes, gain)

    def balance(self, force: ExcitationForce, samples: int) -> Balance:
        """The balance of the disk under forces on all sectors."""
        return Balance(self.compliance(force.harmonics), self.pairs, force, samples)

    def outputs(self, amplitude: FloatArray, deviation: FloatArray) -> FloatArray:
        """Coefficients (2H+1, N) of the output of each sector, from modal amplitudes (2H, N n) and the deviation."""
        count = self.static.sectors
        waves = from_standing(amplitude.reshape(len(amplitude), count, -1))
        answer = np.empty((len(amplitude) + 1, count))
        answer[0] = -self.static.outputs(deviation[0])
        answer[1:] = to_sectors(products(self.output, waves), count)[..., 0]
        return answer


class RingCompliance(Compliance):
    """The response of a disk, whose mean is in waves too."""

    def __init__(self, ring: StuckRing, modes: RingModes, gain: MistunedGain) -> None:
        super().__init__(ring, modes, gain)
        self._static = ring.static

    def relative(self, amplitude: FloatArray, deviation: FloatArray) -> FloatArray:
        """``B u`` (2H+1, m) of amplitudes, with the mean under the deviation."""
        answer = np.empty((amplitude.shape[0] + 1, deviation.shape[1]))
        answer[0] = -self._static.relative(deviation[0]) if deviation[0].any() else 0.0
        self._modes.relative(amplitude, answer[1:])
        return answer

    def mean_relative(self, force: FloatArray) -> FloatArray:
        """(N m,) mean relative displacements under mean forces (N m,) on the pairs."""
        return self._static.relative(force)

    def displacement(self, amplitude: FloatArray, deviation: FloatArray) -> NoReturn:
        """Raise TypeError: no matrix gives the mean of all unknowns (:meth:`StuckRing.outputs`)."""
        raise TypeError("the unknowns of a disk in waves are not available; StuckRing.outputs gives its output.")

    def mean_transposed(self, output: FloatArray) -> NoReturn:
        """Raise TypeError, as :meth:`displacement`."""
        raise TypeError("the unknowns of a disk in waves are not available; StuckRing.outputs gives its output.")


def stuck_ring(
    sector: CyclicSector,
    blade: BladeAlone,
    deviations: FloatArray,
    pairs: list[ContactPairs],
    output: FloatArray,
    highest_omega: float,
    modal_damping_ratio: float,
) -> StuckRing:
    """The stuck disk of N pairs (m, 2n), whose springs at rest must be those of the first ones, and ``output`` (2n,).

    Raises InputError for other springs, deviations that :meth:`BladeAlone.stiffness_changes` rejects, and a disk
    without support at rest.
    """
    first, count = pairs[0], sector.sectors
    springs = first.resting_stiffness()
    if any(not np.array_equal(each.resting_stiffness(), springs) for each in pairs[1:]):
        raise InputError(
            "the pairs of the sectors have other springs at rest, but only their friction and their normal loads may "
            "differ here. Give the same stiffness to all, or solve full_ring.",
            arguments=["pairs"],
        )
    on_mean = sector.mean_structure(), pairs_on_mean(first)
    require_support_at_rest(*on_mean)
    if only_friction_supports(*on_mean):
        pairs = [each.retaining() for each in pairs]
        first = pairs[0]
    mean, restraint = mean_factor(on_mean[0], pairs_on_mean(first))
    closed = ~first.undetermined() + restraint * restrained(first)
    waves = [
        _wave(sector, number, first.operator, springs, springs * closed.ravel(), blade.in_wave(number, count), output)
        for number in range(count // 2 + 1)
    ]
    frequency, modes, contact, alone, row = (np.array([each[place] for each in waves]) for place in range(5))
    joint, bent, shown, of_blade, shown_of_blade, stiff = (
        np.array([each[5][place] for each in waves]) for place in range(6)
    )
    changes = blade.stiffness_changes(deviations, count).ravel()
    change = BladeChange(alone, changes)
    static = RingStatic(joint, bent, shown, of_blade, shown_of_blade, change.core(stiff).real, count)
    return StuckRing(
        joined_pairs(np.zeros((len(springs) * count, 1)), pairs), mean, restraint, highest_omega, frequency,
        modal_damping(frequency, modal_damping_ratio, highest_omega), modes, contact, change, static, row,
    )  # fmt: skip


def _wave(
    sector: CyclicSector, number: int, operators: FloatArray, springs: FloatArray, on_mean: FloatArray,
    alone: NDArray[Any], output: FloatArray,
) -> tuple[Any, ...]:  # fmt: skip
    """Frequencies (n,), modes (n, n), their relative displacements (m, n), blades (k, n) and outputs (1, n), and the
    static parts of :class:`RingStatic`, of a wave."""
    matrices, lag = sector.lagged(number), lag_of(number, sector.sectors)
    here, ahead = np.hsplit(operators, 2)
    operator = here + lag * ahead
    row = (output[: sector.size] + lag * output[sector.size :])[None]
    frequency, modes = modal_basis(
        matrices.mass, matrices.stiffness + operator.conj().T @ (springs[:, None] * operator)
    )
    resting = matrices.stiffness + operator.conj().T @ (on_mean[:, None] * operator)
    try:
        factor = scipy.linalg.cho_factor(resting)
    except scipy.linalg.LinAlgError as error:
        raise InputError(
            f"a body of the disk moves freely in waves of nodal diameter {min(number, sector.sectors - number)} while "
            "its contacts slide. Constrain it, or solve full_ring.",
            arguments=["pairs"],
        ) from error
    of_pairs, of_blade = (scipy.linalg.cho_solve(factor, each.conj().T) for each in (operator, alone))
    static = (operator @ of_pairs, alone @ of_pairs, row @ of_pairs, operator @ of_blade, row @ of_blade)
    return frequency, modes, operator @ modes, alone @ modes, row @ modes, (*static, alone @ of_blade)


def ring_force(first: FloatArray, wave: TravellingWave, sectors: int) -> ExcitationForce:
    """The force (2H+1, N n) on all sectors from coefficients (2H+1, n) of that on the first one."""
    every = [wave.shifted(first.T, sectors, place).T for place in range(sectors)]
    return ExcitationForce(((0, np.hstack(every)),))
