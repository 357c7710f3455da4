"""Weierstrass-Mandelbrot surface: heights, statistics and structure function."""

from __future__ import annotations

from math import atan2, cos, log, pi, sqrt
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from sentences import rejects
from stickslip.contact.stiffness.asperities import Roughness
from stickslip.contact.stiffness.surface import (
    draw_phases,
    fractal_roughness_from_sq,
    fractal_surface,
    frequency_count,
    sdq,
    sq,
    structure_function,
    structure_function_limit,
    surface_statistics,
)
from stickslip.core.errors import InputError

LENGTH, RATIO, RIDGES, N_MAX = 0.028, 1.5, 10, 14
quick = settings(max_examples=40, deadline=None, derandomize=True)


def heights(x: ArrayLike, y: ArrayLike, dimension: float = 2.4, scale: float = 1e-8, seed: int = 1) -> np.ndarray:
    """Heights of a small surface."""
    return fractal_surface(x, y, dimension, scale, LENGTH, RIDGES, draw_phases(seed, RIDGES, N_MAX))


def scattered(count: int, seed: int = 5) -> tuple[np.ndarray, np.ndarray]:
    """Points in all four quadrants."""
    x, y = np.random.default_rng(seed).uniform(-LENGTH, LENGTH, (2, count))
    return x, y


@pytest.mark.parametrize("dimension", [2.2, 2.5, 2.9])
def test_the_origin_has_height_zero(dimension: float) -> None:
    assert heights(0.0, 0.0, dimension) == 0.0
    assert np.all(heights(np.zeros(7), -np.zeros(7), dimension) == 0.0)


@pytest.mark.slow
@quick
@given(
    st.floats(2.05, 2.95),
    st.floats(1e-13, 1e-6),
    st.floats(1e-3, 1e3),
    st.floats(-0.05, 0.05, allow_subnormal=False),
    st.floats(-0.05, 0.05, allow_subnormal=False),
)
def test_heights_scale_with_g_at_every_point(dimension: float, scale: float, factor: float, x: float, y: float) -> None:
    first, second = heights(x, y, dimension, scale), heights(x, y, dimension, factor * scale)
    assert second == pytest.approx(factor ** (dimension - 2) * first, rel=1e-11, abs=0)


def test_same_seed_same_bits_in_any_order_and_any_portion() -> None:
    x, y = scattered(1001)
    whole = heights(x, y)
    assert np.array_equal(whole, heights(x, y))
    assert np.array_equal(whole[::-1], heights(x[::-1], y[::-1]))
    assert np.array_equal(whole, np.concatenate([heights(x[:333], y[:333]), heights(x[333:], y[333:])]))
    assert np.array_equal(whole.reshape(7, 143).T, heights(x.reshape(7, 143).T, y.reshape(7, 143).T))
    assert [float(heights(*point)) for point in zip(x[:20], y[:20], strict=True)] == list(whole[:20])
    assert not np.array_equal(whole, heights(x, y, seed=2))


def test_phases_are_uniform_and_fixed_by_the_seed() -> None:
    phases = draw_phases(3, 100, 99)
    assert phases.shape == (100, 100)
    assert np.array_equal(phases, draw_phases(3, 100, 99))
    assert phases.min() >= 0.0
    assert phases.max() < 2 * pi
    counts = np.histogram(phases, bins=10, range=(0, 2 * pi))[0]
    assert np.abs(counts - 1000).max() < 150  # five standard deviations


