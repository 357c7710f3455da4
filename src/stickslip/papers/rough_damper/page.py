"""The page of the study: one self-contained HTML file, each item beside the paper's statement, with its verdict."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from pathlib import Path

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.shown_numbers import typeset
from stickslip.papers.rough_damper.compute import Failure
from stickslip.papers.rough_damper.items import Item
from stickslip.papers.rough_damper.tables import Cell, Table
from stickslip.papers.rough_damper.verdicts import Verdict
from stickslip.reporting.style import shown_number
from stickslip.reporting.templates import Notice, StudyText, Tile, when, whole_page

TITLE = "Interface roughness and an under-platform damper"
DESCRIPTION = (
    "The results of the 2023 article on interface roughness and under-platform dampers, computed again with an "
    "inferred geometry: Tables 1 and 2, Figures 2, 4 and 7 to 15, and the conclusions. Table 3 (inputs) and the "
    "schematics (Figures 1, 3, 5, 6) are omitted. Verdicts follow from the numbers of this run."
)
_CLASS = {
    Verdict.HOLDS: "holds",
    Verdict.HOLDS_IF: "if",
    Verdict.DOES_NOT_HOLD: "not",
    Verdict.UNDECIDED: "open",
}
# Volume, number and dates: the publisher's page, https://www.mdpi.com/2076-3417/13/4/2128.
CITATION = (
    "The article: The Influence of Interface Roughness on the Vibration Reduction Characteristics of an Under-Platform "
    "Damper. Applied Sciences 13(4), 2128 (2023). Open access, CC BY 4.0."
)
DOI = "10.3390/app13042128"
LARGEST_SHOWN = 60
LONG_CELL = 40  # letters from which a cell needs a wide column
# Folders beside the page, to which it links.
FIGURE_FOLDER = "figures"
TABLE_FOLDER = "tables"
OPEN_TABLE = "conclusions"  # the only table that is not folded


def write_page(
    path: Path,
    items: Sequence[Item],
    figures: Mapping[str, Path],
    counts: Mapping[Verdict, int],
    failures: Sequence[Failure],
    summary: Sequence[str],
    inputs: StudyText,
    provenance: Mapping[str, str],
) -> None:
    """Write the page, completely or not at all. ``figures``: name -> PNG file; ``summary``: lines above all items.
    Raises InputError."""
    values = {
        "title": TITLE,
        "description": DESCRIPTION,
        "byline": when(provenance),
        "notices": list(_failures(failures)),
        "tiles": [Tile(f"Claims: {verdict.value}", str(counts.get(verdict, 0))) for verdict in Verdict],
        "items": items,
        "tables": [[_shown(table) for table in item.tables] for item in items],
        "images": {name: base64.b64encode(file.read_bytes()).decode("ascii") for name, file in figures.items()},
        "verdict_class": {verdict.value: look for verdict, look in _CLASS.items()},
        "figure_folder": FIGURE_FOLDER,
        "table_folder": TABLE_FOLDER,
        "citation": CITATION,
        "doi": DOI,
        "summary": summary,
        "open_table": OPEN_TABLE,
        "inputs": inputs,
    }
    kind, here = "A published study, computed again", "stickslip.papers.rough_damper"
    text = whole_page("paper.html", kind, values, provenance, styles=("paper.css",), package=here)
    with whole_file(path, "page of the study", InputError) as part:
        part.write_text(text, encoding="utf-8")


def _failures(failures: Sequence[Failure]) -> Iterator[Notice]:
    if failures:
        sentences = [f"{failure.setting.words}: {failure.message}" for failure in failures]
        yield Notice("bad", f"Computations without a result: {len(failures)}", sentences)


@dataclass(frozen=True)
class _Cell:
    """A cell in words, and the classes that set its look."""

    text: str
    look: str


@dataclass(frozen=True)
class _ShownTable:
    """A table in words; headings, each with whether its column holds words, and how many rows the page leaves out."""

    name: str
    caption: str
    headings: list[tuple[str, bool]]
    rows: list[list[_Cell]]
    left_out: int


def _shown(table: Table) -> _ShownTable:
    words = [any(isinstance(row[i], str) for row in table.rows) for i in range(len(table.columns))]
    headings = [
        (column.heading + _unit(column.unit), is_word) for column, is_word in zip(table.columns, words, strict=True)
    ]
    rows = [
        [_cell(cell, column.unit, is_word) for cell, column, is_word in zip(row, table.columns, words, strict=True)]
        for row in table.rows[:LARGEST_SHOWN]
    ]
    return _ShownTable(table.name, table.caption, headings, rows, max(0, len(table.rows) - LARGEST_SHOWN))


def _unit(unit: str) -> str:
    return f", {unit.replace('um', 'µm').replace('uJ', 'µJ')}" if unit else ""


def _cell(cell: Cell, unit: str, is_word: bool) -> _Cell:
    if isinstance(cell, str):
        return _Cell(typeset(cell), "word long" if len(cell) > LONG_CELL else "word")
    return _Cell("–" if isnan(cell) else shown_number(cell, unit), "word" if is_word else "")
