"""Files of other programs and users: which are opened, and how much of them is read.

Only regular files are opened: a named pipe or a device may have no end, and opening it may block. Compressed files are
read only if their unpacked size is plausible for their own size.
"""

from __future__ import annotations

import errno
import os
import stat
import zipfile
import zlib
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from stickslip.core.errors import ImportFileError, InputError

if TYPE_CHECKING:
    import h5py

# A deck of this size has about 30 million lines, ten times more than fit into the memory of the machines in
# docs/performance.md.
LARGEST_FILE = 2_000_000_000  # bytes
# Any compressed file may unpack to this size: two dense matrices of 7900 unknowns.
LARGEST_UNPACKED = 1_000_000_000  # bytes
# Larger files may unpack to this multiple of their size. Meshes and responses compress by a factor of 2 to 5, zeros by
# 1000.
LARGEST_RATIO = 20
_PIECE = 1 << 20  # bytes unpacked at a time to count them

_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)


class UnsuitableFileError(OSError):
    """A file that is not opened because of its kind or its size; ``strerror`` says why."""


def open_regular(path: Path, largest: int | None = LARGEST_FILE) -> BinaryIO:
    """Open a regular file of at most ``largest`` bytes (None: of any size) for reading.

    Raises OSError, whose ``strerror`` fits into a message, without waiting, also for a pipe without a writer.
    """
    status = os.stat(path)  # before opening: opening a device may already have effects
    _require_suitable(status, largest)
    stream = open(path, "rb", opener=_without_waiting)  # noqa: SIM115  the caller closes it
    try:
        _require_suitable(os.fstat(stream.fileno()), largest)
    except OSError:
        stream.close()
        raise
    return stream


def read_regular(path: Path, largest: int = LARGEST_FILE) -> bytes:
    """The content of a regular file of at most ``largest`` bytes. Raises OSError as :func:`open_regular`."""
    with open_regular(path, largest) as stream:
        # a file that grows while it is read, or that the kernel fills on reading, is cut off
        return stream.read(os.fstat(stream.fileno()).st_size)


