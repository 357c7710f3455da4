"""Contact pairs of Nastran: BCTSET and BGSET (NX, Simcenter), BCTABLE and BCBODY (MSC), with their regions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from stickslip.formats.meshes.bulk_data import BulkCard
from stickslip.formats.meshes.raw_contacts import RawContact
from stickslip.formats.meshes.raw_model import RawModel, RawSides
from stickslip.structure.cell_kinds import CELL_KINDS, IntArray


@dataclass(frozen=True)
class Elements:
    """Kind and nodes of each solid, corners of each shell, and the solids of each property."""

    solids: Mapping[int, tuple[str, list[int]]]
    shells: Mapping[int, list[int]]
    of_property: Mapping[int, list[int]]


class NastranContact:
    """Reads the cards of contact one after the other; :meth:`write` resolves them after the last element."""

    def __init__(self) -> None:
        self._regions: dict[int, list[BulkCard]] = {}  # BSURF and BSURFS by number
        self._properties: dict[int, BulkCard] = {}  # BCPROP, BCPROPS
        self._bodies: dict[int, BulkCard] = {}
        self._sets: list[BulkCard] = []
        self.cards: dict[str, Callable[[BulkCard], None]] = {
            **dict.fromkeys(("BSURF", "BSURFS"), self._region),
            **dict.fromkeys(("BCPROP", "BCPROPS"), lambda card: self._properties.update({card.integer(0): card})),
            "BCBODY": lambda card: self._bodies.update({card.integer(0): card}),
            **dict.fromkeys(("BCTSET", "BGSET", "BCTABLE"), self._sets.append),
        }

    def _region(self, card: BulkCard) -> None:
        self._regions.setdefault(card.integer(0), []).append(card)

    def write(self, raw: RawModel, elements: Elements) -> None:
        """Face sets "region 3" and the pairs.

        Raises ImportFileError for a region that does not exist, and for an element or a grid that is not in it.
        """
        for card in self._sets:
            pairs = self._table(card) if card.name == "BCTABLE" else self._plain(card)
            for first, second, friction, is_bonded in pairs:
                names = [self._face(raw, card, number, elements) for number in (first, second)]
                name = f"{card.name} {card.integer(0)} {first} {second}"
                raw.contacts.append(RawContact(name, names[0], names[1], friction, card.line, is_bonded))

    def _plain(self, card: BulkCard) -> Iterator[tuple[int, int, float | None, bool]]:
        """Source, target, friction of each pair of a BCTSET or BGSET, eight fields each."""
        for at in range(0, len(card.fields), 8):
            if card.word(at + 1):
                friction = card.real(at + 3) if card.name == "BCTSET" and card.word(at + 3) else None
                yield card.integer(at + 1), card.integer(at + 2), friction, card.name == "BGSET"

    def _table(self, card: BulkCard) -> Iterator[tuple[int, int, float | None, bool]]:
        """Each body in contact with each master body of a BCTABLE. Raises ImportFileError for a table without any."""
        words = [word.upper() for word in card.fields]
        slaves = [at for at, word in enumerate(words) if word in ("SLAVE", "SECONDRY")]
        if not slaves:
            card.fail("it has no group SLAVE with its MASTERS.")
        for start, stop in zip(slaves, [*slaves[1:], len(words)], strict=True):
            masters = [at for at in range(start, stop) if words[at] in ("MASTERS", "PRIMARY")]
            if not masters:
                card.fail("a group SLAVE has no MASTERS.")
            friction = card.real(start + 4) if card.word(start + 4) else None
            glued = bool(card.integer(start + 6, 0))
            for at in range(masters[0] + 1, stop):
                if card.word(at):
                    yield card.integer(start + 1), card.integer(at), friction, glued

    def _face(self, raw: RawModel, card: BulkCard, number: int, elements: Elements) -> str:
        """The name of the face set of a region or contact body, which is made when it is first used."""
        body = self._bodies.get(number)
        region = body.integer(3, 0) if body is not None and card.name == "BCTABLE" else number
        name = f"{'contact body' if body is not None and card.name == 'BCTABLE' else 'region'} {number}"
        if name in raw.face_sets:
            return name
        entries = [side for each in self._regions.get(region, []) for side in _sides(each, elements)]
        if region in self._properties and not entries:
            each = self._properties[region]
            labels = [label for number in each.numbers(1) for label in elements.of_property.get(number, [])]
            entries = list(_sides_of_elements(each, labels, elements))
        if not entries:
            card.fail(f"there is no BSURF, BSURFS, BCPROP or BCPROPS {region} with sides of solid elements.")
        raw.face_sets[name] = entries
        raw.set_lines.setdefault(name, entries[0].line)
        return name


def _sides(card: BulkCard, elements: Elements) -> Iterator[RawSides]:
    """Sides of a BSURF by elements, or of a BSURFS by an element and three of its corners."""
    if card.name == "BSURF":
        yield from _sides_of_elements(card, card.numbers(1), elements)
        return
    for at in range(4, len(card.fields), 4):
        if not card.word(at):
            continue
        label = card.integer(at)
        if label not in elements.solids:
            card.fail(f"element {label} is not a solid element.")
        kind, nodes = elements.solids[label]
        wanted = {card.integer(at + step) for step in (1, 2, 3)}
        cell = CELL_KINDS[kind]
        fits = [
            position
            for position, side in enumerate(cell.sides)
            if wanted <= {nodes[node] for node in side if node < cell.n_corners}
        ]
        if len(fits) != 1:
            card.fail(f"the grids {', '.join(map(str, sorted(wanted)))} are on no side of element {label}.")
        yield RawSides(card.line, elements=_array([label]), side=fits[0])


def _sides_of_elements(card: BulkCard, labels: list[int], elements: Elements) -> Iterator[RawSides]:
    """All free sides of solids, and the sides under shells."""
    solids, shells = elements.solids, elements.shells
    missing = [label for label in labels if label not in solids and label not in shells]
    if missing:
        card.fail(f"element {missing[0]} is neither a solid nor a shell element.")
    inside = [label for label in labels if label in solids]
    if inside:
        yield RawSides(card.line, elements=_array(inside))
    for width in (3, 4):
        corners = [shells[label] for label in labels if label in shells and len(shells[label]) == width]
        if corners:
            yield RawSides(card.line, corners=_array(corners))


def _array(values: list[int] | list[list[int]]) -> IntArray:
    return np.array(values, dtype=np.int64)
