"""A structure before its reduction as a study uses it: bodies of a mesh, a sector of a disk, or given matrices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import singledispatch
from typing import Any, Protocol

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.errors import concerning
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.model.layout import AnyStructure, Layout, NodeGroup
from stickslip.solve.excitation import TravellingWave
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.cache import cached_superelement
from stickslip.structure.cached_reductions import cached_rotating_sector, cached_rotating_superelement, cached_sector
from stickslip.structure.craig_bampton import ReductionRow, craig_bampton
from stickslip.structure.cyclic_sector import CyclicSector, folded
from stickslip.structure.elasticity import Structure
from stickslip.structure.factor import best_backend
from stickslip.structure.joined import joined_modes
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.recovery import reduced_load
from stickslip.structure.relative_model import RelativeModel
from stickslip.structure.relative_reduction import cached_relative_superelement, relative_model
from stickslip.structure.rotating import RotatingBodies
from stickslip.structure.rotating_reduction import rotating_superelement
from stickslip.structure.rotating_sector import RotatingSector, rotating_sector
from stickslip.structure.rotating_superelement import RPM, RotatingSuperelement
from stickslip.structure.sector_structure import SectorStructure
from stickslip.structure.substructure import Substructure
from stickslip.structure.superelement import Superelement


@dataclass(frozen=True)
class Speeds:
    """One reduction for all speeds up to a highest one, with or without Coriolis forces."""

    rotating: RotatingSuperelement | RotatingSector
    coriolis: bool

    def at(self, speed: float) -> Substructure:
        """The matrices at a speed in rad/s. Raises InputError for one above that of the reduction."""
        with concerning("rotation.speed"):
            return self.rotating.at(speed / RPM, self.coriolis)


@dataclass(frozen=True)
class ReducedStructure:
    """A structure after reduction, common to all cases with the same structure and layout.

    substructure:
        the matrices: a superelement, or a sector of a disk.
    node_groups:
        name -> (3, n) rows of the displacement x, y, z of a node group; their transposes apply a force to the unknowns.
        The n unknowns of a sector are those of this sector and of the next one.
    unit_loads:
        section of a distributed static load -> (n, k) N for each unit of its sizes.
    base_inertia:
        (n, 3) kg, the force that resists an acceleration of the support of 1 m/s2 along x, y, z; None if it is fixed.
    mode_table:
        frequencies of the full and the reduced model with every pair closed, if the study compares them.
    speeds:
        the matrices at all speeds of a rotation, if one reduction is valid for them.
    blade:
        the blade alone of a sector whose study has mistuning.
    moving:
        (n_pairs,) the pairs that can move, if the others have no unknowns of their own.
    """

    substructure: Substructure
    node_groups: Mapping[str, FloatArray]
    unit_loads: Mapping[str, FloatArray] = field(default_factory=dict)
    base_inertia: FloatArray | None = None
    mode_table: tuple[ReductionRow, ...] = ()
    speeds: Speeds | None = None
    blade: BladeAlone | None = None
    moving: BoolArray | None = None

    def at(self, speed: float) -> Substructure:
        """The matrices at a speed in rad/s, if one reduction is valid for several speeds; else those at its own."""
        return self.substructure if self.speeds is None else self.speeds.at(speed)

    @classmethod
    def of_superelement(cls, superelement: Superelement, layout: Layout) -> ReducedStructure:
        """A superelement with the rows and loads of a layout."""
        rows = {name: _rows_of(superelement, group) for name, group in layout.node_groups.items()}
        loads = {name: reduced_load(superelement, load) for name, load in layout.unit_loads.items()}
        inertia = None if layout.base_inertia is None else reduced_load(superelement, layout.base_inertia)
        return cls(superelement, rows, loads, inertia)

    def without_recovery(self) -> ReducedStructure:
        """Without what only the motion of the mesh requires, to send it to a worker."""
        speeds = self.speeds and replace(self.speeds, rotating=self.speeds.rotating.without_recovery())
        return replace(self, substructure=self.substructure.without_recovery(), speeds=speeds)


class StudyStructure(Protocol):
    """What a study requires of a structure before its reduction."""

    @property
    def mesh(self) -> Mesh | None:
        """The mesh; None for matrices."""

    @property
    def full_model(self) -> Structure | None:
        """The full model whose modes, motion and stress a study compares and shows; None if there is no single one."""

    @property
    def sector(self) -> SectorStructure | None:
        """The sector of a disk; None for another structure."""

    @property
    def has_damping(self) -> bool:
        """Whether it has viscous damping of its own."""

    @property
    def free_unknowns(self) -> IntArray | None:
        """Unknowns of the full model; None for matrices, which are not reduced."""

    def reduced_unknowns(self, layout: Layout, n_modes: int) -> tuple[int, int]:
        """Unknowns of boundary nodes or pairs, and modes with fixed boundary, after the reduction."""

    def reduced(
        self, layout: Layout, n_modes: int, threads: int = 1, progress: ProgressCallback | None = None
    ) -> ReducedStructure:
        """The structure in the unknowns of the nodes of a layout and some modes. Raises InputError."""

    def stuck_frequencies(
        self, pairs: FacePairs, springs: FloatArray, wave: TravellingWave | None, count: int
    ) -> FloatArray:
        """(count,) Hz, the lowest natural frequencies with stuck pairs on ``springs`` (3 * n_pairs,) N/m; of a disk
        those of the nodal diameter of the wave. At most as many as there are."""


@singledispatch
def study_structure(structure: AnyStructure) -> StudyStructure:
    """A structure of any kind in a study."""
    raise TypeError(f"{type(structure).__name__} is not a structure of a study")


@study_structure.register(Superelement)
@dataclass(frozen=True)
class _Matrices:
    """Given matrices, which are not reduced."""

    superelement: Superelement

    mesh = full_model = sector = free_unknowns = None

    @property
    def has_damping(self) -> bool:
        return self.superelement.damping is not None

    def reduced_unknowns(self, layout: Layout, n_modes: int) -> tuple[int, int]:
        return self.superelement.size, 0

    def reduced(
        self, layout: Layout, n_modes: int, threads: int = 1, progress: ProgressCallback | None = None
    ) -> ReducedStructure:
        return ReducedStructure.of_superelement(self.superelement, layout)

    def stuck_frequencies(
        self, pairs: FacePairs, springs: FloatArray, wave: TravellingWave | None, count: int
    ) -> FloatArray:
        return joined_modes(self.superelement, pairs, min(count, self.superelement.size - 1), springs)[0]


@study_structure.register(Structure)
@dataclass(frozen=True)
class _Bodies:
    """Bodies of a mesh."""

    full_model: Structure
    gyroscopic: Any = None  # csr (n_free, n_free) N s/m of Coriolis forces

    sector, has_damping = None, False

    @property
    def mesh(self) -> Mesh:
        return self.full_model.mesh

    @property
    def free_unknowns(self) -> IntArray:
        return self.full_model.free_unknowns

    def reduced_unknowns(self, layout: Layout, n_modes: int) -> tuple[int, int]:
        nodes = layout.boundary_nodes.size
        if self._relative_model(layout) is not None:
            nodes = layout.face_pairs.n_pairs + layout.single_nodes.size
        return 3 * nodes, n_modes

    def _relative_model(self, layout: Layout) -> RelativeModel | None:
        """The model in the relative displacements of a large joint; None where both sides remain."""
        if self.gyroscopic is not None:
            return None  # the recovery projects Coriolis matrices in the displacements of both sides
        return relative_model(self.full_model, layout.face_pairs, layout.single_nodes)

    def reduced(
        self, layout: Layout, n_modes: int, threads: int = 1, progress: ProgressCallback | None = None
    ) -> ReducedStructure:
        """An earlier reduction is read from the disk."""
        structure, nodes = self.full_model, layout.boundary_nodes
        relative = self._relative_model(layout)
        if relative is not None:
            joint = cached_relative_superelement(
                relative, layout.face_pairs, layout.single_nodes, n_modes, threads, progress
            )
            return ReducedStructure.of_superelement(joint, layout)
        backend = best_backend(structure.stiffness.shape[0], 3 * nodes.size)
        superelement = cached_superelement(
            structure, nodes, n_modes, lambda: craig_bampton(structure, nodes, n_modes, backend, threads, progress)
        )
        if self.gyroscopic is not None:
            whirl = superelement.recovery.projected(self.gyroscopic)
            superelement = replace(superelement, gyroscopic=0.5 * (whirl - whirl.T))
        return ReducedStructure.of_superelement(superelement, layout)

    def stuck_frequencies(
        self, pairs: FacePairs, springs: FloatArray, wave: TravellingWave | None, count: int
    ) -> FloatArray:
        """Without Coriolis forces."""
        return joined_modes(self.full_model, pairs, min(count, self.full_model.stiffness.shape[0] - 1), springs)[0]


@study_structure.register(RotatingBodies)
def _at_speed(structure: RotatingBodies) -> _Bodies:
    if structure.top_speed_rpm is not None:
        return _BodiesAtManySpeeds(structure.structure, rotating=structure)
    return _Bodies(structure.structure, structure.gyroscopic)


@dataclass(frozen=True)
class _BodiesAtManySpeeds(_Bodies):
    """Bodies of a mesh with one reduction for all speeds up to a highest one."""

    rotating: RotatingBodies = field(kw_only=True)

    def _relative_model(self, layout: Layout) -> None:
        """The reduction for all speeds is to the displacements of both sides."""

    def reduced(
        self, layout: Layout, n_modes: int, threads: int = 1, progress: ProgressCallback | None = None
    ) -> ReducedStructure:
        """An earlier reduction is read from the disk."""
        bodies, nodes = self.rotating, layout.boundary_nodes
        rotor, top_rpm = bodies.rotor, bodies.top_speed_rpm
        assert top_rpm is not None  # see study_structure
        backend = best_backend(rotor.structure.stiffness.shape[0])
        rotating = cached_rotating_superelement(
            rotor, nodes, n_modes, top_rpm,
            lambda: rotating_superelement(rotor, nodes, top_rpm, n_modes=n_modes, backend=backend, threads=threads),
        )  # fmt: skip
        speeds = Speeds(rotating, bodies.coriolis)
        at_its_own = speeds.at(bodies.speed_rpm * RPM).require_structure()
        at_speed = ReducedStructure.of_superelement(at_its_own, layout)
        return replace(at_speed, speeds=speeds)


@study_structure.register(SectorStructure)
@dataclass(frozen=True)
class _Sector:
    """One sector of a disk."""

    sector: SectorStructure

    full_model, has_damping = None, False

    @property
    def mesh(self) -> Mesh:
        return self.sector.mesh

    @property
    def free_unknowns(self) -> IntArray:
        return self.sector.model.remaining

    def reduced_unknowns(self, layout: Layout, n_modes: int) -> tuple[int, int]:
        return 3 * layout.boundary_nodes.size, n_modes

    def reduced(
        self, layout: Layout, n_modes: int, threads: int = 1, progress: ProgressCallback | None = None
    ) -> ReducedStructure:
        """An earlier reduction is read from the disk."""
        nodes = layout.boundary_nodes
        speeds, of_study = None, self.sector.speeds
        if of_study is None:
            reduced = cached_sector(
                self.sector, nodes, n_modes, lambda: self.sector.reduced(nodes, n_modes, threads, progress)
            )
        else:
            rotor, top_rpm = of_study.rotor, of_study.top_rpm
            rotating = cached_rotating_sector(
                rotor, nodes, n_modes, top_rpm,
                lambda: rotating_sector(rotor, nodes, top_rpm, n_modes=n_modes, progress=progress),
            )  # fmt: skip
            speeds = Speeds(rotating, of_study.coriolis)
            reduced = speeds.at(of_study.speed_rpm * RPM).require_sector()
        rows = {name: _sector_rows(reduced, each) for name, each in layout.node_groups.items()}
        blade = None
        if layout.blade_nodes is not None:
            with concerning("mistuning.blade"):
                blade = self.sector.blade(reduced, layout.blade_nodes)
        loads = {
            name: _on_first_sector(self.sector.reduced_load(reduced, each)) for name, each in layout.unit_loads.items()
        }
        return ReducedStructure(reduced, rows, loads, speeds=speeds, blade=blade)

    def stuck_frequencies(
        self, pairs: FacePairs, springs: FloatArray, wave: TravellingWave | None, count: int
    ) -> FloatArray:
        assert wave is not None  # its kind has one
        diameter = folded(wave.waves(1), self.sector.symmetry.sectors)
        return self.sector.stuck_frequencies(pairs, springs, diameter, min(count, self.free_unknowns.size - 1))


def _rows_of(superelement: Superelement, node_group: NodeGroup) -> FloatArray:
    """(3, n) rows of the mean displacement x, y, z of a node group."""
    if node_group.blocks is None and np.isin(node_group.nodes, superelement.boundary_nodes).all():
        rows = np.zeros((3, superelement.size))
        for node, share in zip(node_group.nodes, node_group.weights, strict=True):
            rows[np.arange(3), superelement.unknowns_of(int(node))] += share
        return rows
    return reduced_load(superelement, node_group.unit_loads(superelement.recovery.shape[0])).T


def _sector_rows(sector: CyclicSector, node_group: NodeGroup) -> FloatArray:
    """(3, 2n) rows of the mean displacement x, y, z of nodes of a sector, in its own axes."""
    assert sector.symmetry is not None  # that of cyclic_sector
    rows = np.zeros((3, sector.row_size))
    home, ahead = sector.symmetry.homes(node_group.nodes)
    for node, is_ahead, weight in zip(home, ahead, node_group.weights, strict=True):
        rows += weight * np.array([sector.selector(int(node), axis, of_next=bool(is_ahead)) for axis in np.eye(3)])
    return rows


def _on_first_sector(load: FloatArray) -> FloatArray:
    """(2n, k) forces on the unknowns of this sector and of the next one, from those (n, k) on this one."""
    return np.vstack([load, np.zeros_like(load)])
