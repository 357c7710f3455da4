"""What can vibrate along a frequency curve: a structure, or a sector of a disk. Each gives its balances."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import singledispatch
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.cyclic.balances import sector_balances
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.compliance import require_one_size
from stickslip.solve.harmonic.damping import stuck_stiffness_matrix
from stickslip.solve.harmonic.linear import LinearLimit, elastic_hz
from stickslip.solve.harmonic.neglected import more_harmonics
from stickslip.solve.setting_up import CurveBalances, prepare_balances
from stickslip.solve.tractions.traction_band import checked_band_output
from stickslip.structure.cyclic_sector import CyclicSector
from stickslip.structure.superelement import Superelement


@dataclass(frozen=True)
class CurveInput:
    """Joint, excitation and discretisation of a curve; with an accuracy, ``harmonics`` are the fewest of it."""

    pairs: ContactPairs
    excitation: Excitation
    highest_omega: float  # rad/s
    harmonics: int
    by_accuracy: bool
    samples: int
    modal_damping_ratio: float | None
    update: Update


class CurveStructure(Protocol):
    """A structure, or a sector of a disk, that gives the balances of a curve. All methods raise InputError."""

    def highest_elastic_hz(self, pairs: ContactPairs, count: int) -> float:
        """Hz, the highest of the first ``count`` elastic natural frequencies of each linear limit."""

    def band_output(self, pairs: ContactPairs, row: ArrayLike) -> FloatArray:
        """The output row of a band of residual tractions."""

    def balances(self, given: CurveInput, on_stage: Callable[[str], None]) -> CurveBalances:
        """The balances, after a check of the input."""


@singledispatch
def curve_structure(structure: Any) -> CurveStructure:
    """What gives the balances of a superelement or of a sector. Raises InputError for anything else."""
    raise InputError(
        f"superelement is a {type(structure).__name__}; it must be a Superelement, or a CyclicSector for a disk.",
        arguments=["superelement"],
    )


@curve_structure.register(Superelement)
@dataclass(frozen=True)
class StructureBalances:
    """A structure."""

    superelement: Superelement

    def highest_elastic_hz(self, pairs: ContactPairs, count: int) -> float:
        require_one_size(self.superelement, pairs)
        undamped = np.zeros_like(self.superelement.mass)
        stiffness = stuck_stiffness_matrix(self.superelement, pairs), self.superelement.stiffness
        limits = (LinearLimit.of_matrices(self.superelement.mass, each, undamped) for each in stiffness)
        return max(float(elastic[:count][-1]) for elastic in map(elastic_hz, limits) if elastic.size)

    def band_output(self, pairs: ContactPairs, row: ArrayLike) -> FloatArray:
        return checked_band_output(pairs, row, self.superelement.size)

    def balances(self, given: CurveInput, on_stage: Callable[[str], None]) -> CurveBalances:
        return prepare_balances(
            self.superelement, given.pairs, given.excitation, given.highest_omega, given.harmonics, given.samples,
            given.modal_damping_ratio, given.update, on_stage, few_modes=True,
        )  # fmt: skip


@curve_structure.register(CyclicSector)
@dataclass(frozen=True)
class _Sector:
    sector: CyclicSector

    def highest_elastic_hz(self, pairs: ContactPairs, count: int) -> float:
        # Without contact alone: stuck contact raises these frequencies by much less than the range that damping has.
        every = (self.sector.lagged(diameter) for diameter in self.sector.diameters)
        limits = (LinearLimit.of_matrices(each.mass, each.stiffness, np.zeros_like(each.mass)) for each in every)
        return max(float(elastic[:count][-1]) for elastic in map(elastic_hz, limits) if elastic.size)

    def band_output(self, pairs: ContactPairs, row: ArrayLike) -> FloatArray:
        raise InputError(
            "traction_band is not computed for a cyclic sector: omit it, or give the full ring.",
            arguments=["traction_band"],
        )

    def balances(self, given: CurveInput, on_stage: Callable[[str], None]) -> CurveBalances:
        most = given.samples if given.by_accuracy else more_harmonics(given.harmonics, 2 * given.samples)
        return sector_balances(
            self.sector, given.pairs, given.excitation, given.highest_omega, given.harmonics, most, given.samples,
            given.modal_damping_ratio, given.update, on_stage,
        )  # fmt: skip
