"""Two tangents for each point of a face, and flat coordinates of the points for maps."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array

_ALONG_Z = 0.99  # a face whose mean normal has a larger z component looks along z
_SMALLEST_SINE = 0.05  # between a direction and a normal; below it the tangent would be almost arbitrary
_SMALLEST_MEAN = 0.05  # length of a mean of unit vectors; below it the face is closed and has no mean direction


def local_tangents(
    points: FloatArray, normal: FloatArray, area: FloatArray, chosen: ArrayLike | None = None
) -> tuple[FloatArray, FloatArray]:
    """Unit vectors t1 and t2 (k, 3) in the face at points (k, 3) with unit normals (k, 3).

    t1 is the direction ``chosen`` (3,), of any length, projected on the face: ``d - (d . n) n``. Without a choice d is
    z, or x on a face with its normal along z, or, on a face that curves through that direction, the axis farthest from
    all normals. t2 is ``n x t1``, with the sign that makes the leading component of its mean positive, so that mirrored
    faces get mirrored tangents; on a closed face, which has no mean direction, it is ``n x t1``.

    Raises InputError for a direction that is not a vector, or that is parallel to a normal of the face.
    """
    if chosen is None:
        direction = _default_direction(normal, area)
        advice = "Give `tangent`, a direction in the face; split a face that curves through all axes."
    else:
        direction = finite_array("tangent", chosen)
        if direction.shape != (3,) or not direction.any():
            raise InputError(f"tangent must be a non-zero vector x, y, z, but it is {np.asarray(chosen).tolist()}.")
        direction = direction / np.linalg.norm(direction)
        advice = "Choose a direction in the face, or split the face."
    tangent1 = direction - (normal @ direction)[:, None] * normal
    length = np.linalg.norm(tangent1, axis=1)
    if length.min() < _SMALLEST_SINE:
        x, y, z = 1e3 * points[length.argmin()]
        a, b, c = direction
        raise InputError(
            f"the tangential direction ({a:.3g}, {b:.3g}, {c:.3g}) is parallel to the normal of the face at ({x:.4g}, "
            f"{y:.4g}, {z:.4g}) mm, so it has no component in the face there. {advice}"
        )
    tangent1 = tangent1 / length[:, None]
    tangent2 = np.cross(normal, tangent1)
    mean = _mean(tangent2, area)
    if np.linalg.norm(mean) < _SMALLEST_MEAN:
        return tangent1, tangent2
    return tangent1, tangent2 * np.sign(mean[np.abs(mean).argmax()])


def _default_direction(normal: FloatArray, area: FloatArray) -> FloatArray:
    mean = _mean(normal, area)
    length = float(np.linalg.norm(mean))
    usual = np.eye(3)[0 if abs(mean[2]) > _ALONG_Z * length and length > _SMALLEST_MEAN else 2]
    if 1.0 - np.abs(normal @ usual).max() ** 2 >= _SMALLEST_SINE**2:
        return np.asarray(usual)
    return np.asarray(np.eye(3)[np.abs(normal).max(axis=0).argmin()])


def _mean(vectors: FloatArray, area: FloatArray) -> FloatArray:
    return np.asarray(area @ vectors / area.sum())


def mean_tangents(tangent1: FloatArray, tangent2: FloatArray, area: FloatArray) -> FloatArray | None:
    """(2, 3) unit vectors, the means over a face of its tangents; None on a closed face, where they have no mean."""
    means = np.array([_mean(tangent1, area), _mean(tangent2, area)])
    length = np.linalg.norm(means, axis=1, keepdims=True)
    return None if length.min() < _SMALLEST_MEAN else np.asarray(means / length)


def map_position(points: FloatArray, tangent1: FloatArray, tangent2: FloatArray, area: FloatArray) -> FloatArray:
    """(k, 2) m along the mean tangents from the middle of the face's box.

    On a closed face, where a tangent has no mean, the axes are the two longest principal axes of its points.
    """
    axes = mean_tangents(tangent1, tangent2, area)
    if axes is None:
        axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][:2]
    position = points @ axes.T
    return np.asarray(position - 0.5 * (position.min(axis=0) + position.max(axis=0)))
