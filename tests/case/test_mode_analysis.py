"""[analysis] kind = "mode": its keys, and what they reject."""

from __future__ import annotations

from typing import Any

import pytest

from sentences import rejects
from stickslip.case.analysis import ForcedAnalysis, ModeAnalysis
from stickslip.case.case import Case
from stickslip.core.errors import StudyFileError


def test_the_keys_of_a_mode() -> None:
    analysis = Case.from_mapping({"analysis": {"kind": "mode", "mode": 3, "largest_amplitude": "20 um"}}).analysis
    assert isinstance(analysis, ModeAnalysis)
    assert (analysis.mode, analysis.smallest_amplitude) == (3, 1e-8)
    assert analysis.largest_amplitude == pytest.approx(2e-5)
    assert isinstance(Case().analysis, ForcedAnalysis)


def test_a_study_of_a_mode_is_written_and_read() -> None:
    case = Case.from_mapping({"analysis": {"kind": "mode", "mode": 2}})
    assert Case.from_text(case.to_text()) == case
    assert '\nkind = "mode"' in case.to_text()
    assert "\nmode = 2" in case.to_text()


@pytest.mark.parametrize(
    ("keys", "wrong"),
    [
        ({"mode": 0}, "mode"),
        ({"mode": 1.5}, "mode"),
        ({"smallest_amplitude": "0 um"}, "smallest_amplitude"),
        ({"smallest_amplitude": "1 N"}, "smallest_amplitude"),
        ({"smallest_amplitude": "10 um", "largest_amplitude": "10 um"}, "largest_amplitude"),
        ({"smallest_amplitude": "1 mm"}, "largest_amplitude"),
        ({"amplitude": "1 um"}, "amplitude"),
        ({"mode_method": "static"}, "mode_method"),
        ({"mode_method": "quasi-static", "limit": "sliding"}, "mode_method"),
    ],
)
def test_what_is_no_mode_is_rejected(keys: dict[str, Any], wrong: str) -> None:
    with rejects(StudyFileError, f"analysis.{wrong}"):
        Case.from_mapping({"analysis": {"kind": "mode"} | keys})


def test_a_forced_analysis_has_no_mode() -> None:
    with rejects(StudyFileError, "analysis.mode"):
        Case.from_mapping({"analysis": {"mode": 2}})
