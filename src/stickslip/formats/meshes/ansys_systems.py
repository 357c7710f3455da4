"""Coordinate systems of Ansys archives: axes of turned nodes, and of elements by the command LOCAL.

Source: Ansys Mechanical APDL command reference, LOCAL and N (angles THXY, THYZ, THZX).
"""

from __future__ import annotations

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.ansys_archive import Entry


def rotated_axes(angles_degrees: list[float]) -> FloatArray:
    """Rows (3, 3): axes turned about z, then about the new x, then about the new y axis, each by an angle."""
    (z, x, y) = np.radians(angles_degrees)
    about_z = np.array([[np.cos(z), np.sin(z), 0.0], [-np.sin(z), np.cos(z), 0.0], [0.0, 0.0, 1.0]])
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(x), np.sin(x)], [0.0, -np.sin(x), np.cos(x)]])
    about_y = np.array([[np.cos(y), 0.0, -np.sin(y)], [0.0, 1.0, 0.0], [np.sin(y), 0.0, np.cos(y)]])
    return np.asarray(about_y @ about_x @ about_z)


class CoordinateSystems:
    """Reads LOCAL; :meth:`axes` gives the axes of a rectangular system after the last command."""

    def __init__(self) -> None:
        self._angles: dict[int, list[float]] = {}  # of rectangular systems
        self._round: set[int] = set()

    def take(self, entry: Entry) -> None:
        """Read one command: LOCAL,number,kind,x,y,z,angles, or LOCAL,R5.0,LOC | ANG | PRM,number,kind,values."""
        by_archive = entry.word(0).startswith("R")
        part, first = (entry.word(1), 2) if by_archive else ("", 0)
        number, kind = entry.label(entry.word(first)), entry.word(first + 1)
        if kind not in ("", "0", "CART"):
            self._round.add(number)
            return
        at = first + (2 if by_archive else 5)  # of the angles
        angles = [entry.number(entry.word(position)) for position in range(at, at + 3)]
        if part in ("", "ANG"):
            self._angles[number] = angles

    def axes(self, number: int) -> FloatArray | str | None:
        """Axes (3, 3) of a system as rows; None for that of the file; else why it has none, in words."""
        if number == 0:
            return None
        if number in self._angles:
            return rotated_axes(self._angles[number])
        return "is not rectangular" if number in self._round else "is not defined by LOCAL"
