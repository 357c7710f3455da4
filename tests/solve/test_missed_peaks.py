"""Narrow resonances are on the curve, and the search after the curve finds those of a curve that stepped over them.

The expected peaks are those of the independent search (benchmarks/torture_peaks.py), which starts its own curves with
short steps around each natural frequency. Version 0.1.0 reported the first of them as 7.7 um.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from helpers import Blade, benchmark_module
from stickslip.solve.harmonic import missed_peaks
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.harmonic.missed_peaks import PeakCheck, search_missed_peaks
from stickslip.solve.harmonic.resonances import Resonances
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.setting_up import Balances, prepare_balances

make = benchmark_module("torture_problems").make

PEAKS = {5: {114.6625: 1.2544e-3}, 54: {892.340: 9.5347e-5, 698.481: 4.1208e-5, 626.644: 1.38497e-5}}  # Hz: m


@pytest.mark.long
@pytest.mark.parametrize("seed", PEAKS)
def test_narrow_peaks_are_on_the_curve(seed: int) -> None:
    problem = make("narrow", seed)
    response = problem.solve()
    assert response.converged
    amplitude = response.amplitude(problem.structure.output)
    for hertz, expected in PEAKS[seed].items():
        near = np.abs(response.frequency_hz - hertz) < 2e-3 * hertz
        assert amplitude[near].max() == pytest.approx(expected, rel=0.01)
    assert "natural frequencies (stuck, free, tangent) checked" in str(response.settings["search_for_missed_peaks"])
    assert not [words for words in response.warnings if "stepped over" in words]


def prepared(seed: int) -> Balances:
    problem = make("narrow", seed)
    return prepare_balances(
        problem.superelement(),
        problem.pairs(),
        problem.excitation(),
        2.0 * np.pi * max(problem.window_hz),
        harmonics=3,
        samples=128,
        modal_damping_ratio=problem.modal_damping_ratio,
        update="tractrix",
        on_stage=lambda words: None,
    )


def without_landmarks(seed: int) -> PeakCheck:
    """The search on a curve that knows no natural frequency."""
    balances, window = prepared(seed), make("narrow", seed).window_hz
    curve = FrequencyCurve(balances.with_harmonics(3))
    newton = Newton(curve, NewtonSettings())
    start, stop = (2.0 * np.pi * hertz for hertz in window)
    first = newton.correct(
        curve.at(curve.balance.linear(start), start), Plane.fixed(curve.balance.linear(start), start)
    )
    branch = Branch(newton, first.point, stop, ContinuationSettings())
    branch.follow()
    assert branch.complete
    resonances = Resonances(balances.closed, balances.free, balances.stuck, balances.force)
    return search_missed_peaks(newton, [each.point for each in branch.points], resonances.seen)


@pytest.mark.slow
def test_the_search_finds_the_peak_that_a_curve_without_landmarks_misses() -> None:
    check = without_landmarks(54)
    for hertz in (698.481, 626.644):
        assert [peak for peak in check.missed if abs(peak.frequency_hz - hertz) < 0.1 and peak.factor > 10.0]
    assert len(check.warnings()) == 1 + bool(check.failed_hz)
    assert f"{len(check.missed)} missed peaks" in check.words()
    assert check.natural_frequencies == 8
    assert check.narrowest_hz == pytest.approx(min(each.width_hz for each in make("narrow", 54).resonances), rel=1e-6)


@pytest.mark.long
def test_steps_up_to_a_half_power_width_hide_no_peak_and_are_not_searched(
    blade: Blade, monkeypatch: pytest.MonkeyPatch
) -> None:
    checks: list[PeakCheck] = []

    def listening(*arguments: Any) -> PeakCheck:
        checks.append(search_missed_peaks(*arguments))
        return checks[-1]

    monkeypatch.setattr("stickslip.solve.forced.search_missed_peaks", listening)
    for shortest in (missed_peaks.LONG, 0.5):
        monkeypatch.setattr(missed_peaks, "LONG", shortest)
        blade.response(frequency_hz=blade.window_hz)
    usual, thorough = checks
    assert usual.natural_frequencies == thorough.natural_frequencies > 0
    assert usual.solved < thorough.solved
    assert (thorough.missed, thorough.failed_hz) == ((), ())
