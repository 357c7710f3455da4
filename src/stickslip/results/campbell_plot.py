"""The plain figure of a Campbell diagram, for publications and notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from stickslip.core.plain_figure import BLUE, GREY, INK, ORANGE, VERMILLION, one_panel
from stickslip.core.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Mark(Protocol):
    """A crossing with an engine order."""

    @property
    def order(self) -> int:
        """Engine order."""

    @property
    def speed_rpm(self) -> float:
        """Revolutions per minute."""

    @property
    def frequency_hz(self) -> float:
        """Hz."""


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


def _modes(axes: Axes, speed_rpm: FloatArray, frequency_hz: FloatArray, colour: Any, dash: str, name: str) -> None:
    for mode, row in enumerate(frequency_hz.T):
        axes.plot(speed_rpm, row, dash, color=colour, label=name if mode == 0 else None)


def disk_campbell_plot(
    speed_rpm: FloatArray, diameters: Sequence[int], frequency_hz: FloatArray, marks: Sequence[Mark]
) -> Figure:
    """Frequencies (2, k, s, modes) of forward waves (solid) and backward ones (dashed) over the speed (s,), a colour
    for each of ``diameters`` (k,), and circles with the engine order at the ``marks``."""
    from matplotlib import colormaps

    figure, axes = one_panel(7.0, 4.5)
    colours = colormaps["viridis"](np.linspace(0.0, 0.85, len(diameters)))
    for place, diameter in enumerate(diameters):
        for waves, dash in zip(frequency_hz[:, place], ("-", "--"), strict=True):
            name = f"{diameter} nodal diameter{'' if diameter == 1 else 's'}" if dash == "-" else "_"
            _modes(axes, speed_rpm, waves, colours[place], dash, name)
    for mark in marks:
        axes.plot([mark.speed_rpm], [mark.frequency_hz], "o", color=VERMILLION, fillstyle="none")
        axes.annotate(str(mark.order), (mark.speed_rpm, mark.frequency_hz), color=INK, fontsize=8)
    axes.set_xlim(0.0, 1.05 * float(speed_rpm[-1]))
    axes.set_ylim(0.0, _ROOM * float(np.nanmax(frequency_hz)))
    axes.set_xlabel("Speed of rotation, rpm")
    axes.set_ylabel("Natural frequency in the rotating frame, Hz")
    axes.set_title("solid: forward waves, dashed: backward; circles: engine orders that excite them", fontsize=8)
    axes.legend(frameon=False, fontsize=8)
    return figure
