"""Constants of the pairs: the traction at rest must be admissible."""

from __future__ import annotations

import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError


def pairs_with(traction: object, preload: object = 2.0) -> ContactPairs:
    return ContactPairs(np.zeros((6, 1)), 1.0, 3.0, 0.4, preload, traction)  # type: ignore[arg-type]


def test_released_pairs_rest_without_traction() -> None:
    pairs = pairs_with(None)
    assert pairs.released
    assert not pairs.resting_traction.any()


def test_round_off_beyond_the_limit_is_cut() -> None:
    pairs = pairs_with([[0.8 * (1.0 + 1e-9), 0.0], [0.0, 0.1]])
    assert not pairs.released
    np.testing.assert_allclose(pairs.resting_traction, [[0.8, 0.0], [0.0, 0.1]], rtol=1e-15)


@pytest.mark.parametrize(
    ("traction", "preload"),
    [
        ([0.1, 0.2], 2.0),
        ([[0.0, 0.0], [0.7, 0.7]], 2.0),
        ([[0.1, 0.0], [0.0, 0.0]], [-1.0, 2.0]),
        ([[np.nan, 0.0], [0.0, 0.0]], 2.0),
    ],
)
def test_tractions_that_friction_cannot_carry_are_rejected(traction: object, preload: object) -> None:
    with rejects(InputError, "residual_traction"):
        pairs_with(traction, preload)


def test_springs_at_rest_leave_gaps_out() -> None:
    pairs = pairs_with(None, [-1.0, 2.0])
    np.testing.assert_array_equal(pairs.closed_at_rest, [False, True])
    np.testing.assert_array_equal(pairs.resting_stiffness(), [0.0, 0.0, 0.0, 3.0, 3.0, 1.0])
