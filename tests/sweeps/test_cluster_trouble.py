"""Dask clusters in trouble: other code on a worker, a scheduler or workers that end: sentences, no wrong row."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import stickslip
import sweep_deaths
from dask_processes import (
    PATIENCE_SECONDS,
    address_of,
    require_distributed,
    scheduler_arguments,
    started,
    started_scheduler,
    started_sweep,
    wait_until,
    worker_arguments,
)
from sentences import printed_sentence, rejects
from stickslip.core.errors import InputError, WorkersError
from stickslip.sweeps import cluster, schedule
from stickslip.sweeps.cluster import ClusterExecutor, cluster_executor
from stickslip.sweeps.schedule import Schedule, StructureGroup
from stickslip.sweeps.work import open_parcel, parcel, worker_version
from sweep_cases import quick_file

LOADS = "450:700:6"


@pytest.fixture(autouse=True)
def distributed() -> None:
    require_distributed()


@pytest.fixture
def other_code(tmp_path: Path) -> dict[str, str]:
    """Environment of a process that runs stickslip with one line more."""
    package = tmp_path / "other" / "stickslip"
    shutil.copytree(Path(stickslip.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    with (package / "solve" / "path" / "newton.py").open("a", encoding="utf-8") as stream:
        stream.write("# other\n")
    return {"PYTHONPATH": str(package.parent)}


@pytest.fixture(scope="module")
def head(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[subprocess.Popen[bytes], str, Path]]:
    """The process of a scheduler, its address, and the folder of its file; each test takes its workers away again."""
    require_distributed()
    folder = tmp_path_factory.mktemp("scheduler")
    with started_scheduler(folder, extra={"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}) as (process, address):
        yield process, address, folder


@pytest.fixture
def folder(head: tuple[object, str, Path]) -> Iterator[Path]:
    """Where workers find the scheduler, which has none before and after the test."""
    _, address, folder = head
    yield folder
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        wait_until(lambda: not client.nthreads(), "a worker outlives its test")


OwnCluster = tuple[Any, Any, ClusterExecutor]


@pytest.fixture
def own_cluster(head: tuple[object, str, Path], folder: Path) -> Iterator[OwnCluster]:
    """The processes of the scheduler and of its worker, and the executor of both."""
    process, address, _ = head
    with started(*worker_arguments(folder)) as worker, cluster_executor(address) as executor:
        yield process, worker, executor


def require_workers(address: str, count: int) -> None:
    """Wait until so many workers are there."""
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=PATIENCE_SECONDS)


def group() -> StructureGroup:
    """One case without mechanics."""
    no_setup: Any = None
    task: Any = SimpleNamespace(deed="good", marker="", threads=1)
    planned: Any = SimpleNamespace(name="only", case=None)
    return StructureGroup(no_setup, [(planned, task)])


@pytest.mark.long
def test_one_worker_with_other_code_among_others_is_named_before_anything_is_solved(
    tmp_path: Path, other_code: dict[str, str], head: tuple[object, str, Path], folder: Path
) -> None:
    study, out, address = quick_file(tmp_path), tmp_path / "out", head[1]
    with started(*worker_arguments(folder)), started(*worker_arguments(folder), extra=other_code):
        require_workers(address, 2)
        with started_sweep(study, out, LOADS, address) as sweep:
            _, complained = sweep.communicate(timeout=PATIENCE_SECONDS)
    assert sweep.returncode == 2, complained
    printed_sentence(complained[complained.index("Error: ") :], worker_version())
    assert complained.count(" runs stickslip ") == 1 + 1
    assert "Traceback" not in complained
    assert not list(out.glob("cases/*"))


@pytest.mark.long
def test_a_worker_with_other_code_that_comes_later_solves_nothing(
    folder: Path, other_code: dict[str, str], own_cluster: OwnCluster
) -> None:
    _, worker, executor = own_cluster
    assert executor.submit(open_parcel, parcel(pow, 2, 5)).result() == 32
    worker.kill()
    wait_until(executor.waiting_for, "the scheduler does not miss its worker")
    with started(*worker_arguments(folder), extra=other_code) as late:
        error = executor.submit(open_parcel, parcel(pow, 2, 5)).exception(PATIENCE_SECONDS)
    assert isinstance(error, WorkersError)
    printed_sentence(str(error), f"process {late.pid}", worker_version())


def without_stickslip(arguments: tuple[str, ...]) -> tuple[str, ...]:
    """Arguments of Python for the same program of Dask where stickslip is not installed."""
    _, module, *options = arguments
    code = f"import sys; sys.modules['stickslip'] = None; from {module} import main; main()"
    return ("-c", code, *options)


@pytest.mark.slow
def test_a_worker_without_stickslip_is_named(head: tuple[object, str, Path], folder: Path) -> None:
    with (
        started(*without_stickslip(worker_arguments(folder))),
        rejects(WorkersError),  # the rest are words of Dask
        cluster_executor(head[1]),
    ):
        pass


@pytest.mark.long
def test_a_scheduler_without_stickslip_is_reported(tmp_path: Path) -> None:
    with (
        started(*without_stickslip(scheduler_arguments(tmp_path))),
        started(*worker_arguments(tmp_path)),
        rejects(WorkersError),
        cluster_executor(address_of(tmp_path)),
    ):
        pass


@pytest.mark.long
def test_a_scheduler_that_dies_ends_the_sweep_and_keeps_what_is_finished(tmp_path: Path) -> None:
    study, out = quick_file(tmp_path), tmp_path / "out"
    with (
        started_scheduler(tmp_path) as (head, address),
        started(*worker_arguments(tmp_path)),
        started_sweep(study, out, LOADS, address) as sweep,
    ):

        def finished() -> int:
            return len(list(out.glob("cases/*/results.nc")))

        wait_until(lambda: finished() >= 1 or sweep.poll() is not None, "no case is finished")
        head.kill()
        _, complained = sweep.communicate(timeout=PATIENCE_SECONDS)
    assert sweep.returncode == 2, complained
    assert 1 <= finished() < 6
    printed_sentence(complained[complained.index("Error: ") :], address, f"{finished()} of 6", numbers=False)
    assert "Traceback" not in complained


@pytest.mark.long
def test_a_scheduler_that_hangs_is_reported(own_cluster: OwnCluster, monkeypatch: pytest.MonkeyPatch) -> None:
    head, _, executor = own_cluster
    monkeypatch.setattr(cluster, "ANSWER_SECONDS", 1)
    head.send_signal(signal.SIGSTOP)
    try:
        with rejects(WorkersError):
            executor.waiting_for()
    finally:
        head.send_signal(signal.SIGCONT)


@pytest.mark.long
def test_without_workers_the_wait_is_reported_and_ends(
    own_cluster: OwnCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, worker, executor = own_cluster
    monkeypatch.setattr(schedule, "reduce_task", sweep_deaths.reduce)
    monkeypatch.setattr(schedule, "CHECK_SECONDS", 0.5)
    assert executor.waiting_for() == ""
    worker.kill()
    wait_until(executor.waiting_for, "the scheduler does not miss its worker")
    monkeypatch.setattr(cluster, "WITHOUT_WORKER_SECONDS", 5.0)
    reported: list[str] = []
    with rejects(WorkersError):
        Schedule(
            executor, lambda: executor.tasks_at_a_time, lambda *_: None, lambda *_: None, waiting=reported.append
        ).run([group()])
    printed_sentence(reported[0], numbers=False)


@pytest.mark.long
def test_a_task_whose_workers_die_is_given_up(own_cluster: OwnCluster) -> None:
    _, _, executor = own_cluster
    error = executor.submit(os._exit, 1).exception(PATIENCE_SECONDS)
    assert error is not None
    assert isinstance(executor.meaning(error), BrokenExecutor)
    assert "workers died while running it" in str(executor.meaning(error))  # words of Dask


@pytest.mark.slow
def test_a_worker_that_is_killed_at_its_start_is_no_worker(
    head: tuple[object, str, Path], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 3)
    with started(*worker_arguments(folder)):
        pass
    with rejects(InputError), cluster_executor(head[1]):
        pass
