"""Items made of whole curves: amplitude against frequency, energies, and the laws of the normal stiffness."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from stickslip.papers.rough_damper.claims import MICRO, Solutions, energy_at, fixed_frequencies, friction_energy, series
from stickslip.papers.rough_damper.items import Item, Picture, base, judged, peak_table
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.tables import Cell, Table, columns
from stickslip.papers.rough_damper.verdicts import Answer, judge
from stickslip.results.sweeps_of_curve import SAME_PEAK


def curves_item(solutions: Solutions) -> Item:
    """Figures 12 and 14."""
    chosen = base(solutions)
    notes = [
        "Under opposite forces the tip amplitude nearly vanishes at one stiffness, with all pairs stuck: the position "
        f"of the force is then at a node of the second mode.  {nearly_still(chosen)}",
        folded_words(chosen),
    ]
    return Item(
        "curves",
        "Figures 12 and 14: amplitude against frequency",
        "One force gives two peaks; peaks fall as D grows and G falls, and lean to the left.",
        tuple(notes),
        (peak_table("fig12_14_peaks", "Peaks", chosen), warnings_table(solutions)),
        tuple(
            Picture(
                f"fig{number}_curves_{along}",
                f"Amplitude of the tip against frequency, a line for each {along}: a column for each excitation, a row "
                "for each force and centrifugal force. Triangles: peak of a slow sweep up, if it is a lower one.",
                "fig12_14_peaks",
            )
            for number, along in ((12, "D"), (14, "G"))
        ),
        judged(
            chosen,
            *("two peaks", "reverse, small", "reverse, steady", "peak, D", "peak, G", "unchanged law", "left shift"),
        ),
    )


def folded_words(chosen: Solutions) -> str:
    """How many curves fold so that a slow sweep up has a lower peak, and by how much, in words."""
    both = [(one, one.seen_by("up")) for one in chosen]
    lower = [1.0 - up.numbers["peak_m"] / one.numbers["peak_m"] for one, up in both if up is not None]
    missed = sorted(100.0 * part for part in lower if part > SAME_PEAK)
    words = f"On {len(missed)} of {len(chosen)} curves a slow sweep up does not reach the highest peak"
    if not missed:
        return f"{words}."
    return f"{words}; its peak is lower by {np.median(missed):.2g} % in the median and {missed[-1]:.2g} % at most."


def warnings_table(solutions: Solutions) -> Table:
    """What the solver and the contact law say against curves, numbers left out of the sentences that are alike."""
    by_pattern: dict[str, list[str]] = {}
    for one in solutions:
        for sentence in one.warnings:
            by_pattern.setdefault(re.sub(r"[0-9.e+-]*[0-9]", "#", sentence), []).append(sentence)
    rows = sorted(((len(same), same[0]) for same in by_pattern.values()), reverse=True)
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
        "The energy of a period grows with D; for one force and for the same direction it first rises, then falls. It "
        "falls as G grows.",
        (
            "The paper does not specify the frequency. f1, f2, f3 are the peaks of the softest, the middle and the "
            "stiffest curve of a series. The peaks move by more than their width, so the chosen frequency decides "
            "which curve has the largest energy.",
            "Energies below 0.1 % of the input are set to zero, because the balance of energies is not more accurate.",
        ),
        (table,),
        tuple(
            Picture(
                f"fig{number}_energy_{along}",
                f"Friction energy per cycle against {along}: at the peak of each curve, and at the three frequencies.",
                table.name,
            )
            for number, along in ((13, "D"), (15, "G"))
        ),
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
    words = "Amplitude of the tip against frequency in the unloading mode, a line for each D."
    figures = (Picture("unloading_curves_D", words, "unloading"),) if notes else ()
    return Item(
        "laws",
        "Equation 8 or Hertz, and the paper's own roughness",
        "The normal stiffness follows from equation 8 as printed, and D = 2.2, 2.3 and 2.49 at G = 1e-8.",
        notes,
        tables,
        figures,
        (("Of stickslip: equation 8 instead of Hertz changes the peak by more than 5 %.", judge(answers)),),
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
