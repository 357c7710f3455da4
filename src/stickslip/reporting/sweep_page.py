"""The page of a sweep: one self-contained HTML file with its curves, peaks, damper performance, maps and table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from os import PathLike
from pathlib import Path

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.reporting import sweep_plots as plots
from stickslip.reporting.html_parts import notice, scrolled, when, whole_page
from stickslip.reporting.linear_limits import differing_limits
from stickslip.reporting.look import Figure
from stickslip.reporting.style import MICRO, number, shown_number
from stickslip.reporting.sweep_view import LOAD_KEY, SweepView, short_name
from stickslip.results.sweep_table import SweepRow

# column of the table -> heading, factor, unit
_COLUMNS = {
    "peak_amplitude_m": ("Peak, µm", MICRO, "µm"),
    "peak_frequency_hz": ("Peak frequency, Hz", 1.0, "Hz"),
    "shift_from_stuck_hz": ("Shift from stuck, Hz", 1.0, "Hz"),
    "shift_from_free_hz": ("Shift from free, Hz", 1.0, "Hz"),
    "pairs_stuck": ("Stuck", 1.0, ""),
    "pairs_stick_slip": ("Stick-slip", 1.0, ""),
    "pairs_separating": ("Separating", 1.0, ""),
    "friction_energy_j": ("Friction energy, µJ", 1e6, "µJ"),
    "viscous_energy_j": ("Viscous energy, µJ", 1e6, "µJ"),
}


def write_sweep_page(
    path: str | PathLike[str], view: SweepView, title: str, inputs: str, provenance: Mapping[str, str]
) -> None:
    """Write the page of a sweep to ``path``, whole or not at all. Raises InputError if the place cannot be written.

    ``inputs`` is the text of the study file that the cases were made from.
    """
    target = Path(path)
    text = sweep_page(view, title, inputs, provenance)
    with whole_file(target, "page of the sweep", InputError) as part:
        part.write_text(text, encoding="utf-8")


def sweep_page(view: SweepView, title: str, inputs: str, provenance: Mapping[str, str]) -> str:
    """The page of a sweep as HTML."""
    figures: dict[str, Figure] = {}
    parts = {
        "title": escape(title),
        "description": escape("; ".join(f"{key.name}: {_values(key.labels)}" for key in view.table.keys) + "."),
        "byline": escape(f"{when(provenance)} · {len(view.table.rows)} cases · {len(view.table.failed)} failed"),
        "notices": _failures(view) + _limits(view),
        "tiles": _tiles(view),
        "curves": _curves(view, figures),
        "keys": _keys(view, figures),
        "performance": _performance(view, figures),
        "maps": _maps(view, figures),
        "table": _table(view),
        "inputs": escape(inputs),
    }
    return whole_page(
        "sweep.html",
        "Sweep of forced responses with rough frictional contact",
        parts,
        provenance,
        head_title=f"{escape(title)}: sweep",
        script="sweep.js",
        data={"page-figures": figures},
    )


def _values(labels: tuple[str, ...]) -> str:
    """All values, or the first and the last of many."""
    return ", ".join(labels) if len(labels) <= 8 else f"{labels[0]} to {labels[-1]} ({len(labels)} values)"


def _failures(view: SweepView) -> str:
    rows = [(place, row) for place, row in enumerate(view.table.rows) if not row.converged]
    if not rows:
        return ""
    heading = "1 case failed" if len(rows) == 1 else f"{len(rows)} cases failed"
    return notice("bad", heading, [f"{view.label(place)}: {row.message}" for place, row in rows])


def _limits(view: SweepView) -> str:
    sentences = differing_limits(view)
    return notice("warn", "The linear limits differ between the cases", sentences) if sentences else ""


def _tiles(view: SweepView) -> str:
    peak, inside = view.number("peak_amplitude_m"), view.inside()
    tiles = [("Cases", str(len(view.table.rows)), f"{len(view.table.failed)} failed")]
    if inside.any():
        rows = [place for place in range(len(peak)) if inside[place]]
        for words, place in (
            ("Lowest peak", min(rows, key=lambda r: peak[r])),
            ("Highest peak", max(rows, key=lambda r: peak[r])),
        ):
            tiles.append((words, f"{number(MICRO * float(peak[place]))} <small>µm</small>", escape(view.label(place))))
    open_ends = int((view.usable() & ~inside).sum())
    if open_ends:
        tiles.append(("Peak at an end", str(open_ends), "cases whose largest amplitude lies at an end of the range"))
    return "\n".join(
        f'<div class="tile"><h3>{name}</h3><p class="value">{value}</p><p class="more">{more}</p></div>'
        for name, value, more in tiles
    )


def _plot(name: str, words: str) -> str:
    return f'<div class="panel"><div id="{name}" class="plot" role="img" aria-label="{escape(words)}"></div></div>'


def _figure(name: str, caption: str, words: str) -> str:
    """A plot with a caption; ``words`` say in plain text what it shows."""
    drawn = f'<div id="{name}" class="plot" role="img" aria-label="{escape(words)}"></div>'
    return f'<figure class="panel"><figcaption>{caption}</figcaption>{drawn}</figure>'


def _curves(view: SweepView, figures: dict[str, Figure]) -> str:
    if not any(view.curves):
        return '<p class="note">No case has a curve.</p>'
    points = plots.thinned_curves(view)
    figures["curves"] = plots.all_curves(view, points)
    keys = view.table.keys
    words = f"Colour tells {escape(keys[0].name)}" + (f", dash {escape(keys[1].name)}" if len(keys) > 1 else "")
    if points.tolerance:
        drawn = sum(kept.size for kept in points.kept)
        total = sum(curve.frequency_hz.size for curve in view.curves if curve is not None)
        words += (
            f". {drawn} of {total} points are drawn: those that the shapes need; none that is left out lies more than "
            f"{number(100 * points.tolerance, 2)} % of the figure from its line"
        )
    return f'<p class="note">{words}.</p>' + _plot("curves", "Amplitude against frequency of all cases")


def _keys(view: SweepView, figures: dict[str, Figure]) -> str:
    panels = []
    for place, key in enumerate(view.table.keys):
        name = f"key-{place}"
        figures[name] = plots.against_key(view, place)
        panels.append(_figure(name, f"Against {escape(key.name)}", f"Peak and its frequency against {key.name}"))
    return f'<div class="two">{"".join(panels)}</div>' if len(panels) > 1 else "".join(panels)


def _performance(view: SweepView, figures: dict[str, Figure]) -> str:
    if view.place_of(LOAD_KEY) is None:
        return ""
    figures["performance-load"] = plots.performance(view, by_ratio=False)
    figures["performance-ratio"] = plots.performance(view, by_ratio=True)
    return (
        "<section><h2>Damper performance</h2>"
        f'<p class="note">{_optimum_words(view)} The linear limits are drawn where their peaks lie inside the computed '
        "range: every pair that is closed at rest stuck (its stiffness follows the load), and no contact.</p>"
        '<div class="two">'
        + _figure("performance-load", "Against the load F<sub>N</sub>", "Peak against the load")
        + _figure("performance-ratio", "Against force / F<sub>N</sub>", "Peak against force / load")
        + "</div></section>"
    )


def _optimum_words(view: SweepView) -> str:
    found = plots.optima(view)
    if not found:
        return "No peak lies inside its computed range, so there is no optimum."
    place = view.place_of(LOAD_KEY) or 0
    peak, sentences = view.number("peak_amplitude_m"), []
    for optimum in found[: plots.LEGEND_ENTRIES]:
        load = view.table.keys[place].labels[view.positions[optimum.row, place]]
        group = f"{optimum.label}: " if optimum.label else ""
        end = (
            ", at an end of the loads whose peak is known, so the true optimum may lie beyond" if optimum.at_end else ""
        )
        words = f"{group}lowest computed peak {number(MICRO * float(peak[optimum.row]))} µm at F_N = {load}{end}."
        sentences.append(escape(words[0].upper() + words[1:]))
    if len(found) > len(sentences):
        sentences.append(f"{len(found) - len(sentences)} further lines have their own optimum, marked by a star.")
    return " ".join(sentences)


def _maps(view: SweepView, figures: dict[str, Figure]) -> str:
    if len(view.table.keys) < 2:
        return ""
    panels = []
    for count, (heading, figure) in enumerate(plots.maps(view)):
        figures[f"map-{count}"] = figure
        panels.append(_figure(f"map-{count}", escape(heading), f"Map: {heading}"))
    first, second = (key.name for key in view.table.keys[:2])
    total = math.prod(len(key.values) for key in view.table.keys[2:])
    rest = ""
    if total > plots.LARGEST_MAP_COUNT:
        rest = f" The first {plots.LARGEST_MAP_COUNT} of {total} combinations of the other keys are shown."
    note = (
        f'<p class="note">{escape(first)} and {escape(second)}. An empty cell is a case that failed; "at an end" marks '
        f"the largest amplitude of a curve whose peak lies outside the computed range.{rest}</p>"
    )
    return f'<section><h2>Maps of two keys</h2>{note}<div class="two">{"".join(panels)}</div></section>'


def _table(view: SweepView) -> str:
    head = "".join(f"<th>{escape(short_name(key))}</th>" for key in view.table.keys)
    head += "".join(f"<th>{heading}</th>" for heading, _, _ in _COLUMNS.values()) + '<th class="word">Remarks</th>'
    body = "".join(_table_row(view, place, row) for place, row in enumerate(view.table.rows))
    return scrolled("All cases", f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>")


def _table_row(view: SweepView, place: int, row: SweepRow) -> str:
    positions = view.positions[place]
    cells = [escape(key.labels[positions[i]]) for i, key in enumerate(view.table.keys)]
    for name, (_, factor, unit) in _COLUMNS.items():
        value = row.measures.get(name, math.nan)
        cells.append("–" if math.isnan(value) else shown_number(factor * value, unit))
    remarks = "" if row.converged else escape(f"Failed: {row.message} ")
    if row.converged and row.measures.get("peak_bracketed") == 0.0:
        remarks = "The largest amplitude lies at an end of the range. "
    if row.warnings:
        listed = "".join(f"<li>{escape(sentence)}</li>" for sentence in row.warnings)
        count = "1 warning" if len(row.warnings) == 1 else f"{len(row.warnings)} warnings"
        remarks += f"<details><summary>{count}</summary><ul>{listed}</ul></details>"
    plain_cells = "".join(f"<td>{cell}</td>" for cell in cells)
    return f'<tr>{plain_cells}<td class="word">{remarks}</td></tr>'
