"""Matrices in NumPy and MATLAB files."""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.core.input_files import open_hdf5, open_regular, read_regular, require_unpackable_zlib
from stickslip.formats.matrices.coordinates import Matrices
from stickslip.formats.matrices.source import numpy_arrays, readable

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_MATLAB_HEADER = 512  # bytes before the HDF5 part of a version 7.3 file
_MATLAB_5_HEADER, _MATLAB_PACKED = 128, 15


def numpy_matrices(path: Path) -> Matrices:
    """Matrices of a ``.npy`` file, of a ``.npz`` file with named dense arrays, or of a SciPy sparse ``.npz`` file.

    Raises ImportFileError.
    """
    if path.suffix.lower() == ".npy":
        with readable(path, "a NumPy .npy file"), open_regular(path) as stream:
            return {"": np.lib.format.read_array(stream, allow_pickle=False)}
    arrays = numpy_arrays(path)
    if not {"format", "shape", "data"} <= arrays.keys():
        return {name: array for name, array in arrays.items() if array.ndim == 2 and array.dtype.kind in "fiuc"}
    with readable(path, "a SciPy sparse matrix"):
        matrix = scipy.sparse.load_npz(path)
        if matrix.format in ("csr", "csc", "bsr"):
            matrix.check_format(full_check=True)  # an index out of range would read other memory
        return {"": matrix.tocsr()}


def matlab_matrices(path: Path) -> Matrices:
    """Numeric matrices, dense and sparse, of a MATLAB ``.mat`` file of any version, without structs and cells.

    Raises ImportFileError.
    """
    from scipy.io import loadmat

    with readable(path, "a MATLAB .mat file"):
        content = read_regular(path)
        start = content[: _MATLAB_HEADER + len(_HDF5_SIGNATURE)]
        if start[_MATLAB_HEADER:] == _HDF5_SIGNATURE or start.startswith(_HDF5_SIGNATURE):
            return _matlab_73(path)
        require_unpackable_zlib(path, len(content), _packed_elements(content))
        matrices = {}
        for name, value in loadmat(io.BytesIO(content)).items():
            if scipy.sparse.issparse(value):
                value = scipy.sparse.csc_matrix(value)
                value.check_format(full_check=True)
                matrices[name] = value
            elif isinstance(value, np.ndarray) and value.ndim == 2 and value.dtype.kind in "fiuc":
                matrices[name] = value
        return matrices


def _packed_elements(content: bytes) -> Iterator[bytes]:
    """The packed elements of a version 5 file: header of 128 bytes, then type, size and data of each element.

    Source: The MathWorks, MAT-File Format, version 5 (2023), data elements.
    """
    order = "<" if content[126:128] == b"IM" else ">"
    at = _MATLAB_5_HEADER
    while at + 8 <= len(content):
        kind, size = struct.unpack_from(f"{order}II", content, at)
        if kind == _MATLAB_PACKED:
            yield content[at + 8 : at + 8 + size]
        at += 8 + size


def _matlab_73(path: Path) -> Matrices:
    """Version 7.3 files are HDF5: a dense matrix is a transposed data set, a sparse one a group of its columns."""
    import h5py

    matrices: Matrices = {}
    with open_hdf5(path) as file:
        for name, item in file.items():
            rows = item.attrs.get("MATLAB_sparse")
            if rows is not None:
                matrices[name] = _sparse_group(item, int(rows))
            elif isinstance(item, h5py.Dataset) and item.ndim == 2 and item.dtype.kind in "fiu":
                matrices[name] = item[()].T
    return matrices


def _sparse_group(group: Any, rows: int) -> Any:
    # A matrix without entries has only its column pointers.
    data = group["data"][()] if "data" in group else np.empty(0)
    index = group["ir"][()].astype(np.int64) if "ir" in group else np.empty(0, dtype=np.int64)
    pointer = group["jc"][()].astype(np.int64)
    matrix = scipy.sparse.csc_matrix((data, index, pointer), shape=(rows, len(pointer) - 1))
    matrix.check_format(full_check=True)
    return matrix
