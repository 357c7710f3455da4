"""Sobol indices against closed forms, and when they are not given."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.stats

from sentences import printed_sentence
from stickslip.core.validation import FloatArray
from stickslip.results.influence import Coordinate, influence


def points(inputs: int, samples: int) -> FloatArray:
    sobol = scipy.stats.qmc.Sobol(inputs, scramble=True, seed=np.random.default_rng(5))
    drawn: FloatArray = sobol.random_base2(samples.bit_length() - 1)
    return drawn


def uniform(name: str, samples: FloatArray) -> Coordinate:
    """A uniform input between -1 and 1."""
    nodes, weights = np.polynomial.legendre.leggauss(32)
    return Coordinate(name, 2.0 * samples - 1.0, nodes, 0.5 * weights)


def listed(name: str, samples: FloatArray, count: int) -> Coordinate:
    return Coordinate(name, np.floor(samples * count), np.arange(float(count)), np.full(count, 1.0 / count))


def test_a_product_of_two_factors_has_its_closed_form() -> None:
    """y = x z: V(y) = (Vx + mx^2)(Vz + mz^2) - mx^2 mz^2, S_x V(y) = mz^2 Vx, T_x V(y) = Vx (Vz + mz^2)."""
    drawn = points(2, 32)
    coordinates = [uniform("x", drawn[:, 0]), uniform("z", drawn[:, 1])]
    x, z = 2.0 + coordinates[0].samples, 5.0 + 3.0 * coordinates[1].samples
    result = influence(coordinates, x * z)
    (mx, vx), (mz, vz) = (2.0, 1.0 / 3.0), (5.0, 9.0 / 3.0)
    whole = (vx + mx**2) * (vz + mz**2) - mx**2 * mz**2
    assert result.first == pytest.approx((mz**2 * vx / whole, mx**2 * vz / whole), abs=1e-10)
    assert result.total == pytest.approx((vx * (vz + mz**2) / whole, vz * (vx + mx**2) / whole), abs=1e-10)
    assert result.unexplained < 1e-20
    np.testing.assert_allclose(np.ptp(result.first_interval, axis=1), 0.0, atol=1e-10)
    assert (result.names, result.reason, result.n_samples) == (("x", "z"), "", 32)


@pytest.mark.slow
def test_indices_of_a_function_with_strong_interactions() -> None:
    """T. Ishigami, T. Homma (1990): y = sin a + 7 sin^2 b + 0.1 c^4 sin a on (-pi, pi)^3."""
    drawn = points(3, 256)
    a, b, c = np.pi * (2.0 * drawn.T - 1.0)
    result = influence(
        [uniform(name, drawn[:, i]) for i, name in enumerate("abc")],
        np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a),
    )
    for expected, values, ends in (
        ((0.3139, 0.4424, 0.0), result.first, result.first_interval),
        ((0.5576, 0.4424, 0.2437), result.total, result.total_interval),
    ):
        assert values == pytest.approx(expected, abs=0.02)
        for value, (low, high) in zip(expected, ends, strict=True):
            assert low - 0.01 <= value <= high + 0.01
    assert result.unexplained < 0.02


def test_listed_values_have_their_exact_fractions() -> None:
    """y = level of a list of four + uniform: variances 1.25 k^2 and 1/3."""
    drawn = points(2, 64)
    coordinates = [listed("lot", drawn[:, 0], 4), uniform("x", drawn[:, 1])]
    heights = np.array([3.0, 0.0, 1.0, 2.0])  # no polynomial of the number below degree 3
    result = influence(coordinates, heights[coordinates[0].samples.astype(int)] + coordinates[1].samples)
    assert result.first == pytest.approx((1.25 / (1.25 + 1.0 / 3.0), (1.0 / 3.0) / (1.25 + 1.0 / 3.0)), abs=1e-10)


def test_samples_without_a_result_are_left_out_and_counted() -> None:
    drawn = points(1, 32)
    coordinate = uniform("x", drawn[:, 0])
    values = 3.0 + coordinate.samples
    values[::5] = np.nan
    result = influence([coordinate], values)
    assert result.n_samples == 25
    assert result.first == pytest.approx((1.0,), abs=1e-12)


@pytest.mark.parametrize("kind", ["few", "constant", "noise"])
def test_without_a_good_fit_there_are_no_indices_but_the_reason(kind: str) -> None:
    drawn = points(2, 64)
    coordinates = [uniform("x", drawn[:, 0]), uniform("z", drawn[:, 1])]
    values = {
        "few": np.where(np.arange(64) < 11, drawn[:, 0], np.nan),
        "constant": np.full(64, 2.0) * (1.0 + 1e-12 * drawn[:, 0]),
        "noise": np.random.default_rng(1).standard_normal(64),
    }[kind]
    result = influence(coordinates, values)
    assert np.isnan([*result.first, *result.total]).all()
    printed_sentence(result.reason, numbers=kind != "noise")
