"""The words around the picture of the structure, and its place in the page."""

from __future__ import annotations

import base64
import dataclasses
import re
from typing import Any

import numpy as np
import pytest
from test_structure_picture import COUNT, rough_sheet

from browser_pages import LARGEST_PAGE
from large_results import large_result
from sketches import box, shaken, sketch_of_boxes, stacked_boxes
from stickslip.reporting.page import page
from stickslip.reporting.structure_section import STRUCTURE
from stickslip.reporting.view import View
from stickslip.results.sketch import Sketch
from synthetic import synthetic_response, synthetic_study

CUBE = box((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))


def section(sketch: Sketch, **changes: Any) -> str:
    study = dataclasses.replace(synthetic_study(), sketch=sketch, **changes)
    return STRUCTURE.on_page(View.of(synthetic_response(), study)).html


@pytest.mark.slow
def test_the_picture_is_reported_in_words() -> None:
    sketch = stacked_boxes(
        load_names=("shaker", "weight"), load_places=CUBE[[5, 6]], loads=np.array([[3.0, 4.0, 0.0], [0.0, 0.0, -2.0]]),
        constant=np.array([False, True]),
    )  # fmt: skip
    text = section(sketch)
    spoken = re.findall(r'id="structure-words">([^<]*)<', text)[0]
    for words in (
        "box 1, box 2",
        "Left face",
        "shaker, 5 N along (0.6, 0.8, 0)",
        "weight, 2 N along −z",
        "tip",
        "Constrained",
    ):
        assert words in spoken, words
    assert text.count('aria-describedby="structure-words"') == 2
    for words in (
        "constrained node",
        "harmonic force",
        "constant force",
        "response",
        "contact, Left face",
        "box 1",
        "box 2",
    ):
        assert f"{words}</label>" in text


@pytest.mark.slow
def test_no_mark_is_explained_that_is_not_there() -> None:
    text = section(sketch_of_boxes(CUBE))
    for words in ("constrained node", "constant force", "contact", "transparent"):
        assert words not in text
    assert 'data-view="contact"' not in text


@pytest.mark.slow
def test_the_still_picture_is_part_of_it() -> None:
    image = re.findall(r'src="data:image/png;base64,([^"]*)"', section(stacked_boxes()))
    assert len(image) == 1
    assert base64.b64decode(image[0]).startswith(b"\x89PNG")


@pytest.mark.slow
def test_magnification_and_largest_displacement_are_written() -> None:
    text = section(shaken(stacked_boxes()))
    assert "Deflected shape at the peak, 410.50 Hz: displacements × 57, mean and all harmonics." in text
    assert "The largest true displacement in the picture is 250 µm." in text
    assert 'id="structure-play"' in text


@pytest.mark.slow
def test_a_mean_that_is_left_out_is_reported() -> None:
    sketch = shaken(stacked_boxes())
    assert sketch.motion is not None
    points = sketch.motion.points.copy()
    points[8:, 1, 0] = 1.0
    text = section(dataclasses.replace(sketch, motion=dataclasses.replace(sketch.motion, points=points)))
    assert "about their mean. The mean, up to 1\u00a0×\u00a010⁶ µm, is omitted" in text
    assert "mean and all harmonics" not in text


@pytest.mark.slow
def test_without_a_motion_the_page_says_why_nothing_moves() -> None:
    text = section(stacked_boxes())
    assert "The results file is from an older version and has no motion of the structure" in text
    assert "structure-play" not in text


@pytest.mark.slow
def test_a_coarser_picture_reports_it() -> None:
    assert "1000000 outer sides, too many for a page" in section(stacked_boxes(mesh_sides=10**6))
    assert "too many" not in section(stacked_boxes())


@pytest.mark.slow
def test_more_bodies_than_the_legend_shows() -> None:
    cubes = [CUBE + np.array([0.2 * i, 0.0, 0.0]) for i in range(15)]
    text = section(sketch_of_boxes(*cubes))
    assert "box 12</label>" in text
    assert "box 13</label>" not in text
    assert "3 more bodies; colours repeat</label>" in text
    numbers = [int(each) for group in re.findall(r'data-traces="([\d ]*)"', text) for each in group.split()]
    assert sorted(numbers) == list(range(2 * 15 + 3))


@pytest.mark.slow
def test_names_of_a_user_cannot_break_the_page() -> None:
    nasty = 'a<b & "c"</svg><script>'
    sketch = stacked_boxes(load_names=(nasty,), response_names=(nasty,), body_names=(nasty, nasty))
    text = section(sketch, face_names=(nasty, nasty))
    assert "<script>" not in text
    assert text.count("</svg>") == text.count("<svg ")
    assert "a&lt;b &amp; &#34;c&#34;" in text


@pytest.mark.slow
def test_the_page_has_the_structure_before_the_contact_states() -> None:
    study = synthetic_study()
    text = page(synthetic_response(), dataclasses.replace(study, sketch=stacked_boxes()))
    assert text.index(">Amplitude against frequency<") < text.index(">Structure<") < text.index(">Contact states<")
    without = page(synthetic_response(), study)
    assert 'id="structure"' not in without
    assert "structure-data" not in without


@pytest.mark.long
def test_the_page_with_the_largest_picture_stays_below_its_limit() -> None:
    response, study = large_result(5000, 600)
    text = page(response, dataclasses.replace(study, sketch=rough_sheet(COUNT, response.harmonics)))
    assert len(text.encode()) < LARGEST_PAGE
