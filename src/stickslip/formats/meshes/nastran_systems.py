"""Coordinate systems of Nastran: CORD1R, CORD1C, CORD1S by three grids, CORD2R, CORD2C, CORD2S by three places."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.bulk_data import BulkCard
from stickslip.formats.meshes.nastran_frames import BASIC, Frame, Kind

_KINDS: dict[str, Kind] = {"R": "rectangular", "C": "cylindrical", "S": "spherical"}
SYSTEM_CARDS = tuple(f"CORD{way}{kind}" for way in (1, 2) for kind in _KINDS)
_SHOWN = 6  # chosen: systems in a message


@dataclass(frozen=True)
class GridPosition:
    """Three coordinates (3,) in the system with a number, from a card."""

    system: int
    coordinates: FloatArray
    card: BulkCard


@dataclass(frozen=True)
class _Definition:
    """The card of a system, and the three grids of a CORD1, or the three places of a CORD2."""

    card: BulkCard
    grids: tuple[int, ...] = ()
    places: tuple[GridPosition, ...] = ()


class Systems:
    """Systems by number. Each may be defined in another one, or by grids in another one; the order of the cards is
    free."""

    def __init__(self, grid: Callable[[int], GridPosition | None]) -> None:
        """``grid`` returns the position of a grid by its label, or None; it is called after the last card."""
        self._grid = grid
        self._definitions: dict[int, _Definition] = {}
        self._resolved: dict[int, Frame] = {0: BASIC}

    def add(self, card: BulkCard) -> None:
        """Take a card, a CORD1 with one system or two.

        Raises ImportFileError for a number that is 0 or comes twice, and for a CORD2 without its third place.
        """
        if card.name.startswith("CORD1"):
            for at in (0, 4):
                if at == 0 or card.word(at):
                    self._define(card.integer(at), _Definition(card, tuple(card.integer(at + n) for n in (1, 2, 3))))
            return
        if len(card.fields) <= 8:
            card.fail("its second line, with the third point, is missing.")
        reference = card.integer(1, 0)
        places = [[card.real(at + axis, 0.0) for axis in range(3)] for at in (2, 5, 8)]
        self._define(
            card.integer(0),
            _Definition(card, places=tuple(GridPosition(reference, np.array(place), card) for place in places)),
        )

    def _define(self, number: int, definition: _Definition) -> None:
        if not number:
            definition.card.fail("0 is the basic system; number it from 1.")
        if number in self._definitions:
            definition.card.fail(
                f"system {number} is defined twice (first in {self._definitions[number].card.where()})."
            )
        self._definitions[number] = definition

    def frame(self, number: int, user: BulkCard) -> Frame:
        """The system of a number, which the card ``user`` names.

        Raises ImportFileError, each with the card that is wrong, for a system or a grid of it that does not exist,
        systems that are given in themselves, and three places in one line.
        """
        waiting = {number: user}  # the one before needs each
        while waiting:
            current, named_by = next(reversed(waiting.items()))
            definition = self._definitions.get(current)
            if current not in self._resolved:
                if definition is None:
                    named_by.fail(
                        f"there is no coordinate system {current}. stickslip reads {', '.join(SYSTEM_CARDS)}: add one "
                        "of this number, or use the basic system (0)."
                    )
                needed = next((each for each in self._places(definition) if each.system not in self._resolved), None)
                if needed is not None:
                    if needed.system in waiting:
                        circle = [*waiting][[*waiting].index(needed.system) :]
                        way = ", ".join(map(str, circle[1:_SHOWN]))
                        needed.card.fail(
                            f"the system {needed.system} depends on itself{', through ' if way else ''}{way}"
                            f"{' ...' if len(circle) > _SHOWN else ''}."
                        )
                    waiting[needed.system] = needed.card
                    continue
                self._resolved[current] = self._built(definition)
            del waiting[current]
        return self._resolved[number]

    def _places(self, definition: _Definition) -> Iterator[GridPosition]:
        """The three places that define a system."""
        yield from definition.places
        for label in definition.grids:
            place = self._grid(label)
            if place is None:
                definition.card.fail(f"grid {label}, one of its three, is not defined.")
            yield place

    def _built(self, definition: _Definition) -> Frame:
        points = [self._resolved[each.system].basic(each.coordinates[None, :])[0] for each in self._places(definition)]
        frame = Frame.through(_KINDS[definition.card.name[-1]], np.array(points))
        if frame is None:
            definition.card.fail("its three points are on one line and define no axes.")
        return frame
