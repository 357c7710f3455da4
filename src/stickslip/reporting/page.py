"""The report: one self-contained HTML page, with plotly.js and all data inside, without any network request."""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike
from pathlib import Path

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.reporting.look import plain_figures
from stickslip.reporting.page_data import page_data
from stickslip.reporting.page_sections import CURVE, SECTIONS
from stickslip.reporting.style import number, shown_number
from stickslip.reporting.templates import Notice, Tile, when, whole_page
from stickslip.reporting.view import View
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse


def write_page(path: str | PathLike[str], response: ForcedResponse, study: StudyRecord) -> None:
    """Write the report of one run to ``path``, completely or not at all.

    Raises InputError if the study does not belong to the response, or the place cannot be written.
    """
    target = Path(path)
    text = page(response, study)
    with whole_file(target, "report", InputError) as part:
        part.write_text(text, encoding="utf-8")


def page(response: ForcedResponse, study: StudyRecord) -> str:
    """The report of one run as HTML. Raises InputError if the study does not belong to the response."""
    view = View.of(response, study)
    harmonics, ended = f"{response.harmonics} harmonics", "converged" if response.converged else "NOT converged"
    sections = [CURVE, *(section for section in SECTIONS if section.applies(view))]
    contents = [section.on_page(view) for section in sections]
    figures = {name: figure for section in sections for name, figure in section.figures(view).items()}
    pictures = sum(content.characters for content in contents if content.data)  # words have a limit of their own
    numbers = page_data(view, pictures)
    values = {
        "title": study.title,
        "description": study.description,
        "byline": " · ".join([when(response.provenance), f"{response.n_points} points", harmonics, ended]),
        "notices": list(_notices(view)),
        "tiles": _tiles(view),
        "point": view.point,
        "last_point": response.n_points - 1,
        "pair": view.pair,
        "pair_labels": [view.pair_label(pair) for pair in range(response.pairs.n_pairs)],
        "curve": contents[0].html,
        "sections": [content.html for content in contents[1:]],
    }
    return whole_page(
        "page.html",
        "Forced response of a structure with joints",
        values,
        response.provenance,
        scripts=("unpack.js", "page.js", *(script for section in sections for script in section.scripts)),
        data={"page-data": numbers, "page-figures": plain_figures(figures)}
        | {name: value for content in contents for name, value in content.data.items()},
    )


def _notices(view: View) -> Iterator[Notice]:
    response = view.response
    if not response.converged:
        words = "These are partial results: the figures show the computed points."
        yield Notice("bad", "The solver did not converge", [response.message, words])
    warnings = [*response.warnings, *view.study.warnings]
    if not view.summary.peak.bracketed:
        warnings.append(
            "The largest amplitude is at an end of the computed range, so the true peak may be higher: widen the "
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

    states = " · ".join(f"{measures.state_counts[state]} {name}" for state, name in measures.state_names.items())
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
        Tile("Pairs that slip or separate at the peak", str(moving), f"of {sum(measures.state_counts)}", states),
        Tile(
            "Friction energy per cycle",
            number(factor * measures.friction_energy),
            unit,
            f"{percent(measures.friction_share)} of the loss at the peak",
        ),
        Tile("Equivalent damping ratio", percent(measures.damping_ratio), more="half-power width of the curve"),
    )
