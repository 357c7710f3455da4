"""The sections of a study file about a tuned disk, of which one sector is solved: its mesh or its dimensions, and the
wave that excites it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator

from stickslip.case.own_sections import MeshFileSection, Place
from stickslip.case.quantities import Direction, Elements, FileName, Length
from stickslip.case.section import Required, Section, chosen_by, has_value, instead_of
from stickslip.case.sections import STRUCTURE_KINDS, StructureSection
from stickslip.case.two_blade_sections import PlatformAngle
from stickslip.core.errors import InputError
from stickslip.core.units import LARGEST_INTEGER, Count, Quantity

_MATRICES = dict.fromkeys(
    ("stiffness", "mass", "damping", "unknown_map", "node_positions"),
    'does not belong to a structure of kind "cyclic". Remove it.',
)
_BOUNDARY = "is missing. Give the node or face set of that boundary of the sector, where the next sector begins."
MOST_SECTORS = 1000  # chosen: a turbine disk has 20 to 150
MOST_PATTERNS = 100_000  # chosen: some hours of linear disks
# Natural frequencies of the blades of one disk differ by percents; 30 % is a typing error or another unit.
DEVIATION = Quantity("pure number", shown="%", at_least=-0.3, at_most=0.3, example='"1.5 %"')
# Masses of dampers differ by percents and worn faces by more; ten times is a typing error.
DAMPER_LOAD = Quantity("pure number", shown="%", above=0.0, at_most=10.0, example='"90 %"')
Sectors = Annotated[int, Count(at_least=2, at_most=MOST_SECTORS)]


class SectorMeshSection(MeshFileSection):
    """The structure is a disk of equal sectors; a mesh file contains one of them."""

    foreign: ClassVar[Mapping[str, str]] = {
        **_MATRICES,
        **dict.fromkeys(
            (
                "bore_radius", "rim_radius", "web_thickness", "width", "blade_length", "airfoil_thickness",
                "shank_thickness", "platform_height", "platform_thickness", "platform_gap", "contact_face_width",
                "platform_angle", "damper_flank_height", "contact_columns", "contact_rows",
            ),
            "belongs to the parametric disk, but file gives the mesh. Remove one of the two.",
        ),
    }  # fmt: skip

    kind: Literal["cyclic"] = Field(description=STRUCTURE_KINDS)
    left: Annotated[str, Required(_BOUNDARY)] = Field(
        description="node or face set of a boundary of the sector", examples=["left"]
    )
    right: Annotated[str, Required(_BOUNDARY)] = Field(
        description="that of the other one, where the next sector begins", examples=["right"]
    )
    tied: bool = Field(
        default=False,
        description="the boundaries need not match node by node: nodes of the right one follow sides of the left one",
    )
    sectors: Sectors | None = Field(
        default=None, description="number of sectors; default: from the boundaries", examples=[24]
    )
    axis: Direction | None = Field(
        default=None,
        description="[x, y, z] along the axis; default: the one of x, y, z that fits",
        examples=[[0, 0, 1]],
    )
    axis_point: Place | None = Field(
        default=None, description="on the axis; default: the origin", examples=[["0 mm", "0 mm", "0 mm"]]
    )


class BladedDiskSection(StructureSection):
    """The structure is a disk of equal sectors, each with a blade and a wedge damper to the next one. The disk rotates
    about z, the blade of the sector stands along x. Its sets: bore, tip, blade (beyond its root), damper middle; faces
    of the damper: damper here, damper ahead; of the platforms: platform right, platform left. "next NAME" is the set of
    the next sector."""

    foreign: ClassVar[Mapping[str, str]] = {
        **_MATRICES,
        **dict.fromkeys(
            ("length_unit", "unit_system", "includes_outside", "fixed", "element", "left", "right", "tied",
             "axis", "axis_point", "temperature"),
            "belongs to a sector from a mesh file. Give structure.file, or remove the key.",
        ),
    }  # fmt: skip

    kind: Literal["cyclic"] = Field(description=STRUCTURE_KINDS)
    sectors: Sectors = Field(default=24, description="number of blades")
    bore_radius: Length = Field(default=0.060, description="of the disk, which is clamped there")
    rim_radius: Length = Field(default=0.155, description="where the blade begins")
    web_thickness: Length = Field(default=0.008, description="of the disk along z, below the rim")
    width: Length = Field(default=0.028, description="of rim, blade, platforms and damper along z")
    blade_length: Length = Field(default=0.145, description="rim to tip")
    airfoil_thickness: Length = Field(default=0.007, description="along y")
    shank_thickness: Length = Field(default=0.0139, description="from the rim to the top of the platform")
    platform_height: Length = Field(default=0.0367, description="from the rim to the underside at the shank")
    platform_thickness: Length = Field(default=0.0057, description="at the shank and at the free edge")
    platform_gap: Length = Field(default=0.001, description="between neighbouring platforms")
    contact_face_width: Length = Field(default=0.0065, description="along the slope of the platform")
    platform_angle: PlatformAngle = Field(
        default=0.523598775598299, description="contact face against the tangential direction"
    )
    damper_flank_height: Length = Field(default=0.0025, description="of the wedge below its contact faces")
    contact_columns: Elements = Field(default=6, description="elements of a contact face along z")
    contact_rows: Elements = Field(default=3, description="elements of a contact face along the slope")


CyclicStructure = Annotated[
    SectorMeshSection | BladedDiskSection,
    chosen_by(lambda data: SectorMeshSection if has_value(data, "file") else BladedDiskSection),
]


class TravellingWaveSection(Section):
    """The excitation by stationary vanes: all [forces.NAME] act on every sector, one sector after the other."""

    engine_order: Annotated[
        int, Count(at_least=0, at_most=MOST_SECTORS), Required("is missing. Give the number of waves round the disk.")
    ] = Field(description="number of waves round the disk, such as the number of vanes", examples=[4])
    direction: Literal["forward", "backward"] = Field(
        default="forward", description="the wave reaches the next sector after this one, or before it"
    )


class MistuningSection(Section):
    """Blades that differ: deviations of the natural frequencies that each blade has alone, with its root fixed. The
    curve of the study stays that of the tuned disk; its amplitude is the unit of the amplification factor."""

    blade: str = Field(default="blade", description="set of the nodes of the blade beyond its root")
    pattern: tuple[Annotated[float, DEVIATION], ...] | None = Field(
        default=None, description="deviation of each blade, sector by sector", examples=[["1.5 %", "-0.8 %"]]
    )
    file: FileName | None = Field(
        default=None,
        description="instead of pattern: a table with the column deviation, such as deviation [%], a line a blade",
        examples=["blades.csv"],
    )
    standard_deviation: (
        Annotated[float, Quantity("pure number", shown="%", above=0.0, at_most=0.05, example='"1 %"')] | None
    ) = Field(
        default=None,
        description="instead of pattern: of normally distributed random deviations",
        examples=["1 %"],
        validate_default=True,
    )
    patterns: Annotated[int, Count(at_least=1, at_most=MOST_PATTERNS)] = Field(
        default=200, description="number of random patterns"
    )
    seed: Annotated[int, Count(at_least=0, at_most=LARGEST_INTEGER)] = Field(
        default=0, description="of the random patterns; the same seed, the same patterns"
    )
    friction_curve: bool = Field(
        default=False,
        description="also solve the whole disk with friction, for the pattern with the largest linear factor",
    )

    damper_loads: tuple[Annotated[float, DAMPER_LOAD], ...] | None = Field(
        default=None,
        description="normal load of the contacts of each sector over that of the study, for the curve with friction",
        examples=[["100 %", "80 %"]],
    )

    @field_validator("file")
    @classmethod
    def _one_pattern(cls, value: Any, info: ValidationInfo) -> Any:
        return instead_of(value, info, "pattern")

    @field_validator("standard_deviation")
    @classmethod
    def _one_source(cls, value: Any, info: ValidationInfo) -> Any:
        if value is None and all(key in info.data and info.data[key] is None for key in ("pattern", "file")):
            raise InputError("is not enough: give exactly one of standard_deviation, pattern and file.")
        return instead_of(instead_of(value, info, "pattern"), info, "file")
