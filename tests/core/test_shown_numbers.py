"""Numbers in words."""

from __future__ import annotations

import pytest

from stickslip.core.shown_numbers import capital, number, raised, typeset, unit_on_page


@pytest.mark.parametrize(
    ("words", "shown"),
    [
        ("8.9e-05 µJ per cycle", "8.9 × 10⁻⁵ µJ per cycle"),
        ("-1e-05 µJ", "−1 × 10⁻⁵ µJ"),
        ("1.2e+07 N/m", "1.2 × 10⁷ N/m"),
        ("below 1e-12 of input", "below 1 × 10⁻¹² of input"),
        ("-4.11 Hz", "−4.11 Hz"),
        ("46.63 to 48.16 µm", "46.63 to 48.16 µm"),
    ],
)
def test_words_with_powers_of_ten(words: str, shown: str) -> None:
    assert raised(words) == shown


def test_a_small_number_has_a_power_of_ten() -> None:
    assert number(8.2e-4) == "8.2 × 10⁻⁴"
    assert number(-0.0082) == "−0.0082"


def test_a_heading_keeps_the_capitals_of_its_names() -> None:
    assert capital("load of Platform A") == "Load of Platform A"
    assert capital("") == ""


def test_a_sentence_of_a_terminal_is_typeset_on_a_page() -> None:
    assert typeset("by up to 0.000755 um, at 2.9e-05 m kg^0.5 and -3 Hz") == (
        "by up to 0.000755 µm, at 2.9 × 10⁻⁵ m √kg and −3 Hz"
    )
    assert unit_on_page("um") == "µm"
    assert unit_on_page("1/um, lump") == "1/µm, lump"
    assert typeset("182 mm2 and 4e+03 N/mm3, but body m2") == "182 mm² and 4 × 10³ N/mm³, but body m2"
    copied = 'sq = "5 um", solver.tolerance = 1e-09, stickslip run --out x-1, 2026-11-26'
    assert typeset(copied) == copied
