"""Recovery of the full mesh: a product like any matrix, also after pickling."""

from __future__ import annotations

import pickle

import numpy as np

from stickslip.structure.craig_bampton import craig_bampton


def test_it_is_a_linear_map_of_columns_and_vectors(held_block):
    recovery = craig_bampton(held_block, [40, 20], 6).recovery
    assert recovery.shape == (3 * held_block.mesh.n_nodes, 12)
    columns = np.random.default_rng(0).normal(size=(12, 3))
    together = recovery @ columns
    for k in range(3):
        np.testing.assert_allclose(together[:, k], recovery @ columns[:, k], atol=1e-13)


def test_a_pickled_recovery_leaves_its_factor_behind_and_makes_it_again(held_block):
    recovery = craig_bampton(held_block, [40, 20], 6).recovery
    motion = np.random.default_rng(1).normal(size=12)
    again = pickle.loads(pickle.dumps(recovery))
    assert again._factor is None
    np.testing.assert_allclose(again @ motion, recovery @ motion, atol=1e-13)
