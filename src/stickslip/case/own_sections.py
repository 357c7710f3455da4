"""The sections of a study file about a structure of the user's own: a mesh or matrices, its joints, forces, responses.

What one section needs of another is checked in ``consistency``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field

from stickslip.case.quantities import (
    Coordinate,
    Density,
    Direction,
    Distance,
    FatigueLimit,
    FileName,
    Force,
    PoissonRatio,
    RotationSpeed,
    TensileStrength,
    YoungModulus,
    require_printable,
)
from stickslip.case.section import Required, Section, chosen_by, has_value, of_kind
from stickslip.case.sections import STRUCTURE_KINDS, PreloadSection, StructureSection
from stickslip.core.errors import InputError
from stickslip.core.units import LARGEST_INTEGER, Count, NodeNumber, Quantity

_OF_MESH_STRUCTURE = 'does not belong to a structure of kind "matrices". Remove it.'
_IN_FILE = "is in the superelement of file. Remove it."
_MATERIAL = "is missing: only the two-blade structure has a default material."
# Largest part of the earth's acceleration is 9.81 m/s2; pyroshock reaches 1e6 m/s2.
Acceleration = Annotated[
    float, Quantity("acceleration", at_least=1e-12, at_most=1e9, usual=(1e-6, 1e6), example='"9.81 m/s^2"')
]
# Of a direction of a crystal; single ones exceed 0.5 or are negative.
AnyRatio = Annotated[float, Quantity("pure number", at_least=-10.0, at_most=10.0)]
# In the unit of the mesh file.
Temperature = Annotated[float, Quantity("pure number", at_least=-1e5, at_most=1e5)]
# A vacuum chamber has 1e-9 Pa and the deepest sea 110 MPa; autofrettage of gun barrels reaches 1 GPa.
Pressure = Annotated[
    float,
    Quantity(
        "pressure",
        shown="MPa",
        at_least=-1e11,
        at_most=1e11,
        usual=(-1e7, 2e9),
        unit_required="Pa and MPa differ by a factor of a million.",
        example='"2 MPa"',
    ),
]
# Balancing grade G 0.4 of a dental drill leaves 1e-10 kg m, a ship's propeller has 1 kg m.
Imbalance = Annotated[float, Quantity("unbalance", at_least=1e-18, at_most=1e6, example='"2e-6 kg m"')]

# Names become words of pages, entries of files and keys of --vary, so "/", "=", ":" and quotes are left out.
_NAME = re.compile(r"\w(?:[\w .+()-]*[\w.+()-])?")
_LONGEST_NAME = 64


def _usable_name(name: str) -> str:
    """``name`` of an interface, a force, a response or a static load. Raises InputError."""
    if len(name) > _LONGEST_NAME or not _NAME.fullmatch(name):
        raise InputError(
            f"is not a name: letters, digits, blanks and _ . + - ( ) are allowed, at most {_LONGEST_NAME}, with a "
            "letter, a digit or _ first. Give it another name."
        )
    return name


Name = Annotated[str, AfterValidator(_usable_name)]
# Bodies are called as in the mesh file.
BodyName = Annotated[str, AfterValidator(require_printable)]
Place = tuple[Coordinate, Coordinate, Coordinate]


class MeshFileSection(StructureSection):
    """A mesh in a file."""

    file: Annotated[FileName, Required('is missing: a structure of kind "mesh" requires a mesh file.')] = Field(
        description="mesh, relative to the study file", examples=["blades.inp"]
    )
    length_unit: Annotated[
        str,
        Required('is missing: a mesh file does not contain its unit of length. Give "mm", "m" or another unit.'),
    ] = Field(description="of the mesh file: m, mm, in ...", examples=["mm"])
    unit_system: str | None = Field(default=None, description="of all other units in this file", examples=["mm-t-s"])
    includes_outside: bool | None = Field(
        default=None, description="true: the deck may include files outside of its folder", examples=[True]
    )
    temperature: Temperature | None = Field(
        default=None, description="of constants in this file that depend on it, in its unit", examples=[650.0]
    )
    fixed: tuple[str, ...] = Field(
        default=(), description="clamped node or face sets, in addition to constraints in the file", examples=[["root"]]
    )
    element: Literal["incompatible", "trilinear"] | None = Field(
        default=None, description="8-node bricks of the mesh; default incompatible", examples=["incompatible"]
    )

    @property
    def files(self) -> dict[str, str]:
        """The mesh file."""
        return {"file": self.file}


class MeshStructureSection(MeshFileSection):
    """The structure is a mesh in a file."""

    foreign: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("stiffness", "mass", "damping", "unknown_map", "node_positions"),
        'does not belong to a structure of kind "mesh". Remove it.',
    )

    kind: Literal["mesh"] = Field(description=STRUCTURE_KINDS)


class SuperelementSection(StructureSection):
    """The structure is a superelement in a file, or stiffness and mass in files of another program."""

    foreign: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("fixed", "element", "includes_outside"), _OF_MESH_STRUCTURE),
        **dict.fromkeys(
            ("stiffness", "mass", "damping", "unknown_map", "node_positions", "unit_system", "length_unit"), _IN_FILE
        ),
    }

    kind: Literal["matrices"] = Field(description=STRUCTURE_KINDS)
    file: FileName = Field(description="superelement (.npz), relative to the study file", examples=["superelement.npz"])

    @property
    def files(self) -> dict[str, str]:
        """The superelement."""
        return {"file": self.file}


class MatrixFilesSection(StructureSection):
    """The structure consists of sparse matrices in files of another program."""

    foreign: ClassVar[Mapping[str, str]] = dict.fromkeys(("fixed", "element", "includes_outside"), _OF_MESH_STRUCTURE)

    kind: Literal["matrices"] = Field(description=STRUCTURE_KINDS)
    stiffness: Annotated[FileName, Required("is missing: give file, or stiffness and mass.")] = Field(
        description="matrices, instead of file: .mtx, .mat, .npy ...", examples=["stiffness.mtx"]
    )
    mass: Annotated[FileName, Required("is missing: give file, or stiffness and mass.")] = Field(examples=["mass.mtx"])
    length_unit: Annotated[
        str,
        Required('is missing: matrix files do not contain their unit of length. Give "mm", "m" or another unit.'),
    ] = Field(description="of the matrix files: m, mm, in ...", examples=["mm"])
    unit_system: str | None = Field(default=None, description="of all other units in these files", examples=["mm-t-s"])
    damping: FileName | None = Field(default=None, examples=["damping.mtx"])
    unknown_map: FileName | None = Field(
        default=None, description="node and direction of each row of the matrices", examples=["unknowns.txt"]
    )
    node_positions: FileName | None = Field(
        default=None, description="lines node, x, y, z of the matrices", examples=["nodes.csv"]
    )

    @property
    def files(self) -> dict[str, str]:
        """The matrices and what describes them."""
        sources = {key: getattr(self, key) for key in ("stiffness", "mass", "damping", "unknown_map", "node_positions")}
        return {key: name for key, name in sources.items() if name is not None}


MatrixStructure = Annotated[
    SuperelementSection | MatrixFilesSection,
    chosen_by(lambda data: SuperelementSection if has_value(data, "file") else MatrixFilesSection),
]


class OwnMaterialSection(Section):
    """Linear elastic material of all bodies without their own; of rough faces between matrices."""

    young_modulus: Annotated[YoungModulus, Required(_MATERIAL)]
    poisson_ratio: Annotated[PoissonRatio, Required(_MATERIAL)]
    density: Annotated[Density, Required(_MATERIAL)]
    fatigue_limit: FatigueLimit = None
    tensile_strength: TensileStrength = None


class BodySection(Section):
    """Material of one body of the mesh; an omitted key has the value of the file, or else of [material]."""

    young_modulus: YoungModulus | None = Field(default=None, examples=["197 GPa"])
    poisson_ratio: PoissonRatio | None = Field(default=None, examples=[0.3])
    density: Density | None = Field(default=None, examples=["7800 kg/m^3"])
    fatigue_limit: FatigueLimit = None
    tensile_strength: TensileStrength = None
    young_moduli: tuple[YoungModulus, YoungModulus, YoungModulus] | None = Field(
        default=None, description="orthotropic: along the axes 1, 2, 3", examples=[["128 GPa", "128 GPa", "128 GPa"]]
    )
    poisson_ratios: tuple[AnyRatio, AnyRatio, AnyRatio] | None = Field(
        default=None, description="orthotropic: nu12, nu13, nu23 (nu12: tension along 1)", examples=[[0.38, 0.38, 0.38]]
    )
    shear_moduli: tuple[YoungModulus, YoungModulus, YoungModulus] | None = Field(
        default=None, description="orthotropic: G12, G13, G23", examples=[["120 GPa", "120 GPa", "120 GPa"]]
    )
    axis_1: Direction | None = Field(
        default=None, description="orthotropic: axis 1 of the material; default x", examples=[[1.0, 0.0, 0.0]]
    )
    axis_2: Direction | None = Field(
        default=None, description="orthotropic: in the plane of axes 1 and 2; default y", examples=[[0.0, 1.0, 0.0]]
    )


class OwnPreloadSection(PreloadSection):
    """Normal load at rest: prescribed, or solved from the static load with contact, gaps and friction."""

    foreign: ClassVar[Mapping[str, str]] = {
        "centrifugal_force": 'belongs to the damper of kind "two-blade". Give interfaces.NAME.normal_load instead.',
        "friction_coefficient_at_assembly": 'belongs to the damper of kind "two-blade". Remove it.',
    }


class PlaceSection(Section):
    """A place of a structure: a set, the node nearest to a point, or a node by its number in the file."""

    set: str | None = Field(default=None, description="node or face set", examples=["tip"])
    point: Place | None = Field(
        default=None, description="position; stickslip uses the nearest node", examples=[["0 mm", "0 mm", "145 mm"]]
    )
    node: Annotated[int, NodeNumber(at_least=-LARGEST_INTEGER, at_most=LARGEST_INTEGER)] | None = Field(
        default=None, description="number of a node in the file", examples=[1017]
    )
    spread: Literal["equal", "area"] | None = Field(
        default=None,
        description="distribution over the nodes of a set: equal (default), or by area of a mesh",
        examples=["area"],
    )


class NodeGroupSection(PlaceSection):
    """A place and a direction."""

    direction: Direction = Field(description="[x, y, z], any length")


class ForceSection(NodeGroupSection):
    """A harmonic force, amplitude sin(harmonic w t + phase), distributed over a set or at one node."""

    amplitude: Force = Field(description="0-to-peak, of the total force")
    phase: Annotated[
        float,
        Quantity(
            "angle",
            shown="deg",
            at_least=-1e6,
            at_most=1e6,
            unit_required="A plain number would be in radians, which is unusual here.",
        ),
    ] = Field(default=0.0, description="against the other forces")
    harmonic: Annotated[int, Count(at_least=1, at_most=200)] = Field(
        default=1, description="multiple of the frequency of the curve; at most solver.harmonics"
    )


class UnbalanceSection(PlaceSection):
    """A rotating unbalance at a set or a node: its force mass_times_radius w^2 rotates once in each period."""

    axis: Direction = Field(description="[x, y, z]; the rotor turns to the right about this axis")
    mass_times_radius: Imbalance = Field(description="unbalanced mass times its distance from the axis")


class _BaseDirection(Section):
    direction: Direction = Field(description="[x, y, z], any length")


class BaseAccelerationSection(_BaseDirection):
    """The support moves, amplitude cos(w t), all constrained nodes together; displacements are relative to it."""

    kind: Literal["acceleration"] = Field(default="acceleration", description="acceleration, or displacement (m)")
    amplitude: Acceleration = Field(description="0-to-peak, of the support")


class BaseDisplacementSection(_BaseDirection):
    """The support moves, amplitude cos(w t), all constrained nodes together; displacements are relative to it."""

    kind: Literal["displacement"] = Field(description="acceleration (m/s^2), or displacement")
    amplitude: Distance = Field(description="0-to-peak, of the support")


BaseMotion = Annotated[
    BaseAccelerationSection | BaseDisplacementSection,
    of_kind({"acceleration": BaseAccelerationSection, "displacement": BaseDisplacementSection}, "acceleration"),
]


class ResponseSection(NodeGroupSection):
    """An output displacement of one node, or the mean of a set. The first one is the curve of the report."""


class StaticLoadSection(NodeGroupSection):
    """A constant force, distributed over a set or at one node, for a solved preload."""

    force: Force = Field(description="total over the set")


class GravitySection(Section):
    """Weight of all bodies and mass points of the mesh, for a solved preload."""

    acceleration: Acceleration = Field(default=9.80665, description="of gravity")
    direction: Direction = Field(description="[x, y, z] downwards, in the axes of the mesh, any length")


class PressureSection(Section):
    """A uniform pressure on a face of the mesh, for a solved preload."""

    set: Annotated[str, Required("is missing. Give the name of a face set.")] = Field(
        description="face set, or node set that contains whole element sides", examples=["cover"]
    )
    pressure: Pressure = Field(description="towards the body; below 0: suction", examples=["2 MPa"])


class TieSection(Section):
    """Nodes of one set that follow the nearest points of a face, without friction, sliding or opening."""

    dependent: Annotated[str, Required("is missing. Give the name of a node or face set.")] = Field(
        description="node or face set whose nodes follow (the finer mesh)", examples=["blade_foot"]
    )
    independent: Annotated[str, Required("is missing. Give the name of a face set.")] = Field(
        description="face set that they follow (the coarser mesh)", examples=["disk_rim"]
    )
    tolerance: Distance | None = Field(
        default=None, description="largest distance of a node; default 5 % of the mean edge", examples=["0.05 mm"]
    )


_TOP_SPEED = "one reduction for all speeds up to this one, for a sweep over speed; default: one at speed"


class SectorRotationSection(Section):
    """Constant rotation of a disk about its axis: stress stiffening and spin softening."""

    foreign: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("axis", "point"), "is that of the disk, from its boundaries. Remove it."),
    }

    speed: RotationSpeed = Field(description="revolutions per minute or rad/s", examples=["3000 rpm"])
    coriolis: bool = Field(
        default=False, description="with Coriolis forces: forward and backward waves have other frequencies"
    )
    top_speed: RotationSpeed | None = Field(default=None, description=_TOP_SPEED, examples=["9000 rpm"])


class RotationSection(Section):
    """Constant rotation of the complete model: stress stiffening, spin softening, and for a solved preload the
    centrifugal load of all bodies."""

    foreign: ClassVar[Mapping[str, str]] = {
        "coriolis": 'belongs to a structure of kind "mesh"; the model of two blades has no Coriolis forces. Remove it.'
    }

    speed: RotationSpeed = Field(description="revolutions per minute or rad/s")
    axis: Direction = Field(description="[x, y, z] along the axis")
    point: Place = Field(default=(0.0, 0.0, 0.0), description="on the axis")
    top_speed: RotationSpeed | None = Field(default=None, description=_TOP_SPEED, examples=["9000 rpm"])


class MeshRotationSection(RotationSection):
    """Constant rotation of the complete model: stress stiffening, spin softening, and for a solved preload the
    centrifugal load of all bodies."""

    foreign: ClassVar[Mapping[str, str]] = {}

    coriolis: bool = Field(
        default=False,
        description="with Coriolis forces; then without stability, ridges, nonlinear modes and gradients",
    )
