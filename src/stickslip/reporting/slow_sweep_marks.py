"""Marks on the page of many cases: peaks of slow sweeps that are lower than the highest peak on the curve."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.plain_figure import DOWNWARD, UPWARD
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import PlotMarkup, plain_list
from stickslip.reporting.sweep_view import SweepView
from stickslip.results.sweeps_of_curve import SAME_PEAK


def slow_sweep_marks(
    view: SweepView, rows: NDArray[np.int64], x: Sequence[float | str], scale: FloatArray, unit: str
) -> Iterator[dict[str, Any]]:
    """Triangles at the peaks of slow sweeps of ``rows`` that do not reach the highest peak.

    ``x`` are the abscissas of ``rows``; ``scale`` (all rows) converts m to ``unit``.
    """
    highest = view.number("peak_amplitude_m")[rows]
    for direction, column, symbol, colour in (
        ("up", "upward_peak_amplitude_m", "triangle-up", UPWARD),
        ("down", "downward_peak_amplitude_m", "triangle-down", DOWNWARD),
    ):
        peak = view.number(column)[rows]
        lower = peak < (1.0 - SAME_PEAK) * highest  # not for NaN, a sweep without a stable point
        if lower.any():
            name = f"slow sweep {direction}, where lower"
            yield {
                "type": "scatter",
                "mode": "markers",
                "name": name,
                "x": [value for value, is_lower in zip(x, lower, strict=True) if is_lower],
                "y": plain_list((scale[rows] * peak)[lower]),
                "marker": {"symbol": symbol, "size": 10, "color": colour},
                "hovertemplate": PlotMarkup("{}<br>%{{x}}<br>%{{y:.4g}} {}<extra></extra>").format(name, unit),
            }
