"""The content of a model file: labels and numbers of the file, with the line of each entry."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NoReturn

import numpy as np

from stickslip.core.errors import ImportFileError
from stickslip.core.input_files import read_regular
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.raw_contacts import RawContact
from stickslip.formats.meshes.raw_materials import RawMaterial as RawMaterial
from stickslip.formats.meshes.raw_points import RawMass, RawSpring
from stickslip.formats.meshes.raw_ties import RawTies
from stickslip.structure.mesh import IntArray

LARGEST_LABEL = 2**31  # numbers of nodes and elements stay below


@dataclass(frozen=True)
class RawBlock:
    """Solid elements of one ``kind`` of :class:`Mesh`, such as "tetra10".

    ``labels`` (m,) are those of the elements, ``cells`` (m, k) those of their nodes in VTK order, ``lines`` (m,) their
    lines in the file, 0 where unknown.
    """

    kind: str
    labels: IntArray
    cells: IntArray
    lines: IntArray

    __repr__ = short_repr


@dataclass(frozen=True)
class RawBody:
    """Elements (k,) by label with a common name and, unless ``material`` is None, a common material.

    ``axes`` (3, 3) are the axes 1, 2, 3 of the material as rows, None for x, y, z.
    """

    name: str
    elements: IntArray
    material: str | None
    line: int
    axes: FloatArray | None = None


@dataclass(frozen=True)
class RawSides:
    """Sides of solids: ``side`` (0, 1, ...) of elements (k,), or every free side of them where it is None.

    Alternatively ``corners`` are the corner nodes (k, 3 | 4) of sides, from shell elements or surface cells. ``line``
    is that of the entry in the file, 0 if unknown.
    """

    line: int
    elements: IntArray | None = None
    side: int | None = None
    corners: IntArray | None = None

    __repr__ = short_repr


@dataclass(frozen=True)
class RawLoad:
    """Nodes (k,) by label, direction 0, 1, 2, and the force on each in the unit of the file."""

    nodes: IntArray
    direction: int
    value: float
    line: int

    def scaled(self, factor: float) -> RawLoad:
        """The force times a factor."""
        return replace(self, value=factor * self.value)


@dataclass(frozen=True)
class RawConstraint:
    """Nodes (k,) by label whose displacements along some directions 0, 1, 2 are zero; 3, 4, 5 are rotations."""

    nodes: IntArray
    directions: tuple[int, ...]
    line: int

    def scaled(self, factor: float) -> RawConstraint:
        """A displacement of zero stays zero."""
        return self


@dataclass(frozen=True)
class LinePositions:
    """File and line of each line of a text that was joined from several files.

    ``starts`` are the numbers (from 1, rising) of the joined text's lines at which the lines of another file begin, or
    those of the same file continue; ``files`` and ``lines`` are this file and its line.
    """

    starts: list[int] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)

    def begin(self, start: int, file: Path, line: int) -> None:
        """From line ``start`` on the joined text has the lines of ``file`` from ``line`` on."""
        self.starts.append(start)
        self.files.append(file)
        self.lines.append(line)

    def of(self, line: int) -> tuple[Path, int]:
        """File, and line in it, of a line of the joined text."""
        at = bisect_right(self.starts, line) - 1
        return self.files[at], self.lines[at] + line - self.starts[at]

    def words(self, line: int) -> str:
        """The line for a message: "line 5", or "line 5 of blade.bdf" in another file than the first."""
        file, own = self.of(line)
        return f"line {own}" if file == self.files[0] else f"line {own} of {file}"

    def fail(self, sentence: str, line: int) -> NoReturn:
        """Raise ImportFileError with the file, its line, and the sentence."""
        file, own = self.of(line)
        fail(file, sentence, own)


@dataclass(frozen=True)
class LabelRange:
    """Labels ``first`` to ``last`` that the file writes without ``offset``, after the name of an instance."""

    first: int
    last: int
    offset: int
    instance: str


def shown_label(label: int, ranges: tuple[LabelRange, ...]) -> str:
    """A node or element as in the file: 12, or Part-1.12 in an instance."""
    for each in ranges:
        if each.first <= label <= each.last:
            return f"{each.instance}.{label - each.offset}" if each.instance else f"{label - each.offset}"
    return f"{label}"


@dataclass
class RawModel:
    """All entries of a file, in its units. Labels are those of the file, or of the equivalent flat file.

    A reader needs ``source``, ``format``, nodes and ``blocks``; all other fields are optional.

    Parameters
    ----------
    source, format:
        the file, and the name of its format for messages.
    node_labels, coordinates, node_lines:
        (n,) labels, (n, 3) positions, and (n,) lines of the nodes; 0 for a line that is unknown.
    blocks:
        the solid elements by kind.
    node_sets, element_sets:
        name -> labels (k,).
    face_sets:
        name -> sides of solids.
    set_lines:
        name of a set -> its line.
    materials, bodies:
        name -> material, and the elements of each body; without bodies, parts that share nodes are bodies.
    constraints, loads:
        displacements of zero, and forces on nodes.
    ties, contacts:
        linear equations between displacements, and contact pairs.
    sector:
        the entry that repeats the model round an axis, "" without one; the boundaries are face or node sets.
    masses, springs:
        mass points and springs at nodes.
    node_surfaces:
        names of node sets that the file defines as surfaces.
    other_elements:
        number of elements of each type without volume.
    point_elements:
        the node of each element of a distributing coupling.
    messages:
        messages on entries that were ignored.
    places:
        file and line of each line of a text that was joined from several files; None for lines of ``source``.
    label_ranges:
        labels of the nodes and elements of instances.
    """

    source: Path
    format: str
    node_labels: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    coordinates: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    node_lines: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    blocks: list[RawBlock] = field(default_factory=list)
    node_sets: dict[str, IntArray] = field(default_factory=dict)
    element_sets: dict[str, IntArray] = field(default_factory=dict)
    face_sets: dict[str, list[RawSides]] = field(default_factory=dict)
    set_lines: dict[str, int] = field(default_factory=dict)
    materials: dict[str, RawMaterial] = field(default_factory=dict)
    bodies: list[RawBody] = field(default_factory=list)
    constraints: list[RawConstraint] = field(default_factory=list)
    loads: list[RawLoad] = field(default_factory=list)
    ties: RawTies = field(default_factory=RawTies)
    contacts: list[RawContact] = field(default_factory=list)
    sector: str = ""
    masses: list[RawMass] = field(default_factory=list)
    springs: list[RawSpring] = field(default_factory=list)
    node_surfaces: set[str] = field(default_factory=set)
    other_elements: dict[str, int] = field(default_factory=dict)
    point_elements: dict[int, int] = field(default_factory=dict)
    messages: list[str] = field(default_factory=list)
    places: LinePositions | None = None
    label_ranges: tuple[LabelRange, ...] = ()

    __repr__ = short_repr

    def shown(self, label: int) -> str:
        """A node or element as the file writes it."""
        return shown_label(label, self.label_ranges)

    def fail(self, sentence: str, line: int = 0) -> NoReturn:
        """Raise ImportFileError with the file, the line where one is known, and the sentence."""
        if self.places is not None and line:
            self.places.fail(sentence, line)
        fail(self.source, sentence, line)

    def where(self, line: int) -> str:
        """A line for a message, with its file unless it is ``source``."""
        return self.places.words(line) if self.places is not None else f"line {line}"


def fail(source: Path, sentence: str, line: int = 0) -> NoReturn:
    """Raise ImportFileError with the file, the line where one is known, and the sentence."""
    raise ImportFileError(f"{source}, line {line}: {sentence}" if line else f"{source}: {sentence}")


def read_text(source: Path) -> list[str]:
    """Lines of a text file. Raises ImportFileError if it cannot be read, is empty, or is not text."""
    try:
        content = read_regular(source)
    except OSError as error:
        fail(source, f"the file cannot be read ({error.strerror}). Give the path of a model file.")
    if not content.strip():
        fail(source, "the file is empty.")
    if b"\0" in content:
        fail(source, "this is a binary file, but its name is that of a text format. Export the model as text.")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")  # comments and names of older programs; every byte is a character
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
