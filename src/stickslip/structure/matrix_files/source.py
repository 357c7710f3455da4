"""Files of other programs: opening them, and errors that name the file."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ImportFileError, InputError

# What readers of other packages raise for files that are damaged or of another kind.
_DAMAGE = (
    OSError,
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    EOFError,
    OverflowError,
    MemoryError,
    NotImplementedError,
    AttributeError,
    zipfile.BadZipFile,
    zlib.error,
)


@contextmanager
def told_of(path: Path) -> Iterator[None]:
    """Put the name of the file before the sentence of any InputError raised inside."""
    try:
        yield
    except ImportFileError:
        raise
    except InputError as error:
        raise ImportFileError(f'"{path}": {error}') from error


@contextmanager
def readable(path: Path, kind: str) -> Iterator[None]:
    """Turn whatever a reader raises for a missing, damaged or foreign file into an ImportFileError with its name."""
    try:
        yield
    except InputError:
        raise
    except (FileNotFoundError, IsADirectoryError, PermissionError) as error:
        raise ImportFileError(
            f'"{path}" could not be opened: {error.strerror}. Check the name and the folder.'
        ) from error
    except _DAMAGE as error:
        raise ImportFileError(
            f'"{path}" could not be read as {kind}: {type(error).__name__}, {error}. It is damaged, incomplete or of '
            "another kind; write it again, and do not transfer binary files as text."
        ) from error


def numpy_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """All arrays of a ``.npz`` file (no pickled objects). Raises ImportFileError."""
    with readable(path, "a NumPy .npz file"), path.open("rb") as stream:
        data = np.load(stream, allow_pickle=False)
        if not isinstance(data, np.lib.npyio.NpzFile):
            raise ImportFileError(f'"{path}" holds one array, but a .npz file holds several with names.')
        return {name: data[name] for name in data.files}
