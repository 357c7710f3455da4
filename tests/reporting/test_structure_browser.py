"""The structure in a real browser: it turns, moves and zooms, by mouse and keyboard, beside a still picture."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from browser_pages import WIDTHS, opened_page, require_readable, tab_stops
from helpers import opened_browser
from sketches import shaken, stacked_boxes
from stickslip.reporting.page import write_page
from stickslip.reporting.structure_picture import structure_picture
from stickslip.reporting.style import face_colour
from stickslip.results.face_directions import FaceDirections
from synthetic import synthetic_response, synthetic_study

pytestmark = pytest.mark.slow

MOVING = shaken(stacked_boxes())
CAMERA = "Object.values(document.getElementById('structure-plot').layout.scene.camera.eye)"
_POINTS = """trace => ['x', 'y', 'z'].map(
  axis => Array.from(document.getElementById('structure-plot')._fullData[trace][axis]))"""
NO_WEBGL = """const usual = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
  return kind.startsWith('webgl') ? null : usual.call(this, kind, ...more);
};"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with opened_browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("structure") / "report.html"
    write_page(path, synthetic_response(), dataclasses.replace(synthetic_study(), sketch=MOVING))
    return path


@pytest.fixture(scope="module")
def shared_page(browser: Any, report: Path) -> Iterator[Any]:
    with opened_page(browser, report) as opened:
        yield opened


@pytest.fixture
def page(shared_page: Any) -> Any:
    """The page at rest, seen as it opens."""
    shared_page.click("#structure-rest")
    shared_page.click("[data-view=whole]")
    settle(shared_page)
    return shared_page


def settle(page: Any) -> None:
    page.evaluate("new Promise(done => setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(done)), 60))")


def points(page: Any, trace: int = 0) -> np.ndarray:
    """(n, 3) mm, the points of a trace that plotly draws."""
    return np.array(page.evaluate(_POINTS, trace)).T


def wait_until(page: Any, holds: Any, seconds: float = 10.0) -> None:
    """Ask until ``holds()``; wait_for_function of playwright needs eval, which the page forbids."""
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, "it did not happen"
        page.wait_for_timeout(30)


def is_moving(page: Any) -> bool:
    return bool(page.inner_text("#structure-phase-label") != "at rest")


def set_phase(page: Any, degrees: int) -> None:
    page.evaluate(
        "degrees => { const slider = document.getElementById('structure-phase'); slider.value = degrees; "
        "slider.dispatchEvent(new Event('input')); }",
        degrees,
    )
    settle(page)


def face_pixels(page: Any) -> float:
    """Share of the picture that has the hue of the first contact face."""
    image = np.asarray(imread(BytesIO(page.locator("#structure-plot").screenshot()), format="png"))[..., :3]
    colour = np.array(to_rgb(face_colour(0)))
    reddish = image[..., 0] - image[..., 2] > 0.5 * (colour[0] - colour[2])
    return float(reddish.mean())


@pytest.mark.long
def test_the_contact_is_seen_at_once_and_larger_in_its_own_view(page: Any) -> None:
    whole = face_pixels(page)
    assert whole > 5e-4
    page.click("[data-view=contact]")
    settle(page)
    assert face_pixels(page) > 4.0 * whole


_NAMES = "document.getElementById('structure-plot').data.find(trace => trace.mode === 'text').text"


