"""What can vibrate along a frequency curve: a structure, or a sector of a disk. Each gives its balances."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import singledispatch
from typing import Any, Protocol

from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.cyclic.balances import sector_balances
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.neglected import more_harmonics
from stickslip.solve.setting_up import CurveBalances, prepare_balances
from stickslip.solve.traction_band import checked_band_output
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
    """A structure, or a sector of a disk, that gives the balances of a curve. Both methods raise InputError."""

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
class _Structure:
    superelement: Superelement

    def band_output(self, pairs: ContactPairs, row: ArrayLike) -> FloatArray:
        return checked_band_output(pairs, row, self.superelement.size)

    def balances(self, given: CurveInput, on_stage: Callable[[str], None]) -> CurveBalances:
        return prepare_balances(
            self.superelement, given.pairs, given.excitation, given.highest_omega, given.harmonics, given.samples,
            given.modal_damping_ratio, given.update, on_stage,
        )  # fmt: skip


@curve_structure.register(CyclicSector)
@dataclass(frozen=True)
class _Sector:
    sector: CyclicSector

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
