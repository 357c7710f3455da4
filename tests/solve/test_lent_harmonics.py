"""A curve with a fixed number of harmonics goes on with more where its own have no motion, and returns to them."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest

import stickslip as ss
from lost_curves import Solutions, hertz_of, loses_once, pieces, point, resonance
from stickslip.solve import lent_harmonics
from stickslip.solve import pieces as pieces_module
from stickslip.solve import settled_motion as settled_module
from stickslip.solve.evidence import Evidence
from stickslip.solve.settled_motion import SettledMotion

ROW = np.array([1.0, 0.0, 0.0])


@pytest.mark.parametrize(("given_by", "begins"), [(24, 150.02), (3, 150.1)])
def test_a_curve_goes_on_with_the_harmonics_of_the_settled_motion_if_its_own_do_not_give_it(
    given_by: int, begins: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = SettledMotion(24, given_by, 128, 0.01, 0.1, point(150.02, 2.0))
    settled = Evidence(150.02, 300, 1e-6, 0.5, 1, None, 3, motion)
    monkeypatch.setattr(Solutions, "evidence", lambda *arguments, **options: settled)
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    if given_by == 24:
        monkeypatch.setattr(curve, "_beyond", lambda *arguments: None)  # its own harmonics go on nowhere
    assert curve.follow(point(100.0)).complete
    assert hertz_of(curve)[3:] == pytest.approx([150.0, begins, 200.0])
    (warning,) = curve.warnings
    assert "run again" not in warning
    limited = pieces(150.05, 200.0, 2.0, 0.0)
    limited._settling.work.iterate(200)
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
    assert curve.follow(point(100.0)).complete
    assert hertz_of(curve)[3:] == pytest.approx([150.0, 150.1, 200.0])


def test_the_same_motion_with_more_harmonics_is_the_same_piece(monkeypatch: pytest.MonkeyPatch) -> None:
    more = point(150.02)
    more.measured = np.array([1.0, 0.0, 0.0])
    settled = Evidence(150.02, 300, 1e-6, 0.5, 1, None, 3, SettledMotion(24, 24, 128, 0.01, 0.1, more))
    monkeypatch.setattr(Solutions, "evidence", lambda *arguments, **options: settled)
    curve = pieces(150.05, 200.0, 1.0, 0.0)
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
    if not beyond:
        monkeypatch.setattr(curve, "_beyond", lambda *arguments: None)
    assert curve.follow(point(100.0)).complete == beyond
    assert asked == expected


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
