"""The whole disk of a study of one sector: its picture, its motion, and its natural frequencies by nodal diameter."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.linalg

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.validation import FloatArray
from stickslip.model.layout import Layout
from stickslip.model.model import Model, kind_of
from stickslip.results.disk import Disk
from stickslip.solve.excitation import TravellingWave, lag_of
from stickslip.structure.craig_bampton import ReductionRow
from stickslip.structure.cyclic_sector import CyclicSector, folded
from stickslip.structure.gyroscopic import gyroscopic_modes
from stickslip.structure.ring import Ring
from stickslip.structure.sector_structure import SectorStructure
from stickslip.structure.superelement import moves_freely

if TYPE_CHECKING:
    from stickslip.case.case import Case

FAMILIES = 6  # chosen: the lowest natural frequencies of each nodal diameter in the diagram


@dataclass(frozen=True)
class DiskOfStudy:
    """The disk of a model of one sector, under the wave of its case."""

    structure: SectorStructure
    sector: CyclicSector
    pairs: ContactPairs
    face_pairs: FacePairs
    wave: TravellingWave

    @classmethod
    def of(cls, case: Case, model: Model) -> DiskOfStudy | None:
        """The disk of a study of a sector; None for any other structure."""
        wave, structure = kind_of(case).wave(case), model.in_study.sector
        if wave is None or structure is None:
            return None
        return cls(structure, model.substructure.require_sector(), model.pairs, model.joint.face_pairs, wave)

    @cached_property
    def ring(self) -> Ring:
        """The mesh of all sectors."""
        return Ring.of(self.structure.mesh, self.structure.symmetry)

    def sector_motion(self, displacement: FloatArray) -> FloatArray:
        """Displacements (3 * n_nodes, 2H+1) m of the mesh of the sector from the unknowns (2n, 2H+1) of a response."""
        own = displacement[: self.sector.size]
        waves = [self.wave.waves(order) for order in range(1, own.shape[1] // 2 + 1)]
        return self.structure.motion(self.sector, own, waves)

    def ring_motion(self, motion: FloatArray) -> FloatArray:
        """Displacements (3 * n_ring, 2H+1) m of all sectors from those of the mesh of the sector."""
        sectors = self.sector.sectors
        return self.ring.motion(np.stack([self.wave.shifted(motion, sectors, ahead) for ahead in range(sectors)]))

    def ring_layout(self, layout: Layout) -> Layout:
        """The layout on the mesh of all sectors; loads and responses at nodes are those of the first
        one."""
        ring, sectors, pairs = self.ring, range(self.sector.sectors), layout.face_pairs
        copied = {
            name: np.concatenate([getattr(pairs, name)] * len(sectors))
            for name in ("first_weights", "second_weights", "gap", "area", "face", "face_position")
        }
        symmetry = self.structure.symmetry
        copied["points"] = np.concatenate([symmetry.rotated(pairs.points, sector) for sector in sectors])
        for name in ("normal", "tangent1", "tangent2"):
            turned = [getattr(pairs, name) @ symmetry.rotation(sector).T for sector in sectors]
            copied[name] = np.concatenate(turned)
        for name in ("first_nodes", "second_nodes"):
            copied[name] = np.concatenate([ring.of_two(getattr(pairs, name), sector) for sector in sectors])
        return replace(
            layout,
            face_pairs=replace(pairs, **copied),
            node_groups={
                name: replace(group, nodes=ring.number[0, group.nodes]) for name, group in layout.node_groups.items()
            },
            contact_sets=tuple(tuple(map(ring.set_name, names)) for names in layout.contact_sets),
            unit_loads={name: self._on_ring(load) for name, load in layout.unit_loads.items()},
        )

    def _on_ring(self, load: FloatArray) -> FloatArray:
        """(3 * n_ring, k) N on the nodes of all sectors from those (3 * n_nodes, k) N of this one, alike in all."""
        number, of_nodes = self.ring.number, load.reshape(-1, 3, load.shape[1])
        answer = np.zeros((self.ring.mesh.n_nodes, *of_nodes.shape[1:]))
        for sector, nodes in enumerate(number):
            np.add.at(answer, nodes, self.structure.symmetry.rotation(sector) @ of_nodes)
        return answer.reshape(-1, load.shape[1])

    def frequencies(self) -> Disk:
        """The natural frequencies of each nodal diameter with both linear limits of the contact."""
        diameters = sorted(self.sector.diameters)
        turn = self._turn
        given = [(turn, True), (turn, False), *([(-turn, True)] if self.sector.has_coriolis else [])]
        tables = [[self._frequencies(way * each, is_stuck) for each in diameters] for way, is_stuck in given]
        count = min(FAMILIES, *(row.size for table in tables for row in table))
        stuck, free, *opposite = (np.array([row[:count] for row in table]) for table in tables)
        wave = self.wave.engine_order, self.wave.direction
        return Disk(self.sector.sectors, *wave, np.array(diameters), stuck, free, *opposite)

    @property
    def _turn(self) -> int:
        """1 or -1: the sign of the lag between sectors under the excitation, after folding at N / 2."""
        return 1 if 2 * (self.wave.waves(1) % self.sector.sectors) <= self.sector.sectors else -1

    def _frequencies(self, waves: int, is_stuck: bool) -> FloatArray:
        """Hz, rising, without motions of free bodies."""
        stiffness, mass = self._matrices(waves, is_stuck)
        squares, modes = scipy.linalg.eigh(stiffness, mass)
        frees = moves_freely(stiffness, modes)
        omega, elastic = np.sqrt(squares[~frees].clip(0.0)), modes[:, ~frees]
        gyroscopic = self.sector.lagged(waves).gyroscopic
        if gyroscopic is not None:
            # Free bodies have no Coriolis forces.
            omega, _ = gyroscopic_modes(omega, elastic.conj().T @ gyroscopic @ elastic)
        return np.asarray(omega / (2.0 * np.pi))

    def _matrices(self, waves: int, is_stuck: bool) -> tuple[Any, Any]:
        """Stiffness and mass (n, n) of a number of waves round the disk."""
        matrices = self.sector.lagged(waves)
        if not is_stuck:
            return matrices.stiffness, matrices.mass
        here, ahead = np.hsplit(self.pairs.operator, 2)
        operator = here + lag_of(waves, self.sector.sectors) * ahead
        springs = self.pairs.resting_stiffness()[:, None]
        return matrices.stiffness + operator.conj().T @ (springs * operator), matrices.mass

    def mode_rows(self, count: int) -> tuple[ReductionRow, ...]:
        """Frequencies of the full and the reduced sector with stuck pairs, in the nodal diameter of the wave, without
        Coriolis forces."""
        diameter = folded(self.wave.waves(1), self.sector.sectors)
        springs = self.pairs.resting_stiffness()
        count = min(count, self.structure.model.remaining.size - 1)
        full = self.structure.stuck_frequencies(self.face_pairs, springs, diameter, count)
        squares = scipy.linalg.eigh(*self._matrices(diameter, is_stuck=True), eigvals_only=True)
        reduced = np.sqrt(squares[:count].clip(0.0)) / (2.0 * np.pi)
        return tuple(
            ReductionRow(place, float(one), float(other), float(100.0 * (other / one - 1.0)), math.nan)
            for place, (one, other) in enumerate(zip(full, reduced, strict=True), start=1)
        )
