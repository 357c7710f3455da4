"""Ties of Abaqus and CalculiX decks: equations, multi-point constraints, rigid bodies, couplings, and face ties."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.keyword_deck import Card, Find
from stickslip.formats.meshes.raw_model import RawModel
from stickslip.formats.meshes.raw_ties import (
    RawDistributing,
    RawEquation,
    RawRigid,
    RawTie,
    basic_terms,
    combined,
    equal_distance,
    linearised,
    one_line,
    one_plane,
)
from stickslip.structure.cell_kinds import IntArray

ALL = tuple(range(6))
_POINTS = {"PIN": (0, 1, 2), "TIE": ALL}  # nodes with the same displacements, or rotations too
_MANY = {"PLANE": (4, one_plane, 3), "STRAIGHT": (3, one_line, 2)}  # least nodes, conditions, nodes that define it
_MPCS = ("BEAM", "LINK", *_POINTS, *_MANY)


class TieCards:
    """Reads the cards of ties one after the other; :meth:`write` resolves them after the last node."""

    def __init__(self, raw: RawModel, find: Find) -> None:
        self._raw, self._find = raw, find
        self._coupling: tuple[Card, int, str, IntArray] | None = None  # waits for *KINEMATIC or *DISTRIBUTING
        self._equations: list[tuple[list[tuple[IntArray, int, float]], int]] = []
        self._mpcs: list[tuple[str, list[int], int]] = []
        self.cards: dict[str, Callable[[Card], None]] = {
            "EQUATION": self._equation,
            "MPC": self._mpc,
            "RIGID BODY": self._rigid_body,
            "COUPLING": self._begin_coupling,
            "KINEMATIC": self._kinematic,
            "DISTRIBUTING": self._distributing,
            "KINEMATIC COUPLING": self._old_kinematic,
            "DISTRIBUTING COUPLING": self._old_distributing,
            "TIE": self._tie,
            "CYCLIC SYMMETRY MODEL": self._sector,
        }

    def write(self, frames: dict[int, FloatArray]) -> None:
        """Equations and multi-point constraints in basic directions, with the ``frames`` of nodes by label."""
        if self._coupling is not None:
            self._coupling[0].fail("neither *KINEMATIC nor *DISTRIBUTING is below it. Write one of them.")
        for terms, line in self._equations:
            count = max(nodes.size for nodes, _, _ in terms)
            for at in range(count):
                each = [(int(nodes[at if nodes.size > 1 else 0]), axis, value) for nodes, axis, value in terms]
                basic = combined(term for part in each for term in basic_terms(frames, *part))
                if not basic:
                    continue
                plain = each[0][0] not in frames
                self._raw.ties.equations.append(RawEquation("*EQUATION", basic, line, is_free=not plain))
        for kind, labels, line in self._mpcs:
            self._write_mpc(kind, labels, line)

    def _write_mpc(self, kind: str, labels: list[int], line: int) -> None:
        what, ties = f"*MPC {kind}", self._raw.ties
        places = self._places(labels, line)
        if kind in _MANY:
            least, conditions, _ = _MANY[kind]
            if len(labels) < least:
                self._raw.fail(f"{what} has {len(labels)} nodes, but it must have {least} or more.", line)
            ties.equations += linearised(what, conditions(labels, places), line)
            return
        if kind in _POINTS or (kind == "BEAM" and labels[1] not in self._solid_nodes()):
            if kind in _POINTS:
                for axis in _POINTS[kind]:
                    ties.equations.append(RawEquation(what, ((labels[0], axis, 1.0), (labels[1], axis, -1.0)), line))
            else:
                ties.rigid.append(RawRigid(what, labels[1], np.array(labels[:1]), ALL, line))
            return
        ties.equations += linearised(what, equal_distance(labels[0], labels[1], places[0] - places[1]), line)

    def _solid_nodes(self) -> set[int]:
        return {label for block in self._raw.blocks for label in np.unique(block.cells).tolist()}

    def _places(self, labels: list[int], line: int) -> FloatArray:
        """(k, 3) positions of nodes in the unit of the file."""
        row = {label: at for at, label in enumerate(self._raw.node_labels.tolist())}
        for label in labels:
            if label not in row:
                self._raw.fail(f"node {self._raw.shown(label)} does not exist.", line)
        return np.asarray(self._raw.coordinates[[row[label] for label in labels]])

    def _one_node(self, card: Card, word: str, line: int) -> int:
        nodes = self._find(card, "node", word, line)
        if nodes.size != 1:
            card.fail(f"'{word[:40]}' has {nodes.size} nodes, but one reference node is required.", line)
        return int(nodes[0])

    def _equation(self, card: Card) -> None:
        if "REMOVE" in card.parameters:
            card.fail("REMOVE changes the equations of an earlier step, which is not read. Leave those equations out.")
        rows = iter(card.data)
        for line, words in rows:
            count = card.label(words[0], line)
            terms: list[tuple[IntArray, int, float]] = []
            while len(terms) < count:
                term_line, entries = next(rows, (0, []))
                if not term_line:
                    card.fail(f"the equation has {len(terms)} of {count} terms.", line)
                entries = entries[:-1] if len(entries) % 3 == 1 and entries[-1] == "" else entries
                if len(entries) % 3:
                    card.fail("a term is a node or node set, a direction and a coefficient.", term_line)
                for at in range(0, len(entries), 3):
                    axis = card.label(entries[at + 1], term_line)
                    if axis > 6:
                        card.fail(f"direction {axis} is not one of 1 to 6.", term_line)
                    nodes = self._find(card, "node", entries[at], term_line)
                    terms.append((nodes, axis - 1, card.number(entries[at + 2], term_line)))
            sizes = {nodes.size for nodes, _, _ in terms} - {1}
            if len(sizes) > 1:
                card.fail(
                    "its node sets have different numbers of nodes. Use sets of one node, or of equal size.", line
                )
            if terms[0][2] == 0.0:
                card.fail("the coefficient of its first term is 0; that of the dependent node must not be 0.", line)
            self._equations.append((terms, line))

    def _mpc(self, card: Card) -> None:
        kind, start = "", card.line
        labels: list[int] = []
        entries: list[tuple[str, list[int], int]] = []
        for line, words in card.data:
            first = words[0].upper()
            if first[:1].isalpha():
                if first not in _MPCS:
                    card.fail(
                        f"the type {first[:20]} is not linear or not read; {', '.join(_MPCS)} are. Write it as "
                        "*EQUATION, or remove it.",
                        line,
                    )
                kind, labels, start = first, [], line
                entries.append((kind, labels, start))
                words = words[1:]
            elif not kind:
                card.fail("a line begins with the type of the constraint, such as BEAM.", line)
            for word in words:
                if word and word != "0":
                    labels += self._find(card, "node", word, line).tolist()
        for kind, labels, start in entries:
            if kind not in _MANY and len(labels) != 2:
                card.fail(f"{kind} has {len(labels)} nodes, but it must have 2.", start)
        self._mpcs += entries

    def _rigid_body(self, card: Card) -> None:
        reference = self._one_node(card, card.parameter("REF NODE"), card.line)
        rotation = card.parameters.get("ROT NODE")
        turned = None if not rotation else self._one_node(card, rotation, card.line)
        known = {"NSET", "ELSET", "PIN NSET", "TIE NSET"} & card.parameters.keys()
        if not known:
            card.fail("it has no NSET, ELSET, PIN NSET or TIE NSET; a rigid surface is not read. Give its nodes.")
        nodes = []
        for name in sorted(known):
            members = self._find(card, "element" if name == "ELSET" else "node", card.parameter(name), card.line)
            nodes.append(self._nodes_of_elements(members) if name == "ELSET" else members)
        labels = np.unique(np.concatenate(nodes))
        labels = labels[labels != turned]
        self._raw.ties.rigid.append(RawRigid("*RIGID BODY", reference, labels, ALL, card.line, turned))

    def _nodes_of_elements(self, elements: IntArray) -> IntArray:
        parts = [block.cells[np.isin(block.labels, elements)].ravel() for block in self._raw.blocks]
        return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *parts]))

    def _begin_coupling(self, card: Card) -> None:
        if self._coupling is not None:
            self._coupling[0].fail("neither *KINEMATIC nor *DISTRIBUTING is below it. Write one of them.")
        for name in ("ORIENTATION", "INFLUENCE RADIUS"):
            if name in card.parameters:
                card.fail(f"{name}= is not read. Write the coupling for all nodes of the surface and in x, y, z.")
        reference = self._one_node(card, card.parameter("REF NODE"), card.line)
        surface = card.parameter("SURFACE")
        face = next((name for name in self._raw.face_sets if name.upper() == surface.upper()), "")
        nodes = np.empty(0, dtype=np.int64) if face else self._find(card, "node", surface, card.line)
        self._coupling = card, reference, face, nodes

    def _take_coupling(self, card: Card) -> tuple[Card, int, str, IntArray]:
        if self._coupling is None:
            card.fail("there is no *COUPLING above it.")
        coupling, self._coupling = self._coupling, None
        return coupling

    def _kinematic(self, card: Card) -> None:
        coupling, reference, face, nodes = self._take_coupling(card)
        self._raw.ties.rigid.append(
            RawRigid("*COUPLING", reference, nodes, _directions(card), coupling.line, face=face)
        )

    def _distributing(self, card: Card) -> None:
        coupling, reference, face, nodes = self._take_coupling(card)
        self._raw.ties.distributing.append(
            RawDistributing("*COUPLING", reference, nodes, _directions(card), coupling.line, face=face)
        )

    def _old_kinematic(self, card: Card) -> None:
        reference = self._one_node(card, card.parameter("REF NODE"), card.line)
        for line, words in card.data:
            nodes = self._find(card, "node", words[0], line)
            directions = _range(card, words[1:], line) or ALL
            self._raw.ties.rigid.append(RawRigid("*KINEMATIC COUPLING", reference, nodes, directions, line))

    def _old_distributing(self, card: Card) -> None:
        elements = self._find(card, "element", card.parameter("ELSET"), card.line)
        references = [
            self._raw.point_elements[label] for label in elements.tolist() if label in self._raw.point_elements
        ]
        if len(references) != 1:
            card.fail(f"ELSET= has {len(references)} elements DCOUP3D, but it must have one.")
        nodes, weights = [], []
        for line, words in card.data:
            members = self._find(card, "node", words[0], line)
            nodes.append(members)
            weights.append(np.full(members.size, card.number(words[1], line) if len(words) > 1 and words[1] else 1.0))
        if not nodes:
            card.fail("there are no nodes below.")
        self._raw.ties.distributing.append(
            RawDistributing(
                "*DISTRIBUTING COUPLING", references[0], np.concatenate(nodes), ALL, card.line, np.concatenate(weights)
            )
        )

    def _tie(self, card: Card) -> None:
        if "MULTISTAGE" in card.parameters:
            card.fail("MULTISTAGE couples disks of other sectors, which is not read. Write the complete model.")
        if "CYCLIC SYMMETRY" in card.parameters:
            names = [word for _, words in card.data for word in words if word]
            self._raw.sector = f"*TIE, CYCLIC SYMMETRY in line {card.line} ({' and '.join(names)[:80]})"
            return
        word = card.parameters.get("POSITION TOLERANCE", "")
        tolerance = card.number(word, card.line) if word else None
        if tolerance is not None and tolerance < 0.0:
            card.fail(f"POSITION TOLERANCE is {word}; it must be 0 or more.")
        for line, words in card.data:
            if len(words) < 2 or not words[1]:
                card.fail("a line contains the dependent surface and the independent one.", line)
            names = [self._surface_name(card, word, line) for word in words[:2]]
            self._raw.ties.faces.append(RawTie("*TIE", names[0], names[1], tolerance, line))

    def _sector(self, card: Card) -> None:
        self._raw.sector = self._raw.sector or f"*CYCLIC SYMMETRY MODEL in line {card.line}"

    def _surface_name(self, card: Card, word: str, line: int) -> str:
        """The name of a surface, or of a node set, as first written."""
        for sets in (self._raw.face_sets, self._raw.node_surfaces):
            for name in sets:
                if name.upper() == word.upper():
                    return name
        card.fail(f"there is no surface '{word[:60]}' in the deck.", line)


def _directions(card: Card) -> tuple[int, ...]:
    """Directions 0 to 5 of the lines of a coupling, all without lines."""
    directions = {each for line, words in card.data for each in _range(card, words, line)}
    return tuple(sorted(directions)) or ALL


def _range(card: Card, words: list[str], line: int) -> tuple[int, ...]:
    numbers = [card.label(word, line) for word in words[:2] if word]
    if not numbers:
        return ()
    if numbers[0] > numbers[-1] or numbers[-1] > 6:
        card.fail(f"directions {numbers[0]} to {numbers[-1]} are not valid; directions are 1 to 6.", line)
    return tuple(range(numbers[0] - 1, numbers[-1]))
