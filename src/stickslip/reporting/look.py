"""Common style of the figures of the pages: axes, layout and lines as plain data for plotly.js."""

from __future__ import annotations

import math
from typing import Any, Self

import markupsafe
import numpy as np
from markupsafe import Markup
from scipy.spatial import KDTree

from stickslip.core.plain_figure import INK
from stickslip.core.validation import FloatArray
from stickslip.results.sweeps_of_curve import Flags, drawn_steps

Figure = dict[str, Any]


class PlotMarkup(Markup):
    """Text that plotly.js reads itself, with its tags, entities and "%{x}"; other texts of a figure are shown as is.

    Variable parts are inserted by :meth:`format`, which escapes them.
    """

    __slots__ = ()

    @classmethod
    def escape(cls, s: Any, /) -> Self:
        """Text that plotly.js shows as it is."""
        return s if isinstance(s, cls) else cls(str(markupsafe.escape(str(s))).replace("%", "&#37;"))


def plain_figures(figures: Any) -> Any:
    """Figures, or any part of them, with every text in them escaped that is not :class:`PlotMarkup`."""
    if isinstance(figures, dict):
        return {key: plain_figures(value) for key, value in figures.items()}
    if isinstance(figures, list | tuple):
        return [plain_figures(value) for value in figures]
    return str(PlotMarkup.escape(figures)) if isinstance(figures, str) else figures


FREQUENCY = "Excitation frequency, Hz"
_SMALLEST_MARK = 3.0  # px; chosen: the smallest mark with a visible colour
_LEAST_WIDTH = 0.5  # chosen: of the height of a map; the numbers of narrower axes overlap
_CLOSE_FRACTION = 0.1  # chosen: of the pairs may have a neighbour nearer than the size of a mark
_FEW_DECADES = 2.0  # chosen: numbers 1, 2, 5, 10 of more decades would overlap
_LEAST_DECADES = 0.2  # chosen: a logarithmic axis shows at least twice as much
_PLAIN_DECADES = (-4.0, 6.0)  # chosen: numbers of an axis beyond these are powers of ten
_FONT = PlotMarkup("system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif")


def axis_look(title: str, **options: Any) -> dict[str, Any]:
    """An axis with its title; ``options`` of plotly win over the common look."""
    look: dict[str, Any] = {
        "title": {"text": title, "font": {"size": 13}, "standoff": 8},
        "showline": True,
        "linecolor": "#9aa5b1",
        "gridcolor": "#e8ecf0",
        "zeroline": False,
        "ticks": "outside",
        "tickcolor": "#9aa5b1",
        "automargin": True,
    }
    look["exponentformat"] = "power"  # not 100µ of a unit that has its own prefix
    return look | options


def log_axis(title: str, values: Any, **options: Any) -> dict[str, Any]:
    """A logarithmic axis for positive ``values``: 0.1, 1, 10 where all of them have readable digits, else 10⁻⁷, 10⁻⁶.

    ``options`` of plotly win over the common look.
    """
    low, high = (math.log10(float(end(values))) for end in (np.min, np.max))
    if high - low < _LEAST_DECADES:  # digits of round-off would be ticks
        options = {"range": [0.5 * (low + high) - _LEAST_DECADES, 0.5 * (low + high) + _LEAST_DECADES]} | options
    if _PLAIN_DECADES[0] <= low and high <= _PLAIN_DECADES[1]:
        ticks: dict[str, Any] = {"tickformat": ".6~g"}
        if high - low >= 1.0:  # else plotly chooses ticks between the powers of ten
            ticks["dtick"] = "D2" if high - low < _FEW_DECADES else 1
    else:  # plotly would write 10⁻¹, 1, 10
        decades = range(math.floor(low), math.ceil(high) + 1)
        ticks = {
            "tickvals": [float(f"1e{decade}") for decade in decades],
            "ticktext": [PlotMarkup("10<sup>{}</sup>").format(str(decade).replace("-", "−")) for decade in decades],
        }
    return axis_look(title, **({"type": "log"} | ticks | options))


def figure_of(data: list[dict[str, Any]], height: int, **layout: Any) -> Figure:
    """Traces with the common layout; ``layout`` wins over it. Height in px."""
    look = {
        "height": height,
        "autosize": True,
        "font": {"family": _FONT, "size": 12, "color": INK},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "#ffffff",
        "margin": {"l": 56, "r": 16, "t": 12, "b": 44},
        "legend": {
            "orientation": "h",
            "x": 0,
            "y": 1.02,
            "yanchor": "bottom",
            "font": {"size": 12},
            "grouptitlefont": {"size": 12},
        },
        "hoverlabel": {"font": {"family": _FONT}, "namelength": -1},  # a name cut short may end within an entity
        "dragmode": "zoom",
    }
    return {"data": data, "layout": look | layout}


def line_trace(name: str, x: Any, y: Any, colour: str, dash: str = "solid", width: float = 2.0, **options: Any) -> Any:
    """A line; ``options`` of plotly win over the common look."""
    line = {"color": colour, "dash": dash, "width": width}
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": plain_list(x),
        "y": plain_list(y),
        "line": line,
    } | options


def broken_line(
    name: str, x: FloatArray, y: FloatArray, drawn: Flags, colour: str, dash: str, width: float, **options: Any
) -> dict[str, Any]:
    """A line along the steps that are ``drawn`` (n_points - 1,), with gaps between them."""
    line: dict[str, Any] = line_trace(name, [], [], colour, dash, width, **options)
    for axis, values in (("x", x), ("y", y)):
        numbers = plain_list(drawn_steps(values, drawn))
        line[axis] = [None if math.isnan(number) else number for number in numbers]
    return line


def plain_list(values: Any) -> list[float]:
    """Numbers of an array with seven digits, for JSON."""
    return [float(f"{value:.7g}") for value in np.asarray(values, dtype=float).ravel()]


def map_range(position: FloatArray) -> FloatArray:
    """(2, 2) first and last value of both axes of a map with marks at ``position`` (n, 2) in mm.

    An upright map has room for the numbers of its horizontal axis, however narrow its face is.
    """
    pad = 0.06 * np.ptp(position, axis=0) + 0.4
    ranges = np.stack([position.min(axis=0) - pad, position.max(axis=0) + pad], axis=1)
    width, height = np.ptp(ranges, axis=1)
    missing = max(0.0, _LEAST_WIDTH * height - width)
    ranges[0] += 0.5 * missing * np.array([-1.0, 1.0])
    return ranges


def map_scale(position: FloatArray, drawing: tuple[float, float]) -> float:
    """Units of ``drawing``, its width and height, for each mm of a map of marks at ``position`` (n, 2) mm."""
    return float((np.array(drawing) / np.ptp(map_range(position), axis=1)).min())


def mark_size(position: FloatArray, drawing: tuple[float, float], largest: float) -> float:
    """Width of square marks at ``position`` (n, 2) in mm, so that nine in ten do not overlap, at most ``largest``.

    ``drawing`` is the width and height of the map, in the unit of the result (px or points).
    """
    if len(position) < 2:
        return largest
    places = position * map_scale(position, drawing)
    # squares of width s are apart where |dx| or |dy| is above s
    nearest = KDTree(places).query(places, k=2, p=np.inf)[0][:, 1]
    return float(np.clip(np.quantile(nearest, _CLOSE_FRACTION), _SMALLEST_MARK, largest))
