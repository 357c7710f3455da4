"""The sections of a study file about a structure of the user's own: a mesh or matrices, its joints, forces, responses.

What one section needs of another, and which sections a kind of structure has, is checked in ``case_fit``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

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
    Section,
    Stiffness,
    YoungModulus,
    require_printable,
)
from stickslip.core.errors import InputError
from stickslip.core.units import LARGEST_INTEGER, Count, Quantity

Kind = Literal["two-blade", "mesh", "matrices"]
KINDS: tuple[Kind, ...] = ("two-blade", "mesh", "matrices")
GROUND = "ground"
# Sections that are not there at all with other kinds than two blades, where the file does not give them.
_NO_DEFAULT = ("geometry", "mesh", "excitation", "material")

MATRIX_FILES = ("stiffness", "mass", "damping", "unknown_map", "node_positions")
FILE_KEYS = ("file", *MATRIX_FILES)

INTERFACE_OF_MESH = ("points", "edge_tolerance", "gap_tolerance", "gap", "adjust")
_WEDGE = ("preload.centrifugal_force", "preload.friction_coefficient_at_assembly")
# section.key of shared sections that a kind of structure has no use for.
FOREIGN_KEYS: dict[Kind, frozenset[str]] = {
    "two-blade": frozenset(),
    "mesh": frozenset(
        {
            *_WEDGE,
            *(f"structure.{key}" for key in MATRIX_FILES),
            *(f"interfaces.{key}" for key in ("pairs", "normal", "area")),
        }
    ),
    "matrices": frozenset(
        {
            *_WEDGE,
            *(f"structure.{key}" for key in ("fixed", "element", "includes_outside")),
            *(f"interfaces.{key}" for key in INTERFACE_OF_MESH),
            *(f"{section}.spread" for section in ("forces", "responses", "static_loads")),
        }
    ),
}

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


class StructureSection(Section):
    """Where the structure comes from: the two blades of [geometry], a mesh file, or matrix files."""

    kind: Kind = Field(default="two-blade", description="two-blade, mesh or matrices")
    file: FileName | None = Field(
        default=None, description="mesh or superelement (.npz), relative to the study file", examples=["blades.inp"]
    )
    length_unit: str | None = Field(
        default=None, description="of the mesh or matrix files: m, mm, in ...", examples=["mm"]
    )
    unit_system: str | None = Field(default=None, description="of all other units in these files", examples=["mm-t-s"])
    includes_outside: bool | None = Field(
        default=None, description="whether the deck may include files outside of its folder", examples=[True]
    )
    stiffness: FileName | None = Field(
        default=None, description="matrices, instead of file: .mtx, .mat, .npy ...", examples=["stiffness.mtx"]
    )
    mass: FileName | None = Field(default=None, examples=["mass.mtx"])
    damping: FileName | None = Field(default=None, examples=["damping.mtx"])
    unknown_map: FileName | None = Field(
        default=None, description="node and direction of each row of the matrices", examples=["unknowns.txt"]
    )
    node_positions: FileName | None = Field(
        default=None, description="lines node, x, y, z of the matrices", examples=["nodes.csv"]
    )
    fixed: tuple[str, ...] = Field(
        default=(), description="node or face sets that are clamped, beside what the file holds", examples=[["root"]]
    )
    element: Literal["incompatible", "trilinear"] | None = Field(
        default=None, description="8-node bricks of the mesh; incompatible unless given", examples=["incompatible"]
    )


class BodySection(Section):
    """Material of one body of the mesh; a key that is left out is that of the file, or else of [material]."""

    young_modulus: YoungModulus | None = Field(default=None, examples=["197 GPa"])
    poisson_ratio: PoissonRatio | None = Field(default=None, examples=[0.3])
    density: Density | None = Field(default=None, examples=["7800 kg/m^3"])


class InterfaceSection(Section):
    """A joint between two faces, or a face and the rigid ground."""

    first: str | None = Field(
        default=None,
        description="face or node set whose area and outward normal count (the damper's side)",
        examples=["damper_left"],
    )
    second: str | None = Field(
        default=None, description="face or node set of the other side, or ground", examples=["blade_left"]
    )
    pairs: FileName | None = Field(
        default=None,
        description="matrices, instead of first and second: lines first node, second node",
        examples=["left_pairs.csv"],
    )
    points: Literal["nodes", "quadrature"] | None = Field(
        default=None,
        description="where the pairs stand on the first face; nodes unless given",
        examples=["nodes"],
    )
    search_distance: Distance | None = Field(
        default=None, description="along the normal, beyond which two faces do not meet", examples=["0.2 mm"]
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
    tangent: Direction | None = Field(
        default=None, description="first direction of sliding; up the slope unless given", examples=[[0.0, 0.0, 1.0]]
    )
    normal: Direction | None = Field(
        default=None, description="matrices: out of the first side", examples=[[0.0, 0.0, 1.0]]
    )
    area: Area | None = Field(
        default=None, description="matrices: of the whole face; pairs have equal parts", examples=["180 mm^2"]
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


class PortSection(Section):
    """A place of a structure: a set, the node nearest to a point, or a node by its number in the file."""

    set: str | None = Field(default=None, description="node or face set", examples=["tip"])
    point: Place | None = Field(
        default=None, description="the nearest node to it is taken", examples=[["0 mm", "0 mm", "145 mm"]]
    )
    node: Annotated[int, Count(at_least=-LARGEST_INTEGER, at_most=LARGEST_INTEGER)] | None = Field(
        default=None, description="number of a node in the file", examples=[1017]
    )
    spread: Literal["equal", "area"] | None = Field(
        default=None, description="shares of the nodes of a set: equal (unless given), or by area", examples=["area"]
    )
    direction: Direction = Field(description="[x, y, z], any length")

    @property
    def place(self) -> tuple[str | Place | int | None, ...]:
        """What tells this place from others."""
        return self.set, self.point, self.node, self.spread


class ForceSection(PortSection):
    """A harmonic force, amplitude sin(w t + phase), spread over a set or at one node."""

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


class ResponseSection(PortSection):
    """A displacement to be read: of one node, or the mean of a set. The first one is the curve of the report."""


class StaticLoadSection(PortSection):
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


def kind_in(data: Any) -> Any:
    """The kind of structure in the mappings of a study file."""
    structure = data.get("structure") if isinstance(data, Mapping) else None
    return structure.get("kind", "two-blade") if isinstance(structure, Mapping) else "two-blade"


def without_other_kinds(data: Any) -> Any:
    """``data`` without the defaults that only the two-blade kind has, where it is of another kind or rotates."""
    if kind_in(data) not in KINDS[1:]:
        preload = data.get("preload", {}) if isinstance(data, Mapping) and "rotation" in data else None
        if isinstance(preload, Mapping) and "centrifugal_force" not in preload:
            return {**data, "preload": {"centrifugal_force": None, **preload}}
        return data
    missing: dict[str, Any] = {name: None for name in _NO_DEFAULT if name not in data}
    if "study" not in data or (isinstance(data["study"], Mapping) and "title" not in data["study"]):
        file = data["structure"].get("file") or data["structure"].get("stiffness") or "own matrices"
        missing["study"] = {**data.get("study", {}), "title": f"Vibration of {Path(str(file)).stem}"}
    if "preload" not in data:
        missing["preload"] = {"centrifugal_force": None}
    elif isinstance(data["preload"], Mapping) and "centrifugal_force" not in data["preload"]:
        missing["preload"] = {"centrifugal_force": None, **data["preload"]}
    return {**data, **missing}
