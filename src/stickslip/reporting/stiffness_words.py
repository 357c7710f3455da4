"""A contact stiffness that was not measured, on the page: both ends of its band, in words and as lines."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from stickslip.core.plain_figure import GREEN
from stickslip.core.shown_numbers import MICRO, number
from stickslip.reporting.look import PlotMarkup, line_trace
from stickslip.reporting.style import shown_number
from stickslip.reporting.view import View
from stickslip.results.measures import Summary

_DASHES = ("dashdot", "longdash")


def stiffness_lines(view: View) -> Iterator[dict[str, Any]]:
    """A thin line for each curve with another contact stiffness."""
    band = view.response.stiffness_band
    if band is None:
        return
    for dash, curve in zip(_DASHES, band.curves(view.output), strict=False):
        words = PlotMarkup("{}<br>%{{x:.2f}} Hz<br>%{{y:.4g}} µm<extra></extra>").format(curve.name)
        yield line_trace(
            curve.name, curve.frequency_hz, MICRO * curve.amplitude, GREEN, dash, width=1.4, hovertemplate=words
        )


def stiffness_range(measures: Summary) -> str:
    """Amplitude and frequency of the peak over the band, in words; "" without a band."""
    if measures.stiffness_peaks is None or measures.stiffness_peaks_hz is None:
        return ""
    least, most = (number(MICRO * value) for value in measures.stiffness_peaks)
    low, high = (shown_number(value, "Hz") for value in measures.stiffness_peaks_hz)
    return f"{least} to {most} µm at {low} to {high} Hz"


def stiffness_words(view: View) -> str:
    """The range of the peak over the band; "" without a band."""
    return " ".join(_sentences(view))


def _sentences(view: View) -> Iterator[str]:
    band = view.response.stiffness_band
    if band is None:
        return
    tops, limits = band.curve_peaks(view.output), stiffness_range(view.summary)
    yield (
        "The contact stiffness follows from the roughness and was not measured; two methods of measurement differ by a "
        f"factor 3 on one contact. With a third of it, as computed, and with three times it, the peak is {limits}."
    )
    for name, top, complete in zip(band.names, tops, band.complete.tolist(), strict=True):
        if not complete:
            yield f"The curve with {name} ends early, so its peak may be higher."
        elif not top.bracketed:
            yield f"With {name} the largest amplitude is at an end of the range: widen it."
    yield "A measured stiffness, or one fitted to a measured frequency (roughness.stiffness_factor), narrows this band."
