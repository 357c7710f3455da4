"""Faces whose meshes do not match: areas, gaps, directions, what stays unpaired, wrong inputs."""

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import meshio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from touching_blocks import Options, block, moved, pin_in_bore, stacked, two_bodies

from sentences import printed_sentence, rejects
from stickslip.contact.pairing.pairing import FacePairs, pair_faces, pair_surfaces, pair_with_ground, write_pairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.mesh import Mesh

BOTH = pytest.mark.parametrize("points", ["nodes", "quadrature"])
KINDS: dict[str, Options] = {
    "bricks": {},
    "quadratic bricks": {"quadratic": True},
    "tetrahedra": {"kind": "tetra"},
    "quadratic tetrahedra": {"kind": "tetra", "quadratic": True},
    "distorted": {"distortion": 0.2},
}


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize("upper", KINDS)
@pytest.mark.parametrize("lower", KINDS)
def test_every_kind_of_face_is_covered_once(lower: str, upper: str, points: Literal["nodes", "quadrature"]) -> None:
    mesh = stacked((3, 2, 1), (2, 3, 1), lower_options=KINDS[lower], upper_options=KINDS[upper])
    pairing = pair_surfaces(mesh, "bottom", "top", points=points)
    pairs = pairing.pairs
    assert pairs.area.min() > 0.0
    assert pairs.area.sum() == pytest.approx(1.0, rel=1e-12)
    assert pairing.first_area == pytest.approx(1.0)
    assert pairing.second_area == pytest.approx(1.0)
    np.testing.assert_array_equal(pairs.gap, 0.0)
    np.testing.assert_allclose(pairs.normal, np.tile([0.0, 0.0, -1.0], (pairs.n_pairs, 1)), atol=1e-12)
    np.testing.assert_allclose(pairs.tangent1, np.tile([1.0, 0.0, 0.0], (pairs.n_pairs, 1)), atol=1e-12)
    assert len(pairing.unpaired_first) == len(pairing.unpaired_second) == 0
    # Both sides of a pair are at one place, so any motion linear in the place is no relative motion.
    assert_same_place(mesh, pairs, np.zeros(pairs.n_pairs))


def assert_same_place(mesh: Mesh, pairs: FacePairs, gap: FloatArray) -> None:
    def place(nodes: NDArray[np.int64], weights: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("pk,pkx->px", weights, mesh.points[nodes]))

    np.testing.assert_allclose(place(pairs.first_nodes, pairs.first_weights), pairs.points, atol=1e-12)
    opposite = place(pairs.second_nodes, pairs.second_weights)
    np.testing.assert_allclose(opposite - pairs.points, gap[:, None] * pairs.normal, atol=1e-11)


def test_matching_meshes_give_the_pairs_of_nodes() -> None:
    mesh = stacked((3, 2, 1), (3, 2, 1))
    actual, expected = pair_surfaces(mesh, "bottom", "top").pairs, pair_faces(mesh, "bottom", "top")
    assert actual.is_matching
    np.testing.assert_array_equal(actual.first_node, expected.first_node)
    np.testing.assert_array_equal(actual.second_node, expected.second_node)
    np.testing.assert_allclose(actual.area, expected.area)
    np.testing.assert_array_equal(actual.face_position, expected.face_position)


def test_nodes_of_interpolated_pairs_are_those_with_weight() -> None:
    pairs = pair_surfaces(stacked((1, 1, 1), (2, 1, 1)), "bottom", "top").pairs
    # Upper nodes at x = 0 and 1 meet a node each, those at 0.5 the two ends of an edge.
    np.testing.assert_array_equal(np.bincount(np.count_nonzero(pairs.second_weights, axis=1)), [0, 4, 2])
    assert not pairs.is_matching
    assert len(pairs.nodes) == 6 + 4
    assert (np.diff(pairs.nodes) > 0).all()
    with rejects(InputError):
        _ = pairs.second_node
    assert len(pairs.first_node) == 6


