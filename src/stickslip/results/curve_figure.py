"""The plain figure of an amplitude curve, for publications and notebooks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from stickslip.core.plain_figure import BLUE, INK, ORANGE, VERMILLION, one_panel
from stickslip.core.validation import FloatArray
from stickslip.results.peaks import peaks, window_around

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MICRO = 1e6  # m to µm


@dataclass(frozen=True)
class AmplitudeCurve:
    """Data of the figure: frequencies in Hz, 0-to-peak amplitudes in m, and the names of the linear stuck curve,
    of the output and of the curve itself."""

    frequency_hz: FloatArray
    amplitude: FloatArray
    linear_frequency_hz: FloatArray
    stuck: FloatArray
    free: FloatArray
    stuck_name: str
    output_name: str
    curve_name: str

    def figure(self) -> Figure:
        """Amplitude against frequency, linear stuck and free beside it, the peak marked."""
        figure, axes = one_panel(7.0, 4.2)
        peak = peaks(self.frequency_hz, self.amplitude)[0]
        limits = [peaks(self.linear_frequency_hz, curve)[0] for curve in (self.stuck, self.free)]
        axes.plot(self.linear_frequency_hz, _MICRO * self.stuck, "--", color=BLUE, label=self.stuck_name)
        (free,) = axes.plot(self.linear_frequency_hz, _MICRO * self.free, ":", color=ORANGE, linewidth=2.0)
        free.set_label("linear, no contact")
        axes.plot(self.frequency_hz, _MICRO * self.amplitude, ".-", color=INK, markersize=4, label=self.curve_name)
        words = f"peak {_MICRO * peak.amplitude:.4g} µm at {peak.frequency_hz:.2f} Hz"
        axes.plot(peak.frequency_hz, _MICRO * peak.amplitude, "D", color=VERMILLION, label=words)
        window = window_around(self.frequency_hz, limits)
        axes.set(xlim=window, ylim=(0.0, None), xlabel="Excitation frequency, Hz")
        axes.set_ylabel("\n".join(filter(None, ["Amplitude, 0-to-peak, µm", self.output_name])), parse_math=False)
        axes.legend(frameon=False)
        return figure
