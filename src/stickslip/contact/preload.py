"""Normal load of the contact pairs at rest: a wedge under centrifugal force, or prescribed values."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.wedge import face_loads
from stickslip.core.errors import InputError
from stickslip.core.validation import (
    FloatArray,
    finite_array,
    per_pair,
    positive_number,
    real_number,
    require_allowed,
    require_positive,
)


def uniform_preload(
    centrifugal_force: float,
    platform_angle: float,
    area: ArrayLike,
    face: ArrayLike,
    friction_coefficient: float = 0.0,
    right_platform_angle: float | None = None,
) -> FloatArray:
    """Preload (n_pairs,) in N of a wedge damper that rests on two inclined faces with uniform pressure.

    N_face = F_N / (2 (cos theta + mu_0 sin theta)), distributed over the pairs of a face by area. It is the equilibrium
    of forces along F_N: each face contributes N cos theta, and, if the damper slid outwards at assembly, mu_0 N sin
    theta. mu_0 = 0 is the frictionless wedge. Two different angles: :mod:`stickslip.contact.wedge`.

    ``centrifugal_force`` F_N in N, total over both ends of the damper; ``platform_angle`` theta in rad, between a
    face and the plane normal to F_N; ``area`` (n_pairs,) m2; ``face`` (n_pairs,) integers, which face a pair belongs
    to; ``friction_coefficient`` mu_0 at assembly; ``right_platform_angle`` in rad, of the face 1 if it differs from
    that of the face 0. Raises InputError for values that are not usable.
    """
    force = positive_number("centrifugal_force", centrifugal_force, "N (total over both ends)")
    angle = real_number("platform_angle", platform_angle)
    friction = real_number("friction_coefficient", friction_coefficient)
    require_allowed("friction_coefficient", friction, friction >= 0, "0 or above")
    other = angle if right_platform_angle is None else real_number("right_platform_angle", right_platform_angle)
    for name, each in (("platform_angle", angle), ("right_platform_angle", other)):
        require_allowed(name, each, 0 <= each < pi / 2, "from 0 to below pi/2 rad (an angle in radians)")
    share = area_fraction(area, face)
    loads = np.array(face_loads(force, (angle, other), friction))
    return np.asarray(loads[face_index(face, share.size) % 2] * share)


def prescribed_preload(values: ArrayLike, n_pairs: int) -> FloatArray:
    """Preload (n_pairs,) in N, one entry for each pair; below zero it is a gap at rest.

    Raises InputError unless ``values`` contains exactly ``n_pairs`` finite numbers.
    """
    array = finite_array("preload", values)
    if array.shape != (n_pairs,):
        raise InputError(
            f"preload has the shape {array.shape}, but it must be ({n_pairs},): one value in N for each contact pair.",
            arguments=["preload"],
        )
    return array.copy()


def area_fraction(area: ArrayLike, face: ArrayLike) -> FloatArray:
    """Fraction (n_pairs,) of each pair of the area of its own face, A_i / sum of A_j; the fractions of a face sum to 1.

    Raises InputError unless the areas are above zero and ``face`` contains one integer for each pair.
    """
    areas, faces = checked_area(area), face_index(face, np.size(area))
    return areas / face_sum(areas, faces)[faces]


def checked_area(area: ArrayLike) -> FloatArray:
    """``area`` as an array (n_pairs,) in m2. Raises InputError unless every entry is above zero."""
    areas = finite_array("area", area)
    if areas.ndim != 1 or areas.size == 0:
        raise InputError(
            f"area must have the shape (n_pairs,), one area in m2 for each pair, but its shape is {areas.shape}.",
            arguments=["area"],
        )
    require_positive("area", areas, "A pair represents a part of the contact face; check for faces of zero area.")
    return areas


def face_index(face: ArrayLike, n_pairs: int) -> NDArray[np.intp]:
    """``face`` (n_pairs,) renumbered 0, 1, 2 ... without gaps. Raises InputError unless it has one integer a pair."""
    labels = per_pair("face", face, n_pairs)
    bad = np.flatnonzero(labels != np.round(labels))
    if bad.size:
        raise InputError(
            f"face[{bad[0]}] is {labels[bad[0]]:g}, but it must be an integer: the number of the face.",
            arguments=["face"],
        )
    return np.unique(labels, return_inverse=True)[1]


def face_sum(values: FloatArray, face: NDArray[np.intp]) -> FloatArray:
    """Sum of ``values`` (n_pairs,) over the pairs of each face, (n_faces,)."""
    return np.asarray(np.bincount(face, weights=values), dtype=float)
