import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.pairing.local_axes import local_tangents, map_position
from stickslip.core.errors import InputError


def around(axis: int, count: int = 24) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points and normals of a circle around a coordinate axis."""
    angle = 2.0 * np.pi * np.arange(count) / count
    normal = np.zeros((count, 3))
    normal[:, (axis + 1) % 3], normal[:, (axis + 2) % 3] = np.cos(angle), np.sin(angle)
    return normal + np.linspace(0.0, 5.0, count)[:, None] * np.eye(3)[axis], normal, np.ones(count)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_closed_cylinder_gets_its_axis(axis: int) -> None:
    points, normal, area = around(axis)
    tangent1, tangent2 = local_tangents(points, normal, area)
    np.testing.assert_allclose(tangent1, np.tile(np.eye(3)[axis], (24, 1)), atol=1e-12)
    np.testing.assert_allclose(tangent2, np.cross(normal, tangent1), atol=1e-12)
    position = map_position(points, tangent1, tangent2, area)
    # The longest principal axis of this coil is near the cylinder's.
    assert np.ptp(position[:, 0]) == pytest.approx(5.0, rel=0.1)
    np.testing.assert_allclose(position.max(axis=0), -position.min(axis=0))


def test_a_sphere_has_no_direction_for_all_points() -> None:
    normal = np.random.default_rng(0).standard_normal((4000, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    with rejects(InputError):
        local_tangents(normal, normal, np.ones(4000))


def test_mirrored_faces_have_mirrored_axes() -> None:
    normal = np.array([[np.sin(0.5), 0.0, np.cos(0.5)]])
    mirror = np.array([-1.0, 1.0, 1.0])
    one = local_tangents(np.zeros((1, 3)), normal, np.ones(1))
    other = local_tangents(np.zeros((1, 3)), normal * mirror, np.ones(1))
    for mine, theirs in zip(one, other, strict=True):
        np.testing.assert_allclose(theirs, mine * mirror, atol=1e-15)


def test_length_of_the_chosen_direction_does_not_matter() -> None:
    normal, one = np.array([[0.0, 0.6, 0.8]]), np.ones(1)
    short = local_tangents(np.zeros((1, 3)), normal, one, (1e-6, 1e-6, 0.0))
    np.testing.assert_allclose(short[0], local_tangents(np.zeros((1, 3)), normal, one, (5.0, 5.0, 0.0))[0])
    assert short[0] @ normal[0] == pytest.approx(0.0, abs=1e-15)
