"""The stress at the peak in numbers and on the surface, for results files and pages."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.model.model import Model, kind_of
from stickslip.results.response import ForcedResponse
from stickslip.results.stress import Region, StressExtreme, StressSummary, SurfaceStress
from stickslip.structure.mesh import IntArray
from stickslip.study.stress import StressAtPeak

if TYPE_CHECKING:
    from stickslip.case.case import Case

LARGEST_VON_MISES, RANGE_OF_VON_MISES = "largest von Mises stress", "range of von Mises stress"
ALTERNATING = "alternating stress"
SAFETY = "safety factor"
# Row of the derived quantities of matrices.
NO_SECTOR_STRESS = ("Stress at the peak", "none", "-", "it is not computed for a sector of a disk")
NO_MESH = ("Stress at the peak", "none", "-", "matrices have no mesh, and therefore no stress")
NO_STRENGTHS = (
    "No material has both fatigue_limit and tensile_strength, so there is no Goodman check. Give both in [material] or "
    "[bodies.NAME]."
)


def stress_summary(case: Case, model: Model, response: ForcedResponse, stress: StressAtPeak) -> StressSummary:
    """Extremes of all measures with their positions, and the Goodman check."""
    ordinary = (stress.region == Region.ORDINARY) | (stress.region == Region.CONSTRAINED)
    everything = np.ones_like(ordinary)
    names = model.joint.layout.body_names
    output = next(iter(model.outputs.values()))

    def extremes(where: FloatArray) -> tuple[StressExtreme, ...]:
        rows = np.flatnonzero(where)
        return tuple(_extremes(stress, names, rows)) if rows.size else ()

    goodman, message = _goodman(stress, names, np.flatnonzero(ordinary))
    return StressSummary(
        extremes=extremes(ordinary),
        everywhere=extremes(everything),
        goodman=goodman,
        goodman_message=message,
        static=stress.static,
        frequency_hz=stress.frequency_hz,
        force=float(kind_of(case).force_amplitude(case) * response.load_factor[stress.point]),
        displacement=float(response.amplitude(output)[stress.point]),
        truncation=stress.truncation,
    )


def stress_rows(summary: StressSummary) -> Iterator[tuple[str, str, str]]:
    """Rows (name, value, unit) for a terminal: largest alternating stress and smallest safety factor."""
    for row in summary.extremes:
        if row.quantity == ALTERNATING:
            yield "Largest alternating stress, away from contacts and loads", f"{1e-6 * row.value:.4g}", "MPa"
    if summary.goodman:
        weakest = min(summary.goodman, key=lambda row: row.value)
        yield "Smallest safety factor (Goodman)", f"{weakest.value:.4g}", f"- ({weakest.body})"


def surface_stress(stress: StressAtPeak, nodes: IntArray) -> SurfaceStress:
    """The stress at nodes (k,) of its mesh."""
    n_nodes = stress.mesh.n_nodes
    largest, alternating = stress.cycle.largest_von_mises, stress.cycle.alternating
    return SurfaceStress(
        *(stress.nodal.at_nodes(each, n_nodes)[nodes].astype(np.float32) for each in (largest, alternating))
    )


def fields_of(stress: StressAtPeak) -> dict[str, FloatArray]:
    """Name and unit -> values (p,) of the rows of nodes and bodies, for a file of ParaView."""
    cycle = stress.cycle
    fields = {
        "largest von Mises, Pa": cycle.largest_von_mises,
        "smallest von Mises, Pa": cycle.smallest_von_mises,
        "largest first principal, Pa": cycle.largest_first_principal,
        "smallest first principal, Pa": cycle.smallest_first_principal,
        "largest third principal, Pa": cycle.largest_third_principal,
        "smallest third principal, Pa": cycle.smallest_third_principal,
        "alternating, Pa": cycle.alternating,
        "mean, Pa": cycle.mean,
        "region (1 contact, 2 load, 3 constrained)": stress.region.astype(float),
    }
    return fields if stress.safety is None else {**fields, "safety factor (Goodman)": stress.safety}


def _extremes(stress: StressAtPeak, names: tuple[str, ...], rows: IntArray) -> Iterator[StressExtreme]:
    cycle = stress.cycle
    for quantity, values, sign in (
        (LARGEST_VON_MISES, cycle.largest_von_mises, 1.0),
        (RANGE_OF_VON_MISES, cycle.largest_von_mises - cycle.smallest_von_mises, 1.0),
        ("largest first principal stress", cycle.largest_first_principal, 1.0),
        ("smallest third principal stress", cycle.smallest_third_principal, -1.0),
        ("range of first principal stress", cycle.largest_first_principal - cycle.smallest_first_principal, 1.0),
        ("range of third principal stress", cycle.largest_third_principal - cycle.smallest_third_principal, 1.0),
        (ALTERNATING, cycle.alternating, 1.0),
        ("mean stress", cycle.mean, 1.0),
    ):
        row = int(rows[(sign * values[rows]).argmax()])
        yield _extreme(quantity, float(values[row]), row, stress, names)


def _extreme(quantity: str, value: float, row: int, stress: StressAtPeak, names: tuple[str, ...]) -> StressExtreme:
    x, y, z = stress.mesh.points[stress.nodal.node[row]].tolist()
    body = names[int(stress.nodal.body[row])]
    return StressExtreme(quantity, value, body, (x, y, z), int(stress.region[row]))


def _goodman(stress: StressAtPeak, names: tuple[str, ...], rows: IntArray) -> tuple[tuple[StressExtreme, ...], str]:
    """Smallest safety factor of each body, and the check in words."""
    if stress.safety is None:
        return (), NO_STRENGTHS
    weakest: list[StressExtreme] = []
    without: list[str] = []
    hidden: list[str] = []
    for body, name in enumerate(names):
        of_body = stress.safety[stress.nodal.body == body]
        here = rows[(stress.nodal.body[rows] == body) & np.isfinite(stress.safety[rows])]
        if here.size:
            row = int(here[stress.safety[here].argmin()])
            weakest.append(_extreme(SAFETY, float(stress.safety[row]), row, stress, names))
        else:
            (without if np.isnan(of_body).all() else hidden).append(name)
    message = "1 / S = alternating / fatigue limit + mean / tensile strength, at each node."
    if without:
        message += f" Not checked, without both strengths: {', '.join(without)}."
    if hidden:
        message += f" Not checked, because all cells are at a contact or a load: {', '.join(hidden)}."
    below = [row.body for row in weakest if row.value < 1.0]
    if below:
        message += f" Below 1, so the material does not endure this vibration: {', '.join(below)}."
    return tuple(weakest), message
