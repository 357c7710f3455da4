"""The damper of two blades as a wedge, in numbers and sentences: centrifugal force, loads of its faces, lock-up."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees

from stickslip.case.case import TwoBladeCase
from stickslip.contact.wedge import face_loads, is_locked, locking_angle, squeezed_loads
from stickslip.model.layout import Derived


def platform_angles(case: TwoBladeCase) -> tuple[float, float]:
    """Angles of the left and the right face, rad."""
    left, right = case.geometry.platform_angle, case.geometry.right_platform_angle
    return left, left if right is None else right


def damper_facts(case: TwoBladeCase) -> Iterator[Derived]:
    """Centrifugal force from the mass, loads of the faces with and without friction, and the angle of lock-up."""
    force, friction, angles = case.preload.damper_force, case.friction.coefficient, platform_angles(case)
    if case.preload.damper_mass is not None and force is not None:
        yield "Centrifugal force of the damper", force, "N", "mass, times radius, times speed of rotation squared"
    mean, limit = degrees(0.5 * sum(angles)), degrees(locking_angle(friction))
    words = f"mean platform angle from which friction {friction:g} locks the damper, 90 deg - atan(mu); here {mean:.4g}"
    yield "Platform angle of lock-up", limit, "deg", words
    if force is None:
        return
    squeezed = squeezed_loads(force, angles, friction)
    for place, name in enumerate(("left face", "right face")):
        without = f"{face_loads(force, angles)[place]:.4g} N without friction"
        label = f"Normal load that moves the damper inwards, {name}"
        if squeezed is None:
            yield label, "unlimited", "N", f"friction locks the damper; {without}"
        else:
            yield label, squeezed[place], "N", f"at the friction limit, squeezed by the platforms; {without}"


def damper_warnings(case: TwoBladeCase) -> Iterator[str]:
    """A sentence on a damper that is locked."""
    friction, angles = case.friction.coefficient, platform_angles(case)
    if is_locked(angles, friction):
        yield (
            f"Friction locks the damper: the mean platform angle is {degrees(0.5 * sum(angles)):.4g} deg, and with a "
            f"friction coefficient of {friction:g} it must be below {degrees(locking_angle(friction)):.4g} deg "
            "(tan(angle) < 1 / mu). Platforms that approach each other cannot push it inwards, so it sticks and hardly "
            "dissipates energy in that motion."
        )
