"""Marker shapes, line styles and units that all figures share."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.core.plain_figure import BLUE, GREEN, VERMILLION
from stickslip.core.shown_numbers import number
from stickslip.results.measures import hertz

# Bodies of a structure: pale, so that contact, marks and words stand out from them.
BODY_COLOURS = ("#b3d5e8", "#eae6e0", "#8d94a0", "#f2cf80", "#56b4e9", "#b8ad98")
FACE_COLOURS = (VERMILLION, "#4b2e83", "#007a5e", "#8c1c13")  # of contact faces: dark, apart for every eye


@dataclass(frozen=True)
class StateStyle:
    """How a contact state is drawn: by shape as well as by colour, so that a grey print can be read."""

    colour: str
    plotly_symbol: str
    matplotlib_marker: str


# By the code of ContactState; their names are those that the laws of the pairs give them.
STATES = (
    StateStyle(BLUE, "circle", "o"),
    StateStyle(GREEN, "square", "s"),
    StateStyle(VERMILLION, "triangle-up", "^"),
)

NEGLIGIBLE_PERCENT = 0.005  # chosen: smaller percentages of two results are those of tolerances

AXIS_NAMES = ("t1", "t2", "n")
LINE_COLOURS = (BLUE, VERMILLION, GREEN)
LINE_DASHES = ("solid", "dash", "dot")


def body_colour(body: int) -> str:
    """Colour of a body of a structure; colours repeat."""
    return BODY_COLOURS[body % len(BODY_COLOURS)]


def face_colour(face: int) -> str:
    """Colour of a contact face; colours repeat."""
    return FACE_COLOURS[face % len(FACE_COLOURS)]


def shown_measure(value: float, unit: str) -> str:
    """A measure of a result in tables beside others: a negligible percentage is zero."""
    return shown_number(0.0 if unit == "%" and abs(value) < NEGLIGIBLE_PERCENT else value, unit)


def shown_number(value: float | int | str, unit: str) -> str:
    """A derived number as tables show it: four digits, frequencies as :func:`stickslip.results.measures.hertz` says."""
    return hertz(value).replace("-", "−") if unit == "Hz" and isinstance(value, float) else number(value)
