"""Hostile text in a real browser: nothing of it runs, all of it is read as it is, plots work under the policy."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from browser_pages import opened_page
from helpers import opened_browser
from hostile import (
    PAPER_FIELDS,
    STUDY_FIELDS,
    SWEEP_FIELDS,
    hostile,
    hostile_response,
    hostile_study,
    write_hostile_pages,
)
from stickslip.cli import main as cli
from stickslip.papers.rough_damper.page import DOI
from stickslip.reporting.page import write_page
from stickslip.reporting.sweep_page import write_sweep_page
from stickslip.reporting.templates import StudyText
from stickslip.results.storage import save_results
from sweep_tables import MODE, load_key, sweep_view
from synthetic import synthetic_response, synthetic_study

pytestmark = pytest.mark.slow

PAGES = pytest.mark.parametrize("kind", ["report", "sweep", "paper"])
# What the mouse shows of every trace of every plot at its first point; plotly.js answers once in 50 ms.
_HOVER = """async () => {
  const shown = [];
  for (const plot of document.querySelectorAll('.js-plotly-plot:not(#structure-plot)')) {
    for (const [curve, trace] of plot.data.entries()) {
      if (!trace.x || !trace.x.length) continue;
      const point = {curveNumber: curve, pointNumber: trace.type === 'heatmap' ? [0, 0] : 0};
      Plotly.Fx.hover(plot, [point], (trace.xaxis || 'x') + (trace.yaxis || 'y'));
      await new Promise(done => setTimeout(done, 70));
      shown.push(plot.querySelector('.hoverlayer').textContent);
    }
  }
  return shown.join(' ');
}"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with opened_browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Pages with hostile text in every place, that of a run from its file, and plain ones of a report and a sweep."""
    folder = tmp_path_factory.mktemp("hostile")
    write_hostile_pages(folder)
    save_results(folder / "results.nc", hostile_response(), hostile_study())
    (folder / "again").mkdir()
    (folder / "results.nc").rename(folder / "again" / "results.nc")
    reported = CliRunner().invoke(cli.app, ["report", str(folder / "again")])
    assert reported.exit_code == 0, reported.output
    (folder / "again" / "report.html").rename(folder / "report.html")
    write_page(folder / "plain-report.html", synthetic_response(), synthetic_study())
    view = sweep_view((load_key((100.0, 200.0)), MODE), [1e-4, 2e-4, 3e-4, 4e-4])
    write_sweep_page(folder / "plain-sweep.html", view, "Blades", StudyText("[study]"), {"date": "2026"})
    return folder


@pytest.mark.long
@PAGES
def test_nothing_runs_and_all_text_is_read(browser: Any, folder: Path, kind: str) -> None:
    fields = {"sweep": SWEEP_FIELDS, "paper": PAPER_FIELDS}.get(kind, STUDY_FIELDS)
    with opened_page(browser, folder / f"{kind}.html", drawn=kind != "paper") as page:
        words = page.evaluate("document.documentElement.textContent")
        assert [field for field in fields if hostile(field).replace("_", " ") not in words] == []
        for focusable in page.query_selector_all("[tabindex], button, select, input, a"):
            focusable.focus()
        assert page.evaluate("window.pwned") is None
        assert page.locator("[onclick], [onload], [onerror], [onfocus], [style*='color:red'], img[src=x]").count() == 0
        outside = page.locator("a:not([href^='#']):not([href^=figures]):not([href^=tables]):not([href^=cases])")
        article = [f"https://doi.org/{DOI}"] if kind == "paper" else []  # the one link that a reader may follow
        assert [link.get_attribute("href") for link in outside.all()] == article
        assert page.locator("body script:not([src])").count() == {"report": 9, "sweep": 4, "paper": 1}[kind]


@pytest.mark.long
@pytest.mark.parametrize(("kind", "plots"), [("report", 13), ("sweep", 8)])
def test_plots_show_names_as_they_are(browser: Any, folder: Path, kind: str, plots: int) -> None:
    with opened_page(browser, folder / f"{kind}.html") as page:
        marks = page.eval_on_selector_all(
            ".js-plotly-plot:not(#structure-plot)",
            "all => all.map(plot => plot.querySelectorAll('.scatterlayer .trace, .heatmaplayer .hm').length)",
        )
        assert (len(marks), min(marks) > 0) == (plots, True), marks
        drawn = page.evaluate(
            "[...document.querySelectorAll('.js-plotly-plot text')].map(text => text.textContent).join(' ')"
        )
        names = ["output-2", "output-3"]
        if kind != "sweep":  # the labels of the structure are shortened
            labels = [text[:30] for text in page.locator("#structure-plot .annotation-text").all_text_contents()]
            assert labels == [hostile(name)[:30] for name in ("face-0", "load", "response")]
            assert page.locator("#structure .legend").inner_text().count("<script>window.pwned=1</script>") >= 3
        if kind == "sweep":
            names = ["key-unit", "second-0", "second-1", "third-0", "third-1"]  # numbers of the first key
        assert [name for name in names if hostile(name) not in drawn] == []
        pointed = page.evaluate(_HOVER)
        wanted = ["key-unit", "second-1", "third-1"] if kind == "sweep" else ["face-0", "face-1"]
        assert [name for name in wanted if hostile(name) not in pointed] == []
        marked = page.locator(".js-plotly-plot text a, .js-plotly-plot text tspan[style*='color:red']")
        assert marked.count() == 0
        assert page.evaluate("window.pwned") is None


