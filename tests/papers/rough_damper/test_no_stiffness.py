"""Faces to which the published sums give no stiffness: the load, the G and the D of the message have one as
printed, and the digit before has none."""

from __future__ import annotations

import re
from dataclasses import replace
from math import log10

import numpy as np
import pytest

from rough_faces import rough
from stickslip.contact.stiffness.asperities import Roughness, fully_plastic_load
from stickslip.contact.stiffness.fractal import published_contact
from stickslip.papers.rough_damper.no_stiffness import why_no_stiffness


def is_elastic(face: Roughness, load: float) -> bool:
    """Whether the published sums give a stiffness."""
    found = published_contact(face, load, "varying-curvature")
    assert (found.normal > 0) == (found.tangential > 0)
    return found.normal > 0


def number_after(words: str, sentence: str) -> float | None:
    actual = re.search(rf"{words} ([0-9.e+-]+)", sentence)
    return None if actual is None else float(actual[1])


def last_digit(value: float, digits: int) -> float:
    return float(10.0 ** (np.floor(log10(value)) - digits + 1))


@pytest.mark.parametrize("dimension", [2.12, 2.2, 2.3004, 2.37, 2.6])
@pytest.mark.parametrize("scale", [3e-9, 1e-8, 2.7e-7])
@pytest.mark.parametrize("share", [0.999, 0.51, 0.2])
def test_what_is_named_works_as_printed_and_the_digit_before_does_not(
    dimension: float, scale: float, share: float
) -> None:
    face = rough(dimension, scale)
    load = share * fully_plastic_load(face)
    sentence = why_no_stiffness(face, load)

    needed = number_after("raise the load above", sentence)
    assert needed is not None
    assert is_elastic(face, needed)
    assert not is_elastic(face, needed - 1.001 * last_digit(needed, 4))

    finer = number_after("set G below", sentence)
    assert finer is not None
    assert is_elastic(replace(face, fractal_roughness=finer), load)
    assert not is_elastic(replace(face, fractal_roughness=finer + 1.001 * last_digit(finer, 3)), load)

    smoother = number_after("raise D to", sentence)
    assert smoother is not None
    assert dimension < smoother <= 2.95
    assert is_elastic(replace(face, fractal_dimension=smoother), load)
    assert not is_elastic(replace(face, fractal_dimension=max(smoother - 0.001, dimension)), load)


def test_no_dimension_is_named_where_none_below_the_limit_is_enough() -> None:
    face, load = rough(2.3, 1e-5), 0.01
    assert number_after("raise D to", why_no_stiffness(face, load)) is None
    for step in range(2301, 2951):
        assert fully_plastic_load(replace(face, fractal_dimension=step / 1000)) > load
    # Above the minimum a larger D only makes it worse, although a smaller one would do.
    load = 0.999 * fully_plastic_load(rough(2.92))
    assert number_after("raise D to", why_no_stiffness(rough(2.92), load)) is None
    assert is_elastic(rough(2.88), load)
    # Within 0.05 of 3 nothing is proposed, not even what would do.
    hard = rough(2.949, hardness=1e5)  # E*/H of 1e6: the minimum lies above 2.95
    load = 1.0001 * fully_plastic_load(replace(hard, fractal_dimension=2.951))
    assert load < fully_plastic_load(replace(hard, fractal_dimension=2.95))
    assert number_after("raise D to", why_no_stiffness(hard, load)) is None
