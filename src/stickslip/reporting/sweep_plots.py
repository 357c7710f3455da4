"""Figures of a sweep's page: curves over each other, peaks against each key, maps of two keys."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.shown_numbers import MICRO, capital
from stickslip.core.shown_numbers import number as shown_digits
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import FREQUENCY, Figure, PlotMarkup, axis_look, figure_of, log_axis, plain_list
from stickslip.reporting.slow_sweep_marks import slow_sweep_marks
from stickslip.reporting.sweep_styles import Style, mark_look, styles_of
from stickslip.reporting.sweep_view import (
    SCALE,
    Group,
    SweepView,
    axis_title,
    is_logarithmic,
    short_name,
    value_words,
)
from stickslip.reporting.thinning import Thinned, thinned
from stickslip.results.sweep_table import SweptKey
from stickslip.results.sweeps_of_curve import Flags, drawn_steps, joined_steps, unstable_steps

DRAWN_POINTS = 200_000  # chosen: points of all curves on a page
SEPARATE_CURVES = 300  # chosen: above it curves of one colour are one trace
LARGEST_MAP_COUNT = 12  # chosen: maps on a page
UNSTABLE = {"dash": "2px,2px", "width": 0.9}  # finer than the dashes that show a key
_OF_PRINT = 0.8  # chosen: height in print, of that on the screen; the curves fill the first sheet
_TICKS = 8  # chosen: largest number of values with a tick each


def thinned_curves(view: SweepView) -> Thinned:
    """Points that the figure of all curves draws."""
    shown = [(curve.frequency_hz, MICRO * curve.amplitude_m) for curve in view.curves if curve is not None]
    return thinned(shown, DRAWN_POINTS)


def all_curves(view: SweepView, points: Thinned) -> Figure:
    """Every amplitude curve in the style of its case, with the mark of its case at its highest point; unstable parts
    are thin.

    Browsers are slow with very many lines, so above SEPARATE_CURVES those of like style are one line with gaps.
    """
    styles = styles_of(view.table.keys)
    rows = [row for row, curve in enumerate(view.curves) if curve is not None]
    apart = len(rows) <= SEPARATE_CURVES
    batches: dict[tuple[Style, int], list[_Drawn]] = {}
    for row, indices in zip(rows, points.indices, strict=True):
        curve = view.curves[row]
        assert curve is not None  # rows without a curve were removed above
        drawn = _Drawn(
            row, curve.frequency_hz[indices], MICRO * curve.amplitude_m[indices],
            unstable_steps(curve.stable[indices]), joined_steps(curve.part[indices]),
        )  # fmt: skip
        batches.setdefault((styles.of(view.positions[row]), row if apart else 0), []).append(drawn)
    traces = [trace for (style, _), batch in batches.items() for trace in _curve_traces(view, style, batch)]
    if styles.mark is not None:
        traces += [_peak_marks(view, style, batch) for (style, _), batch in batches.items()]
    data, height = styles.with_legend(traces)
    return figure_of(
        data,
        400 + height,
        meta={"legend": height, "print": _OF_PRINT},
        xaxis=axis_look(FREQUENCY),
        yaxis=axis_look("Amplitude, 0-to-peak, µm", rangemode="tozero"),
        hovermode="closest",
    )


@dataclass(frozen=True, eq=False)
class _Drawn:
    """A curve as it is drawn: row, Hz and µm, its unstable and its joined steps."""

    row: int
    x: FloatArray
    y: FloatArray
    unstable: Flags
    joined: Flags


def _curve_traces(view: SweepView, style: Style, batch: Sequence[_Drawn]) -> Iterator[dict[str, Any]]:
    """One line for curves of one style, with a gap between them, and one for their unstable parts."""
    label = view.label(batch[0].row)
    if len(batch) > 1:
        label += f" to {view.label(batch[-1].row)}"
    elif not view.table.rows[batch[0].row].converged:
        label += " (incomplete)"
    looks = [(False, label, {"dash": style.dash, "width": 1.6}), (True, f"{label}, unstable", UNSTABLE)]
    for unstable, words, look in looks:
        x, y = _joined(batch, unstable)
        if x or not unstable:
            yield {
                "type": "scatter",
                "mode": "lines",
                "name": words,
                "showlegend": False,
                "meta": view.positions[batch[0].row].tolist(),
                "x": x,
                "y": y,
                "line": {"color": style.colour, **look},
                "hovertemplate": PlotMarkup("{}<br>%{{x:.2f}} Hz<br>%{{y:.4g}} µm<extra></extra>").format(words),
            }


def _peak_marks(view: SweepView, style: Style, batch: Sequence[_Drawn]) -> dict[str, Any]:
    """The mark of a style at the highest point of each curve of a batch."""
    tops = [int(np.nanargmax(drawn.y)) for drawn in batch]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "highest point",
        "showlegend": False,
        "meta": view.positions[batch[0].row].tolist(),
        "hoverinfo": "skip",
        "x": plain_list([drawn.x[top] for drawn, top in zip(batch, tops, strict=True)]),
        "y": plain_list([drawn.y[top] for drawn, top in zip(batch, tops, strict=True)]),
        "marker": mark_look(style.mark, style.colour),
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


def against_key(view: SweepView, place: int) -> Figure:
    """Highest peak (above) and its frequency (below) against one key; a line for each combination of the others."""
    key = view.table.keys[place]
    styles = styles_of(view.table.keys)
    inside, usable = view.inside(), view.usable()
    traces: list[dict[str, Any]] = []
    for group in view.groups((place,)):
        rows = group.members[usable[group.members]]
        style, x = styles.of(view.positions[group.members[0]], place), _coordinates(view, place, rows)
        for column, factor, axis, shown in (
            ("peak_amplitude_m", MICRO, "y", PlotMarkup("%{y:.4g} µm")),
            ("peak_frequency_hz", 1.0, "y2", PlotMarkup("%{y:.2f} Hz")),
        ):
            hover = PlotMarkup("{}<br>%{{x}}<br>{}<extra></extra>").format(group.label or short_name(key), shown)
            look = {
                "xaxis": "x",
                "yaxis": axis,
                "hovertemplate": hover,
                "meta": view.positions[rows[:1]].ravel().tolist(),
            }
            look["meta"] = view.positions[group.members[0]].tolist()
            look |= {"mode": "markers"} if key.is_choice else {}  # between words there is nothing
            traces += group_lines(style, group.label, x, factor * view.number(column)[rows], inside[rows], look)
        traces += slow_sweep_marks(view, rows, x, np.full(len(view.table.rows), MICRO), "µm")
    data, height = styles.with_legend(traces, place)
    title, join = axis_title(key), {"anchor": "y2"}
    return figure_of(
        data,
        380 + height,
        meta={"legend": height},
        xaxis=axis_look(title, type="category", **join) if key.is_choice else number_axis(title, key.shown, **join),
        yaxis=axis_look("Highest peak, µm", domain=[0.54, 1], rangemode="tozero"),
        yaxis2=axis_look("Peak frequency, Hz", domain=[0, 0.46]),
        hovermode="closest",
    )


def _coordinates(view: SweepView, place: int, rows: Any) -> list[float] | list[str]:
    key, positions = view.table.keys[place], view.positions[rows, place]
    if key.is_choice:
        return [key.labels[position] for position in positions]
    return [key.shown[position] for position in positions]


def number_axis(title: str, values: Sequence[float], **options: Any) -> dict[str, Any]:
    """An axis for the numbers of a key, logarithmic for steps by factors; there each of a few values has a tick."""
    if not is_logarithmic(np.array(values)):
        return axis_look(title, **options)
    few = sorted(set(values))
    if len(few) > _TICKS:
        return log_axis(title, values, **options)
    ticks = {"tickvals": plain_list(few), "ticktext": [shown_digits(each, 6) for each in few]}
    return axis_look(title, type="log", **ticks, **options)


def group_lines(
    style: Style, label: str, x: Sequence[float | str], y: FloatArray, inside: NDArray[np.bool_], look: dict[str, Any]
) -> Iterator[dict[str, Any]]:
    """A line through the peaks that lie inside their range; the others as open marks that no line joins."""
    common = {"type": "scatter", "name": label or "peak", "showlegend": False} | look
    yield (
        {"mode": "lines+markers"}
        | common
        | {
            "x": [value for value, is_inside in zip(x, inside, strict=True) if is_inside],
            "y": plain_list(y[inside]),
            "line": {"color": style.colour, "dash": style.dash, "width": 2.0},
            "marker": mark_look(style.mark, style.colour),
        }
    )
    if not inside.all():
        yield common | {
            "mode": "markers",
            "x": [value for value, is_inside in zip(x, inside, strict=True) if not is_inside],
            "y": plain_list(y[~inside]),
            "marker": {"size": 9, "color": style.colour, "symbol": f"{style.mark}-open", "line": {"width": 2}},
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
    usable, inside = view.usable(), view.inside()
    columns, lines = (np.unique(view.positions[group.members, place]) for place in (0, 1))
    columns, lines = (_by_size(key, each) for key, each in ((first, columns), (second, lines)))
    values = np.full((lines.size, columns.size), np.nan)
    remarks = np.full(values.shape, "", dtype=object)
    for row in group.members:
        cell = (
            int(np.flatnonzero(lines == view.positions[row, 1])[0]),
            int(np.flatnonzero(columns == view.positions[row, 0])[0]),
        )
        values[cell] = numbers[row] if usable[row] else np.nan
        remarks[cell] = "at an end" if usable[row] and not inside[row] else ""
    trace = {
        "type": "heatmap",
        "x": [value_words(first, int(place)) for place in columns],
        "y": [value_words(second, int(place)) for place in lines],
        "z": [[None if np.isnan(value) else float(f"{value:.7g}") for value in line] for line in values],
        "text": remarks.tolist(),
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
        xaxis=axis_look(capital(short_name(first)), type="category", showgrid=False),
        yaxis=axis_look(capital(short_name(second)), type="category", showgrid=False),
    )


def _by_size(key: SweptKey, places: NDArray[np.int64]) -> NDArray[np.int64]:
    """Positions of values of a key in the order of the values; choices in that of the key."""
    return places if key.is_choice else places[np.argsort(np.array(key.shown)[places])]
