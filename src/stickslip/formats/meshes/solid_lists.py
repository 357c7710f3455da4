"""Solid elements that a reader collects one by one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stickslip.formats.meshes.raw_model import RawBlock
from stickslip.structure.cell_kinds import IntArray


class SolidLists:
    """Solid elements by kind, in the order of the file."""

    def __init__(self) -> None:
        self._rows: dict[str, list[tuple[int, list[int], int]]] = {}

    def add(self, kind: str, label: int, cell: list[int], line: int) -> None:
        """One element: its nodes in VTK order."""
        self._rows.setdefault(kind, []).append((label, cell, line))

    def labels(self) -> IntArray:
        """Of all elements."""
        return np.array([label for rows in self._rows.values() for label, _, _ in rows], dtype=np.int64)

    def blocks(self) -> Iterator[RawBlock]:
        """The elements of each kind."""
        for kind, rows in self._rows.items():
            labels, cells, lines = (np.array(column, dtype=np.int64) for column in zip(*rows, strict=True))
            yield RawBlock(kind, labels, cells, lines)
