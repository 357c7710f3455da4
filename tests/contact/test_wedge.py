"""Loads of a wedge between two platforms: sums of forces, limits, lock-up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.preload import uniform_preload
from stickslip.contact.wedge import face_loads, is_locked, locking_angle, squeezed_loads
from stickslip.core.errors import InputError

ANGLES = [(math.radians(a), math.radians(b)) for a, b in ((30.0, 30.0), (20.0, 50.0), (60.0, 35.0))]


def resultant(loads: tuple[float, float], angles: tuple[float, float], friction: float, slides: float) -> np.ndarray:
    """Sum of the forces of both platforms on the wedge, x and z, plus a force of 1 N along z; ``slides`` is +1 for a
    wedge that moves outwards, along z."""
    total = np.array([0.0, 1.0])
    for side, load, angle in zip((1.0, -1.0), loads, angles, strict=True):
        normal = np.array([side * math.sin(angle), -math.cos(angle)])  # of the left platform: to the right and down
        up_the_face = np.array([side * math.cos(angle), math.sin(angle)])
        total += load * normal - slides * friction * load * up_the_face
    return total


@pytest.mark.parametrize("angles", ANGLES)
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_forces_are_in_equilibrium(angles: tuple[float, float], friction: float) -> None:
    outwards, inwards = face_loads(1.0, angles, friction), squeezed_loads(1.0, angles, friction)
    assert inwards is not None
    np.testing.assert_allclose(resultant(outwards, angles, friction, 1.0), 0.0, atol=1e-14)
    np.testing.assert_allclose(resultant(inwards, angles, friction, -1.0), 0.0, atol=1e-14)


def test_the_load_grows_without_limit_towards_lock_up() -> None:
    friction = 0.4
    limit = locking_angle(friction)
    assert math.tan(limit) == pytest.approx(1.0 / friction)
    loads = [squeezed_loads(1.0, (limit - gap,) * 2, friction) for gap in (1e-2, 1e-4)]
    assert loads[0] is not None
    assert loads[1] is not None
    assert loads[1][0] / loads[0][0] == pytest.approx(100.0, rel=0.01)
    assert not is_locked((limit - 0.1, limit + 0.09), friction)
    assert squeezed_loads(1.0, (limit - 0.1, limit + 0.11), friction) is None


def test_preload_of_two_angles_is_that_of_the_wedge() -> None:
    area, face = np.array([1.0, 3.0, 2.0]), np.array([0, 0, 1])
    load = uniform_preload(100.0, 0.4, area, face, 0.1, right_platform_angle=0.7)
    left, right = face_loads(100.0, (0.4, 0.7), 0.1)
    assert load == pytest.approx([0.25 * left, 0.75 * left, right])
    assert right < left  # the steeper face has the smaller load


def test_values_that_cannot_be_used() -> None:
    with rejects(InputError, "friction_coefficient"):
        face_loads(1.0, (0.2, 0.6), 0.3)
    with rejects(InputError, "right_platform_angle"):
        uniform_preload(1.0, 0.4, [1.0, 1.0], [0, 1], right_platform_angle=1.6)
