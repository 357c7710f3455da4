"""The outer surface as polygons: counts, contact, and coarser surfaces that keep shape, bodies and contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sentences import rejects
from solid_cells import CORNERS, PARTS
from stickslip.core.errors import InputError
from stickslip.structure.mesh import Mesh
from stickslip.structure.outer_surface import OuterSurface, coarsened, outer_surface


def row_of_bricks(count: int, part: str = "hexahedron") -> Mesh:
    """Bricks of 2 x 2 x 2 m side by side along x, cut into cells; face sets "left" and "top", two bodies."""
    points = np.unique(np.vstack([CORNERS + np.array([2.0 * i, 0.0, 0.0]) for i in range(count)]), axis=0)
    place = {tuple(point): number for number, point in enumerate(points)}
    bricks = [[place[tuple(corner + np.array([2.0 * i, 0.0, 0.0]))] for corner in CORNERS] for i in range(count)]
    cells = np.array([[brick[at] for at in cell] for brick in bricks for cell in PARTS[part]])
    body = np.repeat(np.arange(count) >= 1, len(PARTS[part])).astype(np.int64)
    sets = {"left": np.flatnonzero(points[:, 0] < -0.5), "top": np.flatnonzero(points[:, 2] > 0.5)}
    names = ("first", "second")[: body.max() + 1]
    return Mesh(points, cells, body, sets, names)


def areas(surface: OuterSurface) -> np.ndarray:
    """(m, 3) area vectors of the sides."""
    corner = surface.points[surface.sides]
    return 0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])


@pytest.mark.parametrize(("part", "per_square"), [("hexahedron", 1), ("tetra", 2)])
def test_sides_of_two_bricks(part: str, per_square: int) -> None:
    surface = outer_surface(row_of_bricks(2, part))
    assert len(surface.sides) == 10 * per_square
    assert np.bincount(surface.body).tolist() == [5 * per_square] * 2
    vectors = areas(surface)
    assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(40.0)
    assert vectors.sum(axis=0) == pytest.approx([0.0, 0.0, 0.0])  # closed
    middle = surface.points[surface.sides].mean(axis=1)
    outwards = middle - np.array([1.0, 0.0, 0.0])
    assert (np.einsum("ij,ij->i", vectors, outwards) > 0.0).all()
    assert (surface.face == -1).all()


def test_wedges_have_triangles_and_squares() -> None:
    mixed = outer_surface(row_of_bricks(2, "wedge"))
    triangles = mixed.sides[:, 2] == mixed.sides[:, 3]
    assert (triangles.sum(), (~triangles).sum()) == (8, 6)
    assert np.linalg.norm(areas(mixed), axis=1).sum() == pytest.approx(40.0)


@pytest.mark.parametrize("part", ["hexahedron", "tetra", "wedge"])
def test_contact_is_where_the_sets_are_and_pairs_carry(part: str) -> None:
    mesh = row_of_bricks(2, part)
    everywhere = np.arange(mesh.n_nodes)
    of_first = mesh.nodes_of_body(0)
    surface = outer_surface(mesh, (("left",), ("top",)), (everywhere, of_first))
    middle = surface.points[surface.sides].mean(axis=1)
    corner = surface.points[surface.sides]
    assert ((surface.face == 0) == (corner[:, :, 0] == -1.0).all(axis=1)).all()
    assert ((surface.face == 1) == ((corner[:, :, 2] == 1.0).all(axis=1) & (middle[:, 0] < 1.0))).all()
    assert (surface.face == 1).any()


def test_midside_nodes_are_left_out() -> None:
    linear = Mesh(0.5 * CORNERS, np.arange(8)[None], node_sets={"all": np.arange(8)})
    both = [outer_surface(mesh, (("all",),), (np.arange(99),)) for mesh in (linear, linear.quadratic())]
    assert both[0].points == pytest.approx(both[1].points)
    np.testing.assert_array_equal(both[0].sides, both[1].sides)
    assert (both[1].face == 0).all()


def test_a_set_that_is_missing_is_rejected() -> None:
    with rejects(InputError):
        outer_surface(row_of_bricks(1, "hexahedron"), (("nowhere",),), (np.arange(4),))


def plate(count: int) -> OuterSurface:
    """The six sides of a plate of 1 x 1 x 0.1 m with ``count`` x ``count`` sides above and below; a contact patch."""
    line = np.linspace(0.0, 1.0, count + 1)
    points = np.array([[x, y, z] for z in (0.0, 0.1) for x in line for y in line])
    number = np.arange(len(points)).reshape(2, count + 1, count + 1)
    ring = [number[:, :, 0], number[:, ::-1, -1], number[:, 0, ::-1], number[:, -1, :]]
    square = [
        np.stack([n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]], axis=-1).reshape(-1, 4)
        for n in (number[0], number[1].T, *ring)
    ]
    sides = np.concatenate(square)
    top = np.arange(count**2, 2 * count**2)
    face = np.full(len(sides), -1)
    middle = points[sides].mean(axis=1)
    face[top[(np.abs(middle[top, :2] - 0.5) < 0.05).all(axis=1)]] = 0
    return OuterSurface(points, sides, np.zeros(len(sides), dtype=np.int64), face, np.arange(len(points)))


def test_few_sides_stay_as_they_are() -> None:
    surface = plate(10)
    assert coarsened(surface, 1000) is surface


@pytest.mark.slow
@pytest.mark.parametrize("most", [1500, 3000])
def test_a_coarser_surface_keeps_its_shape_and_its_contact(most: int) -> None:
    fine = plate(150)
    coarse = coarsened(fine, most)
    assert most / 4 < len(coarse.sides) <= most
    assert np.linalg.norm(areas(coarse), axis=1).sum() == pytest.approx(2.4, rel=0.02)
    assert areas(coarse).sum(axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)  # no cracks
    assert coarse.points.min(axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert coarse.points.max(axis=0) == pytest.approx([1.0, 1.0, 0.1], abs=1e-12)
    patch = areas(coarse)[coarse.face == 0]
    assert patch.sum(axis=0) == pytest.approx([0.0, 0.0, 0.01], rel=0.35, abs=1e-4)
    np.testing.assert_array_equal(np.unique(coarse.sides), np.arange(len(coarse.points)))
    np.testing.assert_array_equal(coarse.points, fine.points[coarse.node])


@pytest.mark.slow
def test_the_contact_stays_fine_where_the_rest_becomes_coarse() -> None:
    coarse = coarsened(plate(150), 3000)
    size = np.linalg.norm(areas(coarse), axis=1)
    assert np.median(size[coarse.face == 0]) < 0.25 * np.median(size[coarse.face == -1])


def test_bodies_that_touch_stay_apart() -> None:
    fine = plate(60)
    two = replace(fine, body=(fine.points[fine.sides].mean(axis=1)[:, 0] > 0.5).astype(np.int64))
    coarse = coarsened(two, 600)
    middle = coarse.points[coarse.sides].mean(axis=1)[:, 0]
    assert set(coarse.body) == {0, 1}
    assert middle[coarse.body == 0].max() < 0.56
    assert middle[coarse.body == 1].min() > 0.44
