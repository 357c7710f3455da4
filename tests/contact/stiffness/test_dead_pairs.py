"""Equation 8: pairs without stiffness are refused with a load, a G and a D that work as printed, and the digit before
does not."""

from __future__ import annotations

import re
from dataclasses import replace
from math import log, log10, pi, sqrt

import numpy as np
import pytest

from rough_faces import NOMINAL_AREA, pair_stiffness, rough
from sentences import rejects
from stickslip.contact.stiffness.asperities import Roughness, fully_plastic_load
from stickslip.core.errors import RoughnessError

AREA = np.full(4, NOMINAL_AREA / 4)


def is_elastic(face: Roughness, load: float) -> bool:
    """Whether a face load gives a stiffness; it is refused otherwise."""
    try:
        normal, tangential = pair_stiffness(face, AREA, load / 4, mode="varying-curvature")
    except RoughnessError:
        return False
    assert (normal > 0).all()
    assert (tangential > 0).all()
    return True


def rejection(face: Roughness, load: float) -> str:
    with rejects(RoughnessError) as caught:
        pair_stiffness(face, AREA, load / 4, mode="varying-curvature")
    return str(caught.value)


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
    sentence = rejection(face, load)

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
    assert number_after("raise D to", rejection(face, load)) is None
    for step in range(2301, 2951):
        assert fully_plastic_load(replace(face, fractal_dimension=step / 1000)) > load
    # Above the minimum a larger D only makes it worse, although a smaller one would do.
    load = 0.999 * fully_plastic_load(rough(2.92))
    assert number_after("raise D to", rejection(rough(2.92), load)) is None
    assert is_elastic(rough(2.88), load)
    # Within 0.05 of 3 nothing is proposed, not even what would do.
    hard = rough(2.949, hardness=1e5)  # E*/H of 1e6: the minimum lies above 2.95
    load = 1.0001 * fully_plastic_load(replace(hard, fractal_dimension=2.951))
    assert load < fully_plastic_load(replace(hard, fractal_dimension=2.95))
    assert number_after("raise D to", rejection(hard, load)) is None


@pytest.mark.parametrize("scale", [1e-10, 1e-8, 1e-6])
@pytest.mark.parametrize("hardness", [1e8, 3e9, 1e10])
@pytest.mark.parametrize("psi", [1.0, 2.5])
def test_fully_plastic_load_falls_with_the_dimension_and_rises_again(scale: float, hardness: float, psi: float) -> None:
    """One minimum over 2 < D < 3: the load is not monotone, and elastic spots exist in one range of D alone."""
    dimension = np.linspace(2.02, 2.999, 980)
    load = [fully_plastic_load(rough(D, scale, hardness=hardness, domain_extension=psi)) for D in dimension]
    rising = np.diff(load) > 0
    assert not rising[0]
    assert rising[-1]
    assert np.count_nonzero(np.diff(rising)) == 1
    if psi == 1.0:  # the derivative of 2 c / x + ln[(1 + x)/(1 - x)], x = D - 2, is zero there
        c = log(2**3.5 / (3 * pi) * sqrt(log(1.5)) * 108.2417582e9 / hardness)
        assert dimension[np.argmin(load)] == pytest.approx(2.0 + sqrt(c / (1.0 + c)), abs=1.1e-3)


def test_unloading_and_one_spot_of_the_real_area_have_a_stiffness_where_equation_8_has_none() -> None:
    with rejects(RoughnessError):
        pair_stiffness(rough(2.3), AREA, 125.0, mode="varying-curvature")
    unloading, _ = pair_stiffness(rough(2.3, shortest_length=1e-6), AREA, 125.0, mode="unloading")
    least, _ = pair_stiffness(rough(2.3), AREA, 125.0, mode="consistent")
    assert (unloading > least).all()
    assert (least > 0).all()