@pytest.mark.long
def test_a_choice_of_the_reader_shows_names_as_they_are(browser: Any, folder: Path) -> None:
    """The script of the page, too, writes text and no markup."""
    with opened_page(browser, folder / "report.html") as page:
        page.locator("#point").focus()
        page.keyboard.press("Home")
        page.select_option("#pair", "60")
        page.wait_for_function("document.getElementById('point-label').textContent.includes('(1 of 40)')")
        assert page.inner_text("#pair-now").startswith(" ".join(hostile("face-1").split()))
        legend = page.evaluate("document.querySelector('#group-0 .legend').textContent")
        assert hostile("output-2") in legend
        assert page.evaluate("window.pwned") is None


@pytest.mark.long
@pytest.mark.parametrize("kind", ["plain-report", "plain-sweep", "paper"])
def test_the_policy_stops_what_the_page_does_not_carry(browser: Any, folder: Path, kind: str) -> None:
    page = browser.new_page()
    printed: list[str] = []
    page.on("console", lambda message: printed.append(message.text))
    page.goto((folder / f"{kind}.html").as_uri())
    page.evaluate(
        """() => {
          window.pwned = [];
          const script = document.createElement('script');
          script.textContent = 'window.pwned.push("script")';
          document.body.append(script);
          const button = document.createElement('button');
          button.setAttribute('onclick', 'window.pwned.push("click")');
          document.body.append(button);
          button.click();
          const picture = document.createElement('img');
          picture.setAttribute('onerror', 'window.pwned.push("picture")');
          picture.src = 'data:,';
          document.body.append(picture);
          const link = document.createElement('a');
          link.href = 'javascript:window.pwned.push("link")';
          document.body.append(link);
          link.click();
        }"""
    )
    failed = page.evaluate("fetch('https://localhost:9/').then(() => 'asked', error => 'stopped')")
    page.wait_for_timeout(200)
    assert (page.evaluate("window.pwned"), failed) == ([], "stopped")
    assert sum("Content Security Policy" in each for each in printed) >= 5
    page.close()


@pytest.mark.long
@pytest.mark.parametrize(("kind", "plot"), [("plain-report", "curve"), ("plain-sweep", "curves")])
def test_a_plot_is_saved_as_a_picture_and_sent_to_nobody(browser: Any, folder: Path, kind: str, plot: str) -> None:
    with opened_page(browser, folder / f"{kind}.html") as page:
        assert page.locator(".modebar-btn").count() == 0  # plotly's toolbar, with its uploads, covers legends
        settings = page.evaluate(
            "[...document.querySelectorAll('.js-plotly-plot')].map(plot => plot._context.showSendToCloud)"
        )
        assert settings
        assert not any(settings)
        tools = f"#{plot} + .tools"
        with page.expect_download() as waiting:
            page.click(f"{tools} button:has-text('SVG')")
        picture = Path(waiting.value.path()).read_text(encoding="utf-8")
        assert picture.startswith("<svg")
        assert "Excitation frequency, Hz" in picture
        with page.expect_download() as waiting:
            page.click(f"{tools} button:has-text('CSV')")
        rows = list(csv.reader(Path(waiting.value.path()).read_text(encoding="utf-8-sig").splitlines()))
        assert rows[0][0].endswith("Excitation frequency, Hz")
        assert rows[0][1].endswith("Amplitude, 0-to-peak, µm")
        assert float(rows[1][0]) > 0.0


@pytest.mark.long
def test_a_table_is_saved_as_csv(browser: Any, folder: Path) -> None:
    with opened_page(browser, folder / "plain-report.html") as page:
        tables = page.locator(".scroll > table").count()
        assert page.locator(".scroll + .tools button, .scroll > table + .tools button").count() == tables
        with page.expect_download() as waiting:
            page.click(".scroll[aria-label='Measures at the peak'] + .tools button")
        rows = dict(csv.reader(Path(waiting.value.path()).read_text(encoding="utf-8-sig").splitlines()))
        assert rows["Highest peak on the curve: amplitude, 0-to-peak, mean included"].endswith("µm")


@pytest.mark.long
def test_the_contents_lead_to_every_section(browser: Any, folder: Path) -> None:
    with opened_page(browser, folder / "plain-report.html") as page:
        links = page.eval_on_selector_all(".contents a", "all => all.map(each => each.getAttribute('href').slice(1))")
        assert len(links) == page.locator("main section > h2, main section > .heading > h2").count()
        assert all(page.locator(f"[id='{link}']").count() == 1 for link in links)
