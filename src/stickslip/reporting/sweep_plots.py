"""Figures of a sweep's page: curves over each other, peaks against each key, damper performance, maps of two keys."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.plain_figure import BLUE, ORANGE, VERMILLION
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import FREQUENCY, Figure, PlotMarkup, axis_look, figure_of, line_trace, plain_list
from stickslip.reporting.slow_sweep_marks import slow_sweep_marks
from stickslip.reporting.style import MICRO
from stickslip.reporting.style import number as shown_digits
from stickslip.reporting.sweep_view import (
    COLOURS,
    DASHES,
    LOAD_KEY,
    Group,
    SweepView,
    axis_title,
    is_logarithmic,
    short_name,
)
from stickslip.reporting.thinning import Thinned, thinned
from stickslip.results.sweep_table import SweptKey
from stickslip.results.sweeps_of_curve import Flags, drawn_steps, joined_steps, unstable_steps

DRAWN_POINTS = 200_000  # chosen: points of all curves on a page
LEGEND_ENTRIES = 12  # chosen: more do not fit beside a plot
SEPARATE_CURVES = 300  # chosen: above it curves of one colour are one trace
SHADES = 60  # chosen: colours of very many curves
LARGEST_MAP_COUNT = 12  # chosen: maps on a page
UNSTABLE = {"dash": "2px,2px", "width": 0.9}  # finer than the dashes that show the second key
# Text at the mouse on a peak over the load: its name, load or ratio, and height with its unit.
_PEAK = PlotMarkup("{}<br>%{{x:.5g}}<br>%{{y:.4g}} {}<extra></extra>")
# Cividis without its palest end, which is invisible on white paper.
SCALE = ((0.0, "#00224e"), (0.25, "#35456c"), (0.5, "#666970"), (0.75, "#948e77"), (1.0, "#c8b866"))


def thinned_curves(view: SweepView) -> Thinned:
    """Points that the figure of all curves draws."""
    shown = [(curve.frequency_hz, MICRO * curve.amplitude_m) for curve in view.curves if curve is not None]
    return thinned(shown, DRAWN_POINTS)


def all_curves(view: SweepView, points: Thinned) -> Figure:
    """Every amplitude curve; the colour shows the first key, the dash the second one; unstable parts are thin.

    Browsers are slow with very many lines, so above SEPARATE_CURVES those of like colour are one line with gaps.
    """
    first = view.table.keys[0]
    rows = [row for row, curve in enumerate(view.curves) if curve is not None]
    apart = len(rows) <= SEPARATE_CURVES
    colours = _colours(first)
    batches: dict[tuple[str, str], list[_Drawn]] = {}
    for row, indices in zip(rows, points.indices, strict=True):
        curve, place = view.curves[row], view.positions[row]
        assert curve is not None  # rows without a curve were removed above
        # Choices have no scale of colours: theirs repeat with another dash.
        number = int(place[1]) if place.size > 1 else int(place[0]) // len(COLOURS) if first.is_choice else 0
        dash = DASHES[number % len(DASHES)]
        drawn = _Drawn(
            row, int(place[0]), curve.frequency_hz[indices], MICRO * curve.amplitude_m[indices],
            unstable_steps(curve.stable[indices]), joined_steps(curve.part[indices]),
        )  # fmt: skip
        batches.setdefault((colours[place[0]], f"{dash} {row if apart else ''}"), []).append(drawn)
    traces = [
        trace
        for (colour, dash), batch in batches.items()
        for trace in _curve_traces(view, colour, dash.split()[0], batch)
    ]
    few = len(first.values) <= LEGEND_ENTRIES
    _list_once(traces, few)
    if not few and first.shown:
        traces.append(_colour_bar(first))
    return figure_of(
        traces,
        460,
        xaxis=axis_look(FREQUENCY),
        yaxis=axis_look("Amplitude, 0-to-peak, µm", rangemode="tozero"),
        hovermode="closest",
    )


@dataclass(frozen=True, eq=False)
class _Drawn:
    """A curve as it is drawn: row, place of its first key's value, Hz and µm, its unstable and its joined steps."""

    row: int
    place: int
    x: FloatArray
    y: FloatArray
    unstable: Flags
    joined: Flags


