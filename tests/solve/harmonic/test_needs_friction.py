"""A body that friction alone supports is found without a factor of the structure without friction."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.damping import modal_basis, stuck_stiffness_matrix
from stickslip.solve.harmonic.support import ModalStatic, StaticFactor, needs_friction, only_friction_supports
from stickslip.solve.setting_up import Balances, prepare_balances
from stickslip.structure.superelement import Superelement

PAIRS = 12


def elastic_body(free: FloatArray, spring: float) -> Superelement:
    """A body without strain in the motions ``free`` (n, k), held by springs in all directions."""
    size, random = len(free), np.random.default_rng(3)
    strain = random.standard_normal((size, size))
    strain -= strain @ np.linalg.qr(free)[0] @ np.linalg.qr(free)[0].T
    return Superelement(np.eye(size), 1e6 * strain.T @ strain + spring * np.eye(size))


@pytest.mark.parametrize(
    ("directions", "spring", "expected"),
    [
        ([0], 0.0, True),  # slides along t1
        ([0, 1], 0.0, True),  # along both
        ([2], 0.0, False),  # the normal springs hold it
        ([0], 10.0, False),  # a soft spring holds it: far above round-off
        ([], 0.0, False),
    ],
)
def test_motions_that_only_friction_resists(directions: list[int], spring: float, expected: bool) -> None:
    free = np.zeros((3 * PAIRS, 3))
    for direction in directions:
        free[direction::3, direction] = 1.0
    free = free[:, directions] if directions else np.zeros((3 * PAIRS, 1))
    structure = elastic_body(free, spring) if directions else Superelement(np.eye(36), 1e6 * np.eye(36))
    pairs = ContactPairs(np.eye(3 * PAIRS), 1e6, 5e5, 0.3, 10.0)
    stuck = StaticFactor.build(structure, pairs, pairs.resting_stiffness().reshape(-1, 3))
    assert needs_friction(structure, pairs, stuck) == expected
    assert only_friction_supports(structure, pairs) == expected


def sliding_body() -> Superelement:
    """A body that slides freely along t1."""
    free = np.zeros((3 * PAIRS, 1))
    free[0::3] = 1.0
    return elastic_body(free, 0.0)


def springs_of(stiffness: float, preload: float | FloatArray = 10.0) -> ContactPairs:
    return ContactPairs(np.eye(3 * PAIRS), stiffness, 0.5 * stiffness, 0.3, preload)


def balances_of(structure: Superelement, pairs: ContactPairs, known: Balances | None = None) -> Balances:
    excitation = Excitation.force(np.ones(structure.size))
    stuck = None if known is None else known.stuck
    return prepare_balances(structure, pairs, excitation, 100.0, 1, 16, 0.01, "tractrix", lambda words: None, stuck)


def test_what_only_friction_supports_is_known_where_springs_alone_differ() -> None:
    structure = sliding_body()
    known = balances_of(structure, springs_of(1e6))
    assert not known.pairs.released
    assert known.stuck.needs_friction(structure, springs_of(2e6))
    gap = np.where(np.arange(PAIRS) == 3, -1.0, 10.0)
    assert not known.stuck.needs_friction(structure, springs_of(2e6, gap))  # other springs at rest
    assert not known.stuck.needs_friction(sliding_body(), springs_of(2e6))  # another structure
    held = balances_of(Superelement(np.eye(36), 1e6 * np.eye(36)), springs_of(1e6))
    assert not held.stuck.needs_friction(held.superelement, springs_of(2e6))
    # The mean of the other springs is the same with known modes, by which it is computed, and without.
    from_known, alone = (balances_of(structure, springs_of(2e6), each) for each in (known, None))
    assert isinstance(from_known.stuck.mean, ModalStatic)
    assert isinstance(alone.stuck.mean, StaticFactor)
    assert not from_known.pairs.released
    assert from_known.stuck.floats
    scale = np.abs(alone.stuck.mean_contact).max()
    assert np.abs(from_known.stuck.mean_contact - alone.stuck.mean_contact).max() < 1e-9 * scale
    forces = np.random.default_rng(5).standard_normal((36, 2))
    for force in (forces, forces[:, 0]):
        expected = alone.stuck.mean.solve(force)
        assert np.abs(from_known.stuck.mean.solve(force) - expected).max() < 1e-9 * np.abs(expected).max()


def test_modes_of_a_singular_structure_are_no_static_response() -> None:
    frictionless = ContactPairs(np.eye(3 * PAIRS), 1e6, 1e-9, 0.3, 10.0)
    structure = sliding_body()
    frequency, modes = modal_basis(structure.mass, stuck_stiffness_matrix(structure, frictionless))
    assert ModalStatic.of_modes(frequency, modes) is None
