"""Rigid-body shares of known motions, and the file of a curve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from damage import damaged
from paper_curves import curve
from sentences import rejects
from stickslip.core.errors import ResultsFileError
from stickslip.core.plain_data import same_content
from stickslip.papers.rough_damper import records
from stickslip.papers.rough_damper.records import Solved, phase_states, rigid_fractions

POINTS = np.random.default_rng(3).normal(size=(20, 3)) * 1e-2


def test_pure_motions() -> None:
    shift = np.tile([1.0 + 1.0j, 2.0, 0.0], (20, 1))
    turn = np.cross([0.3, -0.2j, 0.5], POINTS - POINTS.mean(axis=0))
    stretch = np.zeros((20, 3), dtype=complex)
    stretch[:, 0] = (POINTS - POINTS.mean(axis=0))[:, 0]
    assert rigid_fractions(POINTS, shift) == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
    assert rigid_fractions(POINTS, turn) == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert rigid_fractions(POINTS, stretch)[2] > 0.5
    both = rigid_fractions(POINTS, shift + turn)
    assert both.sum() == pytest.approx(1.0)
    assert both[1] == pytest.approx(np.sum(np.abs(turn) ** 2) / np.sum(np.abs(shift + turn) ** 2))
    assert rigid_fractions(POINTS, np.zeros((20, 3))).tolist() == [0.0, 0.0, 0.0]


def test_file_is_read_back_whole() -> None:
    one = curve({"dimension": 2.45}, peak_hz=451.0)
    assert same_content(Solved.from_bytes(one.to_bytes("key"), "key"), one)


def test_readings_of_sweeps_are_read_back_and_stand_for_the_curve_where_they_differ() -> None:
    up = curve({"dimension": 2.45}, peak_hz=449.0, peak_m=8e-6)
    one = replace(curve({"dimension": 2.45}), swept={"up": up})
    again = Solved.from_bytes(one.to_bytes("key"), "key")
    assert same_content(again, one)
    (whole, upward, downward) = (again.seen_by(reading) for reading in ("curve", "up", "down"))
    assert whole is again
    assert downward is again
    assert upward is not None
    assert upward.numbers["peak_m"] == 8e-6
    unstable = Solved.from_bytes(replace(one, swept={"down": None}).to_bytes("key"), "key")
    assert unstable.seen_by("down") is None


def test_a_pair_that_touches_down_and_sticks_does_not_slip() -> None:
    """mu N is 0.5 N. The pair is open at samples 2 to 4, touches down at 5 and sticks; it slips at 1 only."""
    normal = np.array([1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
    friction = np.array([0.3, 0.5, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3])
    force = np.stack([friction, np.zeros(8), normal], axis=1)[:, None]
    motion = np.zeros((8, 1, 3))
    motion[:, 0, 0] = 1e-6 * np.array([0.3, 0.7, 0.9, 0.5, 0.1, -0.1, 0.0, 0.2])
    slider = 1e-6 * np.array([0.0, 0.2, 0.9, 0.5, 0.1, -0.2, -0.2, -0.2])
    slider = np.stack([slider, np.zeros(8)], axis=1)[:, None]
    # from the last sample to the first the slider moves too, below the limit of friction
    assert phase_states(motion, force, slider, np.array([0.5]))[:, 0].tolist() == [0, 1, 2, 2, 2, 0, 0, 0]


@pytest.mark.slow
def test_any_damage_is_noticed() -> None:
    for _, content in damaged(curve().to_bytes("key"), 600):
        with rejects(ResultsFileError):
            Solved.from_bytes(content, "key")


def test_file_of_other_inputs_is_rejected() -> None:
    with rejects(ResultsFileError):
        Solved.from_bytes(curve().to_bytes("key"), "another")


def test_file_of_other_code_of_records_is_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    content = curve().to_bytes("key")
    monkeypatch.setattr(records, "_code", lambda: "changed")
    with rejects(ResultsFileError):
        Solved.from_bytes(content, "key")


def test_peaks_leave_out_small_ones_and_ends() -> None:
    one = curve(peaks=((450.0, 1e-5), (480.0, 2e-6), (510.0, 1e-7)))
    assert [frequency for frequency, _ in one.peaks()] == pytest.approx([450.0, 480.0], abs=0.1)
