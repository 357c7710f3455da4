"""Checks of a ridge with more harmonics: the peak of a whole curve, and estimated errors of single peaks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import NamedTuple

import pytest

import stickslip as ss
from helpers import Blade
from sentences import printed_sentence
from stickslip.results.checked_peak import CheckedPeak
from stickslip.solve.harmonic.peak import CurvePeak
from stickslip.solve.ridges import ridge_check
from stickslip.solve.ridges.ridge_check import MOST_HARMONICS, checked_minimum, highest_of
from stickslip.solve.ridges.ridge_stage import RidgeOptions, RidgeStage, Work
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


@pytest.mark.long
def test_a_check_has_the_peak_of_a_fine_curve_with_many_harmonics() -> None:
    stage = stage_of(3)
    found, error = highest_of(stage, [peak_of(stage)], 1e-3)
    assert 3 <= found.harmonics <= MOST_HARMONICS
    many = highest(13)
    # The largest of the points of a curve is a little below its peak.
    assert found.amplitude == pytest.approx(many, rel=error + 1e-3)
    assert abs(highest(1) / many - 1.0) > error  # the ridge with one harmonic is worse


@pytest.mark.long
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


class Named(NamedTuple):
    """A stand-in of a peak."""

    amplitude: float
    harmonics: int = 3


class Stage:
    """Stand-in equations: estimated errors by amplitude; more harmonics give the amplitude in ``fine``."""

    harmonics = 3

    def __init__(self, errors: dict[float, float], fine: dict[float, float]) -> None:
        self.errors, self.fine = errors, fine

    def with_harmonics(self, harmonics: int) -> Stage:
        return self

    def estimated_error(self, peak: Named) -> float:
        return self.errors[peak.amplitude]

    def refined(self, peak: Named, accuracy: float, most: int) -> tuple[Named, dict[int, float]]:
        if self.errors[peak.amplitude] <= accuracy:
            return peak, {peak.harmonics: self.errors[peak.amplitude]}
        return Named(self.fine[peak.amplitude], most), {most: accuracy}


def test_a_peak_that_could_be_as_high_has_more_harmonics_too() -> None:
    stage = Stage({10.0: 0.001, 9.0: 0.2, 8.0: 0.02}, {9.0: 11.0})
    best, error = highest_of(stage, [Named(8.0), Named(9.0), Named(10.0)], 0.01)  # type: ignore[list-item, arg-type]
    assert (best.amplitude, best.harmonics) == (11.0, MOST_HARMONICS)
    assert error == pytest.approx(0.01)
    # One that is ruled out has no more harmonics (its stand-in has none), and no part in the error.
    low = Stage({10.0: 0.001, 8.0: 0.02}, {})
    assert highest_of(low, [Named(8.0), Named(10.0)], 0.01)[1] == 0.001  # type: ignore[list-item, arg-type]


class Map:
    """A stand-in of a ridge map, whose minimum moves along ``places`` with each curve of its own harmonics; ``checks``
    are the places of whole curves with more harmonics."""

    def __init__(self, places: list[float | None], seen: bool = True, highest: float = 1.0) -> None:
        self.places, self.curves, self._seen, self._highest = places, [], seen, highest  # type: ignore[var-annotated]
        self.verified: set[float] = set()
        self.checks: list[float] = []
        self.work = Work()

    def harmonics_near(self, value: float, least: int) -> int:
        return least

    def highest_at(self, value: float) -> float:
        return self._highest

    def curve_task(self, value: float, harmonics: int, work: Work) -> Callable[[], tuple[Stage, SimpleNamespace]]:
        self.checks.append(value)
        work.points += 1
        return lambda: (Stage({2.0: 0.001}, {}), SimpleNamespace(complete=True, points=[]))

    def result(self, *names: str) -> SimpleNamespace:
        place = self.places[min(len(self.curves), len(self.places) - 1)]
        return SimpleNamespace(slipping_minimum=place and SimpleNamespace(parameter=place))

    def add_curve(self, value: float) -> None:
        self.curves.append(value)
        if self._seen:
            self.verified.add(value)


PEAK = SimpleNamespace(amplitude=2.0, omega=1.0, harmonics=3)


def checked(
    ridges: Map, monkeypatch: pytest.MonkeyPatch, beside: Callable[[], None] = lambda: None
) -> CheckedPeak | str | None:
    monkeypatch.setattr(ridge_check, "peaks_of_curve", lambda stage, points: [PEAK])
    return checked_minimum(ridges, 0.01, beside)  # type: ignore[arg-type]


def test_a_whole_curve_follows_a_minimum_that_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    ridges = Map([1.0, 2.0, 2.005])
    found = checked(ridges, monkeypatch)
    assert ridges.curves == [1.0, 2.0]
    assert ridges.checks == [1.0, 2.0]
    assert isinstance(found, CheckedPeak)
    assert (found.parameter, found.amplitude, found.error) == (2.0, 2.0, 0.001)


def test_one_curve_is_enough_where_it_has_the_peak_of_the_ridges(monkeypatch: pytest.MonkeyPatch) -> None:
    """1 % between the peak with more harmonics and that of the ridges; the highest of them all stays verified."""
    ridges = Map([1.0, 2.0], highest=1.98)
    found = checked(ridges, monkeypatch)
    assert isinstance(found, CheckedPeak)
    assert (found.parameter, ridges.checks, ridges.curves) == (1.0, [1.0], [])
    assert ridges.verified == {1.0}


def test_a_check_is_not_repeated_where_the_minimum_does_not_move(monkeypatch: pytest.MonkeyPatch) -> None:
    ridges = Map([1.0, 1.0])
    assert isinstance(checked(ridges, monkeypatch), CheckedPeak)
    assert (ridges.curves, ridges.checks) == ([1.0], [1.0])


@pytest.mark.parametrize(("moved", "checks"), [(1.005, [1.0]), (1.2, [1.0, 1.2])])
def test_a_check_is_repeated_where_the_work_beside_it_moves_the_minimum(
    moved: float, checks: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    ridges = Map([1.0], highest=2.0)
    found = checked(ridges, monkeypatch, lambda: ridges.places.__setitem__(0, moved))
    assert isinstance(found, CheckedPeak)
    assert (found.parameter, ridges.checks) == (checks[-1], checks)
    assert ridges.work.points == len(checks)


@pytest.mark.parametrize("places", [[None], [1.0]])
def test_the_work_beside_a_check_is_done_without_a_minimum_too(
    places: list[float | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    ridges = Map(places)
    assert checked(ridges, monkeypatch, lambda: ridges.places.__setitem__(0, None)) is None
    assert ridges.places == [None]


def test_a_minimum_that_is_not_known_has_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    assert checked(Map([None]), monkeypatch) is None
    for ridges in (Map([1.0, 2.0, 3.0, 4.0]), Map([1.0], seen=False)):
        reason = checked(ridges, monkeypatch)
        assert isinstance(reason, str)
        printed_sentence(reason)


def test_a_whole_curve_needs_no_iteration_before_pairs_move_and_has_the_steps_of_its_options() -> None:
    """The motion with stuck contacts is a solution there; a longer step gives fewer points and the same peak."""
    stage = stage_of(3)
    curves = [
        replace(stage, options=replace(stage.options, curve_step=step)).whole_curve().points for step in (0.04, 0.14)
    ]
    heights = [stage.amplitude([each.point for each in points]).max() for points in curves]
    assert len(curves[1]) < 0.7 * len(curves[0])
    assert heights[1] == pytest.approx(heights[0], rel=0.01)
    for points in curves:
        moves = [bool(each.point.trial.contact.moves.any()) for each in points]
        first = moves.index(True)
        assert first > 2
        assert [each.iterations for each in points[1:first]] == [0] * (first - 1)
