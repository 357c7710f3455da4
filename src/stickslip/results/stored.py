"""Reader of the groups of a results file: it checks all content, and reports what is wrong in a damaged or foreign
file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from stickslip.core.validation import FloatArray
from stickslip.results.netcdf import TEXT_CHECKSUM, text_checksum

# Squares of larger numbers overflow; displacements, forces and energies are far smaller.
LARGEST_NUMBER = 1e100
# Deflate makes at most 1032 bytes of one.
LARGEST_EXPANSION = 1100


class UnreadableError(Exception):
    """The content of a results file is wrong; the text is the end of a sentence."""


@dataclass(frozen=True)
class StoredGroup:
    """One group of an open results file; ``most_bytes`` is the largest variable in a file of its size."""

    group: h5py.Group
    most_bytes: int

    def __contains__(self, name: str) -> bool:
        return name in self.group

    @property
    def title(self) -> str:
        """Title of the dataset in the group, "" without one."""
        return str(self.group.attrs.get("title", ""))

    def subgroup(self, name: str) -> StoredGroup:
        """A group within."""
        item = self._item(name)
        if not isinstance(item, h5py.Group):
            raise UnreadableError(f'"{name}" is not a group')
        return StoredGroup(item, self.most_bytes)

    def numbers(self, name: str) -> FloatArray:
        """A variable as an array of floats of any shape."""
        array = self._array(name, "fiu").astype(float)
        if not np.isfinite(array).all() or np.abs(array).max(initial=0.0) > LARGEST_NUMBER:
            raise UnreadableError(
                f'the variable "{name}" contains values that are not finite or above {LARGEST_NUMBER:g}'
            )
        return np.asarray(array)

    def integers(self, name: str) -> NDArray[np.int64]:
        """A variable of whole numbers as an array of any shape."""
        return self._array(name, "iu").astype(np.int64)

    def text(self, name: str) -> str:
        """A variable that is one text, compared with its checksum; files of older versions have none."""
        dataset = self._dataset(name)
        if dataset.shape != () or h5py.check_string_dtype(dataset.dtype) is None:
            raise UnreadableError(f'the variable "{name}" is not a text')
        try:
            text = str(dataset.asstr()[()])
        except UnicodeDecodeError as error:
            raise UnreadableError(f'the text "{name}" is not UTF-8') from error
        if dataset.attrs.get(TEXT_CHECKSUM, checksum := text_checksum(text)) != checksum:
            raise UnreadableError(f'the text "{name}" differs from its checksum')
        return text

    def parsed(self, name: str, kind: Any) -> Any:
        """A variable that is JSON, checked to be of a type such as ``list[str]``."""
        try:
            return TypeAdapter(kind).validate_json(self.text(name), strict=True)
        except ValidationError as error:
            raise UnreadableError(f'the text "{name}" does not have the expected content') from error

    def whole_number(self, name: str, least: int, most: int) -> int:
        """An attribute that is one whole number from ``least`` to ``most``."""
        if name not in self.group.attrs:
            raise UnreadableError(f'the attribute "{name}" is missing')
        value = np.asarray(self.group.attrs[name])
        if value.size != 1 or value.dtype.kind not in "iu" or not least <= int(value.item()) <= most:
            raise UnreadableError(f'the attribute "{name}" is not one whole number from {least} to {most}')
        return int(value.item())

    def _array(self, name: str, kinds: str) -> NDArray[Any]:
        dataset = self._dataset(name)
        if dataset.shape is None or dataset.dtype.kind not in kinds:
            raise UnreadableError(f'the variable "{name}" does not contain numbers of the kind that a run writes')
        if dataset.size * dataset.dtype.itemsize > self.most_bytes:
            raise UnreadableError(f'the variable "{name}" has a declared size above that of the file')
        return np.asarray(dataset[()])

    def _dataset(self, name: str) -> h5py.Dataset:
        item = self._item(name)
        if not isinstance(item, h5py.Dataset):
            raise UnreadableError(f'"{name}" is not a variable')
        if item.external or item.is_virtual:
            raise UnreadableError(f'the variable "{name}" refers to another file, which is not read')
        return item

    def _item(self, name: str) -> Any:
        link = self.group.get(name, getlink=True)
        if link is None:
            raise UnreadableError(f'"{name}" is missing')
        if not isinstance(link, h5py.HardLink):
            raise UnreadableError(f'"{name}" is a link to another location, which is not followed')
        return self.group[name]
