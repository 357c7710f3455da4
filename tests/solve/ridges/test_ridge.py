"""Ridges of peaks: closed forms of linear resonances, slopes by differences, dense sweeps, and ends of ridges."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from helpers import Blade
from sentences import printed_sentence, rejects
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.peak import ANOTHER_PEAK, LARGEST_STEP, MOST_FAILURES, CurvePeak, Probe
from stickslip.solve.ridges.ridge_line import RidgeLine
from stickslip.solve.ridges.ridge_slope import STEP
from stickslip.solve.ridges.ridge_stage import Problem, RidgeOptions, RidgeStage
from stickslip.solve.ridges.ridge_walk import Pace, RidgePoint
from stickslip.solve.setting_up import StageReport

RATIO = 0.01
# Two masses of 1 kg that do not touch each other, each on a spring to the ground; 10 and 15 Hz.
OMEGA = 2.0 * np.pi * np.array([10.0, 15.0])


def two_resonances(force: tuple[float, float], load: float = 1e6) -> Problem:
    """Both masses under forces; a pair under a high load holds the first one with a tenth of its spring."""
    spring = 0.1 * OMEGA[0] ** 2
    structure = ss.Superelement(np.eye(2), np.diag(OMEGA**2 - [spring, 0.0]), np.diag(2.0 * RATIO * OMEGA))
    operator = np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    return structure, ss.ContactPairs(operator, 1.0, spring, 0.5, load), ss.Excitation.force(list(force))


def linear_peak(force: float, omega: float) -> float:
    """Peak amplitude of a mass of 1 kg on a damped spring."""
    return force / (2.0 * RATIO * math.sqrt(1.0 - RATIO**2) * omega**2)


def stage_of(problem: Problem, output: FloatArray, window: tuple[float, float], **options: Any) -> RidgeStage:
    return RidgeStage.of(problem, output, RidgeOptions(window, **options), None, StageReport(None))


def test_a_search_finds_the_peak_of_a_linear_resonance() -> None:
    stage = stage_of(two_resonances((1.0, 0.0)), np.array([1.0, 0.0]), (5.0, 12.0), harmonics=1, samples=16)
    for hertz in (9.85, 10.05):
        omega = 2.0 * np.pi * hertz
        peak = stage.search.from_point(stage.curve.at(stage.search.balance.linear(omega), omega))
        assert isinstance(peak, CurvePeak)
        width = RATIO * OMEGA[0]
        assert peak.omega == pytest.approx(OMEGA[0] * math.sqrt(1.0 - 2.0 * RATIO**2), abs=0.005 * width)
        assert peak.amplitude == pytest.approx(linear_peak(1.0, OMEGA[0]), rel=2e-5)
        assert -1.5 < peak.curvature < -0.9  # a difference of the slopes -tan(lag)
        assert not peak.is_corner


def test_a_sharp_curvature_of_close_points_ends_no_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Samples blur it: slopes 0.06 and 0.05 at points 0.001 rad apart feign -10, and the peak is 0.12 % higher."""
    stage = stage_of(two_resonances((1.0, 0.0)), np.array([1.0, 0.0]), (5.0, 12.0), harmonics=1, samples=16)
    search = stage.search
    probe = search._probe(stage.linear_point(10.0), 0)
    slopes = {0.0: 0.06, 0.001: 0.05, 0.06: 0.0}
    steps: list[float] = []

    def moved(last: Probe, step: float, most_failures: int) -> tuple[Probe, int]:
        steps.append(step)
        lag = (0.001, 0.06)[len(steps) - 1]
        return replace(last, slope=slopes[lag], lag=lag), 0

    monkeypatch.setattr(search, "_moved", moved)
    peak = search._search(replace(probe, slope=slopes[0.0], lag=0.0), -10.0)
    assert isinstance(peak, CurvePeak)
    assert len(steps) == 2
    assert peak.probe.slope == 0.0


