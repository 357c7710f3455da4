"""The quasi-static estimate of a mode on the page: beside the nonlinear mode, or alone."""

from __future__ import annotations

from typing import Any

from stickslip.core.plain_figure import GREEN
from stickslip.core.shown_numbers import MICRO, number
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import Figure, PlotMarkup, axis_look, figure_of, line_trace, log_axis
from stickslip.reporting.section import Section
from stickslip.reporting.view import View
from stickslip.results.mode_figure import ESTIMATE, MODAL_AMPLITUDE
from stickslip.results.quasi_static_mode import QuasiStaticMode


def estimate_line(view: View, values: FloatArray, unit: str) -> Any:
    """Values along the estimate; the hover text has the amplitude of the output too."""
    estimate = _estimate_of(view)
    hover = PlotMarkup("{}: %{{y:.5g}} {}<br>modal amplitude %{{x:.3g}} m √kg<br>%{{text}}<extra></extra>").format(
        ESTIMATE, unit
    )
    output = MICRO * estimate.amplitude(view.output)
    texts = [f"{view.study.response_output}: {each:.3g} µm" for each in output]
    return line_trace(ESTIMATE, estimate.modal_amplitude, values, GREEN, "dash", hovertemplate=hover, text=texts)


def words_of_estimate(estimate: QuasiStaticMode) -> str:
    """What the estimate is, and how far it differs from the nonlinear mode."""
    return (
        f"Quasi-static estimate, from a static load in the shape of stuck mode {estimate.mode} and Masing's rule: "
        f"{estimate.message}"
    )


def _estimate_of(view: View) -> QuasiStaticMode:
    estimate = view.response.quasi_static_mode
    assert estimate is not None  # else the page has no such line
    return estimate


def _figures(view: View) -> dict[str, Figure]:
    """Frequency and damping ratio of the estimate alone."""
    estimate = _estimate_of(view)
    ratio, amplitude_axis = 100.0 * estimate.damping_ratio, log_axis(MODAL_AMPLITUDE, estimate.modal_amplitude)
    frequency = [estimate_line(view, estimate.frequency_hz, "Hz")]
    damping = [estimate_line(view, ratio, "%")]
    return {
        "estimate-frequency": figure_of(
            frequency, 320, xaxis=amplitude_axis, yaxis=axis_look("Frequency, Hz"), hovermode="closest"
        ),
        "estimate-damping": figure_of(
            damping, 320, xaxis=amplitude_axis, yaxis=log_axis("Damping ratio, %", ratio), hovermode="closest"
        ),
    }


def _words(view: View) -> str:
    estimate = _estimate_of(view)
    top = int(estimate.damping_ratio.argmax())
    ends = (
        f"From {estimate.frequency_hz[0]:.2f} Hz to {estimate.frequency_hz[-1]:.2f} Hz; the linear mode has "
        f"{float(estimate.linear_frequency_hz):.2f} Hz. The damping ratio is at most "
        f"{number(100.0 * float(estimate.damping_ratio[top]))} %, at {estimate.frequency_hz[top]:.2f} Hz. The "
        "nonlinear mode, with the inertia of all modes, was not computed."
    )
    return f"{words_of_estimate(estimate)} {ends}"


ESTIMATE_ALONE = Section(
    "Quasi-static estimate of a mode",
    """\
{{ parts.with_warnings(words, "estimate", warnings) }}
  <div class="two">
    {{ parts.figure("estimate-frequency", "Frequency", "Estimated frequency of the mode against modal amplitude") }}
    {{ parts.figure("estimate-damping", "Damping ratio", "Estimated damping ratio against modal amplitude") }}
  </div>
""",
    lambda view: {"words": _words(view), "warnings": _estimate_of(view).warnings},
    _figures,
    applies=lambda view: view.response.quasi_static_mode is not None and view.response.nonlinear_mode is None,
)
