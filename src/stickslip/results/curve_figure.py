"""The plain figure of an amplitude curve, for publications and notebooks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stickslip.core.plain_figure import BLUE, DOWNWARD, GREEN, GREY, INK, ORANGE, UPWARD, VERMILLION, one_panel
from stickslip.core.validation import FloatArray
from stickslip.results.peaks import peaks, window_around
from stickslip.results.side_curves import SideCurve
from stickslip.results.sweeps_of_curve import (
    Flags,
    SlowSweep,
    drawn_steps,
    joined_steps,
    notable_jumps,
    reaches,
    unstable_steps,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MICRO = 1e6  # m to µm
# Colour and width of the lines of curves beside the curve, by their common name.
TRACTION_CURVES, OTHER_CURVES = "other residual tractions", "other solutions"
STIFFNESS_CURVES = "contact stiffness × 1/3 and × 3"
_BESIDE = {STIFFNESS_CURVES: (GREEN, 1.0), TRACTION_CURVES: (GREY, 0.8), OTHER_CURVES: (VERMILLION, 1.8)}


@dataclass(frozen=True)
class AmplitudeCurve:
    """Data of the figure: frequencies in Hz, 0-to-peak amplitudes in m, and the names of the linear stuck curve,
    of the output and of the curve itself; which points are drawn as stable, their uninterrupted parts, what stable ones
    are called, the slow sweeps up and down, and curves beside the curve by their common name."""

    frequency_hz: FloatArray
    amplitude: FloatArray
    linear_frequency_hz: FloatArray
    stuck: FloatArray
    free: FloatArray
    stuck_name: str
    output_name: str
    curve_name: str
    stable: Flags
    part: NDArray[np.int64]
    solid_words: str
    slow_sweeps: tuple[SlowSweep, SlowSweep]
    beside: Mapping[str, Sequence[SideCurve]]

    def figure(self) -> Figure:
        """Amplitude against frequency, linear stuck and free beside it: stable parts solid, unstable parts dashed.

        The highest peak is marked; where slow sweeps do not reach it, their peaks and their jumps are too.
        """
        figure, axes = one_panel(7.0, 4.2)
        peak = peaks(self.frequency_hz, self.amplitude, self.part)[0]
        limits = [peaks(self.linear_frequency_hz, curve)[0] for curve in (self.stuck, self.free)]
        axes.plot(self.linear_frequency_hz, _MICRO * self.stuck, "--", color=BLUE, label=self.stuck_name)
        (free,) = axes.plot(self.linear_frequency_hz, _MICRO * self.free, ":", color=ORANGE, linewidth=2.0)
        free.set_label("linear, no contact")
        self._draw_beside(axes)
        self._draw_curve(axes)
        differ = not all(reaches(peak, sweep.peak) for sweep in self.slow_sweeps)
        words = f"{_MICRO * peak.amplitude:.4g} µm at {peak.frequency_hz:.2f} Hz"
        name = f"{'highest peak' if differ else 'peak'} {words}"
        axes.plot(peak.frequency_hz, _MICRO * peak.amplitude, "D", color=VERMILLION, label=name)
        if differ:
            self._draw_peaks_of_sweeps(axes)
        for jump in notable_jumps(peak, [jump for sweep in self.slow_sweeps for jump in sweep.jumps]):
            colour = UPWARD if jump.direction == "up" else DOWNWARD
            look = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.8, "shrinkA": 0, "shrinkB": 0}
            before, after = ((jump.frequency_hz, _MICRO * at) for at in (jump.amplitude_from, jump.amplitude_to))
            axes.annotate("", after, xytext=before, arrowprops=look)
        window = window_around(self.frequency_hz, limits)
        axes.set(xlim=window, ylim=(0.0, None), xlabel="Excitation frequency, Hz")
        axes.set_ylabel("\n".join(filter(None, ["Amplitude, 0-to-peak, µm", self.output_name])), parse_math=False)
        axes.legend(frameon=False)
        return figure

    def _draw_beside(self, axes: Axes) -> None:
        for name, curves in self.beside.items():
            for place, curve in enumerate(curves):
                height, unstable = _MICRO * curve.amplitude, unstable_steps(curve.stable)
                colour, width = _BESIDE[name]
                axes.plot([], [], color=colour, linewidth=width, label="_nolegend_" if place else name)
                for drawn, dash in ((~unstable, "-"), (unstable, "--")):
                    x, y = drawn_steps(curve.frequency_hz, drawn), drawn_steps(height, drawn)
                    axes.plot(x, y, dash, color=colour, linewidth=width)

    def _draw_curve(self, axes: Axes) -> None:
        height, unstable, joined = _MICRO * self.amplitude, unstable_steps(self.stable), joined_steps(self.part)
        if joined.all() and not unstable.any():
            axes.plot(self.frequency_hz, height, ".-", color=INK, markersize=4, label=self.curve_name)
            return
        axes.plot(self.frequency_hz[self.stable], height[self.stable], ".", color=INK, markersize=4)
        for chosen, dash, words in ((~unstable, "-", self.solid_words), (unstable, "--", "unstable")):
            drawn = chosen & joined
            if not drawn.any():
                continue
            x, y = drawn_steps(self.frequency_hz, drawn), drawn_steps(height, drawn)
            axes.plot(x, y, dash, color=INK, label=f"{self.curve_name}, {words}")

    def _draw_peaks_of_sweeps(self, axes: Axes) -> None:
        for sweep, marker, colour in zip(self.slow_sweeps, "^v", (UPWARD, DOWNWARD), strict=True):
            if sweep.peak is not None:
                top = _MICRO * sweep.peak.amplitude
                words = f"slow sweep {sweep.direction}: {top:.4g} µm at {sweep.peak.frequency_hz:.2f} Hz"
                axes.plot(sweep.peak.frequency_hz, top, marker, color=colour, label=words)
