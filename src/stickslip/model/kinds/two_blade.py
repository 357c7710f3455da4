"""The study of kind "two-blade": two blades and the damper between them, meshed from their dimensions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stickslip.case.case import TwoBladeCase
from stickslip.case.law_constants import LawConstants, contact_law_declaration
from stickslip.contact.constants import FRICTION, NORMAL_LOAD
from stickslip.contact.pairing.pairing import FacePairs, pair_faces
from stickslip.contact.preload import prescribed_preload, uniform_preload
from stickslip.core.errors import InputError, keys_of_section
from stickslip.core.validation import FloatArray
from stickslip.model.face_laws import NamedLaw
from stickslip.model.joint import STARTING_PRESSURE, FaceSettings
from stickslip.model.kinds.contact_lines import contact_lines, line_facts
from stickslip.model.kinds.damper_words import damper_facts, damper_warnings
from stickslip.model.kinds.dimensions import about_dimensions, elements_of, geometry_of
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.model.layout import Derived, Direction, GroupForce, GroupUnbalance, Layout, NodeGroup, Output
from stickslip.model.rotation import Rotation, rotating_bodies, speed_facts, speed_messages
from stickslip.model.rough_face import case_material
from stickslip.structure.body_load import centrifugal_load
from stickslip.structure.elasticity import Element, Material, Structure, assemble
from stickslip.structure.mesh import Mesh
from stickslip.structure.model_facts import material_oddities, size_oddities, wave_oddities
from stickslip.structure.rotating import RotatingBodies
from stickslip.structure.rotating_superelement import RPM

FACES = (("damper_left_face", "left_face"), ("damper_right_face", "right_face"))
FACE_NAMES = ("left face", "right face")
BODY_NAMES = ("left blade", "right blade", "damper")
AXES: dict[str, Direction] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
SAME_SPEED = 1e-6  # chosen: relative difference of two speeds that is that of their units
# Node sets of one node where forces act (N1, N2) and displacements are read (A, the middles of the damper's faces).
NODE_GROUPS = ("excitation_left", "excitation_right", "response", "damper_left_mid", "damper_right_mid")
# The ends of the damper's flat bottom, where a static force F_N acts, half at each.
EDGES = ("damper_front_edge", "damper_back_edge")


@dataclass(frozen=True)
class TwoBladeSetup:
    """Mesh and material of the two blades and the damper."""

    mesh: Mesh
    material: Material
    element: Element
    layout: Layout
    rotation: Rotation | None = None

    def assemble(self) -> Structure | RotatingBodies:
        """Matrices of the mesh, at the speed of a rotation. Raises InputError for a speed that is too high."""
        return rotating_bodies(assemble(self.mesh, self.material, element=self.element), self.rotation)

    def most_unknowns(self, n_modes: int) -> int:
        """Of the nodes and modes that the reduction retains."""
        return self.layout.most_unknowns(n_modes)

    def sizes(self) -> tuple[tuple[str, str], ...]:
        """Elements and nodes."""
        return (("elements", f"{self.mesh.n_cells} ({self.element})"), ("nodes", f"{self.mesh.n_nodes}"))

    def write_places(self, folder: Path) -> tuple[Path, ...]:
        """Nothing: the pairs are nodes of the mesh."""
        return ()


class TwoBladeKind:
    """Two blades and the damper between them."""

    def set_up(self, case: TwoBladeCase) -> TwoBladeSetup:
        """Mesh, contact pairs and ports. Raises InputError for a geometry that does not fit."""
        mesh = build_mesh(case)
        layout = self.find_layout(case, mesh)
        return TwoBladeSetup(mesh, case_material(case), case.mesh.element, layout, _rotation(case))

    def find_layout(self, case: TwoBladeCase, mesh: Mesh) -> Layout:
        """Contact pairs of both faces, left face first, and the places of forces and responses."""
        lines = contact_lines(case)
        pairs = FacePairs.concatenate(
            [pair_faces(mesh, *names) for names in FACES] if lines is None else lines.pairs(mesh, FACES)
        )
        node_groups = {name: NodeGroup.single(int(mesh.node_set(name)[0])) for name in NODE_GROUPS}
        material = case_material(case)
        if _static_force(case):
            node_groups |= {name: _edge_group(mesh, name) for name in EDGES}
        unit_loads = {}
        if case.rotation is not None:
            axis, point = np.array(case.rotation.axis), np.array(case.rotation.point)
            unit_loads["rotation"] = centrifugal_load(mesh, [material] * 3, axis, point)[:, None]
        odd_values = (
            *size_oddities(mesh.points),
            *material_oddities("the material", material, "its unit", "material"),
            *wave_oddities("the structure", material, mesh.points),
        )
        return Layout(
            pairs,
            FACE_NAMES,
            ((material, material),) * len(FACES),
            node_groups,
            unit_loads,
            body_names=BODY_NAMES,
            contact_sets=FACES if lines is None else ((),) * len(FACES),
            odd_values=odd_values,
            line_width=None if lines is None else lines.width,
        )

    def preload(self, case: TwoBladeCase, layout: Layout) -> FloatArray:
        """(n_pairs,) N of the wedge under centrifugal force, or as prescribed; where it is solved, a start for it."""
        face_pairs = layout.face_pairs
        if case.preload.values is not None:
            if len(case.preload.values) != face_pairs.n_pairs:
                first = int((face_pairs.face == 0).sum())
                raise InputError(
                    f"preload.values has {len(case.preload.values)} entries, but this mesh has {face_pairs.n_pairs} "
                    f"contact pairs. Give one force for each: {first} of the left face, then "
                    f"{face_pairs.n_pairs - first} of the right one; or give centrifugal_force instead.",
                    ("preload.values",),
                )
            return prescribed_preload(case.preload.values, face_pairs.n_pairs)
        force = case.preload.damper_force
        if force is None:
            return STARTING_PRESSURE * face_pairs.area
        lines = contact_lines(case)
        if lines is not None:
            return lines.preload(face_pairs)
        with keys_of_section("preload", {"friction_coefficient": "friction_coefficient_at_assembly"}):
            return uniform_preload(
                force,
                case.geometry.platform_angle,
                face_pairs.area,
                face_pairs.face,
                friction_coefficient=case.preload.friction_coefficient_at_assembly,
                right_platform_angle=case.geometry.right_platform_angle,
            )

    def face_settings(self, case: TwoBladeCase) -> tuple[FaceSettings, ...]:
        """Both faces follow [friction] and [contact_stiffness], or the lines of a cylinder Hertz."""
        common, law, lines = FaceSettings.of_case(case), case.friction.other_law, contact_lines(case)
        faces = (common,) * len(FACES)
        if law is not None:
            declared = contact_law_declaration(law)
            none = LawConstants(declared.constants, {})
            keys = {FRICTION: "friction.coefficient", NORMAL_LOAD: "preload"}
            faces = tuple(
                replace(common, contact_law=NamedLaw(name, law, declared, none, "friction", keys))
                for name in FACE_NAMES
            )
        if lines is None or not common.is_pressed:
            return faces
        return tuple(replace(face, line=line) for face, line in zip(faces, lines.lines, strict=True))

    def rotation_speed(self, case: TwoBladeCase) -> float:
        """rad/s; 0 where nothing rotates."""
        return 0.0 if case.rotation is None else case.rotation.speed

    def load_sizes(self, case: TwoBladeCase) -> Mapping[str, tuple[float, ...]]:
        """Speed squared in 1/s2."""
        return {} if case.rotation is None else {"rotation": (case.rotation.speed**2,)}

    def static_forces(self, case: TwoBladeCase) -> tuple[GroupForce, ...]:
        """Half of F_N at each end of the damper's bottom, where the preload is solved; else the wedge's is known."""
        force = _static_force(case)
        return tuple(GroupForce(name, (0.0, 0.0, 1.0), 0.5 * force) for name in EDGES) if force else ()

    def forces(self, case: TwoBladeCase) -> tuple[GroupForce, ...]:
        """Forces at N1 and N2: single (N1 alone), same direction, or opposite."""
        section = case.excitation
        second = {"single": 0.0, "same": 1.0, "opposite": -1.0}[section.mode]
        return (
            GroupForce("excitation_left", section.direction, section.amplitude),
            GroupForce("excitation_right", section.direction, second * section.amplitude),
        )

    def unbalances(self, case: TwoBladeCase) -> tuple[GroupUnbalance, ...]:
        """None: forces at N1 and N2 excite the blades."""
        return ()

    def base_motion(self, case: TwoBladeCase) -> None:
        """None: forces at N1 and N2 excite the blades."""

    def wave(self, case: TwoBladeCase) -> None:
        """None: the blades are no disk."""

    def outputs(self, case: TwoBladeCase) -> tuple[dict[str, Output], dict[str, tuple[str, ...]]]:
        """A along the excitation's direction and both sides of the damper along x, y, z; what is drawn together."""
        named_outputs, groups = {"blade tip A": Output("response", case.excitation.direction)}, {}
        for side in ("left", "right"):
            names = tuple(f"damper {side} {axis}" for axis in AXES)
            named_outputs |= {name: Output(f"damper_{side}_mid", AXES[name[-1]]) for name in names}
            groups[f"Damper, middle of its {side} face"] = names
        return named_outputs, groups

    def force_amplitude(self, case: TwoBladeCase) -> float:
        """N of each force."""
        return case.excitation.amplitude

    def excitation_keys(self, case: TwoBladeCase) -> dict[str, float]:
        """The amplitude of both forces."""
        return {"excitation.amplitude": case.excitation.amplitude}

    def description(self, case: TwoBladeCase) -> str:
        """One sentence on force, load and friction."""
        kinds = {
            "single": "at one blade",
            "same": "at both blades, same direction",
            "opposite": "at both blades, opposed",
        }
        excitation, force = case.excitation, case.preload.damper_force
        load = "prescribed preload" if force is None else f"centrifugal force {force:g} N"
        if case.preload.method == "solved":
            turning = "" if case.rotation is None else f"rotation at {case.rotation.speed:g} rad/s"
            load = f"solved preload under {turning or load}, tractions at rest {case.preload.residual_traction}"
        friction = case.friction.coefficient
        return f"Force {excitation.amplitude:g} N {kinds[excitation.mode]}, {load}, friction {friction:g}."

    def facts(self, case: TwoBladeCase) -> tuple[Derived, ...]:
        """Load, mass and lock-up of the damper; the contact lines of a cylinder; the effects of the speed."""
        return (*damper_facts(case), *line_facts(case), *speed_facts(self.rotation_speed(case)))

    def warnings(self, case: TwoBladeCase) -> tuple[str, ...]:
        """A damper that friction locks; what a rotation does not change."""
        speed, of_damper = self.rotation_speed(case), case.preload.speed_of_rotation
        follows = case.preload.method == "solved" or of_damper is not None
        return (*damper_warnings(case), *speed_messages(speed, follows), *_two_speeds(speed, of_damper))

    def rough_face_size(self, case: TwoBladeCase) -> tuple[float, float]:
        """m along and across the contact face, for a picture of it."""
        return case.geometry.damper_length, case.geometry.contact_face_width


