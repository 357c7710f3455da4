"""Tetrahedra and wedges through each format, and the two-blade mesh written and read back with equal frequencies."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import meshio
import numpy as np
import pytest

from calculix import COARSE, cut_bricks
from model_writers import STEEL_MM, write_bdf, write_inp, write_meshio, write_parts
from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.read import read_model
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.structure.elasticity import Material, assemble, assemble_bodies, natural_frequencies
from stickslip.structure.faces import face_geometry
from stickslip.structure.mesh import Mesh
from stickslip.structure.model_facts import body_volumes

STEEL = Material(1e6 * STEEL_MM[0], STEEL_MM[1], 1e12 * STEEL_MM[2])
WRITERS: dict[str, tuple[str, Callable[..., None], bool]] = {
    "inp": ("model.inp", write_inp, True),
    "inp with parts": ("model.inp", write_parts, True),
    "bdf": ("model.bdf", partial(write_bdf, large=True), True),
    **{
        form: (f"model.{ending}", partial(write_meshio, form=form), False)
        for form, ending in (("gmsh22", "msh"), ("vtu", "vtu"), ("med", "med"))
    },
}
KINDS = ("tetra", "tetra10", "wedge", "wedge15")


def block_of(kind: str, make_block: Callable[..., Mesh]) -> Mesh:
    """A distorted block of 2 x 2 x 1 bricks cut into tetrahedra or wedges, with its lower and upper face."""
    bricks = make_block((2, 2, 1), (0.06, 0.03, 0.01), 0.1)
    grid = np.arange(bricks.n_nodes).reshape(3, 3, 2)
    bricks = replace(bricks, node_sets={"base": grid[:, :, 0].ravel(), "contact": grid[:, :, 1].ravel()})
    return cut_bricks(bricks, kind)


def frequencies(mesh: Mesh, count: int, fixed: np.ndarray) -> FloatArray:
    structure = assemble_bodies(mesh, [STEEL] * len(mesh.body_names), fixed_nodes=fixed)
    return natural_frequencies(structure.stiffness, structure.mass, count)[0]


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("form", WRITERS)
def test_tetrahedra_and_wedges_come_back(tmp_path: Path, make_block: Callable[..., Mesh], kind: str, form: str) -> None:
    mesh = block_of(kind, make_block)
    file, write, holds = WRITERS[form]
    arguments = (tmp_path / file, mesh, ["left"], ["contact"])
    write(*arguments, *(("base",) if holds else ()))
    model = read_model(tmp_path / file, "mm")
    np.testing.assert_allclose(model.mesh.points, mesh.points, atol=1e-12)
    assert [block.kind for block in model.mesh.blocks] == [kind]
    np.testing.assert_allclose(body_volumes(model.mesh), body_volumes(mesh), rtol=1e-9)
    for actual, wanted in zip(face_geometry(model.mesh, "contact"), face_geometry(mesh, "contact"), strict=True):
        order = np.argsort(face_geometry(model.mesh, "contact")[0]), np.argsort(face_geometry(mesh, "contact")[0])
        np.testing.assert_allclose(actual[order[0]], wanted[order[1]], rtol=1e-6, atol=1e-9)
    base = mesh.node_sets["base"]
    if holds:
        assert set(model.fixed_unknowns // 3) == set(base)
    np.testing.assert_allclose(frequencies(model.mesh, 6, base), frequencies(mesh, 6, base), rtol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("form", WRITERS)
def test_the_two_blades_come_back(tmp_path: Path, form: str) -> None:
    mesh = blade_pair_mesh(elements=COARSE)
    file, write, holds = WRITERS[form]
    bodies, faces = ["left", "right", "damper"], ["damper_left_face", "left_face"]
    write(tmp_path / file, mesh, bodies, faces, *(("fixed",) if holds else ()))
    actual = read_model(tmp_path / file, "mm").mesh
    assert actual.body_names == tuple(bodies)
    fixed = mesh.node_sets["fixed"]
    reference = assemble(mesh, STEEL, "incompatible", fixed)
    wanted_hz, _ = natural_frequencies(reference.stiffness, reference.mass, 10)
    found_hz = frequencies(actual, 10, fixed)
    np.testing.assert_allclose(found_hz[6:], wanted_hz[6:], rtol=1e-6)  # the damper is free
    assert found_hz[5] < 1e-2 * found_hz[6]


def two_bricks(make_block: Callable[..., Mesh], fault: str) -> Any:
    """Two bricks side by side, base and contact at their ends, with one fault."""
    bricks = make_block((2, 1, 1), (0.02, 0.01, 0.01))
    (block,) = bricks.blocks
    cells, points = block.cells.copy(), bricks.points
    if fault == "inverted":
        cells[1] = cells[1][[0, 3, 2, 1, 4, 7, 6, 5]]
    elif fault == "duplicated":
        cells = np.vstack([cells, cells[:1]])
    else:  # a third brick without a common node: away from the others, or where it touches the first one
        shift = np.array([0.0, 0.1, 0.0]) if fault == "apart" else np.array([-0.01, 0.0, 0.0])
        corners = np.unique(cells[0])
        cells = np.vstack([cells, len(points) + np.searchsorted(corners, cells[0])])
        points = np.vstack([points, points[corners] + shift])
    far = np.flatnonzero(bricks.points[:, 0] == 0.02)
    return SimpleNamespace(
        points=points,
        n_nodes=len(points),
        cells=cells,
        body=np.zeros(len(cells), dtype=int),
        node_sets={"base": np.flatnonzero(bricks.points[:, 0] == 0.0), "contact": far},
        sides=lambda _: (far[None, [0, 2, 3, 1]],),
    )


FAULTS = {
    "duplicated": r"element (lower\.)?3 has the same nodes as element (lower\.)?1",
    "inverted": r"element (lower\.)?2 \(hexahedron\) is inverted",
    "apart": "body 'lower' consists of 2 separate parts",
    "unmerged": "body 'lower' has 8 nodes at the position of another",
}


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("form", WRITERS)
def test_faults_of_elements_are_found_in_every_format(
    tmp_path: Path, make_block: Callable[..., Mesh], form: str, fault: str
) -> None:
    file, write, holds = WRITERS[form]
    path = tmp_path / file
    write(path, two_bricks(make_block, fault), ["lower"], ["contact"], *(("base",) if holds else ()))
    if fault in ("apart", "unmerged"):
        assert any(re.search(FAULTS[fault], words) for words in read_model(path, "mm").doubts)
    elif fault == "inverted" and form in ("med", "gmsh22", "vtu"):  # a program may write all nodes in mirrored order
        printed_sentence("\n".join(read_model(path, "mm").messages), "converted")
    else:
        with rejects(ImportFileError):
            read_model(path, "mm")


@pytest.mark.parametrize("kind", ["hexahedron27", "wedge18"])
def test_solids_with_inner_nodes_are_rejected_with_the_setting_of_gmsh(tmp_path: Path, kind: str) -> None:
    count = int(kind.removeprefix("hexahedron").removeprefix("wedge"))
    points = np.random.default_rng(count).uniform(size=(count, 3))
    meshio.write_points_cells(tmp_path / "model.vtu", points, [(kind, np.arange(count)[None])])
    with rejects(ImportFileError):
        read_model(tmp_path / "model.vtu", "mm")
