"""D and G from generated surfaces with known D and G; what is refused and what is warned of."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence, rejects
from stickslip.contact.stiffness import roughness_fit
from stickslip.contact.stiffness.roughness_warnings import Evidence, warnings_of
from stickslip.contact.stiffness.surface import draw_phases, frequency_count
from stickslip.core.errors import InputError

SPACING = 1e-6


def profile(dimension: float, scale: float, seed: int = 1, points: int = 1000) -> np.ndarray:
    """A line on a surface whose waves go far beyond the line and below its spacing."""
    length, along = 20 * points * SPACING, SPACING * np.arange(points)
    phases = draw_phases(seed, 10, frequency_count(length, SPACING / 3))
    return ss.fractal_surface(
        along * np.cos(1.3 * seed), along * np.sin(1.3 * seed), dimension, scale, length, 10, phases
    )


@pytest.fixture
def few_simulations(monkeypatch: pytest.MonkeyPatch) -> None:
    """Enough simulated surfaces for weights and for a rough interval."""
    monkeypatch.setattr(roughness_fit, "SIMULATIONS", 60)


def warned(fit: ss.RoughnessFit) -> None:
    """The fit has warnings, which are those of the snapshot; their numbers are those of simulated surfaces."""
    assert fit.warnings
    printed_sentence("\n".join(fit.warnings), numbers=False)


@pytest.mark.long
@pytest.mark.parametrize(("dimension", "scale"), [(2.2, 1e-12), (2.8, 1e-7)])
@pytest.mark.usefixtures("few_simulations")
def test_known_values_are_found_without_bias(dimension: float, scale: float) -> None:
    """Mean over eight surfaces; the interval of each holds the true value but for few."""
    fits = [ss.fit_roughness(profile(dimension, scale, seed), SPACING) for seed in range(1, 9)]
    actual = np.array([fit.fractal_dimension for fit in fits])
    assert actual.mean() == pytest.approx(dimension, abs=0.04)
    for name, true in (("fractal_dimension", dimension), ("fractal_roughness", scale)):
        ends = np.array([getattr(fit, f"{name}_interval") for fit in fits])
        assert np.count_nonzero((ends[:, 0] <= true) & (true <= ends[:, 1])) >= 6
    half_width = np.mean([0.5 * np.ptp(fit.fractal_dimension_interval) for fit in fits])
    assert 1.5 * actual.std() < half_width < 0.3
    assert all(fit.usable and fit.fit_probability > 0.0 for fit in fits)


@pytest.mark.long
@pytest.mark.usefixtures("few_simulations")
def test_same_seed_same_result_and_heights_in_another_unit() -> None:
    heights = profile(2.4, 1e-9)
    first, again = ss.fit_roughness(heights, SPACING), ss.fit_roughness(heights, SPACING)
    assert first.fractal_dimension_interval == again.fractal_dimension_interval
    # all lengths times ten: the same surface seen larger, G is a length
    larger = ss.fit_roughness(10 * heights, 10 * SPACING)
    assert larger.fractal_dimension == pytest.approx(first.fractal_dimension, abs=1e-4)
    assert larger.fractal_roughness == pytest.approx(10 * first.fractal_roughness, rel=0.01)
    assert larger.rms_slope == pytest.approx(first.rms_slope, rel=1e-9)
    assert first.scale_range == pytest.approx((2e-6, 1e-4))


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
def test_a_tilt_changes_nothing_and_is_named() -> None:
    heights = profile(2.6, 1e-8)
    tilted = heights + 0.1 * SPACING * np.arange(heights.size)
    first, second = ss.fit_roughness(heights, SPACING), ss.fit_roughness(tilted, SPACING)
    assert second.fractal_dimension == pytest.approx(first.fractal_dimension, abs=1e-6)
    assert second.rms_height == pytest.approx(first.rms_height, rel=1e-9)
    warned(second)


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
def test_noise_is_found_and_left_out() -> None:
    heights = profile(2.3, 1e-10, points=2000)
    noise = 0.8 * np.sqrt(np.mean(np.diff(heights) ** 2))
    noisy = heights + noise * np.random.default_rng(3).normal(size=heights.size)
    fit = ss.fit_roughness(noisy, SPACING)
    warned(fit)
    assert fit.noise_height == pytest.approx(noise, rel=0.25)
    assert fit.fractal_dimension_interval[0] < 2.3 < fit.fractal_dimension_interval[1]
    warned(ss.fit_roughness(heights, SPACING))  # of its trend only


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
def test_missing_short_waves_raise_the_first_scale() -> None:
    heights = np.convolve(profile(2.5, 1e-9, points=4000), np.full(20, 0.05), "valid")
    fit = ss.fit_roughness(heights, SPACING)
    warned(fit)
    assert fit.scale_range[0] > 5 * SPACING
    assert fit.fractal_dimension_interval[0] < 2.5 < fit.fractal_dimension_interval[1]


@pytest.mark.long
@pytest.mark.usefixtures("few_simulations")
def test_a_sine_is_not_fractal() -> None:
    heights = 1e-6 * np.sin(2 * np.pi * np.arange(1000) / 60)
    warned(ss.fit_roughness(heights, SPACING))


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
def test_a_smooth_curve_is_out_of_range() -> None:
    steps = np.random.default_rng(1).normal(size=1000)
    fit = ss.fit_roughness(1e-9 * np.cumsum(np.cumsum(steps)), SPACING)
    assert not fit.usable
    warned(fit)


@pytest.mark.long
@pytest.mark.usefixtures("few_simulations")
def test_map_with_and_without_direction() -> None:
    x, y = np.meshgrid(SPACING * np.arange(240), 2 * SPACING * np.arange(160))
    length = 5e-3
    phases = draw_phases(5, 10, frequency_count(length, SPACING))
    heights = ss.fractal_surface(x, y, 2.4, 1e-9, length, 10, phases)
    fit = ss.fit_roughness(heights, (2 * SPACING, SPACING))
    assert fit.fractal_dimension_interval[0] < 2.4 < fit.fractal_dimension_interval[1]
    assert 0 < fit.points_along_x < fit.lag.size
    assert fit.lag[fit.points_along_x] == pytest.approx(2e-6)
    warned(fit)  # of its few points only
    stretched = ss.fit_roughness(heights, (SPACING, 4 * SPACING))
    warned(stretched)


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
def test_scales_and_longest_wave_are_used() -> None:
    heights = profile(2.4, 1e-9)
    fit = ss.fit_roughness(heights, SPACING, scales=(5e-6, 4e-5), longest_wave=1e-3)
    assert fit.scale_range == pytest.approx((5e-6, 4e-5))
    warned(fit)


@pytest.mark.parametrize(
    ("heights", "options", "keys"),
    [
        (np.zeros((3, 4, 5)), {}, ("heights",)),
        (np.zeros(100_001), {}, ("heights",)),
        (np.zeros(50), {}, ("heights",)),
        (np.arange(200.0), {}, ()),
        (np.where(np.arange(200) == 7, np.nan, 1.0), {}, ("heights",)),
        (profile(2.4, 1e-9)[:200], {"spacing": 0.0}, ("spacing",)),
        (profile(2.4, 1e-9)[:200], {"spacing": (1e-6, 1e-6)}, ("spacing",)),
        (profile(2.4, 1e-9)[:200], {"scales": (1e-6, 1.0)}, ("scales",)),
        (profile(2.4, 1e-9)[:200], {"scales": (2e-6, 4e-6)}, ()),
        (profile(2.4, 1e-9)[:200], {"longest_wave": 1e-7}, ("longest_wave",)),
        (profile(2.4, 1e-9)[:200], {"seed": -1}, ("seed",)),
    ],
)
def test_bad_input_is_rejected(heights: Any, options: dict[str, Any], keys: tuple[str, ...]) -> None:
    values = {"spacing": SPACING, **options}
    with rejects(InputError, *keys):
        ss.fit_roughness(heights, values.pop("spacing"), **values)


GOOD = Evidence(
    dimension=2.4,
    dimension_interval=(2.3, 2.5),
    roughness=1e-9,
    usable=True,
    scale_range=(1e-6, 1e-4),
    points=1000,
    trend_fraction=0.5,
    noise_fraction=0.0,
    noise_height=0.0,
    raised=False,
    probability=0.5,
    direction_deviation=0.0,
)


@pytest.mark.parametrize(
    "change",
    [
        {"usable": False, "dimension": 2.02},
        {"usable": False, "dimension": 2.98},
        {"probability": 0.0},
        {"direction_deviation": 4.0},
        {"scale_range": (1e-6, 5e-6)},
        {"points": 200},
        {"noise_fraction": 0.3, "noise_height": 1e-9},
        {"raised": True},
        {"trend_fraction": 0.9},
        {"dimension_interval": (2.02, 2.5)},
        {"dimension": 2.97},
        {"roughness": 1e-5},
    ],
)
def test_each_warning_has_its_cause(change: dict[str, Any]) -> None:
    assert warnings_of(GOOD) == ()
    actual = warnings_of(dataclasses.replace(GOOD, **change))
    assert len(actual) == 1
    printed_sentence(actual[0])
