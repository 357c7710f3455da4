"""Coordinate systems of Abaqus and CalculiX decks: *SYSTEM of node coordinates, *TRANSFORM of directions at nodes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.keyword_deck import Card, Find
from stickslip.formats.meshes.nastran_frames import Frame
from stickslip.formats.meshes.raw_model import RawModel
from stickslip.structure.cell_kinds import IntArray


class SystemCards:
    """The current system of coordinates, and the systems of directions of node sets."""

    def __init__(self, raw: RawModel, find: Find) -> None:
        self._raw, self._find = raw, find
        self._current: Frame | None = None
        self._transforms: list[tuple[IntArray, Frame]] = []
        self.cards: dict[str, Callable[[Card], None]] = {"SYSTEM": self._system, "TRANSFORM": self._transform}

    def position(self, coordinates: list[float]) -> list[float]:
        """x, y, z of a node from its coordinates in the current system."""
        if self._current is None:
            return coordinates
        return [float(each) for each in self._current.basic(np.array([coordinates]))[0]]

    def frames(self) -> dict[int, FloatArray]:
        """Directions 1, 2, 3 (3, 3) as rows of each node with a *TRANSFORM, by label; the last one counts."""
        row = {label: at for at, label in enumerate(self._raw.node_labels.tolist())}
        return {
            label: frame.directions(self._raw.coordinates[row[label]])[0]
            for nodes, frame in self._transforms
            for label in nodes.tolist()
            if label in row
        }

    def _system(self, card: Card) -> None:
        """*SYSTEM: without lines x, y, z again; else the origin, a point on axis 1, and one in the plane 1, 2."""
        if card.instance:
            card.fail("a coordinate system inside of a part is not read. Write the nodes in that of the part.")
        values = [card.number(word or "0", line) for line, words in card.data for word in without_end(words)]
        if not any(values):
            self._current = None
        elif len(values) == 3:
            self._current = Frame("rectangular", np.array(values), np.eye(3))
        elif len(values) in (6, 9):
            a, b = np.array(values[:6]).reshape(2, 3)
            c = np.array(values[6:]) if len(values) == 9 else a + np.cross((0.0, 0.0, 1.0), b - a)  # about global z
            self._current = Frame("rectangular", a, axes_of(card, b - a, c - a))
        else:
            card.fail(f"it has {len(values)} numbers; 3 (origin), 6 (and axis 1) or 9 (and plane 1, 2) are required.")

    def _transform(self, card: Card) -> None:
        """*TRANSFORM: directions of a node set, TYPE=R by points on axis 1 and in the plane 1, 2; C by two of the
        axis."""
        kind = card.parameters.get("TYPE", "R").upper()
        values = [card.number(word or "0", line) for line, words in card.data for word in without_end(words)]
        if kind not in ("R", "C") or len(values) != 6:
            card.fail(f"TYPE={kind} with {len(values)} numbers is not read; R and C with 6 numbers are.")
        a, b = np.array(values).reshape(2, 3)
        nodes = self._find(card, "node", card.parameter("NSET"), card.line)
        if kind == "R":
            self._transforms.append((nodes, Frame("rectangular", np.zeros(3), axes_of(card, a, b))))
            return
        across = np.eye(3)[np.abs(b - a).argmin()]
        axes = axes_of(card, b - a, across)  # axis, in the plane with it, across: the axis becomes the third
        self._transforms.append((nodes, Frame("cylindrical", a, np.roll(axes, -1, axis=0))))


def axes_of(card: Card, first: FloatArray, in_plane: FloatArray) -> FloatArray:
    """Axes 1, 2, 3 (3, 3) as rows, axis 1 along ``first``, axis 2 on the side of ``in_plane``.

    Raises ImportFileError for directions on one line.
    """
    third = np.cross(first, in_plane)
    size = float(np.linalg.norm(third))
    if not size > 1e-9 * float(np.linalg.norm(first) * np.linalg.norm(in_plane)):
        card.fail("its points are on one line, so they define no axes.")
    x, z = first / np.linalg.norm(first), third / size
    return np.vstack([x, np.cross(z, x), z])


def without_end(words: list[str]) -> list[str]:
    """The words of a line without the empty one after its last comma."""
    return words[:-1] if words and words[-1] == "" else words
