"""Ansys archives (.cdb, command CDWRITE): solids, materials, components, constraints, forces and contact pairs.

- A body is a material of solid elements ("material 1"), or a material and an element type where several have it; of an
  orthotropic material also the coordinate system of its elements.
- A node component is a node set. A component of solids is an element set, one of surface elements a face set.
- Contact pairs are the elements CONTA173, 174, 175 and TARGE170 with the same set of real constants; their faces are
  "contact 3" and "target 3".

Source: Ansys Mechanical APDL element reference (node orders) and command reference.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.ansys_archive import Entry, read_archive
from stickslip.formats.meshes.ansys_contact import CONTACT_TYPES, TARGET, ContactElements
from stickslip.formats.meshes.ansys_materials import Materials
from stickslip.formats.meshes.ansys_systems import CoordinateSystems, rotated_axes
from stickslip.formats.meshes.ansys_ties import DIRECTIONS, ConstraintEquations, CoupledSets
from stickslip.formats.meshes.directions import basic_constraints, basic_loads
from stickslip.formats.meshes.raw_model import (
    RawBody,
    RawConstraint,
    RawLoad,
    RawModel,
    RawSides,
)
from stickslip.formats.meshes.solid_lists import SolidLists
from stickslip.structure.cell_kinds import IntArray

_BRICKS = (45, 185, 95, 186)
_TETRAHEDRA = (92, 187, 285)
_SKINS = (151, 152, 153, 154, 155, 156, 200)  # surface effects and mesh facets: no stiffness of their own
_SHELLS = (43, 63, 93, 181, 281)
_LAYERED = 1  # KEYOPT(3) of SOLID185 and SOLID186
_TIES = "it connects nodes to each other in a way that is not read, and the model would be another one without it"
_REJECTED = {
    **dict.fromkeys(
        ("CEINTF", "CERIG", "RBE3", "CPINTF"),
        f"{_TIES}. Write it as equations CE or coupled sets CP, as CDWRITE does",
    ),
    "EN": "elements one by one are not read. Write the archive with CDWRITE,DB and without the option UNBLOCKED",
}
_NO_BLOCK = (
    "there is no NBLOCK with nodes; commands that make or mesh a geometry are not read. Write the archive with "
    "CDWRITE,DB and without the option UNBLOCKED."
)
_SILENT = {
    *("NUMOFF", "DOF", "TYPE", "MAT", "REAL", "SECNUM", "ESYS", "EXTOPT", "FINISH", "TREF", "BFUNIF", "KUSE", "TIME"),
    *("CRPLIM", "NCNV", "NEQIT", "ERESX", "IRLF", "ANTYPE", "MODOPT", "MODCONTROL", "QRDOPT", "CSYS", "RLBLOCK", "R"),
    *("RMODIF", "EQSLV", "OUTRES", "OUTPR", "MXPAND", "N", "LUMPM", "NLGEOM", "NSUB", "AUTOTS", "KBC"),
}
# Gravity, rotations and other loads of zero, which each archive has.
_GLOBAL_LOADS = ("ACEL", "OMEGA", "DOMEGA", "CGLOC", "CGOMEGA", "DCGOMG", "ALPHAD", "BETAD", "DMPRAT", "DMPSTR")
_DIRECTIONS = {"ALL": (0, 1, 2), **{name: (direction,) for name, direction in DIRECTIONS.items()}}
_FORCES = {"FX": 0, "FY": 1, "FZ": 2}
# Middles of the edges of a brick that remain in a wedge (I J K K M N O O) and in a tetrahedron (I J K K M M M M).
_OF_WEDGE, _WEDGE_MIDDLES = [0, 1, 2, 4, 5, 6], [0, 1, 3, 4, 5, 7, 8, 9, 10]
_OF_TETRA, _TETRA_MIDDLES = [0, 1, 2, 4], [0, 1, 3, 8, 9, 10]


def read_ansys(source: Path) -> RawModel:
    """The entries of an archive in its own units. Raises ImportFileError that names file and line."""
    reader = _Reader(source)
    entries = list(read_archive(source))
    if not any(entry.name == "NBLOCK" for entry in entries):
        reader.raw.fail(_NO_BLOCK)
    for entry in entries:
        reader.take(entry)
    return reader.finished()


class _Reader:
    """Reads the commands one after the other."""

    def __init__(self, source: Path) -> None:
        self.raw = RawModel(source, "Ansys archive")
        self._types: dict[int, int] = {}  # number of a type -> number of the element, such as 186
        self._keys: dict[tuple[int, int], int] = {}  # type, KEYOPT -> value
        self._labels: list[int] = []
        self._coordinates: list[list[float]] = []
        self._lines: list[int] = []
        self._frames: dict[int, FloatArray] = {}
        self._solids = SolidLists()
        self._bodies: dict[tuple[int, int, int], list[int]] = {}  # material, type, coordinate system -> elements
        self._surface: dict[int, tuple[int, ...]] = {}  # corners of each surface element
        self._contacts = ContactElements()
        self._ties = ConstraintEquations()
        self._coupled = CoupledSets()
        self._materials = Materials()
        self._systems = CoordinateSystems()
        self._components: list[Entry] = []
        self._skipped: dict[str, int] = {}
        self._moved: list[int] = []
        self._cards: dict[str, Callable[[Entry], None]] = {
            "ET": self._type,
            "KEYOP": self._key,
            "KEYOPT": self._key,
            "NBLOCK": self._nodes,
            "EBLOCK": self._elements,
            "CMBLOCK": self._components.append,
            "MP": self._materials.take_constant,
            "MPTEMP": self._materials.take_temperatures,
            "MPDATA": self._materials.take_table,
            "TB": self._nonlinear,
            "LOCAL": self._systems.take,
            "D": self._constraint,
            "CE": self._ties.take,
            "CP": self._coupled.take,
            "F": self._force,
            **dict.fromkeys(_GLOBAL_LOADS, self._global_load),
        }

    def take(self, entry: Entry) -> None:
        """Read one command or block."""
        if entry.name == "EN" and entry.word(0).startswith(("R5", "UNBL")):
            return  # the end of a block
        if entry.name in _REJECTED:
            entry.fail(f"{_REJECTED[entry.name]}.")
        if entry.name in self._cards:
            self._cards[entry.name](entry)
        elif entry.name not in _SILENT:
            self._skipped.setdefault(entry.name[:20], entry.line)

    def finished(self) -> RawModel:
        """The raw model after the last command."""
        raw = self.raw
        if not self._labels:
            raw.fail(_NO_BLOCK)
        raw.node_labels = np.array(self._labels, dtype=np.int64)
        raw.coordinates = np.array(self._coordinates, dtype=float)
        raw.node_lines = np.array(self._lines, dtype=np.int64)
        raw.blocks += self._solids.blocks()
        self._materials.write(
            raw,
            list(dict.fromkeys([*(material for material, _, _ in self._bodies), *self._materials.numbers()])),
            {material for material, _, _ in self._bodies},
        )
        self._write_bodies()
        for entry in self._components:
            self._component(entry)
        solid_nodes = set().union(*(block.cells.ravel().tolist() for block in raw.blocks))
        self._contacts.write(raw, solid_nodes, self._materials.friction())
        raw.constraints, raw.ties.equations = basic_constraints(raw.constraints, self._frames)
        equations, driven = self._ties.equations(self._frames)
        raw.ties.equations += equations + self._coupled.equations(self._frames)
        if driven:
            raw.messages.append(
                f"equations CE with a constant other than 0 (number: {len(driven)}, first in line {driven[0]}): "
                "stickslip sets it to 0, because displacements are about the state at rest."
            )
        raw.loads = basic_loads(raw.loads, self._frames)
        if self._moved:
            raw.messages.append(
                f"{len(self._moved)} lines of D give displacements other than 0 (first in line {self._moved[0]}): "
                "stickslip uses the location only and sets them to 0."
            )
        if self._skipped:
            words = ", ".join(f"{name} (line {line})" for name, line in self._skipped.items())
            raw.messages.append(f"ignored, without effect here: {words}.")
        return raw

    def _write_bodies(self) -> None:
        merged: dict[tuple[int, int, int], list[int]] = {}  # without the systems of isotropic materials
        for (material, number, system), elements in self._bodies.items():
            is_directed = self.raw.materials[str(material)].symmetry != "isotropic"
            merged.setdefault((material, number, system if is_directed else 0), []).extend(elements)
        for (material, number, system), elements in merged.items():
            name = f"material {material}"
            if len({other for each, other, _ in merged if each == material}) > 1:
                name += f" type {number}"
            if len({other for *each, other in merged if each == [material, number]}) > 1:
                name += f" system {system}"
            axes = self._systems.axes(system)
            if isinstance(axes, str):
                self.raw.fail(
                    f"the orthotropic material {material} has the coordinate system {system}, which {axes}. Give the "
                    "axes of its elements as a rectangular system, or write the model as .inp."
                )
            self.raw.bodies.append(RawBody(name, np.array(elements, dtype=np.int64), str(material), 0, axes))

    def _component(self, entry: Entry) -> None:
        name, kind = entry.words[0], entry.word(1)
        members = self._members(entry)
        if kind.startswith("NODE"):
            self.raw.node_sets[name] = members
        else:
            solids = np.intersect1d(members, self._solids.labels())
            if solids.size:
                self.raw.element_sets[name] = solids
            sides = [self._surface[label] for label in members.tolist() if label in self._surface]
            for width in {len(corners) for corners in sides}:
                corners = np.array([each for each in sides if len(each) == width], dtype=np.int64)
                self.raw.face_sets.setdefault(name, []).append(RawSides(entry.line, corners=corners))
        self.raw.set_lines.setdefault(name, entry.line)

    def _members(self, entry: Entry) -> IntArray:
        """The members of a component that exist; a negative number ends a range."""
        nodes = entry.word(1).startswith("NODE")
        elements = [*self._solids.labels().tolist(), *self._surface]
        defined = np.unique(np.array(self._labels if nodes else elements, dtype=np.int64))
        chosen = np.zeros(defined.size, dtype=bool)
        first = 0
        for line, words in entry.rows:
            for word in words:
                last = entry.whole(word, line)
                if last < 0 and not 0 < first <= -last:
                    entry.fail(f"{last} is not the end of a range that begins at {first}.", line)
                first = last if last > 0 else first
                chosen[slice(*np.searchsorted(defined, [first, abs(last) + 1]))] = True
        return np.asarray(defined[chosen])

    def _type(self, entry: Entry) -> None:
        digits = entry.word(1).lstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZ")
        self._types[entry.label(entry.word(0))] = entry.label(digits)

    def _key(self, entry: Entry) -> None:
        self._keys[entry.label(entry.word(0)), entry.label(entry.word(1))] = int(entry.number(entry.word(2)))

    def _nodes(self, entry: Entry) -> None:
        if entry.word(1) != "SOLID":
            entry.fail("blocks without the key SOLID are not read. Write the archive with CDWRITE,DB.")
        for line, fields in entry.rows:
            if len(fields) < 3:
                entry.fail("a node is a number, two more whole numbers, x, y, z and up to three angles.", line)
            label = entry.label(fields[0], line)
            values = [entry.number(word, line) for word in fields[3:9]]
            values += [0.0] * (6 - len(values))
            self._labels.append(label)
            self._coordinates.append(values[:3])
            self._lines.append(line)
            if any(values[3:]):
                self._frames[label] = rotated_axes(values[3:])

    def _elements(self, entry: Entry) -> None:
        if entry.word(0) != "19" or entry.word(1) != "SOLID":
            entry.fail("only blocks EBLOCK,19,SOLID are read. Write the archive with CDWRITE,DB.")
        rows = iter(entry.rows)
        for line, fields in rows:
            if len(fields) < 12:
                entry.fail("an element has 11 numbers and its nodes, but the line is shorter.", line)
            count = entry.whole(fields[8], line)
            words = fields[11:]
            while len(words) < count:
                further = next(rows, None)
                if further is None:
                    entry.fail(f"the element has {len(words)} of {count} nodes.", line)
                words = [*words, *further[1]]
            if len(words) != count:
                entry.fail(f"the element has {len(words)} nodes, but announces {count}.", line)
            attributes = tuple(entry.whole(word, line) for word in fields[:5])
            nodes = [entry.whole(word, line) for word in words]
            self._element(entry, entry.label(fields[10], line), attributes, nodes, line)

    def _element(self, entry: Entry, label: int, attributes: tuple[int, ...], nodes: list[int], line: int) -> None:
        material, number, real, _, system = attributes
        kind = self._types.get(number)
        if kind is None:
            entry.fail(f"element {label} has the type {number}, but there is no ET,{number}.", line)
        if kind in _BRICKS or kind in _TETRAHEDRA:
            if kind in _BRICKS and self._keys.get((number, 3)) == _LAYERED:
                entry.fail(f"element {label} has layers (KEYOPT(3) = 1), which are not read.", line)
            shape, cell = _solid_shape(entry, label, nodes, line)
            self._solids.add(shape, label, cell, line)
            self._bodies.setdefault((material, number, system), []).append(label)
        elif kind in CONTACT_TYPES:
            corners = _corners(nodes, kind == TARGET)
            self._contacts.add(kind, real, material, corners, self._keys.get((number, 12), 0), line)
            self._surface[label] = corners
        elif kind in _SKINS:
            self._surface[label] = _corners(nodes, False)
        else:
            name = f"of type {kind}"
            self.raw.other_elements[name] = self.raw.other_elements.get(name, 0) + 1
            self._surface[label] = _corners(nodes, False) if kind in _SHELLS else ()

    def _nonlinear(self, entry: Entry) -> None:
        if not self._materials.take_nonlinear(entry):
            self._skipped.setdefault(f"TB,{entry.word(0)[:10]}", entry.line)

    def _constraint(self, entry: Entry) -> None:
        node, name = entry.label(entry.word(0)), entry.word(1)
        if name not in _DIRECTIONS:
            self._skipped.setdefault(f"D,{name[:10]}", entry.line)
            return
        if any(entry.number(entry.word(position)) for position in (2, 3)):
            self._moved.append(entry.line)
        self.raw.constraints.append(RawConstraint(np.array([node], dtype=np.int64), _DIRECTIONS[name], entry.line))

    def _force(self, entry: Entry) -> None:
        node, name = entry.label(entry.word(0)), entry.word(1)
        if name not in _FORCES:
            self._skipped.setdefault(f"F,{name[:10]}", entry.line)
            return
        value = entry.number(entry.word(2))
        self.raw.loads.append(RawLoad(np.array([node], dtype=np.int64), _FORCES[name], value, entry.line))

    def _global_load(self, entry: Entry) -> None:
        if any(entry.number(word) for word in entry.words):
            self._skipped.setdefault(entry.name, entry.line)


def _corners(nodes: list[int], is_target: bool) -> tuple[int, ...]:
    """Corners of a surface element; a triangle is a quadrilateral I J K K, or has 3 or 6 nodes (targets)."""
    corners = tuple(nodes[:3] if is_target and len(nodes) in (3, 6) else nodes[:4])
    return corners[:3] if len(corners) == 4 and corners[2] == corners[3] else corners


def _solid_shape(entry: Entry, label: int, nodes: list[int], line: int) -> tuple[str, list[int]]:
    """Kind and nodes in VTK order of a solid, whose brick may be collapsed to a wedge or a tetrahedron."""
    n_corners = 8 if len(nodes) in (8, 20) else 4
    if len(nodes) not in (4, 8, 10, 20):
        entry.fail(f"element {label} has {len(nodes)} nodes; solids have 4, 8, 10 or 20.", line)
    corners, middles = nodes[:n_corners], nodes[n_corners:]
    shape = ("hexahedron", "hexahedron20") if n_corners == 8 else ("tetra", "tetra10")
    if n_corners == 8 and corners[2] == corners[3]:
        is_tetra = len(set(corners[4:])) == 1
        if is_tetra or corners[6] == corners[7]:
            shape = ("tetra", "tetra10") if is_tetra else ("wedge", "wedge15")
            chosen, between = (_OF_TETRA, _TETRA_MIDDLES) if is_tetra else (_OF_WEDGE, _WEDGE_MIDDLES)
            corners = [corners[at] for at in chosen]
            middles = [middles[at] for at in between] if middles else []
    elif n_corners == 8 and len(set(corners[4:])) == 1:
        entry.fail(f"element {label} is a pyramid; stickslip reads tetrahedra, wedges and bricks.", line)
    if not any(middles):
        return shape[0], corners
    if not all(middles):
        entry.fail(f"element {label} lacks some of its midside nodes. Give all of them, or none.", line)
    return shape[1], [*corners, *middles]
