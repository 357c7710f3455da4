"""The page of the study: one self-contained HTML file, each item beside the paper's statement, with its verdict."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from html import escape
from math import isnan
from pathlib import Path

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.papers.rough_damper.compute import Failure
from stickslip.papers.rough_damper.items import Item, Picture
from stickslip.papers.rough_damper.tables import Cell, Table
from stickslip.papers.rough_damper.verdicts import Judgement, Verdict
from stickslip.reporting.html_parts import notice, scrolled, when, whole_page, word_class
from stickslip.reporting.style import shown_number

TITLE = "Interface roughness and an under-platform damper"
DESCRIPTION = (
    "Every table, figure and conclusion of the 2023 article on interface roughness and under-platform dampers, "
    "computed again with an inferred geometry; verdicts follow from the numbers of this run."
)
_CLASS = {
    Verdict.HOLDS: "holds",
    Verdict.HOLDS_IF: "if",
    Verdict.DOES_NOT_HOLD: "not",
    Verdict.UNDECIDED: "open",
}
LARGEST_SHOWN = 60
LONG_CELL = 40  # letters from which a cell needs a wide column
# Folders beside the page, to which it links.
FIGURE_FOLDER = "figures"
TABLE_FOLDER = "tables"


def write_page(
    path: Path,
    items: Sequence[Item],
    figures: Mapping[str, Path],
    counts: Mapping[Verdict, int],
    failures: Sequence[Failure],
    inputs: str,
    provenance: Mapping[str, str],
) -> None:
    """Write the page, whole or not at all. ``figures``: name -> PNG file. Raises InputError."""
    parts = {
        "title": escape(TITLE),
        "description": escape(DESCRIPTION),
        "byline": escape(when(provenance)),
        "notices": _failures(failures),
        "tiles": "".join(
            f'<div class="tile"><h3>Claims: {verdict.value}</h3><p class="value">{counts.get(verdict, 0)}</p></div>'
            for verdict in Verdict
        ),
        "contents": "".join(f'<li><a href="#{item.anchor}">{escape(item.title)}</a></li>' for item in items),
        "items": "".join(_item(item, figures) for item in items),
        "inputs": escape(inputs),
    }
    text = whole_page("paper.html", "A published study, computed again", parts, provenance, styles=("paper.css",))
    with whole_file(path, "page of the study", InputError) as part:
        part.write_text(text, encoding="utf-8")


def _failures(failures: Sequence[Failure]) -> str:
    if not failures:
        return ""
    sentences = [f"{failure.setting}: {failure.message}" for failure in failures]
    return notice("bad", f"{len(failures)} computations have no result", sentences)


def _item(item: Item, figures: Mapping[str, Path]) -> str:
    body = "".join(f'<p class="note">{escape(note)}</p>' for note in item.notes)
    judged = "".join(_judgement(question, judgement) for question, judgement in item.judgements)
    drawn = "".join(_figure(picture, figures[picture.name]) for picture in item.figures)
    tables = "".join(_table(table) for table in item.tables)
    return (
        f'<section id="{item.anchor}"><h2>{escape(item.title)}</h2><p class="says"><b>The paper:</b> '
        f"{escape(item.statement)}</p>{judged}{body}{drawn}{tables}</section>"
    )


def badge(verdict: str) -> str:
    """A verdict as a coloured word."""
    return f'<span class="verdict {_CLASS[Verdict(verdict)]}">{escape(verdict)}</span>'


def _judgement(question: str, judgement: Judgement) -> str:
    return f"<p><b>{escape(question)}</b> {badge(judgement.verdict.value)} {escape(judgement.reason)}</p>"


def _figure(picture: Picture, file: Path) -> str:
    data = base64.b64encode(file.read_bytes()).decode("ascii")
    vector = f'<a href="{FIGURE_FOLDER}/{picture.name}.svg">as SVG</a>'
    return (
        f'<figure class="panel"><img alt="{escape(picture.words)}" src="data:image/png;base64,{data}"><figcaption>'
        f"{escape(picture.words)} {vector}; numbers: {_csv_link(picture.table)}</figcaption></figure>"
    )


def _csv_link(table: str) -> str:
    return f'<a href="{TABLE_FOLDER}/{table}.csv">{table}.csv</a>'


def _table(table: Table) -> str:
    words = [any(isinstance(row[i], str) for row in table.rows) for i in range(len(table.columns))]
    head = "".join(
        f"<th{word_class(is_word)}>{escape(column.heading)}{_unit(column.unit)}</th>"
        for column, is_word in zip(table.columns, words, strict=True)
    )
    rows = "".join(
        "<tr>"
        + "".join(
            _cell(cell, column.unit, is_word) for cell, column, is_word in zip(row, table.columns, words, strict=True)
        )
        + "</tr>"
        for row in table.rows[:LARGEST_SHOWN]
    )
    more = len(table.rows) - LARGEST_SHOWN
    rest = f'<p class="note">{more} more rows are in {_csv_link(table.name)}.</p>' if more > 0 else ""
    caption = f"<caption>{escape(table.caption)} ({_csv_link(table.name)})</caption>"
    body = f"<thead><tr>{head}</tr></thead><tbody>{rows}</tbody>"
    return scrolled(table.caption, f"<table>{caption}{body}</table>") + rest


def _unit(unit: str) -> str:
    return f", {unit.replace('um', 'µm').replace('uJ', 'µJ')}" if unit else ""


def _cell(cell: Cell, unit: str, is_word: bool) -> str:
    if isinstance(cell, str):
        kind = "word long" if len(cell) > LONG_CELL else "word"
        return f'<td class="{kind}">{badge(cell) if cell in set(Verdict) else escape(cell)}</td>'
    shown = "–" if isnan(cell) else shown_number(cell, unit)
    return f"<td{word_class(is_word)}>{shown}</td>"
