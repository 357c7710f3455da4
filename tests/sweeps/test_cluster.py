"""A sweep on a Dask cluster: a real scheduler, two real workers, one of which is killed half-way."""

from __future__ import annotations

import logging
import re
import subprocess
import sys
from pathlib import Path

import pytest

import stickslip as ss
from dask_processes import (
    PATIENCE_SECONDS,
    require_distributed,
    started,
    started_scheduler,
    started_sweep,
    wait_until,
    worker_arguments,
)
from sentences import rejects
from stickslip.case.load import load_case
from stickslip.core.errors import InputError, MissingPackageError
from stickslip.sweeps import cluster
from sweep_cases import quick_file

LOADS = "450:700:6"


@pytest.mark.long
@pytest.mark.slow
def test_a_worker_that_is_killed_loses_no_case(tmp_path: Path) -> None:
    require_distributed()
    study, out = quick_file(tmp_path), tmp_path / "out"
    with (
        started_scheduler(tmp_path) as (_, address),
        started(*worker_arguments(tmp_path)) as doomed,
        started(*worker_arguments(tmp_path)),
        started_sweep(study, out, LOADS, address) as sweep,
    ):

        def finished() -> int:
            return len(list(out.glob("cases/*/results.nc")))

        wait_until(lambda: finished() >= 2 or sweep.poll() is not None, "no case is finished")
        assert finished() < 6, "the worker was to be killed half-way"
        doomed.kill()
        printed, complained = sweep.communicate(timeout=PATIENCE_SECONDS)
    assert sweep.returncode == 0, complained
    assert "6 cases, 0 of them from an earlier run; 0 failed." in printed
    assert "Traceback" not in complained
    assert "Warning" not in complained
    here = ss.sweep(load_case(study), {"preload.centrifugal_force": LOADS}, out=tmp_path / "here", workers=1)
    assert (out / "sweep.csv").read_bytes() == here.files[0].read_bytes()


@pytest.mark.slow
def test_an_address_where_nobody_answers_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    require_distributed()
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 1)
    with (
        rejects(InputError),
        cluster.cluster_executor("tcp://127.0.0.1:9"),
    ):
        pass
    with rejects(InputError), cluster.cluster_executor("nonsense://x"):
        pass


WRONG_ADDRESSES = ("", "127.0.0.1", "tcp://127.0.0.1:port", "tls://127.0.0.1:9")
ONE_AFTER_THE_OTHER = """
import sys
from stickslip.cli.main import app
command, addresses = sys.argv[:-1], sys.argv[-1].split(" ")
for address in addresses:
    sys.argv = [*command, address]
    try:
        app()
    except SystemExit as end:
        print("exit", end.code, flush=True)
"""


@pytest.mark.long
def test_a_wrong_address_is_exit_2_at_once(tmp_path: Path) -> None:
    """All in one process, which takes seconds to start, and whose output is complete: also what it logs at its end."""
    require_distributed()
    arguments = ("sweep", str(quick_file(tmp_path)), "--vary", "preload.centrifugal_force=600")
    sweeps = subprocess.run(
        [sys.executable, "-c", ONE_AFTER_THE_OTHER, *arguments, "--out", str(tmp_path / "out"), "--scheduler",
         " ".join(WRONG_ADDRESSES)],
        capture_output=True, text=True, check=True, timeout=PATIENCE_SECONDS,
    )  # fmt: skip
    assert sweeps.stdout == "exit 2\n" * len(WRONG_ADDRESSES), sweeps.stderr
    assert re.findall('no Dask scheduler responds at "(.*?)"', sweeps.stderr) == list(WRONG_ADDRESSES)
    assert "Traceback" not in sweeps.stderr


@pytest.mark.slow
def test_a_scheduler_without_workers_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    require_distributed()
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 2)
    with (
        started_scheduler(tmp_path) as (_, address),
        rejects(InputError),
        cluster.cluster_executor(address),
    ):
        pass


@pytest.mark.parametrize("part", ["client", "batched"])
def test_a_scheduler_that_is_lost_leaves_no_traceback_of_dask(part: str, caplog: pytest.LogCaptureFixture) -> None:
    """Both parts log one, the second if it was sending at that moment."""
    logger = logging.getLogger(f"distributed.{part}")
    before = logger.level
    with cluster._without_log():
        logger.error("Batched Comm Closed", exc_info=OSError("in <TCP (closed)>"))
    assert caplog.text == ""
    assert logger.level == before


def test_without_the_extra_its_name_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.setitem(sys.modules, "dask", None)
    with (
        rejects(MissingPackageError),
        cluster.cluster_executor("tcp://127.0.0.1:9"),
    ):
        pass
