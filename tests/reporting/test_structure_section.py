"""The drawing of the structure: what it shows, where, in which colour, and how large it may become."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import numpy as np
import pytest

from browser_pages import LARGEST_PAGE
from colour_vision import VISION, difference, seen
from large_results import large_result
from sketches import ABOVE, BACK, BOX_SIDES, FRONT, LEFT, RIGHT, box, sketch_of_boxes, stacked_boxes
from stickslip.reporting.page import page
from stickslip.reporting.sketch import structure_section
from stickslip.reporting.sketch_labels import Label, Labels, text_size
from stickslip.reporting.sketch_marks import arrows, scale_bar
from stickslip.reporting.sketch_view import Camera, best_camera, contact_window, glass_bodies, whole_window
from stickslip.reporting.style import BODY_COLOURS, VERMILLION
from stickslip.results.sketch import Sketch
from stickslip.study.sketching import MOST_SIDES
from synthetic import synthetic_response, synthetic_study

CUBE = box((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))
COUNT = 148  # sides along an edge of the largest sheet
USUAL = Camera.at(-60.0, 30.0)


def drawing(sketch: Sketch, **changes: Any) -> str:
    return structure_section(dataclasses.replace(synthetic_study(), sketch=sketch, **changes))


def figures(text: str) -> list[str]:
    return re.findall(r"<figure.*?</figure>", text)


def bodies(figure: str) -> list[tuple[str, int]]:
    """Colour and number of polygons of each path of the bodies."""
    group = re.search(r'<g class="bodies[^"]*">(.*?)</g>', figure)
    assert group
    return [(colour, path.count("M")) for colour, path in re.findall(r'color="(#\w+)" d="([^"]*)"', group[1])]


def window_of(sketch: Sketch, camera: Camera = USUAL) -> Any:
    return whole_window(sketch, camera, 480, (260, 500), (30.0, 30.0, 30.0, 30.0))


def test_of_a_cube_three_sides_are_drawn_in_three_shades() -> None:
    (figure,) = figures(drawing(sketch_of_boxes(CUBE)))
    assert [count for _, count in bodies(figure)] == [1, 1, 1]
    shades = [int(colour[1:3], 16) for colour, _ in bodies(figure)]
    assert len(set(shades)) == 3
    assert max(shades) <= int(BODY_COLOURS[0][1:3], 16)


def test_a_body_inside_another_is_not_drawn() -> None:
    inner = box((0.03, 0.03, 0.03), (0.06, 0.06, 0.06))
    (figure,) = figures(drawing(sketch_of_boxes(CUBE, inner)))
    assert sum(count for _, count in bodies(figure)) == 3


def test_a_contact_face_in_sight_has_the_strong_colour_at_its_place() -> None:
    face = np.full(6, -1)
    face[FRONT] = 0
    sketch = sketch_of_boxes(CUBE, face=face, load_names=(), load_places=np.empty((0, 3)), loads=np.empty((0, 3)),
                             constant=np.empty(0, dtype=bool))  # fmt: skip
    (figure,) = figures(drawing(sketch))
    hues = [[int(colour[at : at + 2], 16) for at in (1, 3, 5)] for colour, _ in bodies(figure)]
    strong = [red > 2 * blue for red, _, blue in hues]
    assert sum(strong) == 1
    path = re.findall(r'color="#\w+" d="M(\d+) (\d+)l', figure)[strong.index(True)]
    view = re.search(r'viewBox="0 0 480 (\d+)"', figure)
    assert view
    window = whole_window(sketch, USUAL, 480, (260, 500), (34.0, 28.0, 34.0, 52.0))
    assert window.height == int(view[1])
    corner = window.places(sketch.points)[BOX_SIDES[FRONT][0]]
    assert [int(number) / 5.0 for number in path] == pytest.approx(corner[:2].tolist(), abs=0.11)


def test_a_contact_face_that_a_body_hides_is_outlined() -> None:
    for figure in figures(drawing(stacked_boxes())):
        assert '<g class="tint"><path d="M' in figure
        assert figure.split('class="edge" d="')[1].split('"')[0].count("M") == 4


def test_small_contact_gets_a_close_up_and_large_contact_none() -> None:
    text = drawing(stacked_boxes())
    whole, close = figures(text)
    assert "Close-up of the contact" in close
    assert 'class="inset"' in whole
    assert "In the close-up, bodies that stand before the contact are glass." in text
    face = np.full(6, -1)
    face[ABOVE] = 0
    large = drawing(sketch_of_boxes(CUBE, face=face))
    assert len(figures(large)) == 1
    assert "glass" not in large
    assert len(figures(drawing(sketch_of_boxes(CUBE)))) == 1


def test_the_close_up_has_the_contact_in_its_middle_and_the_body_before_it_as_glass() -> None:
    sketch = stacked_boxes()
    whole = window_of(sketch, best_camera(sketch))
    close = contact_window(sketch, whole)
    assert close is not None
    contact = close.places(sketch.points[sketch.sides[sketch.face == 0].ravel()])[:, :2]
    assert 0.5 * (contact.min(axis=0) + contact.max(axis=0)) == pytest.approx([240.0, 0.5 * whole.height])
    assert close.holds(contact).all()
    assert close.scale > 1.6 * whole.scale
    assert glass_bodies(sketch, close.camera).tolist() == [False, True]
    _, figure = figures(drawing(sketch))
    assert figure.count('class="glass"') >= 1


@pytest.mark.parametrize("side", [FRONT, RIGHT, LEFT, BACK])
def test_the_view_shows_the_contact(side: int) -> None:
    face = np.full(6, -1)
    face[side] = 0
    camera = best_camera(sketch_of_boxes(CUBE, face=face))
    normal = {FRONT: [0, -1, 0], RIGHT: [1, 0, 0], LEFT: [-1, 0, 0], BACK: [0, 1, 0]}[side]
    assert camera.axes[2][2] == pytest.approx(0.5)  # from above
    # from outside, or through its own body as glass, but never nearly edge-on
    assert abs(camera.axes[2] @ normal) > 0.4


def test_the_camera_looks_along_a_right_handed_frame_with_z_up() -> None:
    for azimuth in (-120.0, -60.0, 30.0):
        axes = Camera.at(azimuth, 30.0).axes
        assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
        assert np.cross(axes[0], axes[1]) == pytest.approx(axes[2])
        assert axes[0][2] == 0.0
        assert axes[1][2] > 0.0


def test_an_arrow_ends_at_its_place_and_points_along_the_load() -> None:
    sketch = sketch_of_boxes(CUBE)
    window = window_of(sketch)
    (arrow,) = arrows(sketch, window)
    place = window.places(sketch.load_places)[0, :2]
    along = np.array([USUAL.axes[0][0], -USUAL.axes[1][0]])
    along /= np.linalg.norm(along)
    turn = (arrow.tip - arrow.tail) / np.linalg.norm(arrow.tip - arrow.tail)
    assert turn == pytest.approx(along)
    assert arrow.tail == pytest.approx(place + 3.0 * along)  # at the right side of the cube a load along x pulls
    assert arrow.free_end is arrow.tip
    pushed = dataclasses.replace(sketch, loads=-sketch.loads)
    (other,) = arrows(pushed, window)
    assert other.tip == pytest.approx(place + 3.0 * along)
    assert other.free_end is other.tail
    assert "shaker, 5 N" in drawing(sketch)


def test_a_load_along_the_view_is_a_circle() -> None:
    for sign, mark in ((1.0, 'class="dot"'), (-1.0, "l8 8m0-8l-8 8")):
        sketch = sketch_of_boxes(CUBE, loads=sign * USUAL.axes[2:] * 2.0)
        text = figures(drawing(sketch))[0]
        assert 'class="load ring"' in text
        assert mark in text


def test_held_nodes_loads_and_responses_are_marked_and_named() -> None:
    sketch = stacked_boxes(
        load_names=("shaker", "weight"), load_places=CUBE[[5, 6]], loads=np.array([[3.0, 4.0, 0.0], [0.0, 0.0, -2.0]]),
        constant=np.array([False, True]),
    )  # fmt: skip
    text = drawing(sketch)
    whole = figures(text)[0]
    assert whole.count('class="held"') == 1
    assert 2 <= whole.split('class="held" d="')[1].split('"')[0].count("M") <= 4
    for words in ("shaker, 5 N", "weight, 2 N", "tip", "20 mm", ">x<", ">y<", ">z<"):
        assert words in whole, words
    for words in ("held node", "harmonic force", "constant force", "response", "contact face", "box 1", "box 2"):
        assert f"{words}</li>" in text
    assert 'class="load constant"' in whole
    label = re.findall(r'role="img" aria-label="([^"]*)"', whole)[0]
    for words in ("box 1, box 2", "Left face", "shaker, 5 N along (0.6, 0.8, 0)", "weight, 2 N along −z", "tip"):
        assert words in label, label


def test_no_mark_is_explained_that_is_not_there() -> None:
    text = drawing(sketch_of_boxes(CUBE))
    for words in ("held node", "constant force", "contact face"):
        assert f"{words}</li>" not in text


@pytest.mark.parametrize("size", [1e-4, 0.03, 7.0])
def test_the_scale_bar_is_a_round_length(size: float) -> None:
    window = window_of(sketch_of_boxes(CUBE * size / 0.1))
    (bar, text), _ = scale_bar(window)
    words = re.fullmatch(r"([\d.e-]+) mm", str(text.inside[0]))
    drawn = re.search(r"v5h([\d.]+)v-5", str(bar.attributes["d"]))
    assert words
    assert drawn
    assert float(drawn[1]) == pytest.approx(1e-3 * float(words[1]) * window.scale, abs=0.06)
    assert 40.0 < float(drawn[1]) <= 110.0
    assert words[1].lstrip("0.")[0] in "125"


def test_names_of_a_user_cannot_break_the_page() -> None:
    nasty = 'a<b & "c"</svg><script>'
    sketch = stacked_boxes(load_names=(nasty,), response_names=(nasty,), body_names=(nasty, nasty))
    text = drawing(sketch, face_names=(nasty, nasty))
    assert "<script>" not in text
    assert text.count("</svg>") == text.count("<svg ")
    assert "a&lt;b &amp; &#34;c&#34;" in text


def test_a_long_name_is_shortened_in_the_drawing_and_whole_in_its_words() -> None:
    name = "the response of a place that has a very long name"
    text = drawing(sketch_of_boxes(CUBE, response_names=(name,)))
    assert f"<title>{name}</title>" in text
    assert f"{name[:33]}…</text>" in text


def test_labels_stay_in_the_view_and_off_each_other_and_off_bodies() -> None:
    covered = np.zeros((300, 400), dtype=bool)
    covered[:, 200:] = True
    setter = Labels(covered, 1.0, 400, 300, [])
    boxes = []
    for words, place in (("first", (195.0, 150.0)), ("second", (195.0, 155.0)), ("third", (8.0, 8.0))):
        text = setter.svg(Label(words, np.array(place)))[-1]
        assert (text.tag, text.inside) == ("text", (words,))
        x, y = (float(text.attributes[axis]) for axis in "xy")
        width, height = text_size(words)
        left = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[str(text.attributes["text-anchor"])] * width
        boxes.append((left, y - 0.5 * height, left + width, y + 0.5 * height))
        assert left >= 0.0
        assert boxes[-1][1] >= 0.0
        assert boxes[-1][2] <= 200.5
    first, second = boxes[:2]
    assert first[3] <= second[1] + 0.2 or second[3] <= first[1] + 0.2 or first[2] <= second[0] or second[2] <= first[0]


def test_more_bodies_than_the_legend_holds() -> None:
    cubes = [CUBE + np.array([0.2 * i, 0.0, 0.0]) for i in range(15)]
    text = drawing(sketch_of_boxes(*cubes))
    assert "box 12</li>" in text
    assert "box 13</li>" not in text
    assert "and 3 more bodies; colours repeat" in text


def rough_sheet(count: int, **changes: Any) -> Sketch:
    """``count`` x ``count`` sides that all look up, no two of one shade in a row."""
    line = np.linspace(0.0, 1.0, count + 1)
    height = np.random.default_rng(1).uniform(0.0, 0.4 / count, (count + 1) ** 2)
    points = np.column_stack([np.repeat(line, count + 1), np.tile(line, count + 1), height])
    number = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    sides = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    middle = points[sides].mean(axis=1)[:, :2]
    face = np.where((np.abs(middle - 0.5) < 0.15).all(axis=1), 0, -1)
    values = {"points": points, "sides": sides, "face": face, "held": np.zeros(len(points), dtype=bool)}
    return sketch_of_boxes(CUBE, body=np.zeros(count**2, dtype=int), mesh_sides=count**2, **values | changes)


@pytest.mark.parametrize("mesh_sides", [COUNT**2, 10**6])
def test_the_largest_drawing_is_smaller_than_its_limit(mesh_sides: int) -> None:
    assert COUNT**2 <= MOST_SIDES < (COUNT + 1) ** 2
    sketch = dataclasses.replace(rough_sheet(COUNT), mesh_sides=mesh_sides)
    text = drawing(sketch)
    assert len(figures(text)) == 2
    assert sum(count for _, count in bodies(figures(text)[0])) > 10_000
    assert 300_000 < len(text.encode()) < 1_500_000
    assert ("1000000 outer sides, too many for a page" in text) == (mesh_sides == 10**6)
    assert 'class="bodies"' in text  # sides of a pixel or two have no lines


def test_the_page_with_the_largest_drawing_stays_below_its_limit() -> None:
    response, study = large_result(5000, 600)
    with_drawing = page(response, dataclasses.replace(study, sketch=rough_sheet(COUNT)))
    assert len(with_drawing.encode()) < LARGEST_PAGE


def test_the_page_has_the_drawing_before_the_contact_states() -> None:
    study = synthetic_study()
    text = page(synthetic_response(), dataclasses.replace(study, sketch=stacked_boxes()))
    assert text.index(">Amplitude against frequency<") < text.index(">Structure<") < text.index(">Contact states<")
    assert 'id="structure"' not in page(synthetic_response(), study)


@pytest.mark.parametrize("vision", VISION)
def test_colours_of_bodies_keep_apart_and_contact_stands_out(vision: str) -> None:
    colours = [seen(colour, vision) for colour in BODY_COLOURS]
    for number, colour in enumerate(colours):
        assert difference(colour, seen(VERMILLION, vision)) > 20.0
        for other in colours[:number]:
            assert difference(colour, other) > 8.0
