"""The sections of a study file about the two blades and their damper; the defaults are the project's study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator, model_validator

from stickslip.case.law_constants import COULOMB, contact_law_declaration
from stickslip.case.quantities import (
    Density,
    Direction,
    Elements,
    FatigueLimit,
    Force,
    Length,
    Mass,
    PoissonRatio,
    RotationSpeed,
    TensileStrength,
    YoungModulus,
)
from stickslip.case.section import Section, instead_of, of_kind, without_default
from stickslip.case.sections import STRUCTURE_KINDS, FrictionSection, PreloadSection, StructureSection
from stickslip.contact.constants import Declaration
from stickslip.core.errors import InputError
from stickslip.core.units import Quantity

PlatformAngle = Annotated[
    float,
    Quantity(
        "angle",
        shown="deg",
        at_least=0.0,
        below=1.5707963267948966,
        unit_required="A plain number would be in radians, which is unusual here.",
    ),
]


class GeometrySection(Section):
    """All dimensions of two blades, mirrored but for their platform angles, and the damper between them.
    The defaults are from no drawing; they are fitted to ten natural frequencies of such a pair. z runs from the fixed
    root to the tip, x across the airfoil's thickness, y along the chord."""

    blade_length: Length = Field(default=0.145, description="root to tip")
    width: Length = Field(default=0.028, description="chord: extent along y")
    airfoil_thickness: Length = Field(default=0.007, description="along x")
    damper_length: Length = Field(default=0.028, description="along y")
    contact_face_width: Length = Field(default=0.0065, description="along the slope of the platform")
    platform_angle: PlatformAngle = Field(default=0.523598775598299, description="contact face against the horizontal")
    right_platform_angle: PlatformAngle | None = Field(
        default=None,
        description="of the right blade, if it differs; both platform tops have the same height",
        examples=["20 deg"],
    )
    underside_height_at_shank: Length = Field(default=0.0367, description="height of the platform's underside")
    inner_overhang: Length = Field(default=0.0117, description="flat underside between shank and contact face")
    platform_edge_thickness: Length = Field(default=0.0057, description="at the free edge")
    platform_gap: Length = Field(default=0.001, description="between the two platforms")
    shank_thickness_at_platform: Length = Field(default=0.0139, description="tapers to the next one")
    shank_thickness_at_base: Length = Field(default=0.0093, description="at the clamped root")
    damper_flank_height: Length | None = Field(
        default=0.0025, description="of a wedge: vertical side below the damper's contact face"
    )
    excitation_height: Length = Field(
        default=0.00367, description="z of N1, N2 on the outer shank faces; near the root a large force is necessary"
    )


def _of_other_damper(kind: str, **keys: tuple[str, ...]) -> dict[str, str]:
    """Key of another damper -> the rest of an error about it."""
    return {
        key: f'belongs to kind = "{owner}", but kind is "{kind}". Set the kind, or remove this key.'
        for owner, each in keys.items()
        for key in each
    }


_KINDS = "wedge, flat or cylindrical"


class WedgeSection(Section):
    """The damper under the platforms. wedge: its faces fit those of the platforms, dimensions in [geometry]; flat: a
    plate below flat platforms, geometry.platform_angle = 0; cylindrical: a cylinder that touches each platform along a
    line, with the contact stiffness of Hertz; faces are not rough then."""

    foreign: ClassVar[Mapping[str, str]] = _of_other_damper(
        "wedge", flat=("thickness",), cylindrical=("radius", "crowning")
    )

    kind: Literal["wedge"] = Field(default="wedge", description=_KINDS)


class FlatSection(Section):
    """The damper under the platforms: a plate below both contact faces and the gap; geometry.platform_angle is 0."""

    foreign: ClassVar[Mapping[str, str]] = _of_other_damper("flat", cylindrical=("radius", "crowning"))

    kind: Literal["flat"] = Field(default="flat", description=_KINDS)
    thickness: Length = Field(default=0.0025, description="along z")


class CylindricalSection(Section):
    """The damper under the platforms: a cylinder that touches each platform along a line."""

    foreign: ClassVar[Mapping[str, str]] = _of_other_damper("cylindrical", flat=("thickness",))

    kind: Literal["cylindrical"] = Field(default="cylindrical", description=_KINDS)
    radius: Length = Field(default=0.0066, description="with the platform angle it gives where the lines are")
    crowning: Annotated[float, Quantity("length", shown="um", at_least=0.0, at_most=1e-3, example='"5 um"')] = Field(
        default=0.0, description="drop of its profile at both ends, a parabola along its length; 0: straight"
    )


Damper = Annotated[
    WedgeSection | FlatSection | CylindricalSection,
    of_kind({"wedge": WedgeSection, "flat": FlatSection, "cylindrical": CylindricalSection}, "wedge"),
]


