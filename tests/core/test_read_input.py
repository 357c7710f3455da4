"""Whatever a path names, reading it ends at once, with its content or a sentence."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from typer.testing import CliRunner

from sentences import rejects
from stickslip.cli.main import app
from stickslip.core.errors import InputError, StudyFileError
from stickslip.core.input_files import read_input


def odd_path(kind: str, folder: Path) -> Path:
    """A path that is no file to read."""
    if kind == "pipe":
        os.mkfifo(folder / "pipe")
        return folder / "pipe"
    return {"folder": folder, "device": Path("/dev/zero"), "long name": folder / ("x" * 5000)}[kind]


KINDS = {
    "pipe": "it is a named pipe",
    "folder": "a folder",
    "device": "it is a device",
    "long name": "cannot be read",
}


@pytest.mark.skipif(os.name != "posix", reason="pipes and devices with names are those of POSIX")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("command", ["check", "roughness"])
def test_what_is_no_file_is_rejected_at_once(kind: str, command: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(
        app, [command, str(odd_path(kind, tmp_path)), *(["--unit", "um"] * (command != "check"))]
    )
    assert result.exit_code == 2
    assert KINDS[kind] in result.stderr
    assert len(result.stderr) < 1000
    assert "Traceback" not in result.stderr


def test_a_file_has_a_largest_size(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"x" * 11)
    assert read_input(tmp_path / "file", "", 11) == b"x" * 11
    with rejects(StudyFileError):
        read_input(tmp_path / "file", "Give less.", 10, StudyFileError)


def test_a_name_with_nul_is_rejected() -> None:
    with rejects(InputError):
        read_input("a\0b", "", 10)
