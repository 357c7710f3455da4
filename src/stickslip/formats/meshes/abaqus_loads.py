"""Constraints and nodal forces of Abaqus and CalculiX decks, those of the first step."""

from __future__ import annotations

from collections.abc import Callable

from stickslip.formats.meshes.abaqus_keywords import CONSTRAINED_DIRECTIONS
from stickslip.formats.meshes.keyword_deck import Card, Find
from stickslip.formats.meshes.raw_model import RawConstraint, RawLoad, RawModel

TEMPERATURE = "0"  # the direction of temperatures in CalculiX, beside 11


class LoadCards:
    """Reads *BOUNDARY and *CLOAD up to the end of the first step, in the directions of their nodes."""

    def __init__(self, raw: RawModel, find: Find) -> None:
        self._raw, self._find = raw, find
        self._step = 0
        self._moved: list[int] = []  # lines of displacements other than 0
        self._pretension_nodes: set[int] = set()
        self._other_loads: list[int] = []  # lines of moments and other loads that act on no displacement
        self.cards: dict[str, Callable[[Card], None]] = {
            "STEP": self._next_step,
            "BOUNDARY": self._boundary,
            "PRE-TENSION SECTION": self._pretension,
            "CLOAD": self._load,
        }

    def report(self) -> None:
        """Messages on the lines that have no effect, after the last card."""
        messages = self._raw.messages
        if self._step > 1:
            messages.append(f"the deck has {self._step} steps; constraints and forces are those of the first one.")
        if self._moved:
            messages.append(
                f"{len(self._moved)} lines of *BOUNDARY give displacements other than 0 (first in line "
                f"{self._moved[0]}): stickslip uses the location only and sets them to 0."
            )
        if self._pretension_nodes:
            messages.append(
                "the force of *PRE-TENSION SECTION is not read: give the normal loads of the joint in the study, or a "
                'solved preload (preload.method = "solved") with forces in place of the bolt.'
            )
        if self._other_loads:
            messages.append(
                f"{len(self._other_loads)} lines of *CLOAD and *BOUNDARY have directions above 3 of nodes without "
                f"rotation, or of temperatures (first in line {self._other_loads[0]}); they are ignored."
            )

    def _next_step(self, card: Card) -> None:
        self._step += 1

    def _pretension(self, card: Card) -> None:
        nodes = self._find(card, "node", card.parameter("NODE"), card.line)
        self._pretension_nodes |= set(nodes.tolist())

    def _boundary(self, card: Card) -> None:
        if self._step > 1:
            return
        for line, words in card.data:
            nodes = self._find(card, "node", words[0], line)
            first = words[1].upper() if len(words) > 1 else ""
            if first in CONSTRAINED_DIRECTIONS:
                self._raw.constraints.append(RawConstraint(nodes, CONSTRAINED_DIRECTIONS[first], line))
                continue
            if first == TEMPERATURE:
                self._other_loads.append(line)
                continue
            start = card.label(first, line)
            stop = card.label(words[2], line) if len(words) > 2 and words[2] else start
            if start > stop:
                card.fail(f"directions {start} to {stop} are not valid; directions are 1 to 6.", line)
            if start > 6:  # temperatures and other unknowns
                self._other_loads.append(line)
                continue
            if len(words) > 3 and words[3] and card.number(words[3], line) != 0.0:
                self._moved.append(line)
            self._raw.constraints.append(RawConstraint(nodes, tuple(range(start - 1, min(stop, 6))), line))

    def _load(self, card: Card) -> None:
        if self._step > 1:
            return
        for line, words in card.data:
            if len(words) < 3:
                card.fail("a force is a node or node set, a direction and a value.", line)
            direction = card.label(words[1], line)
            nodes = self._find(card, "node", words[0], line)
            if direction > 3:
                self._other_loads.append(line)
                continue
            if self._pretension_nodes.issuperset(nodes.tolist()):
                continue
            self._raw.loads.append(RawLoad(nodes, direction - 1, card.number(words[2], line), line))
