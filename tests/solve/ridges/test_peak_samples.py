"""Highest peaks at single values of a parameter, by whole frequency curves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from helpers import Blade
from sentences import printed_sentence
from stickslip.core.errors import ConvergenceError
from stickslip.core.threads import solver_threads
from stickslip.solve.ridges.peak_samples import CLOSE, PeakSamples
from stickslip.solve.ridges.ridge_stage import RidgeOptions, RidgeStage, Work
from stickslip.solve.ridges.ridge_walk import Pace
from stickslip.solve.setting_up import StageReport

BLADE = Blade()
FAILING = 1.5
BOUNDS = (0.5, 2.0)


def problem_at(factor: float) -> Any:
    force = ss.Excitation.force(factor * BLADE.force_cos, factor * BLADE.force_sin)
    return BLADE.superelement, BLADE.pairs, force


def made(value: float, earlier: RidgeStage | None) -> RidgeStage:
    if value == FAILING:
        raise ConvergenceError("the static state does not exist.")
    options = RidgeOptions(BLADE.window_hz, harmonics=1, samples=64)
    return RidgeStage.of(problem_at(value), BLADE.tip, options, None, StageReport(None), earlier)


def samples(work: Work | None = None) -> PeakSamples:
    return PeakSamples(made, StageReport(None), Pace(), "{:.4g} N".format, work or Work(), None, 1.03)


def result_of(sampled: PeakSamples) -> ss.PeakRidge:
    return sampled.result(BOUNDS, "force", "N", "tip")


@pytest.mark.slow
def test_the_peaks_are_those_of_a_ridge() -> None:
    sampled = samples()
    sampled.add([2.0, 1.0, 0.5])
    found = result_of(sampled)
    followed = ss.peak_ridge(problem_at, BOUNDS, BLADE.tip, frequency_hz=BLADE.window_hz, harmonics=1, samples=64)
    assert found.parameter.tolist() == [0.5, 1.0, 2.0]
    at = followed.at(found.parameter)
    assert found.amplitude == pytest.approx(at.amplitude, rel=1e-3)
    assert found.frequency_hz == pytest.approx(at.frequency_hz, rel=2e-3)  # the peaks are flat
    assert found.converged
    printed_sentence(found.message + "\n" + "\n".join(found.warnings))
    assert found.stuck_parameter.tolist() == found.parameter.tolist()
    assert int(found.settings["points_of_whole_curves"]) > 30


@pytest.mark.slow
def test_a_value_without_equations_leaves_a_gap_with_a_reason() -> None:
    sampled = samples()
    sampled.add([2.0, FAILING, 1.0, 0.5])
    found = result_of(sampled)
    assert not found.converged
    printed_sentence(found.message)
    assert found.warnings[1:] == ("At 1.5 N: the static state does not exist.",)
    assert found.unknown.tolist() == [[1.0, 2.0]]
    assert np.isnan(found.at(1.5).amplitude[0])
    assert found.at(0.7).amplitude[0] > 0.0


def test_without_any_peak_there_is_no_result() -> None:
    sampled = samples()
    sampled.add([FAILING])
    sampled.divide_lowest()
    with pytest.raises(ConvergenceError, match="the static state does not exist"):
        result_of(sampled)


def test_no_curve_begins_when_the_work_is_used_up() -> None:
    sampled = samples(Work(0.0))
    sampled.add([1.0])
    assert sampled.failures == {1.0: "more work was not allowed"}


@pytest.mark.slow
def test_intervals_beside_the_lowest_peak_are_divided() -> None:
    sampled = samples()
    sampled.add([0.5, 1.0, 2.0])  # the peak rises with the force
    sampled.divide_lowest()
    assert [each.parameter for each in sampled.points] == pytest.approx([0.5, 0.5**0.5, 1.0, 2.0])
    for _ in range(4):
        sampled.divide_lowest()
    places = [each.parameter for each in sampled.points]
    assert places[0] < places[1] < CLOSE * places[0]
    assert places[2] > CLOSE * places[1] or len(places) < 8


@pytest.mark.slow
@pytest.mark.parametrize("threads", [2, 3])
def test_the_digits_do_not_depend_on_threads(threads: int) -> None:
    def found(count: int) -> ss.PeakRidge:
        sampled = samples()
        with solver_threads(count):
            sampled.add([2.0, 1.2, 0.8, 0.5])
        return result_of(sampled)

    one, several = found(1), found(threads)
    assert one.amplitude.tobytes() == several.amplitude.tobytes()
    assert one.settings == several.settings
