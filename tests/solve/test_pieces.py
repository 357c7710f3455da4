"""A curve whose branch is lost begins again beyond, and a time integration tells what happens there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

import stickslip as ss
from lost_curves import SETTLES, Solutions, hertz_of, loses_once, pieces, point, resonance
from sentences import printed_sentence, rejects
from stickslip.core.errors import ConvergenceError
from stickslip.solve import forced
from stickslip.solve import pieces as pieces_module
from stickslip.solve import settled_motion as settled_module
from stickslip.solve.evidence import Evidence
from stickslip.solve.harmonic import varying_harmonics
from stickslip.solve.settled_motion import NOT_SOUGHT, SettledMotion

ROW = np.array([1.0, 0.0, 0.0])


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


def test_a_curve_that_goes_on_beyond_a_branch_out_of_points_is_not_complete() -> None:
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    part = curve._part

    def out_of_points(start: Any, stop: float) -> Any:
        answer = cast(Any, part(start, stop))
        answer.ran_out = answer.lost
        return answer

    curve._part = out_of_points
    assert not curve.follow(point(100.0)).complete
    assert hertz_of(curve)[-1] == pytest.approx(200.0)
    printed_sentence(curve.message)


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
    curve._varies = varies
    assert curve.follow(point(100.0)).complete
    assert hertz_of(curve)[3:] == pytest.approx([150.0, begins, 200.0])
    (warning,) = curve.warnings
    printed_sentence(warning, settled.words(varies))


def test_with_an_accuracy_a_curve_begins_from_the_motion_to_which_it_settles_from_rest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """So does one with a fixed number, if more harmonics give the motion; not if its own number does or none."""
    motion = SettledMotion(24, 24, 128, 0.01, 0.1, point(100.0, 2.0))
    settled = Evidence(100.0, 300, 1e-6, None, 1, None, 3, motion)
    monkeypatch.setattr(Solutions, "evidence_from_rest", lambda *arguments, **options: settled)
    for varies in (True, False):
        curve = pieces(150.05, 200.0, 2.0, 0.0)
        curve._varies = varies
        assert curve.follow(None, "there is none.").complete
        assert hertz_of(curve) == pytest.approx([100.0, 125.0, 150.0, 150.0, 150.1, 200.0])
        printed_sentence(curve.warnings[0], settled.words(varies=True))
    for own in (replace(motion, given_by=3), NOT_SOUGHT):
        answer = replace(settled, settled=own)
        monkeypatch.setattr(Solutions, "evidence_from_rest", lambda *arguments, answer=answer, **options: answer)
        with rejects(ConvergenceError):
            pieces(105.0, 200.0, 2.0, 102.0).follow(None, "there is none.")


def test_a_curve_without_a_first_point_begins_where_there_is_a_solution() -> None:
    curve = pieces(105.0, 200.0, 2.0, 102.0).follow(None, "there is none.")
    assert not curve.complete  # 2 % are missing
    assert hertz_of(curve) == pytest.approx([102.0, 106.0, 200.0])
    (warning,) = curve.warnings
    printed_sentence(warning)
    assert curve.breaks == []
    with rejects(ConvergenceError):
        pieces(300.0, 400.0, 2.0, 0.0).follow(None, "there is none.")


@pytest.mark.long
def test_steps_that_are_too_long_lose_the_branch_and_it_goes_on_with_the_right_solution(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Pieces are kept apart here even where they meet."""
    monkeypatch.setattr(pieces_module, "SAME_MOTION", 0.0)
    long_steps = ss.ContinuationSettings(first_step=0.06, smallest_step=0.05, largest_angle_deg=20.0)
    fine, coarse = resonance(ss.ContinuationSettings()), resonance(long_steps)
    assert coarse.converged
    assert coarse.part.max() >= 1
    assert (np.diff(coarse.part) >= 0).all()
    wanted = np.interp(coarse.frequency_hz, fine.frequency_hz, fine.amplitude(ROW))
    assert coarse.amplitude(ROW) == pytest.approx(wanted, rel=0.06)
    assert sum("The curve is interrupted" in warning for warning in coarse.warnings) == coarse.part.max()
    assert coarse.stable is not None
    assert coarse.stable.all()


@pytest.mark.long
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


@pytest.mark.long
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


@pytest.mark.long
def test_a_curve_ends_at_the_limit_of_its_work_with_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forced, "WORK_PER_POINT", 0.02)
    with pytest.warns(ss.NotConvergedWarning):
        response = resonance(ss.ContinuationSettings())
    assert not response.converged
    printed_sentence(response.message, "40 iterations", numbers=False)
    assert int(response.provenance["solve_work"].split()[0]) >= 40
    monkeypatch.undo()
    assert resonance(ss.ContinuationSettings()).converged
