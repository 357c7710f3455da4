"""Mass points (CONM2) and springs (CELAS1 with PELAS, CELAS2) of Nastran."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.formats.meshes.bulk_data import BulkCard
from stickslip.formats.meshes.raw_model import RawModel
from stickslip.formats.meshes.raw_points import RawMass, RawSpring


class NastranPoints:
    """Reads the cards one after the other; :meth:`write` resolves them after the last property."""

    def __init__(self, raw: RawModel) -> None:
        self._raw = raw
        self._springs: list[BulkCard] = []
        self._stiffness: dict[int, float] = {}
        self.cards: dict[str, Callable[[BulkCard], None]] = {
            "CONM2": self._mass,
            "CELAS1": self._springs.append,
            "CELAS2": self._springs.append,
            "PELAS": self._property,
        }

    def _mass(self, card: BulkCard) -> None:
        node = np.array([card.integer(1)], dtype=np.int64)
        x, y, z = (card.real(at, 0.0) for at in range(4, 7))
        xx, yx, yy, zx, zy, zz = (card.real(at, 0.0) for at in range(8, 14))
        inertia = xx, yy, zz, -yx, -zx, -zy  # the card has the integrals of x y dm and so on, without their sign
        in_basic = card.integer(2, 0) == 0
        self._raw.masses.append(RawMass(node, card.real(3, 0.0), card.line, (x, y, z), inertia, in_basic))

    def _property(self, card: BulkCard) -> None:
        for at in (0, 4):
            if card.word(at):
                self._stiffness[card.integer(at)] = card.real(at + 1)

    def write(self, turned: set[int]) -> None:
        """Put springs into the raw model; ``turned`` are grids with directions of their own (CD)."""
        for card in self._springs:
            self._spring(card, turned)

    def _spring(self, card: BulkCard, turned: set[int]) -> None:
        if card.name == "CELAS2":
            stiffness = card.real(1)
        else:
            number = card.integer(1, card.integer(0))
            if number not in self._stiffness:
                card.fail(f"there is no PELAS {number}.")
            stiffness = self._stiffness[number]
        ends = [(card.integer(at), card.integer(at + 1, 0)) for at in (2, 4) if card.word(at) not in ("", "0")]
        if not ends:
            card.fail("it has no grid.")
        if any(not 1 <= direction <= 6 for _, direction in ends):
            self._raw.messages.append(f"{card.where()}: {card.name}: a spring at a scalar point is ignored.")
            return
        if any(node in turned for node, _ in ends):
            card.fail(
                "one of its grids has a coordinate system of displacements (CD), so that its components are not "
                "x, y, z, which is not read."
            )
        (node, direction), *others = ends
        other = (others[0][0], others[0][1] - 1) if others else None
        self._raw.springs.append(
            RawSpring(np.array([node], dtype=np.int64), direction - 1, stiffness, card.line, other)
        )
