"""The figures of the damper's performance on a sweep's page: peaks over the load, its optimum and linear limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.plain_figure import BLUE, ORANGE, VERMILLION
from stickslip.core.shown_numbers import MICRO
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import Figure, PlotMarkup, axis_look, figure_of, line_trace, plain_list
from stickslip.reporting.slow_sweep_marks import slow_sweep_marks
from stickslip.reporting.sweep_plots import group_lines, number_axis
from stickslip.reporting.sweep_styles import Style, styles_of
from stickslip.reporting.sweep_view import LOAD_KEY, SweepView

# Text at the mouse on a peak over the load: its name, load or ratio, and height with its unit.
_PEAK = PlotMarkup("{}<br>%{{x:.5g}}<br>%{{y:.4g}} {}<extra></extra>")


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

    Where the force varies too, peaks are divided by it: a joint responds alike at the same force / F_N. The limits of a
    group have its style, thinner and with open marks.
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
    styles = styles_of(view.table.keys)
    traces: list[dict[str, Any]] = []
    peak = scale * view.number("peak_amplitude_m")
    for group in view.groups((place,)):
        style = styles.of(view.positions[group.members[0]], place)
        rows = group.members[usable[group.members]]
        rows = rows[np.argsort(x[rows], kind="stable")]
        meta = view.positions[group.members[0]].tolist()
        look = {"hovertemplate": _PEAK.format(group.label or "peak", unit), "meta": meta}
        traces += group_lines(style, group.label, plain_list(x[rows]), peak[rows], inside[rows], look)
        traces += slow_sweep_marks(view, rows, plain_list(x[rows]), scale, unit)
        traces += _limits(view, rows, x, scale, unit, style, group.label)
        traces += [_optimum_mark(x[row], peak[row], unit) for row in rows if row in best]
    data, height = styles.with_legend(traces, place)
    words = "Excitation force / F_N" if by_ratio else "F_N: centrifugal force of the damper, N"
    return figure_of(
        data,
        320 + height,
        meta={"legend": height},
        xaxis=axis_look(words) if by_ratio else number_axis(words, load.tolist()),
        yaxis=axis_look(f"Highest peak{'' if one_force else ' per force'}, {unit}", rangemode="tozero"),
        hovermode="closest",
    )


def _limits(
    view: SweepView, rows: NDArray[np.int64], x: FloatArray, scale: FloatArray, unit: str, style: Style, group: str
) -> Iterator[dict[str, Any]]:
    """The linear limits of a group."""
    for limit, words, colour in (("stuck", "stuck", BLUE), ("free", "no contact", ORANGE)):
        heights = (scale * view.number(f"{limit}_peak_amplitude_m"))[rows]
        valid = ~np.isnan(heights)
        if valid.any():
            hover = _PEAK.format(f"linear, {words}{'; ' if group else ''}{group}", unit)
            yield line_trace(
                f"linear, {words}",
                x[rows][valid],
                heights[valid],
                colour,
                style.dash,
                1.0,
                mode="lines+markers",
                marker={"symbol": f"{style.mark}-open", "size": 5, "color": style.colour},
                hovertemplate=hover,
            )


def _optimum_mark(x: float, y: float, unit: str) -> dict[str, Any]:
    look = {"symbol": "star", "size": 16, "color": VERMILLION, "line": {"color": "white", "width": 1}}
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "optimum",
        "x": plain_list([x]),
        "y": plain_list([y]),
        "marker": look,
        "hovertemplate": _PEAK.format("optimum", unit),
    }
