"""A results file: one NetCDF-4 file of named groups of labelled variables.

Layout (read it with xarray, MATLAB, Panoply, ncdump): the curve and the response in the root group, the linear limits
in ``linear``, the joint in ``pairs``, the study in ``study``, the picture of its structure, if there is one, in
``sketch``. Cosine and sine parts are separate real arrays. The class of each group defines its content.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from importlib.metadata import version
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from stickslip.core.errors import ImportFileError, InputError, ResultsFileError
from stickslip.core.files import whole_file
from stickslip.core.input_files import open_hdf5, open_regular
from stickslip.results.netcdf import COMPRESSED, netcdf_bytes
from stickslip.results.stored import LARGEST_EXPANSION, StoredGroup, UnreadableError

if TYPE_CHECKING:
    import xarray

FORMAT_VERSION = 2  # raised when older code cannot read a new file
_FORMAT = "stickslip_format"
_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
Result = TypeVar("Result")


def groups_bytes(groups: Mapping[str, xarray.Dataset]) -> bytes:
    """The content of a results file with these groups, "" being the root."""
    label = {"source": f"stickslip {version('stickslip')}", _FORMAT: FORMAT_VERSION}
    return netcdf_bytes(({**groups, "": groups[""].assign_attrs(label)}).items(), COMPRESSED)


def write_groups(path: str | PathLike[str], groups: Mapping[str, xarray.Dataset]) -> None:
    """Write a results file completely or not at all: a hidden file beside it is renamed once it is complete.

    Raises ResultsFileError if the file cannot be written.
    """
    with whole_file(Path(path), "results", ResultsFileError) as part:
        part.write_bytes(groups_bytes(groups))


def read_groups(path: str | PathLike[str], read: Callable[[StoredGroup], Result]) -> Result:
    """The result of ``read`` for the root group of a results file.

    Raises
    ------
    ResultsFileError
        for a file that is missing, is not NetCDF-4, is not of stickslip, is of another version, or is damaged.
    """
    source = Path(path)
    try:
        with open_regular(source, largest=None) as stream:
            signature = stream.read(len(_HDF5_SIGNATURE))
            rest = stream.read() if signature == _HDF5_SIGNATURE else b""
    except OSError as error:
        why = "there is no such file" if isinstance(error, FileNotFoundError) else error.strerror or error
        raise ResultsFileError(
            f'the results file "{source}" could not be opened: {why}. "stickslip run" writes it as results.nc in its '
            "output folder."
        ) from error
    if signature != _HDF5_SIGNATURE:
        raise ResultsFileError(
            f'"{source}" is not a NetCDF-4 file (its first bytes are {signature!r}). Give the results.nc of "stickslip '
            'run".'
        )
    try:
        open_hdf5(source, largest=None).close()
        return _read(source, signature + rest, read)
    except ResultsFileError:
        raise
    except ImportFileError as error:
        raise ResultsFileError(f"the results file cannot be read: {error}") from error
    except Exception as error:  # HDF5 raises many kinds of errors for damaged bytes
        reason = "its structure of groups and variables cannot be read"
        if isinstance(error, UnreadableError | InputError):
            reason = str(error).removesuffix(".")
        raise ResultsFileError(
            f'the results file "{source}" is damaged or incomplete: {reason}. Copy it again from the original '
            "location, or solve again."
        ) from error


def _read(source: Path, content: bytes, read: Callable[[StoredGroup], Result]) -> Result:
    """The results in the content of ``source``: read from memory, because HDF5 ends the process if a disk fails."""
    import h5py

    with h5py.File(io.BytesIO(content), "r") as file:
        root = StoredGroup(file, LARGEST_EXPANSION * len(content))
        if _FORMAT not in file.attrs:
            raise ResultsFileError(
                f'"{source}" is a NetCDF-4 file, but not one of stickslip: it has no attribute stickslip_format. Give '
                'the results.nc of "stickslip run".'
            )
        version = root.whole_number(_FORMAT, 0, 10**6)
        if version != FORMAT_VERSION:
            raise ResultsFileError(
                f'the results file "{source}" has format {version}, but this version of stickslip reads format '
                f"{FORMAT_VERSION}. Open it with the version of stickslip that wrote it, or solve again."
            )
        return read(root)
