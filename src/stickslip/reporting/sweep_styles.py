"""One style for each key of a sweep on its whole page: colour, dash and mark, with their legend.

The key with the most values has the colour; of the others, one has the dash and one the mark, if it has enough of them
for its values. A key against which a figure plots has no style in it. Without any key, lines are blue.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.plain_figure import BLUE, INK
from stickslip.core.shown_numbers import number
from stickslip.reporting.sweep_view import (
    COLOURS,
    DASHES,
    MARKS,
    SCALE,
    axis_title,
    is_logarithmic,
    short_name,
    value_words,
)
from stickslip.results.sweep_table import SweptKey

LEGEND_ENTRIES = 12  # chosen: more do not fit beside a plot
SHADES = 60  # chosen: colours of very many curves
_LINE_PX = 20  # height of an entry of the legend


@dataclass(frozen=True)
class Style:
    """Look of the curve or the peaks of a case."""

    colour: str
    dash: str
    mark: str


@dataclass(frozen=True, eq=False)
class KeyStyles:
    """Which key each style shows, None if there is none: positions among the ``keys``."""

    keys: tuple[SweptKey, ...]
    colour: int
    dash: int | None
    mark: int | None

    def of(self, positions: NDArray[np.int64], without: int | None = None) -> Style:
        """The style of a row with these positions (n_keys,), in a figure against the key ``without``."""
        colour = INK if len(self.keys) > 1 else BLUE
        dash, mark = DASHES[0], MARKS[0]
        if self.colour != without:
            colour = colours_of(self.keys[self.colour])[positions[self.colour]]
            dash = self._dash_of_choice(int(positions[self.colour]))
        if self.dash is not None and self.dash != without:
            dash = DASHES[positions[self.dash]]
        if self.mark is not None and self.mark != without:
            mark = MARKS[positions[self.mark]]
        return Style(colour, dash, mark)

    def _dash_of_choice(self, position: int) -> str:
        """Choices have no scale of colours: theirs repeat, with another dash if no key has the dash."""
        repeats = self.dash is None and self.keys[self.colour].is_choice
        return DASHES[position // len(COLOURS) % len(DASHES) if repeats else 0]

    def words(self) -> str:
        """The style of each key in words, and the keys without one."""
        shown = [("Colour", self.colour), ("dash", self.dash), ("mark", self.mark)]
        words = ", ".join(f"{style} shows {self.keys[place].name}" for style, place in shown if place is not None)
        rest = [key.name for place, key in enumerate(self.keys) if place not in (self.colour, self.dash, self.mark)]
        return words + (f"; {' and '.join(rest)} only in the text at the mouse" if rest else "")

    def with_legend(
        self, traces: Sequence[dict[str, Any]], without: int | None = None
    ) -> tuple[list[dict[str, Any]], int]:
        """Traces and their legend, and the height of the legend in px.

        The legend has a column for each key with a style, and one for the names of marks of other kinds, once each:
        those of traces that do not set "showlegend". A key with many numbers has a scale of colours instead.
        """
        entries = list(self._entries(without))
        columns = [entry["legendgroup"] for entry in entries if "legendgroup" in entry]
        title = _title("other marks") if columns else {}
        listed: set[str] = set()
        drawn = []
        for trace in traces:
            if "showlegend" in trace:
                drawn.append(trace)
                continue
            drawn.append(
                {
                    **trace,
                    "legendgroup": _MARKS,
                    "legendrank": _LAST,
                    "showlegend": trace["name"] not in listed,
                    **title,
                }
            )
            listed.add(trace["name"])
        columns += [_MARKS] * len(listed)
        rows = max((1 + columns.count(column) for column in columns), default=0)
        return [*drawn, *entries], _LINE_PX * rows

    def _entries(self, without: int | None) -> Iterator[dict[str, Any]]:
        """Traces without points: an entry for each value of each key with a style, or a scale of colours.

        ``meta`` of an entry is the position of its key and that of its value, with which the page hides the cases of
        an entry.
        """
        for place, looks in self._looks(without):
            key = self.keys[place]
            if len(key.values) > LEGEND_ENTRIES:
                yield from [colour_bar(key)] if key.shown and place == self.colour else []
                continue
            for position, look in enumerate(looks):
                named = {"name": value_words(key, position), "legendgroup": f"key {place}", "meta": [place, position]}
                yield _EMPTY | look | _title(short_name(key)) | named

    def _looks(self, without: int | None) -> Iterator[tuple[int, list[dict[str, Any]]]]:
        """Position of each key with a style, and the look of the entry of each of its values."""
        if self.colour != without:
            lines = [
                {"color": colour, "width": 3, "dash": self._dash_of_choice(position)}
                for position, colour in enumerate(colours_of(self.keys[self.colour]))
            ]
            yield self.colour, [{"mode": "lines", "line": line} for line in lines]
        if self.dash is not None and self.dash != without:
            dashes = DASHES[: len(self.keys[self.dash].values)]
            yield self.dash, [{"mode": "lines", "line": {"color": INK, "dash": each, "width": 2}} for each in dashes]
        if self.mark is not None and self.mark != without:
            marks = MARKS[: len(self.keys[self.mark].values)]
            yield self.mark, [{"mode": "markers", "marker": mark_look(each, INK)} for each in marks]


_MARKS = "marks"
_LAST = 2000  # plotly puts entries in the order of their rank, by default 1000
_EMPTY = {"type": "scatter", "x": [None], "y": [None], "hoverinfo": "skip"}


def mark_look(mark: str, colour: str) -> dict[str, Any]:
    """Look of the mark of a peak."""
    return {"symbol": mark, "size": 8, "color": colour}


def _title(words: str) -> dict[str, Any]:
    return {"legendgrouptitle": {"text": words}}


def styles_of(keys: tuple[SweptKey, ...]) -> KeyStyles:
    """The styles of the keys of a sweep."""
    order = sorted(range(len(keys)), key=lambda place: -len(keys[place].values))
    colour, rest = order[0], order[1:]
    dash = next((place for place in rest if len(keys[place].values) <= len(DASHES)), None)
    rest = [place for place in rest if place != dash]
    mark = next((place for place in rest if len(keys[place].values) <= len(MARKS)), None)
    return KeyStyles(keys, colour, dash, mark)


def colours_of(key: SweptKey) -> list[str]:
    """A colour for each value: distinct ones for choices and few values, else a scale over the numbers, which is
    logarithmic if the values are spaced by a factor. Colours of many choices repeat."""
    if key.is_choice or len(key.values) <= len(COLOURS):
        return [COLOURS[place % len(COLOURS)] for place in range(len(key.values))]
    shown = np.log(key.shown) if is_logarithmic(np.array(key.shown)) else np.array(key.shown)
    low, high = float(shown.min()), float(shown.max())
    # whole steps of the scale, so that neighbours among very many values have one colour
    return [_scale_colour(round(SHADES * (value - low) / (high - low)) / SHADES) for value in shown.tolist()]


def _scale_colour(fraction: float) -> str:
    upper = next(i for i in range(1, len(SCALE)) if fraction <= SCALE[i][0] + 1e-12)
    (start, dark), (stop, light) = SCALE[upper - 1], SCALE[upper]
    part = (fraction - start) / (stop - start)
    channels = zip(bytes.fromhex(dark[1:]), bytes.fromhex(light[1:]), strict=True)
    return "#" + "".join(f"{round(a + part * (b - a)):02x}" for a, b in channels)


def colour_bar(key: SweptKey) -> dict[str, Any]:
    """A trace without points for the scale of the colours."""
    bar: dict[str, Any] = {"title": {"text": axis_title(key), "side": "right"}, "thickness": 12, "outlinewidth": 0}
    low, high = min(key.shown), max(key.shown)
    if is_logarithmic(np.array(key.shown)):
        ticks = [low, math.sqrt(low * high), high]
        bar |= {"tickvals": [math.log(each) for each in ticks], "ticktext": [number(each, 3) for each in ticks]}
        low, high = math.log(low), math.log(high)
    marker = {
        "color": [low],
        "cmin": low,
        "cmax": high,
        "colorscale": [list(stop) for stop in SCALE],
        "showscale": True,
        "colorbar": bar,
    }
    return {"type": "scatter", "mode": "markers", "x": [None], "y": [None], "marker": marker, "showlegend": False}
