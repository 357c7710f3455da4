"""Wear on the page: depth maps of the faces, and amplitude, frequency and depth against cycles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from stickslip.core.plain_figure import BLUE, INK, VERMILLION
from stickslip.core.shown_numbers import MICRO, number, raised
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import Figure, PlotMarkup, axis_look, figure_of, line_trace
from stickslip.reporting.plots import pair_map
from stickslip.reporting.section import Section
from stickslip.reporting.view import View
from stickslip.results.wear import Wear

_LIMITS = (
    "What limits trust: one coefficient applies to all pairs at all times, and measurements of it scatter widely; "
    "debris leaves the joint at once; tractions at rest are released; the motion is periodic at each state. Depth "
    "depends on the product of coefficient and cycles alone: another coefficient only stretches the cycles."
)


def _wear(view: View) -> Wear:
    assert view.response.wear is not None  # else the page has no such section
    return view.response.wear


def _line(name: str, wear: Wear, values: FloatArray, unit: str, colour: str, dash: str = "solid") -> dict[str, Any]:
    """A line with a mark at each state."""
    hover = PlotMarkup("{}: %{{y:.5g}} {}<br>after %{{x:.4g}} cycles<extra></extra>").format(name, unit)
    trace: dict[str, Any] = line_trace(
        name, wear.cycles, values, colour, dash, mode="lines+markers", marker={"size": 5}, hovertemplate=hover
    )
    return trace


def _figures(view: View) -> dict[str, Figure]:
    wear = _wear(view)
    across = axis_look("Number of cycles", exponentformat="power")
    depth = [
        _line("largest of a pair", wear, MICRO * wear.depth.max(axis=1), "µm", VERMILLION),
        _line("mean of the faces", wear, MICRO * wear.mean_depth, "µm", BLUE, "dash"),
    ]
    figures = {
        "wear-amplitude": figure_of(
            [_line("amplitude", wear, MICRO * wear.amplitude, "µm", INK)], 320, hovermode="closest", showlegend=False,
            xaxis=across, yaxis=axis_look("0-to-peak, µm", rangemode="tozero"),
        ),
        "wear-frequency": figure_of(
            [_line("frequency", wear, wear.frequency_hz, "Hz", INK)], 320, hovermode="closest", showlegend=False,
            xaxis=across, yaxis=axis_look("Frequency, Hz"),
        ),
        "wear-depth": figure_of(
            depth, 320, hovermode="closest", xaxis=across,
            yaxis=axis_look("Both faces, µm", rangemode="tozero"),
        ),
    }  # fmt: skip
    if wear.changes_stiffness:
        figures["wear-stiffness"] = figure_of(
            [_line("normal stiffness", wear, 1e-6 * wear.total_normal_stiffness, "N/µm", INK)], 320,
            hovermode="closest", showlegend=False, xaxis=across,
            yaxis=axis_look("All pairs, N/µm", rangemode="tozero"),
        )  # fmt: skip
    if wear.open_pairs.any():
        figures["wear-open"] = figure_of(
            [_line("open pairs", wear, wear.open_pairs.astype(float), "pairs", INK)], 320, hovermode="closest",
            showlegend=False, xaxis=across, yaxis=axis_look("Pairs without load", rangemode="tozero"),
        )  # fmt: skip
    is_open = wear.normal_load[-1] == 0.0
    for face in range(len(view.study.face_names)):
        figures[f"wear-map-{face}"] = pair_map(
            view, face, MICRO * wear.depth[-1], is_open, "µm", "µm, both faces", "without load at rest"
        )
    return figures


def _sentences(view: View) -> Iterator[str]:
    wear = _wear(view)
    motion = wear.settings["motion"]
    alpha = 1e9 * wear.energy_wear_coefficient
    low, high = number(float(alpha.min())), number(float(alpha.max()))
    yield (
        f"Friction removes {low if low == high else f'{low} to {high}'} mm³ for each joule, "
        + f"while the joint vibrates at {'its highest peak' if motion == 'highest peak' else motion}, "
        + f"and the pairs that wear most lose load to others. The amplitude is that of {view.study.response_output}."
    )
    yield from wear.words()
    if wear.volume[-1] > 0.0:
        off = abs(wear.energy_volume[-1] / wear.volume[-1] - 1.0)
        yield f"Volume and friction energy times the coefficient differ by {number(100.0 * off, 2)} %."
    if not wear.converged:
        yield wear.message
    yield from wear.warnings
    yield _LIMITS


def _values(view: View) -> dict[str, Any]:
    return {
        "words": [raised(sentence) for sentence in _sentences(view)],
        "cycles": number(float(_wear(view).cycles[-1]), 3),
        "face_names": view.study.face_names,
        "opens": bool(_wear(view).open_pairs.any()),
        "changes_stiffness": _wear(view).changes_stiffness,
    }


WEAR = Section(
    "Wear",
    """\
{{ parts.facts(words) }}
  <div class="two">
    {{ parts.figure("wear-amplitude", "Amplitude", "Amplitude against cycles of wear") }}
    {{ parts.figure("wear-frequency", "Frequency", "Frequency of the motion against cycles of wear") }}
    {{ parts.figure("wear-depth", "Worn depth", "Worn depth against cycles") }}
    {%- if changes_stiffness %}
    {{ parts.figure("wear-stiffness", "Normal stiffness", "Normal stiffness of all pairs against cycles of wear") }}
    {%- endif %}
    {%- if opens %}
    {{ parts.figure("wear-open", "Open pairs", "Pairs without load at rest against cycles") }}
    {%- endif %}
  </div>
  <p class="note after">Worn depth after {{ cycles }} cycles, both faces of a pair together. Hollow pairs have no load
  at rest any more.</p><div class="maps">
{%- for name in face_names %}
{{ parts.figure("wear-map-" ~ loop.index0, name, "Worn depth, " ~ name) }}
{%- endfor -%}
</div>""",
    _values,
    _figures,
    applies=lambda view: view.response.wear is not None,
)
