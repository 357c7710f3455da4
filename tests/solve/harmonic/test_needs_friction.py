"""A body that friction alone supports is found without a factor of the structure without friction."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.support import StaticFactor, needs_friction, only_friction_supports
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
