"""Grids of Nastran: GRID with the defaults of GRDSET, positions, permanent constraints and directions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.bulk_data import BulkCard
from stickslip.formats.meshes.directions import basic_constraints
from stickslip.formats.meshes.nastran_systems import GridPosition, Systems
from stickslip.formats.meshes.raw_model import RawConstraint, RawModel
from stickslip.formats.meshes.raw_ties import RawEquation

_CP, _CD, _PS = 1, 5, 6  # fields after the name


class Grids:
    """GRID and GRDSET cards, in any order; other methods are called after the last one."""

    def __init__(self) -> None:
        self._cards: list[BulkCard] = []
        self._defaults: BulkCard | None = None
        self._position: dict[int, int] = {}  # label -> of its first card

    def add(self, card: BulkCard) -> None:
        """Take a GRID."""
        self._position.setdefault(card.integer(0), len(self._cards))
        self._cards.append(card)

    def set_defaults(self, card: BulkCard) -> None:
        """Take the GRDSET; raises ImportFileError for a second one."""
        if self._defaults is not None:
            card.fail(f"there is another one in {self._defaults.where()}; only one may set the defaults of grids.")
        self._defaults = card

    def place(self, label: int) -> GridPosition | None:
        """Position of a grid as on its card; None if there is none of this label."""
        at = self._position.get(label)
        if at is None:
            return None
        card = self._cards[at]
        coordinates = np.array([card.real(position, 0.0) for position in (2, 3, 4)])
        return GridPosition(self._system(card, _CP), coordinates, self._card_with_field(card, _CP))

    def basic_place(self, label: int, raw: RawModel) -> FloatArray | None:
        """Basic x, y, z (3,) of a grid after ``write_to``; None if there is none of this label."""
        at = self._position.get(label)
        return None if at is None else raw.coordinates[at]

    def write_to(self, raw: RawModel, systems: Systems) -> None:
        """Set labels, basic coordinates and lines of the nodes. Raises ImportFileError."""
        raw.node_labels = np.array([card.integer(0) for card in self._cards], dtype=np.int64)
        raw.node_lines = np.array([card.line for card in self._cards], dtype=np.int64)
        coordinates = np.array(
            [[card.real(position, 0.0) for position in (2, 3, 4)] for card in self._cards], dtype=float
        )
        raw.coordinates = coordinates.reshape(-1, 3)
        for number, members in self._by_system(_CP).items():
            frame = systems.frame(number, self._card_with_field(self._cards[members[0]], _CP))
            raw.coordinates[members] = frame.basic(raw.coordinates[members])

    def _card_with_field(self, card: BulkCard, field: int) -> BulkCard:
        """The card that gives a field of a grid: its own, or the GRDSET where it is blank."""
        return card if card.word(field) or self._defaults is None else self._defaults

    def _system(self, card: BulkCard, field: int) -> int:
        return self._card_with_field(card, field).integer(field, 0)

    def _by_system(self, field: int) -> dict[int, list[int]]:
        """Positions of the grids by the number of their system CP or CD, without those in the basic system."""
        answer: dict[int, list[int]] = {}
        for at, card in enumerate(self._cards):
            number = self._system(card, field)
            if number:
                answer.setdefault(number, []).append(at)
        return answer

    def permanent_constraints(self) -> list[RawConstraint]:
        """Constraints of the field PS of each grid, independent of the case control; 0 is none."""
        answer = []
        for card in self._cards:
            source = self._card_with_field(card, _PS)
            if source.word(_PS) not in ("", "0"):
                answer.append(constrained_nodes(source, source.word(_PS), [card.integer(0)]))
        return answer

    def frames(self, raw: RawModel, systems: Systems) -> dict[int, tuple[FloatArray, frozenset[int]]]:
        """Directions 1, 2, 3 (3, 3) as rows of the grids with a CD, by label, and which of them have no direction."""
        answer = {}
        for number, members in self._by_system(_CD).items():
            frame = systems.frame(number, self._card_with_field(self._cards[members[0]], _CD))
            for at in members:
                answer[int(raw.node_labels[at])] = frame.directions(raw.coordinates[at])
        return answer

    def in_basic_directions(
        self,
        raw: RawModel,
        constraints: Iterable[RawConstraint],
        frames: Mapping[int, tuple[FloatArray, frozenset[int]]],
    ) -> tuple[list[RawConstraint], list[RawEquation]]:
        """Constraints in basic x, y, z from those in the directions that CD gives each grid, and equations where these
        span none of x, y, z. The components of all constraints of a grid are combined.

        Raises ImportFileError for constraints along a direction that does not exist, on the axis of a system.
        """
        constraints = list(constraints)
        components: dict[int, set[int]] = {}
        for entry in constraints:
            for label in entry.nodes.tolist():
                if label in frames:
                    components.setdefault(label, set()).update(entry.directions)
        for label, chosen in components.items():
            lacking = frames[label][1]
            if lacking & chosen and not lacking <= chosen:
                at = self._position[label]
                line = next(entry.line for entry in constraints if label in entry.nodes)
                self._cards[at].fail(
                    f"grid {label} is on the axis of its system {self._system(self._cards[at], _CD)} (CD), so that "
                    f"{_words(chosen)}, which {raw.where(line)} constrains, has no direction there. Constrain 1, 2 and "
                    "3, or give the grid a rectangular system."
                )
        return basic_constraints(constraints, {label: rows for label, (rows, _) in frames.items()})


def _words(components: set[int]) -> str:
    numbers = [str(each + 1) for each in sorted(components) if each < 3]
    return f"component{'s' if len(numbers) > 1 else ''} {' and '.join(numbers)}"


def constrained_nodes(card: BulkCard, components: str, nodes: list[int]) -> RawConstraint:
    """Constrained nodes along ``components``, of 1 to 6, as on a card.

    Raises ImportFileError for other components, and where there are none or no nodes.
    """
    if not nodes or not components or set(components) - set("123456"):
        card.fail(f'it requires components of 1 to 6 and grids, but it has "{components[:12]}" and {len(nodes)} grids.')
    directions = tuple(sorted({int(each) - 1 for each in components}))
    return RawConstraint(np.array(nodes, dtype=np.int64), directions, card.line)
