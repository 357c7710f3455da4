"""The page of the paper study in a real browser: no error, no request, all pictures, nothing too wide."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from helpers import opened_browser
from paper_curves import curve
from stickslip.paper import figures
from stickslip.paper.compute import Failure
from stickslip.paper.items import Item, peak_table
from stickslip.paper.page import write_page
from stickslip.paper.plan import Setting
from stickslip.paper.verdicts import Answer, Verdict, judge


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
    item = Item("one", "One & only", "Says <this>.", ("A note.",), (table,), ("sides",), (("Is it?", judged),))
    failures = [Failure(Setting("base", "same", 5.0, 100.0, 2.4, 1e-9, "consistent"), "No <result>.")]
    path = folder / "paper.html"
    write_page(path, [item], {"sides": picture}, {Verdict.HOLDS: 1}, failures, "[study]", {"date": "2024-01-01"})
    return path


@pytest.mark.parametrize("width", [1280, 390])
def test_page(browser: Any, report: Path, width: int) -> None:
    page = browser.new_page(viewport={"width": width, "height": 900})
    troubles: list[str] = []
    page.on("console", lambda message: troubles.append(message.text) if message.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.on(
        "request",
        lambda asked: None if asked.url.startswith(("data:", report.as_uri())) else troubles.append(asked.url),
    )
    page.goto(report.as_uri())
    assert page.evaluate("[...document.images].every(image => image.complete && image.naturalWidth > 0)")
    assert page.locator("section#one .verdict").inner_text() == "holds"
    assert page.locator("section#one .says").inner_text() == "The paper: Says <this>."
    assert "No <result>." in page.locator(".notice").inner_text()
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    page.close()
    assert troubles == []
