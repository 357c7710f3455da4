"""The nonlinear mode on the page: frequency, damping, contact states, energies and shape against amplitude."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, ORANGE
from stickslip.core.shown_numbers import MICRO, number, typeset
from stickslip.core.validation import FloatArray
from stickslip.reporting.estimate_section import estimate_line, words_of_estimate
from stickslip.reporting.look import Figure, PlotMarkup, axis_look, figure_of, line_trace, log_axis
from stickslip.reporting.mode_figures import energies_of_mode, shape_pictures, shape_words
from stickslip.reporting.section import Section
from stickslip.reporting.style import STATES
from stickslip.reporting.view import View
from stickslip.results.mode_figure import MODAL_AMPLITUDE
from stickslip.results.nonlinear_mode import LARGEST_RATIO_OF_PEAKS, NonlinearMode

_FARTHEST = 5.0  # chosen: a linear frequency farther from the curve, in its ranges, would make it look straight


def _mode_of(view: View) -> NonlinearMode:
    mode = view.response.nonlinear_mode
    assert mode is not None  # else the page has no such section
    return mode


def _amplitude_axis(mode: NonlinearMode) -> dict[str, Any]:
    return log_axis(MODAL_AMPLITUDE, mode.modal_amplitude)


def _curve(view: View, name: str, values: FloatArray, unit: str) -> Any:
    """Values along the mode; the hover text has the amplitude of the output too."""
    mode = _mode_of(view)
    output = MICRO * mode.harmonic_amplitude(view.output, 1)
    hover = PlotMarkup("{}: %{{y:.5g}} {}<br>modal amplitude %{{x:.3g}} m √kg<br>%{{text}}<extra></extra>").format(
        name, unit
    )
    texts = [f"{view.study.response_output}: {each:.3g} µm" for each in output]
    return line_trace(name, mode.modal_amplitude, values, INK, width=2.5, hovertemplate=hover, text=texts)


def _near(mode: NonlinearMode, hertz: float) -> bool:
    """Whether a linear frequency fits into the figure, so that the curve remains more than a straight line."""
    low, high = float(mode.frequency_hz.min()), float(mode.frequency_hz.max())
    return low - _FARTHEST * (high - low) <= hertz <= high + _FARTHEST * (high - low)


def _linear_lines(mode: NonlinearMode) -> Iterator[Any]:
    """The frequencies of the closest linear modes, stuck and sliding, that are near the curve."""
    ends = mode.modal_amplitude[[0, -1]]
    for (name, hertz), colour, dash in zip(mode.closest_linear_modes, (BLUE, ORANGE), ("dash", "dot"), strict=True):
        if _near(mode, hertz):
            yield line_trace(name, ends, [hertz] * 2, colour, dash)


def frequency_of_mode(view: View) -> Figure:
    """Frequency against modal amplitude, with the linear modes that are closest to its shape, and the estimate."""
    mode, estimate = _mode_of(view), view.response.quasi_static_mode
    beside = [] if estimate is None else [estimate_line(view, estimate.frequency_hz, "Hz")]
    return figure_of(
        [*_linear_lines(mode), *beside, _curve(view, "nonlinear mode", mode.frequency_hz, "Hz")],
        320,
        xaxis=_amplitude_axis(mode),
        yaxis=axis_look("Frequency, Hz"),
        hovermode="closest",
    )


def damping_of_mode(view: View) -> Figure:
    """Damping ratio against modal amplitude, with the limit above which peaks are elsewhere, and the estimate."""
    mode, estimate = _mode_of(view), view.response.quasi_static_mode
    ends = mode.modal_amplitude[[0, -1]]
    limit = 100.0 * LARGEST_RATIO_OF_PEAKS
    lines = [_curve(view, "nonlinear mode", 100.0 * mode.damping_ratio, "%")]
    if estimate is not None:
        lines.append(estimate_line(view, 100.0 * estimate.damping_ratio, "%"))
    if not mode.passes_peaks.all():
        lines.append(line_trace(f"{limit:.0f} %", ends, [limit] * 2, ORANGE, "dot"))
    return figure_of(
        lines,
        320,
        xaxis=_amplitude_axis(mode),
        yaxis=log_axis("Damping ratio, %", 100.0 * mode.damping_ratio),
        hovermode="closest",
    )


def states_of_mode(view: View) -> Figure:
    """Proportion of the pairs in each state against modal amplitude."""
    mode = _mode_of(view)
    traces = [
        line_trace(
            mode.pairs.state_names[state], mode.modal_amplitude, 100.0 * fraction, STATES[state].colour,
            hovertemplate=PlotMarkup("%{y:.3g} % of the pairs"),
        )
        for state, fraction in mode.state_fractions.items()
    ]  # fmt: skip
    return figure_of(
        traces,
        300,
        xaxis=_amplitude_axis(mode),
        yaxis=axis_look("Pairs, %", range=[-2, 102]),
        hovermode="x unified",
    )


def _words(view: View) -> Iterator[str]:
    mode = _mode_of(view)
    top = int(np.argmax(mode.damping_ratio))
    yield (
        f"Mode {mode.mode} of the structure with {mode.limit} contacts, followed over its amplitude: from "
        f"{mode.frequency_hz[0]:.2f} Hz to {mode.frequency_hz[-1]:.2f} Hz. Its damping ratio is at most "
        f"{number(100.0 * float(mode.damping_ratio[top]))} %, at {mode.frequency_hz[top]:.2f} Hz. The modal amplitude "
        "is the mass norm of the first harmonic; the texts of the points give the amplitude of "
        f"{view.study.response_output}."
    )
    for name, hertz in mode.closest_linear_modes:
        if not _near(mode, hertz):
            yield f"Far from this range, and not in the figure: {name}, {hertz:.2f} Hz."
    if mode.passes_peaks.all():
        structure = " of the reduced structure" if mode.reduction_is_poor else ""
        yield (
            f"The damping ratio is below {100 * LARGEST_RATIO_OF_PEAKS:.0f} % everywhere: peaks of forced responses"
            f"{structure} near this mode are on these curves."
        )
    if not mode.converged:
        yield mode.message


def _remarks(view: View) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """A paragraph, what it is about, and the warnings on that: of the mode, and of the estimate beside it."""
    mode, estimate = _mode_of(view), view.response.quasi_static_mode
    yield " ".join(_words(view)), "mode", mode.warnings
    if estimate is not None:
        yield words_of_estimate(estimate), "estimate", estimate.warnings


NONLINEAR_MODE = Section(
    "Nonlinear mode",
    """\
{% for words, about, warnings in remarks %}{{ parts.with_warnings(words, about, warnings) }}{% endfor %}
  <div class="two">
    {{ parts.figure("mode-frequency", "Frequency", "Frequency of the mode against modal amplitude") }}
    {{ parts.figure("mode-damping", "Damping ratio", "Damping ratio of the mode against modal amplitude") }}
  </div>
  <div class="two">
    {{ parts.figure("mode-states", "Contact states", "Contact states of the mode against modal amplitude") }}
    {{ parts.figure("mode-energies", "Energy per cycle", "Energies of the mode per cycle against modal amplitude") }}
  </div>
{% if shapes %}
  <p class="note">{{ shape_words }}</p>
  <div class="two">
{%- for shape in shapes %}
    {{ parts.picture(shape.words, "Shape of the mode", shape.png) }}
{%- endfor -%}
</div>
{% endif %}
""",
    lambda view: {
        "remarks": list(_remarks(view)),
        "shape_words": typeset(shape_words(_mode_of(view))),
        "shapes": shape_pictures(view),
    },
    lambda view: {
        "mode-frequency": frequency_of_mode(view),
        "mode-damping": damping_of_mode(view),
        "mode-states": states_of_mode(view),
        "mode-energies": energies_of_mode(_mode_of(view)),
    },
    applies=lambda view: view.response.nonlinear_mode is not None,
)
