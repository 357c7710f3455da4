"""Checks of a ridge with more harmonics: the peak of a whole curve, and estimated errors of single peaks."""

from __future__ import annotations

import pytest

import stickslip as ss
from helpers import Blade
from sentences import printed_sentence
from stickslip.results.checked_peak import CheckedPeak
from stickslip.solve.harmonic.peak import CurvePeak
from stickslip.solve.ridges.ridge_check import MOST_HARMONICS, checked_peak
from stickslip.solve.ridges.ridge_stage import RidgeOptions, RidgeStage
from stickslip.solve.setting_up import StageReport

BLADE = Blade()
SAMPLES = 256


def stage_of(harmonics: int, window: tuple[float, float] = BLADE.window_hz) -> RidgeStage:
    problem = BLADE.superelement, BLADE.pairs, ss.Excitation.force(BLADE.force_cos, BLADE.force_sin)
    options = RidgeOptions(window, harmonics=harmonics, samples=SAMPLES)
    return RidgeStage.of(problem, BLADE.tip, options, None, StageReport(None))


def peak_of(stage: RidgeStage) -> CurvePeak:
    points = [each.point for each in stage.whole_curve().points]
    top = max(points, key=lambda point: stage.search.amplitude(point.trial))
    peak = stage.search.from_point(top)
    assert isinstance(peak, CurvePeak)
    return peak


def highest(harmonics: int) -> float:
    """The largest amplitude of a curve with fine steps."""
    settings = ss.ContinuationSettings(largest_step=0.02)
    response = BLADE.response(
        frequency_hz=BLADE.window_hz, harmonics=harmonics, samples=SAMPLES, continuation=settings, checks=False
    )
    return float(response.amplitude(BLADE.tip).max())


@pytest.mark.slow
def test_a_check_has_the_peak_of_a_fine_curve_with_many_harmonics() -> None:
    found = checked_peak(stage_of(3), 1.0, 1e-3, BLADE.window_hz)
    assert isinstance(found, CheckedPeak)
    assert 3 <= found.harmonics <= MOST_HARMONICS
    many = highest(13)
    # The largest of the points of a curve is a little below its peak.
    assert found.amplitude == pytest.approx(many, rel=found.error + 1e-3)
    assert abs(highest(1) / many - 1.0) > found.error  # the ridge with one harmonic is worse


@pytest.mark.slow
def test_the_estimated_error_of_a_peak_is_near_the_true_one() -> None:
    stage = stage_of(1)
    peak, many = peak_of(stage), highest(13)
    error = abs(peak.amplitude / many - 1.0)
    assert 0.5 * error < stage.estimated_error(peak) < 10.0 * error
    # More harmonics until the accuracy is reached, with the errors on the way.
    fine, errors = stage.refined(peak, 2e-3, 9)
    assert fine.harmonics == max(errors) > 1
    assert errors[fine.harmonics] < 2e-3 < errors[1]
    assert fine.amplitude == pytest.approx(many, rel=errors[fine.harmonics] + 1e-3)
    assert stage.refined(peak, 2e-3, 1)[0] is peak


def test_a_check_without_a_peak_inside_gives_a_reason() -> None:
    low = BLADE.window_hz[0], BLADE.window_hz[0] + 0.05 * (BLADE.window_hz[1] - BLADE.window_hz[0])
    found = checked_peak(stage_of(3), 1.0, 1e-3, low)
    assert isinstance(found, str)
    printed_sentence(found)
