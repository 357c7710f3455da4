"""The still picture of the structure."""

from __future__ import annotations

import dataclasses
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from sketches import ABOVE, BACK, FRONT, box, shaken, sketch_of_boxes, stacked_boxes
from stickslip.reporting import structure_still
from stickslip.reporting.structure_still import still_picture, structure_figure
from stickslip.reporting.structure_view import Camera, area_vectors
from stickslip.reporting.style import body_colour, face_colour
from stickslip.results.face_directions import FaceDirections
from stickslip.results.sketch import Sketch
from synthetic import synthetic_study

CUBE = box((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))


def pixels(sketch: Sketch) -> np.ndarray:
    return np.asarray(imread(BytesIO(still_picture(synthetic_study(), sketch)), format="png"))[..., :3]


def share(image: np.ndarray, colour: str) -> float:
    """Of the pixels, those of a hue, however much light is on them."""
    wanted = np.array(to_rgb(colour))
    bright = image.max(axis=-1, keepdims=True) / wanted.max()
    return float((np.abs(image - wanted * bright).max(axis=-1) < 0.02).mean())


def words(figure: Any) -> list[str]:
    return [text.get_text() for axes in figure.axes for text in axes.texts if text.get_text()]


@pytest.mark.slow
def test_the_contact_is_seen_through_the_body_before_it() -> None:
    """It is vermilion, in the pale tint of that body; nothing else in the picture is that red."""
    image, bare = pixels(stacked_boxes()), pixels(sketch_of_boxes(CUBE))
    reddish = [float((each[..., 0] - each[..., 2] > 0.3).mean()) for each in (image, bare)]
    assert reddish[0] > 0.005
    assert reddish[1] == 0.0
    assert share(image, body_colour(0)) > 0.1


def test_both_sides_that_touch_have_one_shade() -> None:
    """They lie in one plane, so that it is a matter of chance which of them is painted last."""
    face = np.full(12, -1)
    face[[BACK, 6 + FRONT]] = 0
    touching = sketch_of_boxes(CUBE, CUBE + np.array([0.0, 0.1, 0.0]), face=face)
    camera = Camera(-60.0, 30.0)
    colours = structure_still._side_colours(touching, area_vectors(touching), camera)
    assert colours[6 + FRONT] == pytest.approx(colours[BACK])
    assert colours[FRONT] != pytest.approx(colours[BACK])


@pytest.mark.slow
def test_a_face_in_sight_fills_its_side() -> None:
    face = np.full(6, -1)
    face[ABOVE] = 1
    image = pixels(sketch_of_boxes(CUBE, face=face))
    assert share(image, face_colour(1)) > 0.05


def test_small_contact_has_a_second_view_with_what_lies_in_it() -> None:
    figure = structure_figure(synthetic_study(), stacked_boxes())
    whole, close = figure.axes
    assert [text.get_text() for text in figure.texts] == ["Whole structure", "Contact"]
    assert {"Left face", "shaker, 5 N", "tip"} == {text.get_text() for text in whole.texts}
    assert {"Left face"} == {text.get_text() for text in close.texts}
    assert len(structure_figure(synthetic_study(), sketch_of_boxes(CUBE)).axes) == 1


@pytest.mark.slow
@pytest.mark.parametrize("panel", [0, 1])
def test_all_axes_have_one_scale(panel: int) -> None:
    axes = structure_figure(synthetic_study(), stacked_boxes()).axes[panel]
    sizes = np.array([np.ptp(getattr(axes, f"get_{name}lim")()) for name in "xyz"])
    ratio = vars(axes)["_box_aspect"] / sizes
    assert ratio == pytest.approx([ratio[0]] * 3)
    assert axes.get_xlabel() == "x, mm"


@pytest.mark.slow
def test_the_still_picture_is_at_rest_and_the_same_every_time() -> None:
    assert still_picture(synthetic_study(), stacked_boxes()) == still_picture(
        synthetic_study(), shaken(stacked_boxes())
    )


@pytest.mark.slow
def test_a_dollar_in_a_name_is_no_mathematics() -> None:
    figure = structure_figure(synthetic_study(), sketch_of_boxes(CUBE, response_names=("$x^{2$",)))
    assert "$x^{2$" in words(figure)
    figure.savefig(BytesIO(), format="png")


def test_a_flat_structure_has_a_low_picture() -> None:
    plate = box((0.0, 0.0, 0.0), (0.2, 0.02, 0.01))
    width, height = structure_figure(synthetic_study(), sketch_of_boxes(plate)).get_size_inches()
    assert height < 0.9 * width


def test_only_a_view_that_shows_the_contact_large_names_its_directions() -> None:
    """In a small picture of the contact t1 and t2 would cover each other."""
    middle, ends = np.array([[0.048, 0.048, 0.1], [0.0, 0.0, 0.0]]), np.zeros((2, 2, 3))
    ends[:, 0, :2] = np.eye(2)
    study = dataclasses.replace(synthetic_study(), face_directions=FaceDirections(middle, ends[0], ends[1]))
    whole, close = structure_figure(study, stacked_boxes()).axes
    assert not {"t1", "t2"} & {text.get_text() for text in whole.texts}
    assert {"t1", "t2"} <= {text.get_text() for text in close.texts}


def test_directions_of_a_contact_line_are_shown() -> None:
    """A line has no sides in the sketch, so nothing is known to hide it."""
    middle, ends = np.array([[0.05, 0.05, 0.1], [0.05, 0.05, 0.0]]), np.stack([np.eye(3)] * 2)
    study = dataclasses.replace(synthetic_study(), face_directions=FaceDirections(middle, ends[:, 0], ends[:, 1]))
    assert {"t1", "t2"} <= set(words(structure_figure(study, sketch_of_boxes(CUBE))))