def _curve_traces(view: SweepView, colour: str, dash: str, batch: Sequence[_Drawn]) -> Iterator[dict[str, Any]]:
    """One line for curves of one colour and dash, with a gap between them, and one for their unstable parts."""
    key = view.table.keys[0]
    first, last = batch[0], batch[-1]
    if len(batch) == 1:
        label = view.label(first.row) + ("" if view.table.rows[first.row].converged else " (incomplete)")
    else:
        ends = dict.fromkeys((key.labels[first.place], key.labels[last.place]))
        label = f"{short_name(key)} {' to '.join(ends)}"
    looks = [(False, label, {"dash": dash, "width": 1.6}), (True, f"{label}, unstable", UNSTABLE)]
    for unstable, words, look in looks:
        x, y = _joined(batch, unstable)
        if x or not unstable:
            yield {
                "type": "scatter",
                "mode": "lines",
                "name": key.labels[first.place],
                "legendgroup": str(first.place),
                "x": x,
                "y": y,
                "line": {"color": colour, **look},
                "hovertemplate": PlotMarkup("{}<br>%{{x:.2f}} Hz<br>%{{y:.4g}} µm<extra></extra>").format(words),
            }


def _joined(batch: Sequence[_Drawn], unstable: bool) -> tuple[list[float | None], list[float | None]]:
    """Abscissas and ordinates of the unstable steps of curves, or of the others, with None between parts."""
    lines: tuple[list[float | None], list[float | None]] = ([], [])
    for drawn in batch:
        steps = drawn.joined & (drawn.unstable if unstable else ~drawn.unstable)
        for line, values in zip(lines, (drawn.x, drawn.y), strict=True):
            part = plain_list(drawn_steps(values, steps) if values.size > 1 else values[: 1 - unstable])
            line.extend([None] if line and part else [])
            line.extend(None if math.isnan(number) else number for number in part)
    return lines


def _colours(key: SweptKey) -> list[str]:
    """A colour for each value: distinct ones for choices and few values, else a scale over the numbers."""
    if key.is_choice or len(key.values) <= len(COLOURS):
        return [COLOURS[place % len(COLOURS)] for place in range(len(key.values))]
    shown = np.log(key.shown) if is_logarithmic(np.array(key.shown)) else np.array(key.shown)
    low, high = float(shown.min()), float(shown.max())
    # whole steps of the scale, so that neighbours among very many values have one colour
    return [_scale_colour(round(SHADES * (number - low) / (high - low)) / SHADES) for number in shown.tolist()]


def _scale_colour(share: float) -> str:
    upper = next(i for i in range(1, len(SCALE)) if share <= SCALE[i][0] + 1e-12)
    (start, dark), (stop, light) = SCALE[upper - 1], SCALE[upper]
    part = (share - start) / (stop - start)
    channels = zip(bytes.fromhex(dark[1:]), bytes.fromhex(light[1:]), strict=True)
    return "#" + "".join(f"{round(a + part * (b - a)):02x}" for a, b in channels)


def _colour_bar(key: SweptKey) -> dict[str, Any]:
    """A trace without points for the scale of the colours."""
    bar: dict[str, Any] = {"title": {"text": axis_title(key), "side": "right"}, "thickness": 12, "outlinewidth": 0}
    low, high = min(key.shown), max(key.shown)
    if is_logarithmic(np.array(key.shown)):
        ticks = [low, math.sqrt(low * high), high]
        bar |= {"tickvals": [math.log(each) for each in ticks], "ticktext": [shown_digits(each, 3) for each in ticks]}
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


def against_key(view: SweepView, place: int) -> Figure:
    """Highest peak (above) and its frequency (below) against one key; a line for each combination of the others."""
    key = view.table.keys[place]
    inside, usable = view.inside(), view.usable()
    traces: list[dict[str, Any]] = []
    groups = list(view.groups((place,)))
    for number, group in enumerate(groups):
        rows = group.members[usable[group.members]]
        x = _coordinates(view, place, rows)
        for column, factor, axis, shown in (
            ("peak_amplitude_m", MICRO, "y", PlotMarkup("%{y:.4g} µm")),
            ("peak_frequency_hz", 1.0, "y2", PlotMarkup("%{y:.2f} Hz")),
        ):
            hover = PlotMarkup("{}<br>%{{x}}<br>{}<extra></extra>").format(group.label or short_name(key), shown)
            look = {"xaxis": "x", "yaxis": axis, "hovertemplate": hover}
            look |= {"mode": "markers"} if key.is_choice else {}  # between words there is nothing
            traces += _group_lines(number, group.label, x, factor * view.number(column)[rows], inside[rows], look)
        traces += slow_sweep_marks(view, rows, x, np.full(len(view.table.rows), MICRO), "µm")
    _list_once(traces, len(groups) > 1)
    kind = {"type": "category"} if key.is_choice else _number_axis(np.array(key.shown))
    return figure_of(
        traces,
        460,
        xaxis=axis_look(axis_title(key), anchor="y2", **kind),
        yaxis=axis_look("Highest peak, µm", domain=[0.54, 1], rangemode="tozero"),
        yaxis2=axis_look("Peak frequency, Hz", domain=[0, 0.46]),
        hovermode="closest",
    )