def _without_waiting(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def _require_suitable(status: os.stat_result, largest: int | None) -> None:
    if not stat.S_ISREG(status.st_mode):
        kind = next((words for is_kind, words in _KINDS if is_kind(status.st_mode)), "no regular file")
        raise UnsuitableFileError(errno.EINVAL, f"it is {kind}, but it must be a regular file")
    if largest is not None and status.st_size > largest:
        raise UnsuitableFileError(
            errno.EFBIG, f"it has {in_words(status.st_size)}; the limit for such a file is {in_words(largest)}"
        )


def in_words(size: int) -> str:
    """A number of bytes as messages show it: 2.5 GB."""
    for unit, value in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= value:
            return f"{size / value:.3g} {unit}"
    return f"{size} bytes"


def unpacked_limit(packed: int) -> int:
    """Bytes that a file of ``packed`` bytes may unpack to."""
    return max(LARGEST_UNPACKED, LARGEST_RATIO * packed)


def require_unpackable(path: Path, packed: int, unpacked: int, at_least: bool = False) -> None:
    """Raise ImportFileError if ``packed`` bytes would unpack to an implausible number of bytes.

    ``at_least``: ``unpacked`` is a lower bound, because counting stopped there.
    """
    limit = unpacked_limit(packed)
    if unpacked > limit:
        raise ImportFileError(
            f'"{path}" has {in_words(packed)}, but decompresses to {"more than " if at_least else ""}'
            f"{in_words(limit if at_least else unpacked)}; the limit is {in_words(limit)} "
            f"({in_words(LARGEST_UNPACKED)}, or {LARGEST_RATIO} times the file size). If the file is neither "
            "damaged nor malicious, write it without compression, or write sparse matrices."
        )


def require_unpackable_zip(path: Path, stream: BinaryIO) -> None:
    """Check an opened zip file by its list of contents before it is unpacked; readers stop at the sizes in that list.

    Leaves the stream at its start. Raises ImportFileError; a file that is not a zip file is left to its reader.
    """
    if zipfile.is_zipfile(stream):
        with zipfile.ZipFile(stream) as archive:
            unpacked = sum(entry.file_size for entry in archive.infolist())
        require_unpackable(path, os.fstat(stream.fileno()).st_size, unpacked)
    stream.seek(0)


class UnpackedCount:
    """Counts the unpacked bytes of one file, part by part, and stops above the limit."""

    def __init__(self, path: Path, packed: int) -> None:
        self._path, self._packed, self._unpacked = path, packed, 0

    def pieces(self, unpacker: Any, content: bytes) -> Iterator[bytes]:
        """Unpack ``content`` with ``unpacker`` (of zlib or lzma), piece by piece. Raises ImportFileError."""
        while True:
            piece = unpacker.decompress(content, _PIECE)
            self._unpacked += len(piece)
            require_unpackable(self._path, self._packed, self._unpacked, at_least=True)
            yield piece
            # zlib returns its unread input, lzma keeps it; another piece may follow a full one
            content = getattr(unpacker, "unconsumed_tail", b"")
            if unpacker.eof or not (content or len(piece) == _PIECE):
                return


def require_unpackable_zlib(path: Path, packed: int, parts: Iterator[bytes]) -> None:
    """Count the unpacked bytes of the zlib-compressed ``parts`` of a file, without storing them.

    For formats that do not give this size, or not reliably. A damaged part ends the count; its reader reports it.
    Raises ImportFileError.
    """
    count = UnpackedCount(path, packed)
    for part in parts:
        try:
            for _ in count.pieces(zlib.decompressobj(), part):
                pass
        except zlib.error:
            return


def open_hdf5(path: Path, largest: int | None = LARGEST_FILE) -> h5py.File:
    """Open an HDF5 file that contains all of its data and unpacks to a size plausible for its own.

    Raises ImportFileError for external links, external storage, virtual data sets and too much compressed data; OSError
    as :func:`open_regular`, and for a file that is not HDF5.
    """
    import h5py

    with open_regular(path, largest) as stream:
        packed = os.fstat(stream.fileno()).st_size
    file = h5py.File(path, "r")
    try:
        _require_own_data(path, packed, file)
    except BaseException:
        file.close()
        raise
    return file


def _require_own_data(path: Path, packed: int, file: h5py.File) -> None:
    """Check every link and data set of an HDF5 file without reading data."""
    import h5py

    unpacked = 0
    seen: set[Any] = set()
    waiting: list[h5py.Group] = [file]
    while waiting:
        group = waiting.pop()
        for name in group:
            link = group.get(name, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                _reject_foreign_data(path, group, name, "is a link to another file")
            if not isinstance(link, h5py.HardLink):
                continue  # the target of a soft link in this file is visited under its own name
            item = group[name]
            address = h5py.h5o.get_info(item.id).addr
            if address in seen:
                continue
            seen.add(address)
            if isinstance(item, h5py.Group):
                waiting.append(item)
            elif isinstance(item, h5py.Dataset):
                if item.external:
                    _reject_foreign_data(path, group, name, "has its data in another file")
                if item.is_virtual:
                    _reject_foreign_data(path, group, name, "consists of data sets of other files")
                # a chunk is unpacked completely, however little of it belongs to the data set
                chunk = item.dtype.itemsize
                for length in item.chunks or ():
                    chunk *= length
                unpacked += max(item.nbytes if item.shape is not None else 0, chunk)
                require_unpackable(path, packed, unpacked)


def _reject_foreign_data(path: Path, group: h5py.Group, name: str, what: str) -> None:
    raise ImportFileError(
        f"\"{path}\": '{group.name.rstrip('/')}/{name}' {what}. stickslip reads no other files through an HDF5 "
        "file. Write all data into this file."
    )


def read_input(path: str | PathLike[str], advice: str, largest: int, error: type[InputError] = InputError) -> bytes:
    """The content of a small file that a user wrote or an instrument exported.

    Raises ``error`` with a message that ends with ``advice`` for a file that is missing, cannot be read, is not a
    regular file (a folder; a pipe or a device, which may have no end) or has more than ``largest`` bytes.
    """
    try:
        return read_regular(Path(path), largest)
    except FileNotFoundError as problem:
        raise error(f"{path}: the file does not exist. {advice}") from problem
    except (OSError, ValueError) as problem:  # a name with the character NUL is a ValueError
        why = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
        raise error(f"{shortened(str(path))}: the file cannot be read ({why}). {advice}") from problem


def shortened(name: str) -> str:
    """A name, shortened for a message if it is too long for any disk."""
    return name if len(name) <= 200 else f"{name[:100]} ... {name[-40:]}"