@BOTH
def test_the_gap_is_measured_along_the_normal(points: Literal["nodes", "quadrature"]) -> None:
    mesh = stacked(offset=(0.0, 0.0, 0.003))
    pairing = pair_surfaces(mesh, "bottom", "top", points=points)
    np.testing.assert_allclose(pairing.pairs.gap, 0.003, rtol=1e-10)
    assert pairing.warnings == ()
    assert_same_place(mesh, pairing.pairs, pairing.pairs.gap)


@BOTH
def test_overlap_is_a_negative_gap_and_a_warning(points: Literal["nodes", "quadrature"]) -> None:
    pairing = pair_surfaces(stacked(offset=(0.0, 0.0, -0.003)), "bottom", "top", points=points)
    np.testing.assert_allclose(pairing.pairs.gap, -0.003, rtol=1e-10)
    (warning,) = pairing.warnings
    printed_sentence(warning, f"{pairing.pairs.n_pairs} of {pairing.pairs.n_pairs}", "3 mm")


def test_closed_sets_the_gap_to_zero_and_keeps_what_was_measured() -> None:
    pairing = pair_surfaces(stacked(offset=(0.0, 0.0, -0.003)), "bottom", "top", adjust="closed")
    np.testing.assert_array_equal(pairing.pairs.gap, 0.0)
    np.testing.assert_allclose(pairing.measured_gap, -0.003, rtol=1e-10)
    assert pairing.warnings == ()


def test_a_gap_within_the_tolerance_is_none() -> None:
    mesh = stacked(offset=(0.0, 0.0, 1e-4))
    np.testing.assert_array_equal(pair_surfaces(mesh, "bottom", "top", gap_tolerance=2e-4).pairs.gap, 0.0)
    assert pair_surfaces(mesh, "bottom", "top", gap_tolerance=5e-5).pairs.gap.min() > 0.0


def test_a_tilted_face_has_a_gap_that_grows() -> None:
    mesh = stacked()
    points = mesh.points.copy()
    upper = mesh.nodes_of_body(1)
    points[upper, 2] += 0.01 * points[upper, 0]
    pairing = pair_surfaces(replace(mesh, points=points), "top", "bottom")
    # A ray straight up from (x, y, 0.5) meets z = 0.5 + 0.01 x.
    np.testing.assert_allclose(pairing.pairs.gap, 0.01 * pairing.pairs.points[:, 0], atol=1e-12)


@BOTH
def test_what_hangs_over_stays_unpaired_with_its_area(points: Literal["nodes", "quadrature"]) -> None:
    mesh = stacked((4, 2, 1), (4, 3, 1), offset=(0.3, 0.0, 0.0))
    pairing = pair_surfaces(mesh, "bottom", "top", points=points)
    unpaired = pairing.unpaired_first
    assert set(unpaired.reasons) == {"beyond the edge"}
    assert unpaired.largest_overhang == pytest.approx(0.3)
    # Nodes at x = 1.05 and 1.3 carry 3/8 of the face; the cells know that 0.3 of it hangs over.
    share = 0.375 if points == "nodes" else 0.3
    assert unpaired.area.sum() == pytest.approx(share, rel=1e-9)
    assert pairing.pairs.area.sum() == pytest.approx(1.0 - share, rel=1e-9)
    assert pairing.pairs.points[:, 0].max() < 1.0 + 1e-9
    # Of the lower nodes, x = 0 and x = 0.25 look past the upper block.
    np.testing.assert_allclose(np.unique(pairing.unpaired_second.points[:, 0]), [0.0, 0.25], atol=1e-12)
    assert pairing.unpaired_second.area.sum() == pytest.approx(0.375)
    printed_sentence("\n".join(pairing.warnings), f"({100 * share:.3g} %)", "'top'")


