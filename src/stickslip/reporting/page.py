"""The report: one self-contained HTML page, with plotly.js and all data inside, that asks nothing of the network."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.reporting import plots
from stickslip.reporting.look import Figure, plain_figures
from stickslip.reporting.page_data import page_data
from stickslip.reporting.structure_section import structure_section
from stickslip.reporting.style import MICRO, number, shown_number
from stickslip.reporting.templates import Notice, Tile, when, whole_page
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
    structure = structure_section(study)
    harmonics, ended = f"{response.harmonics} harmonics", "converged" if response.converged else "NOT converged"
    values = {
        "title": study.title,
        "description": study.description,
        "byline": " · ".join([when(response.provenance), f"{response.n_points} points", harmonics, ended]),
        "notices": list(_notices(view)),
        "tiles": _tiles(view),
        "output": study.response_output,
        "point": view.point,
        "last_point": response.n_points - 1,
        "pair": view.pair,
        "pair_labels": [view.pair_label(pair) for pair in range(response.pairs.n_pairs)],
        "structure": "" if structure is None else structure.html,
        "face_names": study.face_names,
        "open_at_rest": _open_at_rest(view),
        "imbalance": number(view.summary.energy_imbalance, 2),
        "groups": list(study.signal_groups),
        "modes": _mode_table(study),
        "measures": _measures(view),
        "rough_face": _rough_face(study),
        "derived": [
            (name, shown_number(value, unit), unit, explanation) for name, value, unit, explanation in study.derived
        ],
        "inputs": study.inputs,
        "settings": [(key, number(value)) for key, value in response.settings.items()],
    }
    numbers = page_data(view, 0 if structure is None else structure.characters)
    data = {"page-data": numbers, "page-figures": plain_figures(_figures(view))}
    scripts = ["unpack.js", "page.js"]
    if structure is not None:
        data["structure-data"] = structure.data
        scripts.append("structure.js")
    return whole_page(
        "page.html",
        "Forced response with rough frictional contact",
        values,
        response.provenance,
        scripts=scripts,
        data=data,
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


def _notices(view: View) -> Iterator[Notice]:
    response = view.response
    if not response.converged:
        words = "These are partial results: the figures show the points that were computed."
        yield Notice("bad", "The solve did not converge", [response.message, words])
    warnings = [*response.warnings, *view.study.warnings]
    if not view.summary.peak.bracketed:
        warnings.append(
            "The largest amplitude lies at an end of the computed range, so the true peak may be higher: widen the "
            "frequency range."
        )
    if warnings:
        yield Notice("warn", "Warnings" if len(warnings) > 1 else "Warning", warnings)


def _tiles(view: View) -> tuple[Tile, ...]:
    measures = view.summary
    factor, unit = view.energy_factor, view.energy_unit

    def percent(value: float | None) -> str:
        return "–" if value is None else number(100.0 * value, 3) + " %"

    def shift(value: float | None, what: str) -> str:
        return f"no {what} peak in range" if value is None else f"shift {shown_number(value, 'Hz')} Hz"

    states = " · ".join(f"{count} {name}" for count, name in zip(measures.state_counts, STATE_NAMES, strict=True))
    moving = sum(measures.state_counts[1:])
    return (
        Tile(
            "Peak amplitude, 0‑to‑peak",
            number(1e6 * measures.peak.amplitude),
            "µm",
            f"at {shown_number(measures.peak.frequency_hz, 'Hz')} Hz",
        ),
        Tile(
            "Reduction against linear stuck",
            percent(measures.reduction_from_stuck),
            more=shift(measures.shift_from_stuck_hz, "stuck"),
        ),
        Tile(
            "Reduction against linear free",
            percent(measures.reduction_from_free),
            more=shift(measures.shift_from_free_hz, "free"),
        ),
        Tile("Pairs that move at the peak", str(moving), f"of {sum(measures.state_counts)}", states),
        Tile(
            "Friction energy per cycle",
            number(factor * measures.friction_energy),
            unit,
            f"{percent(measures.friction_share)} of the loss at the peak",
        ),
        Tile("Equivalent damping ratio", percent(measures.damping_ratio), more="half-power width of the curve"),
    )


def _measures(view: View) -> list[tuple[str, str]]:
    """Names and values with their units."""
    return [
        (name, "–" if value == "-" else f"{value} {'' if unit == '-' else unit}".replace("-", "−"))
        for name, value, unit in summary_table(view.summary)
    ]


def _open_at_rest(view: View) -> list[tuple[str, int, int]]:
    """Name, open pairs and pairs of each face; empty where the pressure at rest is uniform on each face."""
    if not view.rest_is_uneven:
        return []
    closed, face = view.response.pairs.closed_at_rest, view.study.pair_face
    return [
        (name, int((~closed[face == place]).sum()), int((face == place).sum()))
        for place, name in enumerate(view.study.face_names)
    ]


@dataclass(frozen=True)
class _ModeTable:
    """The mode table in words: headings and cells, each with whether it is a word; ``compared`` with the paper."""

    contact: str
    compared: bool
    headings: list[tuple[str, bool]]
    rows: list[list[tuple[str, bool]]]


def _mode_table(study: StudyRecord) -> _ModeTable:
    columns = [key for key in _MODE_HEADINGS if any(key in row for row in study.mode_table)]
    compared = "table2_hz" in columns and "full_hz" in columns
    headings = [(_MODE_HEADINGS[key], key == "description") for key in columns]
    rows = [[(_mode_cell(key, row.get(key)), key == "description") for key in columns] for row in study.mode_table]
    if compared:
        headings.append(("Full model against paper, %", False))
        for cells, row in zip(rows, study.mode_table, strict=True):
            cells.append((_deviation(row), False))
    return _ModeTable(study.mode_contact, compared, headings, rows)


def _mode_cell(key: str, value: str | float | int | None) -> str:
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
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
    """What the picture of a rough face shows, where the record has one."""
    patch = study.rough_patch
    if patch is None:
        return ""
    size = f"{number(1e3 * patch.length)} mm by {number(1e3 * patch.width)} mm"
    shown = number(MICRO * float(patch.about_mean.std()))
    return (
        f"Heights about their mean on {size}, one of the faces that the roughness and its seed describe: "
        f"Sq {number(MICRO * patch.sq)} µm and Sdq {number(patch.sdq)} of all waves, as the mean over many faces; "
        f"Sq {shown} µm of the {patch.height.size} points shown, which are too far apart for the shortest waves and "
        "for a slope."
    )
