from typing import Any

import numpy as np
import pytest

from sectors import annulus
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.structure.cyclic_symmetry import rotation_about
from stickslip.structure.sector_boundaries import cyclic_symmetry


@pytest.fixture(scope="module")
def mesh() -> Any:
    return annulus(8, (0.1, 0.3), 0.02, (3, 2, 1), of=1)


def boundaries(mesh: Any) -> tuple[Any, Any]:
    return mesh.node_sets["left"], mesh.node_sets["right"]


def test_axis_sectors_and_partners_follow_from_the_boundaries(mesh: Any) -> None:
    left, right = boundaries(mesh)
    symmetry = cyclic_symmetry(mesh.points, left, np.random.default_rng(0).permutation(right))
    assert symmetry.sectors == 8
    np.testing.assert_allclose(symmetry.direction, [0.0, 0.0, 1.0])
    np.testing.assert_allclose(symmetry.rotated(mesh.points[symmetry.left]), mesh.points[symmetry.right], atol=1e-15)
    np.testing.assert_allclose(symmetry.rotation(8), np.eye(3), atol=1e-15)
    assert repr(symmetry) == "CyclicSymmetry(8 sectors about (0, 0, 1); 8 pairs of boundary nodes)"


def test_left_and_right_determine_the_sense_of_the_rotation(mesh: Any) -> None:
    left, right = boundaries(mesh)
    np.testing.assert_allclose(cyclic_symmetry(mesh.points, right, left).direction, [0.0, 0.0, -1.0])


def test_an_axis_anywhere(mesh: Any) -> None:
    direction, point = np.array([1.0, 2.0, -2.0]) / 3.0, np.array([0.4, -0.1, 7.0])
    normal = np.cross([0.0, 0.0, 1.0], direction)
    turn = rotation_about(normal / np.linalg.norm(normal), np.arccos(direction[2]))
    moved = mesh.points @ turn.T + point
    symmetry = cyclic_symmetry(moved, *boundaries(mesh), sectors=8, axis=(point, -3.0 * direction))
    np.testing.assert_allclose(symmetry.direction, direction, atol=1e-15)
    with rejects(InputError, "axis", "left", "right"):
        cyclic_symmetry(moved, *boundaries(mesh))


def test_boundaries_that_do_not_match(mesh: Any) -> None:
    left, right = boundaries(mesh)
    points = mesh.points.copy()
    points[right[2]] += [0.0, 0.001, 0.0]
    with rejects(InputError, "left", "right"):
        cyclic_symmetry(points, left, right, sectors=8, axis="z")


def test_boundaries_of_different_size(mesh: Any) -> None:
    left, right = boundaries(mesh)
    with rejects(InputError, "left", "right"):
        cyclic_symmetry(mesh.points, left, right[1:])


def test_an_angle_that_does_not_divide_the_circle(mesh: Any) -> None:
    left, right = boundaries(mesh)
    points = mesh.points.copy()
    points[right] = points[left] @ rotation_about(np.array([0.0, 0.0, 1.0]), np.radians(50.0)).T
    with rejects(InputError, "left", "right"):
        cyclic_symmetry(points, left, right, axis="z")


def test_a_number_of_sectors_that_contradicts_the_angle(mesh: Any) -> None:
    with rejects(InputError, "sectors"):
        cyclic_symmetry(mesh.points, *boundaries(mesh), sectors=9, axis="z")


def test_an_axis_that_contradicts_the_boundaries(mesh: Any) -> None:
    with rejects(InputError, "left", "right"):
        cyclic_symmetry(mesh.points, *boundaries(mesh), axis="x")


def test_a_node_on_the_axis() -> None:
    mesh = annulus(8, (0.0001, 0.3), 0.02, (2, 1, 1), of=1)
    points = mesh.points.copy()
    points[mesh.node_sets["inner"], :2] = 0.0
    with rejects(InputError, "left", "right"):
        cyclic_symmetry(points, *boundaries(mesh), axis="z")


def test_a_node_of_both_boundaries(mesh: Any) -> None:
    left, right = boundaries(mesh)
    with rejects(InputError, "left", "right"):
        cyclic_symmetry(mesh.points, left, np.append(right, left[0]))


def test_a_boundary_without_nodes(mesh: Any) -> None:
    with rejects(InputError, "right"):
        cyclic_symmetry(mesh.points, mesh.node_sets["left"], np.empty(0, dtype=int))


@pytest.mark.parametrize("axis", ["r", 3.0, ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), ((0.0, 0.0), (0.0, 0.0, 1.0))])
def test_an_axis_that_is_none(mesh: Any, axis: Any) -> None:
    with rejects(InputError, "axis"):
        cyclic_symmetry(mesh.points, *boundaries(mesh), axis=axis)
