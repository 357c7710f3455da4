"""Pairs across the boundary of a sector, from meshes, against the full ring with the same pairs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from sectors import annulus
from sentences import rejects
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.pairing.pairing import pair_faces, pair_surfaces
from stickslip.core.errors import InputError
from stickslip.structure.cyclic_sector import CyclicSector
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.elasticity import Material, assemble, natural_frequencies
from stickslip.structure.mesh import Mesh
from stickslip.structure.sector_boundaries import cyclic_symmetry, with_next_sector
from stickslip.structure.sector_reduction import cyclic_sector

SECTORS, STEEL, SPRING = 5, Material(), 3e8


@pytest.fixture(scope="module")
def slit() -> tuple[Mesh, CyclicSymmetry]:
    """A sector of a plate whose outer part has a slit to the next sector, and whose faces at the slit touch."""
    mesh = annulus(SECTORS, (0.05, 0.2), 0.02, (4, 2, 1), of=1)
    radius = np.hypot(mesh.points[:, 0], mesh.points[:, 1])
    limit = np.unique(radius.round(9))[2] + 1e-6
    sets = {"inner": mesh.node_sets["inner"]}
    for name in ("left", "right"):
        nodes = mesh.node_sets[name]
        sets |= {name: nodes[radius[nodes] < limit], f"{name} rim": nodes[radius[nodes] > limit]}
        sets[f"{name} all"] = nodes
    mesh = replace(mesh, node_sets=sets)
    return mesh, cyclic_symmetry(mesh.points, sets["left"], sets["right"])


def rim_pairs(mesh: Mesh, symmetry: CyclicSymmetry) -> FacePairs:
    return pair_faces(with_next_sector(mesh, symmetry), "right rim", "next left rim")


def reduced(mesh: Mesh, symmetry: CyclicSymmetry, pairs: FacePairs, n_modes: int) -> CyclicSector:
    structure = assemble(mesh, STEEL, fixed_nodes=mesh.node_sets["inner"])
    return cyclic_sector(structure, symmetry, symmetry.own_nodes(pairs.nodes), n_modes=n_modes)


def ring_frequencies(mesh: Mesh, symmetry: CyclicSymmetry, count: int) -> np.ndarray:
    """Hz of the full ring with springs between the rims, built node by node."""
    number = np.arange(SECTORS * mesh.n_nodes).reshape(SECTORS, -1)
    number[:, symmetry.right] = np.roll(number, -1, axis=0)[:, symmetry.left]
    used, renumbered = np.unique(number, return_inverse=True)
    renumbered = renumbered.reshape(SECTORS, -1)
    points = np.vstack([symmetry.rotated(mesh.points, ahead) for ahead in range(SECTORS)])[used]
    cells = np.vstack([each[mesh.cells] for each in renumbered])
    structure = assemble(Mesh(points, cells), STEEL, fixed_nodes=renumbered[:, mesh.node_sets["inner"]].ravel())
    stiffness = structure.stiffness.tolil()
    assert len(np.unique(points.round(9), axis=0)) < len(points)  # nodes of both sides of a slit are at one place
    for ahead in range(SECTORS):
        here = renumbered[ahead, mesh.node_sets["right rim"]]
        there = renumbered[(ahead + 1) % SECTORS, mesh.node_sets["left rim"]]
        for node in here:
            other = there[np.linalg.norm(points[there] - points[node], axis=1).argmin()]
            for first, second in zip(*structure.unknowns_of([node, other]), strict=True):
                stiffness[first, first] += SPRING
                stiffness[second, second] += SPRING
                stiffness[first, second] -= SPRING
                stiffness[second, first] -= SPRING
    return natural_frequencies(stiffness.tocsr(), structure.mass, count)[0]


@pytest.mark.slow
def test_stuck_pairs_across_the_boundary_are_those_of_the_ring(slit: tuple[Mesh, CyclicSymmetry]) -> None:
    mesh, symmetry = slit
    pairs = rim_pairs(mesh, symmetry)
    sector = reduced(mesh, symmetry, pairs, n_modes=24)
    here, following = np.hsplit(sector.operator(pairs), 2)
    found = []
    for waves in range(SECTORS):
        matrices = sector.lagged(waves)
        operator = here + np.exp(2j * np.pi * waves / SECTORS) * following
        stiffness = matrices.stiffness + SPRING * operator.conj().T @ operator
        found += list(scipy.linalg.eigh(stiffness, matrices.mass, eigvals_only=True)[:4])
    expected = ring_frequencies(mesh, symmetry, 10)
    np.testing.assert_allclose(np.sqrt(np.sort(found)[:10]) / (2.0 * np.pi), expected, rtol=2e-5)
    without = np.sort(np.concatenate([sector.natural_frequencies(min(d, 5 - d), 4) for d in range(5)]))[:10]
    assert np.abs(without / expected - 1.0).max() > 0.01  # so that the springs count


@pytest.mark.slow
def test_a_rigid_rotation_about_the_axis_moves_no_pair(slit: tuple[Mesh, CyclicSymmetry]) -> None:
    mesh, symmetry = slit
    pairs = rim_pairs(mesh, symmetry)
    sector = reduced(mesh, symmetry, pairs, n_modes=1)
    places = mesh.points[sector.boundary_nodes]
    turn = np.cross([0.0, 0.0, 1.0], places).ravel()
    motion = np.concatenate([turn, np.zeros(1), turn, np.zeros(1)])
    np.testing.assert_allclose(sector.operator(pairs) @ motion, 0.0, atol=1e-15)


@pytest.mark.slow
def test_a_node_of_both_faces_on_the_boundary_does_not_move_against_itself(
    slit: tuple[Mesh, CyclicSymmetry],
) -> None:
    mesh, symmetry = slit
    pairs = pair_faces(with_next_sector(mesh, symmetry), "right all", "next left all")
    loose = np.flatnonzero(~np.isin(pairs.first_node, mesh.node_sets["inner"]))
    kept = FacePairs(*(getattr(pairs, name)[loose] for name in FacePairs.__dataclass_fields__))
    operator = reduced(mesh, symmetry, kept, n_modes=1).operator(kept).reshape(len(loose), 3, -1)
    still = np.abs(operator).max(axis=(1, 2)) < 1e-15
    np.testing.assert_array_equal(still, np.isin(kept.first_node, symmetry.right))


def test_surfaces_pair_across_the_boundary_too(slit: tuple[Mesh, CyclicSymmetry]) -> None:
    mesh, symmetry = slit
    pairing = pair_surfaces(with_next_sector(mesh, symmetry), "right rim", "next left rim")
    assert pairing.pairs.n_pairs == mesh.node_sets["right rim"].size
    np.testing.assert_array_equal(
        symmetry.own_nodes(pairing.pairs.nodes), np.union1d(mesh.node_sets["right rim"], mesh.node_sets["left rim"])
    )


def test_bodies_and_sets_of_the_next_sector(slit: tuple[Mesh, CyclicSymmetry]) -> None:
    mesh, symmetry = slit
    both = with_next_sector(mesh, symmetry)
    assert both.body_names == ("body", "next body")
    np.testing.assert_array_equal(both.node_sets["next inner"], mesh.node_sets["inner"] + mesh.n_nodes)
    np.testing.assert_allclose(both.points[mesh.n_nodes :], symmetry.rotated(mesh.points))
    assert (both.body == np.repeat([0, 1], mesh.n_cells)).all()


@pytest.mark.slow
def test_pairs_that_reach_two_sectors_ahead(slit: tuple[Mesh, CyclicSymmetry]) -> None:
    mesh, symmetry = slit
    pairs = rim_pairs(mesh, symmetry)
    sector = reduced(mesh, symmetry, pairs, n_modes=1)
    wrong = replace(pairs, second_nodes=np.full_like(pairs.second_nodes, symmetry.right[-1] + mesh.n_nodes))
    with rejects(InputError, "pairs"):
        sector.operator(wrong)


def test_pairs_of_nodes_that_the_reduction_omitted(slit: tuple[Mesh, CyclicSymmetry]) -> None:
    mesh, symmetry = slit
    pairs = rim_pairs(mesh, symmetry)
    structure = assemble(mesh, STEEL, fixed_nodes=mesh.node_sets["inner"])
    sector = cyclic_sector(structure, symmetry, mesh.node_sets["left rim"], n_modes=1, diameters=[0])
    with rejects(InputError, "pairs"):
        sector.operator(pairs)
    with rejects(InputError, "pairs"):
        replace(sector, symmetry=None).operator(pairs)


def test_a_symmetry_of_another_mesh(slit: tuple[Mesh, CyclicSymmetry]) -> None:
    mesh, symmetry = slit
    with rejects(InputError, "symmetry"):
        with_next_sector(mesh.quadratic(), symmetry)


def test_a_boundary_without_its_midside_nodes(slit: tuple[Mesh, CyclicSymmetry]) -> None:
    mesh = slit[0].quadratic()
    left, right = (mesh.node_sets[name][mesh.node_sets[name] < slit[0].n_nodes] for name in ("left", "right"))
    open_between = cyclic_symmetry(mesh.points, left, right)
    with rejects(InputError, "left"):
        with_next_sector(mesh, open_between)
