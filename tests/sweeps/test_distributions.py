"""Distributions of inputs: their samples, their limits, and the sentence for what is not one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sentences import rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.sweeps.band import sample_points
from stickslip.sweeps.distributions import Distribution, described, distributions

EVEN = (np.arange(4096) + 0.5) / 4096


def distribution(name: str, text: str) -> Distribution:
    return distributions({name: text}, Case())[0]


def samples(name: str, text: str) -> np.ndarray:
    return np.array(distribution(name, text).key(EVEN).values)


# Variance of a normal distribution that is cut at 3 standard deviations: 1 - 6 phi(3) / (2 Phi(3) - 1).
CUT_VARIANCE = 1.0 - 6.0 * math.exp(-4.5) / math.sqrt(2.0 * math.pi) / math.erf(3.0 / math.sqrt(2.0))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "text", "mean", "deviation", "low", "high"),
    [
        ("friction.coefficient", "0.3 +- 0.1", 0.3, 0.1 * math.sqrt(CUT_VARIANCE), 0.0, 0.6),
        ("preload.centrifugal_force", "500 ± 20 N", 500.0, 20.0 * math.sqrt(CUT_VARIANCE), 440.0, 560.0),
        ("preload.centrifugal_force", "0.5 kN +- 4 %", 500.0, 20.0 * math.sqrt(CUT_VARIANCE), 440.0, 560.0),
        ("friction.coefficient", "0.2 .. 0.4", 0.3, 0.2 / math.sqrt(12.0), 0.2, 0.4),
        ("preload.centrifugal_force", "300 .. 500", 400.0, 200.0 / math.sqrt(12.0), 300.0, 500.0),
    ],
)
def test_samples_have_the_moments_of_the_distribution(
    name: str, text: str, mean: float, deviation: float, low: float, high: float
) -> None:
    values = samples(name, text)
    assert values.mean() == pytest.approx(mean, rel=1e-6)
    assert values.std() == pytest.approx(deviation, rel=1e-3)
    assert low < values.min() < values.max() < high


@pytest.mark.slow
def test_logarithms_of_lognormal_and_loguniform_samples() -> None:
    logarithms = np.log(samples("friction.coefficient", "lognormal 0.3 */ 1.5"))
    assert logarithms.mean() == pytest.approx(math.log(0.3), rel=1e-6)
    assert logarithms.std() == pytest.approx(math.log(1.5) * math.sqrt(CUT_VARIANCE), rel=1e-3)
    assert np.abs(logarithms - math.log(0.3)).max() < 3.0 * math.log(1.5)
    even: np.ndarray = np.log10(samples("roughness.fractal_roughness", "1e-10 m .. 1e-8 m log"))
    assert even == pytest.approx(-10.0 + 2.0 * EVEN, abs=1e-8)


def test_listed_values_are_equally_probable() -> None:
    modes = distribution("excitation.mode", "single | same").key(EVEN).values
    assert [modes.count(mode) for mode in ("single", "same")] == [2048, 2048]
    harmonics = distribution("solver.harmonics", "1 | 3 | 5").key(EVEN).values
    assert {type(value) for value in harmonics} == {int}


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("friction.coefficient", "0.3 +- 0.1"),
        ("friction.coefficient", "lognormal 0.3 */ 1.5"),
        ("friction.coefficient", "0.2 .. 0.4"),
        ("roughness.fractal_roughness", "1e-10 m .. 1e-8 m log"),
        ("excitation.mode", "single | same | opposite"),
    ],
)
def test_the_quadrature_of_a_coordinate_is_that_of_its_samples(name: str, text: str) -> None:
    coordinate = distribution(name, text).coordinate(EVEN)
    for power in range(5):
        expected = float(coordinate.weights @ coordinate.nodes**power)
        assert (coordinate.samples**power).mean() == pytest.approx(expected, abs=2e-3 * max(1.0, abs(expected)))
    degree = min(3, coordinate.largest_degree)
    polynomials = coordinate.polynomials(degree)
    np.testing.assert_allclose(polynomials.T @ polynomials / EVEN.size, np.eye(degree + 1), atol=6e-3)


def test_more_points_contain_those_of_fewer_and_fill_each_part() -> None:
    few, many = sample_points(3, 24), sample_points(3, 64)
    np.testing.assert_array_equal(few, many[:24])
    for column in many.T:
        assert sorted(np.floor(64 * column)) == list(range(64))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("friction.coefficient", "0.3 +- 0.11"),
        ("friction.coefficient", "-0.1 .. 0.3"),
        ("friction.coefficient", "5 .. 20"),
        ("preload.centrifugal_force", "500 N +- 200 N"),
        ("geometry.platform_angle", "80 deg +- 10 deg"),  # lognormal would reach beyond 90 deg too
        ("preload.centrifugal_force", "500 N +- 5 mm"),
        ("preload.centrifugal_force", "600 N .. 500 N"),
        ("preload.centrifugal_force", "500 N +- 0 N"),
        ("preload.centrifugal_force", "lognormal 500 N */ 0.9"),
        ("preload.centrifugal_force", "lognormal -500 N */ 1.2"),
        ("damping.rayleigh_alpha", "0 1/s .. 5 1/s log"),
        ("solver.harmonics", "3 .. 9"),
        ("excitation.mode", "0.2 +- 0.1"),
        ("excitation.mode", "single | sam"),
        ("friction.coefficient", "0.3 | 0.3"),
        ("friction.coefficient", "0.3"),
        ("friction.coefficient", "0.3 +- much"),
        ("friction.coeficient", "0.3 +- 0.1"),
        ("study.title", "a | b"),
    ],
)
def test_what_cannot_be_drawn_is_reported_before_anything_runs(name: str, text: str) -> None:
    with rejects(InputError, name):
        distribution(name, text)


def test_nothing_distributed_is_rejected() -> None:
    with rejects(InputError):
        distributions({}, Case())


def test_words_for_the_page() -> None:
    assert described(distribution("friction.coefficient", "0.3 +- 0.1"))[3] == "0 to 0.6"
    assert described(distribution("excitation.mode", "single | same"))[2] == "listed values, equally probable"
    assert described(distribution("geometry.platform_angle", "20 deg .. 30 deg"))[3] == "20 deg to 30 deg"
