"""The contact lines of a cylindrical damper: pairs, loads and stiffness of a study."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import cos, sin

import numpy as np

from stickslip.case.case import TwoBladeCase
from stickslip.case.two_blade_sections import CylindricalSection
from stickslip.contact.crowned_line import crowned_forces
from stickslip.contact.cylinder import line_loads
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.pairing.line_pairs import pair_lines
from stickslip.contact.stiffness.hertz_line import HertzLine, LineBody, depth_below_node, node_radius
from stickslip.core.errors import concerning
from stickslip.core.validation import FloatArray
from stickslip.model.kinds.damper_shapes import Cylinder
from stickslip.model.kinds.dimensions import about_dimensions, elements_of, geometry_of
from stickslip.model.kinds.plane_sections import Section, sides_at
from stickslip.model.kinds.two_blade_mesh import sections
from stickslip.model.layout import Derived
from stickslip.model.rough_face import case_material
from stickslip.structure.mesh import Mesh


@dataclass(frozen=True)
class ContactLines:
    """Both contact lines of a cylinder, left and right.

    ``lines`` is the contact of each, ``angles`` in rad of the platforms, ``length`` in m, ``crowning`` in m the drop at
    both ends, ``force`` in N on the damper and ``friction`` at assembly.
    """

    lines: tuple[HertzLine, HertzLine]
    angles: tuple[float, float]
    length: float
    crowning: float
    force: float
    friction: float

    @property
    def loads(self) -> tuple[float, float]:
        """Normal load of each line, N."""
        return line_loads(self.force, self.angles, self.friction)

    @property
    def width(self) -> float:
        """m, width of the strip that the pairs stand for: that of the contact under the mean load of both lines."""
        return 2.0 * self.lines[0].half_width(0.5 * sum(self.loads) / self.length)

    def pairs(self, mesh: Mesh, sets: Sequence[tuple[str, str]]) -> list[FacePairs]:
        """Contact pairs of the lines, whose node sets in the mesh are ``sets``."""
        normals = [(side * sin(angle), 0.0, cos(angle)) for side, angle in zip((-1.0, 1.0), self.angles, strict=True)]
        return [
            pair_lines(mesh, *names, normal, self.width, self.crowning)
            for names, normal in zip(sets, normals, strict=True)
        ]

    def preload(self, pairs: FacePairs) -> FloatArray:
        """(n_pairs,) N of pairs of a layout; below zero the gap of a pair beyond the contact.

        Raises InputError for a load that no contact line of this mesh carries.
        """
        loads = np.zeros(pairs.n_pairs)
        for face, (line, load) in enumerate(zip(self.lines, self.loads, strict=True)):
            here = pairs.face == face
            length = pairs.area[here] * (self.length / pairs.area[here].sum())
            with concerning("preload", "damper.radius"):
                loads[here] = crowned_forces(line, load, length, pairs.gap[here])
        return loads


def contact_lines(case: TwoBladeCase) -> ContactLines | None:
    """The contact lines of a case with a cylindrical damper, else None. Raises InputError for parts that do not fit."""
    if not isinstance(case.damper, CylindricalSection):
        return None
    geometry, elements, material = geometry_of(case), elements_of(case), case_material(case)
    centre = Cylinder(case.damper.radius).centre(geometry.roof)
    with about_dimensions():
        left, right, damper = sections(geometry, elements)

    def body(section: Section, name: str) -> LineBody:
        radius = node_radius(case.mesh.element, *sides_at(section, int(section.sets[name][0])))
        depth = depth_below_node(radius, material.poisson_ratio)
        return LineBody(material.young_modulus, material.poisson_ratio, depth)

    lines = [
        HertzLine(case.damper.radius, body(damper, name), body(blade, "contact"))
        for name, blade in (("left", left), ("right", right))
    ]
    return ContactLines(
        (lines[0], lines[1]),
        geometry.roof.angles,
        geometry.damper_length,
        case.damper.crowning,
        _nominal_force(case, geometry.damper_volume * material.density, centre),
        case.preload.friction_coefficient_at_assembly,
    )


def _nominal_force(case: TwoBladeCase, mass: float, centre: FloatArray) -> float:
    """N on the damper: as given, of its prescribed loads, or by the rotation of its mass in kg at x, z of its axis."""
    if case.preload.damper_force is not None:
        return case.preload.damper_force
    if case.preload.values is not None:
        return max(sum(max(value, 0.0) for value in case.preload.values), 1e-9)
    assert case.rotation is not None  # nothing else loads a damper without force
    axis, arm = np.array(case.rotation.axis), np.array([centre[0], 0.0, centre[1]]) - case.rotation.point
    distance = float(np.linalg.norm(arm - (arm @ axis) * axis))
    return max(mass * case.rotation.speed**2 * distance, 1e-9)


def line_facts(case: TwoBladeCase) -> Iterator[Derived]:
    """Width, pressure and reference depths of the contact lines."""
    contact = contact_lines(case)
    if contact is None:
        return
    for name, line, load in zip(("left", "right"), contact.lines, contact.loads, strict=True):
        force = load / contact.length
        where = f"{name} line, straight, by Hertz"
        yield f"Force per length, {name} line", 1e-3 * force, "N/mm", "mean of the line"
        yield f"Width of the contact, {name} line", 2e6 * line.half_width(force), "µm", where
        yield f"Largest pressure, {name} line", 1e-6 * line.largest_pressure(force), "MPa", where
    damper, blade = (1e3 * body.depth for body in contact.lines[0].bodies)
    words = "of damper and blade, left line; the finite elements are the bodies beyond"
    yield "Reference depths of the contact stiffness", f"{damper:.3g} and {blade:.3g}", "mm", words
