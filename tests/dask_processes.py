"""Schedulers and workers of Dask as processes, for the tests of sweeps on a cluster."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from helpers import absent_tool, unmeasured

PATIENCE_SECONDS = 300.0  # workers of a clean checkout compile first, on a machine that may do other things
SWEEP = (sys.executable, "-c", "from stickslip.cli.main import main; main()", "sweep")


def require_distributed() -> None:
    if importlib.util.find_spec("distributed") is None:
        absent_tool("distributed", 'pip install "stickslip[cluster]".')


def wait_until(condition: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + PATIENCE_SECONDS
    while not condition():
        assert time.monotonic() < deadline, what
        time.sleep(0.05)


@contextmanager
def started(*arguments: str, extra: Mapping[str, str] | None = None) -> Iterator[subprocess.Popen[bytes]]:
    """A process of this Python, killed at the end; ``extra`` are environment variables."""
    quiet = subprocess.DEVNULL
    environment = {**unmeasured(), **(extra or {})}
    process = subprocess.Popen([sys.executable, *arguments], stdout=quiet, stderr=quiet, env=environment)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@contextmanager
def started_scheduler(
    folder: Path, *options: str, extra: Mapping[str, str] | None = None
) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """A scheduler and its address, once it listens; its file in ``folder`` tells workers where it is."""
    with started(*scheduler_arguments(folder), *options, extra=extra) as process:
        yield process, address_of(folder)


def scheduler_arguments(folder: Path) -> tuple[str, ...]:
    """Arguments for ``started``: a scheduler that writes its address into ``folder``."""
    local = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    return ("-m", "distributed.cli.dask_scheduler", "--scheduler-file", str(folder / "scheduler.json"), *local)


def address_of(folder: Path) -> str:
    """Address of the scheduler of ``folder``, once it listens."""
    file = folder / "scheduler.json"
    # Dask opens the file before it writes it: for a moment it is there and empty. Each file ends with its last brace.
    wait_until(lambda: file.exists() and file.read_text(encoding="utf-8").rstrip().endswith("}"), "no scheduler starts")
    return str(json.loads(file.read_text(encoding="utf-8"))["address"])


def worker_arguments(folder: Path) -> tuple[str, ...]:
    """Arguments for ``started``: a worker of one thread for the scheduler of ``folder``."""
    file, place = str(folder / "scheduler.json"), str(folder / "scratch")
    one = ("--nthreads", "1", "--nworkers", "1", "--no-nanny", "--no-dashboard")
    return ("-m", "distributed.cli.dask_worker", "--scheduler-file", file, *one, "--local-directory", place)


@contextmanager
def started_sweep(study: Path, out: Path, loads: str, address: str, **options: Any) -> Iterator[subprocess.Popen[str]]:
    """``stickslip sweep`` on the cluster with that address."""
    arguments = (str(study), "--vary", f"preload.centrifugal_force={loads}", "--out", str(out), "--scheduler", address)
    pipe = subprocess.PIPE
    with subprocess.Popen([*SWEEP, *arguments], stdout=pipe, stderr=pipe, text=True, **options) as process:
        try:
            yield process
        finally:
            process.kill()
