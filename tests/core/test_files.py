"""Files whole or not at all: left-over parts, full disks, places that are checked before long work."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from helpers import unmeasured
from sentences import rejects
from stickslip.core import files
from stickslip.core.errors import InputError, OutputError, ResultsFileError
from stickslip.core.files import (
    remove_abandoned,
    require_disk_space,
    require_folder,
    whole_file,
    work_folder,
    write_solved,
)

WRITER = """
import sys, time
from pathlib import Path
from stickslip.core.errors import InputError
from stickslip.core.files import {how}
with {how}(Path(sys.argv[1]) / "page.html", "page", InputError) as part:
    (part if part.is_file() else part / "half").write_text("half")
    print("writing", flush=True)
    time.sleep(600)
"""
needs_locks = pytest.mark.skipif(os.name != "posix", reason="Windows itself keeps open files")


def killed_writer(folder: Path, how: str) -> subprocess.Popen[str]:
    """A process that stands in the middle of writing."""
    command = [sys.executable, "-c", WRITER.format(how=how), str(folder)]
    process = subprocess.Popen(command, stdout=-1, text=True, env=unmeasured())
    assert process.stdout is not None
    assert process.stdout.readline() == "writing\n"
    return process


@pytest.mark.slow
@needs_locks
@pytest.mark.parametrize("how", ["whole_file", "work_folder"])
def test_what_a_killed_writer_left_goes_and_what_a_living_one_has_stays(tmp_path: Path, how: str) -> None:
    writer = killed_writer(tmp_path, how)
    try:
        remove_abandoned(tmp_path)
        (part,) = tmp_path.iterdir()
        assert part.suffix == ".part"
    finally:
        writer.send_signal(signal.SIGKILL)
        writer.wait()
        assert writer.stdout is not None
        writer.stdout.close()
    remove_abandoned(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_parts_of_older_versions_and_of_half_removed_folders_go(tmp_path: Path) -> None:
    (tmp_path / ".results.nc.17.part").write_bytes(b"half")
    (tmp_path / ".empty.part").mkdir()
    (tmp_path / ".half.part" / "new").mkdir(parents=True)
    (tmp_path / ".other").write_bytes(b"not ours")
    remove_abandoned(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [".other"]


def test_names_of_parts_do_not_come_from_numbers_of_processes(tmp_path: Path) -> None:
    """Two containers that share a folder may give their processes the same number."""
    target = tmp_path / "results.nc"
    with whole_file(target, "results", InputError) as one, whole_file(target, "results", InputError) as other:
        one.write_bytes(b"one")
        other.write_bytes(b"other")
    assert target.read_bytes() == b"one"
    assert os.listdir(tmp_path) == ["results.nc"]


def test_a_part_that_was_mistaken_for_abandoned_before_it_was_locked_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def meanwhile(held: int) -> None:
        monkeypatch.undo()
        for part in tmp_path.glob("*.part"):
            part.unlink()

    monkeypatch.setattr(files, "_lock", meanwhile)
    with whole_file(tmp_path / "a.txt", "text", InputError) as part:
        part.write_text("whole")
    assert (tmp_path / "a.txt").read_text() == "whole"


def test_a_work_folder_is_gone_after_a_failure(tmp_path: Path) -> None:
    def fail() -> None:
        with work_folder(tmp_path / "a.pvd", "shape", InputError) as folder:
            (folder / "half").write_text("half")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    with (
        rejects(InputError),
        work_folder(tmp_path / "none" / "a.pvd", "shape", InputError),
    ):
        pass
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's cache folder."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_what_was_solved_is_kept_where_there_is_room(tmp_path: Path, elsewhere: Path) -> None:
    with rejects(ResultsFileError) as error:
        write_solved(tmp_path / "gone" / "results.nc", b"curve", "results", ResultsFileError, then="look at it")
    (retained,) = elsewhere.rglob("results.nc")
    assert str(retained) in str(error.value)
    assert retained.read_bytes() == b"curve"


def test_without_a_cache_folder_it_is_kept_among_the_temporary_files(
    tmp_path: Path, elsewhere: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere.write_text("not a folder")
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    with rejects(ResultsFileError):
        write_solved(tmp_path / "gone" / "results.nc", b"curve", "results", ResultsFileError, then="look")
    assert next((tmp_path / "temporary").rglob("results.nc")).read_bytes() == b"curve"


def test_no_room_anywhere_is_reported(tmp_path: Path, elsewhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    elsewhere.write_text("not a folder")
    monkeypatch.setattr("tempfile.tempdir", str(elsewhere))
    with rejects(ResultsFileError):
        write_solved(tmp_path / "gone" / "results.nc", b"curve", "results", ResultsFileError, then="look")


@pytest.mark.skipif(os.name != "posix", reason="a system of this kind gives every user a home")
def test_a_user_without_a_home_has_no_cache_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown_user(number: int) -> None:
        raise KeyError(f"getpwuid(): uid not found: {number}")

    for variable in ("XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr("pwd.getpwuid", unknown_user)
    assert files.user_cache_folder() is None


def test_places_that_are_taken_are_reported_before(tmp_path: Path) -> None:
    (tmp_path / "results.nc").mkdir()
    (tmp_path / "figures").write_text("a file")
    with rejects(OutputError):
        require_folder(tmp_path, files=["results.nc"])
    with rejects(OutputError):
        require_folder(tmp_path, folders=["figures"])
    with rejects(OutputError):
        require_folder(tmp_path / "figures" / "out")
    require_folder(tmp_path / "new", files=["results.nc"], folders=["figures"])
    assert list((tmp_path / "new").iterdir()) == []


def test_too_little_room_is_reported(tmp_path: Path) -> None:
    with rejects(OutputError):
        require_disk_space(tmp_path, 10**18, 1)
    require_disk_space(tmp_path, 1, 1)
    with rejects(OutputError):
        require_disk_space(tmp_path / "removed", 1, 1)


@pytest.mark.skipif(os.name != "posix", reason="limits of files are of POSIX systems")
def test_a_limit_of_the_size_of_files_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import resource

    monkeypatch.setattr(resource, "getrlimit", lambda _: (1_024_000, resource.RLIM_INFINITY))
    with rejects(OutputError):
        require_disk_space(tmp_path, 1, 2_000_000)
    require_disk_space(tmp_path, 1, 1_000_000)
