"""Colours of all pages keep apart for every kind of colour vision, and from the white that they are drawn on."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from colour_vision import VISION, contrast, difference, seen
from stickslip.core import plain_figure
from stickslip.papers.rough_damper import figures
from stickslip.reporting import style, sweep_view

# Differences (CIEDE2000) of about 2 are seen side by side; these are lines and marks apart from each other.
STATES_APART, SERIES_APART = 12.0, 8.0
SETS = {
    "states": ([state.colour for state in style.STATES], STATES_APART),
    "lines of the report": (style.LINE_COLOURS, STATES_APART),
    "series of a sweep": (sweep_view.COLOURS, SERIES_APART),
    "series of the paper study": (figures.COLOURS, SERIES_APART),
}


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
        ((50.0, 2.5, 0.0), (73.0, 25.0, -18.0), 27.1492),
        ((90.8027, -2.0831, 1.4410), (91.1528, -1.6435, 0.0447), 1.4441),
        ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
    ],
)
def test_the_difference_is_that_of_the_published_test_data(
    first: tuple[float, ...], second: tuple[float, ...], expected: float
) -> None:
    assert difference(np.array(first), np.array(second)) == pytest.approx(expected, abs=1e-4)


def test_the_simulation_confuses_what_the_colour_blind_confuse() -> None:
    red, green = "#c05050", "#6f8a3c"
    usual, red_blind = (difference(seen(red, v), seen(green, v)) for v in ("usual", "deuteranopia"))
    assert usual > 30.0
    assert red_blind < 0.5 * usual


@pytest.mark.parametrize("vision", VISION)
@pytest.mark.parametrize("name", SETS)
def test_colours_keep_apart(name: str, vision: str) -> None:
    colours, least = SETS[name]
    for first, second in itertools.combinations(colours, 2):
        assert difference(seen(first, vision), seen(second, vision)) >= least, (first, second)


def test_marks_stand_out_from_white() -> None:
    for colour in (*(state.colour for state in style.STATES), *style.LINE_COLOURS):
        assert contrast(colour, "#ffffff") >= 3.0
    # Orange, the palest of the palette: darker it could not be told from vermillion by the green-blind. It comes late
    # in every series, and never without its own dash.
    assert [c for c in (*sweep_view.COLOURS, *figures.COLOURS) if contrast(c, "#ffffff") < 3.0] == [
        plain_figure.ORANGE
    ] * 2
    assert contrast(plain_figure.ORANGE, "#ffffff") > 2.2


def test_shape_and_dash_show_the_same_as_colour() -> None:
    assert len({state.plotly_symbol for state in style.STATES}) == len(style.STATES)
    assert len(set(style.LINE_DASHES)) == len(style.LINE_COLOURS)


def test_words_stand_out_from_their_ground() -> None:
    for words, ground in (
        (plain_figure.INK, "#f4f6f8"),
        ("#52606d", "#f4f6f8"),
        ("#b3261e", "#fdf0ef"),
        ("#8a5a00", "#fff8e8"),
        ("#00614a", "#e5f4ee"),
        ("#7a5200", "#fff3d6"),
        ("#8f3d00", "#fdeadf"),
        ("#52606d", "#eef1f4"),
        ("#a9c7de", plain_figure.INK),
        ("#b6c2ce", plain_figure.INK),
    ):
        assert contrast(words, ground) >= 4.5, (words, ground)
        if ground != plain_figure.INK:
            assert words == plain_figure.INK or words in _sheets(), words


def _sheets() -> str:
    from stickslip.reporting.templates import asset

    return asset("page.css") + asset("paper.css", "stickslip.papers.rough_damper")
