from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from sentences import rejects
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.errors import InputError
from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import Mesh
from stickslip.structure.shapes import consistent_mass


def test_default_counts(blade_mesh: Mesh) -> None:
    assert blade_mesh.n_nodes == 5005
    np.testing.assert_array_equal(np.bincount(blade_mesh.body), [1560, 1560, 240])
    assert {name: len(nodes) for name, nodes in blade_mesh.node_sets.items()} == {
        "fixed": 88,
        "left_face": 55,
        "right_face": 55,
        "damper_left_face": 55,
        "damper_right_face": 55,
        "excitation_left": 1,
        "excitation_right": 1,
        "response": 1,
        "damper_front_edge": 5,
        "damper_back_edge": 5,
        "damper_left_mid": 1,
        "damper_right_mid": 1,
    }


def test_equals_the_reference_mesh_node_by_node(blade_mesh: Mesh, reference_mesh: dict[str, np.ndarray]) -> None:
    reference_number = np.full(blade_mesh.n_nodes, -1)
    for body in range(3):
        nodes = np.unique(blade_mesh.cells[blade_mesh.body == body])
        reference_nodes = np.unique(reference_mesh["hexahedra"][reference_mesh["body"] == body])
        distance, partner = cKDTree(reference_mesh["points_m"][reference_nodes]).query(blade_mesh.points[nodes])
        assert distance.max() < 1e-12
        reference_number[nodes] = reference_nodes[partner]
    assert len(np.unique(reference_number)) == blade_mesh.n_nodes

    def rows(cells: np.ndarray, body: np.ndarray) -> set[tuple[int, ...]]:
        return {(*map(int, cell), int(number)) for cell, number in zip(cells, body, strict=True)}

    mine = rows(reference_number[blade_mesh.cells], blade_mesh.body)
    assert mine == rows(reference_mesh["hexahedra"], reference_mesh["body"])
    fixed = np.sort(reference_number[blade_mesh.node_set("fixed")])
    np.testing.assert_array_equal(fixed, np.sort(reference_mesh["fixed_nodes"]))


def test_named_points(blade_mesh: Mesh) -> None:
    outer, middle = 31.72916512459885e-3, 3.314582562299425e-3
    expected = {
        "excitation_left": (-outer, 0.0, 3.67e-3),
        "excitation_right": (outer, 0.0, 3.67e-3),
        "response": (-outer, 0.0, 145.0e-3),
        "damper_left_mid": (-middle, 0.0, 38.325e-3),
        "damper_right_mid": (middle, 0.0, 38.325e-3),
    }
    for name, point in expected.items():
        np.testing.assert_allclose(blade_mesh.points[blade_mesh.node_set(name)[0]], point, atol=1e-12)


@pytest.mark.slow
def test_masses_of_the_inferred_parts(blade_mesh: Mesh) -> None:
    mass = consistent_mass(blade_mesh.points[blade_mesh.cells], Material().density).sum(axis=(1, 2))
    np.testing.assert_allclose(1e3 * np.bincount(blade_mesh.body, mass), [303.9, 303.9, 11.4], atol=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("asked", "found"), [(1e-9, 3.67), (5.0e-3, 3.67), (18.0e-3, 18.35), (36.6e-3, 36.7)])
def test_excitation_height_moves_to_the_nearest_node(asked: float, found: float) -> None:
    mesh = blade_pair_mesh(BladePairGeometry(excitation_height=asked))
    for name in ("excitation_left", "excitation_right"):
        assert mesh.points[mesh.node_set(name)[0], 2] == pytest.approx(1e-3 * found)


@pytest.mark.parametrize("name", [item.name for item in fields(BladePairGeometry)])
@pytest.mark.parametrize("value", [0.0, -1.0e-3, np.nan, np.inf, "28 mm", True])
def test_a_bad_dimension_is_named(name: str, value: Any) -> None:
    with rejects(InputError, name):
        BladePairGeometry(**{name: value})


@pytest.mark.parametrize("name", [item.name for item in fields(BladePairElements)])
@pytest.mark.parametrize("value", [0, -2, 1.5, True])
def test_a_bad_element_count_is_named(name: str, value: Any) -> None:
    with rejects(InputError, name):
        BladePairElements(**{name: value})


