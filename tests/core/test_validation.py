"""The checks of single values that all modules share: what passes, and the sentence for what does not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.law.closed_forms import mindlin_stiffness
from stickslip.core.errors import InputError
from stickslip.core.threads import thread_count
from stickslip.core.validation import (
    finite_array,
    positive_number,
    real_number,
    require_allowed,
    require_choice,
    symmetric_matrix,
    whole_number,
)
from stickslip.model.kinds.two_blade_geometry import BladePairElements
from stickslip.structure.elasticity import Material


@pytest.mark.parametrize("value", ["2.4", "1e-8 m", None, True, 1j, [2.4], np.array([2.4, 2.5]), 10**400])
def test_what_is_no_number_is_named(value: object) -> None:
    for check in (real_number, positive_number):
        with rejects(InputError, "some_name"):
            check("some_name", value)
    assert real_number("some_name", np.float32(2.5)) == 2.5


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -np.inf])
def test_numbers_are_finite(value: float) -> None:
    with rejects(InputError, "some_name"):
        positive_number("some_name", value, "m")


def test_positive_numbers_are_above_zero() -> None:
    assert positive_number("load", np.int64(3), "N") == 3.0
    for value in (0, -0.5):
        with rejects(InputError, "load"):
            positive_number("load", value, "N")
        with rejects(InputError, "ratio"):
            positive_number("ratio", value)


@pytest.mark.parametrize("value", [0, -3, 2.0, 2.5, True, "2", None, np.float64(2.0)])
def test_whole_numbers_have_a_least(value: object) -> None:
    with rejects(InputError, "steps"):
        whole_number("steps", value, 1)


def test_whole_numbers_become_integers() -> None:
    actual = [whole_number("seed", value, 0) for value in (0, np.int32(7))]
    assert actual == [0, 7]
    assert [type(each) for each in actual] == [int, int]


def test_choices_are_listed() -> None:
    require_choice("mode", "paper", ("consistent", "paper"))
    for value in ("Paper", None, ["paper"]):
        with rejects(InputError, "mode"):
            require_choice("mode", value, ("consistent", "paper"))  # type: ignore[arg-type]


def test_the_allowed_range_is_reported() -> None:
    require_allowed("angle", 45.0, True, "between 0 and 90 degrees")
    with rejects(InputError, "angle"):
        require_allowed("angle", 95.0, False, "between 0 and 90 degrees")


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda: Material(young_modulus=0.0), "young_modulus"),
        (lambda: Material(density=[7800.0, 7800.0]), "density"),  # type: ignore[arg-type]
        (lambda: Material(poisson_ratio=0.5), "poisson_ratio"),
        (lambda: BladePairElements(chordwise=2.5), "chordwise"),  # type: ignore[arg-type]
        (lambda: thread_count("two"), "threads"),  # type: ignore[arg-type]
        (
            lambda: mindlin_stiffness(1e-3, 1e11, 0.6),
            "poisson_ratio",
        ),
        (lambda: mindlin_stiffness(0.0, 1e11, 0.3), "contact_radius"),
    ],
)
def test_modules_use_them(call: Callable[[], object], key: str) -> None:
    with rejects(InputError, key):
        call()


def test_a_number_alone_must_be_finite_too() -> None:
    with rejects(InputError, "x"):
        finite_array("x", np.nan)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_single_number_that_is_not_finite_is_rejected_as_an_entry_of_an_array_is(value: float) -> None:
    with rejects(InputError, "height"):
        finite_array("height", value)


def test_a_symmetric_matrix_does_not_follow_later_changes_of_its_array() -> None:
    given = np.array([[2.0, 1.0], [1.0, 3.0]])
    kept = symmetric_matrix("stiffness", given)
    given[0, 0] = 9.0
    assert kept.tolist() == [[2.0, 1.0], [1.0, 3.0]]
