"""Rough contact at the ends of its range: elastic faces with a cut-off, tiny loads, D near 3, one reference area."""

from __future__ import annotations

from collections.abc import Callable
from math import exp, log, pi, sqrt

import numpy as np
import pytest

from rough_faces import NOMINAL_AREA, pair_stiffness, rough
from sentences import printed_sentence, rejects
from stickslip.contact.preload import uniform_preload
from stickslip.contact.stiffness.asperities import (
    domain_extension_factor,
    fully_plastic_load,
    spots_under_load,
)
from stickslip.contact.stiffness.fractal import ContactStatus, fractal_contact, reduced_modulus
from stickslip.contact.stiffness.fractal_law import FractalStiffness
from stickslip.contact.stiffness.stiffness_law import springs_of_pairs
from stickslip.contact.stiffness.surface import fractal_roughness_from_sq, frequency_count, structure_function_limit
from stickslip.core.errors import InputError, RoughnessError


@pytest.mark.parametrize(
    ("dimension", "scale", "pressure", "area_percent", "normal", "along_family"),
    [
        (2.2, 1e-8, 1e6, 0.00399, 2.629e6, 3.944e6),
        (2.2, 1e-11, 1e8, 2.13, 3.906e8, 5.859e8),
        (2.3, 1e-8, 1e7, 0.12, 4.836e7, 7.830e7),
        (2.4, 1e-8, 1e8, 4.74, 8.537e8, 1.518e9),
        (2.49, 1e-8, 1e6, 0.0732, 3.435e7, 6.781e7),
        (2.49, 1e-7, 1e8, 3.74, 7.759e8, 1.531e9),
    ],
)
def test_elastic_face_with_a_cut_off(
    dimension: float, scale: float, pressure: float, area_percent: float, normal: float, along_family: float
) -> None:
    """Independent evaluation of the law with elastic spots only, from pi (Ls/2)^2 upwards (6.5 mm square)."""
    length, d = 6.5e-3, dimension - 1
    face = rough(dimension, scale, hardness=1e14, shortest_length=length / 1.5**10)  # too hard for a plastic spot
    actual = fractal_contact(face, pressure * length**2, "unloading")
    assert actual.plastic_load_share == 0.0
    assert actual.normal == pytest.approx(normal, rel=5e-4)
    assert actual.normal * 2 * (3 - d) / (3 * (2 - d)) == pytest.approx(along_family, rel=5e-4)
    assert 100 * actual.real_area / length**2 == pytest.approx(area_percent, rel=4e-3)


@pytest.mark.parametrize("psi", [1.0, 1.7, domain_extension_factor(2.3)])
def test_elastic_spots_begin_at_the_fully_plastic_load(psi: float) -> None:
    face = rough(2.3, domain_extension=psi)
    threshold = fully_plastic_load(face)
    assert fractal_contact(face, 0.999 * threshold).status == ContactStatus.FULLY_PLASTIC
    assert fractal_contact(face, 1.001 * threshold).normal > 0.0


def test_dimension_next_to_three_has_a_status() -> None:
    actual = fractal_contact(rough(2.9999), 500.0)
    assert actual.normal > 0.0
    assert actual.status == ContactStatus.STEEP_ASPERITIES
    printed_sentence(actual.messages[-1], "within 0.05")


@pytest.mark.slow
@pytest.mark.parametrize("load", [50.0, 500.0, 5000.0])
@pytest.mark.parametrize("hardness", [1e9, 3e9, 1e10])
def test_interference_over_radius_falls_with_g_and_is_least_in_the_middle_of_d(load: float, hardness: float) -> None:
    """What the warning of steep asperities advises: beyond there a larger D does harm."""
    dimensions = np.arange(2.2, 2.95, 0.01)

    def ratio(dimension: float, scale: float) -> float:
        face = rough(dimension, scale, hardness=hardness)
        area = exp(spots_under_load(face, load).log_median_area)
        interference = 2 * sqrt(log(1.5)) * scale ** (dimension - 2) * (2 * sqrt(area / pi)) ** (3 - dimension)
        return float(interference / sqrt(area / pi))

    by_scale = np.array([[ratio(D, scale) for D in dimensions] for scale in (1e-10, 1e-9, 1e-8, 1e-7)])
    assert (np.diff(by_scale, axis=0) > 0).all()
    least = dimensions[by_scale.argmin(axis=1)]
    assert ((least > 2.4) & (least < 2.7)).all(), least
    message = fractal_contact(rough(2.2, 1e-7, hardness=hardness), load).messages[-1]
    printed_sentence(message, f"{ratio(2.2, 1e-7):.2g}", "2.4", "2.7")


