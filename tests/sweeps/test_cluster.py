"""A sweep on a Dask cluster: a real scheduler, two real workers, one of which is killed half-way."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import stickslip as ss
from helpers import absent_tool
from stickslip.case.case import load_case
from stickslip.core.errors import InputError, MissingPackageError
from stickslip.sweeps import cluster
from sweep_cases import quick_file

LOADS = "450:700:6"
PATIENCE_SECONDS = 120.0


def require_distributed() -> None:
    if importlib.util.find_spec("distributed") is None:
        absent_tool("distributed", 'pip install "stickslip[cluster]".')


@contextmanager
def started(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A process of this Python, killed at the end."""
    process = subprocess.Popen([sys.executable, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def wait_until(condition: object, what: str) -> None:
    deadline = time.monotonic() + PATIENCE_SECONDS
    while not condition():
        assert time.monotonic() < deadline, what
        time.sleep(0.05)


def scheduler_arguments(folder: Path) -> tuple[str, ...]:
    file = str(folder / "scheduler.json")
    local = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", file)
    return ("-m", "distributed.cli.dask_scheduler", *local)


def worker_arguments(folder: Path) -> tuple[str, ...]:
    file, place = str(folder / "scheduler.json"), str(folder / "scratch")
    one = ("--nthreads", "1", "--nworkers", "1", "--no-nanny", "--no-dashboard")
    return ("-m", "distributed.cli.dask_worker", "--scheduler-file", file, *one, "--local-directory", place)


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_no_case(tmp_path: Path) -> None:
    require_distributed()
    study, out, file = quick_file(tmp_path), tmp_path / "out", tmp_path / "scheduler.json"
    with (
        started(*scheduler_arguments(tmp_path)),
        started(*worker_arguments(tmp_path)) as doomed,
        started(*worker_arguments(tmp_path)),
    ):
        wait_until(file.exists, "the scheduler does not start")
        address = json.loads(file.read_text(encoding="utf-8"))["address"]
        command = ["sweep", str(study), "--vary", f"preload.centrifugal_force={LOADS}", "--out", str(out)]
        sweep = subprocess.Popen(
            [sys.executable, "-c", "from stickslip.cli.main import main; main()", *command, "--scheduler", address],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        with sweep:
            finished = lambda: len(list(out.glob("cases/*/results.nc")))  # noqa: E731
            wait_until(lambda: finished() >= 2 or sweep.poll() is not None, "no case is finished")
            assert finished() < 6, "the worker was to be killed half-way"
            doomed.kill()
            said, complained = sweep.communicate(timeout=PATIENCE_SECONDS)
    assert sweep.returncode == 0, complained
    assert "6 cases, 0 of them finished before; 0 failed." in said
    assert "Traceback" not in complained
    assert "Warning" not in complained
    here = ss.sweep(load_case(study), {"preload.centrifugal_force": LOADS}, out=tmp_path / "here", workers=1)
    assert (out / "sweep.csv").read_bytes() == here.files[0].read_bytes()


def test_an_address_where_nobody_answers_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    require_distributed()
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 1)
    with (
        pytest.raises(InputError, match=r'no Dask scheduler answers at "tcp://127\.0\.0\.1:9"'),
        cluster.cluster_executor("tcp://127.0.0.1:9"),
    ):
        pass
    with pytest.raises(InputError, match="no Dask scheduler answers"), cluster.cluster_executor("nonsense://x"):
        pass


def test_a_scheduler_without_workers_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    require_distributed()
    file = tmp_path / "scheduler.json"
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 2)
    with started(*scheduler_arguments(tmp_path)):
        wait_until(file.exists, "the scheduler does not start")
        address = json.loads(file.read_text(encoding="utf-8"))["address"]
        with pytest.raises(InputError, match="has no worker"), cluster.cluster_executor(address):
            pass


def test_without_the_extra_its_name_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.setitem(sys.modules, "dask", None)
    with (
        pytest.raises(MissingPackageError, match=r"pip install \"stickslip\[cluster\]\""),
        cluster.cluster_executor("tcp://127.0.0.1:9"),
    ):
        pass
