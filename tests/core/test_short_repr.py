"""Each public object is one short line when it is printed."""

from __future__ import annotations

import inspect
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from stickslip.core.short_repr import short_repr


@dataclass(frozen=True)
class Sample:
    value: Any
    absent: None = None

    __repr__ = short_repr


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (np.array([1.0, 2.5]), "[1, 2.5]"),
        (np.full((110, 2), 3.0), "(110, 2) of 3"),
        (np.linspace(-1.0, 2.0, 7), "(7,) from -1 to 2"),
        (np.array([[1.0, np.nan], [3.0, 2.0]]), "(2, 2) from 1 to 3"),
        (np.full((2, 2), np.nan), "(2, 2) float64"),
        (np.array([True, False, True, True]), "(4,) 3 True"),
        (np.empty((0, 3)), "(0, 3) float64"),
        (np.array(["a", "b"]), "['a', 'b']"),
        (1e11 / 3.0, "3.33333e+10"),
        ({"a": 1}, "{'a': 1}"),
        (tuple(range(9)), "9 entries"),
        ("x" * 200, "'" + "x" * 86 + "..."),
    ],
)
def test_values(value: Any, text: str) -> None:
    assert repr(Sample(value)) == f"Sample(value={text})"


def test_a_law_of_many_pairs_is_one_line() -> None:
    law = ss.JenkinsElement(np.full(110, 1e6), np.linspace(1.0, 2.0, 110))
    assert repr(law) == (
        "JenkinsElement(rest_normal_force=(110,) of 0, tangential_stiffness=(110, 2) of 1e+06, "
        "friction_limit=(110, 2) from 1 to 2, normal_stiffness=(110,) of 0)"
    )


def test_a_case_names_the_keys_that_differ_from_their_defaults() -> None:
    assert repr(ss.Case()) == ("TwoBladeCase('Two blades with an under-platform damper': all keys have their defaults)")
    changed = ss.Case.from_mapping({"friction": {"coefficient": 0.45}})
    assert str(changed) == "TwoBladeCase('Two blades with an under-platform damper': friction.coefficient = 0.45)"


PUBLIC = [each for each in (getattr(ss, name) for name in ss.__all__) if inspect.isclass(each)]


@pytest.mark.parametrize("kind", [each for each in PUBLIC if is_dataclass(each) and not inspect.isabstract(each)])
def test_no_public_object_prints_its_arrays(kind: type) -> None:
    has_arrays = any("Array" in str(each.type) for each in fields(kind))
    is_generated = hasattr(kind.__repr__, "__wrapped__")  # by the decorator of dataclasses
    assert not (has_arrays and is_generated)
