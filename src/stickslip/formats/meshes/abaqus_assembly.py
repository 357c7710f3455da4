"""A deck with parts and instances as the equivalent flat deck, with unique numbers and names.

Sets, surfaces and sections of a part are called ``INSTANCE.NAME``; numbers grow by an offset of each instance.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from stickslip.formats.meshes.abaqus_parts import STRUCTURE, Assembly, Motion, Scope, find_instances, plain_name
from stickslip.formats.meshes.abaqus_systems import without_end
from stickslip.formats.meshes.keyword_deck import Card
from stickslip.formats.meshes.raw_model import LARGEST_LABEL, LabelRange

Row = tuple[int, list[str]]
# Parameters that give a name to something, and those that refer to a set.
_NAMES = {"NODE": "NSET", "ELEMENT": "ELSET", "NSET": "NSET", "ELSET": "ELSET", "SURFACE": "NAME"}
_REFERENCES = {
    "NSET": ("ELSET",),
    "SOLID SECTION": ("ELSET",),
    "RIGID BODY": ("REF NODE", "ROT NODE", "NSET", "ELSET", "PIN NSET", "TIE NSET"),
    "COUPLING": ("REF NODE", "SURFACE"),
    "KINEMATIC COUPLING": ("REF NODE",),
    "DISTRIBUTING COUPLING": ("ELSET",),
    "TRANSFORM": ("NSET",),
}
# Positions of the words in the lines of a card that are a set or number.
_WORDS = {
    **dict.fromkeys(("SURFACE", "BOUNDARY", "CLOAD", "KINEMATIC COUPLING", "DISTRIBUTING COUPLING"), slice(0, 1)),
    **dict.fromkeys(("TIE", "CONTACT PAIR", "CONTACT INCLUSIONS", "CONTACT PROPERTY ASSIGNMENT"), slice(0, 2)),
    "EQUATION": slice(0, None, 3),
    "MPC": slice(1, None),
}

_SMALLEST_OFFSET = 1000  # offsets are round, so that numbers stay easy to recognise


@dataclass(frozen=True)
class FlatDeck:
    """Cards of a flat deck, their numbers in the file, and messages on the changes."""

    cards: list[Card]
    ranges: tuple[LabelRange, ...] = ()
    messages: list[str] = field(default_factory=list)


def flatten(cards: list[Card]) -> FlatDeck:
    """Cards of every instance and of the assembly as those of one flat deck; a flat deck stays as it is.

    Each card has its line and its instance. An instance keeps its numbers if they are above all before it; else they
    grow by an offset, which a message reports. Raises ImportFileError that names file and line.
    """
    if not any(card.keyword in STRUCTURE for card in cards):
        return FlatDeck(cards)
    assembly = find_instances(cards)
    scopes = [*assembly.instances.values(), assembly.itself]
    _number(scopes)
    writer = _Writer(assembly)
    flat = [writer.flat(scope, card) for scope, card in assembly.cards]
    filled = [scope for scope in scopes if scope.last]
    ranges = tuple(
        LabelRange(scope.first + scope.offset, scope.last + scope.offset, scope.offset, scope.name) for scope in filled
    )
    return FlatDeck(flat, ranges, [*_numbering(filled), *assembly.unused_parts])


def _number(scopes: list[Scope]) -> None:
    """Collect the numbers of each scope and set its offset, so that the numbers of all scopes differ."""
    largest = 0
    for scope in scopes:
        labels = [label for card in scope.cards for label in _labels(card)]
        if not labels:
            continue
        scope.first, scope.last = min(labels), max(labels)
        if scope.first <= largest:
            step = max(_SMALLEST_OFFSET, 10 ** (len(str(largest)) - 1))
            scope.offset = step * (largest // step + 1)
        largest = scope.last + scope.offset
        if largest >= LARGEST_LABEL:
            scope.cards[0].fail(
                f"with the offset {scope.offset} that separates the instances, the numbers of "
                f"{_scope_name(scope)} go up to {largest}, above {LARGEST_LABEL - 1}. Number the parts from 1 on."
            )


def _labels(card: Card) -> list[int]:
    """Numbers of nodes and elements that a card defines or joins, without those of other scopes (with a dot)."""
    if card.keyword == "NODE":
        return [card.label(words[0], line) for line, words in card.data]
    if card.keyword == "ELEMENT":
        return [card.label(word, line) for line, words in card.data for word in words if word and "." not in word]
    return []


def _scope_name(scope: Scope) -> str:
    return f"instance '{scope.name}'" if scope.name else "the assembly itself"


def _numbering(scopes: list[Scope]) -> list[str]:
    """A sentence on how the numbers of all scopes have grown; none where all are those of the deck."""
    if not any(scope.offset for scope in scopes):
        return []
    words = [f"{_scope_name(scope)} {f'+ {scope.offset}' if scope.offset else 'as in the deck'}" for scope in scopes]
    return [f"each instance has its own numbers of nodes and elements: {', '.join(words)}."]


class _Writer:
    """Writes the cards of a flat deck."""

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly

    def flat(self, scope: Scope, card: Card) -> Card:
        """A card with numbers, names and coordinates of the flat deck."""
        inner = self._named_instance(scope, card)
        parameters = dict(card.parameters)
        kind = card.keyword
        if parameters.get(_NAMES.get(kind, "")):
            name = plain_name(parameters[_NAMES[kind]])
            parameters[_NAMES[kind]] = f"{scope.name}.{name}" if scope.name else name
        for parameter in _REFERENCES.get(kind, ()):
            if parameters.get(parameter):
                parameters[parameter] = self._reference(inner, card, parameters[parameter], card.line)
        data = card.data
        if kind == "NODE":
            data = _nodes(scope, card)
        elif kind == "ORIENTATION" and scope.motion is not None:
            data = [(line, _turned(scope.motion, card, words, line)) for line, words in data[:1]] + data[1:]
        elif kind == "ELEMENT":
            data = [(line, [self._label(scope, card, word, line) for word in words]) for line, words in data]
        elif kind in ("NSET", "ELSET") and "GENERATE" in parameters:
            data = [row for line, words in data for row in _generated(inner, card, line, words)]
        elif kind in ("NSET", "ELSET"):
            data = [(line, [self._reference(inner, card, word, line) for word in words]) for line, words in data]
        elif kind in _WORDS:
            data = [(line, self._with_references(scope, card, words, line)) for line, words in data]
        return replace(card, parameters=parameters, data=data)

    def _with_references(self, scope: Scope, card: Card, words: list[str], line: int) -> list[str]:
        """The words of a line with the sets and numbers of the flat deck."""
        if card.keyword == "EQUATION" and len(words) == 1:
            return words  # the number of terms
        answer = list(words)
        for at in range(*_WORDS[card.keyword].indices(len(words))):
            answer[at] = self._reference(scope, card, words[at], line)
        return answer

    def _named_instance(self, scope: Scope, card: Card) -> Scope:
        """The scope of what a set names: that of INSTANCE=, else that of the card."""
        if card.keyword not in ("NSET", "ELSET") or "INSTANCE" not in card.parameters:
            return scope
        if scope.name:
            card.fail("INSTANCE= is for sets of the assembly; a part or an instance uses its own nodes. Remove it.")
        word = self._without_assembly(plain_name(card.parameter("INSTANCE")))
        if word.upper() not in self._assembly.instances:
            names = ", ".join(each.name for each in self._assembly.instances.values()) or "none"
            card.fail(f"there is no instance '{word}'; there are: {names}.")
        return self._assembly.instances[word.upper()]

    def _without_assembly(self, word: str) -> str:
        """A name without that of the assembly before its first dot."""
        before, dot, rest = word.partition(".")
        return rest if dot and before.upper() in self._assembly.names else word

    def _label(self, scope: Scope, card: Card, word: str, line: int) -> str:
        """A number in the flat deck, also of a node of another instance; an empty word stays one."""
        if not word:
            return word
        return self._reference(scope, card, word, line) if "." in word else f"{card.label(word, line) + scope.offset}"

    def _reference(self, scope: Scope, card: Card, word: str, line: int) -> str:
        """The set or number that a word means in a scope, as the flat deck writes it; an empty word stays one."""
        word = plain_name(word)
        if not scope.name:
            word = self._without_assembly(word)
            instance, rest = self._split(word)
            if instance is not None:
                return self._reference(instance, card, rest, line)
        if not word:
            return word
        try:
            int(word)
        except ValueError:
            return f"{scope.name}.{word}" if scope.name else word
        return str(scope.flat(card, card.label(word, line), line))

    def _split(self, word: str) -> tuple[Scope | None, str]:
        """The instance before a dot and what follows; names of instances may have dots themselves."""
        at = word.rfind(".")
        while at > 0:
            scope = self._assembly.instances.get(word[:at].upper())
            if scope is not None and word[at + 1 :]:
                return scope, word[at + 1 :]
            at = word.rfind(".", 0, at)
        return None, word


def _nodes(scope: Scope, card: Card) -> list[Row]:
    """Lines of *NODE with the numbers of the flat deck, at the place of the instance."""
    numbered = [(line, [f"{card.label(words[0], line) + scope.offset}", *words[1:]]) for line, words in card.data]
    if scope.motion is None:
        return numbered
    # the reader of the flat deck rejects a line without coordinates
    rows = [at for at, (_, words) in enumerate(numbered) if any(words[1:])]
    places = np.zeros((len(rows), 3))
    for row, at in enumerate(rows):
        line, words = numbered[at]
        values = [card.number(word or "0", line) for word in words[1:4]]
        places[row, : len(values)] = values
    for at, place in zip(rows, scope.motion.moved(places).tolist(), strict=True):
        line, words = numbered[at]
        numbered[at] = line, [words[0], *map(repr, place), *words[4:]]
    return numbered


def _turned(motion: Motion, card: Card, words: list[str], line: int) -> list[str]:
    """The points of an *ORIENTATION, whose differences are directions, turned with the instance."""
    values = [card.number(word or "0", line) for word in without_end(words)]
    if len(values) % 3:
        return words  # the reader of the flat deck rejects it
    return [*map(repr, motion.turn.apply(np.reshape(values, (-1, 3))).ravel().tolist())]


def _generated(scope: Scope, card: Card, line: int, words: list[str]) -> list[Row]:
    """First, last and step in the flat deck, cut to the numbers of the scope, because other numbers lie beside them."""
    limits = [card.label(word, line) for word in words if word]
    if len(limits) not in (2, 3) or limits[1] < limits[0]:
        return [(line, words)]  # the reader of the flat deck rejects it
    start, stop, step = (*limits, 1)[:3]
    start += step * max(0, -((start - scope.first) // step))
    stop = min(stop, scope.last)
    if start > stop:
        return []
    return [(line, [f"{start + scope.offset}", f"{stop + scope.offset}", f"{step}"])]
