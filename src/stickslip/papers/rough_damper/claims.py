"""The paper's claims about the vibration, each asked of a set of solved curves; the numbers give the answer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from stickslip.papers.rough_damper.plan import EXCITATIONS
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.verdicts import Answer, Judgement, falls, judge, rises, rises_then_falls

Solutions = Sequence[Solved]
# Friction energy below this fraction of the input energy counts as zero: the energy balance is not more accurate.
NO_ENERGY = 1e-3
MICRO = 1e6


@dataclass(frozen=True)
class Claim:
    """A claim in our words, where the paper makes it, and what decides it."""

    name: str
    place: str
    statement: str
    ask: Callable[[Solutions], list[Answer]]

    def judged(self, solutions: Solutions) -> Judgement:
        """The verdict on it by these curves."""
        return judge(self.ask(solutions))


def friction_energy(one: Solved) -> float:
    """J per cycle at the peak, 0 if it is below the accuracy of the energy balance."""
    energy = one.numbers["friction_energy_j"]
    return energy if energy > NO_ENERGY * one.numbers["input_energy_j"] else 0.0


def energy_at(one: Solved, frequency_hz: float) -> float:
    """J per cycle at a fixed frequency, the largest branch; 0 below the accuracy of the energy balance, or outside the
    curve."""
    f, energy = one.frequency_hz, one.energy_j
    low, high = np.minimum(f[:-1], f[1:]), np.maximum(f[:-1], f[1:])
    segments = np.flatnonzero((low <= frequency_hz) & (frequency_hz <= high) & (high > low))
    share = (frequency_hz - f[segments]) / (f[segments + 1] - f[segments])
    values = energy[segments] + share * (energy[segments + 1] - energy[segments])
    largest = float(values.max()) if values.size else 0.0
    return largest if largest > NO_ENERGY * one.numbers["viscous_energy_j"] else 0.0


def moving(one: Solved) -> float:
    """Pairs that slip or open at the peak."""
    return one.numbers["stick_slip"] + one.numbers["separating"]


def where(one: Solved, *without: str) -> dict[str, str]:
    """The situation of a curve in words, without the named factors."""
    s = one.setting
    words = {
        "excitation": s.excitation,
        "force": f"{s.force:g} N",
        "F_N": f"{s.load:g} N",
        "law": s.law,
        "D": f"{s.dimension:g}",
        "G": f"{s.scale:g} m",
    }
    return {name: value for name, value in words.items() if name not in without}


def series(solutions: Solutions, along: str) -> Iterator[list[Solved]]:
    """Lines of three curves or more that differ in D alone (rising) or in G alone (falling): all grow stiffer."""
    groups: dict[tuple[object, ...], list[Solved]] = {}
    for one in solutions:
        s = one.setting
        fixed = s.scale if along == "D" else s.dimension
        groups.setdefault((s.choice, s.excitation, s.force, s.load, s.law, fixed), []).append(one)
    for group in groups.values():
        if len(group) >= 3:
            yield sorted(group, key=lambda one: one.setting.dimension if along == "D" else -one.setting.scale)


Trend = Callable[[Sequence[float]], bool | None]
Measure = Callable[[Solved], float]


def along_series(along: str, measure: Measure, trend: Trend, factor: float, unit: str) -> Callable[..., list[Answer]]:
    """Asks whether a measure follows a trend along every series of D or G."""

    def ask(solutions: Solutions) -> list[Answer]:
        answers = []
        for line in series(solutions, along):
            values = [measure(one) for one in line]
            first, last = (f"{getattr(one.setting, _FIELD[along]):g}" for one in (line[0], line[-1]))
            shown = ", ".join(f"{factor * value:.3g}" for value in values)
            answers.append(Answer(where(line[0], along), trend(values), f"{along} {first} to {last}: {shown} {unit}"))
        return answers

    return ask


_FIELD = {"D": "dimension", "G": "scale"}


def energy_along(along: str, trend: Trend, fixed: bool) -> Callable[..., list[Answer]]:
    """The friction energy at the peak of each curve, or at one frequency for all: the peak of the first, the middle or
    the last curve of the series."""

    def ask(solutions: Solutions) -> list[Answer]:
        answers = []
        for line in series(solutions, along):
            if not fixed:
                answers.append(_energy_answer([friction_energy(one) for one in line], line, along, trend, "the peak"))
                continue
            for name, frequency_hz in fixed_frequencies(line).items():
                values = [energy_at(one, frequency_hz) for one in line]
                answer = _energy_answer(values, line, along, trend, f"{frequency_hz:.1f} Hz")
                answers.append(replace(answer, where={"frequency fixed at": name, **answer.where}))
        return answers

    return ask


def fixed_frequencies(line: Sequence[Solved]) -> dict[str, float]:
    """The paper does not say which frequency it holds, so three are tried: the peaks of three curves of the series."""
    chosen = {"softest": line[0], "middle": line[len(line) // 2], "stiffest": line[-1]}
    return {f"the {name} curve's peak": one.numbers["peak_hz"] for name, one in chosen.items()}


def _energy_answer(values: Sequence[float], line: Sequence[Solved], along: str, trend: Trend, at: str) -> Answer:
    holds = trend(values) if max(values) > 0.0 else None
    shown = ", ".join(f"{MICRO * value:.3g}" for value in values)
    return Answer(where(line[0], along), holds, f"{shown} µJ at {at}")


def by_excitation(solutions: Solutions) -> Iterator[dict[str, Solved]]:
    """The three excitations of curves that are alike otherwise."""
    groups: dict[object, dict[str, Solved]] = {}
    for one in solutions:
        s = one.setting
        groups.setdefault((s.choice, s.force, s.load, s.dimension, s.scale, s.law), {})[s.excitation] = one
    yield from (group for group in groups.values() if len(group) == len(EXCITATIONS))


def same_is_largest(measure: Measure, factor: float, unit: str) -> Callable[..., list[Answer]]:
    """Asks whether the same direction has the largest value of the three excitations."""

    def ask(solutions: Solutions) -> list[Answer]:
        answers = []
        for group in by_excitation(solutions):
            values = {name: measure(group[name]) for name in EXCITATIONS}
            others = max(values["single"], values["opposite"])
            holds = None if values["same"] == others else values["same"] > others
            shown = ", ".join(f"{name} {factor * value:.3g}" for name, value in values.items())
            answers.append(Answer(where(group["same"], "excitation"), holds, f"{shown} {unit}"))
        return answers

    return ask


def between(
    factor_name: str, holds: Callable[[Solved, Solved], bool | None], show: Callable[[Solved], str]
) -> Callable[..., list[Answer]]:
    """Asks of all pairs of curves that differ in the force or the load alone: smaller value first."""

    def ask(solutions: Solutions) -> list[Answer]:
        groups: dict[object, list[Solved]] = {}
        for one in solutions:
            s = one.setting
            other = s.load if factor_name == "force" else s.force
            groups.setdefault((s.choice, s.excitation, other, s.dimension, s.scale, s.law), []).append(one)
        answers = []
        for group in groups.values():
            group.sort(key=lambda one: float(getattr(one.setting, factor_name)))
            label = "F_N" if factor_name == "load" else "force"
            for low, high in pairwise(group):
                values = [f"{getattr(one.setting, factor_name):g} N: {show(one)}" for one in (low, high)]
                answers.append(Answer(where(low, label), holds(low, high), "; ".join(values)))
        return answers

    return ask


def _two_peaks(solutions: Solutions) -> list[Answer]:
    answers = []
    for group in by_excitation(solutions):
        peak_list = group["single"].peaks()
        holds = len(peak_list) >= 2 and peak_list[0][1] > max(amplitude for _, amplitude in peak_list[1:])
        shown = "; ".join(f"{f:.1f} Hz {MICRO * a:.3g} µm" for f, a in peak_list)
        answers.append(Answer(where(group["single"], "excitation"), holds, f"single excitation: {shown}"))
    return answers


def _peaks_of_both_directions(solutions: Solutions) -> list[Answer]:
    answers = []
    for group in by_excitation(solutions):
        peak_list = group["single"].peaks()
        same, opposite = (group[name].numbers["peak_hz"] for name in ("same", "opposite"))
        holds = (
            len(peak_list) >= 2
            and abs(peak_list[0][0] / same - 1.0) < 0.02
            and abs(peak_list[-1][0] / opposite - 1.0) < 0.02
        )
        single = ", ".join(f"{f:.1f}" for f, _ in peak_list)
        numbers = f"single {single} Hz; same {same:.1f} Hz; opposite {opposite:.1f} Hz"
        answers.append(Answer(where(group["single"], "excitation"), holds, numbers))
    return answers


def _fractions(one: Solved) -> str:
    translation, rotation, deformation = 100.0 * np.asarray(one.shares)
    name = one.setting.excitation
    return f"{name}: translation {translation:.1f} %, rotation {rotation:.1f} %, deformation {deformation:.2g} %"


def _dominated_by(excitation: str, part: int) -> Callable[..., list[Answer]]:
    def ask(solutions: Solutions) -> list[Answer]:
        chosen = [one for one in solutions if one.setting.excitation == excitation]
        return [Answer(where(one, "excitation"), bool(one.shares[part] > 0.5), _fractions(one)) for one in chosen]

    return ask


def _all_states(solutions: Solutions) -> list[Answer]:
    answers = []
    for one in solutions:
        phases = np.asarray(one.phase_state)
        seen = np.stack([(phases == code).any(axis=1) for code in range(3)])
        counts = f"{one.numbers['stuck']:g} / {one.numbers['stick_slip']:g} / {one.numbers['separating']:g}"
        answers.append(
            Answer(where(one), bool(seen.all(axis=0).any()), f"stuck / stick-slip / separating pairs {counts}")
        )
    return answers


def _moves_left(solutions: Solutions) -> list[Answer]:
    answers = []
    for one in solutions:
        if moving(one) == 0.0:
            continue
        shift = one.numbers["peak_hz"] - one.numbers["stuck_peak_hz"]
        holds = None if abs(shift) < 0.05 else shift < 0.0
        answers.append(Answer(where(one), holds, f"{shift:+.2f} Hz from the linear stuck peak"))
    return answers


def reduction(one: Solved) -> float:
    """1 - peak / linear stuck peak: the reduction by friction."""
    return 1.0 - one.numbers["peak_m"] / one.numbers["stuck_peak_m"]


def _compare(measure: Measure, margin: float) -> Callable[[Solved, Solved], bool | None]:
    """The value at the smaller load is the larger one; None where the two are alike."""

    def holds(low: Solved, high: Solved) -> bool | None:
        difference = measure(low) - measure(high)
        return None if abs(difference) <= margin else difference > 0.0

    return holds


def _fewer_stuck_at_high_force(low: Solved, high: Solved) -> bool | None:
    difference = low.numbers["stuck"] - high.numbers["stuck"]
    return None if difference == 0.0 else difference > 0.0


def _opposite_is_nothing(solutions: Solutions) -> list[Answer]:
    chosen = [one for line in series(solutions, "G") for one in line if one.setting.excitation == "opposite"]
    answers = []
    for one in chosen:
        energy = one.numbers["friction_energy_j"]
        numbers = f"{one.numbers['stuck']:g} pairs stuck, friction energy {energy:.3g} J"
        answers.append(Answer(where(one, "excitation"), bool(energy <= 2.5e-21), numbers))
    return answers


def _state_words(one: Solved) -> str:
    n = one.numbers
    return f"{n['stuck']:g} stuck, {n['stick_slip']:g} stick-slip, {n['separating']:g} separating"


CLAIMS = (
    Claim(
        "translation",
        "Fig 9, conclusion 1",
        "Same direction moves the damper as a translation.",
        _dominated_by("same", 0),
    ),
    Claim("rotation", "Fig 9, conclusion 1", "Opposite directions rotate the damper.", _dominated_by("opposite", 1)),
    Claim(
        "three states", "Figs 7, 8, conclusion 1", "A pair sticks, slips and separates within one period.", _all_states
    ),
    Claim(
        "load, slip",
        "conclusion 2",
        "A smaller centrifugal force lets more pairs slip or open.",
        between("load", _compare(moving, 0.5), _state_words),
    ),
    Claim(
        "load, suppression",
        "conclusion 2",
        "A larger centrifugal force weakens the reduction of the peak by friction.",
        between("load", _compare(reduction, 0.01), lambda one: f"{100 * reduction(one):.1f} % off the stuck peak"),
    ),
    Claim(
        "force, slip",
        "Figs 10, 11",
        "5 N leaves fewer pairs stuck than 2 N.",
        between("force", _fewer_stuck_at_high_force, _state_words),
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
    Claim("two peaks", "Fig 12", "One force gives two peaks, the first the higher one.", _two_peaks),
    Claim("peak pairs", "Fig 12", "Its peaks are those of same and of opposite forces.", _peaks_of_both_directions),
    Claim("left shift", "Figs 12, 14", "Where pairs slip or open, the peak lies below the stuck one.", _moves_left),
    Claim(
        "peak, D",
        "Fig 12, conclusion 4",
        "The peak falls as D grows.",
        along_series("D", lambda one: one.numbers["peak_m"], falls, MICRO, "µm"),
    ),
    Claim(
        "peak, G",
        "Fig 14, conclusion 4",
        "The peak falls as G falls.",
        along_series("G", lambda one: one.numbers["peak_m"], falls, MICRO, "µm"),
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
        _opposite_is_nothing,
    ),
)
