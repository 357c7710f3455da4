"""Two blades with an under-platform damper between their platforms: dimensions and numbers of elements.

The section lies in the x-z plane (x across the gap, z from the clamped base to the tips) and is extruded along y. The
left blade stands at x < 0, the right blade is its mirror image, the damper sits below the gap. The default dimensions
come from no drawing: seven of them were fitted to the first ten natural frequencies of such a pair with tied contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import real_number, require_allowed, whole_number
from stickslip.model.kinds.damper_shapes import Cylinder, DamperShape, Plate, Roof, Wedge, section_area


@dataclass(frozen=True)
class BladePairGeometry:
    """Dimensions in metres and the platform angle in degrees.

    blade_length, width, airfoil_thickness:
        base to tip (z), chord (y), and thickness of the airfoil (x).
    damper_length:
        along y, centred; at most ``width``.
    contact_face_width, platform_angle_deg, right_platform_angle_deg:
        width of a contact face along its slope, and the slope against the x-axis; None for a right blade that mirrors
        the left one. If the angles differ, the underside of the right platform has another height (``right``).
    underside_height_at_shank, inner_overhang:
        height of the flat platform underside, and its length from the shank to the contact face.
    platform_edge_thickness, platform_gap:
        thickness of the platform at its free edge; gap between the platforms, which is the damper's top width too.
    shank_thickness_at_platform, shank_thickness_at_base:
        linear taper; the outer face of the shank is flush with the airfoil.
    damper_flank_height:
        height of the damper's vertical flanks below its contact faces.
    excitation_height:
        height of N1 and N2 above the base, on the outer shank face at mid-chord; moved to the nearest node.
    damper:
        shape of the damper. A plate requires flat platforms, angles of 0; ``damper_flank_height`` is of a wedge alone.

    Raises
    ------
    InputError
        for a dimension that is not a positive number, an angle outside 0 to 90 degrees, an angle that the shape of the
        damper does not allow, or parts that do not fit.
    """

    blade_length: float = 145.0e-3
    width: float = 28.0e-3
    airfoil_thickness: float = 7.0e-3
    damper_length: float = 28.0e-3
    contact_face_width: float = 6.5e-3
    platform_angle_deg: float = 30.0
    underside_height_at_shank: float = 36.7e-3
    inner_overhang: float = 11.7e-3
    platform_edge_thickness: float = 5.7e-3
    platform_gap: float = 1.0e-3
    shank_thickness_at_platform: float = 13.9e-3
    shank_thickness_at_base: float = 9.3e-3
    damper_flank_height: float = 2.5e-3
    excitation_height: float = 3.67e-3
    right_platform_angle_deg: float | None = None
    damper: DamperShape = field(default_factory=Wedge)

    def __post_init__(self) -> None:
        if not isinstance(self.damper, DamperShape):
            raise InputError(
                f"damper is {self.damper!r}, but it must be a Wedge, a Plate or a Cylinder.", arguments=["damper"]
            )
        for item in fields(self):
            if getattr(self, item.name) is None or item.name == "damper":
                continue
            value = real_number(item.name, getattr(self, item.name))
            if not item.name.endswith("platform_angle_deg"):
                require_allowed(item.name, value, value > 0.0, "above 0 m (28 mm is 0.028)")
            elif isinstance(self.damper, Plate):
                require_allowed(item.name, value, value == 0.0, "0 degrees for a flat damper")
            else:
                require_allowed(item.name, value, 0.0 < value < 90.0, "between 0 and 90 degrees")
        self._require_fit()
        _ = self.right  # its parts must fit, too

    @property
    def right(self) -> BladePairGeometry:
        """The mirrored right side with its own platform angle; the upper ends of both contact faces, and with them both
        platform tops, have the same height, so that its underside is higher or lower. Raises InputError."""
        if self.right_platform_angle_deg is None:
            return self
        own_rise = self.contact_face_width * math.sin(math.radians(self.right_platform_angle_deg))
        return replace(
            self,
            platform_angle_deg=self.right_platform_angle_deg,
            right_platform_angle_deg=None,
            underside_height_at_shank=self.underside_height_at_shank + self.slope_rise - own_rise,
        )

    def _require_fit(self) -> None:
        """Raise InputError where the parts would overlap or turn inside out."""
        if self.damper_length > self.width and not self.damper_spans_width:
            raise InputError(
                f"damper_length is {1e3 * self.damper_length:.6g} mm; it must be at most {1e3 * self.width:.6g} mm, "
                "the width of the blades; a longer damper does not fit under the platforms.",
                ("damper_length", "width"),
            )
        if isinstance(self.damper, Plate):
            self._require_damper_below("thickness", self.damper.thickness)
        elif isinstance(self.damper, Wedge):
            self._require_damper_below("damper_flank_height", self.damper_flank_height)
        self._below(
            "airfoil_thickness",
            self.airfoil_thickness,
            self.shank_thickness_at_platform + self.inner_overhang,
            "shank_thickness_at_platform + inner_overhang, or the airfoil covers the whole platform",
            ("airfoil_thickness", "shank_thickness_at_platform", "inner_overhang"),
        )
        self._below(
            "platform_top_height (underside_height_at_shank + slope + platform_edge_thickness)",
            self.platform_top_height,
            self.blade_length,
            "blade_length, or no airfoil is left",
            (
                "underside_height_at_shank",
                "contact_face_width",
                "platform_angle_deg",
                "platform_edge_thickness",
                "blade_length",
            ),
        )
        self._below(
            "excitation_height",
            self.excitation_height,
            self.underside_height_at_shank,
            "underside_height_at_shank, because N1 and N2 are on the shank",
            ("excitation_height", "underside_height_at_shank"),
        )

    def _require_damper_below(self, key: str, depth: float) -> None:
        """Raise InputError where a wedge or a plate, which reaches ``depth`` below the undersides, does not fit."""
        self._below(
            key,
            depth,
            self.underside_height_at_shank,
            "underside_height_at_shank, or the damper reaches the base and does not fit",
            (key, "underside_height_at_shank"),
        )
        share = 1.0 - depth / self.underside_height_at_shank
        taper = share * (self.shank_thickness_at_platform - self.shank_thickness_at_base)
        self._below(
            "shank_thickness_at_base",
            self.shank_thickness_at_base + taper,
            self.shank_thickness_at_platform + self.inner_overhang,
            "shank_thickness_at_platform + inner_overhang at the height of the damper's bottom, or the damper does "
            "not fit between the shanks",
            ("shank_thickness_at_base", "shank_thickness_at_platform", "inner_overhang"),
        )

    def require_cylinder_fits(self) -> None:
        """Raise InputError where a cylinder does not touch both contact faces, or reaches a shank or the base."""
        if isinstance(self.damper, Cylinder):
            self.damper.require_lines_on(self.roof)
            sides = ((-1.0, self), (1.0, self.right))
            self.damper.require_space(self.roof, np.array([self._shank_face(side, of) for side, of in sides]))

    def _shank_face(self, side: float, of: BladePairGeometry) -> list[tuple[float, float]]:
        """x, z of the lower and the upper end of the inner face of a shank."""
        outer = of.outer_face
        return [
            (side * (outer - of.shank_thickness_at_base), 0.0),
            (side * (outer - of.shank_thickness_at_platform), of.underside_height_at_shank),
        ]

    @staticmethod
    def _below(name: str, value: float, limit: float, reason: str, keys: tuple[str, ...]) -> None:
        if not value < limit:
            raise InputError(f"{name} is {1e3 * value:.6g} mm; it must be below {1e3 * limit:.6g} mm: {reason}.", keys)

    @property
    def damper_spans_width(self) -> bool:
        """Whether damper and blades end at the same y (to round-off, so that no sliver of a brick is left)."""
        return math.isclose(self.damper_length, self.width, rel_tol=1e-9)

    @property
    def roof(self) -> Roof:
        """Both contact faces of the platforms."""
        angles = math.radians(self.platform_angle_deg), math.radians(self.right.platform_angle_deg)
        height = self.underside_height_at_shank + self.slope_rise
        return Roof(height, self.platform_gap, self.contact_face_width, angles)

    @property
    def damper_volume(self) -> float:
        """m3."""
        return self.damper_length * section_area(self.damper, self.roof, self.damper_flank_height)

    @property
    def slope_run(self) -> float:
        """Extent of a contact face along x, m."""
        return self.contact_face_width * math.cos(math.radians(self.platform_angle_deg))

    @property
    def slope_rise(self) -> float:
        """Extent of a contact face along z, m."""
        return self.contact_face_width * math.sin(math.radians(self.platform_angle_deg))

    @property
    def platform_top_height(self) -> float:
        """Height of the flat platform top, m."""
        return self.underside_height_at_shank + self.slope_rise + self.platform_edge_thickness

    @property
    def damper_half_width(self) -> float:
        """Half of the damper's bottom width, m."""
        return 0.5 * self.platform_gap + self.slope_run

    @property
    def outer_face(self) -> float:
        """Distance of the blades' outer faces from the plane of symmetry x = 0, m."""
        return self.damper_half_width + self.inner_overhang + self.shank_thickness_at_platform


