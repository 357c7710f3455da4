"""Other solutions on the page and in figures: what a search found, or that it proves nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stickslip.reporting.curve_plot import amplitude_frequency
from stickslip.reporting.figures import amplitude_frequency as figure_of
from stickslip.reporting.page import page
from stickslip.reporting.view import View
from stickslip.results.other_solutions import OtherSolutions
from stickslip.results.response import ForcedResponse
from stickslip.results.tables import study_tables
from synthetic import synthetic_response, synthetic_study

STUDY = synthetic_study(columns=4, rows=3)


def with_search(curves: int) -> ForcedResponse:
    """The curve, and beside it as many closed curves of 1.5 times its motion, the second half of each unstable."""
    response = synthetic_response(columns=4, rows=3, n_points=20)
    count = response.n_points
    found = OtherSolutions(
        tuple(f"closed curve {number + 1}" for number in range(curves)),
        np.ones(curves, dtype=bool),
        np.repeat(np.arange(curves), count),
        np.tile(response.frequency_hz, curves),
        np.tile(1.5 * response.displacement, (curves, 1, 1)),
        np.ones(curves, dtype=bool),
        np.tile(np.arange(count) < count // 2, curves),
        24, 192, 3, 1, 5,
    )  # fmt: skip
    return replace(response, other_solutions=found)


def section(response: ForcedResponse) -> str:
    text = page(response, STUDY)
    return text[text.index("<h2>Other solutions</h2>") :].partition("</section>")[0]


@pytest.mark.slow
def test_the_page_says_what_a_search_found() -> None:
    response = with_search(1)
    top = 1.5e6 * response.amplitude(STUDY.outputs[STUDY.response_output]).max()
    words = section(response)
    assert "from 24 random states" in words
    assert "(seed 3)" in words
    assert "found 1 further curve: closed curve 1 from" in words
    assert "(with stable parts)" in words
    assert f"is {top:.4g} µm at" in words
    assert "1 random states led to no periodic motion" in words


@pytest.mark.slow
def test_the_page_says_how_many_verdicts_of_other_solutions_are_doubtful() -> None:
    response = with_search(1)
    found = response.other_solutions
    assert found is not None
    doubtful = np.arange(response.n_points) < 3
    words = section(replace(response, other_solutions=replace(found, doubtful_points=doubtful)))
    assert f"(with stable parts, stability doubtful at 3 of {response.n_points} points)" in words


@pytest.mark.slow
def test_the_table_of_other_solutions_has_a_column_of_doubtful_verdicts() -> None:
    response = with_search(1)
    found = response.other_solutions
    assert found is not None
    doubtful = np.arange(response.n_points) < 3

    def headings(others: OtherSolutions) -> list[str]:
        tables = study_tables(replace(response, other_solutions=others), STUDY)
        (table,) = (each for each in tables if each.name == "other_solutions")
        return [column.name for column in table.columns]

    assert headings(replace(found, doubtful_points=doubtful))[-1] == "doubtful stability"
    assert "doubtful stability" not in headings(found)


@pytest.mark.slow
def test_the_page_says_that_a_search_without_result_proves_nothing() -> None:
    assert "found no periodic motion off the curve, which proves nothing" in section(with_search(0))


@pytest.mark.slow
def test_without_a_search_the_page_has_no_such_section() -> None:
    assert "<h2>Other solutions</h2>" not in page(replace(with_search(1), other_solutions=None), STUDY)


def test_figures_draw_other_solutions_with_unstable_parts_dashed_under_one_name() -> None:
    response = with_search(2)
    lines = [
        line for line in amplitude_frequency(View.of(response, STUDY))["data"] if line["name"] == "other solutions"
    ]
    assert [line["line"]["dash"] for line in lines] == ["solid", "dash"] * 2
    assert [line["showlegend"] for line in lines] == [True, False, False, False]
    half = response.n_points // 2
    assert len(lines[0]["x"]) == half
    assert len(lines[1]["x"]) == response.n_points - half + 1
    legend = figure_of(response, STUDY).axes[0].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()].count("other solutions") == 1
