"""The sections of the page of one run, in their order: each declares its heading, its content and when it applies.

For a new result on the page, add its section to ``SECTIONS`` below; no other change is necessary. Contents are Jinja2
templates, in which ``parts`` are the pieces that all pages share (assets/parts.html); text in values is escaped. Text
of a user is never part of a template.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stickslip.contact.pairing.pairing_result import FROM_PAIRING
from stickslip.core.shown_numbers import MICRO, number, raised
from stickslip.reporting import plots
from stickslip.reporting.assumption_section import ASSUMPTIONS
from stickslip.reporting.curve_plot import amplitude_frequency
from stickslip.reporting.disk_section import DISK
from stickslip.reporting.estimate_section import ESTIMATE_ALONE
from stickslip.reporting.gradient_section import GRADIENTS
from stickslip.reporting.look import Figure
from stickslip.reporting.mistuning_section import MISTUNING
from stickslip.reporting.mode_section import NONLINEAR_MODE
from stickslip.reporting.other_words import OTHER_SOLUTIONS
from stickslip.reporting.ridge_section import PEAK_RIDGE, PERFORMANCE_CURVE
from stickslip.reporting.section import Section
from stickslip.reporting.stiffness_words import stiffness_words
from stickslip.reporting.stress_section import STRESS
from stickslip.reporting.structure_section import STRUCTURE
from stickslip.reporting.style import shown_number
from stickslip.reporting.sweep_words import sweep_words
from stickslip.reporting.templates import StudyText
from stickslip.reporting.traction_words import TRACTIONS
from stickslip.reporting.view import View
from stickslip.reporting.wear_section import WEAR
from stickslip.results.measures import summary_table
from stickslip.results.record import StudyRecord, compared_model, reference_deviation
from stickslip.results.rough_patch import RoughPatch

_MAPS = """\
  <div class="maps">
{%- for name in face_names %}{{ parts.face_map(quantity, words, name, loop.index0) }}{% endfor -%}
</div>
"""


def _maps(quantity: str, words: str) -> Callable[[View], dict[str, Any]]:
    return lambda view: {"quantity": quantity, "words": words, "face_names": view.study.face_names}


def _map_figures(quantity: str) -> Callable[[View], dict[str, Figure]]:
    def figures(view: View) -> dict[str, Figure]:
        faces = range(len(view.study.face_names))
        return {f"{quantity}-map-{face}": plots.face_map(view, face, quantity) for face in faces}

    return figures


def _open_at_rest(view: View) -> list[tuple[str, int, int]]:
    """Name, open pairs and pairs of each face."""
    closed, face = view.response.pairs.closed_at_rest, view.study.pair_face
    return [
        (name, int((~closed[face == place]).sum()), int((face == place).sum()))
        for place, name in enumerate(view.study.face_names)
    ]


def _measures(view: View) -> list[tuple[str, str]]:
    """Names and values with their units."""
    return [
        (name, "–" if value == "-" else raised(f"{value} {'' if unit == '-' else unit}"))
        for name, value, unit in summary_table(view.summary)
    ]


_MODE_HEADINGS = {
    "mode": "#",
    "description": "Mode",
    "full_hz": "Full model, Hz",
    "reduced_hz": "Reduced model, Hz",
    "difference_percent": "Difference, %",
    "mac": "MAC",
    "reference_hz": "Reference, Hz",
}


@dataclass(frozen=True)
class _ModeTable:
    """The mode table in words: headings and cells, each with whether it is a word; source of its reference, or ""."""

    contact: str
    source: str
    headings: list[tuple[str, bool]]
    rows: list[list[tuple[str, bool]]]


def _mode_table(study: StudyRecord) -> _ModeTable:
    columns = [key for key in _MODE_HEADINGS if any(key in row for row in study.mode_table)]
    deviation = [reference_deviation(row) for row in study.mode_table]
    headings = [(_MODE_HEADINGS[key], key == "description") for key in columns]
    rows = [[(_mode_cell(key, row.get(key)), key == "description") for key in columns] for row in study.mode_table]
    if any(percent is not None for percent in deviation):
        headings.append((f"{compared_model(study.mode_table)} against reference, %", False))
        for cells, percent in zip(rows, deviation, strict=True):
            cells.append(("–" if percent is None else f"{percent:+.2f}".replace("-", "−"), False))
    return _ModeTable(study.mode_contact, study.mode_reference, headings, rows)


def _mode_cell(key: str, value: str | float | int | None) -> str:
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    if key == "mode":
        return str(int(value))
    if key == "mac":
        return f"{value:.4f}"
    return number(float(value), 3) if key == "difference_percent" else shown_number(float(value), "Hz")


def _rough_face(patch: RoughPatch) -> str:
    """Description of the picture of a rough face."""
    size = f"{number(1e3 * patch.length)} mm by {number(1e3 * patch.width)} mm"
    shown = number(MICRO * float(patch.about_mean.std()))
    return (
        f"Heights about their mean on {size}, one of the faces that the roughness and its seed describe: "
        f"Sq {number(MICRO * patch.sq)} µm and Sdq {number(patch.sdq)} of all waves, as the mean over many faces; "
        f"Sq {shown} µm of the {patch.height.size} points shown, which are too far apart for the shortest waves and "
        "for a slope."
    )


def _rest_values(view: View) -> dict[str, Any]:
    return {"hollow": view.unloaded_words, "open_at_rest": _open_at_rest(view), "face_names": view.study.face_names}


def _rest_figures(view: View) -> dict[str, Figure]:
    return {f"rest-map-{face}": plots.rest_map(view, face) for face in range(len(view.study.face_names))}


def _group_figures(view: View) -> dict[str, Figure]:
    groups = enumerate(view.study.signal_groups.values())
    return {f"group-{group}": plots.output_signals(names) for group, names in groups}


def _rough_values(view: View) -> dict[str, Any]:
    return {} if view.study.rough_patch is None else {"rough_face": _rough_face(view.study.rough_patch)}


def _rough_figures(view: View) -> dict[str, Figure]:
    return {} if view.study.rough_patch is None else {"rough-map": plots.rough_face(view.study.rough_patch)}


def _derived(view: View) -> dict[str, Any]:
    """Rows of the table, and of the folded one below it."""
    derived: list[tuple[str, ...]] = []
    pairing: list[tuple[str, ...]] = []
    for name, value, unit, meaning in view.study.derived:
        rows = pairing if meaning == FROM_PAIRING else derived
        rows.append((name, shown_number(value, unit), "" if unit == "-" else unit, meaning))
    return {"derived": derived, "pairing": pairing}


def _solver(view: View) -> dict[str, Any]:
    settings = [(key, number(value)) for key, value in view.response.settings.items()]
    return {"settings": settings, "provenance": view.response.provenance}


# The section that is always first: the controls of all others follow it.
CURVE = Section(
    "Amplitude against frequency",
    """\
  <p class="note">{{ output }}, 0-to-peak. <span class="screen-only">Choose a point on the curve, or move the slider
  below: the figures after it show that point.</span>{% if sweeps %} {{ sweeps }}{% endif %}</p>{% if stiffness %}
  <p class="note">{{ stiffness }}</p>{% endif %}
  {{ parts.panel("curve", "Amplitude against frequency") }}
