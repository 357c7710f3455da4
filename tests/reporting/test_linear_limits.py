"""Linear limits that are not the same for all cases of a sweep are told with their range and the reason."""

from __future__ import annotations

import json
import re

import pytest

from helpers import matched
from sentences import printed_sentence
from stickslip.reporting.linear_limits import differing_limits
from stickslip.reporting.sweep_page import sweep_page
from stickslip.reporting.templates import StudyText
from stickslip.results.sweep_table import SweptKey
from sweep_tables import MODE, load_key, sweep_view

LOADS = load_key((100.0, 200.0, 400.0, 800.0))
FREE = [30e-6, 36e-6, 42e-6, 48e-6]
PEAKS = [3e-4, 1e-4, 2e-4, 4e-4]


def test_a_free_limit_that_follows_the_load_is_reported_with_numbers_and_reason() -> None:
    (sentence,) = differing_limits(sweep_view((LOADS,), PEAKS, limits={"stuck": [2e-4] * 4, "free": FREE}))
    printed_sentence(sentence, "preload.centrifugal_force", "damping.modal_damping_ratio")


def test_a_stuck_limit_has_its_own_reason() -> None:
    (sentence,) = differing_limits(
        sweep_view((LOADS,), PEAKS, limits={"stuck": [2e-4, 1.9e-4, 1.8e-4, 1.7e-4], "free": FREE})
    )
    printed_sentence(sentence)


def test_limits_within_one_percent_count_as_one() -> None:
    free = [30e-6, 30.1e-6, 30.2e-6, 30.29e-6]
    assert differing_limits(sweep_view((LOADS,), PEAKS, limits={"stuck": [2e-4] * 4, "free": free})) == ()
    free[-1] = 30.31e-6
    assert len(differing_limits(sweep_view((LOADS,), PEAKS, limits={"stuck": [2e-4] * 4, "free": free}))) == 1


def test_only_cases_that_differ_in_the_joint_alone_are_compared() -> None:
    # alike along the load in either mode, different between the modes of the excitation
    by_mode = [30e-6, 60e-6] * 4
    assert differing_limits(sweep_view((LOADS, MODE), PEAKS * 2, limits={"free": by_mode})) == ()
    density = SweptKey("material.density", "kg/m^3", (1.0, 2.0), (1.0, 2.0), "kg/m^3", ("1", "2"))
    assert differing_limits(sweep_view((density,), PEAKS[:2], limits={"free": FREE[:2]})) == ()
    # the line with the largest range speaks for the others
    mixed = [30e-6, 60e-6, 31e-6, 61e-6, 32e-6, 62e-6, 33e-6, 90e-6]
    (sentence,) = differing_limits(sweep_view((LOADS, MODE), PEAKS * 2, limits={"free": mixed}))
    printed_sentence(sentence)


def test_loads_of_a_face_count_and_its_search_does_not() -> None:
    def along(name: str) -> tuple[str, ...]:
        key = SweptKey(f"interfaces.sole.{name}", "N", (1.0, 2.0), (1.0, 2.0), "N", ("1 N", "2 N"))
        return differing_limits(sweep_view((key,), PEAKS[:2], limits={"free": FREE[:2]}))

    assert len(along("normal_load")) == 1
    assert along("search_distance") == ()


def test_without_damping_linear_peaks_have_no_height_to_compare() -> None:
    view = sweep_view((LOADS,), PEAKS, limits={"free": FREE}, viscous_energy_j=0.0)
    assert differing_limits(view) == ()


def test_the_page_reports_it_and_draws_each_limit_as_a_curve_over_the_load() -> None:
    view = sweep_view((LOADS,), PEAKS, limits={"stuck": [2e-4] * 4, "free": FREE})
    text = sweep_page(view, "Blades", StudyText("[study]"), {"date": "2026-01-01T00:00:00+00:00", "stickslip": "0"})
    assert text.count("The linear limits differ between the cases") == 1
    assert "runs from 30 µm (100 N) to 48 µm (800 N)" in text
    figures = json.loads(matched(r'id="page-figures">(.*?)</script>', text, flags=re.DOTALL).group(1))
    free = next(t for t in figures["performance-load"]["data"] if t["name"] == "linear, no contact")
    assert dict(zip(free["x"], free["y"], strict=True)) == pytest.approx(
        {load: 1e6 * height for load, height in zip(LOADS.values, FREE, strict=True)}
    )