def test_a_load_below_one_smallest_spot_is_rejected() -> None:
    face = rough(2.4, 1.0, hardness=1e13, shortest_length=1e-5)
    with rejects(RoughnessError):
        fractal_contact(face, 1e-12, "unloading")
    assert fractal_contact(face, 1.0, "unloading").normal > 0.0


def test_faces_of_different_size_share_a_reference_area() -> None:
    area = NOMINAL_AREA * np.array([0.5, 0.5, 1.0, 1.0, 1.0])
    face, pressure = [0, 0, 1, 1, 1], 3e6
    normal, tangential = pair_stiffness(
        rough(), area, pressure * area, allocation="pressure", face=face, reference_area=NOMINAL_AREA
    )
    whole = fractal_contact(rough(), pressure * NOMINAL_AREA)
    np.testing.assert_allclose(normal, whole.normal * area / NOMINAL_AREA, rtol=1e-11)
    np.testing.assert_allclose(tangential, whole.tangential * area / NOMINAL_AREA, rtol=1e-11)
    by_face = pair_stiffness(rough(), area, pressure * area, allocation="pressure", face=face)[0]
    assert by_face[0] == pytest.approx(normal[0], rel=1e-11)  # that face has the reference area
    assert by_face[2] != pytest.approx(normal[2], rel=1e-3)


def test_an_open_pair_gets_the_reference_law_at_the_mean_pressure() -> None:
    area = np.full(4, NOMINAL_AREA / 4)
    normal, _ = pair_stiffness(
        rough(), area, [200.0, 200.0, 100.0, -30.0], allocation="pressure", reference_area=2 * NOMINAL_AREA
    )
    assert normal[3] == pytest.approx(fractal_contact(rough(), 1000.0).normal / 8, rel=1e-12)


def test_reference_area_out_of_range() -> None:
    with rejects(InputError, "reference_area"):
        pair_stiffness(rough(), np.ones(2), 1.0, allocation="pressure", reference_area=0.0)


def test_an_unloaded_face_beside_a_plastic_one_is_named_alone() -> None:
    area = np.full(4, NOMINAL_AREA / 2)
    with rejects(RoughnessError):
        springs_of_pairs(FractalStiffness(rough(2.3), NOMINAL_AREA), area, [50.0, 50.0, 0.0, 0.0], face=[0, 0, 1, 1])


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("fractal_dimension", lambda bad: rough(bad)),
        ("fractal_roughness", lambda bad: rough(2.4, bad)),
        ("hardness", lambda bad: rough(hardness=bad)),
        ("domain_extension", lambda bad: rough(domain_extension=bad)),
        ("shortest_length", lambda bad: rough(shortest_length=bad)),
        ("load", lambda bad: fractal_contact(rough(), bad)),
        ("area", lambda bad: fractal_contact(rough(), 1.0, area=bad)),
        ("first_young_modulus", lambda bad: reduced_modulus(bad, 0.3, 1.0, 0.3)),
        ("second_poisson_ratio", lambda bad: reduced_modulus(1.0, 0.3, 1.0, bad)),
        ("fractal_dimension", lambda bad: domain_extension_factor(bad)),
        ("fractal_roughness", lambda bad: structure_function_limit(1.0, 2.4, bad)),
        ("length", lambda bad: frequency_count(bad, 1e-6)),
        ("sq_height", lambda bad: fractal_roughness_from_sq(bad, 2.4, 0.028, 1e-6)),
        ("centrifugal_force", lambda bad: uniform_preload(bad, 0.5, [1.0], [0])),
        ("platform_angle", lambda bad: uniform_preload(500.0, bad, [1.0], [0])),
    ],
)
def test_text_for_a_number_gets_a_sentence(name: str, call: Callable[[object], object]) -> None:
    with rejects(InputError, name):
        call("5 m")


def test_dimension_of_a_line_profile_is_rejected_for_a_surface_factor() -> None:
    with rejects(InputError, "fractal_dimension"):
        domain_extension_factor(1.4)