def test_heights_equal_the_sum_in_polar_form() -> None:
    """The textbook's sqrt(x^2+y^2) cos(angle - pi m/M), with the angle in the right quadrant."""
    dimension, scale, phases = 2.3, 1e-8, draw_phases(1, RIDGES, N_MAX)
    for x, y in [(0.003, 0.002), (-0.003, 0.002), (-0.003, -0.002), (0.003, -0.002), (0.0, 0.004), (-0.004, 0.0)]:
        total = 0.0
        for m in range(1, RIDGES + 1):
            for n in range(N_MAX + 1):
                argument = 2 * pi * RATIO**n / LENGTH * sqrt(x * x + y * y) * cos(atan2(y, x) - pi * m / RIDGES)
                phase = phases[m - 1, n]
                total += RATIO ** ((dimension - 3) * n) * (cos(phase) - cos(argument + phase))
        expected = LENGTH * (scale / LENGTH) ** (dimension - 2) * sqrt(log(RATIO) / RIDGES) * total
        assert heights(x, y, dimension, scale) == pytest.approx(expected, rel=1e-10)


ENSEMBLE = 240
DISTANCES = LENGTH * np.array([3 / RATIO**14, 1 / RATIO**10, 1 / RATIO**7, 0.02, 0.1])


@pytest.fixture(scope="module", params=[2.2, 2.4, 2.8])
def ensemble(request: pytest.FixtureRequest) -> tuple[float, np.ndarray, np.ndarray]:
    """D, and heights (surfaces, starts) and (surfaces, starts, distances) along a fixed direction."""
    starts = np.random.default_rng(0).uniform(-LENGTH, LENGTH, (2, 60))
    step = np.multiply.outer([cos(0.7), np.sin(0.7)], DISTANCES)
    points = np.concatenate([starts[:, :, None], starts[:, :, None] + step[:, None, :]], axis=2)
    actual = np.array([heights(points[0], points[1], request.param, seed=seed) for seed in range(ENSEMBLE)])
    return request.param, actual[:, :, 0], actual[:, :, 1:]


@pytest.mark.slow
def test_structure_function_of_an_ensemble(ensemble: tuple[float, np.ndarray, np.ndarray]) -> None:
    dimension, start, end = ensemble
    measured = ((end - start[:, :, None]) ** 2).mean(axis=(0, 1))
    exact = structure_function(DISTANCES, 0.7, dimension, 1e-8, LENGTH, RIDGES, N_MAX)
    np.testing.assert_allclose(measured, exact, rtol=0.05)
    # The slope is compared with that of the finite band of waves: the ideal 2 (3 - D) would be off by up to 0.2.
    assert np.polyfit(np.log(DISTANCES), np.log(measured / exact), 1)[0] == pytest.approx(0.0, abs=0.01)


@pytest.mark.slow
def test_root_mean_square_height_of_an_ensemble(ensemble: tuple[float, np.ndarray, np.ndarray]) -> None:
    """z is a sum of cos phi less a random wave of the same phases; the wave alone has the mean square Sq^2."""
    dimension, start, _ = ensemble
    mean_height = np.array([weighted_cosine(dimension, draw_phases(seed, RIDGES, N_MAX)) for seed in range(ENSEMBLE)])
    measured = sqrt(((start - mean_height[:, None]) ** 2).mean())
    assert measured == pytest.approx(sq(dimension, 1e-8, LENGTH, LENGTH / RATIO**N_MAX), rel=0.04)


def weighted_cosine(dimension: float, phases: np.ndarray) -> float:
    """Mean height of one surface: the constant part of the sum."""
    weight = RATIO ** ((dimension - 3) * np.arange(N_MAX + 1))
    return float(
        LENGTH * (1e-8 / LENGTH) ** (dimension - 2) * sqrt(log(RATIO) / RIDGES) * (np.cos(phases) @ weight).sum()
    )


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2.2, 2.5, 2.8])
def test_root_mean_square_slope_of_an_ensemble(dimension: float) -> None:
    x, y = scattered(100)
    step = 1e-9
    squares = []
    for seed in range(100):
        base = heights(x, y, dimension, seed=seed)
        along = heights(x + step, y, dimension, seed=seed) - base
        across = heights(x, y + step, dimension, seed=seed) - base
        squares.append(((along**2 + across**2) / step**2).mean())
    expected = sdq(dimension, 1e-8, LENGTH, LENGTH / RATIO**N_MAX)
    assert sqrt(np.mean(squares)) == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize(
    ("dimension", "micrometres"),
    [(2.2, (235, 591, 937)), (2.3, (28, 112, 223)), (2.4, (3.4, 21, 54)), (2.49, (0.51, 4.9, 15))],
)
def test_tabulated_root_mean_square_heights(dimension: float, micrometres: tuple[float, ...]) -> None:
    for scale, expected in zip((1e-11, 1e-9, 1e-8), micrometres, strict=True):
        assert 1e6 * sq(dimension, scale, 0.028, 1e-6) == pytest.approx(expected, rel=0.03)  # two digits or three


