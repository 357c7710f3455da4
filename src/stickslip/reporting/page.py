"""The report: one self-contained HTML page, with plotly.js and all data inside, without any network request."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.shown_numbers import energy, length, number, tile_number
from stickslip.reporting.look import plain_figures
from stickslip.reporting.page_data import page_data
from stickslip.reporting.page_sections import CURVE, SECTIONS
from stickslip.reporting.style import shown_number
from stickslip.reporting.templates import Notice, Tile, when, whole_page
from stickslip.reporting.verdict import verdict
from stickslip.reporting.view import View
from stickslip.results.measures import Summary
from stickslip.results.peaks import Peak
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.sweeps_of_curve import reaches


def write_page(
    path: str | PathLike[str], response: ForcedResponse, study: StudyRecord, changed_inputs: Sequence[str] = ()
) -> None:
    """Write the report of one run to ``path``, completely or not at all; ``changed_inputs`` come before all inputs.

    Raises InputError if the study does not belong to the response, or the place cannot be written.
    """
    target = Path(path)
    text = page(response, study, changed_inputs)
    with whole_file(target, "report", InputError) as part:
        part.write_text(text, encoding="utf-8")


def page(response: ForcedResponse, study: StudyRecord, changed_inputs: Sequence[str] = ()) -> str:
    """The report of one run as HTML. Raises InputError if the study does not belong to the response."""
    view = View.of(response, study, changed_inputs)
    ended = "converged" if response.converged else "NOT converged"
    sections = [CURVE, *(section for section in SECTIONS if section.applies(view))]
    contents = [section.on_page(view) for section in sections]
    figures = {name: figure for section in sections for name, figure in section.figures(view).items()}
    pictures = sum(content.characters for content in contents if content.data)  # words have a limit of their own
    numbers = page_data(view, pictures)
    notices = list(_notices(view))
    values = {
        "title": study.title,
        "description": study.description,
        "byline": " · ".join([when(response.provenance), f"{response.n_points} points", _resolution(view), ended]),
        "notices": notices,
        "verdict": verdict(view, sum(len(each.sentences) for each in notices if each.kind == "warn")),
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
        scripts=(
            "unpack.js",
            "peak_label.js",
            "page.js",
            *(script for section in sections for script in section.scripts),
        ),
        data={"page-data": numbers, "page-figures": plain_figures(figures)}
        | {name: value for content in contents for name, value in content.data.items()},
    )


def _resolution(view: View) -> str:
    """The harmonics, also of a part with more of them, and, with an accuracy, the estimated error of the peak."""
    response = view.response
    if response.estimated_error is None:
        if response.point_harmonics is not None:
            return f"{response.point_harmonics.min()} to {response.harmonics} harmonics"
        return "1 harmonic" if response.harmonics == 1 else f"{response.harmonics} harmonics"
    wanted, reached = (
        number(100.0 * float(value), 2)
        for value in (response.settings["accuracy"], response.estimated_error[view.summary.peak.point])
    )
    return f"accuracy {wanted} % (up to {response.harmonics} harmonics, estimated error of the peak {reached} %)"


def _notices(view: View) -> Iterator[Notice]:
    response = view.response
    if not response.converged:
        words = "These are partial results: the figures show the computed points."
        yield Notice("bad", "The solver did not converge", [response.message, words])
    warnings = [*view.study.warnings, *response.warnings]  # a wrong input comes before what follows from it
    if response.mistuning is not None:
        warnings += response.mistuning.warnings
    if not view.summary.peak.bracketed:
        warnings.append(
            "The largest amplitude is at an end of the computed range, so the true peak may be higher: widen the "
            "frequency range."
        )
    if warnings:
        yield Notice("warn", "Warnings" if len(warnings) > 1 else "Warning", warnings)


def _peak_tiles(measures: Summary) -> Iterator[Tile]:
    """The highest peak on the curve and, where they differ, the peaks of both slow sweeps."""

    def tile(heading: str, peak: Peak, more: str = "") -> Tile:
        at = " ".join(filter(None, [measures.caution(peak), f"at {shown_number(peak.frequency_hz, 'Hz')} Hz"]))
        return Tile(heading, *length(peak.amplitude), f"{at}{more}")

    beside = ""
    if measures.stiffness_peaks is not None:
        low, high = (length(value) for value in measures.stiffness_peaks)
        more = " or more" if measures.stiffness_at_end else ""
        ends = [low[0] if low[1] == high[1] else " ".join(low), " ".join(high)]
        beside = f"; {' to '.join(ends)}{more} with 1/3 to 3 of the stiffness, not measured"
    if not measures.sweeps_differ:
        yield tile("Peak amplitude, 0‑to‑peak", measures.peak, f", of a slow sweep up and down alike{beside}")
        return
    reached = [
        words
        for words, peak in (("down", measures.downward_peak), ("up", measures.upward_peak))
        if reaches(measures.peak, peak)
    ]
    only = f", only a slow sweep {reached[0]} reaches it" if reached else ", no slow sweep reaches it"
    yield tile("Highest peak on the curve, 0‑to‑peak", measures.peak, f"{only}{beside}")
    for direction, peak in (("up", measures.upward_peak), ("down", measures.downward_peak)):
        heading = f"Peak of a slow sweep {direction}, 0‑to‑peak"
        yield Tile(heading, "–", more="no stable point") if peak is None else tile(heading, peak)


def _tiles(view: View) -> tuple[Tile, ...]:
    measures = view.summary

    def percent(value: float | None) -> tuple[str, str]:
        return ("–", "") if value is None else (tile_number(100.0 * value, 3), "%")

    def in_words(value: float | None) -> str:
        return " ".join(percent(value)).strip()

    def shift(value: float | None, what: str) -> str:
        return f"no {what} peak in range" if value is None else f"shift {shown_number(value, 'Hz')} Hz"

    states = " · ".join(f"{measures.state_counts[state]} {name}" for state, name in measures.state_names.items())
    moving = sum(measures.state_counts[1:])
    return (
        *_peak_tiles(measures),
        Tile(
            "Reduction against linear stuck",
            *percent(measures.reduction_from_stuck),
            more=shift(measures.shift_from_stuck_hz, "stuck"),
        ),
        Tile(
            "Reduction against linear free",
            *percent(measures.reduction_from_free),
            more=shift(measures.shift_from_free_hz, "free"),
        ),
        Tile("Pairs that slip or separate at the peak", str(moving), f"of {sum(measures.state_counts)}", states),
        Tile(
            "Friction energy per cycle",
            *energy(measures.friction_energy),
            f"{in_words(measures.friction_share)} of the loss at the peak",
        ),
        Tile(
            "Equivalent damping ratio",
            *percent(measures.equivalent_damping),
            more=f"from energies; half-power width {in_words(measures.half_power_width)}",
        ),
    )