""",
    lambda view: {
        "output": view.study.response_output,
        "sweeps": sweep_words(view),
        "stiffness": stiffness_words(view),
    },
    lambda view: {"curve": amplitude_frequency(view)},
    beside='\n    <button type="button" id="scale" class="screen-only">Logarithmic axis</button>',
)

SECTIONS = (
    PERFORMANCE_CURVE,
    PEAK_RIDGE,
    WEAR,
    DISK,
    MISTUNING,
    STRUCTURE,
    STRESS,
    Section(
        "Contact states",
        """\
  <p class="note">At <b class="now"></b>. <span class="screen-only">Select a pair by a click, or with the arrow keys
  once a map has the focus; its loop follows below.</span></p>
  <ul class="legend" id="state-legend"></ul>
"""
        + _MAPS,
        _maps("state", "Contact states"),
        _map_figures("state"),
    ),
    Section(
        "Dissipated energy of each pair",
        """\
  <p class="note">At <b class="now"></b>. Total: <b id="energy-now"></b> per cycle.</p>
"""
        + _MAPS,
        _maps("energy", "Dissipated energy"),
        _map_figures("energy"),
    ),
    Section(
        "Hysteresis and time signals of one pair",
        """\
  <p class="note"><b id="pair-now"></b>, <span id="loop-now"></span>. Tangential directions t1 and t2, normal n
  (positive when it closes). The normal force N contains the preload; t1 and t2 are shown about their mean over the
  period.</p>
  <div class="two">
    {{ parts.figure("loop", "Hysteresis loop", "Hysteresis loop of the chosen pair") }}
    {{ parts.figure("signals", "Time signals", "Time signals of the chosen pair") }}
  </div>
