"""Loads of a cylinder between two platforms: sums of forces and moments, lock-up, rolling."""

from __future__ import annotations

import math

import numpy as np
import pytest

from stickslip.contact.cylinder import holding_friction, line_loads, squeezed_line_loads
from stickslip.contact.wedge import face_loads, locking_angle, squeezed_loads

ANGLES = [(math.radians(a), math.radians(b)) for a, b in ((30.0, 30.0), (20.0, 50.0), (60.0, 35.0))]


@pytest.mark.parametrize("angles", ANGLES)
@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("slides", [1.0, -1.0])
def test_forces_and_moments_are_in_equilibrium(angles: tuple[float, float], friction: float, slides: float) -> None:
    loads = line_loads(1.0, angles, friction) if slides > 0.0 else squeezed_line_loads(1.0, angles, friction)
    assert loads is not None
    # Unknown friction forces: least squares of the three equations must leave nothing, and the Coulomb law holds.
    normal, tangent, arm = [], [], []
    for side, angle in zip((1.0, -1.0), angles, strict=True):
        normal.append([side * math.sin(angle), -math.cos(angle)])
        tangent.append([-slides * side * math.cos(angle), -slides * math.sin(angle)])
        arm.append([-side * math.sin(angle), math.cos(angle)])
    moments = [a[0] * t[1] - a[1] * t[0] for a, t in zip(arm, tangent, strict=True)]
    matrix = np.vstack([np.transpose(tangent), moments])
    known = np.array([0.0, 1.0, 0.0]) + np.append(np.transpose(normal) @ loads, 0.0)
    forces, *_ = np.linalg.lstsq(matrix, -known, rcond=None)
    np.testing.assert_allclose(matrix @ forces + known, 0.0, atol=1e-14)
    assert forces[0] == pytest.approx(forces[1], abs=1e-14)
    assert max(forces / loads) == pytest.approx(friction, abs=1e-14)  # one line slides, the other is within its limit


def test_equal_angles_are_those_of_a_wedge() -> None:
    angles = (0.6, 0.6)
    assert line_loads(3.0, angles, 0.2) == pytest.approx(face_loads(3.0, angles, 0.2))
    assert squeezed_line_loads(3.0, angles, 0.2) == pytest.approx(squeezed_loads(3.0, angles, 0.2))
    assert line_loads(3.0, (0.4, 0.9)) == pytest.approx(face_loads(3.0, (0.4, 0.9)))


def test_it_locks_where_a_wedge_does() -> None:
    friction = 0.4
    limit = locking_angle(friction)
    assert holding_friction((limit, limit)) == pytest.approx(friction)
    assert holding_friction((0.5 * math.pi, 0.5 * math.pi)) == 0.0
    assert squeezed_line_loads(1.0, (limit - 0.1, limit + 0.1), friction * 1.0001) is None
    loads = [squeezed_line_loads(1.0, (limit - gap,) * 2, friction) for gap in (1e-2, 1e-4)]
    assert loads[0] is not None
    assert loads[1] is not None
    assert loads[1][0] / loads[0][0] == pytest.approx(100.0, rel=0.01)


def test_exchanged_angles_exchange_the_loads() -> None:
    assert line_loads(1.0, (0.3, 0.8), 0.1) == line_loads(1.0, (0.8, 0.3), 0.1)[::-1]