class MeshSection(Section):
    """Element formulation and element counts: columns along x, rows along z, chordwise along y."""

    element: Literal["incompatible", "trilinear", "serendipity"] = Field(
        default="incompatible",
        description="incompatible: 8-node brick that bends; trilinear: locks in bending; serendipity: 20 nodes",
    )
    shank_columns: Elements = Field(default=3, description="across shank and airfoil")
    shank_rows: Elements = Field(default=10, description="root to platform")
    platform_rows: Elements = Field(default=4)
    airfoil_rows: Elements = Field(default=30, description="platform to tip")
    inner_columns: Elements = Field(default=2, description="flat underside between shank and contact face")
    contact_columns: Elements = Field(default=4, description="up the contact face; the same number in the damper")
    chordwise: Elements = Field(default=10, description="along the damper's length")
    beyond_damper: Elements = Field(default=1, description="at each end, if the damper is shorter than the width")
    damper_columns: Elements = Field(default=4)
    damper_flank_rows: Elements = Field(default=2)


class MaterialSection(Section):
    """One linear elastic material for blades and damper. The defaults are a blade steel."""

    young_modulus: YoungModulus = Field(default=197e9)
    poisson_ratio: PoissonRatio = Field(default=0.3)
    density: Density = Field(default=7800.0)
    fatigue_limit: FatigueLimit = None
    tensile_strength: TensileStrength = None


class ExcitationSection(Section):
    """Harmonic force at N1 (left blade) and N2 (right blade). With the defaults the blades move against each other and
    most pairs slip: friction reduces the peak to a third of the peak with stuck pairs."""

    mode: Literal["single", "same", "opposite"] = Field(
        default="opposite", description="single: N1 alone; same, opposite: direction at N1 and N2"
    )
    amplitude: Force = Field(default=300.0, description="of each force")
    direction: Direction = Field(
        default=(1.0, 0.0, 0.0),
        description="[x, y, z] of the force and of the response at A; any length",
    )


class TwoBladeStructureSection(StructureSection):
    """stickslip meshes the structure from [geometry] and [mesh]."""

    foreign: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("file", "length_unit", "unit_system", "includes_outside", "stiffness", "mass", "damping", "unknown_map",
         "node_positions", "fixed", "element"),
        'does not belong to a structure of kind "two-blade". Remove it.',
    )  # fmt: skip

    kind: Literal["two-blade"] = Field(default="two-blade", description=STRUCTURE_KINDS)


# Keys that give the centrifugal force of the damper together.
ROTATING = ("damper_mass", "radius_of_rotation", "speed_of_rotation")


class _WedgeKeys(Section):
    centrifugal_force: Force | None = Field(
        default=500.0,
        description="F of the damper, total over both ends; each face carries F / (2 (cos angle + mu_0 sin angle))",
    )
    damper_mass: Mass | None = Field(
        default=None,
        description="with radius and speed: F is mass times radius_of_rotation times speed_of_rotation squared",
        examples=["20 g"],
    )
    radius_of_rotation: Annotated[float, Quantity("length", shown="mm", at_least=1e-9, at_most=100.0)] | None = Field(
        default=None, description="of the damper's centre of mass about the axis of the disk", examples=["300 mm"]
    )
    speed_of_rotation: RotationSpeed | None = Field(
        default=None, description="of the disk; revolutions per minute or rad/s", examples=["3000 rpm"]
    )
    friction_coefficient_at_assembly: Annotated[float, Quantity("pure number", at_least=0.0, at_most=10.0)] = Field(
        default=0.0, description="mu_0: friction that supports part of the force"
    )


class DamperFrictionSection(FrictionSection):
    """Coulomb friction between damper and platforms."""

    law: str | None = Field(
        default=None,
        description="contact law, default coulomb; exponential: the stiffness follows the momentary pressure",
        examples=["exponential"],
    )

    @field_validator("law")
    @classmethod
    def _is_a_law_without_constants(cls, value: str | None) -> str | None:
        if value not in (None, COULOMB):
            required = contact_law_declaration(value).required
            if required:
                raise InputError(
                    f"requires constants of its own ({', '.join(required)}), which two blades do not have. Choose "
                    '"coulomb" or "exponential"; a study of a mesh has such laws on its interfaces.'
                )
        return value

    @property
    def other_law(self) -> str | None:
        """The name of a law other than Coulomb's."""
        return None if self.law == COULOMB else self.law

    @property
    def declaration(self) -> Declaration:
        """What the law declares."""
        return contact_law_declaration(self.law or COULOMB)


class WedgePreloadSection(PreloadSection, _WedgeKeys):
    """Normal load at rest: prescribed, or solved from the static load with contact, gaps and friction."""

    @model_validator(mode="before")
    @classmethod
    def _values_replace_the_default(cls, data: Any) -> Any:
        return without_default(data, ("values", *ROTATING), "centrifugal_force")

    @field_validator("values", *ROTATING)
    @classmethod
    def _one_source(cls, value: Any, info: ValidationInfo) -> Any:
        return instead_of(value, info, "centrifugal_force")

    @property
    def damper_force(self) -> float | None:
        """N, the centrifugal force of the damper: as given, or from its mass; None if neither is given."""
        if self.damper_mass is None or self.radius_of_rotation is None or self.speed_of_rotation is None:
            return self.centrifugal_force
        return self.damper_mass * self.radius_of_rotation * self.speed_of_rotation**2
