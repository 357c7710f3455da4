"""Ridges of peaks on the page: the performance curve of two blades, and the peaks over a key of the study."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, GREY, INK, ORANGE, VERMILLION
from stickslip.core.shown_numbers import MICRO, number
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import Figure, PlotMarkup, axis_look, figure_of, line_trace, log_axis, plain_list
from stickslip.reporting.section import Section
from stickslip.reporting.view import View
from stickslip.results.checked_peak import CheckedPeak, is_doubtful
from stickslip.results.highest_peak import Optimum
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.ridge_words import STUCK_OPTIMUM

RidgeOf = Callable[[View], PeakRidge | None]
# Prefixes of the ids of figures.
_PERFORMANCE, _RIDGE = "performance", "ridge"
# Short names: a legend of three columns has to fit into half the width of a page.
_DOUBTFUL, _CHECKED = "error above 1 %", "minimum with slip"
_LEGEND = {"legend": 90}  # px, of a legend of four rows in print
_HEIGHT = 440  # px


def _performance(view: View) -> PeakRidge | None:
    return view.response.performance_curve


def _peaks_over_a_key(view: View) -> PeakRidge | None:
    return view.response.peak_ridge


def _axis_words(ridge: PeakRidge) -> str:
    """Name and unit of the parameter; a key of a study stays as it is."""
    words = ridge.parameter_name
    if " " in words:
        words = words[:1].upper() + words[1:]
    return f"{words}, {ridge.parameter_unit}" if ridge.parameter_unit else words


def _mark(
    name: str, ridge: PeakRidge, at: Optimum | CheckedPeak, value: float, symbol: str, colour: str
) -> dict[str, Any]:
    """A mark at a value of the parameter."""
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": plain_list([at.parameter]),
        "y": plain_list([value]),
        "marker": {"symbol": symbol, "size": 11, "color": colour, "line": {"color": "#ffffff", "width": 1}},
        "hovertemplate": PlotMarkup("{}: %{{y:.4g}}<br>at %{{x:.4g}} {}<extra></extra>").format(
            name, ridge.parameter_unit
        ),
    }


def _panel(ridge: PeakRidge, here: Optimum | None, of_amplitude: bool) -> list[dict[str, Any]]:
    """Traces of the amplitude in µm or of the frequency in Hz against the parameter."""
    scale, top = MICRO if of_amplitude else 1.0, ridge.highest()

    def chosen(amplitude: FloatArray, frequency_hz: FloatArray) -> FloatArray:
        return scale * np.asarray(amplitude if of_amplitude else frequency_hz)

    unit = "µm" if of_amplitude else "Hz"
    hover = PlotMarkup("%{{y:.5g}} {} at %{{x:.4g}} {}").format(unit, ridge.parameter_unit)
    stuck, free = (
        chosen(ridge.stuck_amplitude, ridge.stuck_frequency_hz),
        chosen(ridge.free_amplitude, ridge.free_frequency_hz),
    )
    limits = (
        ("linear, all stuck", ridge.stuck_parameter, stuck, BLUE, "dash"),
        ("linear, no contact", ridge.free_parameter, free, ORANGE, "dot"),
    )
    traces = [line_trace(*limit, hovertemplate=hover) for limit in limits if limit[1].size]
    doubtful = is_doubtful(ridge.estimated_error, ridge.n_points)
    kinds = (("computed peaks", ~doubtful, "circle"), (_DOUBTFUL, doubtful, "circle-open"))
    for name, points, symbol in kinds:
        if points.any():
            values = chosen(ridge.amplitude[points], ridge.frequency_hz[points])
            marker = {"size": 5, "color": GREY, "symbol": symbol}
            traces.append(
                line_trace(
                    name, ridge.parameter[points], values, GREY, width=1.0, mode="markers", marker=marker,
                    hovertemplate=hover,
                )
            )  # fmt: skip
    values = chosen(top.amplitude, top.frequency_hz)
    highest = line_trace("highest peak", [], [], INK, width=2.5, hovertemplate=hover)
    highest["x"], highest["y"] = plain_list(top.parameter), [v if np.isfinite(v) else None for v in _rounded(values)]
    traces.append(highest)
    if here is not None:
        value = float(chosen(np.array(here.amplitude), np.array(here.frequency_hz)))
        traces.append(_mark("this study", ridge, here, value, "circle", INK))
    best = ridge.optimum
    value = float(chosen(np.array(best.amplitude), np.array(best.frequency_hz)))
    traces.append(_mark("optimum" if best.is_inside else "lowest followed", ridge, best, value, "diamond", VERMILLION))
    for check in ridge.checked:
        value = float(chosen(np.array(check.amplitude), np.array(check.frequency_hz)))
        traces.append(_mark(_CHECKED, ridge, check, value, "star", VERMILLION))
    return traces


def _rounded(values: FloatArray) -> list[float]:
    return [float(f"{value:.7g}") for value in values]


def _here(view: View, ridge: PeakRidge) -> Optimum | None:
    """The point of the study itself on its performance curve."""
    settings = ridge.settings
    if "centrifugal_force_n" not in settings:
        return None
    ratio = float(settings["centrifugal_force_n"]) / float(settings["excitation_force_n"])
    at = ridge.at(ratio)
    return Optimum(ratio, float(at.amplitude[0]), float(at.frequency_hz[0])) if at.ridge[0] >= 0 else None


def _figures(ridge_of: RidgeOf, prefix: str) -> Callable[[View], dict[str, Figure]]:
    def figures(view: View) -> dict[str, Figure]:
        ridge = ridge_of(view)
        assert ridge is not None  # else the page has no such section
        words, here = _axis_words(ridge), _here(view, ridge)
        across = log_axis(words, ridge.parameter)
        amplitudes = _panel(ridge, here, of_amplitude=True)
        ends = _range_of_peaks(amplitudes)
        up = log_axis("0-to-peak, µm", [10.0**end for end in ends], range=ends)
        return {
            f"{prefix}-amplitude": figure_of(
                amplitudes, _HEIGHT, hovermode="closest", meta=_LEGEND,
                xaxis=across, yaxis=up,
            ),
            f"{prefix}-frequency": figure_of(
                _panel(ridge, here, of_amplitude=False), _HEIGHT, hovermode="closest", meta=_LEGEND,
                xaxis=across, yaxis=axis_look("Frequency, Hz"),
            ),
        }  # fmt: skip

    return figures


def _range_of_peaks(traces: Sequence[Mapping[str, Any]]) -> list[float]:
    """Ends of a logarithmic axis: from below all peaks to above all peaks and limits. A linear limit may be very small
    where its peak is almost zero at the response; this would hide the peaks."""
    heights = {limit: [0.0] for limit in (False, True)}
    for trace in traces:
        heights[trace["name"].startswith("linear")] += [value for value in trace["y"] if value]
    peaks = [value for value in heights[False] if value > 0.0]
    return [float(np.log10(0.6 * min(peaks))), float(np.log10(1.5 * max(peaks + heights[True])))]


def _performance_words(view: View) -> Iterator[str]:
    ridge = view.response.performance_curve
    assert ridge is not None
    force = float(ridge.settings["excitation_force_n"])
    best = ridge.optimum
    yield (
        f"Highest peak of {view.study.response_output} under the excitation of this study, {number(force)} N, while "
        "the centrifugal force of the damper changes: another mass, or another speed. The normal load and the contact "
        "stiffness of the study follow from that force, so that the linear stuck limit changes too."
    )
    if best.is_inside:
        yield (
            f"The optimum is at {number(best.parameter, 3)} times the excitation force, "
            f"{number(force * best.parameter, 3)} N: {number(MICRO * best.amplitude)} µm at {best.frequency_hz:.2f} Hz"
            f"{ridge.words_on_error(best)}."
        )
    else:
        yield (
            f"The lowest peak, {number(MICRO * best.amplitude)} µm at {number(force * best.parameter, 3)} N, is at "
            f"{best.edge}: a lower one may be beyond."
        )
    if ridge.has_stuck_optimum:
        yield STUCK_OPTIMUM
    for other in ridge.other_minima:
        where = f"{number(MICRO * other.amplitude)} µm at {number(force * other.parameter, 3)} N"
        where += ridge.words_on_error(other)
        yield f"Another local minimum is {where}."
    yield from ridge.words_on_trust(lambda ratio: f"{number(force * ratio, 3)} N")
    for ratio in ridge.switches():
        yield f"At {number(force * ratio, 3)} N another peak becomes the highest."
    yield from _common_words(ridge)


def _common_words(ridge: PeakRidge) -> Iterator[str]:
    yield "A peak counts also if it is unstable, or if a slow sweep does not reach it."
    if not ridge.converged:
        yield ridge.message
    yield from ridge.warnings


def _ridge_words(view: View) -> Iterator[str]:
    ridge = view.response.peak_ridge
    assert ridge is not None
    yield f"Highest peak of {ridge.output_name} over {ridge.parameter_name}; all other keys are those of this study."
    yield from ridge.words()
    yield from _common_words(ridge)


# The figures are first: in print they fit below the curve, while the words may need half a page.
_TEMPLATE = """\
  <div class="two">
    {{ parts.figure(prefix ~ "-amplitude", "Peak amplitude", "Peak amplitude: " ~ title) }}
    {{ parts.figure(prefix ~ "-frequency", "Peak frequency", "Peak frequency: " ~ title) }}
  </div>
{{ parts.facts(words) }}
"""


def _section(heading: str, prefix: str, ridge_of: RidgeOf, words: Callable[[View], Iterator[str]]) -> Section:
    return Section(
        heading,
        _TEMPLATE,
        lambda view: {"words": list(words(view)), "prefix": prefix, "title": heading},
        _figures(ridge_of, prefix),
        applies=lambda view: ridge_of(view) is not None,
    )


PERFORMANCE_CURVE = _section("Performance curve of the damper", _PERFORMANCE, _performance, _performance_words)
PEAK_RIDGE = _section("Peaks over a key of the study", _RIDGE, _peaks_over_a_key, _ridge_words)
