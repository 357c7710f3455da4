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

import numpy as np

from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.importers.bulk_data import BulkCard, read_bulk
from stickslip.structure.importers.nastran_case import CaseControl, acting_entries
from stickslip.structure.importers.nastran_frames import Frames
from stickslip.structure.importers.raw_model import (
    RawBlock,
    RawBody,
    RawHeld,
    RawLoad,
    RawMaterial,
    RawModel,
    RawSides,
    fail,
    read_text,
)
from stickslip.validation import FloatArray

_SOLIDS = {"CTETRA": ("tetra", "tetra10"), "CPENTA": ("wedge", "wedge15"), "CHEXA": ("hexahedron", "hexahedron20")}
_SHELLS = {"CTRIA3": 3, "CTRIAR": 3, "CTRIA6": 3, "CQUAD4": 4, "CQUADR": 4, "CQUAD8": 4}
# Nastran numbers the edges along the third direction before those of the upper face.
_TO_VTK = {"wedge15": [*range(9), 12, 13, 14, 9, 10, 11], "hexahedron20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]}
# Coordinate systems other than CORD2R are refused where a grid or a force is in one.
_SILENT = ("PSHELL", "PARAM", "EIGRL", "EIGR", "MDLPRM", "PCOMP", "CORD1R", "CORD1C", "CORD1S", "CORD2C", "CORD2S")
_TIES = (
    "it ties nodes of solids to each other, and without it the model would be another one. Take it out; hold, load or "
    "pair the set of its nodes instead"
)
_REFUSED = {
    "GRDSET": "default coordinate systems of grids are not read. Write CP and CD at each GRID",
    "CPYRAM": "pyramids are not read; tetrahedra, wedges (CPENTA) and hexahedra are",
    **dict.fromkeys(("RBE1", "RBE2", "RBE3", "RBAR", "RBAR1", "RROD", "RTRPLT", "RSPLINE", "RSSCON", "RJOINT"), _TIES),
}
_INCLUDE = re.compile(r"\s*INCLUDE\b", re.IGNORECASE)
_NAMES = (
    re.compile(r"\$HMNAME\s+PROP\s+(?P<number>\d+)\s*\"(?P<name>[^\"]+)\""),
    re.compile(r"\$\s*Femap\s+(?:with\s+NX\s+Nastran\s+)?Property\s+(?P<number>\d+)\s*:\s*(?P<name>.+)", re.IGNORECASE),
)
_PATRAN = re.compile(r"\$\s*Elements and Element Properties for region\s*:\s*(?P<name>.+)", re.IGNORECASE)
_PROPERTY = re.compile(r"\s*P(?:SOLID|SHELL)\*?[\s,]+(?P<number>\d+)")


def read_nastran(source: Path) -> RawModel:
    """The entries of bulk data in their own units. Raises ImportFileError that names file and line."""
    lines = read_text(source)
    for number, line in enumerate(lines, start=1):
        if _INCLUDE.match(line):
            fail(source, "INCLUDE is not read. Put the executive, case control and bulk data into one file.", number)
    reader = _Reader(source, _property_names(lines), CaseControl.of(lines))
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


class _Reader:
    """Takes the cards one after the other; what refers to other cards is put together at the end."""

    def __init__(self, source: Path, names: dict[int, str], case: CaseControl) -> None:
        self.raw = RawModel(source, "Nastran")
        self._names, self._case = names, case
        self._grids: list[BulkCard] = []
        self._frames = Frames()
        self._elements: dict[str, list[tuple[int, int, list[int], int]]] = {}  # kind -> label, property, nodes, line
        self._solids: dict[int, tuple[str, list[int]]] = {}
        self._shells: dict[tuple[int, int], list[tuple[list[int], int]]] = {}  # property, corners -> nodes, line
        self._properties: dict[int, BulkCard] = {}
        self._pressures: list[BulkCard] = []
        self._sets: dict[str, list[int]] = {}
        self._held: dict[int, list[RawHeld]] = {}
        self._loads: dict[int, list[RawLoad]] = {}
        self._combined: dict[str, dict[int, BulkCard]] = {"SPCADD": {}, "LOAD": {}}
        self._left_out: dict[str, int] = {}
        self._cards: dict[str, Callable[[BulkCard], None]] = {
            "GRID": self._grids.append,
            "CORD2R": self._frames.add,
            "SPCADD": self._combination,
            "LOAD": self._combination,
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
        if card.name in ("MPC", "MPCADD") and self._case.ties_nodes():
            card.fail(f"{_TIES}, or select no MPC in the case control.")
        if card.name in self._cards:
            self._cards[card.name](card)
        elif card.name not in _SILENT:
            self._left_out.setdefault(card.name[:16], card.line)

    def finished(self) -> RawModel:
        """The raw model after the last card."""
        raw = self.raw
        raw.node_labels = np.array([card.integer(0) for card in self._grids], dtype=np.int64)
        raw.coordinates = np.array([self._place(card) for card in self._grids], dtype=float).reshape(-1, 3)
        raw.node_lines = np.array([card.line for card in self._grids], dtype=np.int64)
        for kind, rows in self._elements.items():
            labels, _, cells, lines = zip(*rows, strict=True)
            cell_array = np.array(cells, dtype=np.int64)[:, _TO_VTK.get(kind, slice(None))]
            raw.blocks.append(RawBlock(kind, np.array(labels, dtype=np.int64), cell_array, np.array(lines)))
        self._bodies()
        self._faces()
        raw.held = acting_entries(raw, self._case, "SPC", self._held, self._combined["SPCADD"])
        raw.held += [held for card in self._grids for held in self._permanent(card)]
        raw.loads = acting_entries(raw, self._case, "LOAD", self._loads, self._combined["LOAD"])
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

    def _place(self, card: BulkCard) -> FloatArray:
        """Basic coordinates of a grid."""
        if card.integer(5, 0):
            card.fail(
                f"CD = {card.word(5)}: directions of displacements in a coordinate system of their own are not read. "
                "Leave CD blank, and give constraints in the basic directions."
            )
        place = np.array([card.real(position, 0.0) for position in (2, 3, 4)])
        number = card.integer(1, 0)
        return self._frames.basic(number, place, card) if number else place

    def _permanent(self, card: BulkCard) -> list[RawHeld]:
        """What the field PS of a grid holds, whatever the case control selects."""
        return [self._holding(card, card.word(6), [card.integer(0)])] if card.word(6) else []

    def _combination(self, card: BulkCard) -> None:
        if self._combined[card.name].setdefault(card.integer(0), card) is not card:
            card.fail(f"set {card.integer(0)} is defined twice.")

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

    @staticmethod
    def _holding(card: BulkCard, directions: str, nodes: list[int]) -> RawHeld:
        if not nodes or not directions or set(directions) - set("123456"):
            card.fail(f'it needs components out of 1 to 6 and grids; found "{directions[:12]}" and {len(nodes)} grids.')
        solid = tuple(sorted({int(each) - 1 for each in directions if each in "123"}))
        return RawHeld(np.array(nodes, dtype=np.int64), solid, card.line)

    def _hold(self, card: BulkCard, directions: str, nodes: list[int]) -> None:
        self._held.setdefault(card.integer(0), []).append(self._holding(card, directions, nodes))

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
            card.fail("CID other than 0: forces in other coordinate systems are not read. Give basic components.")
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
