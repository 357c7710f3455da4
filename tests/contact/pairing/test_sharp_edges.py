"""A face set with all sides of a solid has the same pairs as the set of its touching sides."""

from dataclasses import replace

import numpy as np
import pytest
from touching_blocks import pin_in_bore, stacked

from stickslip.contact.pairing.pairing import Points, pair_surfaces
from stickslip.contact.pairing.surface_mesh import SurfaceMesh
from stickslip.structure.mesh import IntArray, Mesh

OTHER_SIDES = "on other sides of the body, round a sharp edge"


def _with_whole_bodies(mesh: Mesh) -> Mesh:
    """Sets "lower body" and "upper body" with the nodes of all free sides of the two blocks."""

    def outside(body: int) -> IntArray:
        nodes = mesh.nodes_of_body(body)
        points = mesh.points[nodes]
        on_border = np.isclose(points, points.min(axis=0)) | np.isclose(points, points.max(axis=0))
        return np.asarray(nodes[on_border.any(axis=1)])

    whole = {"lower body": outside(0), "upper body": outside(1)}
    return replace(mesh, node_sets={**mesh.node_sets, **whole})


@pytest.mark.slow
@pytest.mark.parametrize("points", ["nodes", "quadrature"])
def test_all_sides_of_a_solid_pair_like_its_touching_side(points: Points) -> None:
    mesh = _with_whole_bodies(stacked(offset=(0.25, 0.0, 0.0)))
    plain = pair_surfaces(mesh, "bottom", "top", points=points)
    whole = pair_surfaces(mesh, "upper body", "lower body", points=points)
    order = [np.lexsort(np.round(each.pairs.points, 9).T) for each in (plain, whole)]
    for name in ("points", "normal", "area"):
        expected, found = (getattr(each.pairs, name)[at] for each, at in zip((plain, whole), order, strict=True))
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12)
    assert whole.facet_height == 0.0  # no 1e-33 in the table
    assert whole.first_area == pytest.approx(2.0 + 4 * 0.5)  # 1 x 1 x 0.5 m
    assert whole.pairs.area.sum() + whole.unpaired_first.area.sum() == pytest.approx(whole.first_area)


@pytest.mark.slow
def test_the_other_sides_are_listed_without_a_warning() -> None:
    mesh = _with_whole_bodies(stacked())
    pairing = pair_surfaces(mesh, "upper body", "lower body")
    assert set(pairing.unpaired_first.reasons) == set(pairing.unpaired_second.reasons) == {OTHER_SIDES}
    assert not [warning for warning in pairing.warnings if "no partner" in warning]


@pytest.mark.slow
def test_an_overhang_of_the_touching_side_is_still_a_warning() -> None:
    mesh = _with_whole_bodies(stacked(offset=(0.25, 0.0, 0.0)))
    (warning,) = [each for each in pair_surfaces(mesh, "upper body", "lower body").warnings if "no partner" in each]
    assert OTHER_SIDES not in warning
    assert "beyond the edge" in warning


def test_a_round_face_is_one_part_and_a_box_six() -> None:
    assert SurfaceMesh.of(pin_in_bore((12, 3), (16, 4)), "top").smooth_parts.max() == 0
    assert SurfaceMesh.of(_with_whole_bodies(stacked()), "upper body").smooth_parts.max() == 5
