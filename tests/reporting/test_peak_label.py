"""The label of the peak covers no curve and stays inside the axes, at any width and on both kinds of axis."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from browser_pages import WIDTHS, opened_page
from helpers import opened_browser
from stickslip.reporting.curve_plot import amplitude_frequency
from stickslip.reporting.page import write_page
from stickslip.reporting.view import View
from synthetic import synthetic_response, synthetic_study

# Numbers of points of curves under the words of the label, and px by which the words leave the axes.
_COVERED = """() => {
  const plot = document.getElementById('curve'), full = plot._fullLayout, edge = plot.getBoundingClientRect();
  const box = plot.querySelector(".annotation[data-index='0'] .annotation-text-g").getBoundingClientRect();
  const left = box.left - edge.left, top = box.top - edge.top, size = full._size;
  const under = plot._fullData.flatMap(trace => Array.from(trace.x, (x, i) => [
    size.l + full.xaxis.d2p(x), size.t + full.yaxis.d2p(trace.y[i])]))
    .filter(([x, y]) => x > left && x < left + box.width && y > top && y < top + box.height);
  return [under.length, Math.max(size.l - left, size.t - top, left + box.width - size.l - size.w, 0)];
}"""

_PEAK_AT_THE_LEFT = """() => {
  const plot = document.getElementById('curve'), peak = plot.layout.annotations[0].x;
  return Plotly.relayout(plot, { 'xaxis.range': [peak - 0.2, peak + 8] }).then(() => true);
}"""


def clear(page: Any) -> bool:
    page.wait_for_timeout(300)
    under, outside = page.evaluate(_COVERED)
    return bool(under == 0 and outside <= 1.0)


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
def test_the_label_is_clear(tmp_path: Path, width: int) -> None:
    path = tmp_path / "report.html"
    write_page(path, synthetic_response(), synthetic_study())
    with opened_browser() as browser, opened_page(browser, path, width) as page:
        assert clear(page)
        page.click("#scale")
        assert clear(page)
        page.evaluate(_PEAK_AT_THE_LEFT)
        assert clear(page)
        page.emulate_media(media="print")
        page.wait_for_selector("#curve[data-height]")
        assert clear(page)


def test_a_much_higher_limit_needs_a_logarithmic_axis() -> None:
    """Beside it, on a linear axis, the curve would be a line on the ground."""
    response = synthetic_response()
    plain = amplitude_frequency(View.of(response, synthetic_study()))["layout"]["meta"]
    linear = replace(response.linear, free=20.0 * response.linear.free)
    high = amplitude_frequency(View.of(replace(response, linear=linear), synthetic_study()))["layout"]["meta"]
    assert (plain["logarithmic"], high["logarithmic"]) == (False, True)
    low, top = high["ranges"]["log"]
    assert high["ranges"]["linear"][1] < 10.0**top
    assert low < top - 1.0
