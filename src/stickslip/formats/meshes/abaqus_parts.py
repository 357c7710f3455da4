"""Parts, instances and the assembly of an Abaqus deck: the scope of each card, and the position of an instance."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NoReturn

import numpy as np
from scipy.spatial.transform import Rotation

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.keyword_deck import Card

_INSIDE = {"PART": (), "ASSEMBLY": (), "INSTANCE": ("ASSEMBLY",)}  # what must be open where each begins
STRUCTURE = {*_INSIDE, *(f"END {keyword}" for keyword in _INSIDE)}
_MODEL_LEVEL = {"MATERIAL", "ELASTIC", "DENSITY", "BOUNDARY", "CLOAD", "STEP", "END STEP"}


@dataclass(frozen=True)
class Motion:
    """First a translation (3,), then a turn about the axis through ``point`` (3,), as a right-handed screw."""

    translation: FloatArray
    point: FloatArray
    turn: Rotation

    def moved(self, points: FloatArray) -> FloatArray:
        """x' = a + R (x + t - a) of points (n, 3)."""
        return np.asarray(self.point + self.turn.apply(points + self.translation - self.point))


@dataclass
class Scope:
    """A scope of numbers and names: an instance, or the assembly with the level of the model (no name).

    In the flat deck its numbers, ``first`` to ``last``, are larger by ``offset``.
    """

    name: str
    motion: Motion | None = None
    cards: list[Card] = field(default_factory=list)
    first: int = 1
    last: int = 0
    offset: int = 0

    def flat(self, card: Card, label: int, line: int) -> int:
        """Number in the flat deck. Raises ImportFileError for a number of another scope."""
        if not self.first <= label <= self.last:
            where = f"the instance '{self.name}' has" if self.name else "the assembly itself has"
            advice = "" if self.name else " For an instance write INSTANCE.NUMBER."
            card.fail(f"{where} no node or element {label}.{advice}", line)
        return label + self.offset


@dataclass(frozen=True)
class Assembly:
    """The instances by their names in capitals, the assembly itself, and every card with its scope, in order."""

    names: frozenset[str]
    instances: dict[str, Scope]
    itself: Scope
    cards: list[tuple[Scope, Card]]
    unused_parts: list[str]


def plain_name(text: str) -> str:
    """A name without the quotes that may surround it or its halves."""
    return text.replace('"', "").strip()


def find_instances(cards: list[Card]) -> Assembly:
    """Give each card its scope; the cards of a part occur once for each of its instances, at the position of the
    instance.

    Raises ImportFileError for a name that comes twice, an unknown part, an instance of an earlier analysis, and a part,
    instance or assembly that does not end or begin.
    """
    reader = _Nest()
    for card in cards:
        reader.take(card)
    return reader.finished()


