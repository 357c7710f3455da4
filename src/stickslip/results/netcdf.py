"""NetCDF-4 files as bytes in memory: plain Python writes them, because HDF5 ends the process if a disk is full."""

from __future__ import annotations

import io
import zlib
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

# The fastest level saves a third to a half of the size of arrays, and the checksum detects a changed byte on reading.
# It does so for numbers only; the attribute TEXT_CHECKSUM does so for texts.
COMPRESSED: Mapping[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True, "fletcher32": True}

TEXT_CHECKSUM = "crc32"


def text_checksum(text: str) -> int:
    """The checksum of a text in a file, of its bytes in UTF-8."""
    return zlib.crc32(text.encode())


def netcdf_bytes(groups: Iterable[tuple[str, xarray.Dataset]], storage: Mapping[str, Any] | None = None) -> bytes:
    """The bytes of a NetCDF-4 file with these groups, ("", dataset) being the root.

    ``storage`` are options of h5py for arrays of numbers: ``COMPRESSED``, by default none.
    """
    import h5netcdf

    stream = io.BytesIO()
    with h5netcdf.File(stream, "w") as file:
        for name, dataset in groups:
            _write(file.create_group(name) if name else file, dataset, storage or {})
    return stream.getvalue()


def _write(group: Any, dataset: xarray.Dataset, storage: Mapping[str, Any]) -> None:
    group.dimensions = {str(name): int(size) for name, size in dataset.sizes.items()}
    for label, value in dataset.attrs.items():
        group.attrs[label] = value
    for name, array in dataset.variables.items():
        values = _storable(np.asarray(array.values))
        options = storage if values.ndim and values.dtype.kind in "fiu" else {}
        variable = group.create_variable(str(name), tuple(map(str, array.dims)), data=values, **options)
        for label, value in array.attrs.items():
            variable.attrs[label] = value
        if not values.ndim and isinstance(values.item(), str):
            variable.attrs[TEXT_CHECKSUM] = text_checksum(values.item())


def _storable(values: Any) -> Any:
    import h5py

    return values.astype(h5py.string_dtype()) if values.dtype.kind in "OU" else values
