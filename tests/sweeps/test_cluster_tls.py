"""A sweep on a Dask cluster with certificates, which come from Dask's own configuration."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from dask_processes import (
    PATIENCE_SECONDS,
    require_distributed,
    started,
    started_scheduler,
    started_sweep,
    worker_arguments,
)
from helpers import absent_tool
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.sweeps import cluster
from sweep_cases import quick_file


def certificate(folder: Path) -> tuple[Path, Path]:
    """A self-made certificate, which serves as its own authority, and its key."""
    program = shutil.which("openssl")
    if program is None:
        absent_tool("openssl", "apt-get install openssl.")
    file, key = folder / "cluster.pem", folder / "cluster-key.pem"
    options = ["-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", "/CN=test"]
    subprocess.run([program, "req", *options, "-keyout", key, "-out", file], check=True, capture_output=True)
    return file, key


def configuration(file: Path, key: Path) -> str:
    """The file that docs/sweeps.md shows."""
    role = f"{{cert: {file}, key: {key}}}"
    return (
        f"distributed:\n  comm:\n    require-encryption: true\n    tls:\n      ca-file: {file}\n"
        f"      scheduler: {role}\n      worker: {role}\n      client: {role}\n"
    )


@pytest.mark.long
def test_certificates_of_the_configuration_of_dask_are_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    require_distributed()
    settings = tmp_path / "dask" / "distributed.yaml"
    settings.parent.mkdir()
    settings.write_text(configuration(*certificate(tmp_path)), encoding="utf-8")
    configured = {"DASK_CONFIG": str(settings.parent)}
    study = quick_file(tmp_path)
    with (
        started_scheduler(tmp_path, "--protocol", "tls", extra=configured) as (_, address),
        started(*worker_arguments(tmp_path), extra=configured),
    ):
        assert address.startswith("tls://")
        with started_sweep(study, tmp_path / "out", "600", address, env={**os.environ, **configured}) as sweep:
            printed, complained = sweep.communicate(timeout=PATIENCE_SECONDS)
        assert sweep.returncode == 0, complained
        assert "1 cases, 0 of them from an earlier run; 0 failed." in printed
        monkeypatch.setattr(cluster, "CONNECT_SECONDS", 3)  # this process has no certificates
        for wrong in (address, address.replace("tls:", "tcp:")):
            with (
                rejects(InputError),
                cluster.cluster_executor(wrong),
            ):
                pass
