"""The sections of a study file about a structure of the user's own: a mesh or matrices, its joints, forces, responses.

What one section needs of another is checked in ``consistency``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

from stickslip.case.law_keys import ContactLawKeys, StiffnessLawKeys
from stickslip.case.sections import (
    Area,
    Coordinate,
    Density,
    Direction,
    Distance,
    FileName,
    Force,
    ForceOrNone,
    FrictionCoefficient,
    PoissonRatio,
    PreloadSection,
    Required,
    Section,
    Stiffness,
    StructureSection,
    YoungModulus,
    chosen_by,
    of_kind,
    require_printable,
)
from stickslip.contact.constants import STIFFNESSES
from stickslip.core.errors import InputError
from stickslip.core.units import LARGEST_INTEGER, Count, Quantity

GROUND = "ground"
OF_MESH = "belongs to faces of a mesh. Take it out."
OF_MATRICES = "belongs to matrices; the faces of a mesh have their own. Take it out."
_OF_MESH_STRUCTURE = 'does not belong to a structure of kind "matrices". Take it out.'
_IN_FILE = "stands in the superelement of file. Take it out."
_SIDE = 'is missing. Give the name of a set; second may be "ground".'
_MATERIAL = "is missing: the material of your own structure has no default."
# Largest part of the earth's acceleration is 9.81 m/s2; pyroshock reaches 1e6 m/s2.
Acceleration = Annotated[
    float, Quantity("acceleration", at_least=1e-12, at_most=1e9, usual=(1e-6, 1e6), example='"9.81 m/s^2"')
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


class MeshStructureSection(StructureSection):
    """The structure is meshed in a file."""

    foreign: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("stiffness", "mass", "damping", "unknown_map", "node_positions"),
        'does not belong to a structure of kind "mesh". Take it out.',
    )

    kind: Literal["mesh"] = Field(description="two-blade, mesh or matrices")
    file: Annotated[FileName, Required('is missing, but a structure of kind "mesh" comes from a file.')] = Field(
        description="mesh, relative to the study file", examples=["blades.inp"]
    )
    length_unit: Annotated[
        str,
        Required('is missing: a mesh file does not say its unit of length. Give "mm", "m" or another one.'),
    ] = Field(description="of the mesh file: m, mm, in ...", examples=["mm"])
    unit_system: str | None = Field(default=None, description="of all other units in this file", examples=["mm-t-s"])
    includes_outside: bool | None = Field(
        default=None, description="whether the deck may include files outside of its folder", examples=[True]
    )
    fixed: tuple[str, ...] = Field(
        default=(), description="node or face sets that are clamped, beside what the file holds", examples=[["root"]]
    )
    element: Literal["incompatible", "trilinear"] | None = Field(
        default=None, description="8-node bricks of the mesh; incompatible unless given", examples=["incompatible"]
    )

    @property
    def files(self) -> dict[str, str]:
        """The mesh file."""
        return {"file": self.file}


class SuperelementSection(StructureSection):
    """The structure is a superelement in a file, or stiffness and mass in files of another program."""

    foreign: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("fixed", "element", "includes_outside"), _OF_MESH_STRUCTURE),
        **dict.fromkeys(
            ("stiffness", "mass", "damping", "unknown_map", "node_positions", "unit_system", "length_unit"), _IN_FILE
        ),
    }

    kind: Literal["matrices"] = Field(description="two-blade, mesh or matrices")
    file: FileName = Field(description="superelement (.npz), relative to the study file", examples=["superelement.npz"])

    @property
    def files(self) -> dict[str, str]:
        """The superelement."""
        return {"file": self.file}


class MatrixFilesSection(StructureSection):
    """The structure is given by sparse matrices in files of another program."""

    foreign: ClassVar[Mapping[str, str]] = dict.fromkeys(("fixed", "element", "includes_outside"), _OF_MESH_STRUCTURE)

    kind: Literal["matrices"] = Field(description="two-blade, mesh or matrices")
    stiffness: Annotated[FileName, Required("is missing: give file, or stiffness and mass.")] = Field(
        description="matrices, instead of file: .mtx, .mat, .npy ...", examples=["stiffness.mtx"]
    )
    mass: Annotated[FileName, Required("is missing: give file, or stiffness and mass.")] = Field(examples=["mass.mtx"])
    length_unit: Annotated[
        str,
        Required('is missing: matrix files do not say their unit of length. Give "mm", "m" or another one.'),
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


def _has(data: Any, key: str) -> bool:
    return isinstance(data, Mapping) and data.get(key) is not None


MatrixStructure = Annotated[
    SuperelementSection | MatrixFilesSection,
    chosen_by(lambda data: SuperelementSection if _has(data, "file") else MatrixFilesSection),
]


class OwnMaterialSection(Section):
    """Linear elastic material of every body without one of its own; of rough faces between matrices."""

    young_modulus: Annotated[YoungModulus, Required(_MATERIAL)]
    poisson_ratio: Annotated[PoissonRatio, Required(_MATERIAL)]
    density: Annotated[Density, Required(_MATERIAL)]


class BodySection(Section):
    """Material of one body of the mesh; a key that is left out is that of the file, or else of [material]."""

    young_modulus: YoungModulus | None = Field(default=None, examples=["197 GPa"])
    poisson_ratio: PoissonRatio | None = Field(default=None, examples=[0.3])
    density: Density | None = Field(default=None, examples=["7800 kg/m^3"])


class _JointKeys(Section):
    """What a joint of any kind has: its load, its friction and its stiffness."""

    tangent: Direction | None = Field(
        default=None, description="first direction of sliding; up the slope unless given", examples=[[0.0, 0.0, 1.0]]
    )
    normal_load: ForceOrNone | None = Field(
        default=None, description="at rest, on the whole face with uniform pressure", examples=["289 N"]
    )
    friction: FrictionCoefficient | None = Field(
        default=None, description="coefficient of this face instead of that of [friction]", examples=[0.3]
    )
    normal_stiffness: Stiffness | None = Field(
        default=None, description="of this whole face, instead of [roughness]", examples=["1.34e8 N/m"]
    )
    tangential_stiffness: Stiffness | None = Field(default=None, examples=["1.11e8 N/m"])


class InterfaceSection(ContactLawKeys, StiffnessLawKeys, _JointKeys):
    """A joint of any kind: its load, its friction, its stiffness and its laws."""

    @property
    def has_own_stiffness(self) -> bool:
        """Whether a stiffness stands here, be it by a law."""
        given = (self.normal_stiffness, self.tangential_stiffness, self.stiffness_law)
        return any(each is not None for each in given)

    @property
    def needs_stiffness(self) -> bool:
        """Whether the contact law must have a stiffness of the joint."""
        return any(map(self.requires, STIFFNESSES))

    def requires(self, constant: str) -> bool:
        """Whether the contact law must have a value of the joint."""
        return self.other_law is None or self.declaration.needs(constant)


# The keys that lead a section are on a class of their own: a file has them before those that all joints share.
class _Sides(Section):
    first: Annotated[str, Required(_SIDE)] = Field(
        description="face or node set whose area and outward normal count (the damper's side)",
        examples=["damper_left"],
    )
    second: Annotated[str, Required(_SIDE)] = Field(
        description="face or node set of the other side, or ground", examples=["blade_left"]
    )
    search_distance: Distance | None = Field(
        default=None, description="along the normal, beyond which two faces do not meet", examples=["0.2 mm"]
    )


class _FacesOfMesh(_Sides):
    points: Literal["nodes", "quadrature"] | None = Field(
        default=None,
        description="where the pairs stand on the first face; nodes unless given",
        examples=["nodes"],
    )
    edge_tolerance: Distance | None = Field(
        default=None, description="how far a point may lie beyond the edge of the second face", examples=["0.05 mm"]
    )
    gap_tolerance: Distance | None = Field(
        default=None, description="gaps up to it count as none", examples=["0.001 mm"]
    )
    gap: Coordinate | None = Field(
        default=None, description="to the ground, along the normal; 0 unless given", examples=["0 mm"]
    )
    adjust: Literal["measured", "closed"] | None = Field(
        default=None,
        description="initial gaps: as measured between the meshes, or all zero",
        examples=["closed"],
    )


class MeshInterfaceSection(InterfaceSection, _FacesOfMesh):
    """A joint between two faces, or a face and the rigid ground."""

    foreign: ClassVar[Mapping[str, str]] = dict.fromkeys(("normal", "area", "pairs"), OF_MATRICES)


class _FaceOfMatrices(Section):
    normal: Annotated[
        Direction, Required("is missing: matrices do not say it. Give it, such as [0, 0, 1], out of the first side.")
    ] = Field(description="out of the first side", examples=[[0.0, 0.0, 1.0]])
    area: Annotated[
        Area, Required('is missing: matrices do not say it. Give it, such as "180 mm^2", of the whole face.')
    ] = Field(description="of the whole face; pairs have equal parts", examples=["180 mm^2"])
    gap: Distance | None = Field(
        default=None, description="of each pair at rest, for a contact law that has one", examples=["0.1 mm"]
    )


_MESH_KEYS = dict.fromkeys(("points", "edge_tolerance", "gap_tolerance", "adjust"), OF_MESH)


class SetInterfaceSection(InterfaceSection, _FaceOfMatrices, _Sides):
    """A joint between the nodes of two sets, or those of one set and the rigid ground."""

    foreign: ClassVar[Mapping[str, str]] = _MESH_KEYS


class _ListedPairs(Section):
    pairs: FileName = Field(
        description="instead of first and second: lines first node, second node", examples=["left_pairs.csv"]
    )


class PairsInterfaceSection(InterfaceSection, _FaceOfMatrices, _ListedPairs):
    """A joint between the nodes of a list."""

    foreign: ClassVar[Mapping[str, str]] = {
        **_MESH_KEYS,
        **dict.fromkeys(
            ("first", "second", "search_distance"), "is not used where pairs names the nodes. Take it out."
        ),
    }


MatrixInterface = Annotated[
    SetInterfaceSection | PairsInterfaceSection,
    chosen_by(lambda data: PairsInterfaceSection if _has(data, "pairs") else SetInterfaceSection),
]


class OwnPreloadSection(PreloadSection):
    """Normal load at rest: prescribed, or solved from the static load with contact, gaps and friction."""

    foreign: ClassVar[Mapping[str, str]] = {
        "centrifugal_force": 'is the wedge damper\'s, of kind "two-blade". Give interfaces.NAME.normal_load instead.',
        "friction_coefficient_at_assembly": 'is the wedge damper\'s, of kind "two-blade". Take it out.',
    }


class PlaceSection(Section):
    """A place of a structure: a set, the node nearest to a point, or a node by its number in the file."""

    set: str | None = Field(default=None, description="node or face set", examples=["tip"])
    point: Place | None = Field(
        default=None, description="the nearest node to it is taken", examples=[["0 mm", "0 mm", "145 mm"]]
    )
    node: Annotated[int, Count(at_least=-LARGEST_INTEGER, at_most=LARGEST_INTEGER)] | None = Field(
        default=None, description="number of a node in the file", examples=[1017]
    )
    spread: Literal["equal", "area"] | None = Field(
        default=None,
        description="shares of the nodes of a set: equal (unless given), or by area of a mesh",
        examples=["area"],
    )


class NodeGroupSection(PlaceSection):
    """A place and a direction."""

    direction: Direction = Field(description="[x, y, z], any length")


class ForceSection(NodeGroupSection):
    """A harmonic force, amplitude sin(harmonic w t + phase), spread over a set or at one node."""

    amplitude: Force = Field(description="0-to-peak, of the whole force")
    phase: Annotated[
        float,
        Quantity(
            "angle",
            shown="deg",
            at_least=-1e6,
            at_most=1e6,
            unit_required="A plain number would be radian, which few expect here.",
        ),
    ] = Field(default=0.0, description="against the other forces")
    harmonic: Annotated[int, Count(at_least=1, at_most=200)] = Field(
        default=1, description="multiple of the frequency of the curve; at most solver.harmonics"
    )


class UnbalanceSection(PlaceSection):
    """A rotating unbalance at a set or a node: its force mass_times_radius w^2 turns about the axis once a period."""

    axis: Direction = Field(description="[x, y, z]; it turns to the right about this axis")
    mass_times_radius: Imbalance = Field(description="unbalanced mass times its distance from the axis")


class _BaseDirection(Section):
    direction: Direction = Field(description="[x, y, z], any length")


class BaseAccelerationSection(_BaseDirection):
    """The support moves, amplitude cos(w t), all held nodes together; displacements count from the support."""

    kind: Literal["acceleration"] = Field(default="acceleration", description="acceleration, or displacement (m)")
    amplitude: Acceleration = Field(description="0-to-peak, of the support")


class BaseDisplacementSection(_BaseDirection):
    """The support moves, amplitude cos(w t), all held nodes together; displacements count from the support."""

    kind: Literal["displacement"] = Field(description="acceleration (m/s^2), or displacement")
    amplitude: Distance = Field(description="0-to-peak, of the support")


BaseMotion = Annotated[
    BaseAccelerationSection | BaseDisplacementSection,
    of_kind({"acceleration": BaseAccelerationSection, "displacement": BaseDisplacementSection}, "acceleration"),
]


class ResponseSection(NodeGroupSection):
    """A displacement to be read: of one node, or the mean of a set. The first one is the curve of the report."""


class StaticLoadSection(NodeGroupSection):
    """A constant force, spread over a set or at one node, for a solved preload."""

    force: Force = Field(description="of the whole set")


class RotationSection(Section):
    """Constant rotation of the whole model: the centrifugal load of every body, for a solved preload."""

    # Turbochargers turn at 3e4 rad/s, dental drills at 5e4, micro spindles at 1e5.
    speed: Annotated[float, Quantity("speed of rotation", shown="rpm", at_least=0.0, at_most=1e9, usual=(0.0, 1e6))] = (
        Field(description="revolutions per minute or rad/s")
    )
    axis: Direction = Field(description="[x, y, z] along the axis")
    point: Place = Field(default=(0.0, 0.0, 0.0), description="on the axis")
