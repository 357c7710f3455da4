"""Lines of progress for files and pipes: none is missing during a long step, and a long log does not flood."""

from __future__ import annotations

import io
import threading

import pytest
from rich.console import Console

from stickslip.core import progress
from stickslip.core.progress import LineProgress, SilentProgress, terminal_progress


class Log:
    """Lines printed so far, and a clock that stands until it is set."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._stream = io.StringIO()
        self.progress = LineProgress(Console(file=self._stream), lambda: self.seconds)

    @property
    def lines(self) -> list[str]:
        return self._stream.getvalue().splitlines()


def test_reports_within_half_a_minute_are_one_line() -> None:
    log = Log()
    for second in range(100):
        log.seconds = float(second)
        log.progress.update("Response", 0.001 * second, f"point {second}")
    assert log.lines == [
        "Response: point 0 ...",
        "Response: point 30 (3 % done, 30 s)",
        "Response: point 60 (6 % done, 60 s)",
        "Response: point 90 (9 % done, 90 s)",
    ]


def test_a_step_without_reports_is_reported_again() -> None:
    log = Log()
    log.progress.update("Response", 0.0, "modes")
    for second in range(1, 65):
        log.seconds = float(second)
        log.progress.remind()
    assert log.lines[1:] == ["Response: modes (0 % done, 30 s)", "Response: modes (0 % done, 60 s)"]


def test_nothing_is_reported_between_the_stages_and_each_has_its_own_time() -> None:
    log = Log()
    log.progress.update("Structure", 0.5)
    log.seconds = 10.0
    log.progress.update("Structure", 1.0, "99 unknowns")
    log.seconds = 500.0
    log.progress.remind()
    log.progress.update("Response", 0.2, "484 Hz")
    log.progress.remind()
    assert log.lines == ["Structure ...", "Structure: 99 unknowns", "Response ..."]
    log.seconds = 531.0
    log.progress.remind()
    assert log.lines[3:] == ["Response: 484 Hz (20 % done, 31 s)"]


def test_a_stage_that_is_done_again_is_reported() -> None:
    log = Log()
    log.progress.update("Response", 1.0, "9 points")
    log.seconds = 100.0
    log.progress.update("Response", 0.1, "500 Hz")
    log.seconds = 130.0
    log.progress.remind()
    assert log.lines[-1] == "Response: 500 Hz (10 % done, 30 s)"


def test_a_day_does_not_flood_the_log() -> None:
    log = Log()
    for second in range(0, 86_400, 5):
        log.seconds = float(second)
        log.progress.update("Cases", second / 86_400, "3 of 24")
    assert 150 < len(log.lines) < 300
    assert log.lines[-1].endswith(" min)")


def test_reminders_come_while_the_computation_is_silent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "REMINDER_SECONDS", 0.0)
    before = threading.active_count()
    printed = threading.Event()

    class Reported(LineProgress):
        def remind(self) -> None:
            if threading.current_thread() is not threading.main_thread():
                super().remind()
                printed.set()

    stream = io.StringIO()
    lines = Reported(Console(file=stream))
    with lines.reminding(every_seconds=0.001):
        lines.update("Response", 0.25, "modes")
        printed.clear()
        assert printed.wait(timeout=10.0)
    assert "Response: modes (25 % done, 0 s)" in stream.getvalue()
    assert threading.active_count() == before


@pytest.mark.parametrize("quiet", [True, False])
def test_progress_goes_to_stderr(quiet: bool, capsys: pytest.CaptureFixture[str]) -> None:
    with terminal_progress(quiet) as shown:
        shown.update("Curve", 0.0)
        shown.update("Curve", 0.5, "484 Hz [bold]")
        shown.update("Curve", 1.0)
        shown.update("Curve", 1.0)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == ("" if quiet else "Curve ...\nCurve: done\n")


def test_progress_on_a_terminal_shows_the_time_left(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "120")
    with terminal_progress() as shown:
        shown.update("Curve", 0.25, "484 Hz [bold]")
    text = capsys.readouterr().err
    assert "Curve" in text
    assert "left" in text
    assert "484 Hz [bold]" in text


def test_silent_progress_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    SilentProgress().update("Curve", 0.5, "484 Hz")
    assert capsys.readouterr() == ("", "")
