"""Nastran bulk data (.bdf, .nas, .dat, .fem): solids, properties as bodies, shells as face sets, SPC and FORCE.

- A body is a PSOLID; its name is that of a HyperMesh, Patran or Femap comment, else "property 3".
- A face set is a property of shell elements (CTRIA3, CTRIA6, CQUAD4, CQUAD8) that lie on sides of solids, the skin that
  preprocessors put on a face; and a set of PLOAD4, "PLOAD4 2".
- A node set is a SET1, a SET3 of grids ("set 5"), the nodes of a constraint ("SPC 1") and of forces ("FORCE 2").
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np

from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.importers.bulk_data import BulkCard, read_bulk
from stickslip.structure.importers.raw_model import (
    RawBlock,
    RawBody,
    RawHeld,
    RawLoad,
    RawMaterial,
    RawModel,
    RawSides,
    read_text,
)

Entry = TypeVar("Entry", RawHeld, RawLoad)

_SOLIDS = {"CTETRA": ("tetra", "tetra10"), "CPENTA": ("wedge", "wedge15"), "CHEXA": ("hexahedron", "hexahedron20")}
_SHELLS = {"CTRIA3": 3, "CTRIAR": 3, "CTRIA6": 3, "CQUAD4": 4, "CQUADR": 4, "CQUAD8": 4}
# Nastran numbers the edges along the third direction before those of the upper face.
_TO_VTK = {"wedge15": [*range(9), 12, 13, 14, 9, 10, 11], "hexahedron20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]}
_SILENT = ("PSHELL", "PARAM", "EIGRL", "EIGR", "MDLPRM", "PCOMP")
_REFUSED = {
    "GRDSET": "default coordinate systems of grids are not read. Write CP and CD at each GRID",
    "CPYRAM": "pyramids are not read; tetrahedra, wedges (CPENTA) and hexahedra are",
    "INCLUDE": "INCLUDE is not read. Put all bulk data into one file",
}
_NAMES = (
    re.compile(r"\$HMNAME\s+PROP\s+(?P<number>\d+)\s*\"(?P<name>[^\"]+)\""),
    re.compile(r"\$\s*Femap\s+(?:with\s+NX\s+Nastran\s+)?Property\s+(?P<number>\d+)\s*:\s*(?P<name>.+)", re.IGNORECASE),
)
_PATRAN = re.compile(r"\$\s*Elements and Element Properties for region\s*:\s*(?P<name>.+)", re.IGNORECASE)
_PROPERTY = re.compile(r"\s*P(?:SOLID|SHELL)\*?[\s,]+(?P<number>\d+)")
_CASE = re.compile(r"\s*(?P<what>SPC|LOAD)\s*=\s*(?P<number>\d+)\s*", re.IGNORECASE)


def read_nastran(source: Path) -> RawModel:
    """The entries of bulk data in their own units. Raises ImportFileError that names file and line."""
    lines = read_text(source)
    reader = _Reader(source, _property_names(lines), _selected(lines))
    for card in read_bulk(source, lines):
        reader.take(card)
    return reader.finished()


def _property_names(lines: list[str]) -> dict[int, str]:
    """Names that preprocessors write as comments, by the number of the property."""
    names: dict[int, str] = {}
    region = ""
    for line in lines:
        if line.startswith("$"):
            for pattern in _NAMES:
                match = pattern.match(line)
                if match:
                    names[int(match["number"])] = match["name"].strip()
            match = _PATRAN.match(line)
            region = match["name"].strip() if match else region
        elif region:
            match = _PROPERTY.match(line)
            if match:
                names.setdefault(int(match["number"]), region)
                region = ""
    return names


def _selected(lines: list[str]) -> dict[str, int]:
    """The sets SPC and LOAD that the case control names, before BEGIN BULK."""
    answer: dict[str, int] = {}
    end = next((at for at, text in enumerate(lines) if text.upper().split()[:2] == ["BEGIN", "BULK"]), 0)
    for line in lines[:end]:
        match = _CASE.fullmatch(line)
        if match:
            answer.setdefault(match["what"].upper(), int(match["number"]))
    return answer


class _Reader:
    """Takes the cards one after the other; what refers to other cards is put together at the end."""

    def __init__(self, source: Path, names: dict[int, str], selected: dict[str, int]) -> None:
        self.raw = RawModel(source, "Nastran")
        self._names, self._selected = names, selected
        self._nodes: list[tuple[int, float, float, float, int]] = []
        self._elements: dict[str, list[tuple[int, int, list[int], int]]] = {}  # kind -> label, property, nodes, line
        self._solids: dict[int, tuple[str, list[int]]] = {}
        self._shells: dict[tuple[int, int], list[tuple[list[int], int]]] = {}  # property, corners -> nodes, line
        self._properties: dict[int, BulkCard] = {}
        self._pressures: list[BulkCard] = []
        self._sets: dict[str, list[int]] = {}
        self._held: dict[int, list[RawHeld]] = {}
        self._loads: dict[int, list[RawLoad]] = {}
        self._left_out: dict[str, int] = {}
        self._cards: dict[str, Callable[[BulkCard], None]] = {
            "GRID": self._grid,
            "PSOLID": self._solid_property,
            "MAT1": self._material,
            "SPC": self._spc,
            "SPC1": self._spc1,
            "FORCE": self._force,
            "PLOAD4": self._pressures.append,
            "SET1": lambda card: self._set(card, card.numbers(1)),
            "SET3": self._set3,
            **dict.fromkeys(_SOLIDS, self._solid),
            **dict.fromkeys(_SHELLS, self._shell),
        }

    def take(self, card: BulkCard) -> None:
        """Read one card."""
        if card.name in _REFUSED:
            card.fail(f"{_REFUSED[card.name]}.")
        if card.name in self._cards:
            self._cards[card.name](card)
        elif card.name not in _SILENT:
            self._left_out.setdefault(card.name[:16], card.line)

    def finished(self) -> RawModel:
        """The raw model after the last card."""
        raw = self.raw
        raw.node_labels = np.array([node[0] for node in self._nodes], dtype=np.int64)
        raw.coordinates = np.array([node[1:4] for node in self._nodes], dtype=float).reshape(-1, 3)
        raw.node_lines = np.array([node[4] for node in self._nodes], dtype=np.int64)
        for kind, rows in self._elements.items():
            labels, _, cells, lines = zip(*rows, strict=True)
            cell_array = np.array(cells, dtype=np.int64)[:, _TO_VTK.get(kind, slice(None))]
            raw.blocks.append(RawBlock(kind, np.array(labels, dtype=np.int64), cell_array, np.array(lines)))
        self._bodies()
        self._faces()
        raw.held = self._chosen("SPC", self._held)
        raw.loads = self._chosen("LOAD", self._loads)
        for name, members in self._sets.items():
            raw.node_sets[name] = np.unique(np.array(members, dtype=np.int64))
        for what, found in (("SPC", self._held), ("FORCE", self._loads)):
            for number, entries in found.items():
                raw.node_sets[f"{what} {number}"] = np.unique(np.concatenate([entry.nodes for entry in entries]))
        if self._left_out:
            words = ", ".join(f"{name} (line {line})" for name, line in self._left_out.items())
            raw.messages.append(f"not read, so without effect here: {words}.")
        return raw

    def _bodies(self) -> None:
        rows = [row for rows in self._elements.values() for row in rows]
        for number in dict.fromkeys(row[1] for row in rows):
            mine = [row for row in rows if row[1] == number]
            card = self._properties.get(number)
            if card is None:
                self.raw.fail(
                    f"element {mine[0][0]} has the property {number}, but there is no such PSOLID.", mine[0][3]
                )
            elements = np.array([row[0] for row in mine], dtype=np.int64)
            self.raw.bodies.append(RawBody(self._name(number), elements, str(card.integer(1)), card.line))

    def _name(self, number: int) -> str:
        """Name of a property; where two have the same name, the number is added."""
        name = self._names.get(number, f"property {number}")
        return name if list(self._names.values()).count(name) < 2 else f"{name} {number}"

    def _faces(self) -> None:
        for (number, _), rows in self._shells.items():
            corners = np.array([nodes for nodes, _ in rows], dtype=np.int64)
            name = self._name(number)
            self.raw.face_sets.setdefault(name, []).append(RawSides(rows[0][1], corners=corners))
            self.raw.set_lines.setdefault(name, rows[0][1])
        for card in self._pressures:
            name = f"PLOAD4 {card.integer(0)}"
            self.raw.set_lines.setdefault(name, card.line)
            self.raw.face_sets.setdefault(name, []).append(self._loaded_side(card))

    def _loaded_side(self, card: BulkCard) -> RawSides:
        """The side of a solid that a PLOAD4 names by G1 and G3 (quadrilaterals) or G4 (opposite corner of a tetra)."""
        label = card.integer(1)
        if label not in self._solids:
            card.fail(f"element {label} is no solid element.")
        kind, nodes = self._solids[label]
        first, other = card.integer(6, 0), card.integer(7, 0)
        found = []
        for position, side in enumerate(CELL_KINDS[kind].sides):
            corners = [nodes[at] for at in side[: 3 if len(side) in (3, 6) else 4]]
            if first not in corners:
                continue
            if kind.startswith("tetra"):
                fits = other in nodes[:4] and other not in corners
            elif len(corners) == 3:
                fits = not other or other in corners
            else:
                fits = other in corners and (corners.index(other) - corners.index(first)) % 4 == 2
            found += [position] if fits else []
        if len(found) != 1:
            card.fail(f"the grids G1 = {first} and G3/G4 = {other} name no side of element {label}.")
        return RawSides(card.line, elements=np.array([label], dtype=np.int64), side=found[0])

    def _chosen(self, what: str, found: dict[int, list[Entry]]) -> list[Entry]:
        """Entries of the set that the case control selects, else of all sets."""
        if what in self._selected:
            return found.get(self._selected[what], [])
        if len(found) > 1:
            self.raw.messages.append(
                f"there are {len(found)} sets of {what} entries ({', '.join(map(str, found))}) and the case control "
                "selects none; all are taken together."
            )
        return [entry for entries in found.values() for entry in entries]

    def _grid(self, card: BulkCard) -> None:
        for position, name in ((1, "CP"), (5, "CD")):
            if card.integer(position, 0):
                card.fail(f"{name} = {card.word(position)}: coordinate systems other than the basic one are not read.")
        x, y, z = (card.real(position, 0.0) for position in (2, 3, 4))
        self._nodes.append((card.integer(0), x, y, z, card.line))

    def _solid(self, card: BulkCard) -> None:
        words = card.fields[2:]
        while words and not words[-1]:
            words.pop()
        nodes = [card.integer(2 + at) for at in range(len(words))]
        kinds = {CELL_KINDS[kind].n_nodes: kind for kind in _SOLIDS[card.name]}
        if len(nodes) not in kinds:
            card.fail(f"it has {len(nodes)} grids; {' or '.join(map(str, kinds))} are read.")
        kind = kinds[len(nodes)]
        label = card.integer(0)
        self._elements.setdefault(kind, []).append((label, card.integer(1, label), nodes, card.line))
        self._solids[label] = kind, nodes

    def _shell(self, card: BulkCard) -> None:
        count = _SHELLS[card.name]
        nodes = [card.integer(2 + at) for at in range(count)]
        self._shells.setdefault((card.integer(1, card.integer(0)), count), []).append((nodes, card.line))

    def _solid_property(self, card: BulkCard) -> None:
        number = card.integer(0)
        if number in self._properties:
            card.fail(f"property {number} is defined twice.")
        card.integer(1)
        self._properties[number] = card

    def _material(self, card: BulkCard) -> None:
        young, shear, poisson = (card.real(at) if card.word(at) else None for at in (1, 2, 3))
        if young is None and shear is not None and poisson is not None:
            young = 2.0 * shear * (1.0 + poisson)
        if poisson is None and shear and young is not None:
            poisson = young / (2.0 * shear) - 1.0
        density = card.real(4) if card.word(4) else None
        name = str(card.integer(0))
        if name in self.raw.materials:
            card.fail(f"material {name} is defined twice.")
        self.raw.materials[name] = RawMaterial(young, poisson, density, card.line)

    def _hold(self, card: BulkCard, directions: str, nodes: list[int]) -> None:
        if not nodes or not directions or set(directions) - set("123456"):
            card.fail(f'it needs components out of 1 to 6 and grids; found "{directions[:12]}" and {len(nodes)} grids.')
        solid = tuple(sorted({int(each) - 1 for each in directions if each in "123"}))
        held = RawHeld(np.array(nodes, dtype=np.int64), solid, card.line)
        self._held.setdefault(card.integer(0), []).append(held)

    def _spc(self, card: BulkCard) -> None:
        for at in (1, 4):
            if card.word(at):
                if card.real(at + 2, 0.0) != 0.0:
                    card.fail("a displacement other than 0 is not read. Give a force, or remove the entry.")
                self._hold(card, card.word(at + 1), [card.integer(at)])

    def _spc1(self, card: BulkCard) -> None:
        self._hold(card, card.word(1), card.numbers(2))

    def _force(self, card: BulkCard) -> None:
        if card.integer(2, 0):
            card.fail("CID other than 0: forces in other coordinate systems are not read.")
        size = card.real(3)
        node = np.array([card.integer(1)], dtype=np.int64)
        loads = self._loads.setdefault(card.integer(0), [])
        loads += [RawLoad(node, axis, size * card.real(4 + axis, 0.0), card.line) for axis in range(3)]

    def _set(self, card: BulkCard, members: list[int]) -> None:
        self._sets.setdefault(f"set {card.integer(0)}", []).extend(members)
        self.raw.set_lines.setdefault(f"set {card.integer(0)}", card.line)

    def _set3(self, card: BulkCard) -> None:
        if card.word(1).upper() in ("GRID", "POINT"):
            self._set(card, card.numbers(2))
        else:
            self._left_out.setdefault("SET3 of elements", card.line)
