"""Mass points (*MASS), moments of inertia (*ROTARY INERTIA) and springs (*SPRING) of Abaqus and CalculiX decks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.formats.meshes.keyword_deck import Card
from stickslip.formats.meshes.raw_model import RawModel
from stickslip.formats.meshes.raw_points import RawMass, RawSpring
from stickslip.structure.cell_kinds import IntArray

Find = Callable[[Card, str, str, int], IntArray]
POINT_ELEMENTS = ("MASS", "ROTARYI", "SPRING1", "SPRING2")


class PointCards:
    """Reads the cards one after the other; :meth:`write` resolves them after the last element."""

    def __init__(self, raw: RawModel, find: Find) -> None:
        self._raw, self._find = raw, find
        self._nodes: dict[int, list[int]] = {}  # of each element
        self._masses: list[Card] = []
        self._inertias: list[Card] = []
        self._springs: list[Card] = []
        self.cards: dict[str, Callable[[Card], None]] = {
            "MASS": self._masses.append,
            "ROTARY INERTIA": self._inertias.append,
            "SPRING": self._springs.append,
        }

    def add(self, rows: list[list[int]]) -> None:
        """Elements: label and nodes."""
        self._nodes |= {row[0]: row[1:] for row in rows}

    def write(self, turned: set[int]) -> None:
        """Put masses and springs into the raw model; ``turned`` are nodes with directions of their own."""
        for card in self._masses:
            if card.parameters.get("TYPE", "ISOTROPIC").upper() != "ISOTROPIC":
                card.fail("a mass that depends on the direction is not read. Give TYPE=ISOTROPIC.")
            line, words = card.data[0] if card.data else (card.line, [""])
            value = card.number(words[0], line)
            for label in self._elements(card):
                self._raw.masses.append(RawMass(np.array(self._nodes[label][:1], dtype=np.int64), value, card.line))
        for card in self._inertias:
            self._inertia(card)
        for card in self._springs:
            self._spring(card, turned)

    def _inertia(self, card: Card) -> None:
        if "ORIENTATION" in card.parameters:
            card.fail("ORIENTATION is not read. Give the moments of inertia about x, y and z.")
        line, words = card.data[0] if card.data else (card.line, [""])
        values = [card.number(word or "0", line) for word in words[:6]]
        if any(values[3:]):
            card.fail("products of inertia are not read. Give the three moments about x, y and z.", line)
        first, second, third = (*values, 0.0, 0.0)[:3]
        for label in self._elements(card):
            node = np.array(self._nodes[label][:1], dtype=np.int64)
            self._raw.masses.append(RawMass(node, 0.0, card.line, inertia=(first, second, third, 0.0, 0.0, 0.0)))

    def _elements(self, card: Card) -> list[int]:
        """Elements of a card that are points or springs between nodes."""
        labels = self._find(card, "element", card.parameter("ELSET"), card.line)
        return [label for label in labels.tolist() if label in self._nodes]

    def _spring(self, card: Card, turned: set[int]) -> None:
        for name in ("NONLINEAR", "ORIENTATION", "COMPLEX STIFFNESS"):
            if name in card.parameters:
                card.fail(f"{name} is not read. Give a linear spring along x, y or z.")
        elements = self._elements(card)
        if not elements:
            return  # of SPRINGA
        if len(card.data) < 2:
            card.fail("a line with the directions and one with the stiffness are required.")
        (first_line, directions), (line, words) = card.data[:2]
        value = card.number(words[0], line)
        axes = [card.label(word, first_line) for word in directions if word]
        for label in elements:
            nodes = self._nodes[label]
            if len(axes) < len(nodes):
                card.fail(f"element {self._raw.shown(label)} has {len(nodes)} nodes and requires as many directions.")
            if max(axes) > 6:
                card.fail(f"direction {max(axes)} is not valid; directions are 1 to 6.", first_line)
            if turned & set(nodes):
                card.fail(f"node {self._raw.shown(nodes[0])} has a *TRANSFORM, so its directions are not x, y, z.")
            other = (nodes[1], axes[1] - 1) if len(nodes) == 2 else None
            self._raw.springs.append(RawSpring(np.array(nodes[:1]), axes[0] - 1, value, card.line, other))
