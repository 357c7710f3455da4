"""The plain figure of a joint that wears, for publications and notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.core.plain_figure import BLUE, INK, VERMILLION, blank_figure, plain_axes
from stickslip.core.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MICRO = 1e6  # m to µm


def wear_figure(
    cycles: FloatArray, amplitude: FloatArray, frequency_hz: FloatArray, largest: FloatArray, mean: FloatArray
) -> Figure:
    """Amplitude, frequency, and largest and mean depth (m) against the number of cycles, one above the other."""
    figure = blank_figure(6.5, 7.5)
    above, middle, below = (plain_axes(axes) for axes in figure.subplots(3, 1, sharex=True))
    above.plot(cycles, _MICRO * amplitude, ".-", color=INK)
    above.set_ylabel("Amplitude, 0-to-peak, µm")
    middle.plot(cycles, frequency_hz, ".-", color=INK)
    middle.set_ylabel("Frequency, Hz")
    below.plot(cycles, _MICRO * largest, ".-", color=VERMILLION, label="largest of a pair")
    below.plot(cycles, _MICRO * mean, ".--", color=BLUE, label="mean of the faces")
    below.set_ylabel("Worn depth, both faces, µm")
    below.set_xlabel("Number of cycles")
    below.legend(frameon=False)
    return figure
