"""Files of other programs: opening them, and errors that name the file."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.errors import ImportFileError, InputError, MissingPackageError
from stickslip.core.input_files import UnsuitableFileError, open_regular, read_regular, require_unpackable_zip

_BEGINS_WITH_NUMBER = re.compile(r"[-+]?\.?\d")


@contextmanager
def errors_naming(path: Path) -> Iterator[None]:
    """Put the name of the file before the message of any InputError raised inside."""
    try:
        yield
    except ImportFileError:
        raise
    except InputError as error:
        raise ImportFileError(f'"{path}": {error}') from error


@contextmanager
def readable(path: Path, kind: str) -> Iterator[None]:
    """Turn any exception of the reader of another package for a damaged or foreign file into an ImportFileError."""
    try:
        with warnings.catch_warnings():
            # Readers warn of damage that their errors, or the checks of the matrices, report later.
            warnings.simplefilter("ignore")
            yield
    except (InputError, MissingPackageError):
        raise
    except (FileNotFoundError, PermissionError, UnsuitableFileError) as error:
        raise not_opened(path, error) from error
    except Exception as error:  # exceptions of other readers for a damaged file are not documented
        raise ImportFileError(
            f'"{path}" could not be read as {kind}: {type(error).__name__}, {error}. It is damaged, incomplete or of '
            "another kind. Write it again, and do not transfer binary files as text."
        ) from error


def not_opened(path: Path, error: OSError) -> ImportFileError:
    """The error for a file that does not exist or cannot be read."""
    return ImportFileError(f'"{path}" could not be opened: {error.strerror or error}. Check the name and the folder.')


def quoted(text: str) -> str:
    """The start of a line of numbers for a sentence, in quotes; nothing of a line that does not begin with a number.

    Such a line is not a damaged row: the file is a wrong one, and its content must not be in an error message.
    """
    shown = text.strip()[:60]
    return f'"{shown}"' if _BEGINS_WITH_NUMBER.match(shown) else "the content"


def file_bytes(path: Path) -> bytes:
    """The content of a file; raises ImportFileError if there is none, or it is empty."""
    try:
        content = read_regular(path)
    except OSError as error:
        raise not_opened(path, error) from error
    if not content:
        raise ImportFileError(f'"{path}" is empty. Was the program that writes it interrupted?')
    return content


def text_lines(path: Path, may_lack_end: bool = False) -> list[str]:
    """The lines of a text file; raises ImportFileError for one that is missing, empty, binary or cut in a line.

    ``may_lack_end``: a last line without line end is allowed, because the caller rejects an incomplete one.
    """
    content = file_bytes(path)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ImportFileError(f'"{path}" is not a text file: byte {error.start} is not a text character.') from error
    if "\0" in text:
        raise ImportFileError(f'"{path}" is not a text file: byte {text.index(chr(0))} is 0.')
    lines = text.splitlines()
    if not text.endswith(("\n", "\r")) and not may_lack_end:
        raise ImportFileError(
            f'"{path}" ends in the middle of line {len(lines)}, without a line end, so its last number may be '
            "truncated. Write the file again; if it is complete, add a line end."
        )
    return lines


def numpy_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """All arrays of a ``.npz`` file (no pickled objects). Raises ImportFileError."""
    with readable(path, "a NumPy .npz file"), open_regular(path) as stream:
        require_unpackable_zip(path, stream)
        data = np.load(stream, allow_pickle=False)
        if not isinstance(data, np.lib.npyio.NpzFile):
            raise ImportFileError(f'"{path}" contains one array, but an .npz file contains several arrays with names.')
        return {name: data[name] for name in data.files}
