"""Contact pairs of Abaqus and CalculiX decks, with their friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from stickslip.formats.meshes.keyword_deck import Card
from stickslip.formats.meshes.raw_contacts import RawContact
from stickslip.formats.meshes.raw_model import RawModel


@dataclass
class _Interaction:
    """Friction of a *SURFACE INTERACTION; ``notes`` are properties that a joint of a study does not have."""

    friction: float | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Pair:
    """Two surfaces by name, the interaction, whether they are tied, and the line."""

    first: str
    second: str
    interaction: str
    is_bonded: bool
    line: int


class ContactCards:
    """Reads the cards of contact one after the other; :meth:`write` resolves them after the last surface."""

    def __init__(self, raw: RawModel) -> None:
        self._raw = raw
        self._interactions: dict[str, _Interaction] = {}
        self._current: _Interaction | None = None
        self._pairs: list[_Pair] = []
        self._assigned: dict[tuple[str, str], str] = {}
        self.cards: dict[str, Callable[[Card], None]] = {
            "SURFACE INTERACTION": self._begin_interaction,
            "FRICTION": self._friction,
            "CONTACT PAIR": self._pair,
            "CONTACT": lambda card: None,
            "CONTACT INCLUSIONS": self._inclusions,
            "CONTACT PROPERTY ASSIGNMENT": self._assignment,
        }

    def _begin_interaction(self, card: Card) -> None:
        self._current = self._interactions.setdefault(card.parameter("NAME").upper(), _Interaction())

    def _friction(self, card: Card) -> None:
        if self._current is None:
            card.fail("there is no *SURFACE INTERACTION above.")
        notes = []
        if "ROUGH" in card.parameters:
            notes.append("the file allows no sliding (ROUGH), which a joint of a study does")
        elif "USER" in card.parameters:
            notes.append("the friction is a user subroutine, which stickslip does not read")
        elif card.data and card.data[0][1][0]:
            line, words = card.data[0]
            value = card.number(words[0], line)
            if value < 0.0:
                card.fail(f"the friction coefficient is {words[0]}; it must be 0 or more.", line)
            self._current.friction = value
            if "EXPONENTIAL DECAY" in card.parameters:
                notes.append("the friction decreases with the sliding speed; this is the static coefficient")
            elif len(card.data) > 1:
                notes.append(f"line {card.line}: the friction depends on other quantities; this is its first value")
        if "TAUMAX" in card.parameters:
            notes.append(f"the file limits the shear stress (TAUMAX={card.parameters['TAUMAX'][:20]})")
        self._current.notes += tuple(notes)

    def _pair(self, card: Card) -> None:
        interaction = card.parameters.get("INTERACTION", "").upper()
        for line, words in card.data:
            names = [word for word in words if word][:2]
            if not names:
                card.fail("a line contains the dependent surface and the independent one.", line)
            self._pairs.append(_Pair(names[0], names[-1], interaction, "TIED" in card.parameters, line))

    def _inclusions(self, card: Card) -> None:
        named = [(line, words) for line, words in card.data if len(words) > 1 and words[0] and words[1]]
        self._pairs += [_Pair(words[0], words[1], "", False, line) for line, words in named]
        if not named:
            self._raw.messages.append(
                f"line {card.line}: general contact names no pairs of surfaces, so that stickslip proposes no joints. "
                "Give [interfaces.NAME] in the study."
            )

    def _assignment(self, card: Card) -> None:
        for _, words in card.data:
            first, second, interaction = (*words, "", "", "")[:3]
            self._assigned[first.upper(), second.upper()] = interaction.upper()

    def _surface(self, name: str) -> str:
        """The name of a surface or node set as first written."""
        for sets in (self._raw.face_sets, self._raw.node_sets):
            for each in sets:
                if each.upper() == name.upper():
                    return each
        return name

    def write(self) -> None:
        """Put the pairs into the raw model. Raises ImportFileError for an interaction that does not exist."""
        for pair in self._pairs:
            keys = ((pair.first.upper(), pair.second.upper()), (pair.second.upper(), pair.first.upper()), ("", ""))
            assigned = [self._assigned[key] for key in keys if key in self._assigned]
            interaction = pair.interaction or (assigned[0] if assigned else "")
            if interaction and interaction not in self._interactions:
                self._raw.fail(f"there is no *SURFACE INTERACTION, NAME={interaction[:60]}.", pair.line)
            properties = self._interactions.get(interaction, _Interaction())
            first, second = self._surface(pair.first), self._surface(pair.second)
            if first == second:
                self._raw.messages.append(
                    f"line {pair.line}: surface '{first}' is in contact with itself, which is not read; give the two "
                    "faces as a joint of the study."
                )
                continue
            name = f"{first} - {second}"
            self._raw.contacts.append(
                RawContact(name, first, second, properties.friction, pair.line, pair.is_bonded, properties.notes)
            )