def test_a_point_just_beyond_the_edge_is_paired_within_the_tolerance() -> None:
    mesh = stacked((2, 2, 1), (2, 2, 1), offset=(0.004, 0.0, 0.0))
    pairing = pair_surfaces(mesh, "bottom", "top", edge_tolerance=0.005)
    assert len(pairing.unpaired_first) == 0
    assert pairing.overhang.max() == pytest.approx(0.004)
    assert_same_place(mesh, pairing.pairs, np.zeros(9))  # weights beyond the edge still make the place
    assert len(pair_surfaces(mesh, "bottom", "top", edge_tolerance=0.003).unpaired_first) == 3


def test_too_far_and_not_facing_are_distinguished() -> None:
    with rejects(InputError, "first", "second"):
        pair_surfaces(stacked(offset=(0.0, 0.0, 0.4)), "bottom", "top", search_distance=0.25)
    with rejects(InputError, "first", "second"):
        pair_surfaces(stacked(), "bottom", "base", search_distance=2.0)
    with rejects(InputError, "first", "second"):
        pair_surfaces(stacked(offset=(0.0, 0.0, 0.4)), "bottom", "top", points="quadrature", search_distance=0.25)


def test_of_two_layers_nodes_take_the_nearest_and_cells_reject() -> None:
    mesh = stacked((2, 2, 2), (3, 3, 1))
    # The lower block is cut in two plates: the middle nodes' side of the lower plate lies in the set as well.
    plates = two_bodies(
        block((2, 2, 1), (0.0, 0.0, 0.0), lengths=(1.0, 1.0, 0.1)), block((3, 3, 1), (0.0, 0.0, 0.2), (1.0, 1.0, 0.1))
    )
    shift = plates.n_nodes
    upper = replace(mesh, points=mesh.points - np.array([0.0, 0.0, 0.1]))
    blocks = (*plates.blocks, *(replace(block, cells=block.cells + shift) for block in reversed(upper.blocks)))
    both = np.r_[plates.node_set("top"), plates.node_set("load")]
    third = replace(
        plates,
        points=np.vstack([plates.points, upper.points]),
        cells=tuple(block.cells for block in blocks),
        body=np.concatenate([block.body for block in blocks]),
        node_sets={"layers": both, "bottom": shift + upper.node_set("bottom")},
    )
    pairs = pair_surfaces(third, "bottom", "layers", search_distance=0.4).pairs
    np.testing.assert_allclose(pairs.gap, 0.1, rtol=1e-9)
    with rejects(InputError):
        pair_surfaces(third, "bottom", "layers", points="quadrature", search_distance=0.4)


@pytest.mark.slow
@pytest.mark.parametrize(("pin", "bore"), [(36, 24), (48, 60)])
def test_gaps_of_a_pin_in_a_bore_with_flat_sides(pin: int, bore: int) -> None:
    pairing = pair_surfaces(pin_in_bore((pin, 2), (bore, 3)), "top", "bottom", search_distance=0.05)
    pairs = pairing.pairs
    assert pairs.n_pairs == 3 * pin
    assert len(pairing.unpaired_first) == len(pairing.unpaired_second) == 0
    radial = pairs.points * [1.0, 1.0, 0.0] / 0.5
    np.testing.assert_allclose(pairs.normal, radial, atol=1e-12)  # smoothed: the facets beside a node balance
    angle = np.arctan2(radial[:, 1], radial[:, 0])
    from_middle = (angle + np.pi / bore) % (2.0 * np.pi / bore) - np.pi / bore  # to the nearest node of the bore
    from_middle = np.pi / bore - np.abs(from_middle)
    facet = 0.52 * np.cos(np.pi / bore) / np.cos(from_middle)
    np.testing.assert_allclose(pairs.gap, facet - 0.5, atol=1e-12)
    assert pairs.area.sum() == pytest.approx(2 * pin * 0.5 * np.sin(np.pi / pin))
    # Axes: along the pin, and around it.
    np.testing.assert_allclose(pairs.tangent1, np.tile([0.0, 0.0, 1.0], (pairs.n_pairs, 1)), atol=1e-12)
    np.testing.assert_allclose(np.abs(np.einsum("px,px->p", pairs.tangent2, radial)), 0.0, atol=1e-12)


