"""The section on the stress at the peak: its words and numbers, its pictures, and the colours in a browser."""

from __future__ import annotations

import base64
import dataclasses
import re
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread

from browser_pages import WIDTHS, opened_page, require_readable
from helpers import opened_browser
from sketches import shaken, stacked_boxes
from stickslip.reporting.page import write_page
from stickslip.reporting.stress_section import STRESS
from stickslip.reporting.view import View
from stickslip.results.record import StudyRecord
from stickslip.results.stress import Region, StressExtreme, StressSummary, SurfaceStress
from synthetic import synthetic_response, synthetic_study

pytestmark = pytest.mark.slow

APART = StressExtreme("alternating stress", 31.9e6, "box <1>", (0.01, 0.0, -0.02), Region.CONSTRAINED)
INSIDE = StressExtreme("alternating stress", 77.7e6, "box 2", (0.05, 0.05, 0.1), Region.CONTACT)
SAFETY = StressExtreme("safety factor", 2.5, "box 2", (0.05, 0.05, 0.11), Region.ORDINARY)
SUMMARY = StressSummary((APART,), (INSIDE,), (SAFETY,), "1 / S = …", "solved", 450.25, 300.0, 1.5e-4, 0.034)


def study_with_stress(summary: StressSummary = SUMMARY) -> StudyRecord:
    """Two boxes whose stress rises with the height."""
    boxes = shaken(stacked_boxes())
    rise = boxes.points[:, 2] / boxes.points[:, 2].max()
    sketch = dataclasses.replace(
        boxes, stress=SurfaceStress(*((size * rise).astype(np.float32) for size in (90e6, 77.7e6)))
    )
    return dataclasses.replace(synthetic_study(), sketch=sketch, stress=summary)


def section(study: StudyRecord) -> str:
    return STRESS.on_page(View.of(synthetic_response(), study)).html


def test_the_table_has_both_columns_and_says_where_they_are() -> None:
    text = " ".join(section(study_with_stress()).split())
    assert "box &lt;1&gt; (10.0, 0.0, −20.0) mm, constrained node" in text
    assert "box 2 (50.0, 50.0, 100.0) mm, in the cells at a contact" in text
    assert ">31.9</td>" in text
    assert ">77.7</td>" in text
    assert "at 450.25 Hz" in text
    assert "contains the stress of the state at rest" in text
    assert "up to 3.4 %" in text
    assert re.search(r"Alternating stress per unit of force</th><td>0.1063 MPa/N", text)
    assert re.search(r"Displacement per unit of force</th><td>0.5 µm/N", text)
    assert re.search(r"box 2</th><td>2.5</td>", text)


def test_a_prescribed_state_at_rest_is_named_and_a_missing_check_has_its_reason() -> None:
    summary = dataclasses.replace(SUMMARY, static="prescribed", goodman=(), goodman_message="There is none.", force=0.0)
    text = section(study_with_stress(summary))
    assert "prescribed normal loads" in text
    assert "In a bolted joint the bolt carries it" in text
    assert "There is none." in text
    assert "Smallest safety factor" not in text
    assert "per unit of force" not in text.lower()


def test_a_record_without_stress_has_no_section() -> None:
    assert not STRESS.applies(View.of(synthetic_response(), synthetic_study()))
    assert STRESS.applies(View.of(synthetic_response(), study_with_stress()))


def test_the_still_picture_has_the_colours_of_the_stress() -> None:
    """Viridis: dark violet where the stress is low, yellow where it is highest."""
    encoded = re.findall(r'class="stress"[^>]*base64,([^"]+)"', section(study_with_stress()))[0]
    image = np.asarray(imread(BytesIO(base64.b64decode(encoded)), format="png"))[..., :3]
    yellow = (image[..., 0] > 0.8) & (image[..., 1] > 0.8) & (image[..., 2] < 0.4)
    violet = (image[..., 0] < 0.35) & (image[..., 1] < 0.2) & (image[..., 2] > 0.25)
    assert yellow.mean() > 0.002
    assert violet.mean() > 0.002
    assert len(encoded) < 400_000


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with opened_browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("stress") / "report.html"
    write_page(path, synthetic_response(), study_with_stress())
    return path


@pytest.mark.long
def test_the_list_colours_every_surface_and_takes_the_colours_back(browser: Any, report: Path) -> None:
    look = """() => document.getElementById('structure-plot')._fullData.filter(trace => trace.type === 'mesh3d').map(
      trace => [trace.intensity ? Math.max(...trace.intensity) : null, trace.opacity, Boolean(trace.showscale)])"""
    with opened_page(browser, report) as page:
        before = page.evaluate(look)
        assert all(highest is None for highest, _, _ in before)
        page.select_option("#structure-colour", label="Alternating stress, MPa")
        page.wait_for_timeout(300)
        shown = page.evaluate(look)
        assert max(highest for highest, _, _ in shown) == pytest.approx(77.7, rel=1e-6)
        assert all(opacity == 1 for _, opacity, _ in shown)
        assert [bar for _, _, bar in shown] == [True] + [False] * (len(shown) - 1)
        page.select_option("#structure-colour", value="")
        page.wait_for_timeout(300)
        assert page.evaluate(look) == before


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
def test_the_page_with_a_stress_can_be_read(browser: Any, report: Path, width: int) -> None:
    with opened_page(browser, report, width) as page:
        require_readable(page)