""",
        figures=lambda view: {"loop": plots.hysteresis_loop(view), "signals": plots.pair_signals()},
    ),
    TRACTIONS,
    OTHER_SOLUTIONS,
    NONLINEAR_MODE,
    ESTIMATE_ALONE,
    GRADIENTS,
    Section(
        "Pressure at rest",
        """\
<p class="note">
{%- for name, opened, count in open_at_rest %}
{{ name }}: {{ opened }} of {{ count }} pairs open{{ "" if loop.last else "; " }}
{%- endfor -%}
. Hollow pairs are {{ hollow }}; in the linear stuck curve, open pairs stay open.</p><div class="maps">
{%- for name in face_names %}
{{ parts.figure("rest-map-" ~ loop.index0, name, "Pressure at rest, " ~ name) }}
{%- endfor -%}
</div>""",
        _rest_values,
        _rest_figures,
        lambda view: view.rest_varies,
    ),
    Section(
        "Energy per cycle along the curve",
        """\
  <p class="note">Friction and viscous damping together balance the work of the excitation; the largest imbalance on the
  curve is {{ imbalance }} of the input.</p>
  {{ parts.panel("energy-curve", "Energy per cycle against frequency") }}
""",
        lambda view: {"imbalance": number(view.summary.energy_imbalance, 2)},
        lambda view: {"energy-curve": plots.energy_curve(view)},
    ),
    Section(
        "Motion over one period",
        """\
<p class="note">At <b class="now"></b>; displacements are shown about their mean over the period.</p><div class="two">
{%- for heading in groups %}{{ parts.figure("group-" ~ loop.index0, heading, heading) }}{% endfor -%}
</div>""",
        lambda view: {"groups": list(view.study.signal_groups)},
        _group_figures,
        lambda view: bool(view.study.signal_groups),
    ),
    Section(
        "Natural frequencies, contact {{ modes.contact }}",
        """\
{% if modes.source %}
<p class="note">Reference: {{ modes.source }}. It is compared in the order of the modes, with the contact of the
  model as in the heading.</p>{% endif %}
{%- call parts.scrolled("Natural frequencies") %}<table><thead><tr>
{%- for heading, is_word in modes.headings %}{{ parts.head_cell(heading, is_word) }}{% endfor -%}
</tr></thead><tbody>
{%- for row in modes.rows %}<tr>
{%- for value, is_word in row %}<td{% if is_word %} class="word"{% endif %}>{{ value }}</td>{% endfor -%}
</tr>{% endfor -%}
</tbody></table>{% endcall %}""",
        lambda view: {"modes": _mode_table(view.study)},
        applies=lambda view: bool(view.study.mode_table),
    ),
    Section(
        "Measures at the peak",
        """\
  {{ parts.named_values("Measures at the peak", measures) }}
  <p class="note">All measures without other words are those at the highest peak on the curve. The equivalent damping
  ratio is the energy that friction and viscous damping dissipate per cycle over 4π times the largest kinetic energy of
  the first harmonic. The half-power width, (f2 − f1) / (2 f), is a measure of width only: the curve of a joint that
  slips is not a resonance curve. Shifts and reductions compare the highest peak with that of each linear curve; “–”
  means that the linear curve has no peak inside its range, that this curve does not fall to half power, or that the
  file is of a version without kinetic energies.</p>
""",
        lambda view: {"measures": _measures(view)},
    ),
    ASSUMPTIONS,
    Section(
        "Rough face",
        """<p class="note">{{ rough_face }}</p>{{ parts.panel("rough-map", "Heights of a rough face") }}""",
        _rough_values,
        _rough_figures,
        lambda view: view.study.rough_patch is not None,
    ),
    Section(
        "Derived quantities",
        """\
{{ parts.quantities("Derived quantities", derived) }}
{% if pairing %}<details class="more"><summary>From the pairing of the contact faces ({{ pairing | length }})</summary>
{{ parts.quantities("Pairing of the contact faces", pairing) }}</details>{% endif %}""",
        _derived,
        applies=lambda view: bool(view.study.derived),
    ),
    Section(
        "Inputs",
        """\
{{ parts.study_file(study) }}
{% if notes %}<details class="more"><summary>Notes on the model file ({{ notes | length }})</summary>
<ul>{% for words in notes %}<li>{{ words }}</li>{% endfor %}</ul></details>{% endif %}""",
        lambda view: {"study": StudyText(view.study.inputs, view.changed_inputs), "notes": view.study.notes},
    ),
    Section(
        "Settings and provenance",
        """\
  <div class="two tables">
    {{ parts.named_values("Solver", settings, "Solver") }}
    {{ parts.named_values("Software", provenance.items(), "Software") }}
  </div>
""",
        _solver,
    ),
)
