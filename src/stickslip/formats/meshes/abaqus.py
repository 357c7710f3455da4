"""Abaqus and CalculiX decks (.inp): mesh, sets, surfaces, sections, materials, constraints and nodal forces.

Numbers and names are those of the deck; upper and lower case are equal in names, as in both programs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from stickslip.formats.meshes.abaqus_assembly import flatten
from stickslip.formats.meshes.abaqus_contact import ContactCards
from stickslip.formats.meshes.abaqus_keywords import (
    ELEMENT_TYPES,
    FLUID_NETWORK,
    NOT_SOLID,
    OTHER_FORMULATIONS,
    REFUSED,
    SILENT,
)
from stickslip.formats.meshes.abaqus_loads import LoadCards
from stickslip.formats.meshes.abaqus_materials import MaterialCards
from stickslip.formats.meshes.abaqus_points import POINT_ELEMENTS, PointCards
from stickslip.formats.meshes.abaqus_shells import SHELL_SIDES, omit_shell_sides
from stickslip.formats.meshes.abaqus_systems import SystemCards
from stickslip.formats.meshes.abaqus_ties import TieCards
from stickslip.formats.meshes.directions import basic_constraints, basic_loads
from stickslip.formats.meshes.included_files import IncludedFiles
from stickslip.formats.meshes.keyword_deck import Card, read_cards
from stickslip.formats.meshes.raw_model import (
    RawBlock,
    RawBody,
    RawModel,
    RawSides,
)
from stickslip.structure.cell_kinds import CELL_KINDS, IntArray

_NODE_ENTRIES = 7  # number, x, y, z, and the normal of a shell, which solids do not use; omitted ones are 0

_RANK = {"SYSTEM": 0, "NODE": 0, "ELEMENT": 0, "NSET": 1, "ELSET": 1, "SURFACE": 2}


def read_abaqus(source: Path, includes_outside: bool = False) -> RawModel:
    """The entries of a deck and of the files that it includes, in their own units.

    ``includes_outside``: also from outside of its folder. Raises ImportFileError that names file and line.
    """
    included = IncludedFiles(source, includes_outside)
    with included.hidden_if_foreign():
        deck = flatten(read_cards(source, included))
        reader = _Reader(source)
        reader.raw.label_ranges = deck.ranges
        reader.raw.messages += deck.messages
        # sets may be used above the line that defines them
        for card in sorted(deck.cards, key=lambda card: _RANK.get(card.keyword, len(_RANK))):
            reader.take(card)
        return reader.finished()


class _Reader:
    """Reads the cards one after the other."""

    def __init__(self, source: Path) -> None:
        self.raw = RawModel(source, "Abaqus/CalculiX")
        self._labels: list[int] = []
        self._coordinates: list[list[float]] = []
        self._lines: list[int] = []
        self._names: dict[tuple[str, str], str] = {}  # kind of set and name in capitals -> name as first written
        self._pieces: dict[tuple[str, str], list[IntArray]] = {}
        self._other_labels: list[int] = []
        self._blocks_named: list[tuple[str, str, IntArray, int]] = []  # instance, set, elements, line
        self._sections: list[tuple[Card, RawBody]] = []
        self._skipped: dict[str, int] = {}
        self._reported: set[str] = set()  # element types with another formulation
        self._systems = SystemCards(self.raw, self._find)
        self._materials = MaterialCards(self.raw)
        self._ties = TieCards(self.raw, self._find)
        self._contact = ContactCards(self.raw)
        self._points = PointCards(self.raw, self._find)
        self._loads = LoadCards(self.raw, self._find)
        self._cards: dict[str, Callable[[Card], None]] = {
            "NODE": self._nodes,
            "ELEMENT": self._elements,
            "NSET": lambda card: self._set(card, "node", card.parameter("NSET")),
            "ELSET": lambda card: self._set(card, "element", card.parameter("ELSET")),
            "SURFACE": self._surface,
            "SOLID SECTION": self._section,
            **self._materials.cards,
            **self._systems.cards,
            **self._ties.cards,
            **self._contact.cards,
            **self._points.cards,
            **self._loads.cards,
        }

    def take(self, card: Card) -> None:
        """Read one card."""
        if card.keyword in REFUSED:
            card.fail(f"{REFUSED[card.keyword]}.")
        if "INPUT" in card.parameters:
            card.fail("data in another file (INPUT=) are not read. Put them into this file, or use *INCLUDE.")
        if card.keyword in self._cards:
            self._cards[card.keyword](card)
        elif card.keyword not in SILENT:
            self._skipped.setdefault(card.keyword, card.line)

    def finished(self) -> RawModel:
        """The raw model after the last card."""
        raw = self.raw
        raw.node_labels = np.array(self._labels, dtype=np.int64)
        raw.coordinates = np.array(self._coordinates, dtype=float).reshape(-1, 3)
        raw.node_lines = np.array(self._lines, dtype=np.int64)
        for (what, _), name in self._names.items():
            pieces = self._pieces[what, name.upper()]
            members = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *pieces]))
            (raw.node_sets if what == "node" else raw.element_sets)[name] = members
        self._require_members()
        frames = self._systems.frames()
        raw.constraints, equations = basic_constraints(raw.constraints, frames)
        raw.loads = basic_loads(raw.loads, frames)
        self._ties.write(frames)
        self._contact.write()
        self._points.write(set(frames))
        raw.ties.equations += equations
        omit_shell_sides(raw, np.array(self._other_labels, dtype=np.int64))
        sections = [(card.instance, replace(body, axes=self._materials.axes(card))) for card, body in self._sections]
        raw.bodies = _named_bodies(sections or self._bodies_of_blocks())
        self._loads.report()
        loads = [f"*{keyword}" for keyword in ("DLOAD", "DSLOAD") if self._skipped.pop(keyword, 0)]
        if loads:
            raw.messages.append(
                f"loads of {' and '.join(loads)} are not read: if a solved preload needs them, give [pressures.NAME], "
                "[gravity] or [rotation] in the study."
            )
        if self._skipped:
            words = ", ".join(f"*{keyword} (line {line})" for keyword, line in self._skipped.items())
            raw.messages.append(f"ignored, without effect here: {words}.")
        return raw

    def _bodies_of_blocks(self) -> list[tuple[str, RawBody]]:
        """Bodies of a deck without sections: element sets or instances; none where an element is in neither."""
        by_property: dict[tuple[str, str], list[tuple[IntArray, int]]] = {}
        for instance, name, labels, line in self._blocks_named:
            if not name:
                return []
            by_property.setdefault((instance, name), []).append((labels, line))
        return [
            (instance, RawBody(name, np.concatenate([labels for labels, _ in parts]), None, parts[0][1]))
            for (instance, name), parts in by_property.items()
        ]

    def _require_members(self) -> None:
        """Raise ImportFileError for a set that names a node or an element which the file does not define."""
        elements = np.concatenate([np.array(self._other_labels, dtype=np.int64), *(b.labels for b in self.raw.blocks)])
        for what, sets, defined in (
            ("node", self.raw.node_sets, self.raw.node_labels),
            ("element", self.raw.element_sets, elements),
        ):
            ordered = np.unique(defined)
            for name, members in sets.items():
                missing = np.setdiff1d(members, ordered, assume_unique=True)
                if missing.size:
                    self.raw.fail(
                        f"{what} set '{name}' names {what} {self.raw.shown(missing[0])}, which the file does not "
                        "define.",
                        self.raw.set_lines[name],
                    )

    def _nodes(self, card: Card) -> None:
        if card.parameters.get("SYSTEM", "R").upper() != "R":
            card.fail("cylindrical or spherical coordinates (SYSTEM=) are not read. Write x, y, z.")
        first = len(self._labels)
        for line, words in card.data:
            values = [word for word in words if word] if words[-1] == "" else words
            if not any(values):
                card.fail("the line has no number of a node.", line)
            if len(values) > _NODE_ENTRIES:
                card.fail(
                    f"a node is a number, x, y, z and perhaps a normal, but the line has {len(values)} entries.", line
                )
            self._labels.append(card.label(values[0], line))
            xyz = [card.number(word or "0", line) for word in values[1:4]]
            self._coordinates.append(self._systems.position(xyz + [0.0] * (3 - len(xyz))))
            self._lines.append(line)
        if "NSET" in card.parameters:
            self._add("node", card.parameter("NSET"), np.array(self._labels[first:], dtype=np.int64), card.line)

    def _elements(self, card: Card) -> None:
        name = card.parameter("TYPE").upper()
        solid = ELEMENT_TYPES.get(name)
        if solid is None and name not in NOT_SOLID:
            card.fail(
                f"the element type {name} is unknown. stickslip reads the solid types {', '.join(ELEMENT_TYPES)}; it "
                "ignores shells, membranes, beams and springs."
            )
        width = CELL_KINDS[solid].n_nodes if solid else NOT_SOLID[name]
        rows, lines = self._rows(card, width + 1, may_be_open=name == FLUID_NETWORK)
        labels = np.array([row[0] for row in rows], dtype=np.int64)
        elset = card.parameters.get("ELSET", "")
        if elset:
            self._add("element", elset, labels, card.line)
        if solid is None:
            self._other_labels += labels.tolist()
            if name in POINT_ELEMENTS:
                self._points.add(rows)
                return
            self.raw.other_elements[name] = self.raw.other_elements.get(name, 0) + len(labels)
            if name == "DCOUP3D":
                self.raw.point_elements |= {row[0]: row[1] for row in rows}
                return
            self.raw.messages.append(f"line {card.line}: {len(labels)} elements {name} have no volume; ignored.")
            return
        if not rows:
            card.fail("there are no elements below.")
        cells = np.array([row[1:] for row in rows], dtype=np.int64)
        self.raw.blocks.append(RawBlock(solid, labels, cells, np.array(lines, dtype=np.int64)))
        self._blocks_named.append((card.instance, elset or card.instance, labels, card.line))
        if name in OTHER_FORMULATIONS:
            if name not in self._reported:
                self.raw.messages.append(f"elements {name} have the formulation of stickslip for a {solid}.")
            self._reported.add(name)

    def _rows(self, card: Card, width: int, may_be_open: bool = False) -> tuple[list[list[int]], list[int]]:
        """Rows of ``width`` numbers, which may continue over several lines, and the line at which each starts.

        With ``may_be_open`` a node may be 0: none.
        """
        rows: list[list[int]] = []
        lines: list[int] = []
        row: list[int] = []
        for line, words in card.data:
            if not row:
                lines.append(line)
            row += [0 if may_be_open and word == "0" else card.label(word, line) for word in words if word]
            if len(row) > width:
                card.fail(f"an element of this type has {width - 1} nodes, but {len(row) - 1} are given.", line)
            if len(row) == width:
                rows.append(row)
                row = []
        if row:
            card.fail(f"the last element has {len(row) - 1} of {width - 1} nodes.", lines[-1])
        return rows, lines

    def _add(self, what: str, name: str, members: IntArray, line: int) -> None:
        """Add members to a set, or make it."""
        key = (what, name.upper())
        self._names.setdefault(key, name)
        self._pieces.setdefault(key, []).append(members)
        self.raw.set_lines.setdefault(self._names[key], line)

    def _find(self, card: Card, what: str, word: str, line: int) -> IntArray:
        """Labels of a set by its name, or of the node or element with the number ``word``."""
        key = (what, word.upper().strip('"'))
        if key in self._pieces:
            # joined once, even if many lines name the set, and without repeated members of sets that contain each other
            self._pieces[key] = [np.unique(np.concatenate(self._pieces[key]))]
            return self._pieces[key][0]
        if not word[:1].isdigit():
            where = "above this line" if card.keyword in ("NSET", "ELSET") else "in the deck"
            card.fail(f"there is no {what} set '{word[:60]}' {where}.", line)
        return np.array([card.label(word, line)], dtype=np.int64)

    def _set(self, card: Card, what: str, name: str) -> None:
        pieces = [np.empty(0, dtype=np.int64)]
        if what == "node" and "ELSET" in card.parameters:
            elements = self._find(card, "element", card.parameter("ELSET"), card.line)
            pieces += [block.cells[np.isin(block.labels, elements)].ravel() for block in self.raw.blocks]
        if "GENERATE" in card.parameters:
            pieces.append(self._generated(card, what))
        else:
            entries: dict[str, int] = {}
            for line, words in card.data:
                for word in words:
                    entries.setdefault(word, line)
            pieces += [self._find(card, what, word, line) for word, line in entries.items() if word]
        members = np.concatenate(pieces)
        if not members.size:
            card.fail(f"{what} set '{name}' is empty. Give it members, or remove it.")
        self._add(what, name, members, card.line)

    def _generated(self, card: Card, what: str) -> IntArray:
        """Of every line the labels first, first + step, ... last that exist."""
        existing = np.sort(
            np.array(self._labels, dtype=np.int64)
            if what == "node"
            else np.concatenate(
                [np.array(self._other_labels, dtype=np.int64), *(block.labels for block in self.raw.blocks)]
            )
        )
        chosen = np.zeros(existing.size, dtype=bool)
        for line, words in card.data:
            limits = [card.label(word, line) for word in words if word]
            if len(limits) not in (2, 3) or limits[1] < limits[0]:
                card.fail("GENERATE requires the first and the last number, and a step above 0.", line)
            step = limits[2] if len(limits) == 3 else 1
            inside = slice(*np.searchsorted(existing, [limits[0], limits[1] + 1]))
            chosen[inside] |= (existing[inside] - limits[0]) % step == 0
        return np.asarray(existing[chosen])

    def _surface(self, card: Card) -> None:
        name = card.parameter("NAME")
        kind = card.parameters.get("TYPE", "ELEMENT").upper()
        if kind not in ("ELEMENT", "NODE"):
            card.fail(f"surfaces of TYPE={kind} are not read; ELEMENT and NODE are.")
        entries = []
        for line, words in card.data:
            if kind == "NODE":
                self._add("node", name, self._find(card, "node", words[0], line), card.line)
                self.raw.node_surfaces.add(self._names["node", name.upper()])
                continue
            elements = self._find(card, "element", words[0], line)
            word = words[1].upper() if len(words) > 1 else ""
            if word in SHELL_SIDES and np.isin(elements, self._other_labels).all():
                entries.append(RawSides(line, elements=elements))
                continue
            if word and not (word[:1] == "S" and word[1:] in {"1", "2", "3", "4", "5", "6"}):
                card.fail(f'"{word[:20]}" is not a side of a solid element; they are S1 to S6.', line)
            entries.append(RawSides(line, elements=elements, side=int(word[1:]) - 1 if word else None))
        if kind == "ELEMENT":
            if not entries:
                card.fail(f"surface '{name}' is empty. Give it sides of solid elements, or remove it.")
            if name in self.raw.face_sets:
                card.fail(f"surface '{name}' is defined twice.")
            self.raw.face_sets[name] = entries
            self.raw.set_lines.setdefault(name, card.line)

    def _section(self, card: Card) -> None:
        name = card.parameter("ELSET")
        elements = self._find(card, "element", name, card.line)
        material = card.parameter("MATERIAL").upper()
        if ("element", name.upper()) not in self._names:
            card.fail(f"ELSET={name} is a number; a section requires the name of an element set. Give one.")
        body = RawBody(self._names["element", name.upper()], elements, material, card.line)
        self._sections.append((card, body))


def _named_bodies(bodies: list[tuple[str, RawBody]]) -> list[RawBody]:
    """Bodies with the name of their instance where it has one body, else with that of their set, INSTANCE.SET."""
    sets = {body.name.upper() for _, body in bodies}
    count = Counter(instance for instance, _ in bodies)
    return [
        replace(body, name=instance) if instance and count[instance] == 1 and instance.upper() not in sets else body
        for instance, body in bodies
    ]
