"""Faces without elastic spots: their load, their G, and the least stiffness that their real area has."""

from __future__ import annotations

from dataclasses import replace
from math import log, pi, sqrt

import numpy as np
import pytest

import stickslip as ss
from helpers import benchmark_module, matched
from rough_faces import HARDNESS, MINDLIN, NOMINAL_AREA, REDUCED_MODULUS, pair_stiffness, rough
from sentences import printed_sentence
from stickslip.contact.stiffness.asperities import fully_plastic_load
from stickslip.contact.stiffness.fractal import ContactStatus, StiffnessMode, fractal_contact, published_contact

ELASTIC_MODES = pytest.mark.parametrize("mode", ["consistent", "varying-curvature"])


@ELASTIC_MODES
@pytest.mark.parametrize("load", [1e-6, 1.0, 500.0])
def test_a_fully_plastic_face_is_as_stiff_as_one_round_spot_of_its_real_area(mode: StiffnessMode, load: float) -> None:
    """Closed form: the area F/H in one flat punch, K = 2 E* sqrt(F / (pi H))."""
    face = rough(2.3)
    found = ss.contact_stiffness(face, load, mode)
    assert found.status is ContactStatus.FULLY_PLASTIC
    assert found.normal == pytest.approx(2 * REDUCED_MODULUS * sqrt(load / (pi * HARDNESS)), rel=1e-9)
    assert found.tangential == pytest.approx(MINDLIN * found.normal, rel=1e-12)
    assert published_contact(face, load, mode).normal == 0.0
    printed_sentence(found.messages[0], "Fully plastic")
    printed_sentence(found.messages[1], "Few elastic spots")
    normal, _ = pair_stiffness(face, np.full(4, NOMINAL_AREA / 4), load / 4, mode=mode)
    assert normal.sum() == pytest.approx(found.normal, rel=1e-12)


@ELASTIC_MODES
@pytest.mark.parametrize("dimension", [2.12, 2.3, 2.45, 2.6])
def test_stiffness_rises_with_the_load_without_a_jump_where_elastic_spots_begin(
    mode: StiffnessMode, dimension: float
) -> None:
    face = rough(dimension)
    loads = fully_plastic_load(face) * np.geomspace(0.01, 100.0, 400)
    found = [fractal_contact(face, float(load), mode) for load in loads]
    power = np.diff(np.log([each.normal for each in found])) / np.diff(np.log(loads))
    assert power.min() > 0.3  # 1/2 of the plastic area; an elastic spot has half the area of a plastic one
    assert power.max() < 2.0
    statuses = [each.status for each in found]
    assert {ContactStatus.FULLY_PLASTIC, ContactStatus.FEW_ELASTIC_SPOTS} < set(statuses)
    assert found[-1].normal == published_contact(face, float(loads[-1]), mode).normal


@pytest.mark.parametrize("load", [1.0, 500.0, 5000.0])
def test_all_spots_together_are_never_softer_than_the_bound(load: float) -> None:
    """Unloading sums 2 E* a of each spot; one spot of the same area has the least sum."""
    face = rough(2.3, shortest_length=1e-6)
    assert fractal_contact(face, load, "unloading") == published_contact(face, load, "unloading")


def test_no_contact_of_boundary_elements_is_softer_than_one_round_spot_of_its_area() -> None:
    """256 resolved contacts of rough faces, elastic and plastic: 2 E* sqrt(A_r / pi) over their stiffness."""
    laws = benchmark_module("laws_against_boundary_elements")
    rows = [row for group in ("fit", "test", "wide", "again") for row in laws.read(group)[0]]
    area = np.array([laws.area_of(row) for row in rows])
    fraction, modulus, stiffness = (
        np.array([row[key] for row in rows]) for key in ("contact_fraction", "modulus", "normal")
    )
    bound = 2.0 * modulus * np.sqrt(fraction * area / pi) / (stiffness * area)
    assert len(rows) == 256
    assert bound.max() <= 1.0
    assert bound.max() > 0.99


def test_a_face_without_load_has_no_stiffness() -> None:
    assert fractal_contact(rough(2.3), 0.0).normal == 0.0


@pytest.mark.parametrize("dimension", [2.12, 2.2, 2.3004, 2.37, 2.6])
@pytest.mark.parametrize("scale", [3e-9, 1e-8, 2.7e-7])
@pytest.mark.parametrize("share", [0.999, 0.51, 0.2])
def test_the_load_and_the_g_of_the_message_have_elastic_spots(dimension: float, scale: float, share: float) -> None:
    face = rough(dimension, scale)
    load = share * fully_plastic_load(face)
    message = fractal_contact(face, load).messages[0]
    needed, finer = (float(matched(text, message).group(1)) for text in (r"a load above (\S+) N", r"G below (\S+) m"))
    off = 0.006  # three digits are printed
    assert published_contact(face, (1.0 + off) * needed).normal > 0.0
    assert published_contact(face, (1.0 - off) * needed).normal == 0.0
    assert published_contact(replace(face, fractal_roughness=(1.0 - off) * finer), load).normal > 0.0
    assert published_contact(replace(face, fractal_roughness=(1.0 + off) * finer), load).normal == 0.0


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
