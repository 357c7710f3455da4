"""Worker processes: those that die, and sweeps that are interrupted or killed and go on."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import time
import traceback
from concurrent.futures import BrokenExecutor, Executor, ThreadPoolExecutor
from dataclasses import replace
from multiprocessing.context import SpawnProcess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import stickslip as ss
import sweep_deaths
from helpers import unmeasured
from sentences import printed_sentence, rejects
from stickslip.case.load import load_case
from stickslip.core.errors import InputError, WorkersError
from stickslip.core.threads import usable_cores
from stickslip.sweeps import schedule, work
from stickslip.sweeps.pool import LocalProcesses, WorkerDied
from stickslip.sweeps.schedule import Schedule, StructureGroup
from strangers import is_alive
from sweep_cases import quick_file

LOADS = "450:700:6"


def group(deeds: list[str], marker: Path) -> StructureGroup:
    """A group whose cases do the deeds."""
    cases: Any = [
        (SimpleNamespace(name=str(number), case=None), SimpleNamespace(deed=deed, marker=str(marker), threads=1))
        for number, deed in enumerate(deeds)
    ]
    no_setup: Any = None
    return StructureGroup(no_setup, cases)


@pytest.fixture
def light_tasks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tasks without mechanics in place of the real ones."""
    monkeypatch.setattr(schedule, "reduce_task", sweep_deaths.reduce)
    monkeypatch.setattr(schedule, "solve_task", sweep_deaths.solve)


@pytest.mark.long
@pytest.mark.usefixtures("light_tasks", "untraced_commands")
def test_a_worker_that_dies_fails_its_own_case_only(tmp_path: Path) -> None:
    finished: dict[str, object] = {}
    broken: dict[str, BaseException] = {}
    pool = LocalProcesses(2)
    try:
        Schedule(
            pool,
            lambda: 4,
            lambda planned, outcome: finished.__setitem__(planned.name, outcome),
            lambda planned, error: broken.__setitem__(planned.name, error),
        ).run([group(["good", "dies", "good", "dies once", "fault", "good"], tmp_path / "died")])
    finally:
        pool.shutdown()
    assert finished == {"0": "good reduced", "2": "good reduced", "3": "dies once reduced", "5": "good reduced"}
    assert isinstance(broken["1"], WorkerDied)
    assert isinstance(broken["4"], ZeroDivisionError)
    assert "in solve" in "".join(traceback.format_exception(broken["4"]))  # where it happened, in the other process


@pytest.mark.usefixtures("light_tasks")
def test_an_executor_that_is_broken_fails_its_cases(tmp_path: Path) -> None:
    class Broken(Executor):
        def submit(self, *_: object, **__: object) -> object:  # type: ignore[override]
            raise BrokenExecutor("gone")

    broken: list[str] = []
    Schedule(Broken(), lambda: 4, lambda *_: None, lambda planned, error: broken.append(f"{planned.name} {error}")).run(
        [group(["good", "good"], tmp_path)]
    )
    assert broken == ["0 gone", "1 gone"]


@pytest.mark.slow
def test_answers_that_cannot_travel_and_processes_that_are_ended(tmp_path: Path) -> None:
    pool = LocalProcesses(1)
    with pytest.raises(RuntimeError) as caught:
        pool.submit(sweep_deaths.unpicklable).result()
    printed_sentence(str(caught.value).partition(" (")[0])  # before the words of Python
    # The words are Python's own: "Can't pickle local object" until 3.11, "Can't get local object" later.
    with pytest.raises((AttributeError, TypeError), match="local object"):
        pool.submit(lambda: 1).result()
    first = pool.submit(time.sleep, 60.0)
    second = pool.submit(time.sleep, 60.0)
    while not first.running():
        time.sleep(0.01)
    pool.shutdown(wait=False, cancel_futures=True)
    assert isinstance(first.exception(), WorkerDied)
    assert second.cancelled()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="pipes of this system send an answer whole")
def test_a_worker_that_dies_while_it_sends_its_answer_is_noticed() -> None:
    """The pool of the standard library waits for the rest of the answer for ever."""
    pool = LocalProcesses(1)
    try:
        with pytest.raises(WorkerDied):
            pool.submit(sweep_deaths.die_in_answer).result(timeout=30.0)
        assert pool.submit(abs, -1).result() == 1
    finally:
        pool.shutdown(wait=False)


@pytest.mark.slow
def test_a_script_without_main_guard_is_reported(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "from stickslip.sweeps.pool import LocalProcesses\nimport os\nLocalProcesses(1).require_start(os.getpid)\n",
        encoding="utf-8",
    )
    result = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    assert result.returncode == 1
    printed_sentence(re.findall(r"InputError: (.*)", result.stderr)[-1])
    assert 1 <= usable_cores() <= (os.cpu_count() or 1)


# A shell that starts the tests in the background without job control has them ignore Ctrl-C, and so their children.
HEARS_CTRL_C = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "


