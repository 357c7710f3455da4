"""Axes of the maps of contact faces, named by the directions of the structure."""

from __future__ import annotations

from stickslip.core.shown_numbers import number
from stickslip.core.validation import FloatArray
from stickslip.results.record import StudyRecord

# chosen: a part of a unit vector below it is not named; it turns the direction by less than 0.3 degrees.
_SMALLEST_PART = 5e-3


def map_titles(study: StudyRecord, face: int) -> tuple[str, str]:
    """Titles of the horizontal and the vertical axis of the map of a face: t2 to the right, t1 upwards.

    The vertical axis is short, so a long title of it has two lines.
    """
    directions = study.face_directions
    if directions is None or not directions.tangent1[face].any():
        return "Along the face, mm", "Across, mm"
    across, up = in_axes(directions.tangent2[face]), in_axes(directions.tangent1[face])
    return f"t2 = {across}, mm", f"t1, mm\n{up}" if " " in up else f"t1 = {up}, mm"


def in_axes(direction: FloatArray) -> str:
    """A unit vector (3,) in words: "y", "−z" or "0.5 x + 0.87 z"."""
    words = ""
    for part, axis in zip(direction, "xyz", strict=True):
        if abs(part) < _SMALLEST_PART:
            continue
        size = "" if abs(part) > 1.0 - _SMALLEST_PART else f"{number(abs(float(part)), 2)} "
        sign = "−" if part < 0.0 else "+" if words else ""
        words += f"{' ' if words else ''}{sign}{' ' if words else ''}{size}{axis}"
    return words
