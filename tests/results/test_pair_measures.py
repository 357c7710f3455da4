"""States, slip distance and pressure of pairs over a period, against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.cubic_spring import CubicSpring
from stickslip.contact.law.jenkins import JenkinsElement
from stickslip.contact.law.law import ContactLaw
from stickslip.core.errors import InputError
from stickslip.results.pair_measures import pair_measures, point_at_frequency
from stickslip.results.response import ForcedResponse
from synthetic import synthetic_response, synthetic_study

TANGENTIAL, NORMAL, FRICTION = 2e6, 5e6, 0.3  # N/m, N/m, -
SLIDING, BOUNCING = 4e-6, 3e-6  # m
SAMPLES = 4096


def response_of(
    loads: list[float],
    sliding: float,
    bouncing: float,
    laws: list[ContactLaw] | None = None,
    friction: float = FRICTION,
) -> ForcedResponse:
    """Every pair moves by ``sliding sin(w t)`` along t1 and ``bouncing cos(w t)`` along n; its load is another one."""
    base = synthetic_response(2, 2, n_points=8)
    operator = np.tile(np.eye(3, base.n_unknowns), (base.pairs.n_pairs, 1))
    preload = np.resize(loads, base.pairs.n_pairs)
    if laws is None:
        pairs = ContactPairs(operator, np.full(8, NORMAL), np.full(8, TANGENTIAL), np.full(8, friction), preload)
    else:
        pairs = ContactPairs.with_laws(operator, laws, [np.arange(4), np.arange(4, 8)])
    displacement = np.zeros_like(base.displacement)
    displacement[:, 0, 2], displacement[:, 2, 1] = sliding, bouncing
    return replace(base, pairs=pairs, displacement=displacement, samples=SAMPLES)


@pytest.mark.slow
def test_slip_under_a_constant_load() -> None:
    """Per cycle ``4 (A - mu N / k)``; it sticks after each reversal until it has moved by ``2 mu N / k``."""
    loads = np.array([0.0, 2.0, 10.0, 40.0])
    actual = pair_measures(response_of(loads.tolist(), SLIDING, 0.0), 1)
    limit = FRICTION * loads / TANGENTIAL
    slip = np.maximum(4.0 * (SLIDING - limit), 0.0)
    stick = np.arccos(1.0 - 2.0 * np.minimum(limit / SLIDING, 1.0)) / np.pi
    slides = (loads > 0.0) & (limit < SLIDING)
    assert slides.tolist() == [False, True, True, False]
    np.testing.assert_allclose(actual.slip_distance[:4][slides], slip[slides], rtol=1e-5)
    np.testing.assert_allclose(actual.slip_fraction[:4][slides], 1.0 - stick[slides], atol=2.0 / SAMPLES)
    np.testing.assert_allclose(actual.stick_fraction[:4][slides], stick[slides], atol=2.0 / SAMPLES)
    # without load a pair is open throughout, under a large one it sticks
    assert (actual.separated_fraction[0], actual.slip_distance[0]) == (1.0, 0.0)
    assert (actual.stick_fraction[3], actual.slip_distance[3]) == (1.0, 0.0)
    np.testing.assert_allclose(actual.mean_normal_force[:4], loads, atol=1e-12)
    np.testing.assert_array_equal(actual.normal_load[:4], loads)


def test_slip_times_friction_is_the_energy_of_a_constant_load() -> None:
    response = response_of([2.0, 5.0, 10.0, 20.0], SLIDING, 0.0)
    work = FRICTION * response.pairs.normal_load * pair_measures(response, 0).slip_distance
    np.testing.assert_allclose(work, response.pair_cycle(0).dissipated_energy, rtol=1e-4)
    assert (work > 0.0).all()


@pytest.mark.slow
def test_separated_time_and_mean_pressure_of_a_pair_that_bounces() -> None:
    """``N = max(N0 + k c cos, 0)``: open for ``arccos(N0 / (k c)) / pi``, with the mean of the clipped cosine."""
    loads = np.array([3.0, 6.0, 12.0, -6.0])
    actual = pair_measures(response_of(loads.tolist(), SLIDING, BOUNCING), 0)
    opening = np.arccos(np.clip(loads / (NORMAL * BOUNCING), -1.0, 1.0))
    mean = (loads * (np.pi - opening) + NORMAL * BOUNCING * np.sin(opening)) / np.pi
    np.testing.assert_allclose(actual.separated_fraction[:4], opening / np.pi, atol=2.0 / SAMPLES)
    np.testing.assert_allclose(actual.mean_normal_force[:4], mean, rtol=1e-4)
    total = actual.stick_fraction + actual.slip_fraction + actual.separated_fraction
    np.testing.assert_allclose(total, 1.0, rtol=1e-12)
    assert (actual.slip_fraction[:4] > 0.0).all()
    np.testing.assert_allclose(actual.slip_distance[:4], [_marched_slip(load) for load in loads], rtol=2e-3)


def test_the_motion_of_an_open_pair_is_no_slip() -> None:
    """It closes and opens at the same place, so with much friction it sticks whenever it is closed."""
    response = response_of([3.0, 6.0], 0.0, BOUNCING, friction=1e3)
    response.displacement[:, 0, 1] = SLIDING
    actual = pair_measures(replace(response, samples=64), 0)
    assert (actual.separated_fraction > 0.3).all()
    assert not actual.slip_fraction.any()
    assert not actual.slip_distance.any()


def _marched_slip(load: float) -> float:
    """m of slip in contact in the second cycle of a bouncing pair, by elastic trial steps along t1 alone."""
    count = 2 * SAMPLES
    phase = 2.0 * np.pi * np.arange(2 * count + 1) / count
    path, limit = SLIDING * np.sin(phase), FRICTION * np.maximum(load + NORMAL * BOUNCING * np.cos(phase), 0.0)
    traction = slip = 0.0
    for step in range(1, len(path)):
        trial = traction + TANGENTIAL * (path[step] - path[step - 1])
        traction = min(max(trial, -limit[step]), limit[step])
        if step > count and limit[step] > 0.0 and limit[step - 1] > 0.0:
            slip += abs(trial - traction) / TANGENTIAL
    return slip


def test_a_jenkins_element_slides_and_a_cubic_spring_has_no_slider() -> None:
    limit = 5.0
    laws: list[ContactLaw] = [
        JenkinsElement(np.full(4, TANGENTIAL), np.full(4, limit), np.full(4, NORMAL)),
        CubicSpring(np.full((4, 3), 1e6), np.full((4, 3), 1e15)),
    ]
    actual = pair_measures(response_of([0.0], SLIDING, BOUNCING, laws), 2)
    np.testing.assert_allclose(actual.slip_distance[:4], 4.0 * (SLIDING - limit / TANGENTIAL), rtol=1e-5)
    assert not actual.separated_fraction[:4].any()
    assert np.isnan(actual.slip_distance[4:]).all()
    assert np.isnan(actual.stick_fraction[4:]).all()
    assert np.isfinite(actual.dissipated_energy).all()


def folded() -> ForcedResponse:
    """Frequencies that rise, fall and rise again, and then a second part."""
    base = synthetic_response(2, 2, n_points=8)
    frequency = np.array([400.0, 420.0, 440.0, 430.0, 415.0, 450.0, 470.0, 480.0])
    return replace(base, frequency_hz=frequency, part=np.array([0, 0, 0, 0, 0, 0, 1, 1]))


def test_a_frequency_on_a_fold_means_its_highest_point() -> None:
    response = folded()
    output = synthetic_study(2, 2).outputs[synthetic_study(2, 2).response_output]
    amplitude = response.amplitude(output)
    near = [1, 4] if amplitude[1] < amplitude[4] else [4, 1]
    assert point_at_frequency(response, output, 417.0) == near[1]
    assert point_at_frequency(response, output, 402.0) == 0
    assert point_at_frequency(response, output, 480.0) == 7
    for wrong in (399.0, 481.0, 460.0):
        with rejects(InputError, "frequency_hz"):
            point_at_frequency(response, output, wrong)
    with rejects(InputError, "frequency_hz"):
        point_at_frequency(response, output, -1.0)
