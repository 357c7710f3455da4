"""Grids of Nastran: GRID with the defaults of GRDSET, positions, permanent constraints and directions."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.bulk_data import BulkCard
from stickslip.formats.meshes.nastran_frames import Frame
from stickslip.formats.meshes.nastran_systems import GridPosition, Systems
from stickslip.formats.meshes.raw_model import RawConstraint, RawModel
from stickslip.structure.cell_kinds import IntArray

_CP, _CD, _PS = 1, 5, 6  # fields after the name
_PARALLEL = 1e-9  # largest deviation from x, y, z of directions that count as equal to them


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
        """Positions of the grids by the number of their system CP or CD, those in the basic system left out."""
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

    def in_basic_directions(
        self, raw: RawModel, constraints: Iterable[RawConstraint], systems: Systems, solid_nodes: IntArray
    ) -> list[RawConstraint]:
        """Constraints in basic x, y, z from those in the directions that CD gives each grid.

        The components of all constraints of a grid are combined: they can be converted to x, y, z if the constrained
        directions span the same line, plane or space as some of x, y, z. Grids without a solid element are not in the
        model, so their CD has no effect. A message reports the number of grids with a CD.

        Raises ImportFileError for a CD that does not exist, and for constraints in other directions.
        """
        solid = set(solid_nodes.tolist())
        frames: dict[int, tuple[int, Frame]] = {}  # label -> position, system
        for number, members in self._by_system(_CD).items():
            frame = systems.frame(number, self._card_with_field(self._cards[members[0]], _CD))
            labels = raw.node_labels[members].tolist()
            frames |= {label: (at, frame) for label, at in zip(labels, members, strict=True) if label in solid}
        if not frames:
            return [*constraints]
        raw.messages.append(
            f"{len(frames)} grids have a coordinate system of displacements (CD), the first of them {min(frames)}: "
            "stickslip converts their constraints to x, y, z, the directions of all displacements."
        )
        answer: list[RawConstraint] = []
        components: dict[int, set[int]] = {}
        lines: dict[int, int] = {}
        for entry in constraints:
            turned = np.array([label in frames for label in entry.nodes.tolist()], dtype=bool)
            for label in entry.nodes[turned].tolist():
                components.setdefault(label, set()).update(entry.directions)
                lines.setdefault(label, entry.line)
            if not turned.all():
                answer.append(RawConstraint(entry.nodes[~turned], entry.directions, entry.line))
        for label, axes in components.items():
            at, frame = frames[label]
            directions = _basic_directions(frame, raw.coordinates[at], axes)
            if directions is None:
                self._cards[at].fail(
                    f"grid {label} has its displacements in the system {self._system(self._cards[at], _CD)} (CD), and "
                    f"the constraint in {raw.where(lines[label])} constrains {_words(axes)} of them, not along x, y or "
                    "z at this position. Constrain 1, 2 and 3, or give the grid a CD with axes along x, y, z."
                )
            answer.append(RawConstraint(np.array([label], dtype=np.int64), directions, lines[label]))
        return answer


def _basic_directions(frame: Frame, place: FloatArray, constrained: set[int]) -> tuple[int, ...] | None:
    """Which of x, y, z (0, 1, 2) span the same as the directions ``constrained`` of a system; None if none do."""
    rows, lacking = frame.directions(place)
    if lacking & constrained and not lacking <= constrained:
        return None
    axes = rows[sorted(constrained)]
    projector = axes.T @ axes
    whole = np.round(projector)
    if not np.abs(projector - whole).max() <= _PARALLEL:
        return None
    return tuple(np.flatnonzero(np.diag(whole)).tolist())


def _words(components: set[int]) -> str:
    numbers = [str(each + 1) for each in sorted(components)]
    return f"component{'s' if len(numbers) > 1 else ''} {' and '.join(numbers)}"


def constrained_nodes(card: BulkCard, components: str, nodes: list[int]) -> RawConstraint:
    """Constrained nodes along the translations among ``components``, of 1 to 6, as on a card.

    Raises ImportFileError for other components, and where there are none or no nodes.
    """
    if not nodes or not components or set(components) - set("123456"):
        card.fail(f'it requires components of 1 to 6 and grids, but it has "{components[:12]}" and {len(nodes)} grids.')
    solid = tuple(sorted({int(each) - 1 for each in components if each in "123"}))
    return RawConstraint(np.array(nodes, dtype=np.int64), solid, card.line)