@pytest.mark.long
def test_directions_have_names_only_where_the_contact_is_large(browser: Any, tmp_path: Path) -> None:
    middle, ends = np.array([[0.048, 0.048, 0.1], [0.0, 0.0, 0.0]]), np.zeros((2, 2, 3))
    ends[:, 0, :2] = np.eye(2)
    study = dataclasses.replace(synthetic_study(), sketch=MOVING, face_directions=FaceDirections(middle, *ends))
    write_page(tmp_path / "named.html", synthetic_response(), study)
    with opened_page(browser, tmp_path / "named.html") as page:
        assert page.evaluate(_NAMES) == ["", ""]
        page.click("[data-view=contact]")
        wait_until(page, lambda: page.evaluate(_NAMES) == ["t1", "t2"])
        page.click("[data-view=whole]")
        wait_until(page, lambda: page.evaluate(_NAMES) == ["", ""])


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
def test_everything_can_be_read_and_labels_are_inside_and_apart(browser: Any, report: Path, width: int) -> None:
    with opened_page(browser, report, width) as page:
        require_readable(page)
        frame = page.locator("#structure-plot").bounding_box()
        assert 300 < frame["width"] <= width
        actual = page.locator("#structure-plot .annotation-text-g rect.bg")
        boxes = [actual.nth(number).bounding_box() for number in range(actual.count())]
        words = page.locator("#structure-plot .annotation-text").all_text_contents()
        assert words == ["Left face", "shaker, 5 N", "tip"]
        assert len(boxes) == 3
        for number, box in enumerate(boxes):
            assert frame["x"] <= box["x"] <= box["x"] + box["width"] <= frame["x"] + frame["width"] + 1, words[number]
            assert frame["y"] <= box["y"] <= box["y"] + box["height"] <= frame["y"] + frame["height"] + 1, words[number]
            for other in boxes[:number]:
                wide = min(box["x"] + box["width"], other["x"] + other["width"]) - max(box["x"], other["x"])
                high = min(box["y"] + box["height"], other["y"] + other["height"]) - max(box["y"], other["y"])
                assert wide <= 1.0 or high <= 1.0, (box, other)


@pytest.mark.long
@pytest.mark.parametrize("degrees", [0, 90, 230])
def test_the_slider_shows_the_shape_at_its_phase(page: Any, degrees: int) -> None:
    assert points(page) == pytest.approx(1e3 * MOVING.points[:8], abs=1e-4)
    assert page.inner_text("#structure-phase-label") == "at rest"
    set_phase(page, degrees)
    shape = structure_picture(synthetic_study(), MOVING).deflection
    assert shape is not None
    angle = np.radians(degrees)
    expected = 1e3 * MOVING.points[:8]
    share = 0.5 + np.sin(angle) + 0.25 * np.cos(2 * angle)
    expected[:, 0] += 1e3 * shape.magnification * 2e-4 * share * MOVING.points[:8, 2] / 0.11
    assert points(page) == pytest.approx(expected, abs=1e-2)
    assert page.inner_text("#structure-phase-label") == f"{degrees}°"
    assert page.get_attribute("#structure-phase", "aria-valuetext") == f"{degrees}°"
    note = page.evaluate("document.getElementById('structure-plot').layout.scene.annotations[2].x")
    assert note == pytest.approx(expected[6, 0], abs=1e-2)  # the label of the response goes along
    page.click("#structure-rest")
    settle(page)
    assert points(page) == pytest.approx(1e3 * MOVING.points[:8], abs=1e-4)


@pytest.mark.long
def test_the_keyboard_reaches_all_of_it(browser: Any, report: Path) -> None:
    with opened_page(browser, report) as page:
        stops = tab_stops(page)
    wanted = ["structure-plot", "structure-play", "structure-rest", "structure-phase"]
    assert [stop["id"] for stop in stops if stop["id"] in wanted] == wanted
    names = [stop["name"] for stop in stops]
    assert {"box 1", "box 2", "contact, Left face", "Whole structure", "Contact"} <= set(names)


@pytest.mark.long
def test_the_keyboard_alone_plays_pauses_and_moves_the_phase(page: Any) -> None:
    page.locator("#structure-play").focus()
    page.keyboard.press("Enter")
    assert page.inner_text("#structure-play") == "Pause"
    wait_until(page, lambda: is_moving(page))
    before = points(page)
    wait_until(page, lambda: np.abs(points(page) - before).max() > 0.5)
    page.keyboard.press("Space")
    assert page.inner_text("#structure-play") == "Play"
    settle(page)
    paused = page.inner_text("#structure-phase-label")
    page.wait_for_timeout(300)
    assert page.inner_text("#structure-phase-label") == paused
    page.locator("#structure-phase").focus()
    page.keyboard.press("Home")
    settle(page)
    page.keyboard.press("ArrowRight")
    settle(page)
    assert page.inner_text("#structure-phase-label") == "5°"


