"""The plain figure of a nonlinear mode, for publications and notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from stickslip.core.plain_figure import BLUE, GREEN, INK, ORANGE, blank_figure, plain_axes
from stickslip.core.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ESTIMATE = "quasi-static estimate (Masing)"
MODAL_AMPLITUDE = "Modal amplitude, m √kg"


@dataclass(frozen=True)
class Backbone:
    """Frequency (n,) in Hz and damping ratio (n,) against modal amplitude (n,) in m kg^(1/2)."""

    modal_amplitude: FloatArray
    frequency_hz: FloatArray
    damping_ratio: FloatArray


def mode_figure(mode: Backbone, linear: Sequence[tuple[str, float]], quasi_static: Backbone | None) -> Figure:
    """Frequency above, damping ratio below, over the modal amplitude on a logarithmic axis.

    ``linear`` are names and frequencies in Hz of the stuck and of the sliding linear mode.
    """
    figure = blank_figure(6.0, 6.0)
    above, below = (plain_axes(axes) for axes in figure.subplots(2, 1, sharex=True))
    above.semilogx(mode.modal_amplitude, mode.frequency_hz, ".-", color=INK, markersize=4, label="nonlinear mode")
    for (name, hertz), colour, dash in zip(linear, (BLUE, ORANGE), ("--", ":"), strict=True):
        above.axhline(hertz, color=colour, linestyle=dash, label=name)
    below.loglog(mode.modal_amplitude, 100.0 * mode.damping_ratio, ".-", color=INK, markersize=4)
    if quasi_static is not None:
        line = {"color": GREEN, "linestyle": "--"}
        above.semilogx(quasi_static.modal_amplitude, quasi_static.frequency_hz, label=ESTIMATE, **line)
        below.loglog(quasi_static.modal_amplitude, 100.0 * quasi_static.damping_ratio, **line)
    above.set_ylabel("Frequency, Hz")
    above.legend(frameon=False)
    below.set(xlabel=MODAL_AMPLITUDE, ylabel="Damping ratio, %")
    return figure
