"""The constant rotation of a study: the structure at its speed, and what of the effects of the speed is included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.core.errors import InputError, concerning
from stickslip.core.validation import FloatArray
from stickslip.model.layout import Derived
from stickslip.structure.constraints import Constraints
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.elasticity import Structure
from stickslip.structure.factor import best_backend
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.rotating import RotatingBodies, RotatingStructure, rotating
from stickslip.structure.rotating_superelement import RPM
from stickslip.structure.sector_structure import RangeOfSpeeds, SectorStructure
from stickslip.structure.tied_parts import supported_groups

_STIFFENING = (
    "stress stiffening and spin softening of all bodies that are constrained, by linear prestress theory; bodies that "
    "only contact supports have none, and contact forces at rest do not stress the others"
)
_AND_CORIOLIS = "; with Coriolis forces"
_WITHOUT_CORIOLIS = (
    "Coriolis forces are not included. They change frequencies of waves that travel round a shaft or a soft disk most, "
    "those of stiff blades little"
)

ADD_CORIOLIS = "; rotation.coriolis = true adds them"


@dataclass(frozen=True)
class Rotation:
    """A constant rotation: rad/s, (3,) direction of the axis and (3,) m on it, and whether Coriolis forces act.

    With a ``top_speed`` in rad/s, one reduction is valid for all speeds up to it.
    """

    speed: float
    axis: FloatArray
    point: FloatArray
    coriolis: bool = False
    top_speed: float | None = None

    @property
    def speed_rpm(self) -> float:
        """Revolutions per minute."""
        return self.speed / RPM

    def of(
        self, structure: Structure, symmetry: CyclicSymmetry | None = None, masses: FloatArray | None = None
    ) -> RotatingStructure:
        """The rotating structure, with mass points (n_nodes,) kg. Raises InputError for one without any constrained
        body."""
        backend = best_backend(structure.stiffness.shape[0])
        with concerning("structure"):
            return rotating(
                structure, self.axis, self.point, symmetry=symmetry, backend=backend, free_bodies="at rest",
                masses=masses,
            )  # fmt: skip

    def at_its_speed(self, rotor: RotatingStructure) -> Structure:
        """The structure with its stiffness at the speed. Raises InputError for one that is too high."""
        with concerning("rotation.speed"):
            return rotor.at(self.speed_rpm, "rotation.speed")


def speed_facts(speed: float, coriolis: bool = False) -> Iterator[Derived]:
    """The effects of a speed in rad/s that the model contains; at 0 nothing is different."""
    if speed:
        yield (
            "Speed of rotation",
            float(f"{speed / RPM:.10g}"),
            "rpm",
            f"with {_STIFFENING}{_AND_CORIOLIS if coriolis else ''}",
        )


def speed_messages(speed: float, loads_follow: bool, coriolis: bool = False, remedy: str = "") -> Iterator[str]:
    """What a speed in rad/s does not change; ``remedy`` for missing Coriolis forces."""
    if speed and not coriolis:
        yield f"[rotation] at {speed / RPM:.6g} rpm: {_WITHOUT_CORIOLIS}{remedy}."
    if speed and not loads_follow:
        yield (
            f"[rotation] at {speed / RPM:.6g} rpm does not change the normal loads, which are those that the study "
            "gives. Give those at this speed."
        )


def free_body_messages(
    mesh: Mesh, fixed: IntArray, constraints: Constraints | None = None, spring_constraints: Any = None
) -> Iterator[str]:
    """Bodies that only contact supports: the speed does not change their stiffness.

    ``fixed`` are constrained indices among the 3 * n_nodes displacements, ``spring_constraints`` csr rows
    of motions that springs at reference nodes constrain.
    """
    cells = [group.cells for group in supported_groups(mesh, fixed, constraints, spring_constraints) if group.free]
    if cells:
        bodies = np.unique(mesh.body[np.concatenate(cells)])
        names = ", ".join(mesh.body_names[body] for body in bodies)
        yield (
            f"[rotation]: contact alone supports a part of {names}, which keeps its stiffness at rest, has no Coriolis "
            "forces and does not stress other bodies. For a light damper that is a small error, for a blade in a slot "
            "of its disk a large one: connect such a blade by common nodes, or by [ties.NAME]."
        )


def rotating_bodies(
    structure: Structure, rotation: Rotation | None, masses: FloatArray | None = None
) -> Structure | RotatingBodies:
    """Bodies with mass points (n_nodes,) kg at the speed of a study; those at rest as they are.

    Raises InputError for a speed that is too high.
    """
    if rotation is None or not (rotation.speed or rotation.top_speed):
        return structure
    rotor = rotation.of(structure, masses=masses)
    if rotation.coriolis and rotor.unsupported.size:
        raise InputError(
            "rotation.coriolis is true, but contact alone supports a body of the structure. Without contact it would "
            "fly off, so there is no linear limit without contact. Set coriolis to false, or constrain the body.",
            ("rotation.coriolis",),
        )
    whirl = rotation.speed * rotor.coriolis if rotation.coriolis and rotation.speed else None
    top_rpm = None if rotation.top_speed is None else rotation.top_speed / RPM
    if top_rpm is not None:
        with concerning("rotation.top_speed"):
            rotor.at(top_rpm, "rotation.top_speed")
    return RotatingBodies(rotation.at_its_speed(rotor), whirl, rotor, rotation.coriolis, rotation.speed_rpm, top_rpm)


def sector_at_speed(
    sector: SectorStructure, speed: float, coriolis: bool, top_speed: float | None = None
) -> SectorStructure:
    """One sector of a disk at a speed in rad/s, of those up to ``top_speed``. Raises InputError for one that is too
    high."""
    symmetry = sector.symmetry
    rotation = Rotation(speed, symmetry.direction, symmetry.point, coriolis, top_speed)
    rotor = rotation.of(sector.structure, symmetry)
    whirl = rotor.coriolis_at(rotation.speed_rpm) if coriolis and speed else None
    speeds = None
    if top_speed is not None:
        with concerning("rotation.top_speed"):
            rotor.at(top_speed / RPM, "rotation.top_speed")
        speeds = RangeOfSpeeds(rotor, top_speed / RPM, rotation.speed_rpm, coriolis)
    return replace(sector, structure=rotation.at_its_speed(rotor), gyroscopic=whirl, speeds=speeds)
