"""The page on paper: what Chromium writes as PDF."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from browser_pages import opened_page
from helpers import opened_browser
from stickslip.reporting.page import write_page
from synthetic import synthetic_response, synthetic_study

pytestmark = pytest.mark.slow

MARGIN_PT = 14.0 / 25.4 * 72.0  # of @page in page.css
WIDTH_PX = 703  # of A4 without the margins, 702.99 px, as Chromium rounds it
# The heading of each section that begins with a plot, and the height of the plot in px.
_PLOTS = """() => Array.from(document.querySelectorAll('main section'), section => [
  section.querySelector('h2, h3').textContent, section.querySelector('.js-plotly-plot:not(#structure-plot)'),
]).filter(([, plot]) => plot).map(([heading, plot]) => [heading, plot.offsetHeight])"""


def heights_of_headings(pdf: bytes) -> dict[str, float]:
    """Heading -> pt above the lower edge of its page, from the outline of a PDF."""
    entries = re.findall(rb"/Title \(([^)]*)\)\s*/Dest \[\d+ 0 R /XYZ [\d.]+ ([\d.]+)", pdf)
    return {title.decode("latin-1"): float(height) for title, height in entries}


@pytest.mark.long
def test_a_heading_stays_on_the_page_of_its_first_plot(tmp_path: Path) -> None:
    report = tmp_path / "report.html"
    write_page(report, synthetic_response(), synthetic_study())
    with opened_browser() as browser, opened_page(browser, report) as page:
        plots = dict(page.evaluate(_PLOTS))
        page.pdf(path=tmp_path / "report.pdf", prefer_css_page_size=True, tagged=True, outline=True)
    heights = heights_of_headings((tmp_path / "report.pdf").read_bytes())
    checked = {heading: heights[heading] for heading in plots if heading in heights}
    assert {"Amplitude against frequency", "Contact states", "Motion over one period"} <= checked.keys()
    for heading, height in checked.items():
        # maps in two columns are smaller on paper
        assert height - MARGIN_PT >= 0.6 * plots[heading], f"{heading}: its plot is on the next page"


# Of the figure of signals, px below its upper edge: end of the upper plot, legend from ... to, begin of the lower plot.
_BETWEEN = """() => {
  const plot = document.getElementById('signals'), look = plot._fullLayout, size = look._size;
  const legend = plot.querySelector('.legend2').getBoundingClientRect(), edge = plot.getBoundingClientRect().top;
  const down = (fraction) => size.t + (1 - fraction) * size.h;
  return [down(look.yaxis.domain[0]), legend.top - edge, legend.bottom - edge, down(look.yaxis2.domain[1])];
}"""


@pytest.mark.long
def test_the_legend_between_forces_and_displacements_covers_no_curve(tmp_path: Path) -> None:
    report = tmp_path / "report.html"
    write_page(report, synthetic_response(), synthetic_study())
    with opened_browser() as browser, opened_page(browser, report) as page:
        page.emulate_media(media="print")
        page.wait_for_selector("#signals[data-height]")
        page.wait_for_timeout(300)
        printed = page.evaluate(_BETWEEN)
        page.emulate_media(media="screen")
        page.wait_for_selector("#signals:not([data-height])")
        page.wait_for_timeout(300)
        shown = page.evaluate(_BETWEEN)
    assert printed == sorted(printed)
    assert shown == sorted(shown)


@pytest.mark.long
def test_the_last_border_is_not_cut_by_the_edge_of_the_paper(tmp_path: Path) -> None:
    report = tmp_path / "report.html"
    write_page(report, synthetic_response(), synthetic_study())
    with opened_browser() as browser, opened_page(browser, report) as page:
        page.set_viewport_size({"width": WIDTH_PX, "height": 900})
        page.emulate_media(media="print")
        ends = page.evaluate(
            "() => Array.from(document.querySelectorAll('.panel'), each => each.getBoundingClientRect().right)"
        )
    assert WIDTH_PX - 2.0 < max(ends) <= WIDTH_PX - 1.0
