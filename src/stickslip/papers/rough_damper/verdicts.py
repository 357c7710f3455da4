"""Verdicts computed from numbers: a claim is asked in many situations, and the answers make the verdict.

Nothing here knows the paper; see claims.py for what is asked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

from stickslip.core.errors import InputError

TOLERANCE = 0.01  # chosen: relative difference below which two values count as equal


class Verdict(StrEnum):
    """The verdict on a claim."""

    HOLDS = "holds"
    HOLDS_IF = "holds if"
    DOES_NOT_HOLD = "does not hold"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Answer:
    """A claim in one situation.

    where:
        what the situation is: factor -> value, for example excitation -> same.
    holds:
        whether the claim is true there; None if it does not apply, for example if no pair slips.
    numbers:
        the numbers that decided, in words.
    """

    where: Mapping[str, str]
    holds: bool | None
    numbers: str


@dataclass(frozen=True)
class Judgement:
    """A verdict with its reason and the answers behind it."""

    verdict: Verdict
    reason: str
    answers: tuple[Answer, ...]


def judge(answers: Sequence[Answer]) -> Judgement:
    """holds: in every situation that says something; does not hold: in none; holds if: in some, with the condition.

    The condition is the values of the one factor for which the claim always holds and that cover most. Where no factor
    has such a value, the claim does not hold if it fails in more than half of the situations. Without any situation
    that says something: undecided.
    """
    decided = [answer for answer in answers if answer.holds is not None]
    silent = len(answers) - len(decided)
    rest = f" {silent} more give no answer." if silent else ""
    if not decided:
        return Judgement(Verdict.UNDECIDED, f"No situation of {len(answers)} gives an answer.", tuple(answers))
    good = sum(bool(answer.holds) for answer in decided)
    counts = f"{good} of {len(decided)} situations.{rest}"
    if good == len(decided):
        return Judgement(Verdict.HOLDS, f"In {counts}", tuple(answers))
    if good == 0:
        return Judgement(Verdict.DOES_NOT_HOLD, f"In {counts}", tuple(answers))
    condition = _condition(decided, always=True)
    if condition:
        return Judgement(Verdict.HOLDS_IF, f"Always for {condition}. In {counts}", tuple(answers))
    verdict = Verdict.HOLDS_IF if 2 * good >= len(decided) else Verdict.DOES_NOT_HOLD
    exception = _condition(decided, always=False)
    words = f"Never for {exception}. " if exception else "No single condition decides. "
    return Judgement(verdict, f"{words}In {counts}", tuple(answers))


def _condition(decided: Sequence[Answer], always: bool) -> str:
    """The values of one factor for which the claim always (or never) holds, in words; empty if there is none.

    The factor is the one whose values cover most answers. A value that was asked once only is no condition.
    """
    best, covered = "", 0
    for factor in dict.fromkeys(name for answer in decided for name in answer.where):
        by_value: dict[str, list[bool]] = {}
        for answer in decided:
            by_value.setdefault(answer.where.get(factor, "not given"), []).append(bool(answer.holds) is always)
        clear = [value for value, agrees in by_value.items() if all(agrees) and len(agrees) > 1]
        opposed = [value for value, agrees in by_value.items() if not any(agrees)]
        count = sum(len(by_value[value]) for value in clear)
        if count > covered:
            words = f"{factor} {' or '.join(clear)}"
            if opposed:
                words += f", {'never' if always else 'always'} for {' or '.join(opposed)}"
            if len(clear) + len(opposed) < len(by_value):
                words += ", sometimes otherwise"
            best, covered = words, count
    return best


def falls(values: Sequence[float], tolerance: float = TOLERANCE) -> bool | None:
    """Whether the values fall: no step rises by more than ``tolerance``, and the last is lower than the first by more.

    None where they change by no more than the tolerance altogether. Raises InputError for fewer than two values or a
    negative one.
    """
    if len(values) < 2 or min(values) < 0.0:
        raise InputError("a trend needs two values or more, and none below 0.")
    largest = max(values)
    if largest - min(values) <= tolerance * largest:
        return None
    steps = all(after <= before * (1.0 + tolerance) for before, after in pairwise(values))
    return steps and values[-1] < values[0] * (1.0 - tolerance)


def rises(values: Sequence[float], tolerance: float = TOLERANCE) -> bool | None:
    """The same upward."""
    return falls(list(reversed(values)), tolerance)


def rises_then_falls(values: Sequence[float], tolerance: float = TOLERANCE) -> bool | None:
    """Whether the largest value lies inside, above both ends by more than ``tolerance`` of it; None as in ``falls``."""
    if falls(values, tolerance) is None:
        return None
    if len(values) < 3:
        raise InputError("a rise and a fall need three values or more.")
    largest = max(values)
    place = list(values).index(largest)
    inside = 0 < place < len(values) - 1
    return inside and largest * (1.0 - tolerance) > max(values[0], values[-1])
