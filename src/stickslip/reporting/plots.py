"""Figures of the page, each as the plain data that plotly.js draws: {"data": [...], "layout": {...}}.

They show the peak and the pair that dissipates most; page.js moves them to any other point and pair.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.plain_figure import BLUE, GREY, INK, ORANGE, PURPLE, VERMILLION
from stickslip.core.shown_numbers import MICRO
from stickslip.core.validation import FloatArray
from stickslip.reporting.face_axes import map_titles
from stickslip.reporting.look import (
    FREQUENCY,
    Figure,
    PlotMarkup,
    axis_look,
    figure_of,
    line_trace,
    map_range,
    map_scale,
    mark_size,
    plain_list,
)
from stickslip.reporting.style import AXIS_NAMES, LINE_COLOURS, LINE_DASHES, STATES
from stickslip.reporting.view import View
from stickslip.results.rough_patch import RoughPatch

TIME = "Time over period"
_MAP = (400.0, 160.0)  # px of a face's map beside its axes and scale, on a wide screen
_TEXT = PlotMarkup("%{text}<extra></extra>")
_RING = 9.0  # px that the ring about the chosen pair is wider than its mark


def face_map(view: View, face: int, quantity: str) -> Figure:
    """One face at the peak: contact states ("state") or energy of each pair ("energy"); the last trace is the ring."""
    study, response = view.study, view.response
    pairs = np.flatnonzero(study.pair_face == face)
    position = 1e3 * study.pair_position[pairs]
    states = response.contact_state[view.point, pairs]
    dots: dict[str, Any] = {
        "type": "scatter",
        "mode": "markers",
        "x": plain_list(position[:, 0]),
        "y": plain_list(position[:, 1]),
        "customdata": pairs.tolist(),
        "showlegend": False,
        "hovertemplate": _TEXT,
        "text": [""] * pairs.size,
    }
    size = mark_size(position, _MAP, 15.0 if quantity == "state" else 17.0)
    if quantity == "state":
        dots["marker"] = {
            "size": size,
            "color": [STATES[state].colour for state in states],
            "symbol": [STATES[state].plotly_symbol for state in states],
        }
    else:
        energy = view.energy_factor * response.friction_energy[view.point]
        dots["marker"] = _scale(size, energy[pairs], float(energy.max()), f"{view.energy_unit} per cycle")
    chosen = {
        "type": "scatter",
        "mode": "markers",
        "x": [],
        "y": [],
        "marker": {"symbol": "circle-open", "size": size + _RING, "color": INK, "line": {"width": 2.5}},
        "hoverinfo": "skip",
        "showlegend": False,
    }
    return _on_face([dots, chosen], position, map_titles(study, face))


def rest_map(view: View, face: int) -> Figure:
    """The pressure at rest on one face; pairs that are open there are hollow."""
    pressure = view.rest_pressure_mpa
    return pair_map(view, face, pressure, np.isnan(pressure), "MPa", "MPa at rest", view.unloaded_words)


def pair_map(
    view: View, face: int, value: FloatArray, is_hollow: NDArray[np.bool_], unit: str, title: str, hollow: str
) -> Figure:
    """A value of each pair (n_pairs,) on one face, with one scale for all faces; NaN is shown as words alone.

    Pairs that are hollow have the words ``hollow`` in their text.
    """
    pairs = np.flatnonzero(view.study.pair_face == face)
    position, here = 1e3 * view.study.pair_position[pairs], value[pairs]
    marker = _scale(mark_size(position, _MAP, 17.0), here, float(np.nanmax(value)), title)
    marker["color"] = plain_list(np.nan_to_num(here))
    marker["symbol"] = ["square-open" if each else "square" for each in is_hollow[pairs]]
    words = [
        ", ".join(filter(None, ["" if math.isnan(number) else f"{number:.3g} {unit}", hollow if is_open else ""]))
        for number, is_open in zip(here, is_hollow[pairs], strict=True)
    ]
    dots = {
        "type": "scatter",
        "mode": "markers",
        "x": plain_list(position[:, 0]),
        "y": plain_list(position[:, 1]),
        "showlegend": False,
        "hovertemplate": _TEXT,
        "text": [f"{view.pair_label(int(pair))}: {word}" for pair, word in zip(pairs, words, strict=True)],
        "marker": marker,
    }
    return _on_face([dots], position, map_titles(view.study, face))


def _scale(size: float, values: FloatArray, top: float, title: str) -> dict[str, Any]:
    """Square markers coloured by values from 0 to ``top``, with their bar."""
    return {
        "size": size,
        "symbol": "square",
        "color": plain_list(values),
        "colorscale": "Cividis",
        "cmin": 0.0,
        "cmax": max(top, 1e-30),
        "line": {"color": "#9aa5b1", "width": 0.5},
        "showscale": True,
        "colorbar": {
            "title": {"text": title, "side": "right", "font": {"size": 11}},
            "thickness": 12,
            "outlinewidth": 0,
            "exponentformat": "power",
        },
    }


def _on_face(traces: list[dict[str, Any]], position: FloatArray, titles: tuple[str, str]) -> Figure:
    """Traces on one face with pairs at ``position`` (n, 2) mm, to scale; ``titles`` of its axes."""
    ranges = map_range(position).tolist()
    across, up = (PlotMarkup("<br>").join(map(PlotMarkup.escape, title.split("\n"))) for title in titles)
    return figure_of(
        traces,
        230,
        xaxis=axis_look(across, range=ranges[0], constrain="domain", showgrid=False, fixedrange=True),
        yaxis=axis_look(up, range=ranges[1], scaleanchor="x", showgrid=False, fixedrange=True),
        hovermode="closest",
        dragmode=False,
        margin={"l": 48, "r": 12, "t": 6, "b": 42},
        meta={"pxPerMm": map_scale(position, _MAP)},
    )


def rough_face(patch: RoughPatch) -> Figure:
    """Heights of a rough face about their mean, µm, over mm, to scale."""
    heights = [[float(f"{height:.4g}") for height in row] for row in MICRO * patch.about_mean]
    trace = {
        "type": "heatmap",
        "x": plain_list(1e3 * patch.along),
        "y": plain_list(1e3 * patch.across),
        "z": heights,
        "colorscale": "Cividis",
        "colorbar": {
            "title": {"text": "Height, µm", "side": "right", "font": {"size": 11}},
            "thickness": 12,
            "outlinewidth": 0,
        },
        "hovertemplate": PlotMarkup("%{x:.4g}, %{y:.4g} mm<br>%{z:.4g} µm<extra></extra>"),
    }
    fixed: dict[str, Any] = {"showgrid": False, "fixedrange": True, "constrain": "domain"}
    return figure_of(
        [trace],
        280,
        xaxis=axis_look("Along, mm", **fixed),
        yaxis=axis_look("Across, mm", scaleanchor="x", **fixed),
        dragmode=False,
    )


def hysteresis_loop(view: View) -> Figure:
    """Tangential force against relative displacement along t1 and t2; filled by page.js."""
    traces = [
        line_trace(f"along {axis}", [], [], colour, width=2.5)
        for axis, colour in zip(AXIS_NAMES, LINE_COLOURS, strict=False)
    ]
    return figure_of(
        traces[:2],
        480,
        xaxis=axis_look("Relative displacement about the mean, µm"),
        yaxis=axis_look(view.tangential_words),
        hovermode="closest",
    )


def pair_signals() -> Figure:
    """Forces (above) and displacements with the slider (below) of one pair over a period; filled by page.js."""
    forces = [
        line_trace("T1", [], [], LINE_COLOURS[0]),
        line_trace("T2", [], [], LINE_COLOURS[1], "dash"),
        line_trace("N", [], [], LINE_COLOURS[2], "dot", width=2.5),
        line_trace("±µN", [], [], GREY, "solid", width=1.0),
    ]
    motion = [
        line_trace(axis, [], [], colour, dash, xaxis="x", yaxis="y2", legend="legend2")
        for axis, colour, dash in zip(AXIS_NAMES, LINE_COLOURS, LINE_DASHES, strict=True)
    ]
    sliders = [
        line_trace(f"slider {axis}", [], [], colour, "dashdot", width=1.4, xaxis="x", yaxis="y2", legend="legend2")
        for axis, colour in zip(AXIS_NAMES[:2], (PURPLE, ORANGE), strict=True)
    ]
    return figure_of(
        forces + motion + sliders,
        480,
        xaxis=axis_look(TIME, range=[0, 1], anchor="y2"),
        yaxis=axis_look("Force, N", domain=[0.57, 1]),
        yaxis2=axis_look("Displacement, µm", domain=[0, 0.4]),
        legend2={"orientation": "h", "x": 0, "y": 0.42, "yanchor": "bottom", "font": {"size": 12}},
        hovermode="x unified",
    )


def energy_curve(view: View) -> Figure:
    """Energy per cycle along the curve: input, friction, viscous; the last trace is the cursor."""
    response, factor = view.response, view.energy_factor
    friction = factor * response.friction_energy.sum(axis=1)
    hover = PlotMarkup("%{{x:.2f}} Hz<br>%{{y:.4g}} {}").format(view.energy_unit)
    cursor = {
        "type": "scatter",
        "mode": "markers",
        "name": "shown",
        "x": [float(response.frequency_hz[view.point])],
        "y": [float(friction[view.point])],
        "marker": {"symbol": "circle-open", "size": 15, "color": VERMILLION, "line": {"width": 3}},
        "hoverinfo": "skip",
        "showlegend": False,
    }
    return figure_of(
        [
            line_trace("friction", response.frequency_hz, friction, INK, width=2.5, hovertemplate=hover),
            line_trace(
                "viscous", response.frequency_hz, factor * response.viscous_energy, BLUE, "dash", hovertemplate=hover
            ),
            line_trace(
                "input", response.frequency_hz, factor * response.input_energy, ORANGE, "dot", hovertemplate=hover
            ),
            cursor,
        ],
        340,
        xaxis=axis_look(FREQUENCY),
        yaxis=axis_look(f"Energy per cycle, {view.energy_unit}", rangemode="tozero"),
        hovermode="closest",
    )


def group_labels(names: tuple[str, ...]) -> tuple[str, ...]:
    """Last words of names such as "damper left x" (the heading has the rest), or the names if those do not differ."""
    short = tuple(name.split()[-1] for name in names)
    return short if len(set(short)) == len(names) else names


def output_signals(names: tuple[str, ...]) -> Figure:
    """Displacements of a group of outputs over one period; filled by page.js."""
    styles = zip(LINE_COLOURS * len(names), LINE_DASHES * len(names), strict=True)
    traces = [
        line_trace(label, [], [], colour, dash)
        for label, (colour, dash) in zip(group_labels(names), styles, strict=False)
    ]
    return figure_of(
        traces,
        300,
        xaxis=axis_look(TIME, range=[0, 1]),
        yaxis=axis_look("Displacement, µm"),
        hovermode="x unified",
    )
