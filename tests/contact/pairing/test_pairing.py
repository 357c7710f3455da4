from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sentences import rejects
from solid_cells import CORNERS
from stickslip.contact.pairing.pairing import FacePairs, pair_faces
from stickslip.core.errors import InputError
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.structure.mesh import Mesh
from stickslip.structure.superelement import Superelement


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return blade_pair_mesh()


@pytest.fixture(scope="module")
def left(mesh: Mesh) -> FacePairs:
    return pair_faces(mesh, "damper_left_face", "left_face")


@pytest.fixture(scope="module")
def pairs(mesh: Mesh, left: FacePairs) -> FacePairs:
    return FacePairs.concatenate([left, pair_faces(mesh, "damper_right_face", "right_face")])


def two_cubes(gap: float = 0.0, shift: float = 0.0) -> Mesh:
    """Cube 0 below, cube 1 on top of it; face sets ``lower`` (top of cube 0) and ``upper`` (bottom of cube 1)."""
    cube = (CORNERS + 1) / 2
    points = np.vstack([cube, cube + np.array([shift, 0.0, 1.0 + gap])])
    sets = {"lower": np.arange(4, 8), "upper": np.arange(8, 12), "whole": np.arange(8), "corner": np.array([4, 5, 6])}
    return Mesh(points, np.arange(16).reshape(2, 8), np.array([0, 1]), sets)


def test_reference_pairs(pairs: FacePairs) -> None:
    with np.load(Path(__file__).parents[2] / "data" / "two_blade_mesh.npz") as reference:
        assert pairs.n_pairs == len(reference["pair_area_m2"]) == 110
        points = reference["points_m"]
        np.testing.assert_allclose(pairs.points, points[reference["pair_damper_node"]], atol=1e-12)
        np.testing.assert_allclose(pairs.points, points[reference["pair_blade_node"]], atol=1e-12)
        np.testing.assert_allclose(pairs.area, reference["pair_area_m2"], rtol=1e-12)
        np.testing.assert_allclose(pairs.normal, reference["pair_normal"], atol=1e-12)
        np.testing.assert_allclose(pairs.tangent1, reference["pair_tangent1"], atol=1e-12)
        np.testing.assert_allclose(pairs.tangent2, reference["pair_tangent2"], atol=1e-12)


def test_faces_and_map_positions(pairs: FacePairs) -> None:
    np.testing.assert_array_equal(np.bincount(pairs.face), [55, 55])
    for face in (0, 1):
        position = 1e3 * pairs.face_position[pairs.face == face]
        np.testing.assert_allclose(np.unique(position[:, 0].round(9)), np.linspace(-3.25, 3.25, 5), atol=1e-9)
        np.testing.assert_allclose(np.unique(position[:, 1].round(9)), np.linspace(-14.0, 14.0, 11), atol=1e-9)
        assert pairs.area[pairs.face == face].sum() == pytest.approx(182e-6, rel=1e-12)


def test_damper_that_rises_closes_both_faces(mesh: Mesh, pairs: FacePairs) -> None:
    displacement = np.zeros((mesh.n_nodes, 3))
    displacement[np.unique(mesh.cells[mesh.body == 2])] = [0.0, 0.0, 1.0]
    relative = (pairs.mesh_operator(mesh.n_nodes) @ displacement.ravel()).reshape(-1, 3)
    np.testing.assert_allclose(relative[:, 2], np.cos(np.radians(30.0)))
    np.testing.assert_allclose(relative[:, 0], np.sin(np.radians(30.0)))
    np.testing.assert_allclose(relative[:, 1], 0.0, atol=1e-12)


def test_damper_toward_the_right_blade_closes_right_and_opens_left(mesh: Mesh, pairs: FacePairs) -> None:
    displacement = np.zeros((mesh.n_nodes, 3))
    displacement[np.unique(mesh.cells[mesh.body == 2])] = [1.0, 0.0, 0.0]
    normal = (pairs.mesh_operator(mesh.n_nodes) @ displacement.ravel())[2::3]
    np.testing.assert_allclose(normal[pairs.face == 0], -0.5)
    np.testing.assert_allclose(normal[pairs.face == 1], 0.5)


def test_rigid_motion_of_everything_is_no_relative_motion(mesh: Mesh, pairs: FacePairs) -> None:
    rotation = np.array([[0.0, -0.3, 0.2], [0.3, 0.0, -0.5], [-0.2, 0.5, 0.0]])
    displacement = mesh.points @ rotation.T + [1.0, 2.0, 3.0]
    np.testing.assert_allclose(pairs.mesh_operator(mesh.n_nodes) @ displacement.ravel(), 0.0, atol=1e-12)


