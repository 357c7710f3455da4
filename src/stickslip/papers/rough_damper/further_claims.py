"""Questions that compare peaks of one curve, runs of one study, and the motion under two excitations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from stickslip.papers.rough_damper.claims import (
    MICRO,
    Measure,
    Solutions,
    between,
    by_excitation,
    fractions,
    series,
    where,
)
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.verdicts import Answer, falls

# chosen, because the paper gives no numbers: a "small" second peak is below this fraction of the first, and one that
# "did not change much" changes by less than this fraction of its largest value.
SMALL, STEADY = 0.5, 0.1


def _two_peaks(one: Solved) -> tuple[float, float] | None:
    """m, the first and the last peak by frequency; None with less than two."""
    tops = one.peaks()
    return (tops[0][1], tops[-1][1]) if len(tops) >= 2 else None


def second_peak_is_small(solutions: Solutions) -> list[Answer]:
    """Asks whether the last peak of one force is less than SMALL of the first; no answer with one peak only."""
    answers = []
    for one in solutions:
        if one.setting.excitation != "single":
            continue
        both = _two_peaks(one)
        numbers = "one peak only" if both is None else ", ".join(f"{MICRO * height:.3g}" for height in both) + " µm"
        answers.append(Answer(where(one, "excitation"), None if both is None else both[1] < SMALL * both[0], numbers))
    return answers


def second_peak_is_steady(solutions: Solutions) -> list[Answer]:
    """Asks whether the last peak of one force changes along D by less than STEADY; no answer where a curve has one."""
    answers = []
    for line in series([one for one in solutions if one.setting.excitation == "single"], "D"):
        heights = [both[1] for both in map(_two_peaks, line) if both is not None]
        complete = len(heights) == len(line)
        shown = ", ".join(f"{MICRO * height:.3g}" for height in heights)
        holds = max(heights) - min(heights) < STEADY * max(heights) if complete else None
        situation = where(line[0], "excitation", "D")
        answers.append(Answer(situation, holds, f"{shown} µm" if complete else "a curve with one peak only"))
    return answers


def same_trend_in_every_run(measure: Measure) -> Callable[..., list[Answer]]:
    """Asks whether a measure falls in every run, or in none: of series that differ in force and load alone.

    Series where it changes by less than the tolerance give no answer, and one run is no comparison.
    """

    def ask(solutions: Solutions) -> list[Answer]:
        groups: dict[tuple[str, ...], list[tuple[Solved, bool]]] = {}
        for along in ("D", "G"):
            for line in series(solutions, along):
                one, trend = line[0], falls([measure(each) for each in line])
                fixed = one.setting.scale if along == "D" else one.setting.dimension
                key = (one.setting.choice, one.setting.excitation, one.setting.law, f"{fixed:g}", along)
                if trend is not None:
                    groups.setdefault(key, []).append((one, trend))
        answers = []
        for (*_, along), runs in groups.items():
            words = "; ".join(
                f"{one.setting.force:g} N, F_N {one.setting.load:g} N: {'falls' if trend else 'does not fall'}"
                for one, trend in runs
            )
            holds = len({trend for _, trend in runs}) == 1 if len(runs) > 1 else None
            answer = Answer(where(runs[0][0], "force", "F_N", along), holds, words)
            answers.append(replace(answer, where={"along": along, **answer.where}))
        return answers

    return ask


def more_separate_at_high_force(solutions: Solutions) -> list[Answer]:
    """Asks whether more pairs separate at the larger force; no answer where the numbers are equal."""

    def holds(low: Solved, high: Solved) -> bool | None:
        difference = high.numbers["separating"] - low.numbers["separating"]
        return None if difference == 0.0 else difference > 0.0

    return between("force", holds, lambda one: f"{one.numbers['separating']:g} separating")(solutions)


def rotation_is_of_opposite_forces(solutions: Solutions) -> list[Answer]:
    """Asks whether rotation is a larger part of the damper's motion under opposite forces than in the same direction.

    No answer where the parts differ by less than 1 % of the motion.
    """
    answers = []
    for group in by_excitation(solutions):
        same, opposite = group["same"], group["opposite"]
        difference = float(opposite.shares[1] - same.shares[1])
        numbers = f"{fractions(same)}; {fractions(opposite)}"
        holds = None if abs(difference) < 0.01 else difference > 0.0
        answers.append(Answer(where(same, "excitation"), holds, numbers))
    return answers


def rotation_words(solutions: Solutions) -> str:
    """How much of the damper's motion is rotation in the same direction and under opposite forces, with numbers."""
    spans = []
    for excitation in ("same", "opposite"):
        parts = [100.0 * float(one.shares[1]) for one in solutions if one.setting.excitation == excitation]
        if not parts:
            return ""
        spans.append((min(parts), max(parts)))
    (low, _), (_, most) = spans
    same, other = (f"{round(start, 1):g} to {round(stop, 1):g} %" for start, stop in spans)
    words = f"Rotation is {same} of the motion in the same direction, and {other} under opposite forces"
    return f"{words}: the inverse of the picture in the paper." if low > most else f"{words}."
