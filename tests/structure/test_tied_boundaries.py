"""Boundaries of a sector that do not match: patch test, rigid motions, the full ring with the same ties."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.spatial

import stickslip as ss
from sectors import annulus
from sentences import rejects
from stickslip.structure.constraints import eliminate
from stickslip.structure.elasticity import natural_frequencies
from stickslip.structure.equations import Equations
from stickslip.structure.face_ties import add_tie, tie_nodes
from stickslip.structure.ring import Ring
from stickslip.structure.sector_reduction import lagged_model

STEEL = ss.Material(200e9, 0.33, 7850.0)
SECTORS, RADII, THICKNESS = 6, (0.05, 0.2), 0.02
ANGLE = 2.0 * np.pi / SECTORS


def graded(counts: tuple[int, int, int], shift: float = 0.0, of: int = 1) -> Any:
    """A sector of bricks; the radii and heights of nodes move by ``shift`` from left to right."""
    mesh = annulus(SECTORS, RADII, THICKNESS, counts, of=of)
    x, y, z = mesh.points.T
    radius, angle = np.hypot(x, y), np.arctan2(y, x) % ANGLE
    share = shift * angle / ANGLE
    share[mesh.node_sets["right"]] = shift
    place = (radius - RADII[0]) / (RADII[1] - RADII[0])
    height = z / THICKNESS
    radius = RADII[0] + (RADII[1] - RADII[0]) * (place + share * place * (1.0 - place))
    height = height + 2.0 * share * height * (1.0 - height)
    full = np.arctan2(y, x)
    points = np.stack([radius * np.cos(full), radius * np.sin(full), THICKNESS * height], axis=1)
    return ss.Mesh(points, mesh.cells, node_sets=mesh.node_sets)


def wedges(left: int, right: int, through: int = 2) -> Any:
    """A sector of wedges with ``left`` and ``right`` sides along the radius of its boundaries."""
    flat = []
    for angle, count in ((0.0, left), (0.35 * ANGLE, left), (0.7 * ANGLE, right), (ANGLE, right)):
        radius = np.linspace(*RADII, count + 1)
        flat.append(np.stack([radius, np.full(count + 1, angle)], axis=1))
    polar = np.concatenate(flat)
    scaled = polar * [1.0 / (RADII[1] - RADII[0]), 1.0 / ANGLE]
    triangles = scipy.spatial.Delaunay(scaled).simplices
    corners = scaled[triangles]
    area = np.linalg.det(corners[:, 1:] - corners[:, :1])
    triangles = triangles[np.abs(area) > 1e-9]
    area = area[np.abs(area) > 1e-9]
    triangles[area < 0.0] = triangles[area < 0.0][:, ::-1]
    n = len(polar)
    heights = np.linspace(0.0, THICKNESS, through + 1)
    x, y = polar[:, 0] * np.cos(polar[:, 1]), polar[:, 0] * np.sin(polar[:, 1])
    points = np.concatenate([np.stack([x, y, np.full(n, height)], axis=1) for height in heights])
    cells = np.concatenate([np.hstack([triangles + k * n, triangles + (k + 1) * n]) for k in range(through)])
    every = np.arange(len(points)) % n
    sets = {
        "left": np.flatnonzero(polar[every, 1] == 0.0),
        "right": np.flatnonzero(polar[every, 1] == ANGLE),
        "inner": np.flatnonzero(polar[every, 0] == RADII[0]),
    }
    return ss.Mesh(points, cells, node_sets=sets)


def tied(mesh: Any) -> Any:
    return ss.tied_symmetry(mesh, "left", "right")


def clamped(mesh: Any) -> Any:
    return ss.assemble_bodies(mesh, [STEEL], fixed_nodes=mesh.node_sets["inner"])


@pytest.mark.slow
def test_boundaries_that_match_give_the_same_as_without_ties() -> None:
    mesh = graded((3, 2, 1))
    symmetry = tied(mesh)
    assert symmetry.is_tied
    assert repr(symmetry) == (
        "CyclicSymmetry(6 sectors about (0, 0, 1); 8 nodes of the right boundary tied to 8 of the left one)"
    )
    plain = ss.cyclic_symmetry(mesh.points, mesh.node_sets["left"], mesh.node_sets["right"])
    one, other = (ss.sector_frequencies(clamped(mesh), each, range(4), 6) for each in (symmetry, plain))
    for diameter in range(4):
        np.testing.assert_allclose(one[diameter], other[diameter], rtol=1e-10)


@pytest.mark.slow
def test_a_speed_has_the_same_effects_with_ties() -> None:
    mesh = graded((3, 2, 1))
    plain = ss.cyclic_symmetry(mesh.points, mesh.node_sets["left"], mesh.node_sets["right"])
    found = []
    for symmetry in (plain, tied(mesh)):
        rotor = ss.rotating(clamped(mesh), (0, 0, 1), symmetry=symmetry)
        whirl = rotor.coriolis_at(12_000.0)
        found.append(ss.sector_frequencies(rotor.at(12_000.0), symmetry, range(4), 4, gyroscopic=whirl))
    for diameter in range(4):
        np.testing.assert_allclose(found[1][diameter], found[0][diameter], rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("mesh", [graded((3, 2, 2), 0.4), wedges(3, 5), wedges(2, 4)], ids=["graded", "3:5", "2:4"])
def test_patch_of_constant_strain(mesh: Any) -> None:
    """Fields of constant strain that the disk has alike in all sectors satisfy the ties, with their exact energy."""
    symmetry = tied(mesh)
    follows = symmetry.following()
    left, right = (3 * nodes[:, None] + np.arange(3) for nodes in (symmetry.left, symmetry.right))
    free = ss.assemble_bodies(mesh, [STEEL], fixed_nodes=[])
    model = lagged_model(free, symmetry)
    stiffness = model.at(0, SECTORS)[0]
    volume = free.mass[::3, ::3].sum() / STEEL.density
    matrix = STEEL.elastic_matrix()
    for gradient in (np.diag([1e-3, 1e-3, 0.0]), np.diag([0.0, 0.0, 2e-3])):
        exact = (mesh.points @ gradient).ravel()
        np.testing.assert_allclose(follows @ exact[left.ravel()], exact[right.ravel()], atol=1e-15)
        strain = np.array([*np.diag(gradient), 0.0, 0.0, 0.0])
        motion = exact[model.remaining]
        energy = 0.5 * motion @ stiffness @ motion
        assert energy == pytest.approx(0.5 * volume * strain @ matrix @ strain, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("left", "right", "largest"), [(2, 4, 1e-9), (3, 5, 0.3)])
def test_patch_of_constant_stress(left: int, right: int, largest: float) -> None:
    """Forces of constant stress balance inside the left boundary if the right mesh divides its sides; else nearly."""
    mesh = wedges(left, right)
    symmetry = tied(mesh)
    free = ss.assemble_bodies(mesh, [STEEL], fixed_nodes=[])
    model = lagged_model(free, symmetry)
    exact = (mesh.points @ np.diag([1e-3, 1e-3, 0.0])).ravel()[model.remaining]
    forces = (model.at(0, SECTORS)[0] @ exact).reshape(-1, 3)
    alone = (free.stiffness @ (mesh.points @ np.diag([1e-3, 1e-3, 0.0])).ravel()).reshape(-1, 3)
    nodes = model.remaining[::3] // 3
    radius = np.hypot(*mesh.points[nodes, :2].T)
    inside = np.isin(nodes, symmetry.left) & (radius > RADII[0] + 1e-6) & (radius < RADII[1] - 1e-6)
    assert inside.sum() >= 3
    # Round the circle: across the boundary, which has no other load.
    assert np.abs(forces[inside, 1]).max() <= largest * np.abs(alone[symmetry.left, 1]).max()
    assert (np.abs(forces[inside, 1]).max() > 1e-3 * np.abs(alone[symmetry.left, 1]).max()) == (largest > 0.1)


@pytest.mark.slow
def test_a_free_disk_has_its_rigid_motions() -> None:
    mesh = wedges(3, 5)
    symmetry, free = tied(mesh), ss.assemble_bodies(mesh, [STEEL], fixed_nodes=[])
    for diameter, rigid in ((0, 2), (1, 2), (2, 0), (3, 0)):  # along and about the axis; across it and tilts; none
        stiffness, mass, _ = lagged_model(free, symmetry).at(diameter, SECTORS)
        values = scipy.linalg.eigh(stiffness.toarray(), mass.toarray(), eigvals_only=True)
        assert (np.abs(values) < 1e-9 * values[-1]).sum() == rigid


@pytest.mark.slow
@pytest.mark.parametrize("mesh", [graded((2, 2, 2), 0.4), wedges(2, 3, 1)], ids=["graded", "2:3"])
def test_frequencies_are_those_of_the_full_ring_with_the_same_ties(mesh: Any) -> None:
    """The ring by the ordinary path: each boundary tied by equations, which are eliminated."""
    symmetry = tied(mesh)
    whole = Ring.of(mesh, symmetry)
    ring = whole.mesh
    assert ring.n_nodes == SECTORS * mesh.n_nodes
    equations = Equations(ring.n_nodes)
    fixed = ring.node_sets["inner"]
    (sides,) = mesh.sides("left")
    for sector in range(SECTORS):
        nodes = np.setdiff1d(whole.number[sector, symmetry.right], fixed)
        faces = [whole.number[(sector + 1) % SECTORS][sides]]
        add_tie(equations, equations.owner(f"{sector}"), tie_nodes(ring.points, nodes, faces))
    unknowns = (3 * fixed[:, None] + np.arange(3)).ravel()
    structure = ss.assemble_bodies(ring, [STEEL], fixed_nodes=fixed, constraints=eliminate(equations, unknowns))
    expected = natural_frequencies(structure.stiffness, structure.mass, 14)[0]
    found = ss.sector_frequencies(clamped(mesh), symmetry, range(4), 6)
    both = [np.repeat(hz, 1 if 2 * diameter % SECTORS == 0 else 2) for diameter, hz in found.items()]
    np.testing.assert_allclose(np.sort(np.concatenate(both))[:14], expected, rtol=1e-8)


@pytest.mark.slow
def test_frequencies_are_those_of_boundaries_that_match_within_the_error_of_the_mesh() -> None:
    counts = (8, 4, 2)
    mesh, plain, fine = graded(counts, 0.3), graded(counts), graded((16, 8, 4))
    own, matching, exact = (
        ss.sector_frequencies(clamped(each), symmetry, range(4), 4)
        for each, symmetry in (
            (mesh, tied(mesh)),
            *(
                (each, ss.cyclic_symmetry(each.points, each.node_sets["left"], each.node_sets["right"]))
                for each in (plain, fine)
            ),
        )
    )
    for diameter in range(4):
        error_of_mesh = np.abs(matching[diameter] / exact[diameter] - 1.0)
        difference = np.abs(own[diameter] / matching[diameter] - 1.0)
        assert (difference < np.maximum(error_of_mesh, 1e-3)).all()


@pytest.mark.slow
def test_input_errors() -> None:
    mesh = wedges(2, 4)
    symmetry = tied(mesh)
    with rejects(ss.InputError, "nodes"):
        symmetry.own_nodes([int(symmetry.right[0])])
    with rejects(ss.InputError, "nodes"):
        ss.cyclic_sector(clamped(mesh), symmetry, [int(symmetry.right[-1])], diameters=[1], n_modes=2)
    assert symmetry.own_nodes(symmetry.left + mesh.n_nodes).tolist() == symmetry.left.tolist()
    with rejects(ss.InputError, "left", "right"):
        ss.cyclic_symmetry(mesh.points, symmetry.left, symmetry.right)
    with rejects(ss.InputError, "left", "right"):  # a constraint on one boundary alone
        wrong = ss.assemble_bodies(mesh, [STEEL], fixed_nodes=[*mesh.node_sets["inner"], int(symmetry.right[-1])])
        ss.sector_frequencies(wrong, symmetry, [0], 2)
    with rejects(ss.InputError, "left", "right"):
        loose = np.setdiff1d(mesh.node_sets["inner"], symmetry.right)
        ss.sector_frequencies(ss.assemble_bodies(mesh, [STEEL], fixed_nodes=loose), symmetry, [0], 2)
    with rejects(ss.InputError, "left"):
        ss.tied_symmetry(mesh, "nothing", "right")
    with rejects(ss.InputError, "tolerance"):
        ss.tied_symmetry(mesh, "left", "right", tolerance=0.0)
    with rejects(ss.InputError, "sectors"):
        ss.tied_symmetry(mesh, "left", "right", sectors=5, axis="z")
    x, y, _ = mesh.points.T
    part = symmetry.right[np.hypot(x, y)[symmetry.right] < 0.13]
    cut = ss.Mesh(mesh.points, mesh.cells, node_sets={**mesh.node_sets, "part": part})
    with rejects(ss.InputError, "left", "right"):  # a part of the left boundary has no partner
        ss.tied_symmetry(cut, "left", "part", axis="z", sectors=SECTORS)
    with rejects(ss.InputError, "left", "right"):
        ss.tied_symmetry(cut, "part", "left", axis="z", sectors=SECTORS)
