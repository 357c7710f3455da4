"""The plain figure of a Campbell diagram, for publications and notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from stickslip.core.plain_figure import BLUE, GREY, INK, ORANGE, VERMILLION, one_panel
from stickslip.core.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ROOM = 1.08  # of the highest frequency, for the names of the engine orders


def campbell_plot(
    speed_rpm: FloatArray,
    stuck_hz: FloatArray,
    free_hz: FloatArray,
    orders: Sequence[int],
    marks: Sequence[tuple[float, float]],
) -> Figure:
    """Frequencies (s, modes) with stuck contact (solid) and without contact (dotted) over the speed (s,), engine orders
    as thin lines with their numbers, and circles at the crossings ``marks`` (rpm, Hz)."""
    figure, axes = one_panel(7.0, 4.5)
    top, last = _ROOM * float(max(np.nanmax(stuck_hz), np.nanmax(free_hz))), float(speed_rpm[-1])
    for order in orders:
        end = min(last, 60.0 * top / order)
        axes.plot([0.0, end], [0.0, order * end / 60.0], color=GREY, linewidth=0.8)
        axes.annotate(str(order), (end, order * end / 60.0), color=INK, fontsize=8)
    _modes(axes, speed_rpm, free_hz, ORANGE, ":", "no contact")
    _modes(axes, speed_rpm, stuck_hz, BLUE, "-", "contacts stuck")
    if marks:
        places = np.array(marks).T
        axes.plot(*places, "o", color=VERMILLION, fillstyle="none", label="crossing with an engine order")
    axes.set_xlim(0.0, 1.05 * last)
    axes.set_ylim(0.0, top)
    axes.set_xlabel("Speed of rotation, rpm")
    axes.set_ylabel("Natural frequency in the rotating frame, Hz")
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3)
    return figure


def _modes(axes: Axes, speed_rpm: FloatArray, frequency_hz: FloatArray, colour: str, dash: str, name: str) -> None:
    for mode, row in enumerate(frequency_hz.T):
        axes.plot(speed_rpm, row, dash, color=colour, label=name if mode == 0 else None)