@pytest.mark.slow
def test_gap_of_an_eccentric_pin() -> None:
    mesh = pin_in_bore((96, 1), (120, 1), centre=(0.01, 0.0))
    pairing = pair_surfaces(mesh, "top", "bottom", points="quadrature", search_distance=0.05)
    pairs = pairing.pairs
    angle = np.arctan2(pairs.normal[:, 1], pairs.normal[:, 0])
    # Clearance 0.02 m less the offset towards the wall; sides stand off both circles by up to 0.0003 m.
    np.testing.assert_allclose(pairs.gap, 0.02 - 0.01 * np.cos(angle), atol=5e-4)
    assert pairs.area.sum() == pytest.approx(pairing.first_area, rel=1e-9)
    assert pairing.facet_height == pytest.approx(0.5 * (np.pi / 96) ** 2 / 2 + 0.52 * (np.pi / 120) ** 2 / 2, rel=0.02)


def test_gaps_that_come_from_flat_sides_alone_are_reported() -> None:
    mesh = pin_in_bore((36, 1), (25, 1), bore_radius=0.5)
    pairing = pair_surfaces(mesh, "top", "bottom")
    assert 0.0 < np.abs(pairing.pairs.gap).max() < pairing.facet_height
    printed_sentence("\n".join(pairing.warnings))
    printed_sentence("\n".join(pair_surfaces(mesh, "top", "bottom", adjust="closed").warnings))


@pytest.mark.long
@BOTH
@settings(max_examples=15, deadline=None)
@given(
    angles=st.tuples(*[st.floats(-3.0, 3.0)] * 3),
    shift=st.tuples(*[st.floats(-5.0, 5.0)] * 3),
    gap=st.floats(-0.01, 0.01),
)
def test_turning_and_shifting_both_bodies_changes_nothing(
    points: Literal["nodes", "quadrature"],
    angles: tuple[float, float, float],
    shift: tuple[float, float, float],
    gap: float,
) -> None:
    mesh = stacked((3, 2, 1), (2, 2, 1), offset=(0.2, 0.1, gap), lower_options={"distortion": 0.1})
    rotation = Rotation.from_euler("xyz", angles).as_matrix()
    tangent = np.array([1.0, 2.0, 0.0])
    still = pair_surfaces(mesh, "bottom", "top", points=points, tangent=tangent).pairs
    pairs = pair_surfaces(
        moved(mesh, rotation, np.array(shift)), "bottom", "top", points=points, tangent=rotation @ tangent
    ).pairs
    # Sides that touch a cell's border may gain or lose slivers by round-off, so sums stand for the cells.
    assert pairs.area.sum() == pytest.approx(still.area.sum(), rel=1e-9)
    np.testing.assert_allclose(pairs.area @ pairs.points, still.area @ (still.points @ rotation.T + shift), atol=1e-8)
    np.testing.assert_allclose(pairs.gap, np.resize(still.gap, pairs.n_pairs), atol=1e-9)
    np.testing.assert_allclose(pairs.normal[0], rotation @ still.normal[0], atol=1e-9)
    np.testing.assert_allclose(pairs.tangent1[0], rotation @ still.tangent1[0], atol=1e-9)
    if points == "nodes":
        np.testing.assert_allclose(pairs.area, still.area, rtol=1e-9)
        np.testing.assert_array_equal(pairs.first_nodes, still.first_nodes)


