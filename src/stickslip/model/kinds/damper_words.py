"""The damper of two blades in numbers and sentences: centrifugal force, mass, loads of its faces, lock-up."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees

from stickslip.case.case import TwoBladeCase
from stickslip.case.two_blade_sections import CylindricalSection, FlatSection
from stickslip.contact.cylinder import holding_friction, line_loads, squeezed_line_loads
from stickslip.contact.wedge import face_loads, is_locked, locking_angle, squeezed_loads
from stickslip.model.kinds.dimensions import geometry_of
from stickslip.model.layout import Derived
from stickslip.model.rough_face import case_material

# On no other key does the lock-up depend, and it comes with a larger value of each.
LOCK_UP_KEYS = ("geometry.platform_angle", "geometry.right_platform_angle", "friction.coefficient")


def platform_angles(case: TwoBladeCase) -> tuple[float, float]:
    """Angles of the left and the right face, rad."""
    left, right = case.geometry.platform_angle, case.geometry.right_platform_angle
    return left, left if right is None else right


def damper_facts(case: TwoBladeCase) -> Iterator[Derived]:
    """Centrifugal force from the mass, mass of the mesh, loads of the faces with and without friction, lock-up."""
    force = case.preload.damper_force
    if case.preload.damper_mass is not None and force is not None:
        yield "Centrifugal force of the damper", force, "N", "mass, times radius, times speed of rotation squared"
    mass = geometry_of(case).damper_volume * case_material(case).density
    yield "Mass of the damper by its dimensions", 1e3 * mass, "g", "volume times density, as in the mesh"
    if isinstance(case.damper, FlatSection):
        yield from _flat_facts(case, force)
    else:
        yield from _inclined_facts(case, force)


def _flat_facts(case: TwoBladeCase, force: float | None) -> Iterator[Derived]:
    words = "it slides across the force; platforms cannot squeeze it"
    yield "Lock-up of the damper", "none", "-", words
    if force is not None:
        limit = 0.5 * force * case.friction.coefficient
        words = f"half of the centrifugal force times the friction coefficient; the normal load is {0.5 * force:.4g} N"
        yield "Friction limit of each face", limit, "N", words


def _inclined_facts(case: TwoBladeCase, force: float | None) -> Iterator[Derived]:
    """A wedge or a cylinder between inclined faces."""
    friction, angles = case.friction.coefficient, platform_angles(case)
    is_cylinder = isinstance(case.damper, CylindricalSection)
    mean, limit = degrees(0.5 * sum(angles)), degrees(locking_angle(friction))
    words = f"mean platform angle from which friction {friction:g} locks the damper, 90 deg - atan(mu); here {mean:.4g}"
    yield "Platform angle of lock-up", limit, "deg", words
    if is_cylinder:
        words = "cot(mean angle): with more friction, platforms that approach each other cannot push it inwards"
        yield "Friction coefficient of lock-up", holding_friction(angles), "-", words
        words = "platforms that move in opposite directions along their slopes roll it without sliding"
        yield "Rolling of the cylinder", "free", "-", words
    if force is None:
        return
    resting = line_loads(force, angles) if is_cylinder else face_loads(force, angles)
    squeezed = (squeezed_line_loads if is_cylinder else squeezed_loads)(force, angles, friction)
    for place, name in enumerate(("left face", "right face")):
        without = f"{resting[place]:.4g} N without friction"
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


def lock_up_sentences(cases: Sequence[TwoBladeCase]) -> Iterator[str]:
    """A sentence on where friction locks the damper between cases, all corners of a range; none if nowhere."""
    locked = [is_locked(platform_angles(case), case.friction.coefficient) for case in cases]
    if not any(locked):
        return
    means = sorted({0.5 * sum(platform_angles(case)) for case in cases})
    coefficients = sorted({case.friction.coefficient for case in cases})
    weak, strong = coefficients[0], coefficients[-1]
    if means[0] == means[-1]:
        limit = (
            f"at the mean platform angle of {degrees(means[0]):.4g} deg, from a friction coefficient of "
            f"{holding_friction((means[0], means[0])):.3g} on"
        )
    else:
        limit = f"from a mean platform angle of {degrees(locking_angle(strong)):.4g} deg on"
        limit += f" with a friction coefficient of {strong:g}"
        if weak < strong:
            limit += f", and of {degrees(locking_angle(weak)):.4g} deg on with {weak:g}"
    angles = f"{_span('mean angle', [degrees(each) for each in means])} deg"
    frictions = _span("friction coefficient", coefficients)
    where = "the whole of" if all(locked) else "a part of"
    yield (
        f"Friction locks the damper in {where} these ranges: {limit} (tan(angle) = 1 / mu). The ranges have {angles} "
        f"and {frictions}. Platforms that approach each other cannot push a locked damper inwards, so it sticks and "
        "hardly dissipates energy in that motion."
    )


def _span(name: str, values: Sequence[float]) -> str:
    """The first and the last of rising values in words."""
    first, last = f"{values[0]:.4g}", f"{values[-1]:.4g}"
    return f"a {name} of {first}" if first == last else f"{name}s of {first} to {last}"