def test_a_search_whose_steps_fail_again_and_again_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside a corner of the curve only tiny steps succeed, after many iterations each."""
    stage = stage_of(two_resonances((1.0, 0.0)), np.array([1.0, 0.0]), (5.0, 12.0), harmonics=1, samples=16)
    search, lengths = stage.search, list[float]()
    stepped = search._stepped

    def only_short(probe: Probe, length: float, tangent: Any, lag: float) -> Probe | None:
        lengths.append(length)
        return stepped(probe, length, tangent, lag) if abs(length) < 0.2 * LARGEST_STEP else None

    monkeypatch.setattr(search, "_stepped", only_short)
    reason = search.from_point(stage.linear_point(9.7))
    assert reason == "Newton's method did not converge on the way to the maximum"
    # The third fraction of each step succeeds, until the failures of all steps are too many.
    failed = np.abs(lengths) >= 0.2 * LARGEST_STEP
    assert failed.tolist() == [True, True, False] * 2 + [True, True]
    assert failed.sum() == MOST_FAILURES + 1


def test_a_search_far_from_a_peak_gives_a_reason() -> None:
    stage = stage_of(two_resonances((1.0, 0.0)), np.array([1.0, 0.0]), (5.0, 12.0), harmonics=1, samples=16)
    omega = 2.0 * np.pi * 6.0
    reason = stage.search.from_point(stage.curve.at(stage.search.balance.linear(omega), omega))
    assert reason == "the estimate is far from a maximum"


@pytest.mark.slow
def test_the_highest_peak_switches_where_two_linear_peaks_are_equal() -> None:
    def problem_at(force: float) -> Problem:
        return two_resonances((force, 1.0))

    ridge = ss.peak_ridge(
        problem_at, (0.2, 2.0), [1.0, 1.0], frequency_hz=(8.0, 17.0), harmonics=1, samples=16, name="force", unit="N"
    )
    assert ridge.converged, ridge.message
    # Beside a resonance the other mass moves a little: 0.1 % of the sum of both.
    value = (OMEGA[0] / OMEGA[1]) ** 2
    assert list(ridge.switches()) == pytest.approx([value], rel=0.01)
    top = ridge.at([0.3, 1.5])
    assert top.frequency_hz == pytest.approx([15.0, 10.0], rel=1e-3)
    assert top.amplitude == pytest.approx([linear_peak(1.0, OMEGA[1]), linear_peak(1.5, OMEGA[0])], rel=0.02)
    assert top.ridge[0] != top.ridge[1]


@pytest.mark.slow
def test_the_slope_is_that_of_differences_along_the_curve() -> None:
    """Ten pairs that slip: the tangent solves the bordered system, the slope follows from it without differences."""
    stage = stage_of(blade_problem(1.0, 1.0), Blade().tip, Blade().window_hz, harmonics=3, samples=512)
    peak = peak_of(stage)
    search, last = stage.search, peak.probe
    # Over many changes of samples, some degrees of phase.
    for lag in (0.2, -0.2):
        beside, _ = search._moved(last, lag, 0)
        assert beside is not None
        rise = 0.5 * lag * (beside.slope + last.slope)
        assert rise < -0.002
        assert math.log(beside.amplitude / last.amplitude) == pytest.approx(rise, rel=0.05)
    assert peak.probe.point.error < 1e-9


def blade_problem(force: float, load: float) -> Problem:
    blade = Blade()
    pairs = blade.pairs_with(load * blade.pairs.normal_load)
    return blade.superelement, pairs, ss.Excitation.force(force * blade.force_cos, force * blade.force_sin)


def peak_of(stage: RidgeStage) -> CurvePeak:
    """The peak of a whole curve."""
    points = [each.point for each in stage.whole_curve().points]
    peak = stage.search.from_point(points[int(np.argmax(stage.amplitude(points)))])
    assert isinstance(peak, CurvePeak)
    return peak


@pytest.mark.long
def test_a_ridge_over_the_normal_load_agrees_with_dense_sweeps() -> None:
    blade, limits = Blade(), (0.4, 2.5)

    def problem_at(factor: float) -> Problem:
        return blade_problem(1.0, factor)

    options: dict[str, Any] = {"frequency_hz": blade.window_hz, "harmonics": 1, "samples": 128}
    ridge = ss.peak_ridge(problem_at, limits, blade.tip, **options)
    assert ridge.converged, ridge.message
    values = np.geomspace(*limits, 4)[1:3]
    settings = ss.ContinuationSettings(largest_step=0.03)
    dense = [ss.forced_response(*problem_at(value), continuation=settings, **options) for value in values]
    highest = np.array([response.amplitude(blade.tip).max() for response in dense])
    assert ridge.at(values).amplitude == pytest.approx(highest, rel=1e-3)
    usual = ss.forced_response(*problem_at(1.0), **options)
    own = sum(int(ridge.settings[name]) for name in ("points_of_searches", "points_of_whole_curves"))
    assert own <= 0.1 * 40 * usual.n_points


@pytest.mark.slow
def test_a_peak_that_leaves_the_frequency_range_ends_its_ridge() -> None:
    def problem_at(factor: float) -> Problem:
        structure, pairs, excitation = two_resonances((1.0, 0.0))
        return ss.Superelement(structure.mass, factor * structure.stiffness, structure.damping), pairs, excitation

    with pytest.warns(ss.NotConvergedWarning):
        ridge = ss.peak_ridge(
            problem_at, (0.5, 1.1), [1.0, 0.0], frequency_hz=(8.0, 12.0), harmonics=1, samples=16, name="stiffness"
        )
    assert not ridge.converged
    low = float(ridge.parameter.min())
    assert 0.6 < low < 0.65  # the spring of the pair does not change: 8 Hz at 0.6
    assert np.isnan(ridge.at(0.55).amplitude).all()
    printed_sentence(ridge.message)


@pytest.mark.slow
def test_where_the_highest_peak_left_the_range_the_next_one_is_no_optimum() -> None:
    """A high resonance leaves the range of frequencies below a stiffness; a low one stays in it."""

    def problem_at(factor: float) -> Problem:
        structure, pairs, excitation = two_resonances((1.0, 0.1))
        softer = np.diag([factor, 1.0]) @ structure.stiffness
        return ss.Superelement(structure.mass, softer, structure.damping), pairs, excitation

    with pytest.warns(ss.NotConvergedWarning):
        ridge = ss.peak_ridge(
            problem_at, (0.5, 1.1), [1.0, 1.0], frequency_hz=(8.0, 1.5 * OMEGA[1] / (2.0 * np.pi)), harmonics=1,
            samples=16, name="stiffness",
        )  # fmt: skip
    left = float(ridge.unknown[0, 1])
    assert 0.6 < left < 0.65
    assert ridge.unknown[0, 0] == 0.5
    assert np.isnan(ridge.at(0.55).amplitude).all()
    assert ridge.at(0.7).amplitude > 0.0
    assert not ridge.converged
    printed_sentence(ridge.message)
    assert ridge.optimum.parameter >= left * (1.0 - 1e-9)


@pytest.mark.slow
def test_a_ridge_passes_a_node_of_the_excitation() -> None:
    """The force on the first mass vanishes at 1, exactly; a ridge without a peak there continues beyond."""

    def problem_at(factor: float) -> Problem:
        return two_resonances((1.0 - factor, 0.0))

    ridge = ss.peak_ridge(problem_at, (0.5, 1.4), [1.0, 0.0], frequency_hz=(8.0, 12.0), harmonics=1, samples=16)
    assert ridge.converged, ridge.message
    values = np.array([0.6, 0.8, 0.9, 1.1, 1.2, 1.35])
    exact = [linear_peak(abs(1.0 - value), OMEGA[0]) for value in values]
    assert ridge.at(values).amplitude == pytest.approx(exact, rel=1e-3)
    # One ridge from end to end, also where a step arrives exactly at the node.
    assert ridge.ends[0] == ("", "")
    assert float(ridge.highest().amplitude.min()) < 0.01 * linear_peak(0.4, OMEGA[0])


def test_a_ridge_stays_with_its_mode_where_frequencies_cross() -> None:
    """The first mass becomes the faster one at 2.25; its ridge is the one with the large amplitude on both sides."""

    def problem_at(factor: float) -> Problem:
        structure, pairs, excitation = two_resonances((1.0, 0.3))
        stiffness = structure.stiffness + np.diag([(factor - 1.0) * OMEGA[0] ** 2, 0.0])
        return ss.Superelement(structure.mass, stiffness, structure.damping), pairs, excitation

    stages = [
        stage_of(problem_at(factor), np.array([1.0, 1.0]), (8.0, 20.0), harmonics=1, samples=16)
        for factor in (2.0, 2.5)
    ]
    first = stages[0].stuck_mode(0)
    assert stages[1].same_mode(first).number == 1
    assert stages[1].same_mode(first).omega == pytest.approx(math.sqrt(2.5) * OMEGA[0])


def test_the_lag_of_a_search_is_that_of_the_motion() -> None:
    """A step along the tangent of a resonance arrives at another phase than planned."""
    stage = stage_of(two_resonances((1.0, 0.0)), np.array([1.0, 0.0]), (5.0, 12.0), harmonics=1, samples=16)
    search, omega = stage.search, 0.997 * OMEGA[0]

    def phase(probe: Probe) -> float:
        ratio = probe.point.trial.omega / OMEGA[0]
        return math.atan2(2.0 * RATIO * ratio, 1.0 - ratio**2)

    first = search._probe(stage.linear_point(omega / (2.0 * math.pi)), 0)
    after, _ = search._moved(first, 0.4, 0)
    assert after is not None
    turned = phase(after) - phase(first)
    assert after.lag == pytest.approx(turned, rel=0.05)  # the weights are those at both ends
    assert abs(turned - 0.4) > 0.1 * turned


@pytest.mark.slow
def test_a_search_above_the_highest_amplitude_stops() -> None:
    stage = stage_of(two_resonances((1.0, 0.0)), np.array([1.0, 0.0]), (5.0, 12.0), harmonics=1, samples=16)
    peak = peak_of(stage)
    point, top = peak.probe.point, peak.amplitude
    estimate = point.unknowns, point.trial.omega, peak.probe.tangent, peak.curvature
    assert isinstance(stage.search.from_estimate(*estimate, highest=1.01 * top), CurvePeak)
    assert stage.search.from_estimate(*estimate, highest=0.9 * top) == ANOTHER_PEAK


@pytest.mark.slow
def test_no_peak_in_the_range_is_an_error() -> None:
    with rejects(ss.ConvergenceError):
        ss.peak_ridge(
            lambda factor: two_resonances((factor, 0.0)), (1.0, 2.0), [1.0, 0.0], frequency_hz=(11.0, 12.0),
            harmonics=1, samples=16,
        )  # fmt: skip


@pytest.mark.parametrize("limits", [(1.0, 1.0), (0.0, 1.0), (-1.0, 2.0), (1.0, 2.0, 3.0), (np.nan, 1.0), (2.0, 1.0)])
def test_a_range_that_cannot_be_used_is_rejected(limits: tuple[float, ...]) -> None:
    def no_problem(factor: float) -> Problem:
        raise AssertionError("nothing runs before the range is checked")

    with rejects(ss.InputError, "parameter"):
        ss.peak_ridge(no_problem, limits, [1.0], frequency_hz=(1.0, 2.0))  # type: ignore[arg-type]


def test_an_output_of_another_size_is_rejected() -> None:
    with rejects(ss.InputError, "output"):
        ss.peak_ridge(lambda factor: two_resonances((factor, 0.0)), (1.0, 2.0), [1.0], frequency_hz=(8.0, 12.0))


def blade_point(value: float, problem_at: Callable[[float], Problem]) -> RidgePoint:
    """The peak of the blade at a value of a parameter, with its slope."""
    options = RidgeOptions(Blade().window_hz, harmonics=3, samples=512)
    changed = partial(problem_at, value * (1.0 + STEP))
    stage = RidgeStage.of(problem_at(value), Blade().tip, options, None, StageReport(None), None, changed)
    return Pace().resolved(RidgePoint.start(value, peak_of(stage), stage), stage)


@pytest.mark.slow
def test_the_slope_of_a_ridge_is_that_of_differences_of_peaks() -> None:
    """Ten pairs that slip, with the normal load changed by 3 % to both sides."""
    step = 0.03
    points = [
        blade_point(value, lambda load: blade_problem(1.0, load)) for value in (math.exp(-step), 1.0, math.exp(step))
    ]
    line = RidgeLine.of(points)
    expected = (line.heights[2] - line.heights[0]) / (2.0 * step)
    assert abs(expected) > 0.2
    assert line.slopes[1] == pytest.approx(expected, rel=0.05)


@pytest.mark.slow
def test_slopes_by_force_and_by_load_add_up_to_one() -> None:
    """Twice the force and twice the loads give twice the motion."""
    by_force = blade_point(1.0, lambda force: blade_problem(force, 1.0)).rise
    by_load = blade_point(1.0, lambda load: blade_problem(1.0, load)).rise
    assert 0.1 < by_force < 0.9
    assert by_force + by_load == pytest.approx(1.0, abs=2e-3)


def test_a_slope_is_not_known_where_the_structure_changes() -> None:
    problem = two_resonances((1.0, 0.0))
    heavier = ss.Superelement(1.1 * problem[0].mass, problem[0].stiffness, problem[0].damping)
    options = RidgeOptions((5.0, 12.0), harmonics=1, samples=16)
    stage = RidgeStage.of(
        problem, np.array([1.0, 0.0]), options, None, StageReport(None), None, lambda: (heavier, *problem[1:])
    )
    assert math.isnan(stage.rise(peak_of(stage)))
    assert stage_of(problem, np.array([1.0, 0.0]), (5.0, 12.0), harmonics=1, samples=16).changed is None


def test_a_point_between_two_with_small_estimates_has_none_of_its_own() -> None:
    stage = stage_of(two_resonances((1.0, 0.0)), np.array([1.0, 0.0]), (5.0, 12.0), harmonics=1, samples=16)
    pace, point = Pace(accuracy=0.01, most_harmonics=1), RidgePoint.start(1.0, peak_of(stage), stage)
    small, large = (replace(point, estimates={1: error}) for error in (0.005, 0.02))
    assert pace.between(point, stage, [small, small]).estimates == {}
    assert pace.between(point, stage, [small, large]).estimates
