"""Materials of Abaqus and CalculiX decks: isotropic elasticity and density."""

from __future__ import annotations

from collections.abc import Callable

from stickslip.formats.meshes.keyword_deck import Card
from stickslip.formats.meshes.raw_model import RawMaterial, RawModel


class MaterialCards:
    """Reads *MATERIAL and the cards of its constants below it."""

    def __init__(self, raw: RawModel) -> None:
        self._raw = raw
        self._current = ""  # name in capitals
        self.cards: dict[str, Callable[[Card], None]] = {
            "MATERIAL": self._begin,
            "ELASTIC": self._elastic,
            "DENSITY": self._density,
        }

    def _begin(self, card: Card) -> None:
        self._current = card.parameter("NAME").upper()
        if self._current in self._raw.materials:
            card.fail(f"material '{self._current}' is defined twice.")
        self._raw.materials[self._current] = RawMaterial(None, None, None, card.line)

    def _constants(self, card: Card, count: int) -> list[float]:
        """The first ``count`` numbers of a card of the current material."""
        if not self._current:
            card.fail("there is no *MATERIAL above.")
        if not card.data or len(card.data[0][1]) < count:
            card.fail(f"{count} numbers are required below.")
        if len(card.data) > 1:
            self._raw.messages.append(
                f"line {card.line}: *{card.keyword} of '{self._current}' depends on temperature; stickslip uses its "
                "first line only."
            )
        line, words = card.data[0]
        return [card.number(word, line) for word in words[:count]]

    def _elastic(self, card: Card) -> None:
        kind = card.parameters.get("TYPE", "ISO").upper()
        if kind not in ("ISO", "ISOTROPIC"):
            card.fail(
                f"TYPE={kind} is not read; isotropic materials are (two numbers: Young's modulus, Poisson's ratio)."
            )
        young, poisson = self._constants(card, 2)
        before = self._raw.materials[self._current]
        self._raw.materials[self._current] = RawMaterial(young, poisson, before.density, before.line)

    def _density(self, card: Card) -> None:
        (density,) = self._constants(card, 1)
        before = self._raw.materials[self._current]
        self._raw.materials[self._current] = RawMaterial(
            before.young_modulus, before.poisson_ratio, density, before.line
        )