UNDER_PLATFORM = (
    "underside_height_at_shank",
    "contact_face_width",
    "platform_angle_deg",
    "platform_edge_thickness",
    "blade_length",
)


@pytest.mark.parametrize(
    ("change", "keys"),
    [
        ({"platform_angle_deg": 90.0}, ("platform_angle_deg",)),
        (
            {"damper_length": 29.0e-3},
            ("damper_length", "width"),
        ),
        (
            {"damper_flank_height": 40.0e-3},
            ("damper_flank_height", "underside_height_at_shank"),
        ),
        (
            {"airfoil_thickness": 26.0e-3},
            ("airfoil_thickness", "shank_thickness_at_platform", "inner_overhang"),
        ),
        (
            {"shank_thickness_at_base": 400.0e-3},
            ("shank_thickness_at_base", "shank_thickness_at_platform", "inner_overhang"),
        ),
        (
            {"blade_length": 40.0e-3},
            UNDER_PLATFORM,
        ),
        (
            {"platform_edge_thickness": 200.0e-3},
            UNDER_PLATFORM,
        ),
        (
            {"excitation_height": 100.0e-3},
            ("excitation_height", "underside_height_at_shank"),
        ),
    ],
)
def test_parts_that_do_not_fit_are_named(change: dict[str, Any], keys: tuple[str, ...]) -> None:
    with rejects(InputError, *keys):
        BladePairGeometry(**change)


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        {"platform_angle_deg": 60.0},
        {"platform_angle_deg": 5.0},
        {"damper_length": 20.0e-3},
        {"shank_thickness_at_base": 25.0e-3},
        {"airfoil_thickness": 20.0e-3},
        {"platform_gap": 8.0e-3},
    ],
)
def test_other_shapes_keep_their_pairs(change: dict[str, Any], pairs_of: Callable[[Mesh], FacePairs]) -> None:
    geometry = BladePairGeometry(**change)
    pairs = pairs_of(blade_pair_mesh(geometry))
    assert pairs.area.sum() == pytest.approx(2 * geometry.contact_face_width * geometry.damper_length)
    np.testing.assert_allclose(pairs.normal[:, 2], np.cos(np.radians(geometry.platform_angle_deg)), atol=1e-12)


def test_every_count_reaches_the_mesh(pairs_of: Callable[[Mesh], FacePairs]) -> None:
    counts = BladePairElements(
        shank_columns=2,
        shank_rows=7,
        platform_rows=3,
        airfoil_rows=11,
        inner_columns=1,
        contact_columns=5,
        chordwise=3,
        beyond_damper=2,
        damper_columns=6,
        damper_flank_rows=1,
    )
    geometry = BladePairGeometry(damper_length=22.0e-3)
    mesh = blade_pair_mesh(geometry, counts)
    blade = (2 * (7 + 3 + 11) + (1 + 5) * 3) * (3 + 2 * 2)
    np.testing.assert_array_equal(np.bincount(mesh.body), [blade, blade, 6 * (1 + 5) * 3])
    assert pairs_of(mesh).n_pairs == 2 * (5 + 1) * (3 + 1)
    np.testing.assert_allclose(np.ptp(mesh.points[mesh.cells[mesh.body == 0]], axis=(0, 1))[1], geometry.width)


def test_lengths_equal_to_round_off_leave_no_sliver() -> None:
    geometry = BladePairGeometry()
    nearly = replace(geometry, damper_length=geometry.width * (1 + 1e-15))
    assert blade_pair_mesh(nearly).n_nodes == 5005


@pytest.mark.parametrize(
    "geometry",
    [
        BladePairGeometry(shank_thickness_at_platform=1.8e-7),
        BladePairGeometry(airfoil_thickness=2.5e-7),
        BladePairGeometry(platform_edge_thickness=9e-9),
    ],
)
def test_elements_too_thin_to_solve_are_rejected(geometry: BladePairGeometry) -> None:
    """Their eigenvalues took minutes, or did not converge."""
    with rejects(InputError):
        blade_pair_mesh(geometry)
