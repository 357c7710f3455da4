"""Ties inside a sector: the full ring with the same ties by the ordinary path, and ties that the boundaries lack."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sectors import TIED_HEIGHT, TIED_SECTORS, annulus, tied_blade
from sentences import rejects
from stickslip.structure.constraints import eliminate
from stickslip.structure.elasticity import natural_frequencies
from stickslip.structure.equations import Equations
from stickslip.structure.face_ties import add_tie, tie_nodes
from stickslip.structure.ring import Ring
from stickslip.structure.sector_structure import SectorStructure

STEEL, SECTORS, HEIGHT = ss.Material(200e9, 0.33, 7850.0), TIED_SECTORS, TIED_HEIGHT
ANGLE = 2.0 * np.pi / SECTORS


def tied(mesh: Any) -> Any:
    equations = Equations(mesh.n_nodes)
    follow = tie_nodes(mesh.points, mesh.node_set("foot"), mesh.sides("rim"), 0.01)
    add_tie(equations, equations.owner("tie"), follow)
    fixed = (3 * mesh.node_set("bore")[:, None] + np.arange(3)).ravel()
    return ss.assemble_bodies(mesh, [STEEL, STEEL], fixed_unknowns=fixed, constraints=eliminate(equations, fixed))


def symmetry_of(mesh: Any) -> Any:
    return ss.cyclic_symmetry(mesh.points, mesh.node_sets["left"], mesh.node_sets["right"], sectors=SECTORS)


def of_all(frequencies: Any, count: int) -> Any:
    """The frequencies of the ring from those of each nodal diameter."""
    both = [np.repeat(hz, 1 if 2 * diameter % SECTORS == 0 else 2) for diameter, hz in frequencies.items()]
    return np.sort(np.concatenate(both))[:count]


@pytest.mark.slow
@pytest.mark.parametrize(("part", "around"), [(0.6, 3), (1.0, 3), (1.0, 4)])
def test_frequencies_of_a_tied_blade_are_those_of_the_ring_with_the_same_ties(part: float, around: int) -> None:
    """With the whole width, nodes of both boundaries follow nodes of their own boundary."""
    mesh = tied_blade(part, around)
    symmetry = symmetry_of(mesh)
    ring = tied(Ring.of(mesh, symmetry).mesh)
    expected = natural_frequencies(ring.stiffness, ring.mass, 12)[0]
    sector = tied(mesh)
    own = of_all(ss.sector_frequencies(sector, symmetry, range(3), 8), 12)
    np.testing.assert_allclose(own, expected, rtol=1e-8)
    if part < 1.0:
        tip = mesh.node_set("tip")
        reduced = ss.cyclic_sector(sector, symmetry, tip, n_modes=20)
        found = {each: reduced.natural_frequencies(each, 8) for each in range(3)}
        np.testing.assert_allclose(of_all(found, 12), expected, rtol=1e-4)


@pytest.mark.slow
def test_the_motion_of_a_tied_blade_satisfies_its_ties() -> None:
    mesh = tied_blade(0.6, 3)
    sector, symmetry = tied(mesh), symmetry_of(mesh)
    structure = SectorStructure(sector, symmetry)
    reduced = ss.cyclic_sector(sector, symmetry, mesh.node_set("tip"), n_modes=5)
    coefficients = np.random.default_rng(2).standard_normal((reduced.size, 5))
    moved = structure.motion(reduced, coefficients, [1, 2])
    ties = sector.constraints
    assert ties is not None
    np.testing.assert_allclose(moved, ties.transformation @ moved[ties.free_unknowns], atol=1e-10 * np.abs(moved).max())
    foot = (3 * mesh.node_set("foot")[:, None] + np.arange(3)).ravel()
    assert np.abs(moved[foot]).max() > 1e-3 * np.abs(moved).max()
    # the right boundary is the left one of the next sector, one phase lag later
    right, left = ((3 * nodes[:, None] + np.arange(3)).ravel() for nodes in (symmetry.right, symmetry.left))
    first = moved[:, 1] - 1j * moved[:, 2]
    lagged = np.exp(1j * ANGLE) * (symmetry.following() @ first[left])
    np.testing.assert_allclose(first[right], lagged, atol=1e-10 * np.abs(first).max())


@pytest.mark.slow
def test_a_rotating_tied_blade_is_that_of_the_ring() -> None:
    mesh = tied_blade(0.6, 3)
    symmetry = symmetry_of(mesh)
    rotor = ss.rotating(tied(mesh), symmetry.direction, symmetry=symmetry)
    ring = ss.rotating(tied(Ring.of(mesh, symmetry).mesh), symmetry.direction)
    found = of_all(ss.sector_frequencies(rotor.at(15_000.0), symmetry, range(3), 6), 6)
    expected = ring.natural_frequencies(15_000.0, 6, coriolis=False)
    np.testing.assert_allclose(found, expected, rtol=1e-8)
    assert expected[0] > 1.02 * ring.natural_frequencies(0.0, 1, coriolis=False)[0]


@pytest.mark.slow
def test_ties_that_the_other_boundary_does_not_have() -> None:
    mesh = tied_blade(1.0, 3)
    symmetry = symmetry_of(mesh)
    edge = int(np.intersect1d(mesh.node_set("tip"), mesh.node_set("right"))[0])
    inside = int(np.setdiff1d(mesh.node_set("tip"), np.union1d(mesh.node_sets["left"], mesh.node_sets["right"]))[0])
    partner = int(symmetry.left[symmetry.right == edge][0])
    for pairs in ([(edge, inside)], [(partner, inside)], [(edge, inside), (partner, inside)], [(edge, partner)]):
        equations = Equations(mesh.n_nodes)
        follow = tie_nodes(mesh.points, mesh.node_set("foot"), mesh.sides("rim"), 0.01)
        add_tie(equations, equations.owner("tie"), follow)
        for node, leader in pairs:
            for axis in range(3):
                terms = [(3 * node + axis, -1.0), (3 * leader + axis, 1.0)]
                equations.add(terms, 3 * node + axis, equations.owner("wrong"))
        fixed = (3 * mesh.node_set("bore")[:, None] + np.arange(3)).ravel()
        wrong = ss.assemble_bodies(mesh, [STEEL, STEEL], fixed_unknowns=fixed, constraints=eliminate(equations, fixed))
        with pytest.raises(ss.InputError):
            ss.sector_frequencies(wrong, symmetry, [0], 2)
    with rejects(ss.InputError, "structure"):
        ss.cyclic_sector(wrong, symmetry, [inside], n_modes=3)


def test_two_bodies_with_nodes_at_one_position_of_a_boundary() -> None:
    """Positions do not show which node continues in which one."""
    mesh = annulus(SECTORS, (0.05, 0.15), HEIGHT, (2, 2, 1), of=1)
    both = np.vstack([mesh.points, mesh.points + np.array([0.0, 0.0, HEIGHT])])
    left, right = (
        np.append(nodes, nodes + mesh.n_nodes) for nodes in (mesh.node_sets["left"], mesh.node_sets["right"])
    )
    with rejects(ss.InputError, "left"):
        ss.cyclic_symmetry(both, left, right, axis="z")
    body = np.repeat([0, 1], mesh.n_cells)
    sets = {"left": left, "right": right}
    whole = ss.Mesh(
        both, np.vstack([np.asarray(mesh.cells), np.asarray(mesh.cells) + mesh.n_nodes]), body, sets, ("one", "two")
    )
    with rejects(ss.InputError, "left"):
        ss.tied_symmetry(whole, "left", "right", axis="z")