@pytest.mark.parametrize(("dimension", "slopes"), [(2.2, (0.71, 1.8, 2.8)), (2.49, (0.017, 0.16, 0.49))])
def test_tabulated_root_mean_square_slopes(dimension: float, slopes: tuple[float, ...]) -> None:
    for scale, expected in zip((1e-11, 1e-9, 1e-8), slopes, strict=True):
        assert sdq(dimension, scale, 0.028, 1e-6) == pytest.approx(expected, rel=0.03)


@pytest.mark.slow
@quick
@given(st.floats(2.05, 2.95), st.floats(1e-12, 1e-7), st.floats(1.1, 3.0), st.floats(1e-7, 1e-3))
def test_statistics_are_sums_over_the_waves(dimension: float, scale: float, ratio: float, shortest: float) -> None:
    order = np.arange(frequency_count(LENGTH, shortest, ratio) + 1)
    amplitude = LENGTH * (scale / LENGTH) ** (dimension - 2) * sqrt(log(ratio)) * ratio ** ((dimension - 3) * order)
    wave_number = 2 * pi * ratio**order / LENGTH
    assert sq(dimension, scale, LENGTH, shortest, ratio) == pytest.approx(sqrt(0.5 * (amplitude**2).sum()), rel=1e-11)
    expected = sqrt(0.5 * ((amplitude * wave_number) ** 2).sum())
    assert sdq(dimension, scale, LENGTH, shortest, ratio) == pytest.approx(expected, rel=1e-11)


def test_larger_dimension_and_smaller_g_are_smoother() -> None:
    for measure in (sq, sdq):
        by_dimension = [measure(dimension, 1e-9, LENGTH, 1e-6) for dimension in (2.1, 2.3, 2.5, 2.7, 2.9)]
        by_scale = [measure(2.4, scale, LENGTH, 1e-6) for scale in (1e-8, 1e-9, 1e-10)]
        assert np.all(np.diff(by_dimension) < 0)
        assert np.all(np.diff(by_scale) < 0)


def test_structure_function_at_short_and_long_distance() -> None:
    dimension, shortest = 2.4, LENGTH / RATIO**N_MAX
    tiny = 1e-9 * shortest
    actual = structure_function(tiny, 0.3, dimension, 1e-8, LENGTH, RIDGES, N_MAX)
    slope = sdq(dimension, 1e-8, LENGTH, shortest)
    assert float(actual) == pytest.approx(0.5 * slope**2 * tiny**2, rel=1e-9)  # along one direction: half of Sdq^2
    far = structure_function(np.linspace(50, 90, 4000) * LENGTH, 0.3, dimension, 1e-8, LENGTH, RIDGES, N_MAX)
    assert far.mean() == pytest.approx(2 * sq(dimension, 1e-8, LENGTH, shortest) ** 2, rel=0.03)


