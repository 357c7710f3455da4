"""The interactive figure of the amplitude curve: stable and unstable parts, jumps of slow sweeps, and three peaks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, DOWNWARD, GREY, INK, ORANGE, UPWARD, VERMILLION
from stickslip.core.shown_numbers import MICRO
from stickslip.core.validation import FloatArray
from stickslip.reporting.antiresonances import with_antiresonances
from stickslip.reporting.look import FREQUENCY, Figure, PlotMarkup, axis_look, broken_line, figure_of, line_trace
from stickslip.reporting.other_words import other_lines
from stickslip.reporting.stiffness_words import stiffness_lines
from stickslip.reporting.traction_words import traction_lines
from stickslip.reporting.view import View
from stickslip.results.peaks import Peak
from stickslip.results.sweeps_of_curve import Flags, joined_steps, solid_words, unstable_steps

_ROOM = 1.15  # of the highest amplitude, for the label of the peak
_LEGEND_ROWS = 2  # on a wide screen
_OF_PRINT = 0.54  # chosen: height in print, of that on the screen; the curve is the answer of the page
_HIGH_LIMIT = 5.0  # chosen: a linear limit higher than the peak by more needs a logarithmic axis beside it
_DEEPEST = 1e-4  # chosen: of the peak; deeper antiresonances leave a logarithmic axis
_HOVER = PlotMarkup("%{x:.2f} Hz<br>%{y:.4g} µm")


def amplitude_frequency(view: View) -> Figure:
    """Amplitude against frequency, linear stuck and free beside it, with peaks and jumps; the last trace is the cursor.

    page.js counts on three places: trace 2 has every point of the curve, the peak is trace 3, and the first annotation
    names it. It makes the axis logarithmic on request, and from the start where a linear limit is much higher.
    """
    response, linear = view.response, view.response.linear
    low, high = view.window_hz
    cursor = {
        "type": "scatter",
        "mode": "markers",
        "name": "shown below",
        "x": [float(response.frequency_hz[view.point])],
        "y": [float(view.amplitude_um[view.point])],
        "marker": {"symbol": "circle-open", "size": 17, "color": VERMILLION, "line": {"width": 3}},
        "hoverinfo": "skip",
    }
    traces = [
        line_trace(view.stuck_words, *_limit(view, linear.stuck), BLUE, "dash", hovertemplate=_HOVER),
        line_trace("linear, no contact", *_limit(view, linear.free), ORANGE, "dot", width=2.5, hovertemplate=_HOVER),
        *_curve(view),
        *_peaks_of_sweeps(view),
        *stiffness_lines(view),
        *traction_lines(view),
        *other_lines(view),
        cursor,
    ]
    # plotly would make room for the label of the peak too: in print, several times the height of the curve
    heights = [value for trace in traces for value in trace["y"] if value is not None]
    peak = MICRO * view.summary.peak.amplitude
    top = _ROOM * max(heights)
    bottom = max(min((value for value in heights if value > 0.0), default=peak), _DEEPEST * peak)
    ranges = {"linear": [0.0, top], "log": [math.log10(0.7 * bottom), math.log10(1.6 * top)]}
    meta = {"legend": _LEGEND_ROWS * 20, "print": _OF_PRINT, "ranges": ranges}
    return figure_of(
        traces,
        440,
        meta=meta | {"logarithmic": top > _HIGH_LIMIT * peak},
        xaxis=axis_look(FREQUENCY, range=[low, high]),
        yaxis=axis_look("Amplitude, 0-to-peak, µm", range=[0.0, top]),
        annotations=[_peak_label(view), *_jumps(view)],
        hovermode="closest",
    )


def _limit(view: View, motion: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Hz and µm of a linear limit (n_linear, n, 2H+1) in the range that is shown, with its antiresonances."""
    linear, (low, high) = view.response.linear, view.window_hz
    shown = (linear.frequency_hz >= low) & (linear.frequency_hz <= high)
    signal = np.einsum("pic,i->pc", motion[shown], view.study.outputs[view.study.response_output])
    frequency_hz, amplitude = with_antiresonances(linear.frequency_hz[shown], signal)
    return frequency_hz, MICRO * amplitude


