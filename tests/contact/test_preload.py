"""Preload of the contact pairs: the wedge under centrifugal force, and prescribed values."""

from __future__ import annotations

from math import cos, pi, radians, sin
from typing import Any

import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.preload import area_fraction, prescribed_preload, uniform_preload
from stickslip.core.errors import InputError

AREA = np.array([1.0, 3.0, 2.0, 2.0, 4.0]) * 1e-6
FACE = np.array([0, 0, 1, 1, 1])


@pytest.mark.parametrize(("friction", "fraction"), [(0.0, 0.57735), (0.3, 0.49211)])
def test_wedge_at_thirty_degrees(friction: float, fraction: float) -> None:
    preload = uniform_preload(500.0, radians(30), AREA, FACE, friction_coefficient=friction)
    np.testing.assert_allclose(np.bincount(FACE, weights=preload), 500.0 * fraction, rtol=1e-5)


@pytest.mark.parametrize("angle", [0.0, 0.2, 0.5, 1.2])
@pytest.mark.parametrize("friction", [0.0, 0.1, 0.6])
def test_the_two_faces_balance_the_centrifugal_force(angle: float, friction: float) -> None:
    preload = uniform_preload(800.0, angle, AREA, FACE, friction)
    normal = np.bincount(FACE, weights=preload)
    assert (normal * (cos(angle) + friction * sin(angle))).sum() == pytest.approx(800.0, rel=1e-14)
    assert normal[0] == pytest.approx(normal[1], rel=1e-14)
    pressure = preload / AREA
    np.testing.assert_allclose(pressure[FACE == 0], pressure[0], rtol=1e-14)
    np.testing.assert_allclose(pressure[FACE == 1], pressure[2], rtol=1e-14)


def test_area_share_adds_up_on_each_face() -> None:
    share = area_fraction(AREA, [9, 9, -4, -4, -4])
    np.testing.assert_allclose(share, [0.25, 0.75, 0.25, 0.25, 0.5], rtol=1e-15)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"centrifugal_force": 0.0}, "centrifugal_force"),
        ({"centrifugal_force": float("inf")}, "centrifugal_force"),
        ({"platform_angle": 30.0}, "platform_angle"),
        ({"platform_angle": pi / 2}, "platform_angle"),
        ({"platform_angle": -0.1}, "platform_angle"),
        ({"friction_coefficient": -0.1}, "friction_coefficient"),
        ({"friction_coefficient": float("nan")}, "friction_coefficient"),
        ({"area": [1.0, 1.0, 1.0, 0.0, 1.0]}, "area"),
        ({"area": []}, "area"),
        ({"area": AREA.reshape(1, 5)}, "area"),
        ({"face": [0, 1]}, "face"),
        ({"face": [0, 0, 1, 1, 1.5]}, "face"),
    ],
)
def test_values_out_of_range(changes: dict[str, Any], key: str) -> None:
    arguments: dict[str, Any] = {"centrifugal_force": 500.0, "platform_angle": 0.5, "area": AREA, "face": FACE}
    with rejects(InputError, key):
        uniform_preload(**(arguments | changes))


def test_prescribed_preload_is_a_checked_copy() -> None:
    values = np.array([1.0, -2.0, 3.0])
    preload = prescribed_preload(values, 3)
    assert preload.tolist() == [1.0, -2.0, 3.0]
    assert not np.shares_memory(preload, values)


@pytest.mark.parametrize(
    "values",
    [(1.0, 2.0), 5.0, (1.0, float("nan"), 2.0), ("a", 1.0, 2.0)],
)
def test_prescribed_preload_of_the_wrong_form(values: Any) -> None:
    with rejects(InputError, "preload"):
        prescribed_preload(values, 3)
