"""The page of a sweep: one self-contained HTML file with its curves, peaks, damper performance, maps and table."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path, PurePosixPath

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.shown_numbers import MICRO, length, number
from stickslip.reporting import sweep_plots as plots
from stickslip.reporting.best_of_worst import best_of_worst
from stickslip.reporting.linear_limits import differing_limits
from stickslip.reporting.look import Figure, plain_figures
from stickslip.reporting.style import shown_measure
from stickslip.reporting.sweep_performance import optima, performance
from stickslip.reporting.sweep_styles import LEGEND_ENTRIES, styles_of
from stickslip.reporting.sweep_view import LOAD_KEY, SweepView, peak_remark, short_name, value_words
from stickslip.reporting.templates import Notice, StudyText, Tile, when, whole_page
from stickslip.reporting.thinning import Thinned
from stickslip.results.sweep_table import SweepRow, SweptKey
from stickslip.results.sweeps_of_curve import SAME_PEAK

REPORT_FILE = "report.html"  # page of a case, beside its results
# column of the table -> heading, factor, unit
_COLUMNS = {
    "peak_amplitude_m": ("Highest peak, µm", MICRO, "µm"),
    "peak_frequency_hz": ("Peak frequency, Hz", 1.0, "Hz"),
    "upward_peak_amplitude_m": ("Peak, slow sweep up, µm", MICRO, "µm"),
    "downward_peak_amplitude_m": ("Peak, slow sweep down, µm", MICRO, "µm"),
    "shift_from_stuck_hz": ("Shift from stuck, Hz", 1.0, "Hz"),
    "shift_from_free_hz": ("Shift from free, Hz", 1.0, "Hz"),
    "reduction_from_stuck": ("Reduction from stuck, %", 100.0, "%"),
    "equivalent_damping_ratio": ("Equivalent damping, %", 100.0, "%"),
    "pairs_stuck": ("Stuck", 1.0, ""),
    "pairs_stick_slip": ("Stick-slip", 1.0, ""),
    "pairs_separating": ("Separating", 1.0, ""),
    "friction_energy_j": ("Friction energy, µJ", 1e6, "µJ"),
    "viscous_energy_j": ("Viscous energy, µJ", 1e6, "µJ"),
}
_SLOW_SWEEPS = ("upward_peak_amplitude_m", "downward_peak_amplitude_m")


def write_sweep_page(
    path: str | PathLike[str], view: SweepView, title: str, inputs: StudyText, provenance: Mapping[str, str]
) -> None:
    """Write the page of a sweep to ``path``, completely or not at all. Raises InputError if it cannot be written.

    ``inputs`` is the study file of the base case.
    """
    target = Path(path)
    text = sweep_page(view, title, inputs, provenance, target.parent)
    with whole_file(target, "page of the sweep", InputError) as part:
        part.write_text(text, encoding="utf-8")


def sweep_page(
    view: SweepView, title: str, inputs: StudyText, provenance: Mapping[str, str], folder: Path | None = None
) -> str:
    """The page of a sweep as HTML, with a link to each page of a case that exists in the ``folder`` of the sweep."""
    pages = [_page_of_case(row, folder) for row in view.table.rows]
    points = plots.thinned_curves(view) if any(view.curves) else None
    maps = plots.maps(view) if len(view.table.keys) > 1 else []
    columns = _shown_columns(view)
    values = {
        "title": title,
        "description": "; ".join(f"{key.name}: {_values(key)}" for key in view.table.keys) + ".",
        "byline": f"{when(provenance)} · {len(view.table.rows)} cases · {len(view.table.failed)} failed",
        "notices": [*_failures(view), *_limits(view)],
        "tiles": list(_tiles(view)),
        "curves_note": _curves_note(view, points) if points else "",
        "key_names": [key.name for key in view.table.keys],
        "answer": [each for each in [best_of_worst(view)] if each],
        "optimum": _optimum_words(view) if view.place_of(LOAD_KEY) is not None else "",
        "map_headings": [heading for heading, _ in maps],
        "maps_left_out": _omitted_maps(view),
        "headings": [*map(short_name, view.table.keys), *(_COLUMNS[name][0] for name in columns)],
        "rows": [_table_row(view, place, columns, page) for place, page in enumerate(pages)],
        "has_pages": all(page for page, row in zip(pages, view.table.rows, strict=True) if row.file),
        "inputs": inputs,
    }
    figures = _figures(view, points) | {f"map-{count}": figure for count, (_, figure) in enumerate(maps)}
    return whole_page(
        "sweep.html",
        "Sweep of forced responses of structures with joints",
        values,
        provenance,
        head_title=f"{title}: sweep",
        scripts=("sweep.js",),
        data={"page-figures": plain_figures(figures)},
    )


def _figures(view: SweepView, points: Thinned | None) -> dict[str, Figure]:
    """All figures except the maps; ``points`` are those in the figure of all curves, None without a curve."""
    figures = {"curves": plots.all_curves(view, points)} if points else {}
    figures |= {f"key-{place}": plots.against_key(view, place) for place in range(len(view.table.keys))}
    if view.place_of(LOAD_KEY) is not None:
        figures["performance-load"] = performance(view, by_ratio=False)
        figures["performance-ratio"] = performance(view, by_ratio=True)
    return figures


def _values(key: SweptKey) -> str:
    """All values, or the first and the last of many."""
    labels = [value_words(key, place) for place in range(len(key.values))]
    return ", ".join(labels) if len(labels) <= 8 else f"{labels[0]} to {labels[-1]} ({len(labels)} values)"


def _failures(view: SweepView) -> Iterator[Notice]:
    rows = [(place, row) for place, row in enumerate(view.table.rows) if not row.converged]
    if rows:
        heading = "1 case failed" if len(rows) == 1 else f"{len(rows)} cases failed"
        yield Notice("bad", heading, [f"{view.label(place)}: {row.message}" for place, row in rows])


def _limits(view: SweepView) -> Iterator[Notice]:
    sentences = differing_limits(view)
    if sentences:
        yield Notice("warn", "The linear limits differ between the cases", sentences)


def _tiles(view: SweepView) -> Iterator[Tile]:
    peak, inside = view.number("peak_amplitude_m"), view.inside()
    yield Tile("Cases", str(len(view.table.rows)), more=f"{len(view.table.failed)} failed")
    if inside.any():
        rows = [place for place in range(len(peak)) if inside[place]]
        for words, place in (
            ("Lowest peak", min(rows, key=lambda r: peak[r])),
            ("Highest peak", max(rows, key=lambda r: peak[r])),
        ):
            yield Tile(words, *length(float(peak[place])), view.label(place))
    open_ends = int((view.usable() & ~inside).sum())
    if open_ends:
        words = "cases whose largest amplitude is at an end of the range"
        yield Tile("Peak at an end", str(open_ends), more=words)


def _curves_note(view: SweepView, points: Thinned) -> str:
    """Description of the figure of all curves."""
    words = f"{styles_of(view.table.keys).words()}, in all figures of this page"
    if points.tolerance:
        drawn = sum(each.size for each in points.indices)
        total = sum(curve.frequency_hz.size for curve in view.curves if curve is not None)
        words += (
            f". {drawn} of {total} points are plotted, as the shapes require; no omitted point is more than "
            f"{number(100 * points.tolerance, 2)} % of the figure from its line"
        )
    partly = sum(curve is not None and not curve.stable.all() for curve in view.curves)
    if partly:
        words += (
            f". {partly} of the curves {'is' if partly == 1 else 'are'} unstable in part: these parts are thin and "
            "finely dashed. Peaks below are the highest on each curve; triangles are those of a slow sweep up (▲) or "
            "down (▼) where they are lower"
        )
    return f"{words}."


def _optimum_words(view: SweepView) -> str:
    best = optima(view)
    if not best:
        return "No peak is inside its computed range, so there is no optimum."
    place = view.place_of(LOAD_KEY) or 0
    peak, sentences = view.number("peak_amplitude_m"), []
    for optimum in best[:LEGEND_ENTRIES]:
        load = value_words(view.table.keys[place], view.positions[optimum.row, place])
        group = f"{optimum.label}: " if optimum.label else ""
        end = ", at an end of the loads with a peak, so the true optimum may be beyond" if optimum.at_end else ""
        words = f"{group}lowest computed peak {number(MICRO * float(peak[optimum.row]))} µm at F_N = {load}{end}."
        sentences.append(words[0].upper() + words[1:])
    if len(best) > len(sentences):
        sentences.append(f"{len(best) - len(sentences)} further lines have their own optimum, marked by a star.")
    return " ".join(sentences)


def _omitted_maps(view: SweepView) -> str:
    """A message if there are more maps than on the page."""
    total = math.prod(len(key.values) for key in view.table.keys[2:])
    if total <= plots.LARGEST_MAP_COUNT:
        return ""
    return f" The first {plots.LARGEST_MAP_COUNT} of {total} combinations of the other keys are on this page."


@dataclass(frozen=True)
class _Row:
    """A row of the table of all cases in words."""

    cells: list[str]
    remark: str
    warnings: tuple[str, ...]
    page: str = ""


def _page_of_case(row: SweepRow, folder: Path | None) -> str:
    """The page of a case relative to the folder of the sweep; "" if there is none."""
    if folder is None or not row.file.startswith("cases/"):
        return ""
    page = PurePosixPath(row.file).with_name(REPORT_FILE)
    return str(page) if (folder / page).exists() else ""


def _shown_columns(view: SweepView) -> tuple[str, ...]:
    """Columns with a value; those of slow sweeps only if one of them does not reach the highest peak."""
    peak = view.number("peak_amplitude_m")
    shown = []
    for name in _COLUMNS:
        numbers = view.number(name)
        repeats = name in _SLOW_SWEEPS and not (np.abs(numbers - peak) > SAME_PEAK * peak).any()
        if not np.isnan(numbers).all() and not repeats:
            shown.append(name)
    return tuple(shown)


def _table_row(view: SweepView, place: int, columns: tuple[str, ...], page: str) -> _Row:
    row, positions = view.table.rows[place], view.positions[place]
    cells = [value_words(key, positions[i]) for i, key in enumerate(view.table.keys)]
    for name in columns:
        _, factor, unit = _COLUMNS[name]
        value = row.measures.get(name, math.nan)
        cells.append("–" if math.isnan(value) else shown_measure(factor * value, unit))
    return _Row(cells, peak_remark(row), row.warnings, page)
