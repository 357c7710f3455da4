"""Figures of the page, each as the plain data that plotly.js draws: {"data": [...], "layout": {...}}.

They show the peak and the pair that dissipates most; page.js moves them to any other point and pair.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.report.style import (
    AXIS_NAMES,
    BLUE,
    GREY,
    INK,
    LINE_COLOURS,
    LINE_DASHES,
    ORANGE,
    PURPLE,
    STATES,
    VERMILLION,
)
from stickslip.report.view import View

Figure = dict[str, Any]
FREQUENCY = "Excitation frequency, Hz"
TIME = "Time over period"
_FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"


def _axis(title: str, **options: Any) -> dict[str, Any]:
    look = {
        "title": {"text": title, "font": {"size": 13}, "standoff": 8},
        "showline": True,
        "linecolor": "#9aa5b1",
        "gridcolor": "#e8ecf0",
        "zeroline": False,
        "ticks": "outside",
        "tickcolor": "#9aa5b1",
        "automargin": True,
    }
    return look | options


def _figure(data: list[dict[str, Any]], height: int, **layout: Any) -> Figure:
    look = {
        "height": height,
        "autosize": True,
        "font": {"family": _FONT, "size": 12, "color": INK},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "#ffffff",
        "margin": {"l": 56, "r": 16, "t": 12, "b": 44},
        "legend": {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom", "font": {"size": 12}},
        "hoverlabel": {"font": {"family": _FONT}},
        "dragmode": "zoom",
    }
    return {"data": data, "layout": look | layout}


def _line(name: str, x: Any, y: Any, colour: str, dash: str = "solid", width: float = 2.0, **options: Any) -> Any:
    line = {"color": colour, "dash": dash, "width": width}
    return {"type": "scatter", "mode": "lines", "name": name, "x": _list(x), "y": _list(y), "line": line} | options


def _list(values: Any) -> list[float]:
    return [float(f"{value:.7g}") for value in np.asarray(values, dtype=float).ravel()]


def amplitude_frequency(view: View) -> Figure:
    """Amplitude against frequency, linear stuck and free beside it, the peak marked; the last trace is the cursor."""
    response, linear, peak = view.response, view.response.linear, view.summary.peak
    low, high = view.window_hz
    shown = (linear.frequency_hz >= low) & (linear.frequency_hz <= high)
    hover = "%{x:.2f} Hz<br>%{y:.4g} µm"
    frequency = linear.frequency_hz[shown]
    curve = _line("with friction", response.frequency_hz, view.amplitude_um, INK, width=2.5, hovertemplate=hover)
    curve |= {"mode": "lines+markers", "marker": {"size": 5, "color": INK}}
    top = 1e6 * peak.amplitude
    words = f"{'peak' if peak.bracketed else 'highest'} {top:.4g} µm<br>at {peak.frequency_hz:.2f} Hz"
    mark = {
        "type": "scatter",
        "mode": "markers",
        "name": "peak",
        "x": [peak.frequency_hz],
        "y": [top],
        "marker": {"symbol": "diamond", "size": 12, "color": VERMILLION, "line": {"color": "white", "width": 1}},
        "hovertemplate": words + "<extra></extra>",
        "showlegend": False,
    }
    cursor = {
        "type": "scatter",
        "mode": "markers",
        "name": "shown below",
        "x": [float(response.frequency_hz[view.point])],
        "y": [float(view.amplitude_um[view.point])],
        "marker": {"symbol": "circle-open", "size": 17, "color": VERMILLION, "line": {"width": 3}},
        "hoverinfo": "skip",
    }
    label = {
        "x": peak.frequency_hz,
        "y": top,
        "text": words,
        "showarrow": True,
        "arrowhead": 0,
        "arrowcolor": GREY,
        "ax": -70,  # to the left: friction lowers the frequency, so the stuck peak stands on the right
        "ay": -30,
        "align": "right",
    }
    return _figure(
        [
            _line("linear, all stuck", frequency, view.stuck_um[shown], BLUE, "dash", hovertemplate=hover),
            _line("linear, no contact", frequency, view.free_um[shown], ORANGE, "dot", width=2.5, hovertemplate=hover),
            curve,
            mark,
            cursor,
        ],
        440,
        xaxis=_axis(FREQUENCY, range=[low, high]),
        yaxis=_axis("Amplitude, 0-to-peak, µm", rangemode="tozero"),
        annotations=[label],
        hovermode="closest",
    )


def face_map(view: View, face: int, quantity: str) -> Figure:
    """One face at the peak: contact states ("state") or energy of each pair ("energy"); the last trace is the ring."""
    study, response = view.study, view.response
    pairs = np.flatnonzero(study.pair_face == face)
    position = 1e3 * study.pair_position[pairs]
    states = response.contact_state[view.point, pairs]
    dots: dict[str, Any] = {
        "type": "scatter",
        "mode": "markers",
        "x": _list(position[:, 0]),
        "y": _list(position[:, 1]),
        "customdata": pairs.tolist(),
        "showlegend": False,
        "hovertemplate": "%{text}<extra></extra>",
        "text": [""] * pairs.size,
    }
    if quantity == "state":
        dots["marker"] = {
            "size": 15,
            "color": [STATES[state].colour for state in states],
            "symbol": [STATES[state].plotly_symbol for state in states],
        }
    else:
        energy = view.energy_factor * response.dissipated_energy
        dots["marker"] = {
            "size": 17,
            "symbol": "square",
            "color": _list(energy[view.point, pairs]),
            "colorscale": "Cividis",
            "cmin": 0.0,
            "cmax": max(float(energy[view.point].max()), 1e-30),
            "line": {"color": "#9aa5b1", "width": 0.5},
            "showscale": True,
            "colorbar": {
                "title": {"text": f"{view.energy_unit} per cycle", "side": "right", "font": {"size": 11}},
                "thickness": 12,
                "outlinewidth": 0,
                "exponentformat": "power",
            },
        }
    chosen = {
        "type": "scatter",
        "mode": "markers",
        "x": [],
        "y": [],
        "marker": {"symbol": "circle-open", "size": 26, "color": INK, "line": {"width": 2.5}},
        "hoverinfo": "skip",
        "showlegend": False,
    }
    pad = 0.06 * np.ptp(position, axis=0) + 0.4
    ranges = np.stack([position.min(axis=0) - pad, position.max(axis=0) + pad], axis=1).tolist()
    return _figure(
        [dots, chosen],
        230,
        xaxis=_axis("Along the length, mm", range=ranges[0], showgrid=False, fixedrange=True),
        yaxis=_axis("Across, mm", range=ranges[1], showgrid=False, fixedrange=True),
        hovermode="closest",
        dragmode=False,
        margin={"l": 48, "r": 12, "t": 6, "b": 42},
    )


def hysteresis_loop() -> Figure:
    """Tangential force against relative displacement along t1 and t2; filled by page.js."""
    traces = [
        _line(f"along {axis}", [], [], colour, width=2.5)
        for axis, colour in zip(AXIS_NAMES, LINE_COLOURS, strict=False)
    ]
    return _figure(
        traces[:2],
        480,
        xaxis=_axis("Relative displacement about the mean, µm"),
        yaxis=_axis("Friction force, N"),
        hovermode="closest",
    )


def pair_signals() -> Figure:
    """Forces (above) and displacements with the slider (below) of one pair over a period; filled by page.js."""
    forces = [
        _line("T1", [], [], LINE_COLOURS[0]),
        _line("T2", [], [], LINE_COLOURS[1], "dash"),
        _line("N", [], [], LINE_COLOURS[2], "dot", width=2.5),
        _line("±µN", [], [], GREY, "solid", width=1.0),
    ]
    motion = [
        _line(axis, [], [], colour, dash, xaxis="x", yaxis="y2", legend="legend2")
        for axis, colour, dash in zip(AXIS_NAMES, LINE_COLOURS, LINE_DASHES, strict=True)
    ]
    sliders = [
        _line(f"slider {axis}", [], [], colour, "dashdot", width=1.4, xaxis="x", yaxis="y2", legend="legend2")
        for axis, colour in zip(AXIS_NAMES[:2], (PURPLE, ORANGE), strict=True)
    ]
    return _figure(
        forces + motion + sliders,
        480,
        xaxis=_axis(TIME, range=[0, 1], anchor="y2"),
        yaxis=_axis("Force, N", domain=[0.57, 1]),
        yaxis2=_axis("Displacement, µm", domain=[0, 0.4]),
        legend2={"orientation": "h", "x": 0, "y": 0.42, "yanchor": "bottom", "font": {"size": 12}},
        hovermode="x unified",
    )


def energy_curve(view: View) -> Figure:
    """Energy per cycle along the curve: input, friction, viscous; the last trace is the cursor."""
    response, factor = view.response, view.energy_factor
    friction = factor * response.dissipated_energy.sum(axis=1)
    hover = f"%{{x:.2f}} Hz<br>%{{y:.4g}} {view.energy_unit}"
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
    return _figure(
        [
            _line("friction", response.frequency_hz, friction, INK, width=2.5, hovertemplate=hover),
            _line(
                "viscous", response.frequency_hz, factor * response.viscous_energy, BLUE, "dash", hovertemplate=hover
            ),
            _line("input", response.frequency_hz, factor * response.input_energy, ORANGE, "dot", hovertemplate=hover),
            cursor,
        ],
        340,
        xaxis=_axis(FREQUENCY),
        yaxis=_axis(f"Energy per cycle, {view.energy_unit}", rangemode="tozero"),
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
        _line(label, [], [], colour, dash) for label, (colour, dash) in zip(group_labels(names), styles, strict=False)
    ]
    return _figure(
        traces,
        300,
        xaxis=_axis(TIME, range=[0, 1]),
        yaxis=_axis("Displacement, µm"),
        hovermode="x unified",
    )