def _curve(view: View) -> Iterator[dict[str, Any]]:
    """All points of the curve, its highest peak, and where parts are unstable the stable and the unstable lines."""
    frequency, amplitude, name = view.response.frequency_hz, view.amplitude_um, view.response.curve_name
    unstable, joined = unstable_steps(view.response.stable_points), joined_steps(view.response.part)
    in_parts = bool(unstable.any() or not joined.all())
    points = line_trace(name, frequency, amplitude, INK, width=2.5, hovertemplate=_HOVER)
    mode = {"mode": "markers", "showlegend": False} if in_parts else {"mode": "lines+markers"}
    # points of unstable parts would hide their dashes; they remain in the figure for the choice of a point
    seen = np.where(view.response.stable_points, 1.0, 0.0).tolist() if in_parts else 1.0
    yield points | mode | {"marker": {"size": 5, "color": INK, "opacity": seen}}
    yield _peak_mark(_highest_words(view), view.summary.peak, "diamond", VERMILLION, listed=False)
    if in_parts:
        yield _drawn(f"{name}, {solid_words(view.response.stable)}", view, ~unstable & joined, "solid", 2.5)
    if unstable.any():
        yield _drawn(f"{name}, unstable", view, unstable & joined, "dash", 1.8)


def _drawn(name: str, view: View, drawn: Flags, dash: str, width: float) -> dict[str, Any]:
    """The steps of the curve that are ``drawn``."""
    options = {"hoverinfo": "skip"}
    return broken_line(name, view.response.frequency_hz, view.amplitude_um, drawn, INK, dash, width, **options)


def _highest_words(view: View) -> str:
    if view.summary.caution(view.summary.peak):
        return "highest computed"
    return "highest peak on the curve" if view.summary.sweeps_differ else "peak"


def _peak_label(view: View) -> dict[str, Any]:
    peak = view.summary.peak
    top = MICRO * peak.amplitude
    return {
        "x": peak.frequency_hz,
        "y": top,
        # short lines: on a phone longer ones cover the title of the axis
        "text": PlotMarkup("{}<br>{:.4g} µm<br>at {:.2f} Hz").format(
            _highest_words(view).removesuffix(" on the curve"), top, peak.frequency_hz
        ),
        "showarrow": True,
        "arrowhead": 0,
        "arrowcolor": GREY,
        "ax": -70,  # to the left: friction lowers the frequency, so the stuck peak is on the right
        "ay": -8,
        "align": "right",
    }


def _peak_mark(name: str, peak: Peak, symbol: str, colour: str, listed: bool) -> dict[str, Any]:
    top = MICRO * peak.amplitude
    words = PlotMarkup("{} {:.4g} µm<br>at {:.2f} Hz").format(name, top, peak.frequency_hz)
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": [peak.frequency_hz],
        "y": [top],
        "marker": {"symbol": symbol, "size": 12, "color": colour, "line": {"color": "white", "width": 1}},
        "hovertemplate": words + PlotMarkup("<extra></extra>"),
        "showlegend": listed,
    }


def _peaks_of_sweeps(view: View) -> Iterator[dict[str, Any]]:
    """Marks of the peaks of both slow sweeps where one of them is not the highest peak."""
    if not view.summary.sweeps_differ:
        return
    for peak, direction, symbol, colour in (
        (view.summary.upward_peak, "up", "triangle-up", UPWARD),
        (view.summary.downward_peak, "down", "triangle-down", DOWNWARD),
    ):
        if peak is not None:
            yield _peak_mark(f"peak of a slow sweep {direction}", peak, symbol, colour, listed=True)


def _jumps(view: View) -> Iterator[dict[str, Any]]:
    """Vertical arrows from the amplitude before to that after each jump."""
    for jump in view.summary.notable_jumps:
        yield {
            "x": jump.frequency_hz,
            "y": MICRO * jump.amplitude_to,
            "ax": jump.frequency_hz,
            "ay": MICRO * jump.amplitude_from,
            "axref": "x",
            "ayref": "y",
            "text": "",
            "showarrow": True,
            "arrowhead": 2,
            "arrowsize": 1.2,
            "arrowwidth": 2.5,
            "arrowcolor": UPWARD if jump.direction == "up" else DOWNWARD,
        }
