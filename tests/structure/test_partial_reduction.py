"""A reduction to the moving pairs alone: the full structure whose other pairs stick, and that without contact."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray
from test_relative_reduction import OTHER, SPRINGS, compliance, full_compliance, three_pairs

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Structure
from stickslip.structure.joined import joined_modes
from stickslip.structure.partial_reduction import partial_superelement
from stickslip.structure.superelement import Superelement

ONE = np.array([False, True, False])
NONE = np.zeros(3, dtype=bool)


def partial(block: Structure, n_modes: int = 20, moving: NDArray[np.bool_] = ONE) -> Superelement:
    return partial_superelement(block, three_pairs(), SPRINGS, moving, OTHER, n_modes)


def full_frequencies(block: Structure, springs: FloatArray) -> FloatArray:
    """Hz of the full structure with springs on all pairs."""
    operator = block.of_unknowns(three_pairs().mesh_operator(block.mesh.n_nodes)).toarray()
    stiffness = block.stiffness.toarray() + operator.T @ (springs[:, None] * operator)
    return np.asarray(np.sqrt(scipy.linalg.eigvalsh(stiffness, block.mass.toarray())) / (2.0 * np.pi))


def test_the_matrices_are_those_without_contact(held_block: Structure) -> None:
    superelement = partial(held_block, 5)
    basis = superelement.recovery @ np.eye(superelement.size)
    inside = basis[held_block.free_unknowns]
    for name in ("stiffness", "mass"):
        matrix = getattr(superelement, name)
        exact = inside.T @ getattr(held_block, name) @ inside
        np.testing.assert_allclose(matrix, exact, atol=1e-9 * np.abs(matrix).max(), err_msg=name)
    rows = three_pairs().mesh_operator(held_block.mesh.n_nodes) @ basis
    np.testing.assert_allclose(superelement.operator(three_pairs()), rows, atol=1e-10)


def test_only_the_moving_pair_has_unknowns(held_block: Structure) -> None:
    """Two other nodes, the relative displacement of the pair, and at most twice five modes."""
    assert partial(held_block, 5).size <= 3 * len(OTHER) + 3 + 10
    assert partial(held_block, 5, NONE).size <= 3 * len(OTHER) + 10


@pytest.mark.parametrize("other_nodes", [[44, 31], [44, 41]], ids=["own node", "no own node"])
def test_the_static_compliance_of_a_moving_pair_is_exact(held_block: Structure, other_nodes: list[int]) -> None:
    """With the other pairs stuck, from its relative displacement, or from both of its sides."""
    for n_modes in (0, 4):
        exact = full_compliance(held_block, 0.0)
        found = compliance(
            partial_superelement(held_block, three_pairs(), SPRINGS, ONE, np.array(other_nodes), n_modes), 0.0
        )
        own = slice(3, 6)  # of forces on the moving pair
        np.testing.assert_allclose(found[:, own], exact[:, own], atol=1e-9 * np.abs(exact).max())


def test_stuck_and_free_frequencies_are_those_of_the_full_structure(held_block: Structure) -> None:
    superelement = partial(held_block)
    operator = superelement.operator(three_pairs())
    for springs in (SPRINGS, np.zeros(9)):
        stiffness = superelement.stiffness + operator.T @ (springs[:, None] * operator)
        found = np.sqrt(np.abs(scipy.linalg.eigvalsh(stiffness, superelement.mass))) / (2.0 * np.pi)
        exact = full_frequencies(held_block, springs)
        np.testing.assert_allclose(found[:8], exact[:8], rtol=1e-3)
        assert (found[:8] >= exact[:8] * (1.0 - 1e-9)).all()  # a reduction is never softer
    # the pair that moves may have any springs: its relative displacement is an unknown
    slipping = SPRINGS * np.repeat([1.0, 0.0, 1.0], 3)
    stiffness = superelement.stiffness + operator.T @ (slipping[:, None] * operator)
    found = np.sqrt(scipy.linalg.eigvalsh(stiffness, superelement.mass)) / (2.0 * np.pi)
    np.testing.assert_allclose(found[:8], full_frequencies(held_block, slipping)[:8], rtol=1e-3)


def test_more_modes_never_make_it_stiffer(held_block: Structure) -> None:
    """Also where modes with and without contact are nearly the same."""
    sizes, lowest = [], []
    for n_modes in (2, 10, 30, 60):
        superelement = partial(held_block, n_modes)
        operator = superelement.operator(three_pairs())
        stiffness = superelement.stiffness + operator.T @ (SPRINGS[:, None] * operator)
        lowest.append(scipy.linalg.eigvalsh(stiffness, superelement.mass)[:6])
        sizes.append(superelement.size)
    assert (np.diff(sizes) > 0).all()
    assert (np.diff(lowest, axis=0) <= 1e-8 * np.array(lowest[:-1])).all()


def test_shapes_that_a_reduction_contains_add_nothing(held_block: Structure) -> None:
    recovery = craig_bampton(held_block, OTHER, 3).recovery
    contained = (recovery @ np.eye(recovery.shape[1]))[held_block.free_unknowns]
    assert recovery.with_shapes(contained[:, :2]).shape == recovery.shape
    assert recovery.with_shapes(contained).shape == recovery.shape


def test_the_motion_of_the_mesh_is_that_with_stuck_pairs(held_block: Structure) -> None:
    """The static response to a force inside, from a reduction without modes: exact with its omitted part."""
    superelement, pairs = partial(held_block, 0), three_pairs()
    load = np.zeros(held_block.full_size)
    load[3 * 37 + 1] = 100.0
    operator = held_block.of_unknowns(pairs.mesh_operator(held_block.mesh.n_nodes)).toarray()
    stiffness = held_block.stiffness.toarray() + operator.T @ (SPRINGS[:, None] * operator)
    exact = held_block.expand(np.linalg.solve(stiffness, held_block.gather(load)))
    of_pairs = superelement.operator(pairs)
    whole = superelement.stiffness + of_pairs.T @ (SPRINGS[:, None] * of_pairs)
    reduced = np.linalg.solve(whole, superelement.recovery.project(load[:, None]))
    found = superelement.recovery.with_omitted_modes(reduced, load[:, None])[:, 0]
    np.testing.assert_allclose(found, exact, atol=1e-8 * np.abs(exact).max())


def test_wrong_masks_springs_and_ties_are_rejected(held_block: Structure) -> None:
    for wrong in (np.array([True, False]), np.array([1, 0, 0]), [1, 2]):
        with rejects(InputError, "moving"):
            partial_superelement(held_block, three_pairs(), SPRINGS, wrong, OTHER)  # type: ignore[arg-type]
    with rejects(InputError, "springs"):
        partial_superelement(held_block, three_pairs(), SPRINGS[:3], ONE, OTHER)
    with rejects(InputError, "springs"):
        joined_modes(partial(held_block, 2), three_pairs(), 2)
