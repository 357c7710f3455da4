"""Files that are written completely or not at all, checks of output folders, and the digest of source files."""

from __future__ import annotations

import hashlib
import os
import secrets
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from platformdirs import user_cache_path

from stickslip.core.errors import OutputError, StickslipError

_PART = ".part"
_IN_USE = "in_use"  # in an unfinished folder: the file whose lock shows that its writer is alive
_UNSAVED_FOLDER = "stickslip-unsaved"
_own_parts: set[Path] = set()


@contextmanager
def whole_file(target: Path, what: str, error: type[StickslipError]) -> Iterator[Path]:
    """A hidden file beside ``target`` to write to; renamed to ``target`` when the block succeeds, removed otherwise.

    ``what`` names the content ("results"); an operating system error becomes ``error`` with a message.
    """
    with _errors_as(target, what, error):
        part, descriptor = _claim(target)
        try:
            yield part
            _flush(part)
            os.close(descriptor)  # before the new name: Windows renames no open file
            descriptor = -1
            os.replace(part, target)
        finally:
            if descriptor >= 0:
                os.close(descriptor)
            part.unlink(missing_ok=True)
            _own_parts.discard(part)


@contextmanager
def work_folder(target: Path, what: str, error: type[StickslipError]) -> Iterator[Path]:
    """A hidden folder beside ``target``, for content of several files; it is removed after the block.

    ``what`` names the content; an operating system error becomes ``error`` with a message.
    """
    with _errors_as(target, what, error):
        part, descriptor = _claim(target, is_folder=True)
        try:
            yield part
        finally:
            os.close(descriptor)
            shutil.rmtree(part, ignore_errors=True)
            _own_parts.discard(part)


def remove_abandoned(folder: Path) -> None:
    """Remove unfinished files of killed writers from ``folder``, and leave those of running writers.

    A writer locks its file, and the lock ends with its process, also in another container with equal process numbers.
    On a file system without locks no file is removed.
    """
    for part in folder.glob(f".*{_PART}"):
        with suppress(OSError):  # another run removes it, or another user owns it
            if part.is_dir():
                _remove_abandoned_folder(part)
                continue
            with _lock_of_abandoned(part) as is_abandoned:
                if is_abandoned:
                    part.unlink()


def remove_own_unfinished() -> None:
    """Remove the files that this process is writing, before it ends early."""
    for part in tuple(_own_parts):
        with suppress(OSError):
            if part.is_dir():
                shutil.rmtree(part)
            else:
                part.unlink()


def _remove_abandoned_folder(part: Path) -> None:
    """Remove an unfinished folder whose writer is dead. A writer marks the folder before it writes anything into it."""
    has_content = any(part.iterdir())
    mark = part / _IN_USE
    if not mark.exists():
        if has_content:  # its writer was killed while it removed the folder
            shutil.rmtree(part)
        else:
            part.rmdir()  # fails if a new writer marks it at the same time
        return
    with _lock_of_abandoned(mark) as is_abandoned:
        if is_abandoned:
            shutil.rmtree(part)


def write_solved(target: Path, content: bytes, what: str, error: type[StickslipError], then: str) -> None:
    """Write content that took long to compute; where ``target`` cannot be written, write it to another folder.

    ``then`` is the advice for when there is space again and the file has been moved to ``target``. Raises ``error``
    whenever ``target`` was not written; the message says whether and where the content is.
    """
    try:
        with whole_file(target, what, error) as part:
            part.write_bytes(content)
    except error as problem:
        saved = _saved_elsewhere(target.name, content)
        words = (
            "No other folder is writable either. Free disk space, and run the same command again."
            if saved is None
            else f'The result is in "{saved}". Free disk space, move that file to the path above, and {then}.'
        )
        raise error(f"{problem} {words}") from problem


def require_folder(folder: Path, files: Iterable[str] = (), folders: Iterable[str] = ()) -> None:
    """Create ``folder``; raise OutputError before any long computation unless files can be written into it.

    ``files`` and ``folders`` are the names of the future content: no folder may have the name of such a file and no
    file that of such a folder, and existing folders must be writable. Unfinished files of killed runs are removed.
    """
    _require_writable(folder)
    for name in files:
        if (folder / name).is_dir():
            raise _name_conflict(folder / name, "folder", "file")
    inner = [folder / name for name in folders]
    for place in inner:
        if place.is_dir():
            _require_writable(place)
        elif place.exists() or place.is_symlink():
            raise _name_conflict(place, "file", "folder")
    for place in (folder, *inner):
        remove_abandoned(place)


def _name_conflict(place: Path, existing: str, wanted: str) -> OutputError:
    return OutputError(
        f'"{place}" is a {existing}, but stickslip writes a {wanted} of that name. Move it, or give another folder.'
    )


