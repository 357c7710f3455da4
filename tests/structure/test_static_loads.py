"""Pressure and weight: closed surfaces, resultants, moments, and CalculiX on the same meshes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse.linalg

import stickslip as ss
from calculix import ELEMENTS, cut_bricks
from calculix_loads import calculix_static
from sentences import rejects
from stickslip.core.validation import FloatArray
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.elasticity import Material, Structure, assemble, assemble_bodies
from stickslip.structure.mesh import Mesh

MakeBlock = Callable[..., Mesh]
LENGTHS = (0.04, 0.03, 0.02)
STEEL = Material()
PRESSURE, GRAVITY = 3e6, (1.0, -2.0, -9.81)


def block(make_block: MakeBlock, kind: str, distortion: float = 0.0) -> Mesh:
    """A block in cells of one kind, with its sides as node sets: ``fixed`` at z = 0, ``top`` opposite to it."""
    bricks = make_block((3, 2, 2), LENGTHS)
    low, high = bricks.points[:, 2] < 1e-9, bricks.points[:, 2] > LENGTHS[2] - 1e-9
    moved = make_block((3, 2, 2), LENGTHS, distortion).points
    sets = {"fixed": np.flatnonzero(low), "top": np.flatnonzero(high)}
    mesh = Mesh(moved, bricks.cells, node_sets=sets)
    if kind == "hexahedron":
        return mesh
    return mesh.quadratic() if kind == "hexahedron20" else cut_bricks(mesh, kind)


def skin(mesh: Mesh) -> Mesh:
    """The mesh with its complete surface as the face set ``skin``."""
    sides = mesh.outer_sides()
    nodes = np.unique(np.concatenate([each.ravel() for each in sides]))
    return replace(mesh, face_sets={"skin": sides}, node_sets={**mesh.node_sets, "skin": nodes})


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_pressure_on_a_closed_surface_has_no_resultant_also_on_curved_sides(make_block: MakeBlock, kind: str) -> None:
    """Force and moment of a pressure all round vanish exactly; the work in a uniform growth is p times 3 V."""
    plain = block(make_block, kind, distortion=0.15)
    moved = plain.points + 6e-4 * np.random.default_rng(5).uniform(-1.0, 1.0, plain.points.shape)
    mesh = skin(replace(plain, points=moved))
    force = ss.pressure_load(mesh, "skin", PRESSURE).reshape(-1, 3)
    size = np.abs(force).sum()
    assert size > 1e3
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-13 * size)
    np.testing.assert_allclose(np.cross(mesh.points, force).sum(axis=0), 0.0, atol=1e-13 * size * LENGTHS[0])
    weight = ss.gravity_load(mesh, Material(density=1.0), (1.0, 0.0, 0.0)).reshape(-1, 3)[:, 0].sum()
    assert (force * mesh.points).sum() == pytest.approx(-3.0 * PRESSURE * weight, rel=1e-12)


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_pressure_on_a_plane_face_is_its_area_times_its_inward_normal(make_block: MakeBlock, kind: str) -> None:
    mesh = block(make_block, kind)
    force = ss.pressure_load(mesh, "top", PRESSURE).reshape(-1, 3)
    total = PRESSURE * LENGTHS[0] * LENGTHS[1]
    assert force.sum(axis=0) == pytest.approx([0.0, 0.0, -total], rel=1e-12, abs=1e-9)
    centre = (force[:, 2:] * mesh.points).sum(axis=0) / force[:, 2].sum()
    assert centre == pytest.approx([0.5 * LENGTHS[0], 0.5 * LENGTHS[1], LENGTHS[2]], rel=1e-12)
    assert not np.delete(force, mesh.node_set("top"), axis=0).any()
    assert ss.pressure_load(mesh, "top", -PRESSURE).reshape(-1, 3) == pytest.approx(-force)


def test_weight_is_mass_times_gravity_of_every_body_and_mass_point(make_block: MakeBlock) -> None:
    brick = block(make_block, "hexahedron")
    body = (np.arange(len(brick.bricks())) >= 4).astype(np.int64)
    mesh = Mesh(brick.points, brick.cells, body, brick.node_sets, ("light", "heavy"))
    points = np.zeros(mesh.n_nodes)
    points[7] = 0.25
    load = ss.gravity_load(mesh, (Material(density=1000.0), Material(density=8000.0)), GRAVITY, points).reshape(-1, 3)
    third = np.prod(LENGTHS) / 3.0
    mass = 1000.0 * third + 8000.0 * 2.0 * third + 0.25
    assert load.sum(axis=0) == pytest.approx(mass * np.array(GRAVITY), rel=1e-12)
    assert np.linalg.norm(load[7]) > 0.25 * np.linalg.norm(GRAVITY)


def test_bad_loads_are_rejected(make_block: MakeBlock) -> None:
    mesh = block(make_block, "hexahedron")
    with rejects(ss.InputError):
        ss.pressure_load(mesh, "side", 1.0)
    with rejects(ss.InputError):
        ss.pressure_load(replace(mesh, node_sets={**mesh.node_sets, "edge": np.arange(2)}), "edge")
    with rejects(ss.InputError, "pressure"):
        ss.pressure_load(mesh, "top", float("nan"))
    for wrong in ((0.0, 0.0, 0.0), (0.0, -9.81), -9.81):
        with rejects(ss.InputError, "acceleration"):
            ss.gravity_load(mesh, STEEL, wrong)
    with rejects(ss.InputError, "materials"):
        ss.gravity_load(mesh, [STEEL, STEEL], GRAVITY)
    with rejects(ss.InputError, "masses"):
        ss.gravity_load(mesh, STEEL, GRAVITY, np.ones(3))


def solved(structure: Structure, load: FloatArray) -> FloatArray:
    """(n_nodes, 3) m under a load (3 * n_nodes,) N."""
    free = scipy.sparse.linalg.spsolve(structure.stiffness.tocsc(), structure.gather(load))
    return np.asarray(structure.expand(free)).reshape(-1, 3)


def structure_of(mesh: Mesh, element: str) -> Structure:
    if mesh.blocks[0].kind.startswith("hexahedron"):
        return assemble(mesh, STEEL, element)  # type: ignore[arg-type]
    return assemble_bodies(mesh, [STEEL], fixed_nodes=mesh.node_sets["fixed"])


# CalculiX has other incompatible modes of a distorted brick, another rule of mass of a distorted wedge, and another
# stiffness of any linear wedge. Elements without an entry are compared on distorted cells.
DISTORTION = {"C3D8I": 0.0, "C3D15": 0.0, "C3D6": 0.0}


@pytest.mark.slow
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize(("pressure", "gravity"), [(PRESSURE, (1e-9, 0.0, 0.0)), (1e-3, GRAVITY)])
def test_displacements_and_reactions_are_those_of_calculix(
    make_block: MakeBlock, tmp_path: Path, element: str, pressure: float, gravity: tuple[float, ...]
) -> None:
    """``*DLOAD`` P and GRAV on the same mesh. The reactions of CalculiX contain the load on clamped nodes."""
    kind, ours = ELEMENTS[element]
    mesh = block(make_block, kind, DISTORTION.get(element, 0.15))
    load = ss.pressure_load(mesh, "top", pressure) + ss.gravity_load(mesh, STEEL, gravity)
    displacement = solved(structure_of(mesh, ours), load)
    theirs, reaction, _ = calculix_static(tmp_path, mesh, element, [STEEL], "top", pressure, gravity)
    if element != "C3D6":
        np.testing.assert_allclose(displacement, theirs, rtol=0.0, atol=1e-6 * np.abs(theirs).max())
    free = np.delete(load.reshape(-1, 3), mesh.node_set("fixed"), axis=0).sum(axis=0)
    np.testing.assert_allclose(free, -reaction, rtol=0.0, atol=1e-6 * np.abs(reaction).max())