@pytest.mark.parametrize("dimension", [2.2, 2.3, 2.5, 2.8])
@pytest.mark.parametrize("length", [1.0, 40.0])
def test_structure_function_tends_to_the_continuum(dimension: float, length: float) -> None:
    tau, ratio, scale, ridges = 1e-6, 1.05, 1e-9, 60
    n_max = frequency_count(length, 1e-11, ratio)
    # The waves above L and below Ls are missing: (tau/L)^(2(D-2)) and (Ls/tau)^(2(3-D)) of the whole.
    missing = (tau / length) ** (2 * (dimension - 2)) + (1e-11 / tau) ** (2 * (3 - dimension))
    actual = structure_function(tau, 0.2, dimension, scale, length, ridges, n_max, ratio)
    limit = structure_function_limit(tau, dimension, scale)
    assert float(actual) == pytest.approx(float(limit), rel=0.03 + 8 * missing)


@pytest.mark.slow
@quick
@given(st.floats(2.05, 2.95), st.floats(1e-13, 1e-6), st.floats(1.2, 3.0))
def test_g_from_the_root_mean_square_height(dimension: float, scale: float, ratio: float) -> None:
    height = sq(dimension, scale, LENGTH, 1e-6, ratio)
    assert fractal_roughness_from_sq(height, dimension, LENGTH, 1e-6, ratio) == pytest.approx(scale, rel=1e-9)


@pytest.mark.parametrize(("power", "ratio"), [(k, ratio) for ratio in (1.5, 2.0, 1.1) for k in (1, 10, 14, 25, 60)])
def test_frequency_count_keeps_the_last_whole_wave(power: int, ratio: float) -> None:
    assert frequency_count(LENGTH, LENGTH / ratio**power, ratio) == power
    assert frequency_count(LENGTH, 1.001 * LENGTH / ratio**power, ratio) == power - 1


def test_surface_statistics() -> None:
    roughness = Roughness(2.4, 1e-8, 3e9, 1e11, 0.3)
    actual = surface_statistics(roughness, 0.028, 1e-6)
    assert (actual.sq, actual.sdq) == (sq(2.4, 1e-8, 0.028, 1e-6), sdq(2.4, 1e-8, 0.028, 1e-6))
    assert (actual.n_max, actual.sample_length, actual.shortest_length) == (25, 0.028, 1e-6)
    with rejects(InputError, "length"):
        surface_statistics(roughness, 1e-6, 1e-3)


def test_arguments_out_of_range() -> None:
    phases = draw_phases(1, RIDGES, N_MAX)
    arguments = {"fractal_dimension": 2.4, "fractal_roughness": 1e-8, "length": LENGTH, "ridges": RIDGES}
    for changes, keys in (
        ({"fractal_dimension": 1.4}, ["fractal_dimension"]),
        ({"fractal_roughness": -1.0}, ["fractal_roughness"]),
        ({"length": 0.0}, ["length"]),
        ({"ratio": 1.0}, ["ratio"]),
        ({"ratio": float("nan")}, ["ratio"]),
        ({"ridges": 0}, ["ridges"]),
        ({"ridges": 9}, ["phases"]),
        ({"phases": phases[0]}, ["phases"]),
        ({"x": [0.0, float("nan")]}, ["x"]),
        ({"x": [0.0]}, ["x", "y"]),
    ):
        with rejects(InputError, *keys):
            fractal_surface(**({"x": [0.0, 1.0], "y": [0.0, 1.0], "phases": phases} | arguments | changes))
    broken: Any = 1.5
    with rejects(InputError, "n_max"):
        draw_phases(1, 2, -1)
    with rejects(InputError, "seed"):
        draw_phases(broken, 2, 3)
    with rejects(InputError, "shortest_length"):
        frequency_count(1.0, 0.0)
    with rejects(InputError, "sq_height"):
        fractal_roughness_from_sq(0.0, 2.4, LENGTH, 1e-6)
    with rejects(InputError, "fractal_dimension"):
        structure_function_limit(1.0, 3.0, 1e-8)
    with rejects(InputError, "n_max"):
        structure_function(1.0, 0.0, 2.4, 1e-8, LENGTH, RIDGES, -1)
