"""Materials of Abaqus and CalculiX decks: elastic constants of any symmetry, density, and the axes of a section."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.abaqus_systems import axes_of, without_end
from stickslip.formats.meshes.keyword_deck import Card
from stickslip.formats.meshes.raw_materials import COUNTS, RawMaterial, RawTable, Symmetry
from stickslip.formats.meshes.raw_model import RawModel

_SYMMETRIES: dict[str, Symmetry] = {
    **dict.fromkeys(("ISO", "ISOTROPIC"), "isotropic"),
    "ENGINEERING CONSTANTS": "engineering",
    **dict.fromkeys(("ORTHO", "ORTHOTROPIC"), "orthotropic"),
    **dict.fromkeys(("ANISO", "ANISOTROPIC"), "anisotropic"),
}
_IN_LINE = 8  # numbers in a line of a deck


class MaterialCards:
    """Reads the cards of materials one after the other."""

    def __init__(self, raw: RawModel) -> None:
        self._raw = raw
        self._name = ""
        self._orientations: dict[tuple[str, str], Card] = {}  # by instance and name in capitals
        self.cards: dict[str, Callable[[Card], None]] = {
            "MATERIAL": self._begin,
            "ELASTIC": self._elastic,
            "DENSITY": self._density,
            "ORIENTATION": self._orientation,
        }

    def axes(self, section: Card) -> FloatArray | None:
        """The axes of the material of a section, as rows; None without ORIENTATION= and for isotropic materials.

        Raises ImportFileError for an orientation that does not exist or is not constant.
        """
        name = section.parameters.get("ORIENTATION", "")
        material = self._raw.materials.get(section.parameter("MATERIAL").upper())
        if not name or material is None or material.symmetry == "isotropic":
            return None
        card = self._orientations.get((section.instance, name.upper()))
        if card is None:
            section.fail(f"there is no *ORIENTATION, NAME={name[:60]}.")
        return _axes(card)

    def _begin(self, card: Card) -> None:
        self._name = card.parameter("NAME").upper()
        if self._name in self._raw.materials:
            card.fail(f"material '{self._name}' is defined twice.")
        self._raw.materials[self._name] = RawMaterial.of_constants(None, None, None, card.line)

    def _elastic(self, card: Card) -> None:
        kind = card.parameters.get("TYPE", "ISO").upper()
        symmetry = _SYMMETRIES.get(kind)
        if symmetry is None:
            card.fail(f"TYPE={kind} is not read; these are: {', '.join(_SYMMETRIES)}.")
        table = self._table(card, COUNTS[symmetry])
        self._change(card, elastic=table, symmetry=symmetry)

    def _density(self, card: Card) -> None:
        self._change(card, density=self._table(card, 1))

    def _change(self, card: Card, **changes: object) -> None:
        before = self._raw.materials[self._name]
        self._raw.materials[self._name] = replace(before, **changes)  # type: ignore[arg-type]

    def _table(self, card: Card, count: int) -> RawTable:
        """Rows of ``count`` numbers and a temperature, each over as many lines as they require."""
        if not self._name:
            card.fail("there is no *MATERIAL above.")
        lines = (count + 1 + _IN_LINE - 1) // _IN_LINE if count > _IN_LINE else 1
        rows, temperatures = [], []
        for start in range(0, len(card.data), lines):
            line = card.data[start][0]
            words = [word for _, each in card.data[start : start + lines] for word in without_end(each)]
            if len(words) < count:
                card.fail(f"{count} numbers are required below.", line)
            rows.append([card.number(word, line) for word in words[:count]])
            temperatures.append(card.number(words[count], line) if len(words) > count and words[count] else 0.0)
        if not rows:
            card.fail(f"{count} numbers are required below.")
        if "DEPENDENCIES" in card.parameters:
            card.fail("constants that depend on field variables (DEPENDENCIES=) are not read. Give constants.")
        if not (np.diff(temperatures) > 0.0).all():
            card.fail("the temperatures of its rows must rise.")
        return RawTable(np.array(rows), np.array(temperatures))

    def _orientation(self, card: Card) -> None:
        self._orientations[card.instance, card.parameter("NAME").upper()] = card


def _axes(card: Card) -> FloatArray:
    """*ORIENTATION: a point on axis 1 and one in the plane of axes 1 and 2, then a turn about one of them."""
    system = card.parameters.get("SYSTEM", "RECTANGULAR").upper()
    definition = card.parameters.get("DEFINITION", "COORDINATES").upper()
    if system not in ("RECTANGULAR", "R") or definition != "COORDINATES":
        card.fail(
            "only SYSTEM=RECTANGULAR with DEFINITION=COORDINATES is read, because the axes of a body must be "
            "constant. Divide the body, or write its axes as points."
        )
    rows = [(line, [card.number(word or "0", line) for word in without_end(words)]) for line, words in card.data]
    if not rows or len(rows[0][1]) not in (6, 9):
        card.fail("it requires the six coordinates of a point on axis 1 and of one in the plane of axes 1 and 2.")
    values = np.array(rows[0][1])
    origin = values[6:] if len(values) == 9 else np.zeros(3)
    axes = axes_of(card, values[:3] - origin, values[3:6] - origin)
    if len(rows) > 1:
        axis, angle = (*rows[1][1], 0.0, 0.0)[:2]
        if axis not in (0.0, 1.0, 2.0, 3.0):
            card.fail(f"the axis of the additional turn is {axis:g}; it must be 1, 2 or 3.", rows[1][0])
        axes = _turned(axes, int(axis or 3) - 1, np.radians(angle))
    return axes


def _turned(axes: FloatArray, about: int, angle: float) -> FloatArray:
    """Axes (3, 3), rows, after a right-handed turn about one of them."""
    second, third = (about + 1) % 3, (about + 2) % 3
    answer = axes.copy()
    answer[second] = np.cos(angle) * axes[second] + np.sin(angle) * axes[third]
    answer[third] = np.cos(angle) * axes[third] - np.sin(angle) * axes[second]
    return answer
