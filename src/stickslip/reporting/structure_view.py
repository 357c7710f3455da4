"""The view of the structure, and the bodies that are transparent because they would hide the contact."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.results.sketch import Sketch

_ELEVATION_DEG = 30.0
# The first is the usual one: x to the right, y away from the eye, z up. Another one must show more contact, by this
# factor.
_AZIMUTHS_DEG = (-60.0, -120.0, -30.0, -150.0, 60.0, 120.0, 30.0, 150.0)
_CLEARLY_MORE = 1.1
_CLOSER = 1.6  # chosen: a contact smaller than the whole by this factor has a view of its own
_AROUND_CONTACT = 1.7  # times the size of the contact is shown in that view


@dataclass(frozen=True)
class Camera:
    """A direction of view: azimuth, counted from x to y, and elevation of the eye above the x-y plane; z points up."""

    azimuth_deg: float
    elevation_deg: float

    @cached_property
    def axes(self) -> FloatArray:
        """(3, 3) unit vectors to the right, up and towards the eye."""
        a, e = np.radians(self.azimuth_deg), np.radians(self.elevation_deg)
        towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return np.stack([right, np.cross(towards, right), towards])


@dataclass(frozen=True)
class Extent:
    """The box that a view shows: its middle (3,) m and its size (3,) m along x, y and z."""

    middle: FloatArray
    size: FloatArray

    @classmethod
    def around(cls, points: FloatArray, factor: float = 1.0) -> Extent:
        """``factor`` times the box around points (n, 3), no side of it thinner than a part of the longest."""
        low, high = points.min(axis=0), points.max(axis=0)
        return cls(0.5 * (low + high), factor * np.maximum(high - low, 0.02 * float((high - low).max())))

    @property
    def corners(self) -> FloatArray:
        """(8, 3) m."""
        signs = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T
        return self.middle + signs * self.size

    def projected_size(self, camera: Camera) -> FloatArray:
        """(3,) m of the box to the right, up and towards the eye."""
        return np.asarray(np.abs(camera.axes) @ self.size)


def round_length(least: float) -> float:
    """The smallest of 1, 2 and 5 times a power of ten that is not below ``least``: for ticks."""
    power = 10.0 ** np.floor(np.log10(least))
    return float(f"{next(factor * power for factor in (1, 2, 5, 10) if factor * power >= least * (1 - 1e-9)):.3g}")


def area_vectors(sketch: Sketch) -> FloatArray:
    """(m, 3) m2 along the outward normal of each side."""
    corner = sketch.points[sketch.sides]
    return 0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])


def directions(vectors: FloatArray) -> FloatArray:
    """Vectors (m, 3) with the length 1; those without a length stay as they are."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0.0, length, 1.0))


def glass_bodies(sketch: Sketch, camera: Camera) -> NDArray[np.bool_]:
    """(n_bodies,) whether a body stands between the eye and the contact: more of its contact looks away than here."""
    contact = sketch.face >= 0
    towards = area_vectors(sketch)[contact] @ camera.axes[2]
    return np.bincount(sketch.body[contact], towards, minlength=len(sketch.body_names)) < 0.0


def best_camera(sketch: Sketch) -> Camera:
    """The usual view, unless another one shows the contact clearly better once the bodies before it are transparent."""
    cameras = [Camera(azimuth, _ELEVATION_DEG) for azimuth in _AZIMUTHS_DEG]
    shown = [_visible_contact(sketch, camera) for camera in cameras]
    best = max(shown)
    return next(camera for camera, share in zip(cameras, shown, strict=True) if _CLEARLY_MORE * share >= best)


def visible_faces(sketch: Sketch, camera: Camera, least: int = 0) -> FloatArray:
    """(n_faces,) visible fraction of the area of each contact face: through glass, or if it looks at the eye.

    It is 1 for a face without sides, such as a contact line. There are at ``least`` so many faces: the last ones may
    have no sides.
    """
    contact = sketch.face >= 0
    vectors, face = area_vectors(sketch)[contact], sketch.face[contact]
    towards, glass = vectors @ camera.axes[2], glass_bodies(sketch, camera)[sketch.body[contact]]
    n_faces = max(least, int(face.max(initial=-1)) + 1)
    area = np.bincount(face, np.linalg.norm(vectors, axis=1), minlength=n_faces)
    # Of two sides that touch one looks here; a face on the ground may be seen through its own body.
    solid = np.bincount(face, np.where(glass, 0.0, towards.clip(0.0)), minlength=n_faces)
    through = np.bincount(face, np.where(glass, -towards.clip(None, 0.0), 0.0), minlength=n_faces)
    return np.asarray(np.where(area > 0.0, np.maximum(solid, through) / np.where(area > 0.0, area, 1.0), 1.0))


def _visible_contact(sketch: Sketch, camera: Camera) -> float:
    """Visible fraction of the contact area: half of it is that of the least visible face, half that of all faces."""
    shown = np.unique(sketch.face[sketch.face >= 0])
    if not shown.size:
        return 0.0
    fraction = visible_faces(sketch, camera)[shown]
    return 0.5 * float(fraction.min() + fraction.mean())


def contact_extent(sketch: Sketch, camera: Camera) -> Extent | None:
    """The surroundings of the contact; None where there is none, or where it is large in a view of the whole."""
    contact = sketch.sides[sketch.face >= 0]
    if not contact.size:
        return None
    close = Extent.around(sketch.points[contact.ravel()], _AROUND_CONTACT)
    whole = Extent.around(sketch.points)
    if float(np.max(whole.projected_size(camera)[:2])) < _CLOSER * float(np.max(close.projected_size(camera)[:2])):
        return None
    return close