def _coordinates(view: SweepView, place: int, rows: Any) -> list[float] | list[str]:
    key, positions = view.table.keys[place], view.positions[rows, place]
    if key.is_choice:
        return [key.labels[position] for position in positions]
    return [key.shown[position] for position in positions]


def _number_axis(values: FloatArray) -> dict[str, Any]:
    # plotly draws the digits between two powers of ten at three quarters of the size: 15 px keep them readable
    return {"type": "log", "tickfont": {"size": 15}} if is_logarithmic(values) else {}


def _group_lines(
    number: int, label: str, x: Sequence[float | str], y: FloatArray, inside: NDArray[np.bool_], look: dict[str, Any]
) -> Iterator[dict[str, Any]]:
    """A line through the peaks that lie inside their range; the others as open circles that no line joins."""
    colour, dash = COLOURS[number % len(COLOURS)], DASHES[number // len(COLOURS) % len(DASHES)]
    common = {"type": "scatter", "name": label or "peak", "legendgroup": str(number)} | look
    yield (
        {"mode": "lines+markers"}
        | common
        | {
            "x": [value for value, is_inside in zip(x, inside, strict=True) if is_inside],
            "y": plain_list(y[inside]),
            "line": {"color": colour, "dash": dash, "width": 2.0},
            "marker": {"size": 8, "color": colour},
        }
    )
    if not inside.all():
        yield common | {
            "mode": "markers",
            "x": [value for value, is_inside in zip(x, inside, strict=True) if not is_inside],
            "y": plain_list(y[~inside]),
            "marker": {"size": 9, "color": colour, "symbol": "circle-open", "line": {"width": 2}},
            "showlegend": False,
        }


def _list_once(traces: list[dict[str, Any]], shown: bool = True) -> None:
    """Keep the first line of each legend group in the legend, or none; with too many groups there are none."""
    groups = list(dict.fromkeys(trace["legendgroup"] for trace in traces if "lines" in trace["mode"]))
    listed = set() if shown and len(groups) <= LEGEND_ENTRIES else set(groups)
    for trace in traces:
        trace.setdefault("showlegend", trace["legendgroup"] not in listed)
        listed.add(trace["legendgroup"])


@dataclass(frozen=True)
class Optimum:
    """The lowest peak over the load of one group: its ``row``, and whether it is at an end of the loads."""

    label: str
    row: int
    at_end: bool


def optima(view: SweepView) -> list[Optimum]:
    """The best load of each group whose cases differ in the load only; none where no peak lies inside its range."""
    place = view.place_of(LOAD_KEY)
    if place is None:
        return []
    inside, peak = view.inside(), view.number("peak_amplitude_m")
    marks = []
    for group in view.groups((place,)):
        rows = group.members[inside[group.members]]
        if rows.size:
            best = int(rows[peak[rows].argmin()])
            marks.append(Optimum(group.label, best, best in (int(rows[0]), int(rows[-1]))))
    return marks


def performance(view: SweepView, by_ratio: bool) -> Figure:
    """Peak against the load F_N, or against force / F_N; with the optimum and the linear limits of each group.

    Where the force varies too, peaks are divided by it: a joint responds alike at the same force / F_N.
    """
    place = view.place_of(LOAD_KEY)
    assert place is not None  # only pages of a varied load call this
    load = np.array([float(row.values[place]) for row in view.table.rows])
    one_force = np.unique(view.force_n).size == 1
    scale = MICRO * np.ones_like(load) if one_force else MICRO / view.force_n
    unit = "µm" if one_force else "µm/N"
    x = view.force_n / load if by_ratio else load
    inside, usable = view.inside(), view.usable()
    best = {optimum.row for optimum in optima(view)}
    groups = list(view.groups((place,)))
    traces: list[dict[str, Any]] = []
    for number, group in enumerate(groups):
        rows = group.members[usable[group.members]]
        rows = rows[np.argsort(x[rows], kind="stable")]
        peak = scale * view.number("peak_amplitude_m")
        look = {"hovertemplate": _PEAK.format(group.label or "peak", unit)}
        traces += _group_lines(number, group.label, plain_list(x[rows]), peak[rows], inside[rows], look)
        traces += slow_sweep_marks(view, rows, plain_list(x[rows]), scale, unit)
        traces += _limits(view, rows, x, scale, unit)
        traces += [_optimum_mark(x[row], peak[row], unit) for row in rows if row in best]
    _list_once(traces)
    words = "Excitation force / F_N" if by_ratio else "F_N: centrifugal force of the damper, N"
    return figure_of(
        traces,
        400,
        xaxis=axis_look(words, **({} if by_ratio else _number_axis(x))),
        yaxis=axis_look(f"Highest peak{'' if one_force else ' per force'}, {unit}", rangemode="tozero"),
        hovermode="closest",
    )


def _limits(view: SweepView, rows: Any, x: FloatArray, scale: FloatArray, unit: str) -> Iterator[Any]:
    for limit, words, colour, dash in (
        ("stuck", "stuck (pairs closed at rest)", BLUE, "dash"),
        ("free", "no contact", ORANGE, "dot"),
    ):
        heights = (scale * view.number(f"{limit}_peak_amplitude_m"))[rows]
        valid = ~np.isnan(heights)
        if valid.any():
            hover = _PEAK.format(f"linear, {words}", unit)
            yield line_trace(
                f"linear, {words}",
                x[rows][valid],
                heights[valid],
                colour,
                dash,
                1.6,
                legendgroup=limit,
                hovertemplate=hover,
            )


def _optimum_mark(x: float, y: float, unit: str) -> dict[str, Any]:
    look = {"symbol": "star", "size": 16, "color": VERMILLION, "line": {"color": "white", "width": 1}}
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "optimum",
        "legendgroup": "optimum",
        "x": plain_list([x]),
        "y": plain_list([y]),
        "marker": look,
        "hovertemplate": _PEAK.format("optimum", unit),
    }


