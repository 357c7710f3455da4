"""Statics of a wedge between two platforms: loads of its faces, and whether friction locks it.

The faces have the angles ``a`` and ``b`` to the plane normal to the force F that presses the wedge outwards. If the
wedge slides, the reaction of each face is tilted by the friction angle ``phi = atan(mu)`` from its normal, against the
motion. Equilibrium of three forces (law of sines) gives the reactions

    R_a = F sin(b + s phi) / sin(a + b + 2 s phi),   R_b = F sin(a + s phi) / sin(a + b + 2 s phi),   N = R cos(phi),

with s = -1 if the wedge slides outwards and s = +1 if the platforms squeeze it inwards. For two equal angles N = F / (2
(cos a - s mu sin a)). The load for s = +1 grows without limit as a + b + 2 phi reaches 180 degrees: beyond, no force of
the platforms moves the wedge inwards. It is locked, however small F is; for equal angles if tan(a) >= 1 / mu.
"""

from __future__ import annotations

from math import atan, cos, degrees, pi, sin

from stickslip.core.errors import InputError


def face_loads(force: float, angles: tuple[float, float], friction: float = 0.0) -> tuple[float, float]:
    """Normal loads in N of both faces of a wedge that slides outwards with a friction coefficient, or without friction.

    ``angles`` in rad. Raises InputError if no such motion is in equilibrium: friction holds the face with the smaller
    angle.
    """
    phi = atan(friction)
    left, right = angles
    if left == right:  # also with friction above the tangent of the angle, where only the side of F matters
        load = force / (2.0 * (cos(left) + friction * sin(left)))
        return load, load
    total = sin(left + right - 2.0 * phi)
    if min(left, right) <= phi:
        raise InputError(
            f"friction_coefficient is {friction:g}, but a wedge with the angles {degrees(left):.4g} and "
            f"{degrees(right):.4g} deg slides outwards only with less than {sin(min(angles)) / cos(min(angles)):.4g}, "
            "the tangent of the smaller one. Use a smaller coefficient, or solve the preload.",
            arguments=["friction_coefficient"],
        )
    return force * sin(right - phi) / total * cos(phi), force * sin(left - phi) / total * cos(phi)


def squeezed_loads(force: float, angles: tuple[float, float], friction: float) -> tuple[float, float] | None:
    """Normal loads in N of both faces that make the wedge slide inwards; None if it is locked."""
    if is_locked(angles, friction):
        return None
    phi = atan(friction)
    left, right = angles
    total = sin(left + right + 2.0 * phi)
    return force * sin(right + phi) / total * cos(phi), force * sin(left + phi) / total * cos(phi)


def is_locked(angles: tuple[float, float], friction: float) -> bool:
    """Whether no force of the platforms moves the wedge inwards: a + b + 2 phi of at least 180 degrees."""
    return sum(angles) + 2.0 * atan(friction) >= pi


def locking_angle(friction: float) -> float:
    """Mean angle of the two faces in rad from which a wedge is locked, 90 degrees - phi."""
    return 0.5 * pi - atan(friction)
