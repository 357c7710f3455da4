"""All sectors of a disk from the reduced matrices of one: a structure whose sectors may differ.

Unknowns of sector s are the waves of all nodal diameters there, ``u_s = N^-1/2 sum_d e^{2 pi i d s / N} q_d``. Each
wave has the matrices of its diameter, so a matrix of the ring has the blocks

    A_{st} = 1/N sum_d e^{2 pi i d (s - t) / N} A_d,

which are real, as waves in opposite directions have conjugate matrices. Nothing is lost: the tuned ring has the natural
frequencies of the sector. Blades that differ change its stiffness (:mod:`stickslip.structure.blade_alone`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.law import ContactLaw, IndexArray
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.cyclic.balances import force_on_sector
from stickslip.solve.cyclic.ring_input import pairs_of_sectors, require_all_diameters, row_of_sector, travelling
from stickslip.solve.cyclic.stuck_sector import Matrix
from stickslip.solve.excitation import Excitation
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.cyclic_sector import CyclicSector
from stickslip.structure.superelement import Superelement

# chosen: matrices with more unknowns take gigabytes, and their modes take longer than the curve.
MOST_UNKNOWNS = 12_000


@dataclass(frozen=True)
class FullRing:
    """All sectors of a disk as one structure, sector by sector: unknown i of sector s is ``s n + i``.

    Unknowns of a sector are displacements in its own axes, those of :class:`stickslip.CyclicSector`.

    Attributes
    ----------
    sector:
        the sector that it consists of.
    superelement:
        the ``N n`` unknowns of the ring, for all analyses of a structure.
    """

    sector: CyclicSector
    superelement: Superelement

    def __repr__(self) -> str:
        return f"FullRing({self.sector.sectors} sectors of {self.sector.size} unknowns)"

    def joint(self, pairs: ContactPairs | Sequence[ContactPairs]) -> ContactPairs:
        """The pairs of all sectors, from those of one sector, or from those of each sector if their dampers differ.

        Operators have (m, n) or, with sides in the next sector, (m, 2n) columns. Raises InputError for another number
        of sectors or of unknowns.
        """
        count, size = self.sector.sectors, self.sector.size
        of_sectors = pairs_of_sectors(pairs, self.sector)
        operators = []
        for place, each in enumerate(of_sectors):
            rows = np.zeros((3 * each.n_pairs, count, size))
            here, following = np.hsplit(each.operator, 2)
            rows[:, place] += here
            rows[:, (place + 1) % count] += following
            operators.append(rows.reshape(len(rows), -1))
        return joined_pairs(np.vstack(operators), of_sectors)

    def row(self, row: ArrayLike, sector: int = 0) -> FloatArray:
        """The row (N n,) of an output (n,) or (2n,) of one sector, such as ``CyclicSector.selector``.

        Raises InputError for another number of unknowns, or a sector that does not exist.
        """
        count, size = self.sector.sectors, self.sector.size
        given = row_of_sector("row", row, self.sector)
        if sector != int(sector) or not 0 <= sector < count:
            raise InputError(f"sector is {sector}, but the ring has sectors 0 to {count - 1}.", arguments=["sector"])
        answer = np.zeros((count, size))
        for ahead, part in enumerate(given.reshape(-1, size)):
            answer[(int(sector) + ahead) % count] += part
        return answer.ravel()

    def excitation(self, wave: Excitation) -> Excitation:
        """The force on all sectors of :meth:`Excitation.travelling_wave`. Raises InputError for another excitation."""
        travels = travelling(wave)
        count = self.sector.sectors
        first = force_on_sector(self.sector, wave, travels, wave.harmonics).coefficients(1.0).T
        force = np.vstack([travels.shifted(first, count, place) for place in range(count)])
        return Excitation.force(force[:, 1::2], force[:, 2::2])

    def mistuned(self, blade: BladeAlone, deviations: ArrayLike) -> FullRing:
        """The ring whose blade s has natural frequencies ``(1 + deviations[s])`` times those of the tuned blade alone.

        ``deviations`` (N,) or (N, k) for the k modes of ``blade`` (:func:`blade_alone`). Raises InputError for another
        shape, and deviations above 0.3.
        """
        changes = blade.stiffness_changes(deviations, self.sector.sectors)
        rows = block_circulant(blade.participation, self.sector.sectors)
        change = rows.T @ (changes.ravel()[:, None] * rows)
        stiffness = self.superelement.stiffness + 0.5 * (change + change.T)
        return replace(self, superelement=replace(self.superelement, stiffness=stiffness))


def full_ring(sector: CyclicSector) -> FullRing:
    """All sectors of a disk as one structure, to make them differ (:meth:`FullRing.mistuned`, :meth:`FullRing.joint`).

    Raises InputError unless the sector was reduced for all nodal diameters, and for more than 12,000 unknowns.
    """
    count = sector.sectors
    require_all_diameters(sector)
    if count * sector.size > MOST_UNKNOWNS:
        raise InputError(
            f"the ring has {count} sectors of {sector.size} unknowns, {count * sector.size} in all; at most "
            f"{MOST_UNKNOWNS} are possible. Reduce the sector to fewer nodes and modes.",
            arguments=["sector"],
        )
    parts = {
        name: {diameter: getattr(each, name) for diameter, each in sector.diameters.items()}
        for name in ("mass", "stiffness", "damping", "gyroscopic")
    }
    damping = None if parts["damping"][0] is None else _symmetric(block_circulant(parts["damping"], count))
    mass, stiffness = (_symmetric(block_circulant(parts[name], count)) for name in ("mass", "stiffness"))
    whirl = None if parts["gyroscopic"][0] is None else block_circulant(parts["gyroscopic"], count)
    gyroscopic = None if whirl is None else 0.5 * (whirl - whirl.T)
    return FullRing(sector, Superelement(mass, stiffness, damping, gyroscopic=gyroscopic))


def block_circulant(of_diameter: Mapping[int, Matrix], sectors: int) -> FloatArray:
    """(N p, N n) real from blocks (p, n) of the nodal diameters 0 to N // 2; those of other waves are conjugate."""
    folded = range(sectors // 2 + 1)
    waves = np.array([of_diameter[d] if d in folded else of_diameter[sectors - d].conj() for d in range(sectors)])
    blocks = np.fft.ifft(waves, axis=0).real  # block s - t
    rows, columns = blocks.shape[1:]
    answer = np.empty((sectors, rows, sectors, columns))
    for first in range(sectors):
        for second in range(sectors):
            answer[first, :, second] = blocks[(first - second) % sectors]
    return answer.reshape(sectors * rows, sectors * columns)


def _symmetric(matrix: FloatArray) -> FloatArray:
    """The matrix without the round-off of the transform."""
    return np.asarray(0.5 * (matrix + matrix.T))


def joined_pairs(operator: FloatArray, of_sectors: Sequence[ContactPairs]) -> ContactPairs:
    """The pairs of all sectors, those of each after the ones before, with one operator."""
    starts = np.cumsum([0, *(each.n_pairs for each in of_sectors)])
    laws = [law for each in of_sectors for law in each.laws]
    members = [group + start for each, start in zip(of_sectors, starts, strict=False) for group in each.members]
    return _joined(operator, laws, members)


def _joined(operator: FloatArray, laws: Sequence[ContactLaw], members: Sequence[IndexArray]) -> ContactPairs:
    """Pairs with laws; if all are those of Coulomb, they become one, so that all pairs are evaluated at once."""
    coulomb = [law for law in laws if isinstance(law, CoulombLaw)]
    alike = {(law.released, law.update) for law in coulomb}
    if len(coulomb) < len(laws) or len(alike) > 1:
        return ContactPairs.with_laws(operator, laws, members)
    order = np.argsort(np.concatenate(members))

    def together(name: str) -> FloatArray:
        return np.asarray(np.concatenate([getattr(law, name) for law in coulomb])[order])

    one = CoulombLaw(
        normal_stiffness=together("normal_stiffness"),
        tangential_stiffness=together("tangential_springs"),
        friction_coefficient=together("friction_coefficient"),
        normal_load=together("normal_load"),
        gap=together("gap"),
        residual_traction=None if coulomb[0].released else together("residual_traction"),
        update=coulomb[0].update,
    )
    return ContactPairs.with_laws(operator, [one])