def test_chosen_tangent_lies_in_the_face() -> None:
    pairs = pair_surfaces(stacked(), "bottom", "top", tangent=(1.0, 1.0, 5.0)).pairs
    np.testing.assert_allclose(pairs.tangent1, np.tile([np.sqrt(0.5), np.sqrt(0.5), 0.0], (20, 1)), atol=1e-12)
    matching = pair_faces(stacked((2, 2, 1), (2, 2, 1)), "bottom", "top", tangent=(0.0, 2.0, 0.0))
    np.testing.assert_allclose(matching.tangent1, np.tile([0.0, 1.0, 0.0], (9, 1)), atol=1e-12)


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"points": "edges"}, "points"),
        ({"adjust": "glued"}, "adjust"),
        ({"search_distance": 0.0}, "search_distance"),
        ({"edge_tolerance": -1.0}, "edge_tolerance"),
        ({"gap_tolerance": np.nan}, "gap_tolerance"),
        ({"tangent": (0.0, 0.0, 2.0)}, "tangent"),
        ({"tangent": (0.0, 0.0, 0.0)}, "tangent"),
        ({"tangent": (1.0, 0.0)}, "tangent"),
    ],
)
def test_wrong_options_are_rejected(options: dict[str, Any], key: str) -> None:
    with rejects(InputError, key):
        pair_surfaces(stacked((1, 1, 1), (2, 1, 1)), "bottom", "top", **options)


def test_wrong_sets_are_rejected() -> None:
    mesh = stacked((1, 1, 1), (2, 1, 1))
    with rejects(InputError, "second"):
        pair_surfaces(mesh, "bottom", "side")
    with rejects(InputError, "first", "second"):
        pair_surfaces(mesh, "bottom", "bottom")
    partly = replace(mesh, node_sets={**mesh.node_sets, "partly": np.r_[mesh.node_set("bottom"), 19]})
    with rejects(InputError, "first"):
        pair_surfaces(partly, "partly", "top")


def test_a_pin_needs_a_tangent_that_no_normal_is_along() -> None:
    with rejects(InputError, "tangent"):
        pair_surfaces(pin_in_bore((36, 1), (24, 1)), "top", "bottom", tangent=(1.0, 0.0, 0.0))


@pytest.mark.slow
def test_warnings_about_the_choice_of_the_first_face() -> None:
    coarse = pair_surfaces(stacked((4, 4, 1), (2, 2, 1)), "bottom", "top")
    printed_sentence("\n".join(coarse.warnings))
    quadratic = pair_surfaces(stacked(upper_options={"quadratic": True}), "bottom", "top")
    printed_sentence("\n".join(quadratic.warnings))
    many = pair_surfaces(stacked((14, 14, 1), (15, 15, 1)), "bottom", "top", points="quadrature")
    printed_sentence("\n".join(many.warnings), "256")


@BOTH
@pytest.mark.parametrize("kind", KINDS)
def test_ground(kind: str, points: Literal["nodes", "quadrature"]) -> None:
    mesh = stacked(upper_options=KINDS[kind])
    pairing = pair_with_ground(mesh, "bottom", points=points, gap=2e-3)
    pairs = pairing.pairs
    assert pairs.area.sum() == pytest.approx(1.0)
    np.testing.assert_array_equal(pairs.gap, 2e-3)
    assert np.isin(pairs.nodes, mesh.node_set("bottom")).all()
    displacement = np.tile([1.0, 2.0, -3.0], mesh.n_nodes)
    relative = (pairs.mesh_operator(mesh.n_nodes) @ displacement).reshape(-1, 3)
    # The body below x, y, -z moves by 3 toward the ground, and the ground does not follow.
    np.testing.assert_allclose(relative, np.tile([1.0, 2.0, 3.0], (pairs.n_pairs, 1)), atol=1e-12)
    with rejects(InputError):
        _ = pairs.second_node
    assert len(pairing.summary()) > 5


def test_wrong_ground_is_rejected() -> None:
    gaps: Any = [0.0, 1.0]
    with rejects(InputError, "gap"):
        pair_with_ground(stacked(), "bottom", gap=gaps)
    wrong: Any = "all"
    with rejects(InputError, "points"):
        pair_with_ground(stacked(), "bottom", points=wrong)


