"""The plain figure of a ridge of peaks, for publications and notebooks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stickslip.core.plain_figure import BLUE, GREY, INK, ORANGE, VERMILLION, blank_figure, plain_axes
from stickslip.core.validation import FloatArray
from stickslip.results.checked_peak import CHECKED_MINIMUM, DOUBTFUL_PEAKS, CheckedPeak

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MICRO = 1e6  # m to µm


@dataclass(frozen=True)
class RidgePicture:
    """Data of figures: the highest peak on a grid, the points of all ridges, and which are doubtful, the linear limits,
    the optimum, and checked peaks.

    Amplitudes in m, frequencies in Hz, values of the parameter in its unit.
    """

    highest_parameter: FloatArray
    highest_amplitude: FloatArray
    highest_hz: FloatArray
    parameter: FloatArray
    amplitude: FloatArray
    frequency_hz: FloatArray
    ridge: NDArray[np.int64]
    stuck_parameter: FloatArray
    stuck_amplitude: FloatArray
    stuck_hz: FloatArray
    free_parameter: FloatArray
    free_amplitude: FloatArray
    free_hz: FloatArray
    best_parameter: float
    best_amplitude: float
    best_hz: float
    best_is_inside: bool
    parameter_name: str
    parameter_unit: str
    output_name: str
    doubtful: NDArray[np.bool_]
    checked: tuple[CheckedPeak, ...]

    @property
    def parameter_words(self) -> str:
        """Name and unit of the parameter, for an axis."""
        return f"{self.parameter_name}, {self.parameter_unit}" if self.parameter_unit else self.parameter_name


def ridge_figure(picture: RidgePicture) -> Figure:
    """Peak amplitude above, peak frequency below, against the parameter; amplitude and parameter logarithmic."""
    figure = blank_figure(6.5, 6.5)
    above, below = (plain_axes(axes) for axes in figure.subplots(2, 1, sharex=True))
    panels = (
        (above, _MICRO, picture.amplitude, picture.highest_amplitude, picture.stuck_amplitude, picture.free_amplitude),
        (below, 1.0, picture.frequency_hz, picture.highest_hz, picture.stuck_hz, picture.free_hz),
    )
    for axes, scale, points, highest, stuck, free in panels:
        if stuck.size:
            axes.plot(picture.stuck_parameter, scale * stuck, "--", color=BLUE, label="linear, all stuck")
        if free.size:
            axes.plot(
                picture.free_parameter, scale * free, ":", color=ORANGE, linewidth=2.0, label="linear, no contact"
            )
        for ridge in np.unique(picture.ridge):
            here = picture.ridge == ridge
            axes.plot(picture.parameter[here], scale * points[here], ".-", color=GREY, linewidth=0.8, markersize=4)
        if (open_ones := picture.doubtful).any():
            across = picture.parameter[open_ones]
            axes.plot(
                across, scale * points[open_ones], "o", color=GREY, markerfacecolor="white", markersize=4,
                label=DOUBTFUL_PEAKS,
            )  # fmt: skip
        axes.plot(picture.highest_parameter, scale * highest, color=INK, linewidth=2.0, label="highest peak")
        axes.set_xscale("log")
    mark = "optimum" if picture.best_is_inside else "lowest followed"
    label = _place(mark, picture.best_amplitude, picture.best_parameter, picture.parameter_unit)
    above.plot(picture.best_parameter, _MICRO * picture.best_amplitude, "D", color=VERMILLION, label=label)
    below.plot(picture.best_parameter, picture.best_hz, "D", color=VERMILLION)
    for check in picture.checked:
        label = _place(CHECKED_MINIMUM, check.amplitude, check.parameter, picture.parameter_unit)
        above.plot(check.parameter, _MICRO * check.amplitude, "*", color=VERMILLION, markersize=11, label=label)
        below.plot(check.parameter, check.frequency_hz, "*", color=VERMILLION, markersize=11)
    above.set_yscale("log")
    above.set_ylabel("\n".join(filter(None, ["Peak amplitude, 0-to-peak, µm", picture.output_name])), parse_math=False)
    # Above both panels: inside, it would hide the notch of a friction optimum.
    figure.legend(*above.get_legend_handles_labels(), loc="outside upper center", ncols=2, frameon=False)
    below.set_xlabel(picture.parameter_words, parse_math=False)
    below.set_ylabel("Frequency of the peak, Hz")
    return figure


def _place(mark: str, amplitude: float, parameter: float, unit: str) -> str:
    """A label with numbers, in two lines: two labels fit side by side."""
    return f"{mark}:\n{_MICRO * amplitude:.4g} µm at {parameter:.4g} {unit}".rstrip()
