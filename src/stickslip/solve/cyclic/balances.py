"""The balances of a sector under a travelling wave, and the equation of motion that their results satisfy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, NoReturn

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.cyclic.limits import SectorLandmarks, SectorLimit, force_of_order
from stickslip.solve.cyclic.stuck_sector import (
    LaggedStructure,
    Matrix,
    StuckSector,
    pairs_on_mean,
    stuck_sector,
    wide_pairs,
)
from stickslip.solve.excitation import Excitation, ExcitationForce, TravellingWave
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.damping import DAMPED_RANGE
from stickslip.solve.harmonic.gain import to_complex, to_real
from stickslip.solve.harmonic.support import only_friction_supports
from stickslip.solve.harmonic.unbounded import nearly_undamped
from stickslip.solve.harmonic.walk import without_walk
from stickslip.solve.setting_up import Vibration, check_options, require_comparable, resistance
from stickslip.structure.cyclic_sector import CyclicSector, folded


@dataclass(frozen=True)
class SectorEquation:
    """The equation of motion of a sector, harmonic by harmonic (:class:`EquationOfMotion`)."""

    stuck: StuckSector

    def momentum(self, displacement: FloatArray) -> FloatArray:
        """``M_h u_h``."""
        return self._products(displacement, lambda part: part.mass)

    def elastic_force(self, displacement: FloatArray) -> FloatArray:
        """``K_h u_h``."""
        return self._products(displacement, lambda part: part.stiffness)

    def viscous_term(self, displacement: FloatArray) -> FloatArray:
        """``(C_h + G_h) u_h``; Coriolis forces ``G_h`` do no work."""
        return self._products(displacement, lambda part: part.velocity_matrix)

    def joint_force(self, contact: FloatArray) -> FloatArray:
        """``B_h^H f_h``."""
        return self._products(contact, lambda part: part.operator.conj().T)

    def kinetic_energy(self, displacement: FloatArray, omega: FloatArray) -> FloatArray:
        """(n_points,) ``w^2 / 2 u_1^H M_1 u_1``, that of one sector."""
        first = displacement[:, 1] - 1j * displacement[:, 2]
        momentum = first @ self.stuck.of_order(1).mass.T
        return np.asarray(0.5 * omega**2 * (first.conj() * momentum).sum(axis=1).real)

    def _products(self, coefficients: FloatArray, matrix_of: Callable[[LaggedStructure], Matrix]) -> FloatArray:
        """Coefficients (n_points, 2H+1, k) of a product with the matrix (k, l) of each harmonic."""
        rows = [coefficients[:, 0] @ matrix_of(self.stuck.of_order(0)).T]
        for order in range(1, coefficients.shape[1] // 2 + 1):
            part = coefficients[:, 2 * order - 1] - 1j * coefficients[:, 2 * order]
            product = part @ matrix_of(self.stuck.of_order(order)).T
            rows += [product.real, -product.imag]
        return np.stack(rows, axis=1)


@dataclass(frozen=True)
class SectorBalances:
    """The balances of a sector, joint and travelling wave (:class:`stickslip.solve.setting_up.CurveBalances`)."""

    stuck: StuckSector
    excitation: Excitation
    force: ExcitationForce
    samples: int
    update: Update
    modal_damping_ratio: float | None
    no_stability: ClassVar[str] = (
        "The stability of the points is not known: a small disturbance of a disk may have any nodal diameter, but the "
        "equations of a sector contain only those of the excitation."
    )

    no_static_mode: ClassVar[str] = (
        "for a sector of a disk, the excitation at which nearly all pairs slip is not computed."
    )

    @property
    def pairs(self) -> ContactPairs:
        """The pairs of the mean; those of results are :attr:`shown_pairs`."""
        return self.stuck.pairs

    @property
    def shown_pairs(self) -> ContactPairs:
        """The pairs with an operator (m, 2n) on this sector and the next one."""
        return self.stuck.all_pairs

    def shown(self, coefficients: FloatArray) -> FloatArray:
        """Coefficients (..., 2H+1, 2n) of this sector and the next one."""
        return self.stuck.expanded(coefficients)

    def vibration_of(self, outputs: FloatArray) -> Vibration:
        """The outputs (k, 2n) of vibrations."""

        def vibration(balance: Balance, amplitude: FloatArray) -> FloatArray:
            still = np.zeros((*amplitude.shape[:-2], amplitude.shape[-2] + 1, balance.rows))
            motion = self.shown(balance.compliance.displacement(amplitude, still))
            return np.asarray(motion[..., 1:, :] @ outputs.T)

        return vibration

    @property
    def damped_harmonics(self) -> int | None:
        """Number of harmonics whose resonances have damping; None if the number does not matter."""
        return None if self.modal_damping_ratio is None else int(DAMPED_RANGE)

    @property
    def is_damped(self) -> bool:
        """Always: :func:`sector_balances` rejects a sector without damping."""
        return True

    @cached_property
    def closed(self) -> SectorLimit:
        """The sector with every contact that is closed at rest stuck."""
        return SectorLimit(lambda order: self.stuck.of_order(order).closed, self.stuck)

    @cached_property
    def free(self) -> SectorLimit:
        """The sector without contact."""
        return SectorLimit(lambda order: self.stuck.of_order(order).free, self.stuck)

    @property
    def shown_free(self) -> SectorLimit:
        """The sector without contact, of results."""
        return self.free

    @property
    def equation(self) -> SectorEquation:
        """The terms of the equation of motion."""
        return SectorEquation(self.stuck)

    def landmarks(self) -> SectorLandmarks:
        """The natural frequencies that the force excites."""
        return SectorLandmarks(self.stuck, self.force)

    def unbounded(self, window: tuple[float, float]) -> tuple[str, ...]:
        """No warnings. Raises InputError for an excited mode in the range (Hz) that damping matrices do not damp."""
        low, high = (2.0 * np.pi * hertz for hertz in sorted(window))
        for order in range(1, self.force.harmonics + 1):
            part, alone = self.stuck.of_order(order), force_of_order(self.force, order)
            for words, limit in (("stuck contact", part.closed), ("no contact", part.free)):
                undamped = nearly_undamped(limit, alone, low, high)
                if undamped:
                    hertz = limit.natural_hz[undamped[0][1]]
                    raise InputError(
                        f"the mode of harmonic {order} at {hertz:.3f} Hz, with {words}, has no damping from the "
                        "damping matrices of the sector, so nothing bounds its amplitude. Give damping that reaches "
                        "it, or modal_damping_ratio.",
                        arguments=["modal_damping_ratio"],
                    )
        return ()

    def motion(self, trials: Sequence[Trial], displacement: FloatArray) -> tuple[FloatArray, FloatArray | None]:
        """See :func:`without_walk`, of this sector and the next one."""
        mean = self.stuck.of_order(0)
        motion, walk = without_walk(mean.mass, mean.free, self.pairs, trials, displacement)
        return self.shown(motion), None if walk is None else np.hstack([walk, walk])

    def with_harmonics(self, harmonics: int, samples: int | None = None) -> Balance:
        """The balance with a number of harmonics, and of samples if they differ."""
        force = self.force.with_harmonics(harmonics)
        return Balance(self.stuck.compliance(harmonics), self.pairs, force, samples or self.samples)

    def with_samples(self, samples: int) -> SectorBalances:
        """The same balances with another number of samples."""
        return replace(self, samples=samples)

    def stability(self, trials: Sequence[Trial], pairs: ContactPairs) -> NoReturn:
        """A sector has none, see :attr:`no_stability`: raises InputError."""
        raise self.stuck.sector.no_structure()

    def in_time(self) -> None:
        """None: the equations of a sector contain no other motion than waves."""

    def of_structure(self) -> NoReturn:
        """A sector has no single matrices: raises InputError."""
        raise self.stuck.sector.no_structure()


def sector_balances(
    sector: CyclicSector,
    pairs: ContactPairs,
    excitation: Excitation,
    highest_omega: float,
    harmonics: int,
    most_harmonics: int,
    samples: int,
    modal_damping_ratio: float | None,
    update: Update,
    on_stage: Callable[[str], None],
) -> SectorBalances:
    """Check the input and compute the modes of the stuck sector.

    ``most_harmonics`` is the largest number of harmonics that the analysis may use, for its check too. Raises
    InputError.
    """
    check_options(harmonics, samples, update, modal_damping_ratio)
    wave = _wave_of(excitation)
    _require_damping(sector, modal_damping_ratio)
    _require_diameters(sector, wave, most_harmonics)
    pairs = wide_pairs(pairs, sector.size).with_update(update)
    if only_friction_supports(sector.mean_structure(), pairs_on_mean(pairs)):
        # The stuck pairs of such a body carry its mean load: only they know where it is.
        pairs = pairs.retaining()
    force = force_on_sector(sector, excitation, wave, harmonics)
    stiffest, heaviest = sector.lagged(0).stiffness, sector.lagged(0).mass
    sides = np.hsplit(pairs.operator, 2)
    elastic, inertial = (sum(resistance(side, matrix) for side in sides) for matrix in (stiffest, heaviest))
    require_comparable(pairs, np.asarray(elastic + highest_omega**2 * inertial))
    on_stage(f"modes of the stuck sector, {sector.size} unknowns, engine order {wave.engine_order}")
    stuck = stuck_sector(sector, pairs, wave, highest_omega, modal_damping_ratio)
    on_stage(f"compliance of {pairs.n_pairs} pairs")
    return SectorBalances(stuck, excitation, force, samples, update, modal_damping_ratio)


def _wave_of(excitation: Excitation) -> TravellingWave:
    if excitation.wave is None:
        raise InputError(
            "the excitation of a cyclic sector must say how it travels round the disk: use "
            "Excitation.travelling_wave(engine_order, cos, sin).",
            arguments=["excitation"],
        )
    return excitation.wave


def _require_damping(sector: CyclicSector, modal_damping_ratio: float | None) -> None:
    """Raise InputError unless either the sector or the ratio gives damping."""
    given = next(iter(sector.diameters.values())).damping is not None
    if given and modal_damping_ratio is not None:
        raise InputError(
            "give either the damping matrices of the sector or modal_damping_ratio, not both.",
            arguments=["modal_damping_ratio"],
        )
    has_matrices = given and all(each.damping is not None and each.damping.any() for each in sector.diameters.values())
    if not has_matrices and not modal_damping_ratio:
        raise InputError(
            "a cyclic sector requires viscous damping: give modal_damping_ratio, for example 0.001, or a sector with "
            "damping (with_rayleigh_damping).",
            arguments=["modal_damping_ratio"],
        )


def _require_diameters(sector: CyclicSector, wave: TravellingWave, harmonics: int) -> None:
    """Raise InputError for a nodal diameter of a harmonic that the reduction omitted."""
    needed = [folded(wave.waves(order), sector.sectors) for order in range(harmonics + 1)]
    missing = [(order, diameter) for order, diameter in enumerate(needed) if diameter not in sector.diameters]
    if missing:
        order, diameter = missing[0]
        all_of_them = ", ".join(map(str, sorted(set(needed))))
        raise InputError(
            f"the sector was reduced for nodal diameters {', '.join(map(str, sorted(sector.diameters)))}, but engine "
            f"order {wave.engine_order} has nodal diameter {diameter} in harmonic {order}. Harmonics 0 to {harmonics} "
            f"(with those of the check of the accuracy) require the diameters {all_of_them}: reduce the sector for "
            "these, see nodal_diameters.",
            arguments=["diameters"],
        )


def force_on_sector(
    sector: CyclicSector, excitation: Excitation, wave: TravellingWave, harmonics: int
) -> ExcitationForce:
    """The force on this sector, with (n,) or (2n,) unknowns: that on the next sector comes from it one lag earlier.

    Raises InputError for another number of unknowns, and for more harmonics than ``harmonics``.
    """
    rows = excitation.parts[0].cos.shape[0]
    size = sector.size if rows != 2 * sector.size else rows
    terms = excitation.terms_on(sector, size, harmonics)
    if size == sector.size:
        return ExcitationForce(terms)
    folded_terms = []
    for power, array in terms:
        here, following = np.hsplit(array, 2)
        lags = np.array([wave.lag(order, sector.sectors) for order in range(1, harmonics + 1)])
        earlier = to_real(lags.conj()[:, None] * to_complex(following[1:]))
        folded_terms.append((power, np.vstack([np.zeros((1, sector.size)), here[1:] + earlier])))
    return ExcitationForce(tuple(folded_terms))
