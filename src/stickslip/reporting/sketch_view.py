"""From where a sketch is seen, which bodies are drawn as glass around the contact, and the windows of its views."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.results.sketch import Sketch

_ELEVATION_DEG = 30.0
# The first is the usual one: x to the right, y away from the eye, z up. Another one must show clearly more contact.
_AZIMUTHS_DEG = (-60.0, -120.0, -30.0, -150.0, 60.0, 120.0, 30.0, 150.0)
_CLEARLY_MORE = 1.1
_CLOSER = 1.6  # how much larger the contact must be in a close-up that is worth its place
_AROUND_CONTACT = 1.7  # times the size of the contact is shown in the close-up

Margins = tuple[float, float, float, float]  # px: left, top, right, bottom


@dataclass(frozen=True)
class Camera:
    """A parallel projection: ``axes`` (3, 3) are unit vectors to the right, up and towards the eye."""

    axes: FloatArray

    @classmethod
    def at(cls, azimuth_deg: float, elevation_deg: float) -> Camera:
        """Seen from an azimuth, counted from x to y, and an elevation above the x-y plane; z points up."""
        a, e = np.radians(azimuth_deg), np.radians(elevation_deg)
        towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return cls(np.stack([right, np.cross(towards, right), towards]))


@dataclass(frozen=True)
class Window:
    """The part of a projection that one view shows, ``scale`` px a metre around ``middle`` (2,) m right and up."""

    camera: Camera
    middle: FloatArray
    scale: float
    width: int
    height: int

    def places(self, points: FloatArray) -> FloatArray:
        """(n, 3) px of points (n, 3) m: x to the right and y down in the view, and depth towards the eye."""
        seen = points @ self.camera.axes.T
        x = 0.5 * self.width + self.scale * (seen[:, 0] - self.middle[0])
        y = 0.5 * self.height - self.scale * (seen[:, 1] - self.middle[1])
        return np.column_stack([x, y, self.scale * seen[:, 2]])

    def holds(self, places: FloatArray, margin: float = 0.0) -> NDArray[np.bool_]:
        """(n,) whether places (n, 2 or more) px lie in the view, at least ``margin`` px from its edge."""
        low, high = np.array([margin, margin]), np.array([self.width - margin, self.height - margin])
        return np.asarray(((places[:, :2] >= low) & (places[:, :2] <= high)).all(axis=1))


def area_vectors(sketch: Sketch) -> FloatArray:
    """(m, 3) m2 along the outward normal of each side."""
    corner = sketch.points[sketch.sides]
    return 0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])


def glass_bodies(sketch: Sketch, camera: Camera) -> NDArray[np.bool_]:
    """(n_bodies,) whether a body stands between the eye and the contact: more of its contact looks away than here."""
    contact = sketch.face >= 0
    towards = area_vectors(sketch)[contact] @ camera.axes[2]
    return np.bincount(sketch.body[contact], towards, minlength=len(sketch.body_names)) < 0.0


def best_camera(sketch: Sketch) -> Camera:
    """The usual view, unless another one shows the contact clearly better once the bodies before it are glass."""
    cameras = [Camera.at(azimuth, _ELEVATION_DEG) for azimuth in _AZIMUTHS_DEG]
    shown = [_contact_shown(sketch, camera) for camera in cameras]
    best = max(shown)
    return next(camera for camera, share in zip(cameras, shown, strict=True) if _CLEARLY_MORE * share >= best)


def _contact_shown(sketch: Sketch, camera: Camera) -> float:
    """Share of the contact area that is seen, of the face that is seen worst and of all of them, half each."""
    contact = sketch.face >= 0
    if not contact.any():
        return 0.0
    vectors, face = area_vectors(sketch)[contact], sketch.face[contact]
    towards, glass = vectors @ camera.axes[2], glass_bodies(sketch, camera)[sketch.body[contact]]
    n_faces = int(face.max()) + 1
    area = np.bincount(face, np.linalg.norm(vectors, axis=1), minlength=n_faces)
    # Of two sides that touch one looks here; a face on the ground may be seen through its own body.
    solid = np.bincount(face, np.where(glass, 0.0, towards.clip(0.0)), minlength=n_faces)
    through = np.bincount(face, np.where(glass, -towards.clip(None, 0.0), 0.0), minlength=n_faces)
    share = (np.maximum(solid, through) / np.where(area > 0.0, area, 1.0))[area > 0.0]
    return 0.5 * float(share.min() + share.mean())


def whole_window(sketch: Sketch, camera: Camera, width: int, heights: tuple[int, int], margins: Margins) -> Window:
    """A view of everything inside ``margins``, as high as it needs to be within ``heights`` px."""
    low, high = _extent(sketch.points, camera)
    size = np.maximum(high - low, 1e-6 * float(np.ptp(sketch.points, axis=0).max()))
    left, top, right, bottom = margins
    scale = (width - left - right) / size[0]
    height = int(np.clip(scale * size[1] + top + bottom, *heights))
    scale = min(scale, (height - top - bottom) / size[1])
    shift = np.array([right - left, top - bottom]) / (2.0 * scale)
    return Window(camera, 0.5 * (low + high) + shift, scale, width, height)


def contact_window(sketch: Sketch, whole: Window) -> Window | None:
    """A close-up of the contact in the format of ``whole``; None where there is none, or where it is large anyway."""
    contact = sketch.sides[sketch.face >= 0]
    if not contact.size:
        return None
    low, high = _extent(sketch.points[contact.ravel()], whole.camera)
    size = np.maximum(_AROUND_CONTACT * (high - low), 1e-6 / whole.scale)
    scale = float(min(whole.width / size[0], whole.height / size[1]))
    if scale < _CLOSER * whole.scale:
        return None
    return Window(whole.camera, 0.5 * (low + high), scale, whole.width, whole.height)


def _extent(points: FloatArray, camera: Camera) -> tuple[FloatArray, FloatArray]:
    seen = points @ camera.axes[:2].T
    return seen.min(axis=0), seen.max(axis=0)
