"""Wrong matrices, operators and constants of pairs are refused at once, with their name and what was found."""

from typing import Any

import numpy as np
import pytest
import scipy.sparse

from sentences import rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.structure.superelement import Superelement

STIFFNESS = np.array([[3.0, -1.0, 0.0], [-1.0, 3.0, -1.0], [0.0, -1.0, 3.0]])
GOOD_PAIRS: dict[str, Any] = {
    "operator": np.ones((6, 3)),
    "normal_stiffness": 1e7,
    "tangential_stiffness": 8e6,
    "friction_coefficient": 0.3,
    "preload": 2.0,
}


def with_entry(matrix: np.ndarray, value: float) -> np.ndarray:
    """A copy of ``matrix`` with ``value`` at [0, 1] only."""
    changed = matrix.copy()
    changed[0, 1] = value
    return changed


@pytest.mark.parametrize(
    ("matrices", "keys"),
    [
        ({"mass": np.ones((2, 3))}, ("mass",)),
        ({"mass": np.ones(3)}, ("mass",)),
        ({"stiffness": with_entry(STIFFNESS, 2.0)}, ("stiffness",)),
        ({"stiffness": np.eye(4)}, ("stiffness",)),
        ({"damping": np.eye(2)}, ("damping",)),
        ({"damping": with_entry(np.eye(3), 1.0)}, ("damping",)),
        ({"mass": with_entry(np.eye(3), np.nan)}, ("mass",)),
        ({"stiffness": with_entry(STIFFNESS, np.inf)}, ("stiffness",)),
        ({"stiffness": scipy.sparse.csr_matrix(with_entry(STIFFNESS, 2.0))}, ("stiffness",)),
        ({"mass": [["a", "b"], ["c", "d"]]}, ("mass",)),
        pytest.param(
            {"stiffness": 1j * np.eye(3)},
            ("stiffness",),
        ),
    ],
)
def test_superelement(matrices: dict[str, Any], keys: tuple[str, ...]) -> None:
    arguments = {"mass": np.eye(3), "stiffness": STIFFNESS} | matrices
    with rejects(InputError, *keys):
        Superelement(**arguments)


def test_round_off_asymmetry_is_accepted_and_removed() -> None:
    element = Superelement(np.eye(3), with_entry(STIFFNESS, -1.0 + 1e-12))
    assert np.array_equal(element.stiffness, element.stiffness.T)


@pytest.mark.parametrize(
    ("constants", "key"),
    [
        ({"operator": np.ones((5, 3))}, "operator"),
        ({"operator": np.ones(6)}, "operator"),
        ({"operator": np.ones((0, 3))}, "operator"),
        ({"operator": np.full((3, 3), np.nan)}, "operator"),
        ({"normal_stiffness": [1e7, 0.0]}, "normal_stiffness"),
        ({"tangential_stiffness": 0.0}, "tangential_stiffness"),
        ({"tangential_stiffness": [[1e7, 1e7], [1e7, -1.0]]}, "tangential_stiffness"),
        ({"normal_stiffness": np.ones(3)}, "normal_stiffness"),
        ({"friction_coefficient": -0.3}, "friction_coefficient"),
        ({"friction_coefficient": 0.0}, "friction_coefficient"),
        ({"preload": [1.0, np.inf]}, "preload"),
        ({"preload": np.ones((2, 2))}, "preload"),
    ],
)
def test_contact_pairs(constants: dict[str, Any], key: str) -> None:
    with rejects(InputError, key):
        ContactPairs(**(GOOD_PAIRS | constants))


def test_negative_preload_is_a_gap_and_allowed() -> None:
    assert ContactPairs(**(GOOD_PAIRS | {"preload": -1.0})).preload.tolist() == [-1.0, -1.0]
