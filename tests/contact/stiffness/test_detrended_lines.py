"""Expected structure function of detrended lines, and the surfaces that are simulated for comparison."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from scipy.special import j0

from stickslip.contact.stiffness.detrended_lines import (
    LineModel,
    expected_structure,
    measured_structure,
    straight_lines,
    wavelengths,
    without_trend,
)
from stickslip.contact.stiffness.random_lines import LineSet, Spectrum, simulate
from stickslip.contact.stiffness.surface import structure_function, structure_function_limit
from stickslip.core.validation import FloatArray

LAGS = np.array([1, 2, 5, 11, 20])
POINTS = 40


def test_a_straight_line_leaves_nothing() -> None:
    lines = np.array([[3.0], [-1.0]]) + np.array([[0.5], [2.0]]) * np.arange(float(POINTS))
    assert np.abs(without_trend(lines)).max() < 1e-12


def test_measured_structure_is_the_mean_square_of_differences() -> None:
    lines = np.array([[0.0, 1.0, 3.0, 6.0]])
    assert measured_structure(lines, np.array([1, 2])) == pytest.approx([(1 + 4 + 9) / 3, (9 + 25) / 2])


@pytest.mark.parametrize("exponent", [0.4, 1.2, 1.8])
def test_expected_structure_equals_the_dense_projection(exponent: float) -> None:
    """P C P written out, with a covariance that differs from -S/2 by a constant."""
    structure: FloatArray = np.arange(float(POINTS)) ** exponent
    distance = np.abs(np.subtract.outer(np.arange(POINTS), np.arange(POINTS)))
    basis = straight_lines(POINTS)
    projection = np.eye(POINTS) - basis.T @ basis
    covariance = projection @ (50.0 - 0.5 * structure[distance]) @ projection
    variance = np.diag(covariance)
    dense = [np.mean(variance[lag:] + variance[:-lag] - 2.0 * np.diag(covariance, lag)) for lag in LAGS]
    assert expected_structure(structure, LAGS) == pytest.approx(dense, rel=1e-10)
    assert expected_structure(structure, LAGS)[-1] < structure[LAGS[-1]]


def test_waves_of_the_model_sum_to_the_power_law() -> None:
    """Many waves, no trend removed: the closed form that knows neither gamma nor the ends of the band."""
    waves = wavelengths(1e7, 1e-8)
    tau = np.geomspace(0.01, 10.0, 7)
    for dimension in (2.2, 2.5, 2.8):
        terms = np.log(1.5) * waves ** (2 * (3 - dimension)) * (1.0 - j0(2 * np.pi * np.outer(tau, 1 / waves)))
        limit = structure_function_limit(tau, dimension, 1.0)
        assert terms.sum(axis=1) == pytest.approx(limit, rel=0.03)


def test_waves_of_the_model_are_those_of_many_ridges() -> None:
    tau, dimension = np.geomspace(0.01, 0.3, 5), 2.4
    waves = 1.0 / 1.5 ** np.arange(15)
    mean_of_ridges = structure_function(tau, 0.3, dimension, 1e-3, 1.0, 400, 14)
    weights = np.log(1.5) * waves ** (2 * (3 - dimension))
    terms = weights * (1.0 - j0(2 * np.pi * np.outer(tau, 1 / waves)))
    assert 1e-3 ** (2 * (dimension - 2)) * terms.sum(axis=1) == pytest.approx(mean_of_ridges, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("constant", [0.0, 0.3, -1.6])
def test_simulated_surfaces_have_the_structure_function_of_the_model(constant: float) -> None:
    """Rows and columns of one surface; noise and missing short waves included."""
    points, lags, hurst = 120, np.array([4, 8, 12]), 0.5
    waves = wavelengths(2.0 * points, 1.0)
    model = LineModel.build(points, 1.0, waves, lags)
    sets = (LineSet(points, 1.0, 7.0 * np.arange(4.0), True), LineSet(points, 1.0, 9.0 * np.arange(4.0), False))
    spectrum = Spectrum.of(waves, hurst, 1.0, constant)
    assert (spectrum.shortest == 0.0) == (constant >= 0.0)
    surfaces = islice(simulate(sets, spectrum, np.random.default_rng(2)), 400)
    actual = np.array([[measured_structure(without_trend(lines), lags) for lines in surface] for surface in surfaces])
    expected = model.structure(hurst) + constant * model.flat
    error = actual.std(axis=0) / 20.0
    assert np.all(np.abs(actual.mean(axis=0) - expected) < 4.0 * error + 0.02 * expected)


def test_missing_waves_are_the_shortest_ones() -> None:
    spectrum = Spectrum.of(np.array([8.0, 4.0, 2.0, 1.0]), 0.5, 1.0, 0.0)
    total = spectrum.noise + spectrum.weights[-1] + 0.5 * spectrum.weights[-2]
    cut = Spectrum.of(np.array([8.0, 4.0, 2.0, 1.0]), 0.5, 1.0, -total)
    assert cut.weights == pytest.approx(spectrum.weights * [1.0, 1.0, 0.5, 0.0])
    assert (cut.noise, cut.shortest, spectrum.shortest) == (0.0, 2.0, 0.0)
