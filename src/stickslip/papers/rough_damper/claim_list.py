"""The paper's claims about the vibration, in its order, each with the question that decides it."""

from __future__ import annotations

from collections.abc import Callable

from stickslip.papers.rough_damper.claims import (
    MICRO,
    Claim,
    Measure,
    all_states,
    along_series,
    between,
    compare,
    dominated_by,
    energy_along,
    fewer_stuck_at_high_force,
    friction_energy,
    moves_left,
    moving,
    opposite_is_nothing,
    peaks_of_both_directions,
    reduction,
    same_is_largest,
    state_words,
    two_peaks,
)
from stickslip.papers.rough_damper.further_claims import (
    more_separate_at_high_force,
    rotation_is_of_opposite_forces,
    same_trend_in_every_run,
    second_peak_is_small,
    second_peak_is_steady,
)
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.verdicts import Answer, falls, rises, rises_then_falls


def peak(one: Solved) -> float:
    """m, the peak of the curve, or of the sweep that sees it."""
    return one.numbers["peak_m"]


def stuck_peak(one: Solved) -> float:
    """m, the linear peak with the pairs stuck: what stiffness alone does."""
    return one.numbers["stuck_peak_m"]


def over_stuck(one: Solved) -> float:
    """The peak over the linear stuck one: what friction alone does."""
    return peak(one) / stuck_peak(one)


def _peak_falls(name: str, along: str, place: str, statement: str) -> Claim:
    def ask(measure: Measure, unit: str = "µm", factor: float = MICRO) -> Callable[..., list[Answer]]:
        return along_series(along, measure, falls, factor, unit)

    beside = (
        ("Beside it, of stiffness alone, the linear stuck peak falls", ask(stuck_peak)),
        ("Of friction alone, the peak over the linear stuck peak falls", ask(over_stuck, "of stuck", 1.0)),
    )
    question = along_series(along, peak, falls, MICRO, "µm", beside=("linear stuck", stuck_peak))
    return Claim(name, place, statement, question, beside)


CLAIMS = (
    Claim(
        "translation",
        "Fig 9, conclusion 1",
        "Same direction moves the damper mostly as a translation.",
        dominated_by("same", 0),
    ),
    Claim("rotation", "Fig 9, conclusion 1", "Opposite directions rotate the damper.", dominated_by("opposite", 1)),
    Claim(
        "rotation, larger",
        "Fig 9, conclusion 1",
        "The damper rotates more under opposite forces than in the same direction.",
        rotation_is_of_opposite_forces,
    ),
    Claim(
        "three states", "Figs 7, 8, conclusion 1", "A pair sticks, slips and separates within one period.", all_states
    ),
    Claim(
        "load, slip",
        "conclusion 2",
        "A smaller centrifugal force lets more pairs slip or open.",
        between("load", compare(moving, 0.5), state_words),
    ),
    Claim(
        "load, suppression",
        "conclusion 2",
        "A larger centrifugal force weakens the reduction of the peak by friction.",
        between("load", compare(reduction, 0.01), lambda one: f"{100 * reduction(one):.1f} % off the stuck peak"),
    ),
    Claim(
        "force, slip",
        "Figs 10, 11",
        "5 N leaves fewer pairs stuck than 2 N.",
        between("force", fewer_stuck_at_high_force, state_words),
    ),
    Claim(
        "force, separation",
        "Figs 10, 11",
        "5 N separates more pairs than 2 N.",
        more_separate_at_high_force,
    ),
    Claim(
        "same, slip",
        "conclusion 3",
        "Same direction lets most pairs slip or open.",
        same_is_largest(moving, 1.0, "pairs"),
    ),
    Claim(
        "same, energy",
        "conclusion 3",
        "Same direction dissipates most.",
        same_is_largest(friction_energy, MICRO, "µJ"),
    ),
    Claim("two peaks", "Fig 12", "One force gives two peaks, the first the higher one.", two_peaks),
    Claim("peak pairs", "Fig 12", "Its peaks are those of same and of opposite forces.", peaks_of_both_directions),
    Claim("left shift", "Figs 12, 14", "Where pairs slip or open, the peak lies below the stuck one.", moves_left),
    _peak_falls("peak, D", "D", "Fig 12, conclusion 4", "The peak falls as D grows."),
    _peak_falls("peak, G", "G", "Fig 14, conclusion 4", "The peak falls as G falls."),
    Claim(
        "reverse, small",
        "Fig 12",
        "Of one force, the peak of the reverse vibration is small: less than half of the first.",
        second_peak_is_small,
    ),
    Claim(
        "reverse, steady",
        "Fig 12",
        "Of one force, the peak of the reverse vibration changes with D by less than 10 %.",
        second_peak_is_steady,
    ),
    Claim(
        "unchanged law",
        "abstract, conclusion 4",
        "Neither the centrifugal force nor the force changes whether the peak falls along D or G.",
        same_trend_in_every_run(peak),
    ),
    Claim(
        "slip, D",
        "Fig 10, conclusion 4",
        "More pairs slip or open as D grows.",
        along_series("D", moving, rises, 1.0, "pairs"),
    ),
    Claim(
        "slip, G",
        "Fig 11, conclusion 4",
        "More pairs slip or open as G falls.",
        along_series("G", moving, rises, 1.0, "pairs"),
    ),
    Claim(
        "energy, D", "Fig 13, conclusion 4", "The energy grows with D (at the peak).", energy_along("D", rises, False)
    ),
    Claim(
        "energy, G",
        "Fig 15, conclusion 4",
        "The energy grows as G falls (at the peak).",
        energy_along("G", rises, False),
    ),
    Claim(
        "hump, D",
        "Fig 13",
        "The energy first rises, then falls with D (at the peak).",
        energy_along("D", rises_then_falls, False),
    ),
    Claim("energy, D, fixed", "Fig 13", "The energy grows with D (at one frequency).", energy_along("D", rises, True)),
    Claim(
        "hump, D, fixed",
        "Fig 13",
        "The energy first rises, then falls with D (at one frequency).",
        energy_along("D", rises_then_falls, True),
    ),
    Claim(
        "energy, G, fixed", "Fig 15", "The energy grows as G falls (at one frequency).", energy_along("G", rises, True)
    ),
    Claim(
        "opposite, stuck",
        "Fig 15, E26",
        "Opposite forces dissipate almost no energy, at most 2.5e-21 J, for each G.",
        opposite_is_nothing,
    ),
)
