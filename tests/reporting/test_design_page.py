"""The page of a design: its figures contain curves, path and sharpness; failed designs have their messages."""

from __future__ import annotations

import html
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from browser_pages import LARGEST_PAGE, WIDTHS, opened_page, require_readable
from design_tables import design_result, failed_result
from helpers import opened_browser
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.reporting.design_page import design_page, write_design_page
from stickslip.reporting.templates import StudyText
from stickslip.results.design import DesignResult, agreement_sentence

PROVENANCE = {"date": "2026-01-01T00:00:00+00:00", "stickslip": "0"}


def page_of(result: DesignResult) -> str:
    return design_page(result, "Two <blades>", StudyText("[study]"), PROVENANCE)


def figures_of(result: DesignResult) -> dict[str, Any]:
    match = re.search(r'id="page-figures">(.*?)</script>', page_of(result), flags=re.DOTALL)
    assert match is not None
    figures: dict[str, Any] = json.loads(match.group(1))
    return figures


def named(figure: dict[str, Any], name: str) -> dict[str, Any]:
    return next(trace for trace in figure["data"] if html.unescape(trace["name"]) == name)


def test_curves_of_optimum_and_study_for_each_load_case() -> None:
    figure = figures_of(design_result())["curves"]
    names = [html.unescape(trace["name"]) for trace in figure["data"]]
    loads = ("excitation.mode = single", "excitation.mode = same")
    words = [f"{what}: {load}" for what in ("study", "optimum") for load in loads]
    assert names == [*words, "limit: peak < 0.2 mm"]
    assert max(named(figure, words[-1])["y"]) == pytest.approx(170.0)


def test_the_page_says_which_checks_its_curves_lack() -> None:
    assert "no search for peaks that they missed" in page_of(design_result())


def test_the_path_falls_to_the_optimum_and_omits_what_is_not_allowed() -> None:
    figure = figures_of(design_result())["path"]
    line = named(figure, "best so far")
    assert (line["x"], line["y"]) == ([2, 3, 4, 5], pytest.approx([180.0, 170.0, 170.0, 170.0]))
    assert named(figure, "sample, limit not satisfied")["y"] == pytest.approx([300.0])


def test_the_sharpness_is_a_line_through_the_optimum_without_failed_designs() -> None:
    figure = figures_of(design_result())["key-0"]
    line = named(figure, "through the optimum")
    assert (line["x"], line["y"]) == ([200.0, 235.0, 300.0], pytest.approx([180.0, 170.0, 190.0]))
    assert named(figure, "5 % above the optimum")["y"] == pytest.approx([178.5, 178.5])
    assert named(figure, "optimum")["x"] == [235.0]


def test_the_page_says_what_the_optimum_costs_and_why_designs_failed() -> None:
    text = page_of(design_result())
    assert "none in the range below, 265 N above" in text
    assert "300 µm in the study, −43.3 %" in text
    assert "No result: No &lt;first&gt; point." in text
    assert "A limit is violated: 300 µm instead of at most 200 µm (highest peak)." in text
    assert "The best design has centrifugal force 235 N: highest peak 170 µm in the worst of 2 load cases" in text


def test_one_start_confirms_nothing() -> None:
    words = "There was one start only, so a better optimum is possible"
    agreement = agreement_sentence(design_result())
    assert agreement.startswith(words)
    text = page_of(replace(design_result(), remarks=(agreement,)))
    assert text.index("Before you use this design") < text.index(words) < text.index("<h2>The optimum</h2>")


def test_a_design_without_an_optimum_has_a_page() -> None:
    text = page_of(design_result(best=None))
    assert "<h2>No design satisfies the limits</h2>" in text
    assert "<h2>The nearest design</h2>" in text
    assert "<h2>Against each key</h2>" in text
    assert "optimum" not in text[text.index("<h2>The nearest design</h2>") : text.index("<h2>The study</h2>")]
    assert '<th scope="row">peak &lt; 0.01 mm</th><td>170 µm</td><td>17 times</td>' in text
    assert "Nearest to the limits. A limit is violated: 170 µm instead of at most 10 µm (highest peak)." in text
    assert "best so far" not in json.dumps(figures_of(design_result(best=None)))
    assert set(figures_of(design_result(best=None))) == {"path", "key-0"}


def test_a_design_without_any_result_has_a_page_with_the_reason_of_each() -> None:
    text = page_of(failed_result())
    assert "<h2>No design has a result</h2>" in text
    assert [f"No result: No &lt;first&gt; point of {number}." in text for number in (1, 2, 3)] == [True] * 3
    assert "satisfies the limits" not in text
    assert "How sharp" not in text
    assert figures_of(failed_result()) == {}
    assert repr(failed_result()) == "DesignResult(no design of 3 has a result)"


def test_cautions_on_the_ranges_are_at_the_top() -> None:
    assert "About the ranges" not in page_of(design_result())
    for result in (design_result(cautions=("Friction locks it.",)), design_result(None, ("Friction locks it.",))):
        text = page_of(result)
        assert text.index("About the ranges") < text.index("Friction locks it.") < text.index('scope="row">preload')


def test_a_folder_that_does_not_exist_is_reported(tmp_path: Path) -> None:
    with rejects(InputError):
        write_design_page(tmp_path / "no" / "design.html", design_result(), "t", StudyText(""), PROVENANCE)


@pytest.mark.long
def test_the_page_in_a_browser(tmp_path: Path) -> None:
    path = tmp_path / "design.html"
    write_design_page(path, design_result(), "Two blades", StudyText("[study]"), PROVENANCE)
    assert path.stat().st_size < LARGEST_PAGE
    with opened_browser() as browser:
        for width in WIDTHS:
            with opened_page(browser, path, width) as page:
                require_readable(page)
                assert page.locator(".js-plotly-plot").count() == 3
                page.click("#scale")
                assert page.evaluate("document.getElementById('curves').layout.yaxis.type") == "log"


@pytest.mark.long
def test_the_page_without_results_in_a_browser(tmp_path: Path) -> None:
    path = tmp_path / "design.html"
    write_design_page(path, failed_result(), "Two blades", StudyText("[study]"), PROVENANCE)
    with opened_browser() as browser, opened_page(browser, path, WIDTHS[0]) as page:
        require_readable(page)
        assert page.locator(".js-plotly-plot").count() == 0
        assert not page.locator("#scale").is_visible()
