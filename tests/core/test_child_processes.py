"""Processes that the package starts run no modules of the current folder."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import stickslip
from stickslip.core.processes import python_command, safe_path
from stickslip.sweeps.pool import LocalProcesses
from strangers import strangers


@pytest.mark.slow
def test_another_python_finds_the_package_and_nothing_of_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    strangers(tmp_path)
    monkeypatch.chdir(tmp_path)
    for places in (sys.path, ["", ".", *sys.path], [place for place in sys.path if "src" not in place]):
        monkeypatch.setattr(sys, "path", places)
        command = python_command("import random, copy, numpy, stickslip; print(stickslip.__file__)")
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        assert done.stdout.strip() == stickslip.__file__
    assert not (tmp_path / "ran").exists()


@pytest.mark.slow
def test_workers_of_a_sweep_run_nothing_of_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    strangers(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place])
    pool = LocalProcesses(1)
    try:
        pool.require_start(os.getpid)
    finally:
        pool.shutdown()
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("before", [None, "", "1"])
def test_the_environment_is_as_before(before: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    if before is not None:
        monkeypatch.setenv("PYTHONSAFEPATH", before)
    with safe_path():
        assert os.environ["PYTHONSAFEPATH"] == "1"
    assert os.environ.get("PYTHONSAFEPATH") == before
