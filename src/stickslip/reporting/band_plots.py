"""Figures of a band's page: curves, distribution of the peaks, Sobol indices, peaks against each input."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, ORANGE, VERMILLION
from stickslip.core.shown_numbers import MICRO, SHOWN, unit_on_page
from stickslip.reporting.look import (
    FREQUENCY,
    Figure,
    PlotMarkup,
    axis_look,
    figure_of,
    line_trace,
    log_axis,
    plain_list,
)
from stickslip.reporting.sweep_view import axis_title
from stickslip.reporting.thinning import thinned
from stickslip.results.band import MEASURES, PERCENTILES, BandMeasure, drawn_pieces
from stickslip.results.band_statistics import BandStatistics
from stickslip.results.influence import Influence
from stickslip.results.sweep_table import SweptKey

DRAWN_CURVES = 64  # chosen: thin lines of samples behind the band; more are a grey area
DRAWN_POINTS = 40_000  # chosen: points of these lines
DRAWN_PARTS = 4  # chosen: straight parts of a step between two points of a sample
LIMIT_REACH = 3.0  # chosen: ranges of the samples up to which a distribution shows a limit and remains readable
_BAND = "rgba(0, 114, 178, 0.22)"
_TRACTIONS = "rgba(230, 159, 0, 0.14)"
TRACTIONS = "residual tractions, central inputs"


def curves(statistics: BandStatistics) -> Figure:
    """Median and band of the curves, over thin lines of the first samples, with limits of the amplitude."""
    band = statistics.curve_band
    assert band is not None  # the page has no figure without it
    x, (low, middle, high) = band.frequency_hz, MICRO * band.amplitude_m
    has = np.isfinite(middle)
    x, low, middle, high = x[has], low[has], middle[has], high[has]
    first, _, last = (f"{percent:g} %" for percent in PERCENTILES)
    hover = PlotMarkup("{}<br>%{{x:.2f}} Hz<br>%{{y:.4g}} µm<extra></extra>")
    traces = list(_samples(statistics))
    traces += [
        line_trace(first, x, low, BLUE, "dot", 1.2, showlegend=False, hovertemplate=hover.format(first)),
        line_trace(
            f"{first} to {last} of the samples", x, high, BLUE, "dot", 1.2, fill="tonexty", fillcolor=_BAND,
            hovertemplate=hover.format(last),
        ),
        line_trace("median", x, middle, BLUE, "solid", 2.4, hovertemplate=hover.format("median")),
    ]  # fmt: skip
    traces += _other_tractions(statistics)
    for each in statistics.exceedances:
        if each.limit.measure.unit == "m":
            level = MICRO * each.limit.value
            ends = [x.min(), x.max()]
            traces.append(line_trace(f"limit: {each.limit.text}", ends, [level, level], **_line_of_limit()))
    return figure_of(
        traces,
        460,
        xaxis=axis_look(FREQUENCY),
        yaxis=axis_look("Amplitude, 0-to-peak, µm", rangemode="tozero"),
        hovermode="closest",
    )


def _line_of_limit() -> dict[str, Any]:
    return {"colour": VERMILLION, "dash": "dash", "width": 1.8, "hoverinfo": "name"}


def _samples(statistics: BandStatistics) -> Iterator[dict[str, Any]]:
    """Thin lines of the first complete curves, as one trace with gaps; between points as the percentiles have them."""
    shown = [
        curve
        for curve, row in zip(statistics.curves, statistics.table.rows, strict=True)
        if curve is not None and row.converged
    ][:DRAWN_CURVES]
    drawn = [(hertz, MICRO * amplitude) for curve in shown for hertz, amplitude in drawn_pieces(curve, DRAWN_PARTS)]
    x: list[float | None] = []
    y: list[float | None] = []
    for (frequency, amplitude), places in zip(drawn, thinned(drawn, DRAWN_POINTS).indices, strict=True):
        x += [*plain_list(frequency[places]), None]
        y += [*plain_list(amplitude[places]), None]
    trace: dict[str, Any] = line_trace(f"{len(shown)} samples", [], [], "#b4bcc6", "solid", 0.7, hoverinfo="skip")
    yield trace | {"x": x, "y": y}


def _other_tractions(statistics: BandStatistics) -> Iterator[dict[str, Any]]:
    """The curves with extreme residual tractions and central inputs, under one name of the legend."""
    for place, (frequency, amplitude) in enumerate(statistics.tractions.curves if statistics.tractions else ()):
        yield line_trace(
            TRACTIONS, frequency, MICRO * amplitude, ORANGE, "solid", 1.4, showlegend=not place, legendgroup=TRACTIONS,
            hovertemplate=PlotMarkup("{}<br>%{{x:.2f}} Hz<br>%{{y:.4g}} µm<extra></extra>").format(TRACTIONS),
        )  # fmt: skip


def distribution(statistics: BandStatistics, measure: BandMeasure) -> Figure:
    """Histogram of a measure, the fraction of samples above each value, and its limits that are not far away."""
    factor, unit = SHOWN[measure.unit]
    values = measure.of(statistics.table)
    values = np.sort(factor * values[np.isfinite(values)])
    edges = np.histogram_bin_edges(values, bins=min(24, max(6, int(np.sqrt(values.size) * 1.5))))
    counts, _ = np.histogram(values, edges)
    bars = {
        "type": "bar",
        "name": "in the interval",
        "x": plain_list(0.5 * (edges[1:] + edges[:-1])),
        "y": plain_list(100.0 * counts / values.size),
        "width": plain_list(np.diff(edges)),
        "marker": {"color": "#b3d5e8", "line": {"color": "white", "width": 1}},
        "hovertemplate": PlotMarkup("%{{x:.5g}} {}<br>%{{y:.3g}} &#37; of the samples<extra></extra>").format(unit),
    }
    above = 100.0 * (1.0 - np.arange(1, values.size + 1) / values.size)
    steps = line_trace(
        "above the value", values, above, INK, "solid", 1.8, yaxis="y2",
        hovertemplate=PlotMarkup("above %{{x:.5g}} {}: %{{y:.3g}} &#37; of the samples<extra></extra>").format(unit),
    )  # fmt: skip
    steps["line"]["shape"] = "hv"
    traces = [bars, steps]
    if statistics.tractions is not None and measure.name == "peak_amplitude":
        ends = factor * np.array([statistics.tractions.low, statistics.tractions.high])
        traces.append(
            line_trace(
                TRACTIONS, ends.repeat(2), [0, 100, 100, 0], ORANGE, "dashdot", 1.8, yaxis="y2", fill="toself",
                fillcolor=_TRACTIONS, hoverinfo="name",
            )
        )  # fmt: skip
    for each in statistics.exceedances:
        at = factor * each.limit.value
        reach = LIMIT_REACH * (np.ptp(values) or abs(values[0]))
        if each.limit.measure is measure and values[0] - reach <= at <= values[-1] + reach:
            trace = line_trace(f"limit: {each.limit.text}", [at, at], [0, 100], **_line_of_limit())
            traces.append(trace | {"yaxis": "y2"})
    title = f"{measure.words}, {unit}" + (", 0-to-peak" if measure.unit == "m" else "")
    return figure_of(
        traces,
        380,
        xaxis=axis_look(title),
        yaxis=axis_look("Samples in the interval, %", rangemode="tozero"),
        yaxis2=axis_look(
            "Samples above the value, %", overlaying="y", side="right", range=[0, 100], dtick=20, showgrid=False
        ),
        bargap=0,
        hovermode="closest",
    )


def indices(result: Influence) -> Figure:
    """First-order and total Sobol indices of each input, with their intervals; the largest total index on top."""
    order = np.argsort(result.total)
    names = [result.names[i] for i in order]
    traces = []
    for label, values, ends, colour, pattern in (
        ("total, with interactions", result.total, result.total_interval, ORANGE, "/"),
        ("first order, alone", result.first, result.first_interval, BLUE, ""),
    ):
        at = np.array(values)[order]
        low, high = np.array(ends)[order].T
        traces.append(
            {
                "type": "bar",
                "orientation": "h",
                "name": label,
                "y": names,
                "x": plain_list(100.0 * at),
                "error_x": {
                    "type": "data",
                    "symmetric": False,
                    "array": plain_list(100.0 * (high - at)),
                    "arrayminus": plain_list(100.0 * (at - low)),
                    "color": INK,
                    "thickness": 1.2,
                },
                "marker": {
                    "color": colour,
                    "pattern": {"shape": pattern, "size": 6, "fgcolor": "white", "fillmode": "overlay"},
                },
                "hovertemplate": PlotMarkup("{}<br>%{{y}}: %{{x:.3g}} &#37;<extra></extra>").format(label),
            }
        )
    return figure_of(
        traces,
        130 + 62 * len(names),
        meta={"print": 0.7},  # chosen: height in print, so that each bar keeps its name
        xaxis=axis_look("Fraction of the variance, %", range=[0, 105]),
        yaxis=axis_look("", ticks="", automargin=True),
        barmode="group",
        legend={
            "orientation": "h",
            "x": 0,
            "y": 1.02,
            "yanchor": "bottom",
            "traceorder": "reversed",
            "font": {"size": 12},
        },
    )


def against_input(statistics: BandStatistics, place: int) -> Figure:
    """The highest peak of each sample against one input."""
    key, measure = statistics.table.keys[place], MEASURES["peak_amplitude"]
    peak = MICRO * measure.of(statistics.table)
    rows = np.flatnonzero(np.isfinite(peak))
    if key.is_choice:
        x: Any = [key.labels[row] for row in rows]
    else:
        x = plain_list(np.array(key.shown)[rows])
    points = {
        "type": "scatter",
        "mode": "markers",
        "name": "sample",
        "x": x,
        "y": plain_list(peak[rows]),
        "marker": {"size": 7, "color": BLUE, "opacity": 0.75},
        "hovertemplate": PlotMarkup("%{{x}} {}<br>%{{y:.4g}} µm<extra></extra>").format(unit_on_page(key.shown_unit)),
        "showlegend": False,
    }
    return figure_of(
        [points],
        320,
        xaxis=axis_look(axis_title(key), type="category") if key.is_choice else _number_axis(key),
        yaxis=axis_look("Highest peak, µm", rangemode="tozero"),
        hovermode="closest",
    )


def _number_axis(key: SweptKey) -> dict[str, Any]:
    """A logarithmic axis for values over more than a decade, else a linear one."""
    is_wide = min(key.shown) > 0.0 and max(key.shown) > 10.0 * min(key.shown)
    return log_axis(axis_title(key), key.shown) if is_wide else axis_look(axis_title(key))
