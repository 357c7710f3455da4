"""The page that compares several results: curves over each other, differences, measures and differing inputs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from stickslip import __version__
from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.shown_numbers import MICRO, length, number
from stickslip.reporting import sweep_plots
from stickslip.reporting.campbell_figure import campbell_figure, crossing_rows
from stickslip.reporting.compare_verdict import compare_verdict
from stickslip.reporting.look import FREQUENCY, Figure, PlotMarkup, axis_look, figure_of, line_trace, plain_figures
from stickslip.reporting.style import NEGLIGIBLE_PERCENT, shown_measure, shown_number
from stickslip.reporting.sweep_view import COLOURS, DASHES, SweepView
from stickslip.reporting.templates import Notice, Tile, when, whole_page
from stickslip.results.campbell import campbell
from stickslip.results.comparison import Compared, ComparedMeasure, amplitude_at, compared_measures, differing_inputs
from stickslip.results.peaks import caution
from stickslip.results.sweep_table import SweepCurve, SweepRow, SweepTable, SweptKey

_GRID = 2000  # chosen: frequencies of the curve of differences; finer than the pixels of a figure
# Unit of a measure in SI -> factor and unit on the page.
_SHOWN = {"m": (MICRO, "µm"), "J": (1e6, "µJ"), "Pa": (1e-6, "MPa")}
_PERCENT = frozenset(
    {
        "equivalent_damping_ratio",
        "half_power_width_ratio",
        "reduction_from_stuck",
        "reduction_from_free",
        "friction_share",
    }
)
_LONGEST_TITLE = 80  # chosen: letters, two lines on a screen
# Words of measures whose meaning in the table of a sweep is too short, or follows from the column before.
_WORDS = {
    "peak_amplitude_m": "Highest peak on the curve",
    "upward_peak_frequency_hz": "Frequency of the peak of a slow sweep up",
    "downward_peak_frequency_hz": "Frequency of the peak of a slow sweep down",
    "peak_bracketed": "Highest peak is inside the computed range",
    "shift_from_stuck_hz": "Shift from the linear stuck peak",
    "shift_from_free_hz": "Shift from the linear free peak",
    "reduction_from_stuck": "Reduction against the linear stuck peak",
    "reduction_from_free": "Reduction against the linear free peak",
    "stuck_peak_amplitude_m": "Linear peak, contacts closed at rest stuck",
    "stuck_peak_frequency_hz": "Frequency of the linear stuck peak",
    "free_peak_amplitude_m": "Linear peak, no contact",
    "free_peak_frequency_hz": "Frequency of the linear free peak",
    "equivalent_damping_ratio": "Equivalent damping ratio, from energies",
    "half_power_width_ratio": "Half-power width, (f2 − f1) / (2 f)",
    "friction_share": "Fraction of friction in the energy loss",
    "pairs_stuck": "Pairs stuck",
    "pairs_stick_slip": "Pairs in stick-slip",
    "pairs_separating": "Pairs separating",
    "friction_energy_j": "Energy dissipated by friction per cycle",
    "normal_work_j": "Work of the normal forces per cycle (zero except for sampling)",
    "viscous_energy_j": "Energy dissipated by viscous damping per cycle",
    "input_energy_j": "Work of the excitation per cycle",
    "largest_friction_energy_hz": "Frequency of the largest friction energy",
    "energy_imbalance": "Largest energy imbalance on the curve, of the input",
}
# Measures that are differences, flags or errors: a quotient of them means nothing.
_NO_PERCENT = (
    "shift_from_stuck_hz", "shift_from_free_hz", "reduction_from_stuck", "reduction_from_free", "peak_bracketed",
    "energy_imbalance", "normal_work_j",
)  # fmt: skip


def write_compare_page(path: str | PathLike[str], compared: Sequence[Compared]) -> None:
    """Write the page completely or not at all. Raises InputError if it cannot be written."""
    target = Path(path)
    text = compare_page(compared)
    with whole_file(target, "page of the comparison", InputError) as part:
        part.write_text(text, encoding="utf-8")


def compare_page(compared: Sequence[Compared]) -> str:
    """The page as HTML; differences refer to the first result."""
    both = [each.curve_and_measures() for each in compared]
    curves, measures = [curve for curve, _ in both], [numbers for _, numbers in both]
    names = tuple(each.name for each in compared)
    view = _view(compared, curves, measures)
    rows = compared_measures(measures)
    inputs = differing_inputs([each.study for each in compared])
    provenance = {"date": datetime.now(UTC).isoformat(timespec="seconds"), "stickslip": __version__}
    values: dict[str, Any] = {
        "title": _title(names),
        "description": f"{len(names)} results of stickslip run. All differences refer to the first one, {names[0]}.",
        "byline": when(provenance),
        "answer": compare_verdict(compared, measures, inputs),
        "notices": list(_notices(compared)),
        "tiles": list(_tiles(compared, measures)),
        "names": names,
        "titles": [each.study.title for each in compared],
        "responses": [each.study.response_output for each in compared],
        "measures": [_measure_cells(row) for row in rows],
        "inputs": [(key, ["–" if value is None else value for value in row]) for key, row in inputs.items()],
        "warnings": [(each.name, [*each.study.warnings, *each.response.warnings]) for each in compared],
        "software": [(each.name, _software(each.response.provenance)) for each in compared],
    }
    diagram = campbell(compared)
    values |= {
        "has_campbell": diagram is not None,
        "asked_orders": () if diagram is None else diagram.asked,
        "crossings": [] if diagram is None else crossing_rows(diagram),
    }
    figures = {
        "curves": sweep_plots.all_curves(view, sweep_plots.thinned_curves(view)),
        "differences": _differences(names, curves),
    } | ({} if diagram is None else {"campbell": campbell_figure(diagram)})
    return whole_page(
        "compare.html",
        "Comparison of forced responses",
        values,
        provenance,
        scripts=("sweep.js",),
        data={"page-figures": plain_figures(figures)},
    )


def _title(names: Sequence[str]) -> str:
    """The names of the results where they are short; cases of a sweep have long ones, which stand in the tiles."""
    words = "Comparison of " + ", ".join(names)
    return words if len(words) <= _LONGEST_TITLE else f"Comparison of {names[0]} and {len(names) - 1} more"


def _view(
    compared: Sequence[Compared], curves: Sequence[SweepCurve], measures: Sequence[Mapping[str, float]]
) -> SweepView:
    """The results as cases of a sweep whose only key is their name."""
    names = tuple(each.name for each in compared)
    rows = tuple(
        SweepRow(each.name, (each.name,), each.response.converged, each.response.message, numbers)
        for each, numbers in zip(compared, measures, strict=True)
    )
    table = SweepTable((SweptKey("compare.result", "", names, (), "", names),), rows)
    return SweepView(table, tuple(curves), np.ones(len(rows)))


def _differences(names: Sequence[str], curves: Sequence[SweepCurve]) -> Figure:
    """Amplitude over that of the first result, less one, in percent; the upper branch where a curve folds."""
    low, high = (float(getattr(curves[0].frequency_hz, end)()) for end in ("min", "max"))
    # The points of the first curve are among the frequencies, so that its peak is exact.
    frequency = np.union1d(np.linspace(low, high, _GRID), curves[0].frequency_hz)
    reference = amplitude_at(curves[0], frequency)
    traces = []
    for place, (name, curve) in enumerate(zip(names[1:], curves[1:], strict=True), start=1):
        difference = 100.0 * (amplitude_at(curve, frequency) / reference - 1.0)
        present = ~np.isnan(difference)
        look = {"colour": COLOURS[place % len(COLOURS)], "dash": DASHES[place // len(COLOURS) % len(DASHES)]}
        hover = PlotMarkup("{}<br>%{{x:.2f}} Hz<br>%{{y:.3g}} %<extra></extra>").format(name)
        traces.append(line_trace(name, frequency[present], difference[present], **look, width=1.6, hovertemplate=hover))
    return figure_of(
        traces,
        360,
        xaxis=axis_look(FREQUENCY, range=[low, high]),
        yaxis=axis_look("Difference, %", zeroline=True, zerolinecolor="#9aa5b1"),
        showlegend=True,
        hovermode="closest",
    )


def _measure_cells(row: ComparedMeasure) -> tuple[str, list[str]]:
    """The measure in words with its unit, and for each result the value and, after the first, its difference."""
    factor, unit = (100.0, "%") if row.name in _PERCENT else _SHOWN.get(row.unit, (1.0, row.unit))
    counts = row.name.startswith("pairs_")
    cells: list[str] = []
    for value, difference in zip(row.values, row.differences, strict=True):
        text = "–" if value is None else _shown(row.name, factor * value, unit, counts)
        if difference is not None and cells and not counts and row.name not in _NO_PERCENT:
            text += f" ({_signed(100.0 * difference)})".replace(" %", "\N{NO-BREAK SPACE}%")
        cells.append(text)
    meaning = _WORDS.get(row.name, row.meaning[0].upper() + row.meaning[1:])
    return (meaning if unit in ("1", "") else f"{meaning}, {unit}"), cells


def _shown(name: str, value: float, unit: str, counts: bool) -> str:
    if name == "peak_bracketed":
        return "yes" if value else "no"
    return str(int(value)) if counts else shown_measure(float(value), unit)


def _signed(percent: float) -> str:
    """A difference in percent with its sign, to three digits."""
    if abs(percent) < NEGLIGIBLE_PERCENT:
        return "0 %"
    return ("+" if percent >= 0.0 else "") + number(float(f"{percent:.3g}"), 3) + " %"


def _tiles(compared: Sequence[Compared], measures: Sequence[Mapping[str, float]]) -> Iterator[Tile]:
    first = measures[0]["peak_amplitude_m"]
    for place, (each, numbers) in enumerate(zip(compared, measures, strict=True)):
        name, converged = each.name, each.response.converged
        peak = numbers["peak_amplitude_m"]
        more = f"at {shown_number(numbers['peak_frequency_hz'], 'Hz')} Hz"
        if note := caution(numbers["peak_bracketed"] == 1.0, converged):
            more += f" ({note})"
        if place:
            more += f"; {_signed(100.0 * (peak / first - 1.0))}"
        yield Tile(f"Highest peak, {name}", *length(peak), more)


def _notices(compared: Sequence[Compared]) -> Iterator[Notice]:
    incomplete = [f"{each.name}: {each.response.message}" for each in compared if not each.response.converged]
    if incomplete:
        yield Notice("bad", "Not every curve is complete", incomplete)
    cautions = []
    outputs = {each.name: each.study.response_output for each in compared}
    if len(set(outputs.values())) > 1:
        words = "; ".join(f"{name}: {output}" for name, output in outputs.items())
        cautions.append(
            f"The responses have different names, so the amplitudes may be those of different positions: {words}."
        )
    ends = [each.name for each in compared if each.curve_and_measures()[1].get("peak_bracketed") == 0.0]
    if ends:
        cautions.append(
            "The largest amplitude is at an end of the computed range, so the true peak may be higher: "
            f"{', '.join(ends)}."
        )
    static = {each.name: each.study.stress.static for each in compared if each.study.stress is not None}
    if len(set(static.values())) > 1:
        words = "; ".join(f"{name}: {state}" for name, state in static.items())
        cautions.append(f"The stresses contain different states at rest; alternating stresses are comparable: {words}.")
    versions = {each.response.provenance.get("stickslip", "unknown") for each in compared}
    if len(versions) > 1:
        cautions.append(f"The results are of different versions of stickslip: {', '.join(sorted(versions))}.")
    if cautions:
        yield Notice("warn", "Before you compare", cautions)


def _software(provenance: Mapping[str, str]) -> str:
    """Version and date; the pages of the results have the rest."""
    return f"stickslip {provenance.get('stickslip', 'unknown')}, {when(provenance)}"
