"""Wrong matrices, operators and constants of pairs are refused at once, with their name and what was found."""

from typing import Any

import numpy as np
import pytest
import scipy.sparse

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
    ("matrices", "parts"),
    [
        ({"mass": np.ones((2, 3))}, ["mass", "square", "(2, 3)"]),
        ({"mass": np.ones(3)}, ["mass", "square", "(3,)"]),
        ({"stiffness": with_entry(STIFFNESS, 2.0)}, ["stiffness", "symmetric", "[0, 1] = 2", "[1, 0] = -1", "0.5 *"]),
        ({"stiffness": np.eye(4)}, ["stiffness", "(4, 4)", "(3, 3)"]),
        ({"damping": np.eye(2)}, ["damping", "(2, 2)", "(3, 3)"]),
        ({"damping": with_entry(np.eye(3), 1.0)}, ["damping", "symmetric"]),
        ({"mass": with_entry(np.eye(3), np.nan)}, ["mass[0, 1] is nan", "finite"]),
        ({"stiffness": with_entry(STIFFNESS, np.inf)}, ["stiffness[0, 1] is inf", "finite"]),
        ({"stiffness": scipy.sparse.csr_matrix(with_entry(STIFFNESS, 2.0))}, ["stiffness", "symmetric"]),
        ({"mass": [["a", "b"], ["c", "d"]]}, ["mass", "real numbers"]),
        pytest.param(
            {"stiffness": 1j * np.eye(3)},
            ["stiffness", "real"],
        ),
    ],
)
def test_superelement(matrices: dict[str, Any], parts: list[str]) -> None:
    arguments = {"mass": np.eye(3), "stiffness": STIFFNESS} | matrices
    with pytest.raises(InputError) as caught:
        Superelement(**arguments)
    assert [part for part in parts if part not in str(caught.value)] == []


def test_round_off_asymmetry_is_accepted_and_removed() -> None:
    element = Superelement(np.eye(3), with_entry(STIFFNESS, -1.0 + 1e-12))
    assert np.array_equal(element.stiffness, element.stiffness.T)


@pytest.mark.parametrize(
    ("constants", "parts"),
    [
        ({"operator": np.ones((5, 3))}, ["operator", "3 * n_pairs", "(5, 3)"]),
        ({"operator": np.ones(6)}, ["operator", "(6,)"]),
        ({"operator": np.ones((0, 3))}, ["operator", "(0, 3)"]),
        ({"operator": np.full((3, 3), np.nan)}, ["operator[0, 0] is nan"]),
        ({"normal_stiffness": [1e7, 0.0]}, ["normal_stiffness[1] is 0", "above 0", "roughness"]),
        ({"tangential_stiffness": 0.0}, ["tangential_stiffness[0] is 0", "above 0"]),
        ({"tangential_stiffness": [[1e7, 1e7], [1e7, -1.0]]}, ["tangential_stiffness", "-1", "above 0"]),
        ({"normal_stiffness": np.ones(3)}, ["normal_stiffness", "(2,)", "(3,)"]),
        ({"friction_coefficient": -0.3}, ["friction_coefficient[0] is -0.3", "above 0", "0.1 and 0.8"]),
        ({"friction_coefficient": 0.0}, ["friction_coefficient[0] is 0", "above 0"]),
        ({"preload": [1.0, np.inf]}, ["preload[1] is inf", "finite"]),
        ({"preload": np.ones((2, 2))}, ["preload", "(2, 2)"]),
    ],
)
def test_contact_pairs(constants: dict[str, Any], parts: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        ContactPairs(**(GOOD_PAIRS | constants))
    assert [part for part in parts if part not in str(caught.value)] == []


def test_negative_preload_is_a_gap_and_allowed() -> None:
    assert ContactPairs(**(GOOD_PAIRS | {"preload": -1.0})).preload.tolist() == [-1.0, -1.0]
