"""Stiffness spread over contact pairs: by area, by pressure, face by face, and refusals."""

from __future__ import annotations

import numpy as np
import pytest

from rough_faces import HARDNESS, MINDLIN, NOMINAL_AREA, REDUCED_MODULUS, pair_stiffness, rough
from sentences import rejects
from stickslip.contact.stiffness.fractal import StiffnessMode, fractal_contact, published_contact
from stickslip.contact.stiffness.fractal_law import FractalStiffness
from stickslip.contact.stiffness.stiffness_law import Allocation, springs_of_pairs
from stickslip.core.errors import RoughnessError


def face_of(columns: int, rows: int) -> np.ndarray:
    """Areas of the pairs of a grid on the nominal face; edge pairs have half a cell."""
    along, across = np.ones(columns), np.ones(rows)
    along[[0, -1]] = across[[0, -1]] = 0.5
    cells = np.outer(along, across).ravel()
    return np.asarray(NOMINAL_AREA * cells / cells.sum())


@pytest.mark.parametrize("mode", ["consistent", "varying-curvature", "unloading"])
@pytest.mark.parametrize("scale", [1e-8, 1e-10])
def test_uniform_pressure_makes_both_allocations_equal(mode: StiffnessMode, scale: float) -> None:
    area = face_of(11, 5)
    preload, face = 500.0 * area / area.sum(), rough(2.4, scale, shortest_length=1e-6)
    by_area = pair_stiffness(face, area, preload, mode=mode, allocation="area")
    by_pressure = pair_stiffness(face, area, preload, mode=mode, allocation="pressure")
    whole = fractal_contact(face, 500.0, mode)
    for first, second, total in zip(by_area, by_pressure, (whole.normal, whole.tangential), strict=True):
        np.testing.assert_allclose(first, second, rtol=1e-11)
        assert first.sum() == pytest.approx(total, rel=1e-12)
        np.testing.assert_allclose(first / first.sum(), area / area.sum(), rtol=1e-12)


@pytest.mark.parametrize("allocation", ["area", "pressure"])
def test_splitting_every_pair_leaves_the_sum(allocation: Allocation) -> None:
    area, random = face_of(11, 5), np.random.default_rng(3)
    preload = 500.0 * area / area.sum() * random.uniform(0.5, 1.5, area.size)
    parts = random.uniform(0.2, 0.8, area.size)
    coarse = pair_stiffness(rough(), area, preload, allocation=allocation)
    areas, loads = (np.concatenate([parts * values, (1 - parts) * values]) for values in (area, preload))
    fine = pair_stiffness(rough(), areas, loads, allocation=allocation)
    for first, second in zip(coarse, fine, strict=True):
        np.testing.assert_allclose(second[: area.size] + second[area.size :], first, rtol=1e-10)


def test_refining_the_mesh_under_a_pressure_field_converges() -> None:
    def total(columns: int, rows: int) -> float:
        area = face_of(columns, rows)
        x = np.repeat(np.linspace(0, 1, columns), rows)
        return float(
            pair_stiffness(rough(), area, 500.0 * area / area.sum() * (0.6 + 0.8 * x), allocation="pressure")[0].sum()
        )

    coarse, fine, finest = total(11, 5), total(21, 9), total(81, 5)
    assert coarse == pytest.approx(finest, rel=1e-3)
    assert abs(fine - finest) < 0.4 * abs(coarse - finest)


def test_pressure_shifts_the_stiffness_to_the_loaded_pairs() -> None:
    area = np.full(4, NOMINAL_AREA / 4)
    normal, _ = pair_stiffness(rough(), area, [50.0, 100.0, 150.0, 200.0], allocation="pressure")
    assert np.all(np.diff(normal) > 0)
    expected = [fractal_contact(rough(), load).normal / 4 for load in (200.0, 400.0, 600.0, 800.0)]
    np.testing.assert_allclose(normal, expected, rtol=1e-12)


def test_each_face_has_its_own_load() -> None:
    area = np.array([1.0, 3.0, 2.0, 2.0]) * 1e-5
    normal, tangential = pair_stiffness(rough(), area, [100.0, 300.0, 150.0, 50.0], face=[7, 7, 2, 2])
    left, right = fractal_contact(rough(), 400.0), fractal_contact(rough(), 200.0)
    np.testing.assert_allclose(normal, [left.normal / 4, left.normal * 0.75, right.normal / 2, right.normal / 2])
    np.testing.assert_allclose(tangential, MINDLIN * normal)


def test_open_pairs_get_the_stiffness_of_the_mean_pressure() -> None:
    area = np.full(4, NOMINAL_AREA / 4)
    normal, _ = pair_stiffness(rough(), area, [200.0, 200.0, 100.0, -30.0], allocation="pressure")
    assert normal[3] == pytest.approx(fractal_contact(rough(), 500.0).normal / 4, rel=1e-12)
    assert normal[0] == pytest.approx(fractal_contact(rough(), 800.0).normal / 4, rel=1e-12)


def test_a_pair_under_too_little_pressure_for_elastic_spots_has_the_least_stiffness_of_its_real_area() -> None:
    """The others keep that of their elastic spots, as if each were alone on the face."""
    area, load = np.full(4, NOMINAL_AREA / 4), np.array([200.0, 100.0, 1.0, 50.0])
    normal, tangential = pair_stiffness(rough(), area, load, allocation="pressure")
    least = 2 * REDUCED_MODULUS * np.sqrt(4.0 / (np.pi * HARDNESS))  # of the face under this pressure, 4 N
    assert normal[2] == pytest.approx(least / 4, rel=1e-9)
    assert normal[[0, 1, 3]] == pytest.approx(
        [published_contact(rough(), 4 * each).normal / 4 for each in load[[0, 1, 3]]], rel=1e-13
    )
    assert tangential / normal == pytest.approx(MINDLIN, rel=1e-12)


def test_a_face_without_preload_is_rejected() -> None:
    with rejects(RoughnessError):
        springs_of_pairs(FractalStiffness(rough(), 2.0), np.ones(4), [1e3, 1e3, 0.0, -5.0], face=[0, 0, 1, 1])
