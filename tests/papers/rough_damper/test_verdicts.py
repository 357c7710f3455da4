"""Verdicts from synthetic answers and trends from synthetic series."""

from __future__ import annotations

import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.papers.rough_damper.verdicts import Answer, Verdict, falls, judge, rises, rises_then_falls


def answer(holds: bool | None, **where: str) -> Answer:
    return Answer(where, holds, "numbers")


def test_holds_in_every_situation() -> None:
    judged = judge([answer(True, force="5 N"), answer(True, force="2 N"), answer(None, force="1 N")])
    assert judged.verdict is Verdict.HOLDS
    assert judged.reason == "In 2 of 2 situations. 1 more give no answer."
    assert len(judged.answers) == 3


def test_does_not_hold_in_any_situation() -> None:
    judged = judge([answer(False, force="5 N"), answer(False, force="2 N")])
    assert (judged.verdict, judged.reason) == (Verdict.DOES_NOT_HOLD, "In 0 of 2 situations.")


def test_holds_if_names_the_factor_that_decides() -> None:
    answers = [
        answer(excitation == "same", force=force, excitation=excitation)
        for force in ("5 N", "2 N")
        for excitation in ("same", "opposite")
    ]
    judged = judge(answers)
    assert judged.verdict is Verdict.HOLDS_IF
    assert judged.reason == "Always for excitation same, never for opposite. In 2 of 4 situations."


def test_holds_if_where_other_values_are_mixed() -> None:
    answers = [answer(True, force="5 N")] * 2 + [answer(True, force="2 N"), answer(False, force="2 N")]
    judged = judge(answers)
    assert judged.verdict is Verdict.HOLDS_IF
    assert judged.reason == "Always for force 5 N, sometimes otherwise. In 3 of 4 situations."


@pytest.mark.parametrize(
    ("good", "verdict"), [(3, Verdict.HOLDS_IF), (2, Verdict.HOLDS_IF), (1, Verdict.DOES_NOT_HOLD)]
)
def test_without_a_condition_the_majority_counts(good: int, verdict: Verdict) -> None:
    # a value that is asked once is no condition
    judged = judge([answer(place < good, number=str(place)) for place in range(4)])
    assert judged.verdict is verdict
    assert judged.reason == f"No single condition decides. In {good} of 4 situations."


def test_without_a_condition_for_it_the_values_against_it_are_reported() -> None:
    answers = [answer(place < 3, excitation="same") for place in range(4)] + [answer(False, excitation="opposite")] * 2
    judged = judge(answers)
    assert judged.verdict is Verdict.HOLDS_IF
    assert judged.reason == "Never for excitation opposite, sometimes otherwise. In 3 of 6 situations."


@pytest.mark.parametrize("answers", [[], [answer(None)]])
def test_undecided_where_nothing_is_reported(answers: list[Answer]) -> None:
    assert judge(answers).verdict is Verdict.UNDECIDED


@pytest.mark.parametrize(
    ("values", "fall", "rise", "hump"),
    [
        ((3.0, 2.0, 1.0), True, False, False),
        ((1.0, 2.0, 3.0), False, True, False),
        ((1.0, 3.0, 2.0), False, False, True),
        ((3.0, 1.0, 2.0), False, False, False),
        ((1.0, 1.005, 0.995), None, None, None),  # a change of 1 % is none
        ((0.0, 0.0, 0.0), None, None, None),
        ((2.0, 2.01, 1.0), True, False, False),  # a step up within the tolerance
        ((2.0, 2.1, 1.0), False, False, True),
    ],
)
def test_trends(values: tuple[float, ...], fall: bool | None, rise: bool | None, hump: bool | None) -> None:
    assert (falls(values), rises(values), rises_then_falls(values)) == (fall, rise, hump)


def test_trends_reject_what_is_no_series() -> None:
    with rejects(InputError):
        falls([1.0])
    with rejects(InputError):
        rises([1.0, -1.0])
    with rejects(InputError):
        rises_then_falls([1.0, 2.0])
