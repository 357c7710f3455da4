"""Recovery of the full mesh: a product like any matrix, also after pickling."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse.linalg

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Structure
from stickslip.structure.recovery import reduced_load


def test_it_is_a_linear_map_of_columns_and_vectors(held_block: Structure) -> None:
    recovery = craig_bampton(held_block, [40, 20], 6).recovery
    assert recovery.shape == (3 * held_block.mesh.n_nodes, 12)
    columns = np.random.default_rng(0).normal(size=(12, 3))
    together = recovery @ columns
    for k in range(3):
        np.testing.assert_allclose(together[:, k], recovery @ columns[:, k], atol=1e-13)


def test_a_pickled_recovery_leaves_its_factor_behind_and_makes_it_again(held_block: Structure) -> None:
    recovery = craig_bampton(held_block, [40, 20], 6).recovery
    motion = np.random.default_rng(1).normal(size=12)
    again = pickle.loads(pickle.dumps(recovery))
    assert again._factor is None
    np.testing.assert_allclose(again @ motion, recovery @ motion, atol=1e-13)


def test_projected_loads_give_exact_static_boundary_displacements(held_block: Structure) -> None:
    """K u = f solved in full, against the reduced system under T^T f, for loads on every node."""
    superelement = craig_bampton(held_block, [40, 20], 3)
    load = np.random.default_rng(2).normal(size=(3 * held_block.mesh.n_nodes, 2))
    reduced = np.linalg.solve(superelement.stiffness, reduced_load(superelement, load))
    full = scipy.sparse.linalg.spsolve(held_block.stiffness.tocsc(), load[held_block.free_unknowns])
    boundary = held_block.unknowns_of(np.array([40, 20])).ravel()
    np.testing.assert_allclose(reduced[:6], full[boundary], rtol=1e-8)


def test_a_projected_row_reads_the_recovered_displacement(held_block: Structure) -> None:
    superelement = craig_bampton(held_block, [40, 20], 3)
    generator = np.random.default_rng(3)
    row, motion = generator.normal(size=3 * held_block.mesh.n_nodes), generator.normal(size=9)
    assert reduced_load(superelement, row) @ motion == pytest.approx(row @ (superelement.recovery @ motion))


def test_loads_without_recovery_or_of_another_length_are_rejected(held_block: Structure) -> None:
    superelement = craig_bampton(held_block, [40, 20], 3)
    with rejects(InputError, "load"):
        reduced_load(superelement, np.zeros(7))
    with rejects(InputError):
        reduced_load(replace(superelement, recovery=None), np.zeros(7))


def test_constant_loads_have_their_exact_displacements_with_the_omitted_modes(held_block: Structure) -> None:
    superelement = craig_bampton(held_block, [40, 20], 3)
    load = np.random.default_rng(2).normal(size=(3 * held_block.mesh.n_nodes, 1))
    reduced = np.linalg.solve(superelement.stiffness, reduced_load(superelement, load))
    exact = np.zeros_like(load)
    exact[held_block.free_unknowns, 0] = scipy.sparse.linalg.spsolve(
        held_block.stiffness.tocsc(), load[held_block.free_unknowns]
    )
    moved = superelement.recovery.with_omitted_modes(reduced, load)
    np.testing.assert_allclose(moved, exact, atol=1e-8 * np.abs(exact).max())
    assert np.abs(superelement.recovery @ reduced - exact).max() > 1e-2 * np.abs(exact).max()


def test_the_omitted_modes_follow_a_vibration_more_closely(held_block: Structure) -> None:
    """(K - w^2 M) u = f solved in full: the error with the static part of the omitted modes is much smaller."""
    superelement = craig_bampton(held_block, [40, 20], 4)
    load = np.zeros((3 * held_block.mesh.n_nodes, 3))
    load[held_block.free_unknowns, 1] = np.random.default_rng(5).normal(size=held_block.free_unknowns.size)
    omega = 0.2 * np.sqrt(np.diag(superelement.stiffness)[6] / np.diag(superelement.mass)[6])
    dynamic = superelement.stiffness - omega**2 * superelement.mass
    reduced = np.linalg.solve(dynamic, reduced_load(superelement, load))
    free = held_block.free_unknowns
    exact = scipy.sparse.linalg.spsolve((held_block.stiffness - omega**2 * held_block.mass).tocsc(), load[free, 1])
    plain, moved = superelement.recovery @ reduced, superelement.recovery.with_omitted_modes(reduced, load, omega)
    errors = [np.linalg.norm(each[free, 1] - exact) for each in (plain, moved)]
    assert errors[1] < 0.2 * errors[0]
    assert not moved[:, [0, 2]].any()
