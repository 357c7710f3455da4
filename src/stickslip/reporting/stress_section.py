"""The section of the page on the stress at the peak: its extremes, the picture of it and the Goodman check."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.core.shown_numbers import MICRO, number
from stickslip.reporting.section import Content, Section
from stickslip.reporting.structure_picture import STRESS_WORDS
from stickslip.reporting.structure_still import Paint, still_picture
from stickslip.reporting.style import shown_number
from stickslip.reporting.templates import rendered
from stickslip.reporting.view import View
from stickslip.results.stress import REGION_WORDS, Region, StressExtreme, StressSummary

_MPA = 1e-6  # Pa to MPa
_STATIC = {
    "solved": "It contains the stress of the state at rest, solved from the static load.",
    "none": "Nothing loads the structure at rest, so this is the complete stress.",
    "prescribed": (
        "It contains the stress at rest under the prescribed normal loads and the constant loads, without tractions. "
        "Bodies that only contact supports are balanced by a uniform acceleration, as by a centrifugal force. Supports "
        "carry the reaction of a normal load. In a bolted joint the bolt carries it: there only ranges and the "
        "alternating stress are meaningful, unless a solved preload has the clamp force as its load."
    ),
}


def _values(view: View) -> dict[str, Any]:
    stress, sketch = view.study.stress, view.study.sketch
    assert stress is not None  # the section applies only where there is one
    still = ""
    if sketch is not None and sketch.stress is not None:
        paint = Paint(_MPA * np.asarray(sketch.stress.alternating, dtype=float), STRESS_WORDS["alternating"])
        still = base64.b64encode(still_picture(view.study, sketch, paint)).decode("ascii")
    return {
        "frequency": shown_number(view.shown_frequency_hz(stress.frequency_hz), "Hz"),
        "static": _STATIC[stress.static],
        "rows": list(_rows(stress)),
        "per_force": list(_per_force(stress)),
        "goodman": [(row.body, number(row.value), _position(row)) for row in stress.goodman],
        "goodman_message": stress.goodman_message,
        "truncation": number(100.0 * stress.truncation, 2),
        "still": still,
    }


def _rows(stress: StressSummary) -> Iterator[tuple[str, str, str, str, str]]:
    """Measure; value and position away from contacts and loads; value and position on the whole mesh."""
    apart = {row.quantity: row for row in stress.extremes}
    for row in stress.everywhere:
        inside = apart.get(row.quantity)
        words = ("–", "–") if inside is None else (_mpa(inside), _position(inside))
        yield (row.quantity[0].upper() + row.quantity[1:], *words, _mpa(row), _position(row))


def _per_force(stress: StressSummary) -> Iterator[tuple[str, str]]:
    """Peak stress and displacement for 1 N of the excitation."""
    if not stress.force > 0.0:
        return
    alternating = [row for row in stress.extremes if row.quantity == "alternating stress"]
    for row in alternating:
        yield "Alternating stress per unit of force", f"{number(_MPA * row.value / stress.force)} MPa/N"
    yield "Displacement per unit of force", f"{number(MICRO * stress.displacement / stress.force)} µm/N"
    yield "Force amplitude", f"{number(stress.force)} N"


def _mpa(row: StressExtreme) -> str:
    return number(_MPA * row.value).replace("-", "−")


def _position(row: StressExtreme) -> str:
    x, y, z = (f"{1e3 * each:.1f}".replace("-", "−") for each in row.position)
    words = REGION_WORDS[Region(row.region)]
    return f"{row.body} ({x}, {y}, {z}) mm{', ' + words if words else ''}"


STRESS = Section(
    "Stress at the peak",
    lambda view: Content(rendered("stress.html", _values(view))),
    applies=lambda view: view.study.stress is not None,
    identity="stress",
)
