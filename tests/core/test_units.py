"""Values with units: conversion to SI, ranges, and sentences about what cannot be read."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.units import Count, Quantity, number_or_text

LENGTH = Quantity("length", shown="mm", above=0.0, at_most=3.0)


@pytest.mark.parametrize(
    ("kind", "text", "expected"),
    [
        ("length", "36.7 mm", 0.0367),
        ("length", "2 µm", 2e-6),
        ("length", "1e-8m", 1e-8),
        ("pressure", "197 GPa", 197e9),
        ("pressure", "3 kN/mm^2", 3e9),
        ("density", "7.8 g/cm^3", 7800.0),
        ("density", "7800 kg m^-3", 7800.0),
        ("stiffness", "130 N/um", 1.3e8),
        ("frequency", "0.44 kHz", 440.0),
        ("angle", "30 deg", math.radians(30.0)),
        ("pure number", "0.1 %", 0.001),
        ("pure number", "0.3", 0.3),
        ("rate", "2 1/ms", 2000.0),
        ("time", "1 us", 1e-6),
        ("force", "-0.5 kN", -500.0),
    ],
)
def test_text_with_unit_becomes_si(kind: str, text: str, expected: float) -> None:
    assert Quantity(kind).parse(text) == pytest.approx(expected, rel=1e-14)


def test_prefix_leaves_no_round_off() -> None:
    assert LENGTH.parse("36.7 mm") == 0.0367


def test_plain_number_is_si() -> None:
    assert LENGTH.parse(0.145) == 0.145
    assert Quantity("force").parse(500) == 500.0


@pytest.mark.parametrize(
    ("quantity", "value"),
    [
        (LENGTH, "145 N"),
        (LENGTH, "145"),
        (LENGTH, "145 foo"),
        (LENGTH, "12 mm(("),
        (LENGTH, "four mm"),
        (LENGTH, ""),
        (LENGTH, True),
        (LENGTH, [1.0]),
        (LENGTH, 145),
        (LENGTH, "0 mm"),
        (LENGTH, math.nan),
        (LENGTH, "inf m"),
        (LENGTH, "1e400 m"),
        (LENGTH, 10**400),
        (Quantity("frequency"), "60 rpm"),
        (Quantity("frequency"), "60 rad/s"),
        (Quantity("pure number"), "3 N"),
        (Quantity("angle", below=math.pi / 2.0, shown="deg"), "95 deg"),
    ],
)
def test_rejection_is_a_sentence(quantity: Quantity, value: object) -> None:
    with rejects(InputError):
        quantity.parse(value)


def test_open_bounds_are_rejected_and_closed_ones_allowed() -> None:
    dimension = Quantity("pure number", above=2.0, below=3.0)
    for value in (2, 3.0, 1.9):
        with rejects(InputError):
            dimension.parse(value)
    assert Quantity("pure number", at_least=0.0, at_most=1.0).parse(0) == 0.0
    assert Quantity("pure number", at_least=0.0, at_most=1.0).parse(1) == 1.0


def test_required_unit() -> None:
    roughness = Quantity("length", unit_required="Papers leave it out.")
    with rejects(InputError):
        roughness.parse(1e-8)
    assert roughness.parse("1e-8 m") == 1e-8
    assert roughness.parse("1e-8 mm") == 1e-11


def test_count() -> None:
    elements = Count(at_least=1, at_most=10)
    assert elements.parse(10) == 10
    for value in (0, 11, 3.0, "3", True, None):
        with rejects(InputError):
            elements.parse(value)


@given(st.floats(min_value=1e-12, max_value=3.0))
def test_stored_value_is_read_back_exactly(value: float) -> None:
    assert LENGTH.parse(LENGTH.stored(value)) == value


@given(st.floats(min_value=1e-12, max_value=3.0))
def test_shown_value_is_read_back_to_15_digits(value: float) -> None:
    assert LENGTH.parse(LENGTH.text(value).strip('"')) == pytest.approx(value, rel=1e-14)


@pytest.mark.long
@settings(max_examples=300)
@given(st.text(max_size=12) | st.text("mNkgs*/^-+12 nafiNAF%µ(", max_size=8))
def test_any_text_is_read_or_rejected(text: str) -> None:
    try:
        value = LENGTH.parse(f"1 {text}")
    except InputError:
        return
    assert 0.0 < value <= 3.0


@pytest.mark.parametrize(
    ("part", "value"), [("3", 3), ("-2", -2), ("3.0", 3.0), ("1e3", 1000.0), ("3 mm", "3 mm"), ("same", "same")]
)
def test_a_text_is_the_number_that_it_is_in_toml(part: str, value: object) -> None:
    """A key for whole numbers accepts no 3.0."""
    found = number_or_text(part)
    assert found == value
    assert type(found) is type(value)
