"""Mistuning on the page: distribution of the amplification factor, the blades of one pattern, and their curve."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, ORANGE, VERMILLION
from stickslip.core.shown_numbers import MICRO
from stickslip.reporting.look import Figure, axis_look, figure_of, line_trace
from stickslip.reporting.section import Section
from stickslip.reporting.view import View
from stickslip.results.mistuning import LIMITS, Mistuning
from stickslip.results.mistuning_figure import exceedance

_COLOURS = dict(zip(LIMITS.values(), (BLUE, ORANGE), strict=True))
_FACTOR = "Amplification factor"


def _mistuning(view: View) -> Mistuning:
    assert view.response.mistuning is not None  # else the page has no such section
    return view.response.mistuning


def _patterns(result: Mistuning) -> Figure:
    """The fraction of patterns above a factor, with Whitehead's limit."""
    traces = []
    for words, factors in result.limits.items():
        rising, fraction = exceedance(factors.max(axis=1))
        hover = "%{y:.1%} of the patterns have at least %{x:.3f}"
        traces.append(line_trace(words, rising, fraction, _COLOURS[words], hovertemplate=hover))
    limit = result.whitehead_limit
    traces.append(line_trace("Whitehead's limit", [limit, limit], [0.0, 1.0], VERMILLION, "dash"))
    return figure_of(
        traces, 360, hovermode="closest", xaxis=axis_look(_FACTOR),
        yaxis=axis_look("Fraction of patterns", range=[0.0, 1.02]),
    )  # fmt: skip


def _blades(result: Mistuning) -> Figure:
    """The factor of each blade of the shown pattern."""
    rows = {words: (factors[result.shown], _COLOURS[words]) for words, factors in result.limits.items()}
    if result.friction_factor is not None:
        rows["friction"] = result.friction_factor, INK
    number, percent = np.arange(1, result.blades + 1), 100.0 * result.deviation[result.shown]
    traces = []
    for words, (factors, colour) in rows.items():
        trace = line_trace(
            words, number, factors, colour, mode="lines+markers",
            text=[f"blade {place}, {value:+.2f} %" for place, value in zip(number, percent, strict=True)],
            hovertemplate="%{text}: %{y:.3f}",
        )  # fmt: skip
        traces.append(trace)
    return figure_of(
        traces, 360, hovermode="closest", xaxis=axis_look("Blade"), yaxis=axis_look(_FACTOR, rangemode="tozero")
    )


def _curve(view: View, result: Mistuning) -> Figure:
    """The highest amplitude of all blades with friction beside the curve of the tuned disk."""
    assert result.ring_hz is not None
    assert result.ring_amplitude is not None
    tuned = MICRO * view.response.amplitude(view.study.outputs[view.study.response_output])
    of_blades = MICRO * result.ring_amplitude
    traces = [
        line_trace("blade that moves most", result.ring_hz, of_blades.max(axis=1), VERMILLION),
        line_trace("blade that moves least", result.ring_hz, of_blades.min(axis=1), BLUE),
        line_trace("tuned disk", view.response.frequency_hz, tuned, INK, "dash"),
    ]
    return figure_of(
        traces, 360, hovermode="closest", xaxis=axis_look("Frequency, Hz"),
        yaxis=axis_look("Amplitude, 0-to-peak, µm", rangemode="tozero"),
    )  # fmt: skip


def _figures(view: View) -> dict[str, Figure]:
    result = _mistuning(view)
    figures = {"mistuning-blades": _blades(result)}
    if len(result.deviation) > 1:
        figures["mistuning-patterns"] = _patterns(result)
    if result.ring_hz is not None:
        figures["mistuning-curve"] = _curve(view, result)
    return figures


def _words(view: View) -> Iterator[str]:
    result = _mistuning(view)
    yield (
        "The amplification factor is the highest amplitude of a blade of the mistuned disk, at any frequency of the "
        f"range, over the peak of the tuned disk; both of {view.study.response_output}, both with the same contact. "
        f"The natural frequencies of each blade alone deviate: {result.message}"
    )
    yield from result.words()


def _values(view: View) -> dict[str, Any]:
    result = _mistuning(view)
    return {
        "words": list(_words(view)),
        "patterns": len(result.deviation) > 1,
        "number": result.shown + 1,
        "curve": result.ring_hz is not None,
    }


MISTUNING = Section(
    "Mistuning",
    """\
{%- for sentence in words %}
  <p class="note">{{ sentence }}</p>
{%- endfor %}
  <div class="two">
    {%- if patterns %}
    {{ parts.figure("mistuning-patterns", "Patterns", "Fraction of patterns above an amplification factor") }}
    {%- endif %}
    {{ parts.figure("mistuning-blades", "Blades of pattern " ~ number, "Amplification factor of each blade") }}
    {%- if curve %}
    {{ parts.figure("mistuning-curve", "With friction", "Amplitude against frequency of the mistuned disk") }}
    {%- endif %}
  </div>
""",
    _values,
    _figures,
    lambda view: view.response.mistuning is not None,
)
