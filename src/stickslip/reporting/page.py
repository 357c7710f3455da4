"""The report: one self-contained HTML page, with plotly.js and all data inside, that asks nothing of the network."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from os import PathLike
from pathlib import Path

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.reporting import plots
from stickslip.reporting.html_parts import notice, scrolled, table_rows, when, whole_page, word_class
from stickslip.reporting.look import Figure
from stickslip.reporting.page_data import page_data
from stickslip.reporting.sketch import structure_section
from stickslip.reporting.style import MICRO, number, shown_number
from stickslip.reporting.view import View
from stickslip.results.measures import summary_table
from stickslip.results.record import StudyRecord
from stickslip.results.response import STATE_NAMES, ForcedResponse

_MODE_HEADINGS = {
    "mode": "#",
    "description": "Mode",
    "full_hz": "Full model, Hz",
    "reduced_hz": "Reduced model, Hz",
    "difference_percent": "Difference, %",
    "mac": "MAC",
    "table2_hz": "Paper, Table 2, Hz",
}
_INFERRED = (
    "The geometry is <b>inferred</b>: the paper's drawing does not survive, so seven dimensions were fitted to these "
    "ten frequencies of its Table 2, with tied contact. The last column shows how good that fit is; it is not an "
    "independent check. The frequencies of this study, with its own contact stiffness, stand among the derived "
    "quantities."
)


def write_page(path: str | PathLike[str], response: ForcedResponse, study: StudyRecord) -> None:
    """Write the report of one run to ``path``, whole or not at all.

    Raises InputError if the study does not belong to the response, or the place cannot be written.
    """
    target = Path(path)
    text = page(response, study)
    with whole_file(target, "report", InputError) as part:
        part.write_text(text, encoding="utf-8")


def page(response: ForcedResponse, study: StudyRecord) -> str:
    """The report of one run as HTML. Raises InputError if the study does not belong to the response."""
    view = View.of(response, study)
    faces = range(len(study.face_names))
    drawing = structure_section(study)
    ended = "converged" if response.converged else "NOT converged"
    parts = {
        "title": escape(study.title),
        "description": escape(study.description),
        "byline": escape(
            f"{when(response.provenance)} · {response.n_points} points · {response.harmonics} harmonics · {ended}"
        ),
        "notices": _notices(view),
        "tiles": _tiles(view),
        "output": escape(study.response_output),
        "point": str(view.point),
        "last_point": str(response.n_points - 1),
        "pair_options": _pair_options(view),
        "structure": drawing,
        "rest": _rest(view),
        "state_maps": _maps(study, faces, "state", "Contact states"),
        "energy_maps": _maps(study, faces, "energy", "Dissipated energy"),
        "imbalance": number(view.summary.energy_imbalance, 2),
        "groups": _groups(study),
        "modes": _mode_table(study),
        "measures": table_rows(
            (name, "–" if value == "-" else f"{value} {unit}".replace("-", "−"))
            for name, value, unit in _measures(view)
        ),
        "rough_face": _rough_face(study),
        "derived": _derived(study),
        "inputs": escape(study.inputs),
        "settings": table_rows((key, number(value)) for key, value in response.settings.items()),
    }
    return whole_page(
        "page.html",
        "Forced response with rough frictional contact",
        parts,
        response.provenance,
        script="page.js",
        data={"page-data": page_data(view, len(drawing)), "page-figures": _figures(view)},
    )


def _figures(view: View) -> dict[str, Figure]:
    figures = {
        "curve": plots.amplitude_frequency(view),
        "loop": plots.hysteresis_loop(),
        "signals": plots.pair_signals(),
        "energy-curve": plots.energy_curve(view),
    }
    for face in range(len(view.study.face_names)):
        for quantity in ("state", "energy"):
            figures[f"{quantity}-map-{face}"] = plots.face_map(view, face, quantity)
        if view.rest_is_uneven:
            figures[f"rest-map-{face}"] = plots.rest_map(view, face)
    if view.study.rough_patch is not None:
        figures["rough-map"] = plots.rough_face(view.study.rough_patch)
    for group, names in enumerate(view.study.signal_groups.values()):
        figures[f"group-{group}"] = plots.output_signals(names)
    return figures


def _notices(view: View) -> str:
    response = view.response
    blocks = []
    if not response.converged:
        words = "These are partial results: the figures show the points that were computed."
        blocks.append(notice("bad", "The solve did not converge", [response.message, words]))
    warnings = [*response.warnings, *view.study.warnings]
    if not view.summary.peak.bracketed:
        warnings.append(
            "The largest amplitude lies at an end of the computed range, so the true peak may be higher: widen the "
            "frequency range."
        )
    if warnings:
        blocks.append(notice("warn", "Warnings" if len(warnings) > 1 else "Warning", warnings))
    return "\n".join(blocks)


def _tiles(view: View) -> str:
    measures = view.summary
    factor, unit = view.energy_factor, view.energy_unit

    def percent(value: float | None) -> str:
        return "–" if value is None else number(100.0 * value, 3) + " %"

    def shift(value: float | None, what: str) -> str:
        return f"no {what} peak in range" if value is None else f"shift {shown_number(value, 'Hz')} Hz"

    states = " · ".join(f"{count} {name}" for count, name in zip(measures.state_counts, STATE_NAMES, strict=True))
    moving = sum(measures.state_counts[1:])
    tiles = (
        (
            "Peak amplitude, 0‑to‑peak",
            f"{number(1e6 * measures.peak.amplitude)} <small>µm</small>",
            f"at {shown_number(measures.peak.frequency_hz, 'Hz')} Hz",
        ),
        (
            "Reduction against linear stuck",
            percent(measures.reduction_from_stuck),
            shift(measures.shift_from_stuck_hz, "stuck"),
        ),
        (
            "Reduction against linear free",
            percent(measures.reduction_from_free),
            shift(measures.shift_from_free_hz, "free"),
        ),
        ("Pairs that move at the peak", f"{moving} <small>of {sum(measures.state_counts)}</small>", states),
        (
            "Friction energy per cycle",
            f"{number(factor * measures.friction_energy)} <small>{unit}</small>",
            f"{percent(measures.friction_share)} of the loss at the peak",
        ),
        ("Equivalent damping ratio", percent(measures.damping_ratio), "half-power width of the curve"),
    )
    return "\n".join(
        f'<div class="tile"><h3>{name}</h3><p class="value">{value}</p><p class="more">{more}</p></div>'
        for name, value, more in tiles
    )


def _measures(view: View) -> list[tuple[str, str, str]]:
    return [(name, value, "" if unit == "-" else unit) for name, value, unit in summary_table(view.summary)]


def _pair_options(view: View) -> str:
    return "".join(
        f'<option value="{pair}"{" selected" if pair == view.pair else ""}>{escape(view.pair_label(pair))}</option>'
        for pair in range(view.response.pairs.n_pairs)
    )


def _maps(study: StudyRecord, faces: Iterable[int], quantity: str, words: str) -> str:
    return "".join(
        f'<figure class="panel"><figcaption>{escape(study.face_names[face])}</figcaption>'
        f'<div id="{quantity}-map-{face}" class="plot" tabindex="0" role="application" '
        f'aria-label="{words}, {escape(study.face_names[face])}; arrow keys select a pair"></div></figure>'
        for face in faces
    )


def _rest(view: View) -> str:
    """The pressure at rest, where it is not uniform on each face."""
    if not view.rest_is_uneven:
        return ""
    names, closed = view.study.face_names, view.response.pairs.closed_at_rest
    counts = "; ".join(
        f"{escape(name)}: {int((~closed[view.study.pair_face == face]).sum())} of "
        f"{int((view.study.pair_face == face).sum())} pairs open"
        for face, name in enumerate(names)
    )
    figures = "".join(
        f'<figure class="panel"><figcaption>{escape(name)}</figcaption><div id="rest-map-{face}" class="plot" '
        f'role="img" aria-label="Pressure at rest, {escape(name)}"></div></figure>'
        for face, name in enumerate(names)
    )
    return (
        f'<section><h2>Pressure at rest</h2><p class="note">{counts}. Hollow pairs are open at rest; the linear stuck '
        f'curve leaves them open.</p><div class="maps">{figures}</div></section>'
    )


def _groups(study: StudyRecord) -> str:
    if not study.signal_groups:
        return ""
    figures = "".join(
        f'<figure class="panel"><figcaption>{escape(heading)}</figcaption>'
        f'<div id="group-{i}" class="plot" role="img" aria-label="{escape(heading)}"></div></figure>'
        for i, heading in enumerate(study.signal_groups)
    )
    return (
        '<section><h2>Motion over one period</h2><p class="note">At <b class="now"></b>; displacements are '
        "shown about their mean over the period.</p>"
        f'<div class="two">{figures}</div></section>'
    )


def _mode_table(study: StudyRecord) -> str:
    if not study.mode_table:
        return ""
    columns = [key for key in _MODE_HEADINGS if any(key in row for row in study.mode_table)]
    compared = "table2_hz" in columns and "full_hz" in columns
    headings = [_MODE_HEADINGS[key] for key in columns] + (["Full model against paper, %"] if compared else [])
    body = []
    for row in study.mode_table:
        cells = [(key == "description", _mode_cell(key, row.get(key))) for key in columns]
        if compared:
            cells.append((False, _deviation(row)))
        body.append("<tr>" + "".join(f"<td{word_class(text)}>{value}</td>" for text, value in cells) + "</tr>")
    head = "".join(f"<th{word_class(heading == 'Mode')}>{heading}</th>" for heading in headings)
    note = f'<p class="note">{_INFERRED}</p>' if compared else ""
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(body)}</tbody></table>"
    heading = f"Natural frequencies, contact {study.mode_contact}{' (geometry inferred)' if compared else ''}"
    return f"<section><h2>{heading}</h2>{note}{scrolled('Natural frequencies', table)}</section>"


def _mode_cell(key: str, value: str | float | int | None) -> str:
    if value is None:
        return "–"
    if isinstance(value, str):
        return escape(value)
    if key == "mode":
        return str(int(value))
    if key == "mac":
        return f"{value:.4f}"
    return f"{value:.2e}".replace("-", "−") if key == "difference_percent" else shown_number(float(value), "Hz")


def _deviation(row: dict[str, str | float | int]) -> str:
    if "table2_hz" not in row or "full_hz" not in row:
        return "–"
    return f"{100.0 * (float(row['full_hz']) / float(row['table2_hz']) - 1.0):+.2f}".replace("-", "−")


def _rough_face(study: StudyRecord) -> str:
    """The picture of a rough face, where the record has one."""
    patch = study.rough_patch
    if patch is None:
        return ""
    size = f"{number(1e3 * patch.length)} mm by {number(1e3 * patch.width)} mm"
    shown = number(MICRO * float(patch.about_mean.std()))
    return (
        f'<section><h2>Rough face</h2><p class="note">Heights about their mean on {size}, one of the faces that the '
        f"roughness and its seed describe: Sq {number(MICRO * patch.sq)} µm and Sdq {number(patch.sdq)} of all waves, "
        f"as the mean over many faces; Sq {shown} µm of the {patch.height.size} points shown, which are too far apart "
        'for the shortest waves and for a slope.</p><div class="panel"><div id="rough-map" class="plot" role="img" '
        'aria-label="Heights of a rough face"></div></div></section>'
    )


def _derived(study: StudyRecord) -> str:
    if not study.derived:
        return ""
    rows = "".join(
        f'<tr><th scope="row">{escape(name)}</th><td>{shown_number(value, unit)}</td>'
        f'<td class="word unit">{escape(unit)}</td><td class="word">{escape(explanation)}</td></tr>'
        for name, value, unit, explanation in study.derived
    )
    head = '<th class="word">Quantity</th><th>Value</th><th class="word">Unit</th><th class="word">Meaning</th>'
    table = f'<table class="plain"><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>'
    return f"<section><h2>Derived quantities</h2>{scrolled('Derived quantities', table)}</section>"
