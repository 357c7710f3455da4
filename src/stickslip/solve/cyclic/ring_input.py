"""What an analysis of a disk whose sectors differ demands of its input."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.solve.cyclic.stuck_sector import wide_pairs
from stickslip.solve.excitation import Excitation, TravellingWave
from stickslip.structure.cyclic_sector import CyclicSector


def require_all_diameters(sector: CyclicSector) -> None:
    """Raise InputError for a sector that was not reduced for all nodal diameters."""
    missing = [each for each in range(sector.sectors // 2 + 1) if each not in sector.diameters]
    if missing:
        raise InputError(
            f"the sector was reduced without nodal diameter {missing[0]} ({len(missing)} are missing), but a ring "
            "whose sectors differ has them all. Reduce it with diameters=None.",
            arguments=["sector"],
        )


def require_modes_without_coupling(sector: CyclicSector) -> None:
    """Raise InputError unless the modes of the tuned disk are real in each wave and only their ratio damps them."""
    require_all_diameters(sector)
    found = "damping matrices" if any(each.damping is not None for each in sector.diameters.values()) else None
    found = "Coriolis forces" if found is None and sector.has_coriolis else found
    if found is not None:
        raise InputError(
            f"the sector has {found}, which couple the modes of the tuned disk; only modal_damping_ratio is possible "
            "here. Give a sector without them, or use forced_response with full_ring.",
            arguments=["sector"],
        )


def row_of_sector(name: str, row: ArrayLike, sector: CyclicSector) -> FloatArray:
    """The row (2n,) of an output (n,) of a sector or (2n,) with the next one. Raises InputError for another size."""
    given, size = finite_array(name, row), sector.size
    if given.shape not in ((size,), (2 * size,)):
        raise InputError(
            f"{name} must have shape ({size},), or ({2 * size},) with the next sector, but its shape is {given.shape}.",
            arguments=[name],
        )
    return np.append(given, np.zeros(2 * size - given.size))


def pairs_of_sectors(pairs: ContactPairs | Sequence[ContactPairs], sector: CyclicSector) -> list[ContactPairs]:
    """The pairs of each sector, with operators (m, 2n), from those of one or of each.

    Raises InputError for another number of sectors or of unknowns.
    """
    listed = [pairs] * sector.sectors if isinstance(pairs, ContactPairs) else list(pairs)
    if len(listed) != sector.sectors:
        raise InputError(
            f"pairs are those of {len(listed)} sectors, but the disk has {sector.sectors}: give the pairs of one "
            "sector, or of each.",
            arguments=["pairs"],
        )
    return [wide_pairs(each, sector.size) for each in listed]


def travelling(wave: Excitation) -> TravellingWave:
    """How an excitation travels. Raises InputError for one that does not."""
    if wave.wave is None:
        raise InputError(
            "wave is an excitation that does not travel; give one of Excitation.travelling_wave.", arguments=["wave"]
        )
    return wave.wave
