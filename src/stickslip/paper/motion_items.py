"""Items made of solved curves: pairs over a period, motion of the damper, states, curves, energies, other laws."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from stickslip.paper.claims import (
    CLAIMS,
    MICRO,
    Solutions,
    energy_at,
    fixed_frequencies,
    friction_energy,
    series,
)
from stickslip.paper.items import Item, base, peak_table
from stickslip.paper.plan import Scope
from stickslip.paper.records import SHOWN_PLACES, Solved
from stickslip.paper.tables import Cell, Table, columns
from stickslip.paper.verdicts import Answer, Judgement, judge


def judged(solutions: Solutions, *names: str) -> tuple[tuple[str, Judgement], ...]:
    """The statements of these claims with the verdicts of these curves."""
    found = {claim.name: claim for claim in CLAIMS}
    return tuple((found[name].statement, found[name].judged(solutions)) for name in names)


def main_run(solutions: Solutions, scope: Scope, force: float | None = None) -> list[Solved]:
    """The base curves under the main centrifugal force, and the main or another force."""
    first, load = scope.runs[0]
    wanted = first if force is None else force
    return [one for one in base(solutions) if (one.setting.force, one.setting.load) == (wanted, load)]


def main_series(chosen: Solutions, along: str) -> list[Solved]:
    """The curves of the longest series of D or G for each excitation, in its order."""
    longest: dict[str, list[Solved]] = {}
    for line in series(chosen, along):
        name = line[0].setting.excitation
        if len(line) > len(longest.get(name, [])):
            longest[name] = line
    return [one for line in longest.values() for one in line]


def shown_place(solutions: Solutions) -> int:
    """Which of the three pairs shows most: the one that is in most different states within its periods."""
    kinds = [sum(len(np.unique(one.phase_state[place])) for one in solutions) for place in range(len(SHOWN_PLACES))]
    return int(np.argmax(kinds))


def period_item(solutions: Solutions, scope: Scope) -> Item:
    """Figures 7 and 8."""
    chosen = [one for one in main_run(solutions, scope) if one.setting.excitation != "single"]
    rows: list[tuple[Cell, ...]] = []
    for one in chosen:
        s = one.setting
        for place, name in enumerate(SHOWN_PLACES):
            shares = [100.0 * float((one.phase_state[place] == code).mean()) for code in range(3)]
            normal = one.signals[place, 5]
            friction = np.hypot(*one.signals[place, 3:5]).max()
            rows.append(
                (
                    s.excitation,
                    s.dimension,
                    s.scale,
                    name,
                    *shares,
                    float(normal.min()),
                    float(normal.max()),
                    float(friction),
                )
            )
    table = Table(
        "fig07_08_period",
        "Shares of the period, and forces, of three pairs at mid-length of the left face, at the peak",
        columns(
            "excitation||Excitation",
            "dimension||D",
            "scale|m|G",
            "pair||Pair",
            "stuck|%|Stuck",
            "slipping|%|Slipping",
            "open|%|Open",
            "least_normal|N|Least N",
            "largest_normal|N|Largest N",
            "largest_friction|N|Largest friction",
        ),
        tuple(rows),
    )
    place = shown_place(chosen)
    return Item(
        "period",
        "Figures 7 and 8: one pair over one period",
        "Within one period a pair sticks, slips and may separate; which of these depends on D, G and the excitation.",
        (f"The paper does not number its pair. Drawn is the {SHOWN_PLACES[place]} one of the three in the table.",),
        (table,),
        ("fig07_period_D", "fig08_period_G"),
        judged(chosen, "three states"),
    )


def damper_item(solutions: Solutions, scope: Scope) -> Item:
    """Figure 9 with the rigid-body fit."""
    chosen = main_run(solutions, scope)
    rows: list[tuple[Cell, ...]] = []
    for one in chosen:
        s = one.setting
        shares = [100.0 * float(share) for share in one.shares]
        swing = MICRO * 0.5 * np.ptp(one.sides, axis=2)
        rows.append((s.excitation, s.dimension, s.scale, *shares, *(float(value) for value in swing.ravel())))
    table = Table(
        "fig09_damper",
        "Rigid-body fit over the 110 contact nodes of the damper, and its middle nodes, at the peak",
        columns(
            "excitation||Excitation",
            "dimension||D",
            "scale|m|G",
            "translation|%|Translation",
            "rotation|%|Rotation",
            "deformation|%|Deformation",
            "left_x|um|Left x",
            "left_y|um|Left y",
            "left_z|um|Left z",
            "right_x|um|Right x",
            "right_y|um|Right y",
            "right_z|um|Right z",
        ),
        tuple(rows),
    )
    pair = pick_pair(chosen, scope)
    return Item(
        "damper",
        "Figure 9: does the damper translate or rotate?",
        "Same direction moves the damper as a translation, opposite directions turn it.",
        (
            "Least squares on the first harmonic: translation plus rotation about the centre of the nodes; the shares "
            "are those of the sum of squared displacements. Swings are half of peak to peak.",
            "Two mirrored blades pushed in opposite directions along x move as mirror images, and a rigid body that "
            "mirrors itself can move up, down and tilt along its length, but not turn about its length. "
            + mirror_words(pair[1]),
        ),
        (table,),
        ("fig09_damper",),
        judged(chosen, "translation", "rotation"),
    )


def mirror_words(one: Solved) -> str:
    """How well the motion under opposite forces mirrors itself, in words with numbers."""
    left, right = one.sides[0], one.sides[1]
    unlike = np.abs(left[2] - right[2]).max() / max(
        np.abs(one.sides - one.sides.mean(axis=2, keepdims=True)).max(), 1e-30
    )
    return f"Here z of the two nodes differs by {100.0 * unlike:.2g} % of the largest swing at most."


def pick_pair(chosen: Solutions, scope: Scope) -> tuple[Solved, Solved]:
    """Same and opposite at the roughness in which both series meet; the first of each if it has no result."""

    def pick(excitation: str) -> Solved:
        kind = [one for one in chosen if one.setting.excitation == excitation]
        centre = [one for one in kind if (one.setting.dimension, one.setting.scale) == (scope.dimension, scope.scale)]
        return (centre or kind)[0]

    return pick("same"), pick("opposite")


def states_item(solutions: Solutions, scope: Scope) -> Item:
    """Figures 10 and 11."""
    forces = list(dict.fromkeys(force for force, load in scope.runs if load == scope.runs[0][1]))
    chosen = [one for force in forces for one in main_run(solutions, scope, force)]
    rows: list[tuple[Cell, ...]] = []
    for one in chosen:
        s, n = one.setting, one.numbers
        rows.append(
            (s.force, s.excitation, s.dimension, s.scale, int(n["stuck"]), int(n["stick_slip"]), int(n["separating"]))
        )
    table = Table(
        "fig10_11_states",
        "Pairs in each state at the peak",
        columns(
            "force|N|Force",
            "excitation||Excitation",
            "dimension||D",
            "scale|m|G",
            "stuck||Stuck",
            "stick_slip||Stick-slip",
            "separating||Separating",
        ),
        tuple(rows),
    )
    figures = tuple(
        f"fig{number}_states_{along}_{force:g}N" for number, along in ((10, "D"), (11, "G")) for force in forces
    )
    return Item(
        "states",
        "Figures 10 and 11: states of the pairs",
        "With D growing and G falling fewer pairs stay stuck; 5 N leaves fewer stuck than 2 N; opposite forces leave "
        "nearly all stuck.",
        (),
        (table,),
        figures,
        judged(chosen, "slip, D", "slip, G", "force, slip"),
    )


def curves_item(solutions: Solutions) -> Item:
    """Figures 12 and 14."""
    chosen = base(solutions)
    notes = [
        "Under opposite forces the tip amplitude nearly vanishes at one stiffness, with every pair stuck: the place of "
        f"the force then lies at a node of the second mode. {nearly_still(chosen)}"
    ]
    return Item(
        "curves",
        "Figures 12 and 14: amplitude against frequency",
        "One force gives two peaks; peaks fall as D grows and G falls, and lean to the left.",
        tuple(notes),
        (peak_table("fig12_14_peaks", "Peaks", chosen), warnings_table(solutions)),
        ("fig12_curves_D", "fig14_curves_G"),
        judged(chosen, "two peaks", "peak, D", "peak, G", "left shift"),
    )


def warnings_table(solutions: Solutions) -> Table:
    """What the solver and the contact law say against curves, numbers left out of the sentences that are alike."""
    found: dict[str, list[str]] = {}
    for one in solutions:
        for sentence in one.warnings:
            found.setdefault(re.sub(r"[0-9.e+-]*[0-9]", "#", sentence), []).append(sentence)
    rows = sorted(((len(same), same[0]) for same in found.values()), reverse=True)
    return Table(
        "warnings",
        f"Warnings on {sum(bool(one.warnings) for one in solutions)} of {len(solutions)} curves, one of each kind",
        columns("curves||Curves", "example||For example"),
        tuple(rows),
    )


def nearly_still(chosen: Solutions) -> str:
    """The smallest peak under opposite forces against the largest one, in words."""
    opposite = [one for one in chosen if one.setting.excitation == "opposite"]
    if not opposite:
        return ""
    lowest, highest = (f(opposite, key=lambda one: one.numbers["peak_m"] / one.setting.force) for f in (min, max))
    words = [
        f"{MICRO * one.numbers['peak_m']:.3g} µm (D {one.setting.dimension:g}, G {one.setting.scale:g} m, "
        f"{one.setting.force:g} N)"
        for one in (lowest, highest)
    ]
    return f"Smallest and largest peak per force: {words[0]} and {words[1]}."


def energy_item(solutions: Solutions) -> Item:
    """Figures 13 and 15: at the peak and at fixed frequencies."""
    rows: list[tuple[Cell, ...]] = []
    for along in ("D", "G"):
        for line in series(base(solutions), along):
            fixed = list(fixed_frequencies(line).values())
            for one in line:
                s = one.setting
                at_fixed = [MICRO * energy_at(one, frequency_hz) for frequency_hz in fixed]
                rows.append(
                    (
                        along,
                        s.excitation,
                        s.force,
                        s.load,
                        s.dimension,
                        s.scale,
                        MICRO * friction_energy(one),
                        *at_fixed,
                        *fixed,
                        MICRO * one.numbers["input_energy_j"],
                    )
                )
    table = Table(
        "fig13_15_energy",
        "Friction energy per cycle, uJ",
        columns(
            "along||Along",
            "excitation||Excitation",
            "force|N|Force",
            "load|N|F_N",
            "dimension||D",
            "scale|m|G",
            "at_peak|uJ|At the peak",
            "at_softest|uJ|At f1",
            "at_middle|uJ|At f2",
            "at_stiffest|uJ|At f3",
            "softest|Hz|f1",
            "middle|Hz|f2",
            "stiffest|Hz|f3",
            "input|uJ|Input at the peak",
        ),
        tuple(rows),
    )
    names = ("energy, D", "hump, D", "energy, G", "energy, D, fixed", "hump, D, fixed", "energy, G, fixed")
    return Item(
        "energies",
        "Figures 13 and 15: dissipated energy",
        "The energy of a period grows with D, for one force and for the same direction first up and then down; it "
        "falls as G grows.",
        (
            "Which frequency is meant is not said. f1, f2, f3 are the peaks of the softest, the middle and the "
            "stiffest curve of a series. The peaks move by more than their width, so the chosen frequency decides "
            "where the largest energy lies.",
            "Energies below 0.1 % of the input are set to zero: the balance of energies tells no more.",
        ),
        (table,),
        ("fig13_energy_D", "fig15_energy_G"),
        judged(base(solutions), *names),
    )


def laws_item(solutions: Solutions) -> Item:
    """Equation 8 against Hertz in the response, and the paper's roughness in the unloading mode."""
    rows, answers = [], []
    for one, plain in law_pairs(solutions):
        ratio = one.numbers["peak_m"] / plain.numbers["peak_m"]
        s = one.setting
        rows.append(
            (
                s.excitation,
                s.dimension,
                s.scale,
                plain.numbers["normal_stiffness"],
                one.numbers["normal_stiffness"],
                MICRO * plain.numbers["peak_m"],
                MICRO * one.numbers["peak_m"],
                plain.numbers["peak_hz"],
                one.numbers["peak_hz"],
                100.0 * (ratio - 1.0),
            )
        )
        answers.append(Answer({"excitation": s.excitation}, abs(ratio - 1.0) > 0.05, f"{100.0 * (ratio - 1.0):+.1f} %"))
    table = Table(
        "laws",
        "Equation 8 as printed (paper) against Hertz (consistent)",
        columns(
            "excitation||Excitation",
            "dimension||D",
            "scale|m|G",
            "kn_consistent|N/m|K_n, Hertz",
            "kn_paper|N/m|K_n, eq 8",
            "peak_consistent|um|Peak, Hertz",
            "peak_paper|um|Peak, eq 8",
            "at_consistent|Hz|at",
            "at_paper|Hz|at, eq 8",
            "change|%|Change of the peak",
        ),
        tuple(rows),
    )
    unloading = base(solutions, "unloading")
    tables = (table, peak_table("unloading", "The paper's roughness in the unloading mode", unloading))
    notes = tuple(
        f"Unloading mode, {line[0].setting.excitation}, D {line[0].setting.dimension:g} to "
        f"{line[-1].setting.dimension:g} at G {line[0].setting.scale:g} m: peaks {_peaks(line)} µm."
        for line in series(unloading, "D")
    )
    figures = ("unloading_curves_D",) if notes else ()
    return Item(
        "laws",
        "Equation 8 or Hertz, and the paper's own roughness",
        "The normal stiffness is taken from equation 8 as printed, and D = 2.2, 2.3 and 2.49 at G = 1e-8.",
        notes,
        tables,
        figures,
        (("Ours: equation 8 instead of Hertz changes the peak by more than 5 %.", judge(answers)),),
    )


def _peaks(line: Solutions) -> str:
    return ", ".join(f"{MICRO * one.numbers['peak_m']:.3g}" for one in line)


def law_pairs(solutions: Solutions) -> Iterator[tuple[Solved, Solved]]:
    """Curves under the paper's law with the base curve that has the same labels otherwise."""
    plain = {_alike(one): one for one in base(solutions)}
    for one in solutions:
        if one.setting.law == "paper" and _alike(one) in plain:
            yield one, plain[_alike(one)]


def _alike(one: Solved) -> Sequence[object]:
    s = one.setting
    return (s.excitation, s.force, s.load, s.dimension, s.scale)
