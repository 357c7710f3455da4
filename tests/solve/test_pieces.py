"""A curve whose branch is lost begins again beyond, and a time integration tells what happens there."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import stickslip as ss
from lost_curves import resonance
from sentences import printed_sentence, rejects
from stickslip.core.errors import ConvergenceError
from stickslip.solve import forced, lent_harmonics
from stickslip.solve import pieces as pieces_module
from stickslip.solve import settled_motion as settled_module
from stickslip.solve.evidence import Evidence, Settling
from stickslip.solve.harmonic import varying_harmonics
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.work import Work
from stickslip.solve.pieces import Pieces
from stickslip.solve.settled_motion import SettledMotion

ROW = np.array([1.0, 0.0, 0.0])
SETTLES = Evidence(1.0, 20, 1e-6, 0.02, 1)


def point(hertz: float, motion: float = 1.0) -> Any:
    return SimpleNamespace(
        trial=SimpleNamespace(omega=2.0 * np.pi * hertz, amplitude=np.zeros((6, 1))),
        parameters=[2.0 * np.pi * hertz],
        measured=np.array([motion]),
    )


def branch(points: list[Any], stop: float, complete: bool) -> Any:
    return SimpleNamespace(
        points=[SimpleNamespace(point=each, iterations=1) for each in points],
        complete=complete,
        lost=not complete,
        message=f"toward {stop / (2.0 * np.pi):.0f}",
        retreats=[],
        corners=[],
        crossings=[],
    )


class Solutions(Settling):
    """Knows the frequencies in Hz at which there are solutions, and their motion."""

    def __init__(self, first: float, last: float, motion: float) -> None:
        self._first, self._last, self._motion = first, last, motion
        self.work = Work(most=100.0)

    def solution(self, near: Any, omega: float, ramp: bool) -> Any:
        hertz = omega / (2.0 * np.pi)
        return (point(hertz, self._motion), "by a guess") if self._first <= hertz <= self._last else None

    def evidence(self, point: Any, change: float, thorough: bool = False) -> Evidence:
        return SETTLES

    def evidence_from_rest(self, omega: float, thorough: bool = False) -> Evidence:
        return Evidence(1.0, 20, 0.3, None, None)


def pieces(first: float, last: float, motion: float, lowest: float) -> Pieces[Any]:
    """From 100 to 200 Hz; the branch from 100 ends at 150, others reach down to ``lowest``, with a ``motion``."""

    def part(start: Any, stop: float) -> Any:
        begin, end = start.trial.omega / (2.0 * np.pi), stop / (2.0 * np.pi)
        if begin == 100.0:
            return branch([point(each) for each in (100.0, 125.0, 150.0)], stop, complete=False)
        reached = max(end, lowest) if end < begin else end
        return branch([point(each, motion) for each in (begin, reached)], stop, complete=reached == end)

    window = 2.0 * np.pi * 100.0, 2.0 * np.pi * 200.0
    return Pieces(cast(Any, part), window, Solutions(first, last, motion))


def hertz_of(curve: Pieces[Any]) -> list[float]:
    return [each.point.trial.omega / (2.0 * np.pi) for each in curve.points]


def test_another_motion_beyond_is_another_piece() -> None:
    curve = pieces(150.05, 200.0, 2.0, 0.0).follow(point(100.0))
    assert curve.complete
    assert hertz_of(curve) == pytest.approx([100.0, 125.0, 150.0, 150.0, 150.1, 200.0])
    assert curve.breaks == [2]
    (warning,) = curve.warnings
    printed_sentence(warning, SETTLES.words())


def test_the_same_motion_beyond_is_the_same_piece() -> None:
    curve = pieces(150.05, 200.0, 1.0, 0.0).follow(point(100.0))
    assert curve.complete
    assert hertz_of(curve) == pytest.approx([100.0, 125.0, 150.0, 150.1, 200.0])
    assert curve.breaks == []
    assert curve.warnings == []
    assert len(curve.crossings) == 1


@pytest.mark.parametrize(("lowest", "complete"), [(150.9, True), (152.0, False)])
def test_a_gap_is_named_and_a_wide_one_is_no_complete_curve(lowest: float, complete: bool) -> None:
    curve = pieces(lowest, 200.0, 2.0, lowest).follow(point(100.0))
    assert curve.complete is complete
    (warning,) = curve.warnings
    low = min(hertz_of(curve)[3:])
    assert low >= lowest
    printed_sentence(warning, "150.000", f"{low:.3f} Hz")
    printed_sentence(curve.message)


def test_a_curve_that_no_step_lost_ends_with_what_happens_there_too() -> None:
    """Such as one of too many points."""
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    part = curve._part

    def many_points(start: Any, stop: float) -> Any:
        answer = cast(Any, part(start, stop))
        answer.lost = False
        return answer

    curve._part = many_points
    assert not curve.follow(point(100.0)).complete
    assert curve.message == f"toward 200 {SETTLES.words()}"


@pytest.mark.parametrize(
    ("given_by", "words"),
    [
        (None, "No number of harmonics up to 96 gives it to 5 %"),
        (3, "The harmonics of the curve reproduce it to 1.6 %; more do not help"),
        (48, "48 harmonics with 768 samples give it to 1.6 %: run again with harmonics = 48 and samples = 768"),
    ],
)
def test_the_evidence_says_whether_more_harmonics_help(given_by: int | None, words: str) -> None:
    settled = SettledMotion(96, given_by, 768, 0.016, 0.13)
    sentence = Evidence(100.0, 300, 1e-6, 0.5, 1, 2e-3, 3, settled).words()
    assert words in sentence
    assert "13 % of its vibration is in harmonics above 3" in sentence
    assert "with 1/4 of the time steps: 0.2 % away" in sentence


def test_without_a_solution_beyond_the_curve_ends_with_what_happens_there() -> None:
    curve = pieces(300.0, 400.0, 2.0, 0.0).follow(point(100.0))
    assert not curve.complete
    assert curve.message == f"toward 200 {SETTLES.words()}"
    assert hertz_of(curve) == pytest.approx([100.0, 125.0, 150.0])


def test_at_the_limit_of_the_work_no_solution_beyond_is_looked_for() -> None:
    """Though there is one."""
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    curve._settling.work.iterate(100)
    assert not curve.follow(point(100.0)).complete
    assert curve.message == f"toward 200 {SETTLES.words()} {curve._settling.work.limit_words}"
    assert hertz_of(curve) == pytest.approx([100.0, 125.0, 150.0])
    late = pieces(105.0, 200.0, 2.0, 102.0)
    late._settling.work.iterate(100)
    with rejects(ConvergenceError):
        late.follow(None, "there is none.")


@pytest.mark.parametrize(("varies", "begins"), [(True, 150.02), (False, 150.1)])
def test_with_an_accuracy_a_curve_goes_on_from_the_settled_motion_that_more_harmonics_give(
    varies: bool, begins: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Others look for a motion with their own number of harmonics."""
    settled = Evidence(150.02, 300, 1e-6, 0.5, 1, None, 3, SettledMotion(24, 24, 128, 0.01, 0.1, point(150.02, 2.0)))
    monkeypatch.setattr(Solutions, "evidence", lambda *arguments, **options: settled)
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    curve._varies = curve._takes_settled = varies
    assert curve.follow(point(100.0)).complete
    assert hertz_of(curve)[3:] == pytest.approx([150.0, begins, 200.0])
    (warning,) = curve.warnings
    printed_sentence(warning, settled.words(varies))