def require_disk_space(folder: Path, whole_bytes: int, largest_file_bytes: int) -> None:
    """Raise OutputError unless the disk has ``whole_bytes`` free and a single file may have ``largest_file_bytes``."""
    try:
        free = shutil.disk_usage(folder).free
    except OSError as error:
        raise OutputError(
            f"the folder {folder} no longer exists ({error.strerror}), and nothing is solved yet. Start again."
        ) from error
    if free < whole_bytes:
        raise OutputError(
            f"the disk of the folder {folder} has {_megabytes(free)} free, but the files need about "
            f"{_megabytes(whole_bytes)}. Free disk space, or give a folder on another disk."
        )
    limit = _size_limit()
    if limit is not None and limit < largest_file_bytes:
        raise OutputError(
            f"the limit of the file size is {_megabytes(limit)} (ulimit -f), but the largest file needs about "
            f"{_megabytes(largest_file_bytes)}. Raise that limit."
        )


def source_digest(sources: Iterable[Path]) -> str:
    """Hexadecimal digest of the content of source files, in the order of their paths: it changes with the code."""
    digest = hashlib.blake2b(digest_size=16)
    for source in sorted(sources):
        digest.update(source.read_bytes())
    return digest.hexdigest()


@contextmanager
def _errors_as(target: Path, what: str, error: type[StickslipError]) -> Iterator[None]:
    try:
        yield
    except OSError as problem:
        if isinstance(problem, StickslipError):  # MissingPackageError and others have two parents
            raise
        raise error(
            f'the {what} could not be written to "{target}": {problem.strerror or problem}. Give an existing, '
            "writable folder with free disk space."
        ) from problem


def _claim(target: Path, is_folder: bool = False) -> tuple[Path, int]:
    """A new unfinished file or folder, and the descriptor of its lock."""
    while True:
        # a random name: processes of two containers may share a number
        part = target.with_name(f".{target.name}.{secrets.token_hex(8)}{_PART}")
        if is_folder:
            part.mkdir()
        mark = part / _IN_USE if is_folder else part
        try:
            descriptor = os.open(mark, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666)
        except FileNotFoundError:
            if is_folder and target.parent.is_dir():
                continue  # removed as abandoned before it was marked
            raise
        _lock(descriptor)
        if mark.exists():
            _own_parts.add(part)
            return part, descriptor
        os.close(descriptor)  # removed as abandoned before it was locked


def _lock(descriptor: int) -> None:
    """Lock an open file until its descriptor is closed, where the file system has locks."""
    if os.name == "posix":
        import fcntl

        with suppress(OSError):  # no locks here: the file is then never removed as abandoned
            fcntl.flock(descriptor, fcntl.LOCK_EX)


@contextmanager
def _lock_of_abandoned(path: Path) -> Iterator[bool]:
    """Whether no process has locked a file; the block has the lock. Windows removes no open file by itself."""
    if os.name != "posix":
        yield True
        return
    import fcntl

    probe = os.open(path, os.O_RDONLY)
    try:
        try:
            fcntl.flock(probe, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            yield False  # its writer is alive, or the file system has no locks
        else:
            yield True
    finally:
        os.close(probe)


def _flush(part: Path) -> None:
    """Write buffered data to the disk: a full disk may raise its error only now."""
    with part.open("rb+") as stream:
        os.fsync(stream.fileno())


def _saved_elsewhere(name: str, content: bytes) -> Path | None:
    """Write content into a new folder of the user's cache, or of the temporary files; None if neither has space."""
    for base in (user_cache_folder(), Path(tempfile.gettempdir())):
        if base is None:
            continue
        try:
            (base / _UNSAVED_FOLDER).mkdir(parents=True, exist_ok=True)
            folder = Path(tempfile.mkdtemp(dir=base / _UNSAVED_FOLDER))
        except OSError:
            continue
        try:
            with whole_file(folder / name, "results", StickslipError) as part:
                part.write_bytes(content)
        except StickslipError:
            shutil.rmtree(folder, ignore_errors=True)
            continue
        return folder / name
    return None


def user_cache_folder() -> Path | None:
    """The folder for caches that the system gives its user; None for a user without a home."""
    try:
        folder = user_cache_path()
    except RuntimeError:  # a container may run under a number that no user has
        return None
    return folder if folder.is_absolute() else None  # older versions of platformdirs: "~/.cache"


def _require_writable(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise OutputError(f"the folder {folder} is not writable ({error.strerror}). Give a writable folder.") from error


def _size_limit() -> int | None:
    """Bytes of the largest file that this process may write, None for no limit."""
    if os.name != "posix":
        return None
    import resource

    limit, _ = resource.getrlimit(resource.RLIMIT_FSIZE)
    return None if limit == resource.RLIM_INFINITY else limit


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB"
