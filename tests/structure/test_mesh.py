import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from sentences import rejects
from solid_cells import CORNERS
from stickslip.core.errors import InputError
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Material, assemble
from stickslip.structure.mesh import Mesh
from structure_fixtures import brick_block

CUBE = (CORNERS + 1) / 2
CELL = np.arange(8)[None]


@pytest.mark.parametrize(
    ("points", "cells", "keys"),
    [
        (CUBE[:, :2], CELL, ("points",)),
        (np.where(CUBE == 1, np.nan, CUBE), CELL, ("points",)),
        (CUBE, CELL[:, :7], ("cells",)),
        (CUBE, CELL[:, [0, 1, 2, 4, 5, 6]], ("cells",)),
        (CUBE, CELL.astype(float), ("cells",)),
        (CUBE, CELL + 1, ("cells",)),
        (CUBE, CELL[:, [1, 0, 3, 2, 5, 4, 7, 6]], ()),
        (CUBE * [1, 1, 0], CELL, ()),
    ],
)
def test_unusable_mesh_is_rejected(points: np.ndarray, cells: np.ndarray, keys: tuple[str, ...]) -> None:
    with rejects(InputError, *keys):
        Mesh(points, cells)


def test_one_collapsed_corner_is_found() -> None:
    points = CUBE.copy()
    points[6] = [0.2, 0.2, 0.2]
    with rejects(InputError):
        Mesh(points, CELL)


def test_body_and_sets_are_checked() -> None:
    with rejects(InputError, "body"):
        Mesh(CUBE, CELL, body=np.zeros(2, dtype=int))
    with rejects(InputError):
        Mesh(CUBE, CELL, node_sets={"top": np.array([99])})


def test_one_class_holds_bricks_and_cells_of_several_kinds() -> None:
    """A brick with a pyramid of two tetrahedra on it; what needs bricks says so."""
    points = np.vstack([CUBE, [[0.5, 0.5, 2.0]]])
    roof = np.array([[4, 5, 6, 8], [4, 6, 7, 8]])
    mesh = Mesh(points, (CELL, roof), body=np.array([0, 1, 1]), body_names=("house", "roof"))
    assert [(block.kind, len(block.cells), block.body.tolist()) for block in mesh.blocks] == [
        ("hexahedron", 1, [0]),
        ("tetra", 2, [1, 1]),
    ]
    assert mesh.nodes_of_body(1).tolist() == [4, 5, 6, 7, 8]
    assert repr(mesh) == "Mesh(9 nodes, 3 cells (hexahedron, tetra) in 2 bodies; node sets: none)"
    for brick in (lambda: assemble(mesh, Material()), mesh.quadratic):
        with rejects(InputError):
            brick()
    with rejects(InputError):
        dataclasses.replace(Mesh(CUBE, CELL), face_sets={"top": (np.array([[4, 5, 6, 7]]),)}).quadratic()
    with rejects(InputError, "body"):
        dataclasses.replace(mesh, body_names=("house", "roof", "cellar"))


def test_missing_and_empty_set_name_what_exists() -> None:
    mesh = Mesh(CUBE, CELL, node_sets={"top": np.arange(4, 8), "none": np.array([], dtype=int)})
    with rejects(InputError):
        mesh.node_set("bottom")
    with rejects(InputError):
        mesh.node_set("none")


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("end", [0.0, 1.0])
def test_sides_look_outward(axis: int, end: float) -> None:
    mesh = Mesh(CUBE, CELL, node_sets={"side": np.flatnonzero(CUBE[:, axis] == end)})
    for whole in (mesh, mesh.quadratic()):
        ((side,),) = whole.sides("side")
        corner = whole.points[side[:4]]
        outward = np.zeros(3)
        outward[axis] = 1.0 if end else -1.0
        np.testing.assert_allclose(np.cross(corner[1] - corner[0], corner[2] - corner[1]), outward)
        middle = 0.5 * (corner + np.roll(corner, -1, axis=0))
        np.testing.assert_allclose(whole.points[side[4:]], middle[: len(side) - 4])


def test_sides_inside_a_body_are_left_out(make_block: Callable[..., Mesh]) -> None:
    block = make_block((2, 1, 1), (2.0, 1.0, 1.0))
    mesh = Mesh(block.points, block.cells, node_sets={"all": np.arange(block.n_nodes)})
    assert len(mesh.sides("all")[0]) == 10


def test_a_set_without_a_whole_side_is_rejected() -> None:
    mesh = Mesh(CUBE, CELL, node_sets={"edge": np.array([0, 1])})
    with rejects(InputError):
        mesh.sides("edge")


def test_quadratic_adds_shared_edge_nodes(make_block: Callable[..., Mesh]) -> None:
    block = make_block((2, 3, 4), (1.0, 1.0, 1.0), 0.2)
    quadratic = block.quadratic()
    n_edges = 2 * 4 * 5 + 3 * 3 * 5 + 3 * 4 * 4
    assert quadratic.n_nodes == block.n_nodes + n_edges
    np.testing.assert_array_equal(quadratic.points[: block.n_nodes], block.points)
    assert quadratic.quadratic() is quadratic


def test_one_line_shows_what_a_mesh_and_what_follows_from_it_are() -> None:
    block = brick_block((2, 1, 1), (2.0, 1.0, 1.0))
    assert repr(block) == "Mesh(12 nodes, 2 cells (hexahedron) in 1 body; node sets: all)"
    many = dataclasses.replace(block, node_sets={f"set {i}": np.array([i]) for i in range(9)})
    assert repr(many).endswith("node sets: set 0, set 1, set 2, set 3, set 4, set 5 and 3 more)")
    structure = assemble(block, Material(), "trilinear", fixed_nodes=np.arange(4))
    assert repr(structure) == "Structure(24 unknowns of 12 nodes, 4 of them fixed; element trilinear)"
    superelement = craig_bampton(structure, [10, 11], n_modes=3)
    assert repr(superelement) == "Superelement(9 unknowns: 2 boundary nodes and 3 other unknowns; no damping matrix)"
    faces = dataclasses.replace(block, face_sets={"end": block.sides("all")})
    assert repr(faces) == "Mesh(12 nodes, 2 cells (hexahedron) in 1 body; node sets: all, end; face sets: end)"