def test_arrow_keys_turn_it_and_plus_and_minus_zoom(page: Any) -> None:
    start = np.array(page.evaluate(CAMERA))
    page.locator("#structure-plot").focus()
    page.keyboard.press("ArrowRight")
    settle(page)
    right = np.array(page.evaluate(CAMERA))
    assert np.linalg.norm(right) == pytest.approx(np.linalg.norm(start))
    assert np.arctan2(right[1], right[0]) - np.arctan2(start[1], start[0]) == pytest.approx(np.pi / 24)
    page.keyboard.press("ArrowUp")
    settle(page)
    assert page.evaluate(CAMERA)[2] > right[2]
    page.keyboard.press("+")
    settle(page)
    assert np.linalg.norm(page.evaluate(CAMERA)) == pytest.approx(np.linalg.norm(start) / 1.15)
    page.keyboard.press("-")
    for _ in range(30):
        page.keyboard.press("ArrowUp")
    settle(page)
    eye = np.array(page.evaluate(CAMERA))
    assert eye[2] / np.linalg.norm(eye) < 1.0  # never over the top


@pytest.mark.long
def test_the_mouse_turns_it_also_while_it_plays(page: Any) -> None:
    page.locator("#structure-plot").scroll_into_view_if_needed()
    start = page.evaluate(CAMERA)
    page.click("#structure-play")
    wait_until(page, lambda: is_moving(page))
    box = page.locator("#structure-plot").bounding_box()
    x, y = box["x"] + 0.2 * box["width"], box["y"] + 0.2 * box["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(1, 19):
        page.mouse.move(x + 20 * step, y)
        page.wait_for_timeout(30)
    page.mouse.up()
    settle(page)
    turned = page.evaluate(CAMERA)
    # Playing alone does not turn it (asserted below); a busy browser draws few of the movements, so it turns less far.
    assert np.linalg.norm(np.subtract(turned, start)) > 0.02
    page.wait_for_timeout(400)  # plays on
    assert page.evaluate(CAMERA) == pytest.approx(turned, abs=1e-6)
    assert page.inner_text("#structure-play") == "Pause"


def test_the_legend_hides_and_shows_a_body_with_its_outlines(page: Any) -> None:
    shown = "[...document.getElementById('structure-plot')._fullData].map(trace => trace.visible)"
    before = page.evaluate(shown)
    assert set(before) == {True}
    page.get_by_role("checkbox", name="box 2").focus()
    page.keyboard.press("Space")
    settle(page)
    assert page.evaluate(shown) == [True, True, False, False, *before[4:]]
    page.keyboard.press("Space")
    settle(page)
    assert page.evaluate(shown) == before


def test_on_paper_there_is_the_still_picture_alone(page: Any) -> None:
    visible = "(which) => document.querySelector(which).getClientRects().length > 0"
    assert page.evaluate(visible, "#structure-plot")
    assert not page.evaluate(visible, "#structure .still")
    page.emulate_media(media="print")
    assert page.evaluate(visible, "#structure .still")
    for which in ("#structure-plot", "#structure-play", "#structure-phase", "#structure [data-view]"):
        assert not page.evaluate(visible, which), which
    assert page.evaluate("document.querySelector('#structure .still').naturalWidth") > 800
    page.emulate_media(media="screen")


@pytest.mark.long
@pytest.mark.parametrize("lost", [False, True])
def test_without_webgl_a_sentence_and_the_still_picture_appear(browser: Any, report: Path, lost: bool) -> None:
    with opened_page(browser, report, before="" if lost else NO_WEBGL) as page:
        if lost:
            page.evaluate("document.getElementById('structure-plot').emit('plotly_webglcontextlost', {})")
        assert page.locator("#structure .still").is_visible()
        assert page.locator("#structure-no-webgl").is_visible()
        assert "has no WebGL" in page.inner_text("#structure-no-webgl")
        for which in ("#structure-plot", "#structure-play", "#structure-phase"):
            assert not page.locator(which).is_visible(), which
        assert page.locator("#curve .scatterlayer .trace").count() > 0  # the other plots are there


def test_without_scripts_there_is_the_still_picture(browser: Any, report: Path) -> None:
    with opened_page(browser, report, drawn=False, java_script_enabled=False) as page:
        assert page.locator("#structure .still").is_visible()
        assert not page.locator("#structure-play").is_visible()
        assert not page.locator("#structure-no-webgl").is_visible()


@pytest.mark.long
def test_a_record_without_a_motion_shows_the_structure_and_no_controls(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    write_page(path, synthetic_response(), dataclasses.replace(synthetic_study(), sketch=stacked_boxes()))
    with opened_page(browser, path) as page:
        assert page.locator("#structure-plot canvas").count() > 0
        assert page.locator("#structure-play").count() == 0
        assert page.get_by_text(
            "The results file is from an older version and has no motion of the structure"
        ).is_visible()
