"""The Campbell diagram of results at several speeds: natural frequencies, engine orders and their crossings."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, ORANGE, VERMILLION
from stickslip.core.shown_numbers import number
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import Figure, PlotMarkup, axis_look, figure_of, line_trace
from stickslip.reporting.style import shown_number
from stickslip.results.campbell import Campbell, Crossing

_PALE = "#c3ccd5"  # of engine orders that no study asks for
_ROOM = 1.08  # of the highest frequency, for the names of the engine orders
# Chosen: nearer names overlap on a phone. Of the highest speed, and of the height of the figure.
_BETWEEN_NAMES = 0.05, 0.045
# Places of a name along its line, as fractions: the end, or below it where other names leave no room there.
_PLACES = (1.0, 0.95, 0.9, 0.85, 0.8)


def campbell_figure(diagram: Campbell) -> Figure:
    """Frequencies with contact stuck and without contact over the speed; the engine orders of the studies, or all as
    thin lines, with names."""
    top, last = _ROOM * diagram.highest_hz, float(diagram.speed_rpm[-1])
    traces: list[dict[str, Any]] = []
    taken: list[tuple[float, float]] = []  # speed and frequency of the names, as fractions of the figure
    notes = []
    for order in diagram.asked or diagram.orders:
        end = min(last, 60.0 * top / order)
        look = (VERMILLION, "dash", 1.8) if diagram.asked else (_PALE, "solid", 0.7)
        trace = line_trace(f"engine order {order}", [0.0, end], [0.0, order * end / 60.0], *look, hoverinfo="skip")
        traces.append(trace | {"showlegend": bool(diagram.asked)})
        for place in _PLACES:
            here = place * end / last, order * place * end / 60.0 / top
            if not any(_overlap(here, other) for other in taken):
                taken.append(here)
                notes.append(_name(order, place * end))
                break
    for name, frequency, colour, dash in (
        ("contacts stuck", diagram.stuck_hz, BLUE, "solid"),
        ("no contact", diagram.free_hz, ORANGE, "dot"),
    ):
        traces += _modes(diagram, name, frequency, colour, dash)
    marks = diagram.crossings()
    if marks:
        traces.append(_marks(marks))
    low = min(0.0, float(diagram.speed_rpm[0]))
    return figure_of(
        traces,
        460,
        xaxis=axis_look("Speed of rotation, rpm", range=[low, 1.02 * last], tickformat=".6~g"),
        yaxis=axis_look("Natural frequency, Hz", range=[0.0, top]),
        annotations=notes,
        hovermode="closest",
    )


def _overlap(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return all(abs(a - b) < room for a, b, room in zip(one, other, _BETWEEN_NAMES, strict=True))


def _name(order: int, speed_rpm: float) -> dict[str, Any]:
    """The number of an engine order at the end of its line."""
    return {
        "x": speed_rpm,
        "y": order * speed_rpm / 60.0,
        "text": str(order),
        "showarrow": False,
        "font": {"size": 11, "color": INK},
        "bgcolor": "rgba(255,255,255,.8)",
    }


def crossing_rows(diagram: Campbell) -> list[tuple[str, str, str, str]]:
    """Mode, engine order, speed and frequency of each crossing with contact stuck, in words."""
    return [
        (str(each.mode), str(each.order), number(each.speed_rpm), shown_number(each.frequency_hz, "Hz"))
        for each in diagram.crossings()
    ]


def _modes(diagram: Campbell, name: str, frequency: FloatArray, colour: str, dash: str) -> list[dict[str, Any]]:
    traces = []
    for mode in range(frequency.shape[1]):
        there = ~np.isnan(frequency[:, mode])
        if not there.any():
            continue
        hover = PlotMarkup("mode {}, {}<br>%{{x:.5g}} rpm<br>%{{y:.2f}} Hz<extra></extra>").format(mode + 1, name)
        trace = line_trace(name, diagram.speed_rpm[there], frequency[there, mode], colour, dash, hovertemplate=hover)
        traces.append(trace | {"mode": "lines+markers", "legendgroup": name, "showlegend": mode == 0})
    return traces


def _marks(marks: tuple[Crossing, ...]) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "crossing with an engine order",
        "x": [each.speed_rpm for each in marks],
        "y": [each.frequency_hz for each in marks],
        "marker": {"symbol": "circle-open", "size": 11, "color": INK, "line": {"width": 2}},
        "text": [f"mode {each.mode}, EO {each.order}" for each in marks],
        "hovertemplate": PlotMarkup("%{text}<br>%{x:.5g} rpm<br>%{y:.2f} Hz<extra></extra>"),
    }