def build_mesh(case: TwoBladeCase) -> Mesh:
    """Mesh of the two blades and the damper. Raises InputError for a geometry that does not fit."""
    geometry, elements = geometry_of(case), elements_of(case)
    with about_dimensions():
        mesh = blade_pair_mesh(geometry, elements)
    return mesh.quadratic() if case.mesh.element == "serendipity" else mesh


def _two_speeds(speed: float, of_damper: float | None) -> Iterator[str]:
    """A message on the load of a damper at another speed (rad/s) than that of the blades."""
    if speed and of_damper is not None and abs(of_damper - speed) > SAME_SPEED * speed:
        yield (
            f"preload.speed_of_rotation is {of_damper / RPM:.6g} rpm, but rotation.speed is {speed / RPM:.6g} rpm: the "
            "load of the damper and the stiffness of the blades are those of different speeds. Give the same speed."
        )


def _rotation(case: TwoBladeCase) -> Rotation | None:
    section = case.rotation
    if section is None:
        return None
    return Rotation(section.speed, np.array(section.axis), np.array(section.point), top_speed=section.top_speed)


def _static_force(case: TwoBladeCase) -> float:
    """N on the damper, both ends together; 0 where the preload is not solved from it."""
    return (case.preload.damper_force or 0.0) if case.preload.method == "solved" else 0.0


def _edge_group(mesh: Mesh, name: str) -> NodeGroup:
    """A line along x with a uniform load."""
    nodes = mesh.node_set(name)
    if nodes.size == 1:
        return NodeGroup.single(int(nodes[0]))
    nodes = nodes[np.argsort(mesh.points[nodes, 0])]
    length = np.diff(mesh.points[nodes, 0])
    weights = np.zeros(nodes.size)
    weights[:-1] += 0.5 * length
    weights[1:] += 0.5 * length
    return NodeGroup(nodes, weights / weights.sum())
