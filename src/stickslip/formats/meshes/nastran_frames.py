"""Coordinate systems as geometry: rectangular, cylindrical and spherical ones by origin and axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from stickslip.core.validation import FloatArray

Kind = Literal["rectangular", "cylindrical", "spherical"]

_SHORTEST = 1e-9  # fraction of the distances between the three points below which they define no axes
_ON_AXIS = 1e-9  # fraction of the coordinates below which a point is on the axis of a system


@dataclass(frozen=True)
class Frame:
    """A coordinate system: ``origin`` (3,) and ``axes`` (3, 3), one a row, in basic x, y, z."""

    kind: Kind
    origin: FloatArray
    axes: FloatArray

    @classmethod
    def through(cls, kind: Kind, points: FloatArray) -> Frame | None:
        """The system of three points (3, 3), basic x, y, z: the origin, a place on axis 3, one in the half plane of
        axes 1 and 3. None where they lie in one line, or one is not finite."""
        a, b, c = points
        with np.errstate(over="ignore", invalid="ignore"):
            z, y = b - a, np.cross(b - a, c - a)
            length, area = float(np.linalg.norm(z)), float(np.linalg.norm(y))
            # the comparison is false for what is not finite, too
            if not _SHORTEST * length * float(np.linalg.norm(c - a)) < area < np.inf:
                return None
        z, y = z / length, y / area
        return cls(kind, a, np.vstack([np.cross(y, z), y, z]))

    def basic(self, places: FloatArray) -> FloatArray:
        """Basic x, y, z (k, 3) of places (k, 3): x, y, z; r, theta, z; or r, theta from axis 3, phi. Angles in degrees.

        Cylindrical: (r cos theta, r sin theta, z); spherical: r (sin theta cos phi, sin theta sin phi, cos theta), in
        the system's axes. Values that overflow are not finite in the result.
        """
        first, second, third = places.T
        with np.errstate(over="ignore", invalid="ignore"):
            if self.kind == "cylindrical":
                angle = np.radians(second)
                local = np.column_stack([first * np.cos(angle), first * np.sin(angle), third])
            elif self.kind == "spherical":
                polar, angle = np.radians(second), np.radians(third)
                ring = first * np.sin(polar)
                local = np.column_stack([ring * np.cos(angle), ring * np.sin(angle), first * np.cos(polar)])
            else:
                local = places
            return np.asarray(self.origin + local @ self.axes)

    def directions(self, place: FloatArray) -> tuple[FloatArray, frozenset[int]]:
        """Directions 1, 2, 3 of the system at a place (3,), both in basic x, y, z: rows (3, 3), and which rows have no
        direction of their own, as the place is on axis 3 of a cylindrical or spherical system.

        Rows are the axes; those of r, theta, z; or those of r, theta, phi.
        """
        if self.kind == "rectangular":
            return self.axes, frozenset()
        with np.errstate(over="ignore", invalid="ignore"):  # positions that are not finite are rejected with their node
            local = self.axes @ (place - self.origin)
            ring = float(np.hypot(local[0], local[1]))  # without the squares, which may be too large
            radius = float(np.hypot(ring, local[2]))
        small = _ON_AXIS * max(float(np.abs(each).max()) for each in (place, self.origin))
        if self.kind == "spherical" and radius <= small:
            return self.axes, frozenset((0, 1, 2))
        if ring <= small:
            if self.kind == "cylindrical":
                return self.axes, frozenset((0, 1))
            return self.axes[[2, 0, 1]] * np.sign([[local[2]], [1.0], [1.0]]), frozenset((1, 2))
        cosine, sine = local[0] / ring, local[1] / ring
        around = [-sine, cosine, 0.0]
        if self.kind == "cylindrical":
            rows = [[cosine, sine, 0.0], around, [0.0, 0.0, 1.0]]
        else:
            up, out = local[2] / radius, ring / radius  # cosine and sine of the angle from axis 3
            rows = [[out * cosine, out * sine, up], [up * cosine, up * sine, -out], around]
        return np.array(rows) @ self.axes, frozenset()


BASIC = Frame("rectangular", np.zeros(3), np.eye(3))
