"""Errors and gaps of the article's equations, the form that is used here instead, and its effect."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.papers.rough_damper.claims import Solutions
from stickslip.papers.rough_damper.curve_items import law_pairs
from stickslip.papers.rough_damper.items import Item, base
from stickslip.papers.rough_damper.table2 import table2
from stickslip.papers.rough_damper.tables import Cell, Table, columns


@dataclass(frozen=True)
class Erratum:
    """Number, place, what is printed, what stands here, and what it does to the result."""

    number: str
    place: str
    printed: str
    here: str
    effect: str


ERRATA = (
    Erratum("E1", "eq 1", "contact for n above +N0/kn", "above -N0/kn", "as printed, a range of motion has no force"),
    Erratum(
        "E2", "text of eq 1", "N0 changes with the motion", "N changes, N0 is constant", "wording; none if read as N"
    ),
    Erratum(
        "E3",
        "eq 2",
        "size of the friction force only",
        "vector law with a moving slider",
        "direction decides energy on curved paths",
    ),
    Erratum(
        "E4",
        "sec 3.1",
        "slip along one axis as a state of its own",
        "stuck or slipping",
        "states are counted as three, not five",
    ),
    Erratum(
        "E5", "eq 2", "unequal springs not treated", "associated return", "none here: both tangential springs are equal"
    ),
    Erratum("E6", "eq 3", "phase written f, bracket open", "phase of each wave", "misprint; none"),
    Erratum(
        "E7",
        "eq 3",
        "arc tangent of y/x",
        "dot product (arc tangent of two arguments)",
        "wrong heights for x below 0; picture only",
    ),
    Erratum(
        "E8",
        "eq 3",
        "number of waves, ridges and lengths missing",
        "inputs: 28 mm, 1 um, 10 ridges",
        "Sq and Sdq follow from them; K_n does not (except unloading)",
    ),
    Erratum("E9", "text of eq 3, conclusion 4", "rougher means D up and G down", "smoother and stiffer", ""),
    Erratum(
        "E10",
        "eqs 3, 6, 8, 9",
        "one D everywhere",
        "surface D in 3, D - 1 in 6, 8, 9",
        "with one D the two stiffnesses have opposite signs",
    ),
    Erratum(
        "E11",
        "eq 5",
        "elastic part integrated over nothing",
        "from the critical to the largest area",
        "as printed no elastic load at all",
    ),
    Erratum("E12", "eq 5", "several names of one largest area", "one largest, one smallest area", "misprint; none"),
    Erratum(
        "E13", "eqs 5 to 9", "hardness, plastic force, size density not given", "H a', usual density, H = 3 GPa", ""
    ),
    Erratum(
        "E14",
        "eq 6",
        "exponents for a profile",
        "same with D - 1",
        "units do not reveal it; interference wrong by orders",
    ),
    Erratum("E15", "eq 8", "exact only along the asperity family", "offered as law paper", ""),
    Erratum("E16", "eq 8", "normal stiffness of no single asperity", "fixed curvature, law consistent", ""),
    Erratum("E17", "eq 9", "Mindlin on fixed curvature", "the same", "none: K_t is equal in both laws"),
    Erratum(
        "E18",
        "eqs 8, 9",
        "ratio of K_t to K_n depends on D",
        "2(1-nu)/(2-nu) = 0.8235",
        "paper law: 0.417 (D 2.49) to 0.549 (D 2.2)",
    ),
    Erratum("E19", "eqs 8, 9", "modulus with another name", "reduced modulus of eq 4", "misprint; none"),
    Erratum("E20", "eqs 8, 9", "no guard for plastic faces", "zero with a status, rejected by the solver", ""),
    Erratum(
        "E21",
        "eq 10",
        "fraction of a pair not defined",
        "its area over that of the face",
        "an area would give the wrong unit",
    ),
    Erratum("E22", "Figs 4 to 15", "G without a unit", "metre; the unit is a required input", ""),
    Erratum(
        "E23",
        "nomenclature",
        "names of two forces exchanged",
        "separate symbols for contact force and excitation",
        "misprint; none",
    ),
    Erratum(
        "E24",
        "eq 14",
        "derivative operator not defined",
        "real form of i k omega",
        "a sign error here turns mass into stiffness",
    ),
    Erratum("E25", "Table 2", "all differences below 1/10,000", "three rows are above", ""),
    Erratum("E26", "Fig 15", "2.5e-21 J", "exactly 0 for a stuck pair", ""),
    Erratum(
        "E27",
        "sec 5.3.1",
        "energy falls because a rough face sticks",
        "stiffer springs slip earlier; the motion falls",
        "",
    ),
    Erratum(
        "E28",
        "sec 4",
        "samples, friction, damping missing; order in the list of symbols only",
        "5 harmonics, 256 samples, inputs",
        "see the table of choices",
    ),
    Erratum(
        "E29",
        "Table 3",
        "beam dimensions only",
        "geometry inferred from Table 2",
        "a bare beam has 270 Hz, Table 2 has 507 Hz: frequencies depend on the inference",
    ),
)


def errata_item(solutions: Solutions, surfaces: Table, stiffness: Table) -> Item:
    """The table of errata; effects that numbers of this run show are computed."""
    computed = {
        "E9": _smoother(surfaces),
        "E13": _hardness(solutions),
        "E15": _law(solutions),
        "E16": _law(solutions),
        "E20": _plastic(stiffness),
        "E22": _unit(stiffness),
        "E25": _exceeding(),
        "E26": _still(solutions),
        "E27": _motion(solutions),
    }
    rows: list[tuple[Cell, ...]] = [
        (each.number, each.place, each.printed, each.here, computed.get(each.number, each.effect)) for each in ERRATA
    ]
    table = Table(
        "errata",
        "Errata and their effect",
        columns("number||No.", "place||Where", "printed||Printed", "here||Here", "effect||Effect on the result"),
        tuple(rows),
    )
    return Item("errata", "Errata", "Equations, symbols and units as printed.", (), (table,))


def _smoother(surfaces: Table) -> str:
    rows = [row for row in surfaces.rows if row[1] == 1e-8]
    return f"at G 1e-8 m Sq is {rows[0][2]:.3g} um for D {rows[0][0]} and {rows[-1][2]:.3g} um for D {rows[-1][0]}"


def _hardness(solutions: Solutions) -> str:
    parts = []
    for choice in ("hardness 2 GPa", "hardness 4 GPa"):
        selected = [one for one in solutions if one.setting.choice == choice]
        if selected:
            soft = min(selected, key=lambda one: one.numbers["normal_stiffness"])
            parts.append(
                f"{choice}: K_n {soft.numbers['normal_stiffness']:.3g} N/m (D {soft.setting.dimension:g}, G "
                f"{soft.setting.scale:g} m)"
            )
    return "; ".join(parts) if parts else "no curve with another hardness in this run"


def _law(solutions: Solutions) -> str:
    changes = [100.0 * (one.numbers["peak_m"] / plain.numbers["peak_m"] - 1.0) for one, plain in law_pairs(solutions)]
    if not changes:
        return "no curve with equation 8 in this run"
    return f"changes the peak by {min(changes):+.1f} % to {max(changes):+.1f} %"


def _plastic(stiffness: Table) -> str:
    plastic = [row for row in stiffness.rows if row[-1] == "fully plastic"]
    return f"{len(plastic)} of {len(stiffness.rows)} faces in the table of stickslip would have a negative stiffness"


def _unit(stiffness: Table) -> str:
    def span(scale: float) -> str:
        values = [float(row[3]) for row in stiffness.rows if row[1] == scale]
        return f"{min(values):.2g} to {max(values):.2g} N/m"

    both = f"K_n {span(1e-8)} read as metre, {span(1e-11)} read as millimetre"
    return f"{both}; D 2.2 stays plastic at light load either way"


def _exceeding() -> str:
    modes = [f"{row['mode']:.0f}" for row in table2() if row["frequency_difference_percent"] > 0.01]
    return f"modes {', '.join(modes)} of its own table are above 0.01 %"


def _still(solutions: Solutions) -> str:
    opposite = [one for one in base(solutions) if one.setting.excitation == "opposite"]
    stuck = [one for one in opposite if one.numbers["stuck"] == len(one.pair_state)]
    zero = sum(one.numbers["friction_energy_j"] == 0.0 for one in stuck)
    return (
        f"{len(stuck)} of {len(opposite)} curves under opposite forces are all stuck, {zero} of them with exactly 0 J"
    )


def _motion(solutions: Solutions) -> str:
    """Relative tangential swing at the middle pair of the softest and the stiffest curve of the main series."""
    chosen = [one for one in base(solutions) if one.setting.excitation == "same"]
    if not chosen:
        return "no curve in this run"
    soft, stiff = (f(chosen, key=lambda one: one.numbers["normal_stiffness"]) for f in (min, max))
    swing = [1e6 * float(np.ptp(one.signals[1, :2], axis=1).max()) for one in (soft, stiff)]
    shown = f"swing of the middle pair {swing[0]:.3g} um at the softest, {swing[1]:.3g} um at the stiffest face"
    return f"{shown}; roughness does not end slip"
