"""Figures of a design's page: curves of study and optimum, path of the search, objective against each key."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, GREEN, INK, ORANGE, PURPLE, VERMILLION
from stickslip.core.shown_numbers import MICRO, SHOWN
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
from stickslip.results.band import BandMeasure
from stickslip.results.design import COST, DesignResult, Evaluation

STARTS = ((VERMILLION, "square"), (GREEN, "diamond"), (PURPLE, "triangle-up"), (ORANGE, "triangle-down"))
_GREY = "#8d94a0"
_CURVE_COLOURS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE)


def axis_words(measure: BandMeasure) -> str:
    """A measure with its unit as an axis shows it."""
    return f"{measure.words}, {SHOWN[measure.unit][1]}" + (", 0-to-peak" if measure.unit == "m" else "")


def start_design(result: DesignResult) -> Evaluation | None:
    """The evaluation of the study itself, if it is inside the ranges and has a result."""
    first = result.evaluations[0]
    is_study = all(math.isclose(key.start, at) for key, at in zip(result.keys, first.values, strict=True))
    return first if is_study and not first.failure else None


def curves(result: DesignResult) -> Figure:
    """The amplitude curves of the optimum, one for each load case, over those of the study (thin, dotted)."""
    designs = [("study", start_design(result), "dot", 1.3), ("optimum", result.optimum, "solid", 2.2)]
    traces = []
    for words, design, dash, width in designs:
        for place, case in enumerate(design.cases if design else ()):
            if case.curve is None:
                continue
            load = result.load_cases[place]
            name = f"{words}: {load}" if load else words
            traces.append(
                line_trace(
                    name,
                    case.curve.frequency_hz,
                    MICRO * case.curve.amplitude_m,
                    _CURVE_COLOURS[place % len(_CURVE_COLOURS)],
                    dash,
                    width,
                    hovertemplate=PlotMarkup("{}<br>%{{x:.2f}} Hz<br>%{{y:.4g}} µm<extra></extra>").format(name),
                )
            )
    for each in result.limits:
        if each.measure.unit == "m":
            ends = [trace["x"] for trace in traces]
            span = [min(map(min, ends)), max(map(max, ends))]
            trace = line_trace(f"limit: {each.text}", span, [MICRO * each.value] * 2, INK, "dash", 1.4)
            traces.append(trace | {"hoverinfo": "name"})
    return figure_of(
        traces,
        440,
        xaxis=axis_look(FREQUENCY),
        yaxis=axis_look("Amplitude, 0-to-peak, µm", rangemode="tozero"),
        hovermode="closest",
    )


def path(result: DesignResult) -> Figure:
    """The objective of each computed design in order, and the best allowed one so far."""
    factor, unit = SHOWN[result.measure.unit]
    traces = list(_marks(result, [(each, float(each.number)) for each in result.evaluations]))
    numbers, best, lowest = [], [], np.inf
    for each in result.evaluations:
        if each.is_allowed and each.objective < lowest:
            lowest = each.objective
        if np.isfinite(lowest):
            numbers.append(each.number)
            best.append(factor * lowest)
    if best:
        line = line_trace("best so far", numbers, best, INK, "solid", 1.6)
        line["line"]["shape"] = "hv"
        hover = PlotMarkup("best so far: %{{y:.5g}} {}<extra></extra>").format(unit)
        traces.insert(0, line | {"hovertemplate": hover})
    return figure_of(
        traces,
        400,
        xaxis=axis_look("Number of the design"),
        yaxis=_objective_axis(result),
        hovermode="closest",
    )


def against_key(result: DesignResult, place: int) -> Figure:
    """The objective of all designs against a key, and along the key through the optimum."""
    factor, unit = SHOWN[result.measure.unit]
    key = result.keys[place]
    ends = [key.shown(key.low), key.shown(key.high)]
    marks = _marks(result, [(each, key.shown(each.values[place])) for each in result.evaluations])
    traces = [trace | {"showlegend": False} for trace in marks]  # the path has their legend
    best = result.optimum
    if best is not None:
        along = result.sharpness[place]
        has = np.isfinite(along.objective)
        x = [key.shown(float(value)) for value in along.values[has]]
        name = "through the optimum"
        hover = PlotMarkup("{}<br>%{{x:.5g}} {}<br>%{{y:.5g}} {}<extra></extra>").format(name, key.unit, unit)
        traces.append(line_trace(name, x, factor * along.objective[has], INK, "solid", 2.0, hovertemplate=hover))
        level = [COST * factor * best.objective] * 2
        cost = f"{100.0 * (COST - 1.0):.0f} % above the optimum"
        traces.append(line_trace(cost, ends, level, INK, "dash", 1.2, hoverinfo="name"))
        star = {"size": 15, "color": "#f2cf80", "symbol": "star", "line": {"color": INK, "width": 1.2}}
        traces.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": "optimum",
                "x": [key.shown(best.values[place])],
                "y": [factor * best.objective],
                "marker": star,
                "hovertemplate": PlotMarkup("optimum<br>%{{x:.5g}} {}<br>%{{y:.5g}} {}<extra></extra>").format(
                    key.unit, unit
                ),
            }
        )
    title = f"{key.name}{', ' + key.unit if key.unit else ''}"
    return figure_of(
        traces,
        420,
        xaxis=log_axis(title, ends) if key.is_logarithmic else axis_look(title),
        yaxis=_objective_axis(result),
        hovermode="closest",
    )


def _objective_axis(result: DesignResult) -> dict[str, Any]:
    """The axis of the objective, logarithmic for objectives over more than a decade."""
    values = np.array([each.objective for each in result.evaluations if not each.failure])
    is_wide = values.size and values.min() > 0.0 and values.max() > 10.0 * values.min()
    title = axis_words(result.measure)
    if is_wide:
        return log_axis(title, SHOWN[result.measure.unit][0] * values)
    return axis_look(title, rangemode="tozero")


def _marks(result: DesignResult, rows: Sequence[tuple[Evaluation, float]]) -> Iterator[dict[str, Any]]:
    """Marks of designs: by stage, and hollow if a limit is not satisfied."""
    factor, unit = SHOWN[result.measure.unit]
    stages = dict.fromkeys(each.stage for each in result.evaluations)
    for stage in stages:
        colour, symbol = _GREY, "circle"
        if stage.startswith("start"):
            colour, symbol = STARTS[(int(stage.split()[1]) - 1) % len(STARTS)]
        elif stage != "sample":
            colour, symbol = BLUE, "cross" if stage == "difference" else "x"
        for is_allowed in (True, False):
            chosen = [(each, x) for each, x in rows if each.stage == stage and not each.failure]
            chosen = [(each, x) for each, x in chosen if each.is_allowed == is_allowed]
            if not chosen:
                continue
            name = stage if is_allowed else f"{stage}, limit not satisfied"
            yield {
                "type": "scatter",
                "mode": "markers",
                "name": name,
                "x": plain_list([x for _, x in chosen]),
                "y": plain_list([factor * each.objective for each, _ in chosen]),
                "marker": {
                    "size": 8,
                    "color": colour,
                    "symbol": symbol if is_allowed else f"{symbol}-open",
                    "opacity": 0.85,
                },
                "text": [f"design {each.number}" for each, _ in chosen],
                "hovertemplate": PlotMarkup("{}, %{{text}}<br>%{{y:.5g}} {}<extra></extra>").format(name, unit),
            }