MOST_ELEMENTS = 2_000_000  # six million unknowns; their factor alone takes more than 100 GB


@dataclass(frozen=True)
class BladePairElements:
    """Numbers of elements. Columns count along x, rows along z, ``chordwise`` along the damper's length (y).

    ``beyond_damper`` elements cover each end of the blades when the damper is shorter than their width. The damper
    has as many rows on its slopes as the platform has ``contact_columns``, so that the contact nodes coincide.

    Raises InputError for a count that is not a positive whole number.
    """

    shank_columns: int = 3
    shank_rows: int = 10
    platform_rows: int = 4
    airfoil_rows: int = 30
    inner_columns: int = 2
    contact_columns: int = 4
    chordwise: int = 10
    beyond_damper: int = 1
    damper_columns: int = 4
    damper_flank_rows: int = 2

    def __post_init__(self) -> None:
        for item in fields(self):
            whole_number(item.name, getattr(self, item.name), 1)
        if self.most_elements > MOST_ELEMENTS:
            raise InputError(
                f"the counts of [mesh] make up to {self.most_elements} elements, but at most {MOST_ELEMENTS} are "
                "allowed, because usual machines have no memory for more. Use smaller counts."
            )

    def require_lines(self) -> None:
        """Raise InputError where a contact line would not have elements on both sides."""
        for name in ("contact_columns", "damper_columns"):
            if getattr(self, name) < 2:
                raise InputError(
                    f"{name} is {getattr(self, name)}; a cylindrical damper requires at least 2, because its contact "
                    "lines are between two columns of elements.",
                    (name,),
                )

    @property
    def most_elements(self) -> int:
        """Number of elements where the damper is shorter than the blades; else those beyond it are not there."""
        rows = self.shank_rows + self.platform_rows + self.airfoil_rows
        blade = self.shank_columns * rows + (self.inner_columns + self.contact_columns) * self.platform_rows
        damper = self.damper_columns * (4 * self.damper_flank_rows + self.contact_columns + self.damper_columns)
        return 2 * (self.chordwise + 2 * self.beyond_damper) * blade + self.chordwise * damper
