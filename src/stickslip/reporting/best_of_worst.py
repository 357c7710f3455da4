"""The answer of a sweep: the design whose highest peak over all load cases is the lowest."""

from __future__ import annotations

import numpy as np

from stickslip.core.shown_numbers import length
from stickslip.reporting.sweep_view import SweepView, short_name

# Sections whose keys are load cases: what acts on the structure. All other keys are the design.
LOAD_SECTIONS = ("excitation", "forces", "base_motion", "unbalance", "rotation", "static_loads", "pressures", "gravity")
LOAD_KEYS = ("preload.speed_of_rotation",)


def best_of_worst(view: SweepView) -> str:
    """A sentence on the minimum over designs of the maximum over load cases; "" without a design with a known peak.

    A design counts if it was computed under every load case, and each of these peaks is inside the computed range.
    """
    names = [key.name for key in view.table.keys]
    loads = [place for place, name in enumerate(names) if name.split(".")[0] in LOAD_SECTIONS or name in LOAD_KEYS]
    designs = [place for place in range(len(names)) if place not in loads]
    if not designs:
        return ""
    peak, inside = view.number("peak_amplitude_m"), view.inside()
    _, member_of = np.unique(view.positions[:, designs], axis=0, return_inverse=True)
    groups = [np.flatnonzero(member_of.ravel() == number) for number in range(int(member_of.max()) + 1)]
    _, case_of = np.unique(view.positions[:, loads], axis=0, return_inverse=True)
    count = int(case_of.max()) + 1 if loads else 1
    complete = [rows for rows in groups if rows.size == count and inside[rows].all()]
    if not complete:
        return "No design has a known peak under all its load cases."
    worst = [int(rows[peak[rows].argmax()]) for rows in complete]
    best = min(worst, key=lambda row: peak[row])
    top, design = " ".join(length(float(peak[best]))), view.label(best, tuple(loads))
    words = f"Best design: {design}. Its highest peak is {top}"
    if loads:
        words += f", in the load case {view.label(best, tuple(designs))}"
    words += "." + "".join(_at_an_end(view, best, place) for place in designs)
    left_out = len(groups) - len(complete)
    return words + (f" {left_out} designs with an unknown peak do not count." if left_out else "")


def _at_an_end(view: SweepView, row: int, place: int) -> str:
    """A sentence if the value of this row is at an end of a range of numbers."""
    key = view.table.keys[place]
    if len(key.shown) <= 2 or key.shown[view.positions[row, place]] not in (min(key.shown), max(key.shown)):
        return ""
    return f" This is at an end of the values of {short_name(key)}: a better one may be beyond."
