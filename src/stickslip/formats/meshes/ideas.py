"""I-DEAS universal files (.unv): nodes, solid elements, surface elements and groups.

Data sets: 15, 781, 2411 (nodes), 780, 2412 (elements), 2417 to 2477 (groups), 2420 (coordinate systems). A body is a
group of solids if groups divide all solids among them, else a number of a material. A group of surface elements is a
face set, another group an element set or a node set. The files contain no materials that stickslip reads.

Source: SDRC I-DEAS universal data sets (documentation of the University of Cincinnati).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NoReturn

import numpy as np

from stickslip.formats.meshes.raw_model import RawBody, RawModel, RawSides, read_text
from stickslip.formats.meshes.solid_lists import SolidLists
from stickslip.formats.meshes.words import as_label, as_number

# Positions of the nodes of a solid in VTK order: parabolic elements name corners and middles round each face in turn.
_SOLIDS: dict[int, tuple[str, list[int]]] = {
    111: ("tetra", list(range(4))),
    112: ("wedge", list(range(6))),
    113: ("wedge15", [0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8]),
    115: ("hexahedron", list(range(8))),
    116: ("hexahedron20", [0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11]),
    118: ("tetra10", [0, 2, 4, 9, 1, 3, 5, 6, 7, 8]),
}
# Plane stress, plane strain, plate, membrane, axisymmetric and thin shell: linear and parabolic, 3 and 4 sides.
_SURFACES = {
    **{10 * kind + 1: [0, 1, 2] for kind in (4, 5, 6, 7, 8, 9)},
    **{10 * kind + 2: [0, 2, 4] for kind in (4, 5, 6, 7, 8, 9)},
    **{10 * kind + 4: [0, 1, 2, 3] for kind in (4, 5, 6, 7, 8, 9)},
    **{10 * kind + 5: [0, 2, 4, 6] for kind in (4, 5, 6, 7, 8, 9)},
}
_BEAMS = (11, 21, 22, 23, 24)  # with a third line
_NODE, _ELEMENT = 7, 8  # kinds of members of groups
_SHORT_GROUPS = (2417, 2429, 2430, 2432)  # four members in a line; the later ones have two
_LONG_GROUPS = (2435, 2452, 2467, 2477)
_SILENT = (151, 164, 2400)
Lines = list[tuple[int, list[str]]]


def read_ideas(source: Path) -> RawModel:
    """The entries of a universal file in its own units. Raises ImportFileError that names file and line."""
    reader = _Reader(source)
    for number, line, rows in _data_sets(reader.raw):
        reader.take(number, line, rows)
    return reader.finished()


def _data_sets(raw: RawModel) -> Iterator[tuple[int, int, Lines]]:
    """Number, line and lines of each data set, which is between two lines with -1."""
    rows: Lines | None = None
    start = 0
    for at, line in enumerate(read_text(raw.source), start=1):
        words = line.split()
        if words == ["-1"]:
            if rows:
                yield as_label(raw.fail, rows[0][1][0], rows[0][0]), rows[0][0], rows[1:]
            rows, start = ([], at) if rows is None else (None, 0)
        elif rows is not None and (words or rows):
            rows.append((at, words))
        elif words:
            raw.fail("the file has text outside of the data sets, which begin and end with -1.", at)
    if rows is not None:
        raw.fail("this data set has no end (-1); the file is truncated.", start)


class _Reader:
    """Reads the data sets one after the other."""

    def __init__(self, source: Path) -> None:
        self.raw = RawModel(source, "I-DEAS universal file")
        self._labels: list[int] = []
        self._coordinates: list[list[float]] = []
        self._lines: list[int] = []
        self._systems: dict[int, int] = {}  # of the coordinates of nodes: number -> line of the first node
        self._turned: set[int] = set()  # systems that are not the global one
        self._solids = SolidLists()
        self._materials: dict[int, list[int]] = {}
        self._surface: dict[int, list[int]] = {}
        self._other: dict[int, list[int]] = {}
        self._groups: list[tuple[str, int, list[tuple[int, int]]]] = []  # name, line, members: kind, number
        self._skipped: dict[int, int] = {}
        self._sets: dict[int, Callable[[Lines], None]] = {
            15: self._nodes_in_lines,
            **dict.fromkeys((781, 2411), self._nodes),
            780: lambda rows: self._elements(rows, 5, 7),
            2412: lambda rows: self._elements(rows, 3, 5),
            **dict.fromkeys(_SHORT_GROUPS, lambda rows: self._group(rows, 2)),
            **dict.fromkeys(_LONG_GROUPS, lambda rows: self._group(rows, 4)),
            2420: self._coordinate_systems,
        }

    def take(self, number: int, line: int, rows: Lines) -> None:
        """Read one data set."""
        if number in self._sets:
            self._sets[number](rows)
        elif number not in _SILENT:
            self._skipped.setdefault(number, line)

    def finished(self) -> RawModel:
        """The raw model after the last data set."""
        raw = self.raw
        for number, line in self._systems.items():
            if number in self._turned:
                raw.fail(
                    f"the coordinates of this node are in the system {number}, which is not the global one. Write them "
                    "in global x, y, z.",
                    line,
                )
        raw.node_labels = np.array(self._labels, dtype=np.int64)
        raw.coordinates = np.array(self._coordinates, dtype=float).reshape(-1, 3)
        raw.node_lines = np.array(self._lines, dtype=np.int64)
        raw.blocks += self._solids.blocks()
        for name, line, members in self._groups:
            self._write_group(name, line, members)
        if raw.blocks:
            self._write_bodies()
        if self._skipped:
            words = ", ".join(f"{number} (line {line})" for number, line in self._skipped.items())
            raw.messages.append(
                f"ignored data sets: {words}. stickslip reads nodes, elements and groups of universal files; give "
                "materials and constraints in the study."
            )
        return raw

    def _write_group(self, name: str, line: int, members: list[tuple[int, int]]) -> None:
        """A group as an element set, a face set or a node set, depending on its members."""
        numbers = np.array([number for kind, number in members if kind == _ELEMENT], dtype=np.int64)
        solids = np.intersect1d(numbers, self._solids.labels())
        sides = [self._surface[number] for number in numbers.tolist() if number in self._surface]
        nodes = [number for kind, number in members if kind == _NODE]
        if solids.size:
            self.raw.element_sets[name] = solids
        for width in sorted({len(side) for side in sides}):
            corners = np.array([side for side in sides if len(side) == width], dtype=np.int64)
            self.raw.face_sets.setdefault(name, []).append(RawSides(line, corners=corners))
        if not sides and not solids.size:
            nodes += [node for number in numbers.tolist() for node in self._other.get(number, [])]
            missing = np.setdiff1d(nodes, self._labels)
            if missing.size:
                self.raw.fail(f"group '{name}' names node {missing[0]}, which the file does not define.", line)
            if nodes:
                self.raw.node_sets[name] = np.unique(np.array(nodes, dtype=np.int64))
        self.raw.set_lines.setdefault(name, line)

    def _write_bodies(self) -> None:
        """Bodies from groups that divide the solids among them, else from their materials."""
        solids = np.concatenate([block.labels for block in self.raw.blocks])
        grouped = np.sort(np.concatenate([np.empty(0, dtype=np.int64), *self.raw.element_sets.values()]))
        if np.array_equal(grouped, np.sort(solids)):
            self.raw.bodies += [RawBody(name, each, None, 0) for name, each in self.raw.element_sets.items()]
            return
        self.raw.bodies += [
            RawBody(f"material {number}", np.array(labels, dtype=np.int64), None, 0)
            for number, labels in self._materials.items()
        ]

    def _fail_short(self, line: int) -> NoReturn:
        self.raw.fail("the data set ends inside an entry, or a line has too few numbers.", line)

    def _whole(self, words: list[str], position: int, line: int) -> int:
        if position >= len(words):
            self._fail_short(line)
        try:
            return int(words[position])
        except ValueError:
            self.raw.fail(f'"{words[position][:40]}" is not a whole number.', line)

    def _node(self, words: list[str], places: list[str], line: int) -> None:
        if len(places) != 3:
            self._fail_short(line)
        self._labels.append(as_label(self.raw.fail, words[0], line))
        self._coordinates.append([as_number(self.raw.fail, word, line) for word in places])
        self._lines.append(line)
        self._systems.setdefault(self._whole(words, 1, line), line)

    def _nodes(self, rows: Lines) -> None:
        for (line, words), (_, places) in zip(rows[::2], [*rows[1::2], (0, [])], strict=False):
            self._node(words, places, line)

    def _nodes_in_lines(self, rows: Lines) -> None:
        for line, words in rows:
            self._node(words, words[4:], line)

    def _elements(self, rows: Lines, material_at: int, count_at: int) -> None:
        """Elements whose first line has the material and the number of nodes at these positions."""
        entries = iter(rows)
        for line, words in entries:
            kind, material, count = (self._whole(words, at, line) for at in (1, material_at, count_at))
            label = as_label(self.raw.fail, words[0], line)
            if kind in _BEAMS:
                next(entries, None)
            nodes: list[int] = []
            while len(nodes) < count:
                at, more = next(entries, (line, []))
                if not more:
                    self._fail_short(line)
                nodes += [as_label(self.raw.fail, word, at) for word in more]
            self._element(label, kind, material, nodes, line)

    def _element(self, label: int, kind: int, material: int, nodes: list[int], line: int) -> None:
        if kind in _SOLIDS:
            name, order = _SOLIDS[kind]
            if len(nodes) != len(order):
                self.raw.fail(f"element {label} of type {kind} has {len(nodes)} nodes instead of {len(order)}.", line)
            self._solids.add(name, label, [nodes[at] for at in order], line)
            self._materials.setdefault(material, []).append(label)
        elif kind in _SURFACES and max(_SURFACES[kind]) < len(nodes):
            self._surface[label] = [nodes[at] for at in _SURFACES[kind]]
        elif kind in (114, 117):
            self.raw.fail(f"element {label} is cubic (type {kind}); stickslip reads linear and parabolic solids.", line)
        else:
            self._other[label] = nodes
            name = f"of type {kind}"
            self.raw.other_elements[name] = self.raw.other_elements.get(name, 0) + 1

    def _group(self, rows: Lines, width: int) -> None:
        """Groups: a line whose last number counts the members, a line with the name, and members in ``width`` words."""
        at = 0
        while at < len(rows):
            line, words = rows[at]
            count = self._whole(words, 7, line)
            name = " ".join(rows[at + 1][1]) if at + 1 < len(rows) else ""
            at += 2
            members: list[tuple[int, int]] = []
            while len(members) < count:
                if at >= len(rows):
                    self._fail_short(line)
                entry, fields = rows[at]
                at += 1
                pairs = range(0, len(fields), width)
                if not pairs:
                    self._fail_short(entry)
                members += [(self._whole(fields, p, entry), self._whole(fields, p + 1, entry)) for p in pairs]
            self._groups.append((name or f"group {words[0]}", line, members[:count]))

    def _coordinate_systems(self, rows: Lines) -> None:
        """Systems: number and kind, name, and four lines with axes and origin, after two lines with the part."""
        for start in range(2, len(rows) - 5, 6):
            line, words = rows[start]
            number, kind = (self._whole(words, position, line) for position in (0, 1))
            values = [as_number(self.raw.fail, word, at) for at, row in rows[start + 2 : start + 6] for word in row]
            if kind != 0 or values != [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]:
                self._turned.add(number)
