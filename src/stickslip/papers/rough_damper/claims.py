"""How a claim is asked of a set of solved curves: measures, series, and questions; the numbers give the answer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from stickslip.papers.rough_damper.plan import EXCITATIONS
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.verdicts import Answer, Judgement, judge

Solutions = Sequence[Solved]
# Friction energy below this fraction of the input energy counts as zero: the energy balance is not more accurate.
NO_ENERGY = 1e-3
MICRO = 1e6


@dataclass(frozen=True)
class Claim:
    """A claim in our words, where the paper makes it, and what decides it.

    ``beside`` are questions whose verdicts stand beside that of the claim, because it mixes several effects.
    """

    name: str
    place: str
    statement: str
    ask: Callable[[Solutions], list[Answer]]
    beside: tuple[tuple[str, Callable[[Solutions], list[Answer]]], ...] = ()

    def judged(self, solutions: Solutions) -> Judgement:
        """The verdict on it by these curves."""
        return judge(self.ask(solutions))

    def beside_words(self, solutions: Solutions) -> str:
        """The verdicts of the questions beside it, in words."""
        judged = [(words, judge(ask(solutions))) for words, ask in self.beside]
        return " ".join(f"{words}: {each.verdict.value} ({each.reason.rstrip('.')})." for words, each in judged)


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


def along_series(
    along: str, measure: Measure, trend: Trend, factor: float, unit: str, beside: tuple[str, Measure] | None = None
) -> Callable[..., list[Answer]]:
    """Asks whether a measure follows a trend along every series of D or G.

    ``beside`` is the name of another measure in the same unit, and the measure, whose values the numbers show too.
    """

    def ask(solutions: Solutions) -> list[Answer]:
        answers = []
        for line in series(solutions, along):
            values = [measure(one) for one in line]
            first, last = (f"{getattr(one.setting, _FIELD[along]):g}" for one in (line[0], line[-1]))
            shown = f"{_listed(values, factor)} {unit}"
            if beside is not None:
                name, other = beside
                shown += f"; {name} {_listed([other(one) for one in line], factor)} {unit}"
            answers.append(Answer(where(line[0], along), trend(values), f"{along} {first} to {last}: {shown}"))
        return answers

    return ask


def _listed(values: Sequence[float], factor: float) -> str:
    return ", ".join(f"{factor * value:.3g}" for value in values)


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


def two_peaks(solutions: Solutions) -> list[Answer]:
    """Asks whether one force gives two peaks or more, the first the highest."""
    answers = []
    for group in by_excitation(solutions):
        peak_list = group["single"].peaks()
        holds = len(peak_list) >= 2 and peak_list[0][1] > max(amplitude for _, amplitude in peak_list[1:])
        shown = "; ".join(f"{f:.1f} Hz {MICRO * a:.3g} µm" for f, a in peak_list)
        answers.append(Answer(where(group["single"], "excitation"), holds, f"single excitation: {shown}"))
    return answers


def peaks_of_both_directions(solutions: Solutions) -> list[Answer]:
    """Asks whether the peaks of one force lie within 2 % of those of same and of opposite forces."""
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


def fractions(one: Solved) -> str:
    """Translation, rotation and deformation of the damper, in words."""
    translation, rotation, deformation = 100.0 * np.asarray(one.shares)
    name = one.setting.excitation
    return f"{name}: translation {translation:.1f} %, rotation {rotation:.1f} %, deformation {deformation:.2g} %"


def dominated_by(excitation: str, part: int) -> Callable[..., list[Answer]]:
    """Asks whether one part of the motion of the damper is more than a half of it under an excitation."""

    def ask(solutions: Solutions) -> list[Answer]:
        chosen = [one for one in solutions if one.setting.excitation == excitation]
        return [Answer(where(one, "excitation"), bool(one.shares[part] > 0.5), fractions(one)) for one in chosen]

    return ask


def all_states(solutions: Solutions) -> list[Answer]:
    """Asks whether one pair is in all three states within a period."""
    answers = []
    for one in solutions:
        phases = np.asarray(one.phase_state)
        seen = np.stack([(phases == code).any(axis=1) for code in range(3)])
        counts = f"{one.numbers['stuck']:g} / {one.numbers['stick_slip']:g} / {one.numbers['separating']:g}"
        answers.append(
            Answer(where(one), bool(seen.all(axis=0).any()), f"stuck / stick-slip / separating pairs {counts}")
        )
    return answers


def moves_left(solutions: Solutions) -> list[Answer]:
    """Asks whether the peak lies below the linear stuck peak where pairs move."""
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


def compare(measure: Measure, margin: float) -> Callable[[Solved, Solved], bool | None]:
    """The value at the smaller load is the larger one; None where the two are alike."""

    def holds(low: Solved, high: Solved) -> bool | None:
        difference = measure(low) - measure(high)
        return None if abs(difference) <= margin else difference > 0.0

    return holds


def fewer_stuck_at_high_force(low: Solved, high: Solved) -> bool | None:
    """Fewer pairs are stuck at the larger value; None where the numbers are equal."""
    difference = low.numbers["stuck"] - high.numbers["stuck"]
    return None if difference == 0.0 else difference > 0.0


def opposite_is_nothing(solutions: Solutions) -> list[Answer]:
    """Asks whether opposite forces dissipate at most 2.5e-21 J."""
    chosen = [one for line in series(solutions, "G") for one in line if one.setting.excitation == "opposite"]
    answers = []
    for one in chosen:
        energy = one.numbers["friction_energy_j"]
        numbers = f"{one.numbers['stuck']:g} pairs stuck, friction energy {energy:.3g} J"
        answers.append(Answer(where(one, "excitation"), bool(energy <= 2.5e-21), numbers))
    return answers


def state_words(one: Solved) -> str:
    """The pairs in each state, in words."""
    n = one.numbers
    return f"{n['stuck']:g} stuck, {n['stick_slip']:g} stick-slip, {n['separating']:g} separating"