class _Nest:
    """Reads the cards one after the other and tracks the open part, assembly and instance."""

    def __init__(self) -> None:
        self._open: list[Card] = []
        self._parts: dict[str, tuple[Card, list[Card]]] = {}
        self._used: set[str] = set()
        self._instances: dict[str, tuple[Card, Scope]] = {}
        self._assembly: Card | None = None
        self._itself = Scope("")
        self._part: list[Card] = []
        self._scope = self._itself
        self._cards: list[tuple[Scope, Card]] = []

    def take(self, card: Card) -> None:
        """Put one card into its scope."""
        if card.keyword in _INSIDE:
            self._require_open(card, _INSIDE[card.keyword])
            {"PART": self._begin_part, "ASSEMBLY": self._begin_assembly, "INSTANCE": self._begin_instance}[
                card.keyword
            ](card)
            self._open.append(card)
        elif card.keyword in STRUCTURE:
            self._end(card)
        elif card.keyword in _MODEL_LEVEL and self._open:
            self._fail_unclosed(card)
        elif self._open and self._open[-1].keyword == "PART":
            self._part.append(card)
        else:
            self._add(self._scope, card)

    def finished(self) -> Assembly:
        """The assembly after the last card."""
        if self._open:
            last = self._open[-1]
            last.fail(f"*END {last.keyword} is missing. Write it at the end of the {_name_of(last)}.")
        if self._parts and not self._instances:
            first, _ = next(iter(self._parts.values()))
            first.fail(f"no *INSTANCE places the {_name_of(first)}, so there is no mesh. Write the assembly, too.")
        unused = [
            f"the {_name_of(card)} (line {card.line}) has no instance; it is ignored."
            for name, (card, _) in self._parts.items()
            if name not in self._used
        ]
        names = frozenset([plain_name(self._assembly.parameters.get("NAME", "")).upper()] if self._assembly else [])
        instances = {name: scope for name, (_, scope) in self._instances.items()}
        return Assembly(names - {""}, instances, self._itself, self._cards, unused)

    def _add(self, scope: Scope, card: Card) -> None:
        card = replace(card, instance=scope.name)
        scope.cards.append(card)
        self._cards.append((scope, card))

    def _require_open(self, card: Card, wanted: tuple[str, ...]) -> None:
        keywords = tuple(each.keyword for each in self._open)
        if keywords == wanted:
            return
        if len(keywords) > len(wanted) or not wanted:
            self._fail_unclosed(card)
        card.fail("it is outside of an assembly. Write *ASSEMBLY above it, and *END ASSEMBLY after the last one.")

    def _fail_unclosed(self, card: Card) -> NoReturn:
        last = self._open[-1]
        card.fail(
            f"it is inside of the {_name_of(last)} ({_place(last, card)}), which is not allowed. Write "
            f"*END {last.keyword} above it."
        )

    def _end(self, card: Card) -> None:
        wanted = card.keyword.removeprefix("END ")
        if not self._open or self._open[-1].keyword != wanted:
            if any(each.keyword == wanted for each in self._open):
                self._fail_unclosed(card)
            card.fail(f"there is no *{wanted} above it.")
        self._open.pop()
        self._scope = self._itself

    def _begin_part(self, card: Card) -> None:
        name = plain_name(card.parameter("NAME")).upper()
        if name in self._parts:
            _fail_twice(card, self._parts[name][0])
        self._part = []
        self._parts[name] = card, self._part

    def _begin_assembly(self, card: Card) -> None:
        if self._assembly is not None:
            card.fail(f"there is an assembly already ({_place(self._assembly, card)}); a deck has one.")
        self._assembly = card

    def _begin_instance(self, card: Card) -> None:
        for parameter in ("LIBRARY", "INSTANCE"):
            if parameter in card.parameters:
                card.fail(
                    f"{parameter}= uses the instance of an earlier analysis, with its mesh in another file that is "
                    "not read. Write its mesh into this deck."
                )
        name, part = plain_name(card.parameter("NAME")), plain_name(card.parameter("PART"))
        if name.upper() in self._instances:
            _fail_twice(card, self._instances[name.upper()][0])
        if part.upper() not in self._parts:
            names = ", ".join(plain_name(each.parameters["NAME"]) for each, _ in self._parts.values()) or "none"
            card.fail(f"there is no part '{part}' above this line; there are: {names}.")
        self._used.add(part.upper())
        self._scope = Scope(name, _motion(card))
        self._instances[name.upper()] = card, self._scope
        for each in self._parts[part.upper()][1]:
            self._add(self._scope, each)


def _name_of(card: Card) -> str:
    """Part 'P', instance 'P-1', assembly 'A'."""
    return f"{card.keyword.lower()} '{plain_name(card.parameters.get('NAME', ''))}'"


def _place(other: Card, card: Card) -> str:
    """The line of another card, with its file where that is not the one of ``card``."""
    return f"line {other.line}" if other.source == card.source else f"{other.source}, line {other.line}"


def _fail_twice(card: Card, first: Card) -> NoReturn:
    card.fail(
        f"the name '{plain_name(card.parameters['NAME'])}' is used twice (first in {_place(first, card)}); upper and "
        "lower case do not differ. Give one of the two another name."
    )


def _motion(card: Card) -> Motion | None:
    """How the data lines of *INSTANCE move it; None where they do not. Raises ImportFileError for wrong lines."""
    if not card.data:
        return None
    if len(card.data) > 2:
        card.fail("it has a line of translation and a line of rotation at most.", card.data[2][0])
    translation = _numbers(card, *card.data[0], 3)
    if len(card.data) == 1:
        return Motion(translation, np.zeros(3), Rotation.identity()) if translation.any() else None
    line, words = card.data[1]
    values = _numbers(card, line, words, 7)
    point, axis = values[:3], values[3:6] - values[:3]
    length = float(np.linalg.norm(axis))
    if not length > 0.0:
        card.fail(
            "the points a and b of the axis are the same. The line is ax, ay, az, bx, by, bz, angle in degrees.", line
        )
    return Motion(translation, point, Rotation.from_rotvec(np.deg2rad(values[6]) * axis / length))


def _numbers(card: Card, line: int, words: list[str], count: int) -> FloatArray:
    """``count`` numbers of a data line; missing entries are 0."""
    numbers = words[:-1] if words[-1] == "" else words
    if len(numbers) > count:
        card.fail(f"this line has {len(numbers)} numbers, but it must have {count}.", line)
    values = [card.number(word or "0", line) for word in numbers]
    return np.array(values + [0.0] * (count - len(values)))
