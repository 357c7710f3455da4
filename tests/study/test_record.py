"""Data for the report beside a response: references of the mode table."""

from __future__ import annotations

import pytest

from sentences import printed_sentence
from stickslip.results.record import Value
from stickslip.study.record import _beside_reference, _doubtful_order

MODES = (350.0, 415.0, 528.0)


def warnings_with(*reference_hz: float) -> tuple[str, ...]:
    rows: list[dict[str, Value]] = [{"mode": place + 1, "full_hz": frequency} for place, frequency in enumerate(MODES)]
    return _doubtful_order(tuple(_beside_reference(rows, reference_hz)))


def test_references_of_a_test_that_lacks_the_first_mode_are_doubted() -> None:
    (sentence,) = warnings_with(412.0, 530.0)
    printed_sentence(sentence, "reference.mode_frequencies", "412", "530")


@pytest.mark.parametrize("reference_hz", [(0.0, 412.0, 530.0), (300.0, 400.0), (0.0, 0.0, 528.0, 900.0)])
def test_references_in_the_order_of_the_modes_are_not(reference_hz: tuple[float, ...]) -> None:
    assert warnings_with(*reference_hz) == ()


def test_modes_so_close_that_order_is_all_there_is_are_not_doubted() -> None:
    rows: list[dict[str, Value]] = [{"mode": 1, "full_hz": 500.0}, {"mode": 2, "full_hz": 500.5}]
    assert _doubtful_order(tuple(_beside_reference(rows, (500.4, 500.9)))) == ()
