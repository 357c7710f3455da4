"""The study of kind "mesh": bodies from a mesh file, several materials, joints between named faces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stickslip.case.case import MeshCase
from stickslip.case.interface_sections import GROUND, MeshInterfaceSection
from stickslip.case.own_sections import MeshFileSection
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.pairing.pairing import pair_surfaces, pair_with_ground
from stickslip.contact.pairing.pairing_result import FROM_PAIRING, Pairing, write_pairs
from stickslip.core.errors import InputError, concerning, keys_of_section
from stickslip.core.plausible import OddValue, suspecting
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.model.kinds.body_materials import body_materials
from stickslip.model.kinds.distributed_loads import load_sizes, unit_loads
from stickslip.model.kinds.entry import named_entry
from stickslip.model.kinds.mesh_places import following_groups, node_groups_of, require_free
from stickslip.model.kinds.mesh_support import require_support
from stickslip.model.kinds.own import OwnKind
from stickslip.model.kinds.ties import (
    eliminated,
    require_independent,
    study_ties,
)
from stickslip.model.layout import BaseMotionOfSupport, Derived, Layout, NodeGroup
from stickslip.model.overlap import require_single_joints
from stickslip.model.rotation import (
    ADD_CORIOLIS,
    Rotation,
    free_body_messages,
    rotating_bodies,
    speed_facts,
    speed_messages,
)
from stickslip.structure.attachments import Attachments, attach
from stickslip.structure.body_load import translation_inertia
from stickslip.structure.constraints import Constraints
from stickslip.structure.elasticity import Hexahedron, Material, Structure, assemble_bodies
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.model_facts import body_volumes, bounding_box, model_oddities
from stickslip.structure.rotating import RotatingBodies

PAIRS_FILE = "contact_pairs.vtu"


@dataclass(frozen=True)
class MeshSetup:
    """A mesh with the material of each body, its constraints, and the pairings of its interfaces."""

    mesh: Mesh
    materials: tuple[Material, ...]
    fixed_unknowns: IntArray
    element: Hexahedron
    layout: Layout
    pairings: tuple[Pairing, ...]
    constraints: Constraints | None = None
    attachments: Attachments | None = None
    rotation: Rotation | None = None

    def assemble(self) -> Structure | RotatingBodies:
        """Matrices of all bodies, at the speed of a rotation. Raises InputError for a speed that is too high."""
        masses = None if self.attachments is None else self.attachments.masses
        return rotating_bodies(self.at_rest(), self.rotation, masses)

    def at_rest(self) -> Structure:
        """Matrices of all bodies at rest, with the mass points and springs of the file."""
        solids = assemble_bodies(
            self.mesh,
            self.materials,
            self.element,
            fixed_unknowns=self.fixed_unknowns,
            constraints=self.constraints,
        )
        return attach(solids, self.attachments)

    def most_unknowns(self, n_modes: int) -> int:
        """Of the nodes and modes that the reduction retains."""
        return self.layout.most_unknowns(n_modes)

    def sizes(self) -> tuple[tuple[str, str], ...]:
        """Elements, nodes, bodies with their material and mass, named sets."""
        mesh, volumes = self.mesh, body_volumes(self.mesh)
        kinds = ", ".join(dict.fromkeys(block.kind for block in mesh.blocks))
        low, high = bounding_box(mesh.points)
        box = " x ".join(f"{1e3 * size:.4g}" for size in high - low)
        bodies = tuple(
            (
                f"body {name}",
                f"{np.count_nonzero(mesh.body == number)} elements, {material.density * volume:.4g} kg, "
                f"E {1e-9 * material.young_modulus:.4g} GPa{_average(material)}, density {material.density:.4g} kg/m^3",
            )
            for number, (name, volume, material) in enumerate(
                zip(mesh.body_names, volumes, self.materials, strict=True)
            )
        )
        others = sorted(mesh.node_sets.keys() - mesh.face_sets.keys())
        return (
            ("elements", f"{mesh.n_cells} ({kinds})"),
            ("nodes", f"{mesh.n_nodes}"),
            ("bounding box", f"{box} mm"),
            *bodies,
            ("face sets", ", ".join(sorted(mesh.face_sets)) or "none"),
            ("other sets", ", ".join(others) or "none"),
            ("constrained displacements", f"{self._zero_unknowns().size}"),
            *(() if self.attachments is None else self.attachments.sizes()),
            *self._tied(),
        )

    def _zero_unknowns(self) -> IntArray:
        return self.fixed_unknowns if self.constraints is None else self.constraints.zero_unknowns

    def _tied(self) -> tuple[tuple[str, str], ...]:
        if self.constraints is None:
            return ()
        redundant = self.constraints.n_redundant
        words = f"; {redundant} equations follow from others" if redundant else ""
        return (("dependent displacements", f"{self.constraints.dependent_unknowns.size}{words}"),)

    def write_places(self, folder: Path) -> tuple[Path, ...]:
        """The pairs, and the points of their faces without a partner."""
        return (write_pairs(folder / PAIRS_FILE, self.pairings),)


def _average(material: Material) -> str:
    return "" if material.elastic is None else " (average of all directions)"


class MeshKind(OwnKind[MeshCase]):
    """Bodies from a mesh file."""

    def set_up(self, case: MeshCase) -> MeshSetup:
        """Read the mesh, pair its faces and locate forces and responses.

        Raises ImportFileError for the file; InputError that names the entry of the study file for a set that is missing
        or empty, a material that is missing, faces without a pair, and a body without support.
        """
        source = read_source(case.structure)
        _require_complete(source)
        mesh, materials = source.mesh, body_materials(case, source)
        odd_values = tuple(model_oddities(mesh, dict(zip(mesh.body_names, materials, strict=True))))
        with suspecting(odd_values):
            fixed = fixed_unknowns_of(case.structure.fixed, source)
            pairings = tuple(pairing_of(mesh, name, each) for name, each in case.interfaces.items())
            require_single_joints(mesh, case.interfaces)
            ties = study_ties(mesh, source.equations, case.ties)
            named = dict(zip(case.interfaces, pairings, strict=True))
            groups = node_groups_of(case, source)
            contact = {name: each.pairs.nodes for name, each in named.items()}
            constraints = eliminated(ties, fixed, contact, groups)
            require_independent(constraints, source, contact)
            groups |= following_groups(case, source, groups, ties, constraints)
            layout = _layout(case, source, materials, named, (fixed, constraints), groups, odd_values)
            if ties is not None:
                layout = replace(
                    layout, messages=(*layout.messages, *ties.messages), facts=(*layout.facts, *ties.facts)
                )
        element, rotation = case.structure.element or "incompatible", _rotation(case)
        return MeshSetup(mesh, materials, fixed, element, layout, pairings, constraints, source.attachments, rotation)

    def find_layout(self, case: MeshCase, mesh: Mesh) -> Layout:
        """The layout on the mesh of the file; ``mesh`` must be that of :func:`set_up`."""
        setup = self.set_up(case)
        if not np.array_equal(setup.mesh.points, mesh.points):
            raise InputError("the structure belongs to another mesh file than the case.")
        return setup.layout

    def rotation_speed(self, case: MeshCase) -> float:
        """rad/s; 0 where nothing rotates."""
        return 0.0 if case.rotation is None else case.rotation.speed

    def facts(self, case: MeshCase) -> tuple[Derived, ...]:
        """The effects of the speed."""
        has_coriolis = case.rotation is not None and case.rotation.coriolis
        return (*super().facts(case), *speed_facts(self.rotation_speed(case), has_coriolis))

    def warnings(self, case: MeshCase) -> tuple[str, ...]:
        """What a rotation does not change."""
        has_coriolis = case.rotation is not None and case.rotation.coriolis
        solved = case.preload.method == "solved"
        words = speed_messages(self.rotation_speed(case), solved, has_coriolis, ADD_CORIOLIS)
        return (*super().warnings(case), *words)

    def load_sizes(self, case: MeshCase) -> Mapping[str, tuple[float, ...]]:
        """Sizes of rotation, gravity and pressures."""
        return load_sizes(case)

    def _distributed_words(self, case: MeshCase) -> list[str]:
        words = [f"{each.pressure:g} Pa on {name}" for name, each in case.pressures.items()]
        words += [] if case.gravity is None else [f"gravity of {case.gravity.acceleration:g} m/s^2"]
        speed = self.rotation_speed(case)
        return words + ([f"rotation at {speed:g} rad/s"] if speed else [])

    def base_motion(self, case: MeshCase) -> BaseMotionOfSupport | None:
        """The motion of all constrained nodes."""
        section = case.base_motion
        return None if section is None else BaseMotionOfSupport(section.direction, section.amplitude, section.kind)


def read_source(section: MeshFileSection) -> ImportedModel:
    """The mesh file."""
    with keys_of_section("structure"), concerning("file"):
        return read_model(
            section.file, section.length_unit, section.unit_system, bool(section.includes_outside), section.temperature
        )


def _require_complete(source: ImportedModel) -> None:
    if source.sector:
        raise InputError(
            f'the model is one sector of a disk: {source.sector}. kind is "mesh", which would solve the sector alone. '
            'Use kind = "cyclic" with left and right for its boundaries (docs/bladed_disks.md), or remove the entry '
            "from the model file.",
            ["structure.kind"],
        )


def fixed_unknowns_of(fixed: Sequence[str], source: ImportedModel) -> IntArray:
    """Indices among 3 * n_nodes that the file or structure.fixed constrains to zero."""
    constrained = [source.fixed_unknowns]
    for name in fixed:
        with named_entry("structure.fixed"):
            constrained.append((3 * source.mesh.node_set(name)[:, None] + np.arange(3)).ravel())
    return np.unique(np.concatenate(constrained)).astype(np.int64)


def pairing_of(mesh: Mesh, name: str, section: MeshInterfaceSection) -> Pairing:
    points = section.points or "nodes"
    with named_entry(f"interfaces.{name}"), keys_of_section(f"interfaces.{name}"):
        if section.second == GROUND:
            of_two_faces = ("search_distance", "edge_tolerance", "gap_tolerance", "adjust")
            wrong = [key for key in of_two_faces if getattr(section, key) is not None]
            if wrong:
                raise InputError(f"{wrong[0]} applies to two faces; the ground uses the first face. Remove it.", wrong)
            return pair_with_ground(mesh, section.first, points=points, gap=section.gap or 0.0, tangent=section.tangent)
        if section.gap is not None:
            raise InputError("gap belongs to the ground; the mesh defines it between faces. Remove it.", ["gap"])
        return pair_surfaces(
            mesh,
            section.first,
            section.second,
            points=points,
            search_distance=section.search_distance,
            edge_tolerance=section.edge_tolerance,
            gap_tolerance=section.gap_tolerance,
            tangent=section.tangent,
            adjust=section.adjust or "measured",
        )


def _layout(
    case: MeshCase,
    source: ImportedModel,
    materials: Sequence[Material],
    named: Mapping[str, Pairing],
    constrained: tuple[IntArray, Constraints | None],
    node_groups: Mapping[str, NodeGroup],
    odd_values: tuple[OddValue, ...],
) -> Layout:
    mesh, names, pairings = source.mesh, tuple(named), tuple(named.values())
    fixed, constraints = constrained
    pairs = FacePairs.concatenate([each.pairs for each in pairings])
    points, spring_constraints, supported = source.attachments, None, fixed
    masses = None if points is None else points.masses
    base_inertia = None
    if case.base_motion is not None:
        if not fixed.size:
            raise InputError(
                "[base_motion] moves the constrained nodes, but neither structure.fixed nor the file has any. "
                "Constrain some, or remove the section.",
                ("base_motion",),
            )
        base_inertia = translation_inertia(mesh, materials, masses)
        base_inertia += 0.0 if points is None else points.translation_inertia(constraints)
    if points is not None:
        supported, spring_constraints = points.supports(fixed, constraints)
    require_support(mesh, pairs.nodes, supported, constraints, source, spring_constraints)
    require_free(named, node_groups, fixed, source)
    messages = (
        *source.doubts,
        *(() if case.rotation is None else free_body_messages(mesh, supported, constraints, spring_constraints)),
        *(f"interfaces.{name}: {words}" for name, each in zip(names, pairings, strict=True) for words in each.warnings),
    )
    return Layout(
        pairs,
        names,
        tuple(face_materials(mesh, materials, each) for each in pairings),
        node_groups,
        unit_loads(case, mesh, materials, (points, constraints), fixed),
        base_inertia,
        tuple(pairing_facts(names, pairings)),
        messages,
        mesh.body_names,
        tuple((each.first,) if each.second == GROUND else (each.first, each.second) for each in pairings),
        odd_values,
        notes=(*source.messages, *_unused_forces(source)),
        file_numbers=(source.node_labels, source.element_labels),
    )


def pairing_facts(names: Sequence[str], pairings: Sequence[Pairing]) -> Iterator[Derived]:
    for name, pairing in zip(names, pairings, strict=True):
        for label, value, unit in pairing.summary():
            yield f"{label[0].upper()}{label[1:]}, {name}", value, unit or "-", FROM_PAIRING


def _rotation(case: MeshCase) -> Rotation | None:
    section = case.rotation
    if section is None:
        return None
    return Rotation(section.speed, np.array(section.axis), np.array(section.point), section.coriolis, section.top_speed)


def _unused_forces(source: ImportedModel) -> Iterator[str]:
    if source.node_forces.any():
        yield "the forces in the mesh file are not used; give them as [forces.NAME] or [static_loads.NAME]."


def face_materials(mesh: Mesh, materials: Sequence[Material], pairing: Pairing) -> tuple[Material, Material]:
    """Materials of both sides; the ground has that of the first side."""
    first = _body_of(mesh, pairing.first)
    second = first if pairing.second == GROUND else _body_of(mesh, pairing.second)
    return materials[first], materials[second]


def _body_of(mesh: Mesh, name: str) -> int:
    """The body that most nodes of a set belong to."""
    nodes = mesh.node_set(name)
    members = [np.isin(nodes, mesh.nodes_of_body(body)).sum() for body in range(len(mesh.body_names))]
    return int(np.argmax(members))
