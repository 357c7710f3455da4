"""A curve with a fixed number of harmonics goes on with more where its own have no motion, and returns to them."""

from __future__ import annotations

from functools import partial
from typing import Any, cast

import numpy as np
import pytest

import stickslip as ss
from lost_curves import Solutions, hertz_of, loses_once, pieces, point, resonance
from sentences import printed_sentence
from stickslip.solve import forced, lent_harmonics
from stickslip.solve import pieces as pieces_module
from stickslip.solve import settled_motion as settled_module
from stickslip.solve.evidence import Evidence
from stickslip.solve.gradients.peak_gradients import peak_gradients
from stickslip.solve.harmonic import checks
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.other_solutions import search_other_solutions
from stickslip.solve.path.newton import NewtonSettings
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


@pytest.mark.parametrize(("settles_at", "goes_on"), [(149.9, True), (148.0, False)])
def test_a_curve_goes_on_from_a_settled_motion_shortly_before_its_end(
    settles_at: float, goes_on: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A branch may turn back a little before it is lost, and time is integrated from its last point."""
    motion = SettledMotion(24, 24, 128, 0.01, 0.1, point(settles_at, 2.0))
    settled = Evidence(settles_at, 300, 1e-6, 0.5, 1, None, 3, motion)
    monkeypatch.setattr(Solutions, "evidence", lambda *arguments, **options: settled)
    curve = pieces(150.05, 200.0, 2.0, 0.0)
    monkeypatch.setattr(curve, "_beyond", lambda *arguments: None)
    assert curve.follow(point(100.0)).complete == goes_on
    assert hertz_of(curve) == pytest.approx([100.0, 125.0, 150.0] + [settles_at, 200.0] * goes_on)
    if goes_on:
        assert curve.breaks == [2]
        assert "jumps there to another motion" in curve.warnings[0]


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


# The resonance of these tests, and the frequency in Hz beyond which the harmonics of the curve go on nowhere.
FORCE: dict[str, Any] = {"newtons": 400.0, "modal_damping_ratio": 0.02}
LOST = 355.6


def lost_at(hertz: float, confirms: float, **options: Any) -> ss.ForcedResponse:
    """The resonance with 1 harmonic, lost at a frequency where more harmonics go on."""
    events: list[str] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pieces_module, "SAME_MOTION", 0.0)
        patch.setattr(settled_module, "MORE_HARMONICS", (3,))
        patch.setattr(lent_harmonics, "SAME", confirms)
        patch.setattr(pieces_module.Pieces, "_beyond", lambda *arguments: None)
        patch.setattr(lent_harmonics, "Branch", loses_once(2.0 * np.pi * hertz, events))
        parted = resonance(ss.ContinuationSettings(), **FORCE, **options)
    assert events == ["lost", "goes on elsewhere"]
    assert parted.converged
    assert parted.harmonics == 3
    return parted


@pytest.mark.long
@pytest.mark.parametrize(("hertz", "harmonics"), [(LOST, 1), (343.0, 3)])
def test_the_peak_of_a_curve_of_few_digits_has_more_also_with_lent_harmonics(
    hertz: float, harmonics: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    few = partial(forced.unreported_response, few_digits=NewtonSettings(1e-3))
    exact = lost_at(hertz, 0.0)
    monkeypatch.setattr(forced, "unreported_response", few)
    rough = lost_at(hertz, 0.0)
    peak = int(rough.amplitude(ROW).argmax())
    assert rough.point_harmonics is not None
    assert rough.point_harmonics[peak] == harmonics
    assert rough.residual[peak] < 1e-7
    assert rough.residual.max() > 1e-5
    assert rough.amplitude(ROW)[peak] == pytest.approx(exact.amplitude(ROW).max(), rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize(("confirms", "returns"), [(0.05, True), (0.0, False)])
def test_a_lost_curve_with_fixed_harmonics_has_more_until_its_own_confirm_the_motion(
    confirms: float, returns: bool
) -> None:
    parted = lost_at(LOST, confirms)
    assert parted.estimated_error is None
    assert (parted.settings["harmonics"], parted.settings["samples"]) == (1, 64)
    numbers = parted.point_harmonics
    assert numbers is not None
    lost = int(np.flatnonzero(parted.part == 0)[-1])
    assert set(numbers[: lost + 1]) == {1}
    assert set(numbers[lost + 1 :]) == ({1, 3} if returns else {3})
    assert numbers[-1] == (1 if returns else 3)
    alone = resonance(ss.ContinuationSettings(), **FORCE)
    more = resonance(ss.ContinuationSettings(), **FORCE, harmonics=3)
    assert alone.point_harmonics is None
    for number, whole in ((1, alone), (3, more)):
        those = numbers == number
        wanted = np.interp(parted.frequency_hz[those], whole.frequency_hz, whole.amplitude(ROW))
        assert parted.amplitude(ROW)[those] == pytest.approx(wanted, rel=0.01)  # linear between points
    there = parted.frequency_hz[numbers == 3]
    (sentence,) = [each for each in parted.warnings if "harmonics instead of 1" in each]
    assert f"From {there.min():.3f} to {there.max():.3f} Hz {there.size} of {numbers.size} points have 3" in sentence


STRUCTURE = ss.Superelement(np.eye(3), 4e6 * np.eye(3))
JOINT = ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3, 2000.0)
PULL = np.array([FORCE["newtons"], 0.0, 0.0])
DAMPING = {"modal_damping_ratio": FORCE["modal_damping_ratio"]}


@pytest.mark.slow
@pytest.mark.parametrize(("hertz", "harmonics"), [(345.0, 3), (362.0, 1)])
def test_gradients_have_the_harmonics_of_the_peak(hertz: float, harmonics: int) -> None:
    parted = lost_at(hertz, confirms=0.0)
    top = int(parted.amplitude(ROW).argmax())
    assert parted.resolution_at(range(top - 1, top + 2)).harmonics == harmonics
    whole = resonance(ss.ContinuationSettings(), **FORCE, harmonics=harmonics)
    values, expected = (peak_gradients(STRUCTURE, JOINT, PULL, each, ROW, **DAMPING) for each in (parted, whole))
    assert values.amplitude == pytest.approx(expected.amplitude, rel=1e-6)  # 1 and 3 harmonics differ by 1.4e-4
    np.testing.assert_allclose(values.by_amplitude, expected.by_amplitude, rtol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("hertz", "harmonics"), [(345.0, 3), (362.0, 1)])
def test_a_band_of_tractions_has_the_harmonics_of_the_peak(hertz: float, harmonics: int) -> None:
    options: dict[str, Any] = {"traction_band": ROW, "traction_starts": 0}
    band = lost_at(hertz, confirms=0.0, **options).traction_band
    expected = resonance(ss.ContinuationSettings(), **FORCE, harmonics=harmonics, **options).traction_band
    assert band is not None
    assert expected is not None
    assert band.displacement.shape[2] == 7
    assert bool(band.displacement[:, :, 3:].any()) == (harmonics == 3)
    amplitudes = [[each.amplitude.max() for each in those.curves(ROW)] for those in (band, expected)]
    np.testing.assert_allclose(amplitudes[0], amplitudes[1], rtol=1e-3)


@pytest.mark.slow
def test_a_search_for_other_solutions_has_the_harmonics_of_the_curve_and_says_where_it_has_more() -> None:
    parted = lost_at(LOST, confirms=0.0)
    searched = search_other_solutions(STRUCTURE, JOINT, PULL, parted, starts=1, **DAMPING)
    assert searched.other_solutions is not None
    assert searched.other_solutions.displacement.shape[2] == 3
    (sentence,) = searched.warnings[len(parted.warnings) :]
    there = parted.frequency_hz[parted.point_harmonics == 3]
    assert f"has harmonics up to 1. From {there.min():.3f} to {there.max():.3f} Hz the curve has more" in sentence
    printed_sentence(sentence, numbers=False)


@pytest.mark.slow
def test_points_are_checked_with_twice_their_own_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of the curve keep its samples though a part with more harmonics has more."""
    checked: set[tuple[int, int]] = set()

    def residual(fine: Balance, trial: Trial) -> float:
        checked.add((len(trial.relative) // 2, fine.samples))
        return 0.1 if len(trial.relative) == 3 else 0.0

    monkeypatch.setattr(checks, "sample_residual", residual)
    monkeypatch.setattr(lent_harmonics, "enough_samples", lambda harmonics, samples: 8 * samples)
    parted = lost_at(362.0, confirms=0.0)
    assert checked == {(1, 128), (3, 1024)}
    assert (parted.samples, parted.settings["samples"]) == (512, 64)
    assert "with 128 instead of 64 samples" in " ".join(parted.warnings)