@pytest.mark.parametrize(("given_by", "begins"), [(24, 150.02), (3, 150.1)])
def test_a_curve_goes_on_with_the_harmonics_of_the_settled_motion_if_its_own_do_not_give_it(
    given_by: int, begins: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = SettledMotion(24, given_by, 128, 0.01, 0.1, point(150.02, 2.0))
    settled = Evidence(150.02, 300, 1e-6, 0.5, 1, None, 3, motion)
    monkeypatch.setattr(Solutions, "evidence", lambda *arguments, **options: settled)
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    curve._lends = curve._takes_settled = True
    if given_by == 24:
        monkeypatch.setattr(curve, "_beyond", lambda *arguments: None)  # its own harmonics go on nowhere
    assert curve.follow(point(100.0)).complete
    assert hertz_of(curve)[3:] == pytest.approx([150.0, begins, 200.0])
    (warning,) = curve.warnings
    assert "run again" not in warning
    limited = pieces(150.05, 200.0, 2.0, 0.0)
    limited._lends = limited._takes_settled = True
    limited._settling.work.iterate(150)
    assert not limited.follow(point(100.0)).complete
    assert hertz_of(limited) == pytest.approx([100.0, 125.0, 150.0])


def test_a_curve_goes_on_with_its_own_harmonics_where_they_have_a_motion_beyond(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Though a time integration settles there on a motion that they do not give."""
    motion = SettledMotion(24, 24, 128, 0.01, 0.1, point(150.02, 2.0))
    settled = Evidence(150.02, 300, 1e-6, 0.5, 1, None, 3, motion)
    monkeypatch.setattr(Solutions, "evidence", lambda *arguments, **options: settled)
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    curve._lends = curve._takes_settled = True
    assert curve.follow(point(100.0)).complete
    assert hertz_of(curve)[3:] == pytest.approx([150.0, 150.1, 200.0])


def test_the_same_motion_with_more_harmonics_is_the_same_piece(monkeypatch: pytest.MonkeyPatch) -> None:
    more = point(150.02)
    more.measured = np.array([1.0, 0.0, 0.0])
    settled = Evidence(150.02, 300, 1e-6, 0.5, 1, None, 3, SettledMotion(24, 24, 128, 0.01, 0.1, more))
    monkeypatch.setattr(Solutions, "evidence", lambda *arguments, **options: settled)
    curve = pieces(150.05, 200.0, 1.0, 0.0)
    curve._lends = curve._takes_settled = True
    monkeypatch.setattr(curve, "_beyond", lambda *arguments: None)
    known = curve._part

    def part(start: Any, stop: float) -> Any:
        followed = cast(Any, known(start, stop))
        if start is more:
            followed.points[0].point = more
        return followed

    curve._part = part
    assert curve.follow(point(100.0)).complete
    assert curve.breaks == []
    (crossing,) = curve.crossings
    assert crossing.motion == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("beyond", "expected"), [(True, [False]), (False, [False, True])])
def test_a_curve_asks_thoroughly_only_where_its_own_harmonics_go_on_nowhere(
    beyond: bool, expected: list[bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[bool] = []

    def evidence(settling: Any, point: Any, change: float, thorough: bool = False) -> Evidence:
        asked.append(thorough)
        return Evidence(150.02, 300, 1e-6, 0.5, None)

    monkeypatch.setattr(Solutions, "evidence", evidence)
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    curve._lends = curve._takes_settled = True
    if not beyond:
        monkeypatch.setattr(curve, "_beyond", lambda *arguments: None)
    assert curve.follow(point(100.0)).complete == beyond
    assert asked == expected


def test_with_an_accuracy_a_curve_begins_from_the_motion_to_which_it_settles_from_rest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """But not from one that these harmonics do not give."""
    settled = Evidence(100.0, 300, 1e-6, None, 1, None, 3, SettledMotion(24, 24, 128, 0.01, 0.1, point(100.0, 2.0)))
    monkeypatch.setattr(Solutions, "evidence_from_rest", lambda *arguments, **options: settled)
    curve = pieces(105.0, 200.0, 2.0, 102.0)
    with rejects(ConvergenceError):
        curve.follow(None, "there is none.")
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    curve._varies = curve._takes_settled = True
    assert curve.follow(None, "there is none.").complete
    assert hertz_of(curve) == pytest.approx([100.0, 125.0, 150.0, 150.0, 150.1, 200.0])
    printed_sentence(curve.warnings[0], settled.words(varies=True))


def test_a_curve_without_a_first_point_begins_where_there_is_a_solution() -> None:
    curve = pieces(105.0, 200.0, 2.0, 102.0).follow(None, "there is none.")
    assert not curve.complete  # 2 % are missing
    assert hertz_of(curve) == pytest.approx([102.0, 106.0, 200.0])
    (warning,) = curve.warnings
    printed_sentence(warning)
    assert curve.breaks == []
    with rejects(ConvergenceError):
        pieces(300.0, 400.0, 2.0, 0.0).follow(None, "there is none.")


@pytest.mark.slow
def test_steps_that_are_too_long_lose_the_branch_and_it_goes_on_with_the_right_solution(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Pieces are kept apart here even where they meet."""
    monkeypatch.setattr(pieces_module, "SAME_MOTION", 0.0)
    long_steps = ss.ContinuationSettings(first_step=0.05, smallest_step=0.04, largest_angle_deg=20.0)
    fine, coarse = resonance(ss.ContinuationSettings()), resonance(long_steps)
    assert coarse.converged
    assert coarse.part.max() >= 1
    assert (np.diff(coarse.part) >= 0).all()
    wanted = np.interp(coarse.frequency_hz, fine.frequency_hz, fine.amplitude(ROW))
    assert coarse.amplitude(ROW) == pytest.approx(wanted, rel=0.06)
    assert sum("The curve is interrupted" in warning for warning in coarse.warnings) == coarse.part.max()
    assert coarse.stable is not None
    assert coarse.stable.all()


def loses_once(beyond: float, events: list[str]) -> type[Branch[Any]]:
    """A class of branches of which the first is lost beyond a parameter."""

    class LostOnce(Branch[Any]):
        def _advance_to_landmark(self, point: Any, *others: Any) -> Any:
            if not events and point.trial.omega > beyond:
                events.append("lost")
                self.message = "No step."
                return None
            return super()._advance_to_landmark(point, *others)

        def _around_corner(self, point: Any, tangent: Any) -> Any:
            return None if events == ["lost"] else super()._around_corner(point, tangent)

        def _beyond(self) -> Any:
            if events == ["lost"]:
                events.append("goes on elsewhere")
                return None
            return super()._beyond()

    return LostOnce


@pytest.mark.slow
def test_pieces_with_an_accuracy(monkeypatch: pytest.MonkeyPatch) -> None:
    """The harmonics of the points follow in each of them."""
    whole = resonance(ss.ContinuationSettings(), harmonics=None, accuracy=0.02)
    monkeypatch.setattr(pieces_module, "SAME_MOTION", 0.0)
    events: list[str] = []
    monkeypatch.setattr(varying_harmonics, "Branch", loses_once(2.0 * np.pi * 355.6, events))
    parted = resonance(ss.ContinuationSettings(), harmonics=None, accuracy=0.02)
    assert events == ["lost", "goes on elsewhere"]
    assert parted.converged
    assert parted.part.max() == 1
    wanted = np.interp(parted.frequency_hz, whole.frequency_hz, whole.amplitude(ROW))
    assert parted.amplitude(ROW) == pytest.approx(wanted, rel=0.05)  # linear between points
    assert parted.point_harmonics is not None
    assert parted.point_harmonics.max() > 1
    assert parted.estimated_error is not None
    assert parted.estimated_error.max() <= 0.02


def parted_resonance(monkeypatch: pytest.MonkeyPatch, **options: Any) -> ss.ForcedResponse:
    """A resonance that is lost once, where it has more than one harmonic."""
    events: list[str] = []
    for module in (forced, varying_harmonics):
        monkeypatch.setattr(module, "LEAST_HARMONICS", 1)
    monkeypatch.setattr(varying_harmonics, "Branch", loses_once(2.0 * np.pi * 355.6, events))
    response = resonance(ss.ContinuationSettings(), harmonics=None, accuracy=5e-4, **options)
    assert events == ["lost", "goes on elsewhere"]
    assert response.converged
    assert response.point_harmonics is not None
    assert response.point_harmonics.max() > 1
    return response


@pytest.mark.slow
def test_pieces_with_more_harmonics_that_are_the_same_motion_are_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """The points before have more harmonics than the one beyond, from which they go on."""
    parted = parted_resonance(monkeypatch, newtons=40.0)
    assert parted.part.max() == 0


@pytest.mark.slow
def test_a_lost_curve_with_an_accuracy_goes_on_with_the_harmonics_of_the_settled_motion(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pieces_module, "SAME_MOTION", 0.0)
    monkeypatch.setattr(settled_module, "MORE_HARMONICS", (3,))
    parted = parted_resonance(monkeypatch, newtons=400.0, modal_damping_ratio=0.02)
    assert parted.part.max() == 1
    printed_sentence("\n".join(parted.warnings), "with 3 harmonics", numbers=False)
    monkeypatch.undo()
    whole = resonance(ss.ContinuationSettings(), 400.0, accuracy=5e-4, harmonics=None, modal_damping_ratio=0.02)
    wanted = np.interp(parted.frequency_hz, whole.frequency_hz, whole.amplitude(ROW))
    assert parted.amplitude(ROW) == pytest.approx(wanted, rel=0.01)  # linear between points


@pytest.mark.slow
@pytest.mark.parametrize(("confirms", "returns"), [(0.05, True), (0.0, False)])
def test_a_lost_curve_with_fixed_harmonics_has_more_until_its_own_confirm_the_motion(
    confirms: float, returns: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pieces_module, "SAME_MOTION", 0.0)
    monkeypatch.setattr(settled_module, "MORE_HARMONICS", (3,))
    monkeypatch.setattr(lent_harmonics, "SAME", confirms)
    # The harmonics of the curve go on nowhere.
    monkeypatch.setattr(pieces_module.Pieces, "_beyond", lambda *arguments: None)
    events: list[str] = []
    monkeypatch.setattr(lent_harmonics, "Branch", loses_once(2.0 * np.pi * 355.6, events))
    force = {"newtons": 400.0, "modal_damping_ratio": 0.02}
    parted = resonance(ss.ContinuationSettings(), **force)
    monkeypatch.undo()
    assert events == ["lost", "goes on elsewhere"]
    assert parted.converged
    assert parted.harmonics == 3
    assert parted.estimated_error is None
    numbers = parted.point_harmonics
    assert numbers is not None
    lost = int(np.flatnonzero(parted.part == 0)[-1])
    assert set(numbers[: lost + 1]) == {1}
    assert set(numbers[lost + 1 :]) == ({1, 3} if returns else {3})
    assert numbers[-1] == (1 if returns else 3)
    alone = resonance(ss.ContinuationSettings(), **force)
    more = resonance(ss.ContinuationSettings(), **force | {"harmonics": 3})
    assert alone.point_harmonics is None
    for number, whole in ((1, alone), (3, more)):
        those = numbers == number
        wanted = np.interp(parted.frequency_hz[those], whole.frequency_hz, whole.amplitude(ROW))
        assert parted.amplitude(ROW)[those] == pytest.approx(wanted, rel=0.01)  # linear between points
    there = parted.frequency_hz[numbers == 3]
    (sentence,) = [each for each in parted.warnings if "harmonics instead of 1" in each]
    assert f"From {there.min():.3f} to {there.max():.3f} Hz {there.size} of {numbers.size} points have 3" in sentence


@pytest.mark.slow
def test_a_curve_ends_at_the_limit_of_its_work_with_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forced, "WORK_PER_POINT", 0.02)
    with pytest.warns(ss.NotConvergedWarning):
        response = resonance(ss.ContinuationSettings())
    assert not response.converged
    printed_sentence(response.message, "40 iterations", numbers=False)
    assert int(response.provenance["solve_work"].split()[0]) >= 40
    monkeypatch.undo()
    assert resonance(ss.ContinuationSettings()).converged
