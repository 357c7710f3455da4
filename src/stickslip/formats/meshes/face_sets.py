"""Face sets of a model file: element sides by number, free sides of elements, or surface cells on solids."""

from __future__ import annotations

import numpy as np

from stickslip.formats.meshes.raw_model import RawModel, RawSides
from stickslip.structure.cell_kinds import CELL_KINDS, CORNERS_OF_SIDE, IntArray, all_sides, single_sides
from stickslip.structure.finite_element_mesh import CellBlock

Sides = tuple[IntArray, ...]


class _Sides:
    """Every side of every cell, one table for each number of nodes of a side, with the cell and its free flag."""

    def __init__(self, blocks: tuple[CellBlock, ...]) -> None:
        tables = all_sides([(block.kind, block.cells) for block in blocks])
        self.nodes = [nodes for nodes, _ in tables]
        self.cell = [cell for _, cell in tables]
        self.free = single_sides(self.nodes)

    def of_cells(self, wanted: IntArray) -> list[IntArray]:
        """Positions in each table of the free sides of cells."""
        return [np.flatnonzero(free & np.isin(cell, wanted)) for cell, free in zip(self.cell, self.free, strict=True)]

    def with_corners(self, corners: IntArray) -> tuple[list[IntArray], IntArray]:
        """Positions in each table of the sides with these corners (k, 3 | 4), and which (k,) no cell has."""
        wanted = np.sort(corners, axis=1)
        known = np.zeros(len(corners), dtype=bool)
        found = []
        for nodes in self.nodes:
            if CORNERS_OF_SIDE[nodes.shape[1]] != corners.shape[1]:
                found.append(np.empty(0, dtype=np.int64))
                continue
            mine = np.sort(nodes[:, : corners.shape[1]], axis=1)
            _, position = np.unique(np.vstack([mine, wanted]), axis=0, return_inverse=True)
            position = position.ravel()
            known |= np.isin(position[len(mine) :], position[: len(mine)])
            found.append(np.flatnonzero(np.isin(position[: len(mine)], position[len(mine) :])))
        return found, ~known


def build_face_sets(
    raw: RawModel,
    node_labels: IntArray,
    element_labels: IntArray,
    blocks: tuple[CellBlock, ...],
    messages: list[str],
) -> tuple[dict[str, Sides], dict[str, IntArray]]:
    """Face sets by node number, and the nodes of each.

    A face set with a side inside the solid (two cells have it) is left out with a message: no contact can be there.
    Raises ImportFileError for an empty set and for sides that no element has.
    """
    if not raw.face_sets:
        return {}, {}
    table = _Sides(blocks)
    faces, nodes = {}, {}
    for name, entries in raw.face_sets.items():
        chosen = [np.zeros(len(each), dtype=bool) for each in table.nodes]
        for entry in entries:
            for flags, found in zip(
                chosen, _positions(raw, name, entry, table, node_labels, element_labels, blocks), strict=True
            ):
                flags[found] = True
        if not any(flags.any() for flags in chosen):
            raw.fail(f"surface '{name}' is empty. Give it sides of solid elements.", raw.set_lines.get(name, 0))
        sides = tuple(each[flags] for each, flags in zip(table.nodes, chosen, strict=True) if flags.any())
        nodes[name] = np.unique(np.concatenate([side.ravel() for side in sides]))
        inner = sum(int((flags & ~free).sum()) for flags, free in zip(chosen, table.free, strict=True))
        if inner:
            messages.append(
                f"surface '{name}' is kept as a node set only: {inner} of its sides lie inside the solid, between two "
                "elements that share their nodes. A contact face needs nodes of its own on each side."
            )
        else:
            faces[name] = sides
    return faces, nodes


def _positions(
    raw: RawModel,
    name: str,
    entry: RawSides,
    table: _Sides,
    node_labels: IntArray,
    element_labels: IntArray,
    blocks: tuple[CellBlock, ...],
) -> list[IntArray]:
    """Positions in each table of the sides that one entry of a face set names."""
    if entry.corners is not None:
        return _by_corners(raw, name, entry, entry.corners, table, node_labels)
    assert entry.elements is not None
    missing = np.setdiff1d(entry.elements, element_labels)
    if missing.size:
        raw.fail(
            f"surface '{name}' names element {raw.shown(missing[0])}, which is no solid element of the file.",
            entry.line,
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
                raw.fail(
                    f"surface '{name}' names side S{entry.side + 1} of element "
                    f"{raw.shown(element_labels[first + mine[0]])}, but a {block.kind} has sides S1 to "
                    f"S{len(kind.sides)}.",
                    entry.line,
                )
            side = kind.sides[entry.side]
            corners[CORNERS_OF_SIDE[len(side)]].append(block.cells[mine][:, side[: CORNERS_OF_SIDE[len(side)]]])
        first += len(block.cells)
    answer = [np.empty(0, dtype=np.int64) for _ in table.nodes]
    for group in corners.values():
        if group:
            found, _ = table.with_corners(np.concatenate(group))
            # of the two sides inside a solid only that of the named element
            answer = [
                np.concatenate([before, new[np.isin(cell[new], cells)]])
                for before, new, cell in zip(answer, found, table.cell, strict=True)
            ]
    return answer


def _by_corners(
    raw: RawModel, name: str, entry: RawSides, corners: IntArray, table: _Sides, node_labels: IntArray
) -> list[IntArray]:
    order = np.argsort(node_labels)
    place = order[np.searchsorted(node_labels, corners, sorter=order).clip(max=len(order) - 1)]
    off = (node_labels[place] != corners).any(axis=1)
    found, lone = table.with_corners(np.where(off[:, None], -1, place))
    if lone.any():
        at = int(np.flatnonzero(lone)[0])
        raw.fail(
            f"surface '{name}' has a side with nodes {', '.join(raw.shown(node) for node in corners[at])}, which is no "
            f"side of a solid element ({int(lone.sum())} of {len(corners)} sides are not).",
            entry.line,
        )
    return found
