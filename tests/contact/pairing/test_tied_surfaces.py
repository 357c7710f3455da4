"""Faces whose meshes do not match, tied or stuck, in the full structure and in the reduced one."""

from typing import Literal

import numpy as np
import pytest
from touching_blocks import STEEL, stacked

from sentences import rejects
from stickslip.contact.pairing.pairing import FacePairs, pair_surfaces, pair_with_ground
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.craig_bampton import craig_bampton, reduction_table
from stickslip.structure.elasticity import Structure, assemble_bodies
from stickslip.structure.joined import joined_modes
from stickslip.structure.mesh import Mesh


def held(mesh: Mesh) -> Structure:
    return assemble_bodies(mesh, [STEEL, STEEL], fixed_nodes=mesh.node_set("base"))


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return stacked((3, 2, 2), (4, 3, 2))


@pytest.fixture(scope="module")
def tied(mesh: Mesh) -> tuple[FloatArray, FloatArray]:
    return joined_modes(held(mesh), pair_surfaces(mesh, "bottom", "top").pairs, 6)


def test_tied_faces_move_together(mesh: Mesh, tied: tuple[FloatArray, FloatArray]) -> None:
    pairs = pair_surfaces(mesh, "bottom", "top").pairs
    _, modes = tied
    assert np.abs(pairs.mesh_operator(mesh.n_nodes) @ modes).max() < 1e-12 * np.abs(modes).max()


def test_tied_frequencies_are_near_those_of_a_matching_mesh(tied: tuple[FloatArray, FloatArray]) -> None:
    matching = stacked((4, 3, 2), (4, 3, 2))
    expected, _ = joined_modes(held(matching), pair_surfaces(matching, "bottom", "top").pairs, 6)
    np.testing.assert_allclose(tied[0], expected, rtol=0.02)


def test_stiff_springs_at_integration_points_are_near_the_tie(mesh: Mesh, tied: tuple[FloatArray, FloatArray]) -> None:
    pairs = pair_surfaces(mesh, "bottom", "top", points="quadrature").pairs
    stuck, _ = joined_modes(held(mesh), pairs, 6, pairs.springs(1e14, 1e14))
    # Rigid springs hold the faces together at every point, ties at the nodes alone: the joint is somewhat stiffer.
    np.testing.assert_allclose(stuck, tied[0], rtol=0.02)
    assert (stuck > tied[0]).all()


@pytest.mark.slow
@pytest.mark.parametrize("points", ["nodes", "quadrature"])
def test_the_reduced_structure_has_the_same_stuck_modes(mesh: Mesh, points: Literal["nodes", "quadrature"]) -> None:
    structure, pairs = held(mesh), pair_surfaces(mesh, "bottom", "top", points=points).pairs
    superelement = craig_bampton(structure, pairs.nodes, n_modes=20)
    table = reduction_table(structure, superelement, pairs, 3, pairs.springs(1e12, 1e12))
    assert max(abs(row.difference_percent) for row in table) < 0.1
    assert min(row.mac for row in table) > 0.999
    if points == "nodes":
        table = reduction_table(structure, superelement, pairs, 3)
        assert max(abs(row.difference_percent) for row in table) < 0.1


def test_integration_points_cannot_be_tied(mesh: Mesh) -> None:
    pairs = pair_surfaces(mesh, "bottom", "top", points="quadrature").pairs
    with rejects(InputError):
        joined_modes(held(mesh), pairs, 2)


@pytest.mark.slow
def test_a_face_tied_to_the_ground_is_constrained(mesh: Mesh) -> None:
    free = assemble_bodies(mesh, [STEEL, STEEL])
    joint = pair_surfaces(mesh, "bottom", "top").pairs
    on_ground = FacePairs.concatenate([joint, pair_with_ground(mesh, "base").pairs])
    frequency_hz, _ = joined_modes(free, on_ground, 4)
    expected, _ = joined_modes(held(mesh), joint, 4)
    np.testing.assert_allclose(frequency_hz, expected, rtol=1e-9)
