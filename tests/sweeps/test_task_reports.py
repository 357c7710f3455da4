"""A sweep shows what a long case does: its name, frequency and points, and not only "0 of 10"."""

from __future__ import annotations

import re
import time
from pathlib import Path

import pytest

import stickslip as ss
from stickslip.sweeps import task_reports
from stickslip.sweeps.pool import InProcess, LocalProcesses
from stickslip.sweeps.task_reports import REPORT_SECONDS, TaskProgress, reports_to
from sweep_cases import quick_case
from sweep_deaths import report_until


def test_a_task_reports_its_name_and_work_at_most_once_in_a_second() -> None:
    now, heard = [0.0], list[str]()
    with reports_to(heard.append):
        progress = TaskProgress("amplitude=30 N", clock=lambda: now[0])
        for tenth in range(25):
            now[0] = 0.1 * tenth * REPORT_SECONDS
            progress.update("Response", 0.01 * tenth, f"{400 + tenth}.00 Hz, point {tenth}")
    assert heard == [
        "amplitude=30 N: 10 %, 410.00 Hz, point 10",
        "amplitude=30 N: 20 %, 420.00 Hz, point 20",
    ]


def test_a_task_that_nobody_watches_reports_to_no_one() -> None:
    now = [0.0]
    progress = TaskProgress("case", clock=lambda: now[0])
    now[0] = 2.0 * REPORT_SECONDS
    progress.update("Response", 0.5)


def test_a_task_in_this_process_reports_at_once(tmp_path: Path) -> None:
    executor, heard = InProcess(), list[str]()
    executor.listen(heard.append)
    (tmp_path / "end").touch()
    assert executor.submit(report_until, "working", str(tmp_path / "end")).result() == "answer"
    assert heard == ["working"]


@pytest.mark.slow
def test_the_report_of_another_process_arrives_before_its_answer_and_ends_with_it(tmp_path: Path) -> None:
    pool, end = LocalProcesses(1), tmp_path / "end"
    try:
        future = pool.submit(report_until, "working", str(end))
        limit = time.monotonic() + 60.0
        while not pool.last_report() and time.monotonic() < limit:
            time.sleep(0.02)
        assert pool.last_report() == "working"
        assert not future.done()
        end.touch()
        assert future.result(60.0) == "answer"
        assert pool.last_report() == ""
    finally:
        pool.shutdown()


@pytest.mark.long
@pytest.mark.parametrize("workers", [1, 2])
def test_a_sweep_shows_the_points_of_a_long_curve(workers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    details: list[str] = []

    class Listener:
        def update(self, stage: str, fraction: float, detail: str = "") -> None:
            if stage == "Cases":
                details.append(detail)

    if workers == 1:  # these curves take less than a second
        monkeypatch.setattr(task_reports, "REPORT_SECONDS", 0.0)
        case = quick_case()
    else:
        case = quick_case().replace({"solver.first_step": 5e-4, "solver.largest_step": 5e-4})
    ss.sweep(case, {"excitation.amplitude": ["40 N", "50 N"]}, workers=workers, progress=Listener())
    pattern = r"[01] of 2; .*(40|50).*: \d+ %, \d+\.\d\d Hz, point \d+, \d+ pairs moving"
    assert any(re.match(pattern, words) for words in details), details
