"""Check of the node numbers of Gmsh 4.1 files, before meshio makes a table as long as the largest of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.structure.importers.raw_model import fail

_LARGEST_TAG = 10_000_000  # meshio's table then takes 80 MB
_VERSIONS = ([b"2"], [b"2.2"], [b"4.0"], [b"4"], [b"4.1"])
_DAMAGED = "the file is damaged or cut off: its $Nodes section does not hold what it announces. Write it again."


def require_node_numbers(source: Path) -> None:
    """Raise ImportFileError where the nodes of a 4.1 file are not those that it announces, or have huge numbers."""
    try:
        content = source.read_bytes()
    except OSError as error:
        fail(source, f"the file cannot be read ({error.strerror}). Give the path of a model file.")
    words = content[: content.find(b"\n", content.find(b"\n") + 1) + 1].split()
    if words[:1] != [b"$MeshFormat"] or words[1:2] not in _VERSIONS or words[2:] not in ([b"0", b"8"], [b"1", b"8"]):
        fail(source, "the first two lines are not those of a Gmsh file of version 2.2, 4.0 or 4.1.")
    content = content.replace(b"\r\n", b"\n") if words[2] == b"0" else content
    start, end = content.find(b"$Nodes\n"), content.find(b"$EndNodes")
    if start < 0 or end < start or content.find(b"$Nodes\n", start + 1) > 0:
        fail(source, _DAMAGED)
    if words[1] not in (b"4", b"4.1"):
        return  # other versions have no such table
    section = content[start + len(b"$Nodes\n") : end]
    numbers = _Binary(section) if words[2] == b"1" else _Text(section)
    try:
        n_blocks, missing, _, _ = numbers.take(4, "u8").tolist()
        for _ in range(n_blocks):
            numbers.take(3, "i4")
            (count,) = numbers.take(1, "u8").tolist()
            tags = numbers.take(count, "u8")
            smallest, largest = int(tags.min(initial=1)), int(tags.max(initial=1))
            missing -= count
            numbers.take(3 * count, "f8")
            if largest > _LARGEST_TAG:
                fail(source, f"there is a node {largest}; numbers up to {_LARGEST_TAG} are read. Renumber the nodes.")
            if smallest < 1:
                raise ValueError("node 0")
    except (ValueError, OverflowError):
        fail(source, _DAMAGED)
    if missing:
        fail(source, _DAMAGED)


class _Binary:
    """Numbers of a binary section, one after the other."""

    def __init__(self, content: bytes) -> None:
        self._content, self._at = content, 0

    def take(self, count: int, kind: str) -> NDArray[Any]:
        """The next numbers; raises ValueError beyond the end."""
        size = count * np.dtype(kind).itemsize
        if size > len(self._content) - self._at:
            raise ValueError("too short")
        values: NDArray[Any] = np.frombuffer(self._content, kind, count, self._at)
        self._at += size
        return values


class _Text:
    """Numbers of a text section, one after the other."""

    def __init__(self, content: bytes) -> None:
        self._words, self._at = content.split(), 0

    def take(self, count: int, kind: str) -> NDArray[Any]:
        """The next numbers; raises ValueError beyond the end and for other words."""
        if not 0 <= count <= len(self._words) - self._at:
            raise ValueError("too short")
        words = self._words[self._at : self._at + count]
        self._at += count
        return np.array([float(word) if kind == "f8" else int(word) for word in words], dtype=kind)