def maps(view: SweepView) -> list[tuple[str, Figure]]:
    """(words, figure) of peak and peak frequency over the first two keys, for each combination of the others."""
    figures = []
    for group in list(view.groups((0, 1)))[:LARGEST_MAP_COUNT]:
        for column, factor, words, digits in (
            ("peak_amplitude_m", MICRO, "Highest peak, µm", ".4g"),
            ("peak_frequency_hz", 1.0, "Peak frequency, Hz", ".2f"),
        ):
            heading = f"{words}{'; ' + group.label if group.label else ''}"
            figures.append((heading, _map(view, group, factor * view.number(column), digits)))
    return figures


def _map(view: SweepView, group: Group, numbers: FloatArray, digits: str) -> Figure:
    first, second = view.table.keys[:2]
    shape = len(first.values), len(second.values)
    rows = group.members.reshape(shape)
    values = np.where(view.usable(), numbers, np.nan)[rows]
    cells = [[None if np.isnan(value) else float(f"{value:.7g}") for value in line] for line in values.T]
    open_ends = (view.usable() & ~view.inside())[rows]
    positions = view.positions
    labels = (
        [first.labels[positions[row, 0]] for row in rows[:, 0]],
        [second.labels[positions[row, 1]] for row in rows[0]],
    )
    trace = {
        "type": "heatmap",
        "x": labels[0],
        "y": labels[1],
        "z": cells,
        "text": [["at an end" if open_end else "" for open_end in line] for line in open_ends.T],
        "texttemplate": PlotMarkup("%{text}"),
        "colorscale": [list(stop) for stop in SCALE],
        "colorbar": {"thickness": 12, "outlinewidth": 0},
        "hoverongaps": False,
        "hovertemplate": PlotMarkup("{} %{{x}}<br>{} %{{y}}<br>%{{z:{}}}<extra></extra>").format(
            short_name(first), short_name(second), digits
        ),
    }
    return figure_of(
        [trace],
        360,
        xaxis=axis_look(short_name(first).capitalize(), type="category", showgrid=False),
        yaxis=axis_look(short_name(second).capitalize(), type="category", showgrid=False),
    )
