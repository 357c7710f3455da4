"""The study of kind "cyclic": a sector of a tuned disk, from a mesh file or dimensions, under a travelling wave."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from stickslip.case.case import CyclicCase
from stickslip.case.cyclic_sections import BladedDiskSection, SectorMeshSection
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.pairing.pairing_result import Pairing, write_pairs
from stickslip.core.errors import InputError, keys_of_section
from stickslip.core.plausible import suspecting
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.model.kinds.bladed_disk_mesh import LEFT, RIGHT, BladedDisk
from stickslip.model.kinds.body_materials import body_materials
from stickslip.model.kinds.entry import named_entry
from stickslip.model.kinds.mesh import (
    PAIRS_FILE,
    MeshSetup,
    face_materials,
    fixed_unknowns_of,
    pairing_facts,
    pairing_of,
    read_source,
)
from stickslip.model.kinds.mesh_support import require_support
from stickslip.model.kinds.mistuning import blade_nodes
from stickslip.model.kinds.own import OwnKind
from stickslip.model.kinds.sector_ties import tied_sector
from stickslip.model.layout import Derived, Layout, NodeGroup
from stickslip.model.overlap import require_single_joints
from stickslip.model.rotation import (
    ADD_CORIOLIS,
    free_body_messages,
    sector_at_speed,
    speed_facts,
    speed_messages,
)
from stickslip.solve.excitation import TravellingWave
from stickslip.structure.body_load import centrifugal_load
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.elasticity import Hexahedron, Material
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.model_facts import connected_parts, model_oddities
from stickslip.structure.sector_boundaries import Axis, cyclic_symmetry, with_next_sector
from stickslip.structure.sector_structure import SectorStructure
from stickslip.structure.tied_boundaries import tied_symmetry

# chosen: all nodes of forces and responses remain unknowns of the sector, and their number squared is its matrix.
MOST_NODES_OF_A_PLACE = 200
# A part that spans more than this number of sectors reaches past the next one, which pairs do not know.
MOST_SECTORS_OF_A_PART = 2.0


@dataclass(frozen=True)
class SectorLayout(Layout):
    """The layout on the mesh of a sector; the pairs have the nodes of this sector and of the next one."""

    symmetry: CyclicSymmetry | None = None

    @cached_property
    def boundary_nodes(self) -> IntArray:
        """Nodes of this sector that keep their displacements: those of pairs, forces and responses."""
        assert self.symmetry is not None
        groups = [each.nodes for each in self.node_groups.values()]
        return self.symmetry.own_nodes(np.concatenate([self.face_pairs.nodes, *groups]))


@dataclass(frozen=True)
class CyclicSetup:
    """A sector before its matrices are made."""

    sector: MeshSetup
    symmetry: CyclicSymmetry
    speed: float = 0.0  # rad/s
    coriolis: bool = False
    top_speed: float | None = None  # rad/s, of one reduction for several speeds

    @property
    def layout(self) -> Layout:
        """Joints and node groups."""
        return self.sector.layout

    def assemble(self) -> SectorStructure:
        """The matrices of the sector. Raises InputError."""
        setup = self.sector
        structure = setup.at_rest()
        with keys_of_section("structure"):
            sector = SectorStructure(structure, self.symmetry)
            _ = sector.model  # its constraints are those of both boundaries
        if not (self.speed or self.top_speed):
            return sector
        return sector_at_speed(sector, self.speed, self.coriolis, self.top_speed)

    def most_unknowns(self, n_modes: int) -> int:
        """Of the nodes and modes that the reduction retains."""
        return self.layout.most_unknowns(n_modes)

    def sizes(self) -> tuple[tuple[str, str], ...]:
        """The sizes of the sector, and the disk."""
        symmetry = self.symmetry
        axis, point = (", ".join(f"{each:.4g}" for each in row) for row in (symmetry.direction, 1e3 * symmetry.point))
        disk = f"{symmetry.sectors} sectors about ({axis}) through ({point}) mm"
        return (("disk", disk), ("boundaries", symmetry.boundary_words()), *self.sector.sizes())

    def write_places(self, folder: Path) -> tuple[Path, ...]:
        """The pairs, and the points of their faces without a partner."""
        return (write_pairs(folder / PAIRS_FILE, self.sector.pairings),)


class CyclicKind(OwnKind[CyclicCase]):
    """One sector of a tuned disk."""

    def set_up(self, case: CyclicCase) -> CyclicSetup:
        """Read or make the mesh, find its symmetry, pair faces in the sector and across its boundary.

        Raises ImportFileError for the file, and InputError that names the entry of the study file.
        """
        section = case.structure
        source = _source(section)
        mesh, materials = source.mesh, body_materials(case, source)
        odd_values = tuple(model_oddities(mesh, dict(zip(mesh.body_names, materials, strict=True))))
        with suspecting(odd_values):
            symmetry = _symmetry(section, mesh)
            _require_own_sector(mesh, symmetry, source)
            fixed = fixed_unknowns_of(_fixed(section), source)
            both = with_next_sector(mesh, symmetry)
            pairings = {name: pairing_of(both, name, each) for name, each in case.interfaces.items()}
            require_single_joints(both, case.interfaces)
            tied = tied_sector(case, source, symmetry, fixed, pairings)
            groups, constraints = tied.groups, tied.constraints
            layout = _layout(both, symmetry, materials, pairings, groups)
            require_support(mesh, symmetry.own_nodes(layout.face_pairs.nodes), fixed, constraints, source)
            _require_free(symmetry, pairings, groups, fixed, source)
        free = () if case.rotation is None else free_body_messages(mesh, fixed, constraints)
        messages = (*source.doubts, *layout.messages, *tied.messages, *free)
        blade = None if case.mistuning is None else blade_nodes(case.mistuning, mesh, symmetry.sectors)
        layout = replace(
            layout,
            odd_values=odd_values,
            facts=(*layout.facts, *tied.facts),
            messages=messages,
            notes=source.messages,
            body_names=mesh.body_names,
            blade_nodes=blade,
            unit_loads=_unit_loads(case, mesh, materials, symmetry),
        )
        element: Hexahedron = "incompatible"
        if isinstance(section, SectorMeshSection) and section.element is not None:
            element = section.element
        sector = MeshSetup(mesh, materials, fixed, element, layout, tuple(pairings.values()), constraints)
        top_speed = None if case.rotation is None else case.rotation.top_speed
        return CyclicSetup(sector, symmetry, self.rotation_speed(case), _has_coriolis(case), top_speed)

    def find_layout(self, case: CyclicCase, mesh: Mesh) -> Layout:
        """The layout on the mesh of the sector; ``mesh`` must be that of :func:`set_up`."""
        setup = self.set_up(case)
        if not np.array_equal(setup.sector.mesh.points, mesh.points):
            raise InputError("the structure belongs to another sector than the case.")
        return setup.layout

    def rotation_speed(self, case: CyclicCase) -> float:
        """rad/s; 0 where nothing rotates."""
        return 0.0 if case.rotation is None else case.rotation.speed

    def wave(self, case: CyclicCase) -> TravellingWave:
        """How the forces travel round the disk."""
        section = case.travelling_wave
        assert section is not None  # a case without it is rejected
        return TravellingWave(section.engine_order, section.direction)

    def facts(self, case: CyclicCase) -> tuple[Derived, ...]:
        """What a travelling wave and the speed mean for the numbers of the page."""
        wave = self.wave(case)
        return (
            (
                "Engine order",
                wave.engine_order,
                "-",
                f"{wave.direction} wave; all forces travel with it",
            ),
            ("Sectors", "all alike", "-", "amplitudes, energies and forces are those of each one, at another time"),
            *speed_facts(self.rotation_speed(case), _has_coriolis(case)),
        )

    def warnings(self, case: CyclicCase) -> tuple[str, ...]:
        """What a rotation does not change."""
        solved = case.preload.method == "solved"
        return tuple(speed_messages(self.rotation_speed(case), solved, _has_coriolis(case), ADD_CORIOLIS))

    def load_sizes(self, case: CyclicCase) -> Mapping[str, tuple[float, ...]]:
        """The square of the speed in 1/s2, for the centrifugal load of a solved preload."""
        if case.rotation is None or case.preload.method == "prescribed":
            return {}
        return {"rotation": (case.rotation.speed**2,)}

    def _distributed_words(self, case: CyclicCase) -> list[str]:
        speed = self.rotation_speed(case)
        return [f"rotation at {speed:g} rad/s"] if speed else []

    def _excitation_words(self, case: CyclicCase) -> list[str]:
        wave = self.wave(case)
        forces = super()._excitation_words(case)
        return [f"{wave.direction.capitalize()} wave of engine order {wave.engine_order}: {' and '.join(forces)}"]


def _unit_loads(
    case: CyclicCase, mesh: Mesh, materials: Sequence[Material], symmetry: CyclicSymmetry
) -> dict[str, FloatArray]:
    """The centrifugal load (3 * n_nodes, 1) N of this sector at 1 rad/s, if it rotates."""
    if case.rotation is None:
        return {}
    return {"rotation": centrifugal_load(mesh, materials, symmetry.direction, symmetry.point)[:, None]}


def _has_coriolis(case: CyclicCase) -> bool:
    return case.rotation is not None and case.rotation.coriolis


def _source(section: SectorMeshSection | BladedDiskSection) -> ImportedModel:
    """The mesh of a file, or of dimensions."""
    if isinstance(section, SectorMeshSection):
        return read_source(section)
    with keys_of_section("structure"):
        disk = BladedDisk(**section.model_dump(exclude={"kind"}))
        mesh = disk.mesh()
    return ImportedModel(
        mesh, "the parametric disk", "parametric", np.arange(mesh.n_nodes), np.arange(mesh.n_cells), "m", "SI",
        node_forces=np.zeros((mesh.n_nodes, 3)),
    )  # fmt: skip


def _fixed(section: SectorMeshSection | BladedDiskSection) -> tuple[str, ...]:
    return section.fixed if isinstance(section, SectorMeshSection) else ("bore",)


def _symmetry(section: SectorMeshSection | BladedDiskSection, mesh: Mesh) -> CyclicSymmetry:
    """The symmetry of the boundaries. Raises InputError that names the keys of [structure]."""
    if isinstance(section, BladedDiskSection):
        boundaries = mesh.node_set(LEFT), mesh.node_set(RIGHT)
        return cyclic_symmetry(mesh.points, *boundaries, sectors=section.sectors, axis="z")
    with named_entry("structure.left"):
        left = mesh.node_set(section.left)
    with named_entry("structure.right"):
        right = mesh.node_set(section.right)
    if section.axis_point is not None and section.axis is None:
        raise InputError(
            "structure.axis_point is given without structure.axis. Give both, or none for an axis x, y or z through "
            "the origin.",
            ("structure.axis_point",),
        )
    axis: Axis | None = None
    if section.axis is not None:
        axis = (section.axis_point or (0.0, 0.0, 0.0), section.axis)
    try:
        if section.tied:
            return tied_symmetry(mesh, section.left, section.right, sectors=section.sectors, axis=axis)
        return cyclic_symmetry(mesh.points, left, right, sectors=section.sectors, axis=axis)
    except InputError as error:
        error.concern(*(f"structure.{name}" for name in error.keys))
        raise


def _require_own_sector(mesh: Mesh, symmetry: CyclicSymmetry, source: ImportedModel) -> None:
    """Raise InputError for a part of the mesh that reaches over more than two sectors."""
    first = np.eye(3)[np.abs(symmetry.direction).argmin()]
    first = np.cross(symmetry.direction, first)
    first /= np.linalg.norm(first)
    arms = mesh.points - symmetry.point
    second = np.cross(symmetry.direction, first)
    part = connected_parts([block.cells for block in mesh.blocks])
    for number in np.unique(part):
        cells = np.flatnonzero(part == number)
        nodes = mesh.nodes_of_cells(cells)
        phase = arms[nodes] @ first + 1j * (arms[nodes] @ second)
        angle = np.angle(phase * np.conj(phase.sum()))
        span = float(np.ptp(angle)) * symmetry.sectors / (2.0 * np.pi)
        if span > MOST_SECTORS_OF_A_PART:
            raise InputError(
                f"the part of the mesh with element {source.shown(source.element_labels[cells[0]])} reaches over "
                f"{span:.3g} sectors of {360.0 / symmetry.sectors:.4g} degrees, at most {MOST_SECTORS_OF_A_PART:g} are "
                "possible. Give a mesh of one sector: a part that reaches further touches sectors beyond the next one.",
                ("structure.file",),
            )


def _layout(
    both: Mesh,
    symmetry: CyclicSymmetry,
    materials: tuple[Material, ...],
    pairings: Mapping[str, Pairing],
    groups: Mapping[str, NodeGroup],
) -> SectorLayout:
    """The layout on the sector; ``both`` is the mesh of this sector and the next one."""
    names, found = tuple(pairings), tuple(pairings.values())
    for name, pairing in pairings.items():
        with named_entry(f"interfaces.{name}"):
            _require_within_two(symmetry, pairing.pairs)
    for name, group in groups.items():
        if group.nodes.size > MOST_NODES_OF_A_PLACE:
            raise InputError(
                f"{name}: its set has {group.nodes.size} nodes, but at most {MOST_NODES_OF_A_PLACE} are possible on a "
                "sector, whose matrices contain all of them. Give a smaller set, a point or a node.",
                (name,),
            )
    return SectorLayout(
        FacePairs.concatenate([each.pairs for each in found]),
        names,
        tuple(face_materials(both, (*materials, *materials), each) for each in found),
        groups,
        facts=tuple(pairing_facts(names, found)),
        messages=tuple(f"interfaces.{name}: {words}" for name, each in pairings.items() for words in each.warnings),
        contact_sets=tuple(tuple(s for s in (each.first, each.second) if s in both.node_sets) for each in found),
        symmetry=symmetry,
    )


def _require_within_two(symmetry: CyclicSymmetry, pairs: FacePairs) -> None:
    """Raise InputError for pairs two sectors ahead, or of the next sector alone."""
    _, ahead = symmetry.homes(pairs.nodes)
    if ahead.max() > 1:
        raise InputError(
            "a pair reaches two sectors ahead, because a face of the next sector contains nodes of its right boundary. "
            "Pair the faces the other way round: that of the next sector at its left boundary."
        )
    if ahead.min() > 0:
        raise InputError(
            'both faces belong to the next sector, so this is not a joint of this sector. Leave "next" out of at least '
            "one name."
        )


def _require_free(
    symmetry: CyclicSymmetry,
    pairings: Mapping[str, Pairing],
    groups: Mapping[str, NodeGroup],
    fixed: IntArray,
    source: ImportedModel,
) -> None:
    """Raise InputError for a contact pair, a force or a response on a constrained node."""
    constrained = np.unique(fixed // 3)
    named = {f"interfaces.{name}": each.pairs.nodes for name, each in pairings.items()}
    for name, nodes in (named | {name: each.nodes for name, each in groups.items()}).items():
        with named_entry(name):
            own = symmetry.own_nodes(nodes)
        wrong = np.intersect1d(own, constrained)
        if wrong.size:
            label = source.shown(source.node_labels[wrong[0]])
            raise InputError(
                f"{name}: node {label} of the mesh is constrained ({wrong.size} of its nodes are). Remove these nodes "
                "from the set or from the constraint.",
                (name,),
            )
