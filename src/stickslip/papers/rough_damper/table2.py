"""Table 2 of the paper: ten natural frequencies of the full and the reduced model."""

from __future__ import annotations

import csv
from importlib.resources import files

SOURCE = "Table 2 of the 2023 article, full model"


def table2() -> tuple[dict[str, float], ...]:
    """Rows with mode, full_hz, reduced_hz, frequency_difference_percent, mac."""
    text = files("stickslip.papers.rough_damper").joinpath("table2.csv").read_text(encoding="utf-8")
    return tuple({name: float(value) for name, value in row.items()} for row in csv.DictReader(text.splitlines()))
