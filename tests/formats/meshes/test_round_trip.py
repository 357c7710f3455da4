"""A block in two bodies, written to each format and read back: the same volumes, masses, sets and frequencies."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from model_writers import STEEL_MM, write_bdf, write_inp, write_meshio, write_parts
from stickslip.formats.meshes.read import read_model
from stickslip.structure.elasticity import Material, assemble, assemble_bodies, natural_frequencies
from stickslip.structure.faces import face_geometry
from stickslip.structure.mesh import Mesh
from stickslip.structure.model_facts import body_volumes
from universal_writer import write_unv

STEEL = Material(1e6 * STEEL_MM[0], STEEL_MM[1], 1e12 * STEEL_MM[2])
BODIES = ["lower", "upper"]
WRITERS: dict[str, tuple[str, Callable[..., None], tuple[Any, ...]]] = {
    "inp": ("model.inp", write_inp, ()),
    "inp with parts": ("model.inp", write_parts, ()),
    "small fields": ("model.bdf", write_bdf, (False,)),
    "large fields": ("model.nas", write_bdf, (True,)),
    "gmsh text": ("model.msh", write_meshio, ("gmsh22",)),
    "gmsh binary": ("model.msh", write_meshio, ("gmsh22b",)),
    "universal": ("model.unv", write_unv, ()),
    "vtk 5.1": ("model.vtk", write_meshio, ("vtk",)),
    "vtk 4.2": ("model.vtk", write_meshio, ("vtk42",)),
    "vtu": ("model.vtu", write_meshio, ("vtu",)),
    "med": ("model.med", write_meshio, ("med",)),
}


def two_bodies(make_block: Callable[..., Mesh], quadratic: bool) -> Mesh:
    """Two blocks one above the other, with nodes of their own where they touch."""
    lower = make_block((3, 2, 1), (0.06, 0.03, 0.01), 0.1)
    (bricks,) = lower.blocks
    cells = np.vstack([bricks.cells, bricks.cells + lower.n_nodes])
    points = np.vstack([lower.points, lower.points + np.array([0.0, 0.0, 0.02])])
    grid = np.arange(lower.n_nodes).reshape(4, 3, 2)
    sets = {
        "base": grid[:, :, 0].ravel(),
        "contact": grid[:, :, 1].ravel(),
        "opposite": lower.n_nodes + grid[:, :, 0].ravel(),
        "tip": np.array([2 * lower.n_nodes - 1]),
    }
    mesh = Mesh(points, cells, np.repeat([0, 1], len(lower.cells)), sets)
    return in_order_of_bodies(mesh.quadratic()) if quadratic else mesh


def in_order_of_bodies(mesh: Mesh) -> Mesh:
    """The mesh with the nodes of the first body before those of the second, as a deck with parts has them."""
    order = np.concatenate([np.unique(mesh.cells[mesh.body == body]) for body in (0, 1)])
    number = np.argsort(order)
    sets = {name: number[nodes] for name, nodes in mesh.node_sets.items()}
    return replace(mesh, points=mesh.points[order], cells=number[mesh.cells], node_sets=sets)


@pytest.mark.long
@pytest.mark.parametrize("quadratic", [False, True], ids=["linear", "quadratic"])
@pytest.mark.parametrize("name", WRITERS)
def test_a_model_comes_back(tmp_path: Path, make_block: Callable[..., Mesh], name: str, quadratic: bool) -> None:
    mesh = two_bodies(make_block, quadratic)
    file, write, options = WRITERS[name]
    path = tmp_path / file
    clamped = () if write in (write_meshio, write_unv) else ("base",)
    write(path, mesh, BODIES, ["contact", "opposite"], *clamped, *options)
    model = read_model(path, "mm")

    actual = model.mesh
    np.testing.assert_allclose(actual.points, mesh.points, atol=1e-12)
    assert actual.body_names == tuple(BODIES)
    reference = assemble(mesh, STEEL, "serendipity" if quadratic else "incompatible", mesh.node_sets["base"])
    volume = reference_volumes(mesh, quadratic)
    np.testing.assert_allclose(body_volumes(actual), volume, rtol=1e-9)
    for face in ("contact", "opposite"):
        np.testing.assert_array_equal(np.sort(actual.node_set(face)), np.sort(mesh.node_set(face)))
        nodes, area, normal = face_geometry(actual, face)
        wanted_nodes, wanted_area, wanted_normal = face_geometry(mesh, face)
        order, wanted = np.argsort(nodes), np.argsort(wanted_nodes)
        np.testing.assert_allclose(area[order], wanted_area[wanted], rtol=1e-6)
        np.testing.assert_allclose(normal[order], wanted_normal[wanted], atol=1e-6)
    fixed = model.fixed_unknowns
    if clamped:
        for body in BODIES:
            assert vars(model.materials[body]) == pytest.approx(vars(STEEL))
        assert set(np.unique(fixed // 3)) == set(mesh.node_sets["base"])
        assert fixed.size == 3 * mesh.node_sets["base"].size
    else:
        fixed = (3 * mesh.node_sets["base"][:, None] + np.arange(3)).ravel()
        assert model.materials == {}
    structure = assemble_bodies(actual, [STEEL, STEEL], fixed_unknowns=fixed)
    frequency_hz, _ = natural_frequencies(structure.stiffness, structure.mass, 12)
    wanted_hz, _ = natural_frequencies(reference.stiffness, reference.mass, 12)
    np.testing.assert_allclose(frequency_hz[6:], wanted_hz[6:], rtol=1e-6)
    assert frequency_hz[5] < 1e-2 * frequency_hz[6]


def reference_volumes(mesh: Mesh, quadratic: bool) -> list[float]:
    structure = assemble(mesh, STEEL, "serendipity" if quadratic else "incompatible", fixed_nodes=[])
    answer = []
    for body in (0, 1):
        motion = np.zeros(3 * mesh.n_nodes)
        motion[3 * np.unique(mesh.cells[mesh.body == body])] = 1.0
        answer.append(motion @ structure.mass @ motion / STEEL.density)
    return answer


def test_named_node_sets_come_back(tmp_path: Path, make_block: Callable[..., Mesh]) -> None:
    mesh = two_bodies(make_block, False)
    write_inp(tmp_path / "model.inp", mesh, BODIES, ["contact"], "base")
    write_meshio(tmp_path / "model.vtu", mesh, BODIES, ["contact"], "vtu")
    for name in ("model.inp", "model.vtu"):
        actual = read_model(tmp_path / name, "mm").mesh
        for each in ("tip", "base"):
            np.testing.assert_array_equal(actual.node_set(each), mesh.node_set(each))
