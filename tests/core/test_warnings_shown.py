"""Warnings of stickslip on the command line and in worker processes: one sentence each."""

from __future__ import annotations

import warnings

import pytest

from stickslip.core.errors import StickslipWarning, show_warnings_as_lines


def test_a_warning_of_stickslip_is_one_line_and_others_stay_as_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    others: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = lambda message, *place: others.append(str(message))
        show_warnings_as_lines()
        warnings.warn("The kept file is damaged.", StickslipWarning, stacklevel=1)
        warnings.warn("overflow", RuntimeWarning, stacklevel=1)
    assert capsys.readouterr().err == "Warning: The kept file is damaged.\n"
    assert others == ["overflow"]