def start_sweep(study: Path, out: Path) -> subprocess.Popen[str]:
    """``stickslip sweep`` with two workers, in a process group of its own, and without coverage: a signal inside of the
    tracer would leave its lock behind."""
    arguments = [
        "sweep",
        str(study),
        "--vary",
        f"preload.centrifugal_force={LOADS}",
        "--out",
        str(out),
        "--workers",
        "2",
    ]
    return subprocess.Popen(
        [sys.executable, "-c", f"{HEARS_CTRL_C}from stickslip.cli.main import main; main()", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env=unmeasured(),
    )


def wait_for_files(out: Path, count: int, process: subprocess.Popen[str]) -> None:
    deadline = time.monotonic() + 120.0
    while len(list(out.glob("cases/*/results.nc"))) < count:
        assert process.poll() is None, process.communicate()[1]
        assert time.monotonic() < deadline
        time.sleep(0.02)


def children(process: subprocess.Popen[str]) -> list[int]:
    listed = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    return [int(pid) for pid in listed.read_text().split()] if listed.exists() else []


def require_end(pids: list[int]) -> None:
    deadline = time.monotonic() + 20.0
    while any(is_alive(pid) for pid in pids):
        assert time.monotonic() < deadline, "worker processes outlive their sweep"
        time.sleep(0.05)


@pytest.mark.long
@pytest.mark.skipif(not hasattr(os, "killpg"), reason="no process groups on this system")
def test_an_interrupted_and_a_killed_sweep_continue_without_solving_again(tmp_path: Path) -> None:
    study, out = quick_file(tmp_path), tmp_path / "out"
    with start_sweep(study, out) as process:
        wait_for_files(out, 1, process)
        workers = children(process)
        os.killpg(process.pid, signal.SIGINT)
        _, printed = process.communicate(timeout=60)
        assert process.returncode == 130, printed
        printed_sentence(printed.splitlines()[-1])
        assert "Traceback" not in printed
        require_end(workers)
    before = len(list(out.glob("cases/*/results.nc")))
    with start_sweep(study, out) as process:
        wait_for_files(out, before + 1, process)
        workers = children(process)
        process.kill()
        process.communicate(timeout=60)
        require_end(workers)
    assert process.returncode == -signal.SIGKILL
    finished = {file: file.stat().st_mtime_ns for file in out.glob("cases/*/results.nc")}
    assert before < len(finished) <= 6
    assert not (out / "sweep.csv").exists()
    result = ss.sweep(load_case(study), {"preload.centrifugal_force": LOADS}, out=out, workers=1)
    assert result.reused == len(finished)
    assert {file: file.stat().st_mtime_ns for file in finished} == finished
    assert [row.converged for row in result.table.rows] == [True] * 6
    # The kill may hit between the row of a case and its results, which are written after it.
    assert len(result.notices) <= 1
    assert all("results.nc" in notice for notice in result.notices)


def test_a_task_checks_the_code_before_it_reads_its_arguments() -> None:
    sent = work.parcel(pow, 2, 5)
    assert work.open_parcel(sent) == 32
    for version in ("0.0.9 (code 0123456789ab)", sent.version[:-2] + ")", ""):
        with rejects(WorkersError) as caught:
            work.open_parcel(work.Parcel(version, b"pickled by other code"))
        for part in (socket.gethostname(), f"process {os.getpid()}", work.worker_version(), f" {version}."):
            assert part in str(caught.value)


@pytest.mark.long
@pytest.mark.usefixtures("light_tasks")
@pytest.mark.parametrize("executor", [LocalProcesses, ThreadPoolExecutor])
def test_workers_of_other_code_end_the_sweep_without_a_row(
    executor: type[Executor], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(schedule, "parcel", lambda *call: replace(work.parcel(*call), version="0.0.9 (code 0)"))
    rows: list[object] = []
    pool = executor(1)  # type: ignore[call-arg]
    try:
        with rejects(WorkersError):
            Schedule(pool, lambda: 2, lambda *row: rows.append(row), lambda *row: rows.append(row)).run(
                [group(["good", "good"], tmp_path)]
            )
    finally:
        pool.shutdown()
    assert rows == []


def test_a_process_that_cannot_be_started_is_a_worker_that_died(monkeypatch: pytest.MonkeyPatch) -> None:
    def rejected(process: SpawnProcess) -> None:
        raise BlockingIOError("Resource temporarily unavailable")

    monkeypatch.setattr(SpawnProcess, "start", rejected)
    pool = LocalProcesses(1)
    try:
        with rejects(InputError):
            pool.require_start(os.getpid)
        assert isinstance(pool.submit(os.getpid).exception(), WorkerDied)
    finally:
        pool.shutdown(wait=False)


@pytest.mark.long
@pytest.mark.usefixtures("untraced_commands")
def test_what_a_worker_imports_lies_in_the_code_that_its_digest_covers(tmp_path: Path) -> None:
    quick_file(tmp_path)
    script = f"""
import sys
from pathlib import Path
import stickslip.sweeps.work as work
from stickslip.case.load import load_case
from stickslip.model.model import load_joint, set_up
case = load_case({str(tmp_path / "study.toml")!r})
setup = set_up(case)
task = work.CaseTask(case, "key", load_joint(case, setup.layout), 1, wants_file=True)
assert work.solve_task(task, work.reduce_task(case, setup, 1)).converged
used = {{Path(module.__file__) for name, module in sys.modules.items() if name.partition(".")[0] == "stickslip"}}
assert len(used) > 50
print(*sorted(used - set(work.answering_files())))
"""
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == ""
