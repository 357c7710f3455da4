"""Nastran bulk data (.bdf, .nas, .dat, .fem): solids, properties as bodies, shells as face sets, SPC and FORCE.

- A body is a PSOLID; its name is that of a HyperMesh, Patran or Femap comment, else "property 3".
- A face set is a property of shell elements (CTRIA3, CTRIA6, CQUAD4, CQUAD8) that lie on sides of solids, the skin that
  preprocessors put on a face; and a set of PLOAD4, "PLOAD4 2".
- Grids and forces may be in coordinate systems (CP, CID), and INCLUDE brings further files.
- A node set is a SET1, a SET3 of grids ("set 5"), the nodes of a constraint ("SPC 1") and of forces ("FORCE 2").
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from stickslip.formats.meshes.bulk_data import BulkCard, read_bulk
from stickslip.formats.meshes.included_files import IncludedFiles
from stickslip.formats.meshes.nastran_case import CaseControl, active_entries
from stickslip.formats.meshes.nastran_contact import Elements, NastranContact
from stickslip.formats.meshes.nastran_grids import Grids, constrained_nodes
from stickslip.formats.meshes.nastran_include import join_files
from stickslip.formats.meshes.nastran_materials import AnisotropicMaterials
from stickslip.formats.meshes.nastran_points import NastranPoints
from stickslip.formats.meshes.nastran_systems import SYSTEM_CARDS, Systems
from stickslip.formats.meshes.nastran_ties import NastranTies
from stickslip.formats.meshes.raw_model import (
    LinePositions,
    RawBlock,
    RawBody,
    RawConstraint,
    RawLoad,
    RawMaterial,
    RawModel,
    RawSides,
)
from stickslip.structure.cell_kinds import CELL_KINDS

_SOLIDS = {"CTETRA": ("tetra", "tetra10"), "CPENTA": ("wedge", "wedge15"), "CHEXA": ("hexahedron", "hexahedron20")}
_SHELLS = {"CTRIA3": 3, "CTRIAR": 3, "CTRIA6": 3, "CQUAD4": 4, "CQUADR": 4, "CQUAD8": 4}
# Nastran numbers the edges along the third direction before those of the upper face.
_TO_VTK = {"wedge15": [*range(9), 12, 13, 14, 9, 10, 11], "hexahedron20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]}
_SILENT = ("PSHELL", "PARAM", "EIGRL", "EIGR", "MDLPRM", "PCOMP")
_TIES = (
    "it ties grids to each other in a way that is not read, and without it the model would be another one. Write it as "
    "RBE2, RBE3, RBAR or MPC, or remove it"
)
_REJECTED = {
    "CPYRAM": "stickslip reads no pyramids, but tetrahedra, wedges (CPENTA) and hexahedra",
    **dict.fromkeys(("RBE1", "RBAR1", "RTRPLT", "RSPLINE", "RSSCON", "RJOINT"), _TIES),
}
_NAMES = (
    re.compile(r"\$HMNAME\s+PROP\s+(?P<number>\d+)\s*\"(?P<name>[^\"]+)\""),
    re.compile(r"\$\s*Femap\s+(?:with\s+NX\s+Nastran\s+)?Property\s+(?P<number>\d+)\s*:\s*(?P<name>.+)", re.IGNORECASE),
)
_PATRAN = re.compile(r"\$\s*Elements and Element Properties for region\s*:\s*(?P<name>.+)", re.IGNORECASE)
_CARD_NAME = re.compile(r"[A-Z][A-Z0-9]{0,7}")
_PROPERTY = re.compile(r"\s*P(?:SOLID|SHELL)\*?[\s,]+(?P<number>\d+)")


def read_nastran(source: Path, includes_outside: bool = False) -> RawModel:
    """The entries of a deck and of the files that it includes, in their own units, in basic x, y, z.

    ``includes_outside``: also from outside of its folder. Raises ImportFileError that names the file, also an included
    one, and its line.
    """
    included = IncludedFiles(source, includes_outside)
    with included.hidden_if_foreign():
        lines, places = join_files(source, included)
        reader = _Reader(source, places, _property_names(lines), CaseControl.of(lines))
        for card in read_bulk(lines, places):
            reader.take(card)
        return reader.finished()


def _frame_messages(raw: RawModel, labels: list[int]) -> Iterator[str]:
    """Number of grids of solids with directions of their own."""
    parts = [np.empty(0, dtype=np.int64), *(block.cells.ravel() for block in raw.blocks)]
    turned = np.intersect1d(labels, np.concatenate(parts))
    if turned.size:
        yield (
            f"{turned.size} grids have a coordinate system of displacements (CD), the first of them {turned[0]}: "
            "stickslip converts their constraints to x, y, z, the directions of all displacements."
        )


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
    """Reads the cards one after the other; references to other cards are resolved at the end."""

    def __init__(self, source: Path, places: LinePositions, names: dict[int, str], case: CaseControl) -> None:
        self.raw = RawModel(source, "Nastran", places=places)
        self._names, self._case = names, case
        self._count = Counter(names.values())
        self._grids = Grids()
        self._systems = Systems(self._grids.place)
        self._elements: dict[str, list[tuple[int, int, list[int], int]]] = {}  # kind -> label, property, nodes, line
        self._solids: dict[int, tuple[str, list[int]]] = {}
        self._shells: dict[tuple[int, int], list[tuple[list[int], int]]] = {}  # property, corners -> nodes, line
        self._shell_corners: dict[int, list[int]] = {}
        self._of_property: dict[int, list[int]] = {}  # elements, also shells
        self._properties: dict[int, BulkCard] = {}
        self._pressures: list[BulkCard] = []
        self._forces: list[BulkCard] = []
        self._sets: dict[str, list[int]] = {}
        self._constraints: dict[int, list[RawConstraint]] = {}
        self._combined: dict[str, dict[int, BulkCard]] = {"SPCADD": {}, "LOAD": {}}
        self._skipped: dict[str, int] = {}
        self._moved: list[int] = []  # lines of displacements other than 0
        self._ties = NastranTies()
        self._contact = NastranContact()
        self._points = NastranPoints(self.raw)
        self._other_materials = AnisotropicMaterials(self.raw)
        self._cards: dict[str, Callable[[BulkCard], None]] = {
            "GRID": self._grids.add,
            "GRDSET": self._grids.set_defaults,
            **dict.fromkeys(SYSTEM_CARDS, self._systems.add),
            "SPCADD": self._combination,
            "LOAD": self._combination,
            "PSOLID": self._solid_property,
            "MAT1": self._material,
            **self._other_materials.cards,
            "SPC": self._spc,
            "SPC1": self._spc1,
            "FORCE": self._forces.append,
            "PLOAD4": self._pressures.append,
            "SET1": lambda card: self._set(card, card.numbers(1)),
            "SET3": self._set3,
            **dict.fromkeys(_SOLIDS, self._solid),
            **dict.fromkeys(_SHELLS, self._shell),
            **self._ties.cards,
            **self._contact.cards,
            **self._points.cards,
        }

    def take(self, card: BulkCard) -> None:
        """Read one card."""
        if card.name in _REJECTED:
            card.fail(f"{_REJECTED[card.name]}.")
        if card.name in self._cards:
            self._cards[card.name](card)
        elif card.name not in _SILENT:
            # text that is not the name of an entry is not quoted: the file may be a wrong one
            name = card.name if _CARD_NAME.fullmatch(card.name) else "lines that are not entries"
            self._skipped.setdefault(name, card.line)

    def finished(self) -> RawModel:
        """The raw model after the last card."""
        raw = self.raw
        self._grids.write_to(raw, self._systems)
        for kind, rows in self._elements.items():
            labels, _, cells, lines = zip(*rows, strict=True)
            cell_array = np.array(cells, dtype=np.int64)[:, _TO_VTK.get(kind, slice(None))]
            raw.blocks.append(RawBlock(kind, np.array(labels, dtype=np.int64), cell_array, np.array(lines)))
        self._bodies()
        self._faces()
        constrained = [
            *active_entries(raw, self._case, "SPC", self._constraints, self._combined["SPCADD"]),
            *self._grids.permanent_constraints(),
        ]
        frames = self._grids.frames(raw, self._systems)
        raw.constraints, raw.ties.equations = self._grids.in_basic_directions(raw, constrained, frames)
        self._ties.write(raw, self._case, {label: rows for label, (rows, _) in frames.items()})
        self._contact.write(raw, Elements(self._solids, self._shell_corners, self._of_property))
        self._points.write(set(frames))
        raw.messages += _frame_messages(raw, list(frames))
        if self._moved:
            raw.messages.append(
                f"{len(self._moved)} SPC give displacements other than 0 (first in {raw.where(self._moved[0])}): "
                "stickslip uses the location only and sets them to 0."
            )
        loads: dict[int, list[RawLoad]] = {}
        for card in self._forces:
            loads.setdefault(card.integer(0), []).extend(self._nodal_force(card))
        raw.loads = active_entries(raw, self._case, "LOAD", loads, self._combined["LOAD"])
        for name, members in self._sets.items():
            raw.node_sets[name] = np.unique(np.array(members, dtype=np.int64))
        for what, sets in (("SPC", self._constraints), ("FORCE", loads)):
            for number, entries in sets.items():
                raw.node_sets[f"{what} {number}"] = np.unique(np.concatenate([entry.nodes for entry in entries]))
        if self._skipped:
            words = ", ".join(f"{name} ({raw.where(line)})" for name, line in self._skipped.items())
            raw.messages.append(f"ignored, without effect here: {words}.")
        return raw

    def _bodies(self) -> None:
        of_property: dict[int, list[tuple[int, int, list[int], int]]] = {}
        for row in (row for rows in self._elements.values() for row in rows):
            of_property.setdefault(row[1], []).append(row)
        if of_property and not self._properties:
            self.raw.messages.append("the deck has no PSOLID, so its bodies have no material; give it in the study.")
        for number, mine in of_property.items():
            card = self._properties.get(number)
            if not self._properties:
                elements = np.array([row[0] for row in mine], dtype=np.int64)
                self.raw.bodies.append(RawBody(self._name(number), elements, None, mine[0][3]))
                continue
            if card is None:
                self.raw.fail(
                    f"element {mine[0][0]} has the property {number}, but there is no such PSOLID.", mine[0][3]
                )
            elements = np.array([row[0] for row in mine], dtype=np.int64)
            material = str(card.integer(1))
            axes = self._other_materials.axes(card, material, self._systems)
            self.raw.bodies.append(RawBody(self._name(number), elements, material, card.line, axes))

    def _name(self, number: int) -> str:
        """Name of a property; where two have the same name, the number is added."""
        name = self._names.get(number, f"property {number}")
        return name if self._count[name] < 2 else f"{name} {number}"

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
            card.fail(f"element {label} is not a solid element.")
        kind, nodes = self._solids[label]
        first, other = card.integer(6, 0), card.integer(7, 0)
        positions = []
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
            positions += [position] if fits else []
        if len(positions) != 1:
            card.fail(f"the grids G1 = {first} and G3/G4 = {other} are on no side of element {label}.")
        return RawSides(card.line, elements=np.array([label], dtype=np.int64), side=positions[0])

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
            card.fail(f"it has {len(nodes)} grids, but it must have {' or '.join(map(str, kinds))}.")
        kind = kinds[len(nodes)]
        label = card.integer(0)
        self._elements.setdefault(kind, []).append((label, card.integer(1, label), nodes, card.line))
        self._solids[label] = kind, nodes
        self._of_property.setdefault(card.integer(1, label), []).append(label)

    def _shell(self, card: BulkCard) -> None:
        count = _SHELLS[card.name]
        nodes = [card.integer(2 + at) for at in range(count)]
        label = card.integer(0)
        self._shells.setdefault((card.integer(1, label), count), []).append((nodes, card.line))
        self._shell_corners[label] = nodes
        self._of_property.setdefault(card.integer(1, label), []).append(label)

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
        self.raw.materials[name] = RawMaterial.of_constants(young, poisson, density, card.line)

    def _constrain(self, card: BulkCard, directions: str, nodes: list[int]) -> None:
        self._constraints.setdefault(card.integer(0), []).append(constrained_nodes(card, directions, nodes))

    def _spc(self, card: BulkCard) -> None:
        for at in (1, 4):
            if card.word(at):
                if card.real(at + 2, 0.0) != 0.0:
                    self._moved.append(card.line)
                self._constrain(card, card.word(at + 1), [card.integer(at)])

    def _spc1(self, card: BulkCard) -> None:
        self._constrain(card, card.word(1), card.numbers(2))

    def _nodal_force(self, card: BulkCard) -> list[RawLoad]:
        """Components along x, y, z of a FORCE, whose directions are those of its system at the place of its grid."""
        label, size = card.integer(1), card.real(3)
        frame = self._systems.frame(card.integer(2, 0), card)
        place = self._grids.basic_place(label, self.raw)
        if place is None:
            card.fail(f"grid {label}, on which it acts, is not defined.")
        components = np.array([card.real(4 + axis, 0.0) for axis in range(3)])
        directions, lacking = frame.directions(place)
        if any(components[axis] for axis in lacking):
            card.fail(
                f"grid {label} is on the axis of the system {card.word(2)}, so that the components "
                f"{', '.join(str(axis + 1) for axis in sorted(lacking))} of its force have no direction there. Give "
                "the force in a rectangular system."
            )
        with np.errstate(over="ignore", invalid="ignore"):
            force = size * (components @ directions)
        node = np.array([label], dtype=np.int64)
        return [RawLoad(node, axis, float(force[axis]), card.line) for axis in range(3)]

    def _set(self, card: BulkCard, members: list[int]) -> None:
        self._sets.setdefault(f"set {card.integer(0)}", []).extend(members)
        self.raw.set_lines.setdefault(f"set {card.integer(0)}", card.line)

    def _set3(self, card: BulkCard) -> None:
        if card.word(1).upper() in ("GRID", "POINT"):
            self._set(card, card.numbers(2))
        else:
            self._skipped.setdefault("SET3 of elements", card.line)
