"""Numbers of the summary stay inside their tiles, also numbers with an exponent and ranges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from browser_pages import WIDTHS, opened_page
from helpers import opened_browser
from stickslip.core.shown_numbers import tile_number
from stickslip.reporting.page import page as page_text
from synthetic import synthetic_response, synthetic_study

pytestmark = pytest.mark.slow

OUTSIDE = """[...document.querySelectorAll('.tile .value')].filter(each => {
  const tile = each.parentElement.getBoundingClientRect(), range = document.createRange();
  range.selectNodeContents(each);
  return [...range.getClientRects()].some(box => box.right > tile.right - 4 || box.left < tile.left);
}).map(each => each.textContent)"""
BROKEN = """[...document.querySelectorAll('.tile .value')].filter(each => {
  const range = document.createRange();
  range.selectNodeContents(each.firstChild);
  return range.getClientRects().length > 1;
}).map(each => each.textContent)"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with opened_browser() as opened:
        yield opened


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("size", [1.0, 1e-9, 3.33e5])
def test_numbers_stay_inside_their_tiles(browser: Any, tmp_path: Path, width: int, size: float) -> None:
    """Energies and damping ratios of a joint that hardly dissipates, and of one that dissipates very much."""
    response = synthetic_response()
    other = replace(response, dissipated_energy=size * response.dissipated_energy, normal_work=0.0 * response.closure)
    other = replace(other, viscous_energy=size * response.viscous_energy)
    path = tmp_path / "page.html"
    path.write_text(page_text(other, synthetic_study()), encoding="utf-8")
    with opened_page(browser, path, width) as page:
        texts = page.evaluate("[...document.querySelectorAll('.tile .value')].map(each => each.textContent)")
        assert page.evaluate(OUTSIDE) == []
        assert page.evaluate(BROKEN) == []
    assert len(texts) == 6
    assert any("10⁻" in text for text in texts) == (size < 1e-3)


def test_a_number_with_an_exponent_has_two_digits_in_a_tile() -> None:
    assert tile_number(8.2154e-4) == "8.2 × 10⁻⁴"
    assert tile_number(-1.26e7) == "−1.3 × 10⁷"
    assert tile_number(0.82154) == "0.8215"
    assert tile_number(0.0) == "0"
    assert tile_number(1.23456, 3) == "1.23"
