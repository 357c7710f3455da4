"""The page of the paper study in a real browser: no error, no request, all pictures, nothing too wide."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from browser_pages import WIDTHS, opened_page, require_readable, tab_stops
from helpers import opened_browser
from paper_curves import curve
from stickslip.papers.rough_damper import figures
from stickslip.papers.rough_damper.choice_items import ChangedVerdict
from stickslip.papers.rough_damper.compute import Failure
from stickslip.papers.rough_damper.items import Item, Picture, peak_table
from stickslip.papers.rough_damper.page import write_page
from stickslip.papers.rough_damper.plan import Setting
from stickslip.papers.rough_damper.verdict_items import REMARKS, JudgedClaim, conclusions_item
from stickslip.papers.rough_damper.verdicts import Answer, Verdict, judge
from stickslip.reporting.templates import StudyText

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with opened_browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("page")
    same, opposite = curve(), curve({"excitation": "opposite"})
    picture = figures.write(folder, "sides", lambda: figures.damper_sides(same, opposite))[-1]
    judged = judge([Answer({"force": "5 N"}, True, "<1 µm")])
    table = peak_table("peaks", "Peaks", [same, opposite])
    picture_words = Picture("sides", "Two <nodes> over a period.", "peaks")
    item = Item("one", "One & only", "Says <this>.", ("A note.",), (table,), (picture_words,), (("Is it?", judged),))
    failures = [Failure(Setting("base", "same", 5.0, 100.0, 2.4, 1e-9, "consistent"), "No <result>.")]
    path = folder / "paper.html"
    write_page(
        path,
        [item],
        {"sides": picture},
        {Verdict.HOLDS: 1},
        failures,
        ("A line.",),
        StudyText("[study]"),
        {"date": "2024-01-01"},
    )
    return path


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
def test_page(browser: Any, report: Path, width: int) -> None:
    with opened_page(browser, report, width, drawn=False) as page:
        assert page.evaluate("[...document.images].every(image => image.complete && image.naturalWidth > 0)")
        assert page.locator("section#one .verdict").inner_text() == "holds"
        assert page.locator("section#one .says").inner_text() == "The paper: Says <this>."
        failed = "base, excitation same with 5 N, F_N 100 N, D 2.4, G 1 × 10⁻⁹ m, law consistent: No <result>."
        assert failed in page.locator(".notice").inner_text().replace("\xa0", " ")
        require_readable(page)


def test_the_keyboard_reaches_items_tables_and_data(browser: Any, report: Path) -> None:
    with opened_page(browser, report, drawn=False) as page:
        stops = tab_stops(page)
        assert [stop["name"] for stop in stops[:2]] == ["doi:10.3390/app13042128", "One & only"]
        names = [stop["name"] for stop in stops]
        assert {"as SVG", "peaks.csv", "Table: Peaks", "The complete study file"} <= set(names)
        page.keyboard.press("Tab")  # the link to the paper
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")  # the link to the item
        assert page.evaluate("location.hash") == "#one"


def test_a_picture_says_what_it_shows_and_where_its_numbers_are(browser: Any, report: Path) -> None:
    with opened_page(browser, report, drawn=False) as page:
        assert page.get_attribute("section#one img", "alt") == "Two <nodes> over a period."
        links = page.eval_on_selector_all("section#one a", "all => all.map(link => link.getAttribute('href'))")
        assert links == ["figures/sides.svg", "tables/peaks.csv", "tables/peaks.csv"]


def test_a_row_of_the_conclusions_is_seen_whole_on_a_common_screen(browser: Any, tmp_path: Path) -> None:
    statement = "The energy first rises, then falls with D (at one frequency)."  # the claim with the longest remark
    numbers = "single excitation, 2 N: " + ", ".join(["12.345"] * 20) + " µJ at 480.3 Hz"
    answers = [Answer({"excitation": name, "force": "5 N"}, name == "same", numbers) for name in ("same", "opposite")]
    judged = judge(answers)
    other = judge(answers[:1])
    choices = ("excitation height 11.01 mm", "friction coefficient 0.15", "centrifugal force 200 N", "preload solved")
    changed = ChangedVerdict(statement, {"base": judged} | dict.fromkeys(choices, other), "")
    place = "Tables 1 and 2, Figure 2: reduction of the model"
    sweeps = {"up": other, "down": judged}
    item = conclusions_item([JudgedClaim(statement, place, judged, sweeps, REMARKS[statement])], [changed])
    path = tmp_path / "paper.html"
    write_page(path, [item], {}, {judged.verdict: 1}, [], (), StudyText("[study]"), {"date": "2024-01-01"})
    with opened_page(browser, path, drawn=False) as page:
        assert "preload solved" in page.locator("section#conclusions td").last.inner_text()
        assert page.evaluate(
            "[...document.querySelectorAll('.scroll')].every(box => box.scrollWidth <= box.clientWidth)"
        )
    with opened_page(browser, path, 400, drawn=False) as page:
        badges = "[...document.querySelectorAll('section#conclusions td:nth-child(2) .verdict')]"
        assert page.evaluate(
            f"{badges}.length === 1 && {badges}.every(one => one.getBoundingClientRect().right <= 400)"
        )
