"""Matrices of a program reduce as our own structures do; what floats or folds is named."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.sparse

from matrix_writers import NODES
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.formats.matrices.model import MatrixModel
from stickslip.formats.matrices.reduce import reduce_matrices
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Material, Structure, assemble, natural_frequencies
from stickslip.structure.floating_parts import require_contact_bodies, strainless_motions
from stickslip.structure.mesh import Mesh
from stickslip.structure.superelement import Superelement


def model_of(structure: Structure, labels: np.ndarray | None = None) -> MatrixModel:
    """The matrices of one of our structures as another program would give them."""
    labels = np.arange(structure.mesh.n_nodes) if labels is None else labels
    return MatrixModel(
        structure.stiffness,
        structure.mass,
        1e-7 * structure.stiffness,
        node=labels[structure.free_unknowns // 3],
        direction=structure.free_unknowns % 3,
        node_labels=labels,
        position=structure.mesh.points,
        node_sets={"tip": labels[[40, 41]]},
    )


@pytest.mark.slow
def test_the_same_superelement_as_from_our_structure(held_block: Structure) -> None:
    labels = 1000 - np.arange(45)
    actual = reduce_matrices(model_of(held_block, labels), labels[[40, 20]], 6)
    ours = craig_bampton(held_block, [40, 20], 6)
    np.testing.assert_allclose(actual.stiffness, ours.stiffness, atol=1e-9 * np.abs(ours.stiffness).max())
    np.testing.assert_allclose(np.abs(actual.mass), np.abs(ours.mass), atol=1e-9)
    np.testing.assert_array_equal(actual.boundary_nodes, labels[[40, 20]])
    np.testing.assert_array_equal(actual.positions, held_block.mesh.points[[40, 20]])
    assert actual.node_sets["tip"].tolist() == [labels[40]]
    # damping 1e-7 K projects to 1e-7 of the reduced stiffness
    assert actual.damping is not None
    np.testing.assert_allclose(actual.damping, 1e-7 * actual.stiffness, atol=1e-16 * np.abs(actual.stiffness).max())
    unit = np.eye(actual.size)
    whole = held_block.expand(actual.recovery @ unit)
    np.testing.assert_allclose(np.abs(whole), np.abs(ours.recovery @ unit), atol=1e-9)


def test_a_small_model_is_taken_as_it_is(small: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    stiffness, mass, points = small
    rows: dict[str, Any] = {
        "node": np.repeat(NODES, 3),
        "direction": np.tile([0, 1, 2], 12),
        "node_labels": NODES,
        "position": points,
    }
    order = np.random.default_rng(1).permutation(36)
    mixed: dict[str, Any] = {
        name: matrix[np.ix_(order, order)] for name, matrix in (("stiffness", stiffness), ("mass", mass))
    }
    rows |= {"node": rows["node"][order], "direction": rows["direction"][order]}
    actual = reduce_matrices(MatrixModel(**mixed, **rows), NODES[:3], 30)
    assert actual.size == 36
    position = np.concatenate([3 * np.flatnonzero(node == NODES) + np.arange(3) for node in actual.boundary_nodes])
    np.testing.assert_array_equal(actual.stiffness, 0.5 * (stiffness + stiffness.T)[np.ix_(position, position)])
    np.testing.assert_array_equal(actual.positions, points[position[::3] // 3])


@pytest.mark.slow
def test_strainless_motions_are_the_same_for_dense_and_sparse(make_block: Callable[..., Mesh]) -> None:
    free = assemble(make_block((8, 4, 4), (2.0, 1.0, 1.0)), Material()).stiffness
    assert free.shape[0] > 600
    assert strainless_motions(free).shape[1] == 6
    assert strainless_motions(free.toarray()).shape[1] == 6
    assert strainless_motions(free[30:][:, 30:]).shape[1] == 0


def two_blocks(make_block: Callable[..., Mesh], shared: int = 0) -> tuple[MatrixModel, int]:
    """A free block beside another one: apart, or joined at the nodes (2: an edge) they share."""
    one = assemble(make_block((3, 2, 2), (3.0, 1.0, 1.0)), Material())
    n = one.mesh.n_nodes
    size = 6 * n
    second = np.arange(3 * n) + 3 * n
    last = np.flatnonzero((one.mesh.points[:, 0] > 2.9) & (one.mesh.points[:, 2] < 0.1))
    first = np.flatnonzero((one.mesh.points[:, 0] < 0.1) & (one.mesh.points[:, 2] < 0.1))
    for a, b in zip(last[:shared], first[:shared], strict=True):
        second[3 * b : 3 * b + 3] = 3 * a + np.arange(3)
    place = scipy.sparse.csr_matrix((np.ones(3 * n), (second, np.arange(3 * n))), shape=(size, 3 * n))
    matrices = []
    for matrix in (one.stiffness, one.mass):
        whole = scipy.sparse.block_diag([matrix, 0.0 * matrix]) + place @ matrix @ place.T
        matrices.append(whole.tocsr())
    used = np.flatnonzero(matrices[0].diagonal())
    points = np.vstack([one.mesh.points, one.mesh.points + np.array([3.0, 0.0, 0.0])])
    labels = np.arange(2 * n) + 1
    stiffness, mass = (matrix[used][:, used] for matrix in matrices)
    return MatrixModel(
        stiffness,
        mass,
        node=labels[used // 3],
        direction=used % 3,
        node_labels=labels,
        position=points,
    ), n


def corners(n: int, *blocks: int) -> np.ndarray:
    """Three nodes of each block that are not in one line (labels)."""
    return np.concatenate([np.array([3, 9, n]) + block * n for block in blocks])


def test_free_bodies_with_contact_are_accepted(make_block: Callable[..., Mesh]) -> None:
    model, n = two_blocks(make_block)
    actual = reduce_matrices(model, corners(n, 0, 1), 4)
    frequency, _ = natural_frequencies(actual.stiffness, actual.mass, 13)
    assert frequency[11] < 1e-3 * frequency[12]


def test_a_body_without_contact_is_named(make_block: Callable[..., Mesh]) -> None:
    model, n = two_blocks(make_block)
    with rejects(InputError):
        reduce_matrices(model, corners(n, 0), 4)
    with rejects(InputError):
        reduce_matrices(model, corners(n, 0), 1000)


def test_one_contact_node_does_not_support_a_body(make_block: Callable[..., Mesh]) -> None:
    model, n = two_blocks(make_block)
    with rejects(InputError):
        reduce_matrices(model, [3, 3 + n], 4)


@pytest.mark.slow
@pytest.mark.parametrize("n_modes", [4, 1000])
def test_a_hinge_is_a_mechanism(make_block: Callable[..., Mesh], n_modes: int) -> None:
    model, n = two_blocks(make_block, shared=2)
    nodes = np.concatenate([corners(n, 0), np.array([5, 9, n]) + n])
    with rejects(InputError):
        reduce_matrices(model, nodes, n_modes)


def test_positions_of_another_model_do_not_explain_rigid_motions(make_block: Callable[..., Mesh]) -> None:
    model, n = two_blocks(make_block)
    assert model.position is not None
    wrong = replace(model, position=model.position * [5.0, 1.0, 1.0])
    with rejects(InputError):
        reduce_matrices(wrong, corners(n, 0, 1), 4)


def test_contact_bodies_of_a_superelement(small: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    stiffness, mass, points = small
    element = Superelement(mass, stiffness, boundary_nodes=NODES, positions=points)
    require_contact_bodies(element, NODES[:4])
    with rejects(InputError):
        require_contact_bodies(element, np.array([999]))
    held = Superelement(mass, stiffness + 1e9 * np.eye(36), boundary_nodes=NODES)
    require_contact_bodies(held, np.array([999]))


def test_without_a_map_nothing_can_be_kept(small: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    with rejects(InputError):
        reduce_matrices(MatrixModel(*small[:2]), [3], 4)