@pytest.mark.slow
def test_interfaces_of_different_kinds_join() -> None:
    mesh = stacked()
    parts = [pair_surfaces(mesh, "bottom", "top", points=points).pairs for points in ("nodes", "quadrature")]
    parts.append(pair_with_ground(mesh, "base").pairs)
    joined = FacePairs.concatenate(parts)
    np.testing.assert_array_equal(joined.face, np.repeat([0, 1, 2], [part.n_pairs for part in parts]))
    expected = np.concatenate([part.mesh_operator(mesh.n_nodes).toarray() for part in parts])
    np.testing.assert_array_equal(joined.mesh_operator(mesh.n_nodes).toarray(), expected)
    np.testing.assert_array_equal(joined.nodes, np.unique(np.concatenate([part.nodes for part in parts])))


def test_summary_shows_tolerances_and_what_is_left() -> None:
    pairing = pair_surfaces(stacked(offset=(0.3, 0.0, 1e-3)), "bottom", "top", search_distance=0.1)
    rows = {label: (value, unit) for label, value, unit in pairing.summary()}
    assert rows["contact pairs"] == (pairing.pairs.n_pairs, "")
    assert rows["largest measured gap"] == (pytest.approx(1.0), "mm")  # type: ignore[unreachable]
    assert rows["tolerance: search distance along the normal"] == (pytest.approx(100.0), "mm")
    assert rows["area of the first face"] == (pytest.approx(1e6), "mm²")
    total = rows["area of the pairs"][0] + rows["area without a partner"][0]
    assert total == pytest.approx(1e6)
    assert rows["largest overhang of positions without a partner"] == (pytest.approx(300.0), "mm")
    assert rows["positions on 'bottom' without a partner"] == (f"{len(pairing.unpaired_first)} beyond the edge", "")


def test_pairs_and_unpaired_places_read_back(tmp_path: Path) -> None:
    mesh = stacked(offset=(0.3, 0.0, 1e-3))
    pairings = [pair_surfaces(mesh, "bottom", "top"), pair_with_ground(mesh, "base")]
    path = write_pairs(tmp_path / "pairs.vtu", pairings)
    actual = meshio.read(path)
    sizes = [pairings[0].pairs.n_pairs, len(pairings[0].unpaired_first), len(pairings[0].unpaired_second), 12]
    data = actual.point_data
    np.testing.assert_array_equal(data["interface"], np.repeat([0, 1], [sum(sizes[:3]), sizes[3]]))
    np.testing.assert_array_equal(data["reason"], np.repeat([0, 1, 1, 0], sizes))
    np.testing.assert_array_equal(data["side"], np.repeat([1, 1, 2, 1], sizes))
    np.testing.assert_allclose(data["gap mm"][: sizes[0]], 1.0)
    np.testing.assert_allclose(actual.points[: sizes[0]], pairings[0].pairs.points)
    assert data["area mm2"].sum() == pytest.approx(1e6 * (1.0 + pairings[0].unpaired_second.area.sum() + 1.0))
    with rejects(InputError):
        write_pairs(tmp_path / "none.vtu", [])
    with rejects(InputError):
        write_pairs(tmp_path / "pairs.txt", pairings)


def test_pairs_check_themselves() -> None:
    pairs = pair_surfaces(stacked(), "bottom", "top").pairs
    for change, keys in (
        ({"gap": pairs.gap[:3]}, ["gap"]),
        ({"area": -pairs.area}, ["area"]),
        ({"first_weights": 2.0 * pairs.first_weights}, ["first_weights"]),
        ({"second_weights": 0.5 * pairs.second_weights}, ["second_weights"]),
        ({"second_nodes": pairs.second_nodes[:, :1]}, ["second_nodes", "second_weights"]),
        ({"tangent1": pairs.normal}, ["normal", "tangent1", "tangent2"]),
    ):
        with rejects(InputError, *keys):
            replace(pairs, **change)
