"""The performance curve on the page: its words in a list, and legends that leave room for the figures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from browser_pages import WIDTHS, opened_page
from helpers import opened_browser
from ridges import ridge_of, valley
from stickslip.reporting.page import page as page_text
from stickslip.results.checked_peak import CheckedPeak
from stickslip.results.response import ForcedResponse
from synthetic import synthetic_response, synthetic_study

LOADS = np.geomspace(0.1, 10.0, 15)
RIDGE = ridge_of(
    (LOADS, valley(LOADS, best=1.0)),
    parameter_name="centrifugal force over excitation force",
    parameter_unit="",
    settings={"harmonics": 1, "centrifugal_force_n": 600.0, "excitation_force_n": 300.0},
    estimated_error=np.geomspace(0.2, 1e-4, LOADS.size),
    checked=(CheckedPeak(1.0, 1.5e-5, 49.5, 0.004, 7),),
)
# Traces of the figure, px of its axes, px of its legend, and whether plotly cut the legend and gave it a scroll bar.
_FIGURES = """() => ['performance-amplitude', 'performance-frequency'].map(function (id) {
  const plot = document.getElementById(id), bar = plot.querySelector('.legend .scrollbar');
  const legend = plot.querySelector('.legend').getBoundingClientRect();
  return [plot.querySelectorAll('.legend .traces').length, plot._fullLayout._size.h, legend.height,
    Boolean(bar) && bar.getBBox().height > 0, legend.right <= plot.getBoundingClientRect().right + 1];
})"""


def response() -> ForcedResponse:
    return replace(synthetic_response(), performance_curve=RIDGE)


@pytest.mark.slow
def test_each_sentence_is_an_item_with_forces_in_newton() -> None:
    text = page_text(response(), synthetic_study())
    section = text[text.index("<h2>Performance curve of the damper</h2>") :].partition("</section>")[0]
    facts = section.partition('<ul class="note after facts">')[2].partition("</ul>")[0].split("<li>")[1:]
    assert len(facts) == 5
    assert facts[1].startswith("The optimum is at 1 times the excitation force, 300 N")
    assert facts[2].startswith("Checked with 7 harmonics by a whole curve at 300 N: 15 µm")


@pytest.mark.long
@pytest.mark.parametrize(("width", "media"), [(WIDTHS[0], "screen"), (WIDTHS[0], "print"), (WIDTHS[1], "screen")])
def test_the_legend_is_complete_and_leaves_room_for_the_curves(tmp_path: Path, width: int, media: str) -> None:
    path = tmp_path / "page.html"
    path.write_text(page_text(response(), synthetic_study()), encoding="utf-8")
    with opened_browser() as browser, opened_page(browser, path, width) as page:
        if media == "print":
            page.emulate_media(media="print")
            page.wait_for_selector("#performance-frequency[data-height]")
            page.wait_for_timeout(300)
        figures = page.evaluate(_FIGURES)
    for entries, height, legend, has_scroll_bar, is_inside in figures:
        assert entries == 8
        assert not has_scroll_bar
        assert is_inside
        assert height > 0.8 * legend