def test_operators_of_mesh_and_superelement_agree(mesh: Mesh, pairs: FacePairs) -> None:
    nodes = np.random.default_rng(1).permutation(np.append(pairs.nodes, mesh.node_set("response")))
    size = 3 * len(nodes) + 4
    superelement = Superelement(mass=np.eye(size), stiffness=np.eye(size), boundary_nodes=nodes)
    displacement = np.random.default_rng(2).standard_normal((mesh.n_nodes, 3))
    unknowns = np.append(displacement[nodes].ravel(), np.ones(4))
    operator = pairs.operator(superelement)
    assert operator.shape == (330, size)
    np.testing.assert_allclose(operator @ unknowns, pairs.mesh_operator(mesh.n_nodes) @ displacement.ravel())


def test_operator_names_a_node_that_was_reduced_away(pairs: FacePairs) -> None:
    superelement = Superelement(np.eye(6), np.eye(6), boundary_nodes=pairs.nodes[:2])
    with rejects(InputError):
        pairs.operator(superelement)


def test_quadratic_faces_keep_area_and_pairs(mesh: Mesh) -> None:
    pairs = pair_faces(mesh.quadratic(), "damper_right_face", "right_face")
    assert pairs.n_pairs == 11 * 5 + 10 * 5 + 11 * 4
    assert pairs.area.min() > 0.0
    assert pairs.area.sum() == pytest.approx(182e-6, rel=1e-12)
    np.testing.assert_allclose(pairs.normal, np.tile([0.5, 0.0, np.sqrt(0.75)], (pairs.n_pairs, 1)), atol=1e-12)


def test_a_face_that_looks_along_z_gets_tangents_along_x_and_y() -> None:
    pairs = pair_faces(two_cubes(), "lower", "upper")
    np.testing.assert_allclose(pairs.normal, np.tile([0.0, 0.0, 1.0], (4, 1)), atol=1e-12)
    np.testing.assert_allclose(pairs.tangent1, np.tile([1.0, 0.0, 0.0], (4, 1)), atol=1e-12)
    np.testing.assert_allclose(pairs.tangent2, np.tile([0.0, 1.0, 0.0], (4, 1)), atol=1e-12)
    np.testing.assert_allclose(pairs.area, 0.25)


def test_springs_follow_the_areas(pairs: FacePairs) -> None:
    springs = pairs.springs(normal_per_area=1e14, tangential_per_area=8e13).reshape(-1, 3)
    np.testing.assert_allclose(springs, pairs.area[:, None] * [8e13, 8e13, 1e14])
    with rejects(InputError, "normal_per_area"):
        pairs.springs(0.0, 1.0)


def test_concatenate_numbers_the_faces_on(left: FacePairs) -> None:
    three = FacePairs.concatenate([FacePairs.concatenate([left, left]), left])
    np.testing.assert_array_equal(three.face, np.repeat([0, 1, 2], left.n_pairs))
    with rejects(InputError):
        FacePairs.concatenate([])


def test_a_missing_set_is_named_with_those_that_exist(mesh: Mesh) -> None:
    with rejects(InputError):
        pair_faces(mesh, "damper_face", "left_face")
    with rejects(InputError):
        pair_faces(mesh, "damper_left_face", "face")


def test_an_empty_set_is_named(mesh: Mesh) -> None:
    empty = replace(mesh, node_sets={**mesh.node_sets, "left_face": np.array([], dtype=int)})
    with rejects(InputError):
        pair_faces(empty, "damper_left_face", "left_face")


@pytest.mark.parametrize("arguments", [{"gap": 1e-3}, {"shift": 0.1}])
def test_nodes_without_partner_are_named(arguments: dict[str, float]) -> None:
    with rejects(InputError):
        pair_faces(two_cubes(**arguments), "lower", "upper")


def test_a_larger_tolerance_bridges_a_gap() -> None:
    assert pair_faces(two_cubes(gap=1e-3), "lower", "upper", tolerance=2e-3).n_pairs == 4


def test_a_node_too_many_on_the_first_side_is_found() -> None:
    with rejects(InputError):
        pair_faces(two_cubes(), "whole", "upper")


def test_a_node_too_few_on_the_first_side_is_found() -> None:
    with rejects(InputError):
        pair_faces(two_cubes(), "corner", "upper")


def test_sides_of_a_joint_must_not_share_nodes() -> None:
    with rejects(InputError, "first", "second"):
        pair_faces(two_cubes(), "lower", "lower")


def test_tolerance_must_be_positive() -> None:
    with rejects(InputError, "tolerance"):
        pair_faces(two_cubes(), "lower", "upper", tolerance=0.0)
