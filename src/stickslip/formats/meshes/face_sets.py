"""Face sets of a model file: element sides by number, free sides of elements, or surface cells on solids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.formats.meshes.raw_model import RawModel, RawSides
from stickslip.structure.cell_kinds import CELL_KINDS, CORNERS_OF_SIDE, IntArray, all_sides, single_sides
from stickslip.structure.mesh import CellBlock

Sides = tuple[IntArray, ...]


@dataclass(frozen=True)
class _Entries:
    """Entries of a face set of one kind: the same side of elements (k,), or all their free sides, or corners (k, c).

    ``lines`` (k,) are those of the file. A file may have one line for each side, so all are looked up at once.
    """

    side: int | None
    elements: IntArray | None
    corners: IntArray | None
    lines: IntArray


def _merge_entries(entries: Sequence[RawSides]) -> list[_Entries]:
    """The entries of a face set by their kind."""
    groups: dict[tuple[int | None, int], list[RawSides]] = {}
    for entry in entries:
        width = 0 if entry.corners is None else entry.corners.shape[1]
        groups.setdefault((entry.side, width), []).append(entry)
    answer = []
    for (side, _), group in groups.items():
        elements = [entry.elements for entry in group if entry.elements is not None]
        corners = [entry.corners for entry in group if entry.corners is not None]
        lines = np.repeat([entry.line for entry in group], [len(part) for part in elements or corners])
        answer.append(
            _Entries(
                side, np.concatenate(elements) if elements else None, np.vstack(corners) if corners else None, lines
            )
        )
    return answer


class _RowNumbers:
    """A number for each distinct row of whole numbers (m, c), found for other rows by bisection, column by column."""

    def __init__(self, rows: IntArray) -> None:
        self._factor = int(rows.max(initial=0)) + 1
        self._levels: list[IntArray] = []
        self.number = rows[:, 0]  # (m,) of each row
        for column in rows[:, 1:].T:
            level, self.number = np.unique(self.number * self._factor + column, return_inverse=True)
            self._levels.append(level)

    def of(self, rows: IntArray) -> IntArray:
        """Number (k,) of each of other rows (k, c), -1 for a row that is not there."""
        number = rows[:, 0]
        for level, column in zip(self._levels, rows[:, 1:].T, strict=True):
            # an entry above all of the table, or -1, must not match another row
            valid = (number >= 0) & (column >= 0) & (column < self._factor)
            key = number * self._factor + column
            place = np.searchsorted(level, key).clip(max=max(len(level) - 1, 0))
            number = np.where(valid & (level[place] == key), place, -1) if len(level) else np.full(len(rows), -1)
        return number


class _Sides:
    """Every side of every cell, one table for each number of nodes of a side, with the cell and its free flag."""

    def __init__(self, blocks: tuple[CellBlock, ...]) -> None:
        tables = all_sides([(block.kind, block.cells) for block in blocks])
        self.nodes = [nodes for nodes, _ in tables]
        self.cell = [cell for _, cell in tables]
        self.free = single_sides(self.nodes)
        self._rows = [_RowNumbers(np.sort(nodes[:, : CORNERS_OF_SIDE[nodes.shape[1]]], axis=1)) for nodes in self.nodes]

    def of_cells(self, wanted: IntArray) -> list[IntArray]:
        """Positions in each table of the free sides of cells."""
        return [np.flatnonzero(free & np.isin(cell, wanted)) for cell, free in zip(self.cell, self.free, strict=True)]

    def with_corners(self, corners: IntArray) -> tuple[list[IntArray], IntArray]:
        """Positions in each table of the sides with these corners (k, 3 | 4), and which (k,) no cell has."""
        wanted = np.sort(corners, axis=1)
        present = np.zeros(len(corners), dtype=bool)
        positions = []
        for nodes, rows in zip(self.nodes, self._rows, strict=True):
            if CORNERS_OF_SIDE[nodes.shape[1]] != corners.shape[1]:
                positions.append(np.empty(0, dtype=np.int64))
                continue
            number = rows.of(wanted)
            present |= number >= 0
            chosen = np.zeros(len(nodes) + 1, dtype=bool)
            chosen[number[number >= 0]] = True
            positions.append(np.flatnonzero(chosen[rows.number]))
        return positions, ~present


def build_face_sets(
    raw: RawModel,
    node_labels: IntArray,
    element_labels: IntArray,
    blocks: tuple[CellBlock, ...],
    messages: list[str],
) -> tuple[dict[str, Sides], dict[str, IntArray]]:
    """Face sets by node number, and the nodes of each.

    A face set with a side inside the solid (of two cells) is dropped with a message: there can be no contact. Raises
    ImportFileError for an empty set and for sides that no element has.
    """
    if not raw.face_sets:
        return {}, {}
    table = _Sides(blocks)
    faces, nodes = {}, {}
    for name, entries in raw.face_sets.items():
        chosen = [np.zeros(len(each), dtype=bool) for each in table.nodes]
        for entry in _merge_entries(entries):
            for flags, positions in zip(
                chosen, _positions(raw, name, entry, table, node_labels, element_labels, blocks), strict=True
            ):
                flags[positions] = True
        if not any(flags.any() for flags in chosen):
            raw.fail(f"surface '{name}' is empty. Give it sides of solid elements.", raw.set_lines.get(name, 0))
        sides = tuple(each[flags] for each, flags in zip(table.nodes, chosen, strict=True) if flags.any())
        nodes[name] = np.unique(np.concatenate([side.ravel() for side in sides]))
        inner = sum(int((flags & ~free).sum()) for flags, free in zip(chosen, table.free, strict=True))
        if inner:
            messages.append(
                f"surface '{name}' becomes a node set only: {inner} of its sides are inside the solid, between two "
                "elements that share their nodes. A contact face requires separate nodes on each side."
            )
        else:
            faces[name] = sides
    return faces, nodes


def _positions(
    raw: RawModel,
    name: str,
    entry: _Entries,
    table: _Sides,
    node_labels: IntArray,
    element_labels: IntArray,
    blocks: tuple[CellBlock, ...],
) -> list[IntArray]:
    """Positions in each table of the sides that entries of one kind name."""
    if entry.corners is not None:
        return _by_corners(raw, name, entry, entry.corners, table, node_labels)
    assert entry.elements is not None
    missing = np.flatnonzero(~np.isin(entry.elements, element_labels))
    if missing.size:
        raw.fail(
            f"surface '{name}' names element {raw.shown(entry.elements[missing[0]])}, which is not a solid element of "
            "the file.",
            int(entry.lines[missing[0]]),
        )
    cells = np.flatnonzero(np.isin(element_labels, entry.elements))
    if entry.side is None:
        return table.of_cells(cells)
    corners: dict[int, list[IntArray]] = {3: [], 4: []}
    first = 0
    for block in blocks:
        kind = CELL_KINDS[block.kind]
        mine = cells[(cells >= first) & (cells < first + len(block.cells))] - first
        if mine.size:
            if entry.side >= len(kind.sides):
                label = element_labels[first + mine[0]]
                raw.fail(
                    f"surface '{name}' names side S{entry.side + 1} of element {raw.shown(label)}, but a {block.kind} "
                    f"has sides S1 to S{len(kind.sides)}.",
                    int(entry.lines[entry.elements == label][0]),
                )
            side = kind.sides[entry.side]
            corners[CORNERS_OF_SIDE[len(side)]].append(block.cells[mine][:, side[: CORNERS_OF_SIDE[len(side)]]])
        first += len(block.cells)
    answer = [np.empty(0, dtype=np.int64) for _ in table.nodes]
    for group in corners.values():
        if group:
            positions, _ = table.with_corners(np.concatenate(group))
            # of the two sides inside a solid only that of the named element
            answer = [
                np.concatenate([before, new[np.isin(cell[new], cells)]])
                for before, new, cell in zip(answer, positions, table.cell, strict=True)
            ]
    return answer


def _by_corners(
    raw: RawModel, name: str, entry: _Entries, corners: IntArray, table: _Sides, node_labels: IntArray
) -> list[IntArray]:
    order = np.argsort(node_labels)
    place = order[np.searchsorted(node_labels, corners, sorter=order).clip(max=len(order) - 1)]
    off = (node_labels[place] != corners).any(axis=1)
    positions, unmatched = table.with_corners(np.where(off[:, None], -1, place))
    if unmatched.any():
        at = int(np.flatnonzero(unmatched)[0])
        raw.fail(
            f"surface '{name}' has a side with nodes {', '.join(raw.shown(node) for node in corners[at])}, which is "
            f"not a side of a solid element ({int(unmatched.sum())} of {len(corners)} sides are not).",
            int(entry.lines[at]),
        )
    return positions
