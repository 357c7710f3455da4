"""Shapes of the damper between two platforms: wedge, flat plate and cylinder, in the plane of their section.

The platforms are a roof: two slopes whose upper ends have the same height on both sides of a gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, hypot, pi, sin, tan

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, positive_number

# chosen: the least distance of a contact line from the ends of a contact face, as a fraction of its width; elements
# beside it would be slivers.
LEAST_MARGIN = 0.1


@dataclass(frozen=True)
class Roof:
    """Both contact faces of the platforms: m and rad.

    ``height`` z of their upper ends, ``gap`` between them along x, ``face_width`` along each slope, ``angles`` of the
    left and the right face.
    """

    height: float
    gap: float
    face_width: float
    angles: tuple[float, float]

    @property
    def ridge(self) -> FloatArray:
        """(2,) x, z where the two slopes meet above the gap."""
        left, right = (tan(angle) for angle in self.angles)
        x = 0.5 * self.gap * (right - left) / (left + right)
        return np.array([x, self.height + (x + 0.5 * self.gap) * left])

    @property
    def beyond(self) -> tuple[float, float]:
        """Distance of the upper end of each face from the ridge, along the slope."""
        x, z = self.ridge
        left, right = (hypot(x - side * 0.5 * self.gap, z - self.height) for side in (-1.0, 1.0))
        return left, right


@dataclass(frozen=True)
class Wedge:
    """Two contact faces that fit the platforms, vertical flanks below, a flat bottom."""

    kind = "wedge"


@dataclass(frozen=True)
class Plate:
    """A flat plate of ``thickness`` in m below two flat platforms; InputError unless it is above zero."""

    thickness: float
    kind = "flat"

    def __post_init__(self) -> None:
        object.__setattr__(self, "thickness", positive_number("thickness", self.thickness, "m"))


@dataclass(frozen=True)
class Cylinder:
    """A cylinder of ``radius`` in m that touches each platform along a line; InputError unless it is above zero."""

    radius: float
    kind = "cylindrical"

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive_number("radius", self.radius, "m"))

    def centre(self, roof: Roof) -> FloatArray:
        """(2,) x, z of the axis."""
        angle = roof.angles[0]
        return np.asarray(self.contacts(roof)[0] + self.radius * np.array([sin(angle), -cos(angle)]))

    def contacts(self, roof: Roof) -> FloatArray:
        """(2, 2) x, z of the left and the right contact line."""
        reach = self._reach(roof)
        left, right = roof.angles
        return np.array(
            [
                roof.ridge - reach * np.array([cos(left), sin(left)]),
                roof.ridge + reach * np.array([cos(right), -sin(right)]),
            ]
        )

    def positions(self, roof: Roof) -> tuple[float, float]:
        """Fraction of each contact face from its lower end to the contact line."""
        left, right = (1.0 - (self._reach(roof) - beyond) / roof.face_width for beyond in roof.beyond)
        return left, right

    def _reach(self, roof: Roof) -> float:
        """Distance of both contact lines from the ridge, along the slopes."""
        return self.radius * tan(0.5 * sum(roof.angles))

    def require_lines_on(self, roof: Roof) -> None:
        """Raise InputError unless both lines are on the contact faces, away from their ends."""
        slope, margin = tan(0.5 * sum(roof.angles)), LEAST_MARGIN * roof.face_width
        least = (max(roof.beyond) + margin) / slope
        most = (min(roof.beyond) + roof.face_width - margin) / slope
        if not least <= self.radius <= most:
            raise InputError(
                f"radius is {1e3 * self.radius:.6g} mm; it must be between {1e3 * least:.4g} and {1e3 * most:.4g} mm, "
                "or the cylinder does not touch the contact faces of the platforms away from their ends.",
                ("radius", "contact_face_width", "platform_angle_deg", "platform_gap"),
            )

    def require_space(self, roof: Roof, shanks: FloatArray) -> None:
        """Raise InputError unless the cylinder is above the base and between the shanks.

        ``shanks`` (2, 2, 2): the inner face of the left and of the right shank from its lower to its upper end, x, z.
        """
        centre = self.centre(roof)
        along = shanks[:, 1] - shanks[:, 0]
        outwards = centre - shanks[:, 0]
        distance = np.abs(along[:, 0] * outwards[:, 1] - along[:, 1] * outwards[:, 0]) / np.linalg.norm(along, axis=1)
        free = min(float(centre[1]), *map(float, distance))
        if not self.radius < free:
            raise InputError(
                f"radius is {1e3 * self.radius:.6g} mm, but the axis of the cylinder is {1e3 * free:.4g} mm from the "
                "base or a shank. Use a smaller radius, a longer inner_overhang or a higher underside_height_at_shank.",
                ("radius", "inner_overhang", "underside_height_at_shank"),
            )


DamperShape = Wedge | Plate | Cylinder


def section_area(shape: DamperShape, roof: Roof, flank_height: float) -> float:
    """m2 of the section of a damper; ``flank_height`` is that of a wedge."""
    if isinstance(shape, Cylinder):
        return pi * shape.radius**2
    below = shape.thickness if isinstance(shape, Plate) else flank_height
    left, right = (roof.face_width * np.array([cos(angle), -sin(angle)]) for angle in roof.angles)
    middle, down = np.array([0.5 * roof.gap, 0.0]), np.array([0.0, below])
    low_left, low_right = left * [-1.0, 1.0] - middle, right + middle
    return _area(np.array([low_left - down, low_right - down, low_right, middle, -middle, low_left]))


def _area(corners: FloatArray) -> float:
    """m2 of a polygon (n, 2), counter-clockwise."""
    following = np.roll(corners, -1, axis=0)
    return 0.5 * float((corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]).sum())
