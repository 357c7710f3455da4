"""Rectangular coordinate systems of Nastran (CORD2R) in which grids may be given."""

from __future__ import annotations

import numpy as np

from stickslip.structure.importers.bulk_data import BulkCard
from stickslip.validation import FloatArray

_SHORTEST = 1e-9  # share of the distances between the three points below which they give no axes


class Frames:
    """CORD2R by number; each may be given in another one."""

    def __init__(self) -> None:
        self._cards: dict[int, BulkCard] = {}
        self._known: dict[int, tuple[FloatArray, FloatArray]] = {0: (np.zeros(3), np.eye(3))}

    def add(self, card: BulkCard) -> None:
        """Take a CORD2R; raises ImportFileError for a number that is 0 or comes twice."""
        number = card.integer(0)
        if not number or number in self._cards:
            card.fail(f"system {number} is defined twice." if number else "0 is the basic system; number it from 1.")
        self._cards[number] = card

    def basic(self, number: int, place: FloatArray, user: BulkCard) -> FloatArray:
        """Basic coordinates (3,) of a place in system ``number``, which ``user`` names. Raises ImportFileError."""
        origin, axes = self._frame(number, user, ())
        return np.asarray(origin + place @ axes)

    def _frame(self, number: int, user: BulkCard, path: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
        """Origin (3,) and axes (3, 3), one a row, of a system: A is the origin, B on z, C in the half plane of x, z."""
        if number in self._known:
            return self._known[number]
        if number in path:
            user.fail(f"the system {number} is given in itself.")
        if number not in self._cards:
            user.fail(
                f"it is given in coordinate system {number}, but only CORD2R (rectangular) is read, and there is none "
                "of this number. Write it in the basic system (0)."
            )
        card = self._cards[number]
        origin, axes = self._frame(card.integer(1, 0), card, (*path, number))
        a, b, c = (origin + np.array([card.real(at + axis, 0.0) for axis in range(3)]) @ axes for at in (2, 5, 8))
        z, y = b - a, np.cross(b - a, c - a)
        if np.linalg.norm(y) <= _SHORTEST * np.linalg.norm(z) * np.linalg.norm(c - a):
            card.fail("its three points lie in one line, so that they give no axes.")
        z, y = z / np.linalg.norm(z), y / np.linalg.norm(y)
        self._known[number] = a, np.vstack([np.cross(y, z), y, z])
        return self._known[number]
