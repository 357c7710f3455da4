"""Arrows, outlines and labels of the structure."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from sketches import ABOVE, box, sketch_of_boxes, stacked_boxes
from stickslip.reporting.structure_marks import Frame, before_faces, labels, marked, outlines, shortened
from stickslip.reporting.structure_view import Camera, best_camera
from stickslip.results.face_directions import FaceDirections
from stickslip.results.record import StudyRecord
from synthetic import synthetic_study

CUBE = box((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))
USUAL = Camera(-60.0, 30.0)


def test_an_arrow_starts_at_its_place_where_it_pulls_and_ends_there_where_it_pushes() -> None:
    sketch = sketch_of_boxes(CUBE)  # a load along x at the right side
    shown = marked(synthetic_study(), sketch)
    assert shown.places[shown.tails[0]] == pytest.approx(sketch.load_places[0])
    along = shown.places[shown.tips[0]] - shown.places[shown.tails[0]]
    assert along == pytest.approx([0.16 * np.sqrt(0.03), 0.0, 0.0])
    assert shown.free_ends.tolist() == shown.tips.tolist()
    pushed = marked(synthetic_study(), dataclasses.replace(sketch, loads=-sketch.loads))
    assert pushed.places[pushed.tips[0]] == pytest.approx(sketch.load_places[0])
    assert pushed.free_ends.tolist() == pushed.tails.tolist()


def test_places_are_those_of_the_sketch() -> None:
    sketch = sketch_of_boxes(CUBE, load_names=(), load_places=np.empty((0, 3)), loads=np.empty((0, 3)),
                             constant=np.empty(0, dtype=bool))  # fmt: skip
    shown = marked(synthetic_study(), sketch)
    assert shown.places[:8] == pytest.approx(sketch.points)
    assert shown.places[shown.responses] == pytest.approx(sketch.response_places)
    assert len(shown.places) == 9
    assert shown.tails.size == shown.tips.size == 0


def directed_study() -> StudyRecord:
    """The synthetic study on the upper box: the left face at its bottom, the right face closed, without directions."""
    middle = np.array([[0.048, 0.048, 0.1], [0.0, 0.0, 0.0]])
    tangent1, tangent2 = np.array([[[1.0, 0, 0], [0, 0, 0]], [[0, 1.0, 0], [0, 0, 0]]])
    return dataclasses.replace(synthetic_study(), face_directions=FaceDirections(middle, tangent1, tangent2))


def test_arrows_of_the_sliding_directions_start_at_the_middle_of_their_face() -> None:
    study, sketch = directed_study(), stacked_boxes()
    shown = marked(study, sketch)
    assert shown.tangents == ("t1", "t2")  # a closed face has none
    assert shown.places[shown.starts] == pytest.approx(np.tile([0.048, 0.048, 0.1], (2, 1)))
    along = shown.places[shown.ends] - shown.places[shown.starts]
    least = 0.02 * np.linalg.norm([0.1, 0.1, 0.11])
    assert along == pytest.approx(np.array([[least, 0.0, 0.0], [0.0, 0.4 * 0.028, 0.0]]))  # a face of 6.5 by 28 mm
    assert sketch.points[shown.anchors] == pytest.approx(np.tile([0.04, 0.04, 0.1], (2, 1)))


def test_arrows_lie_before_their_face() -> None:
    shown = marked(directed_study(), stacked_boxes())
    for elevation, side in ((30.0, 1.0), (-30.0, -1.0)):
        before = before_faces(shown, Camera(-60.0, elevation), 0.001)
        moved = before.places - shown.places
        assert moved[np.r_[shown.starts, shown.ends]] == pytest.approx(np.tile([0.0, 0.0, 0.001 * side], (4, 1)))
        assert not moved[: shown.starts[0]].any()


def test_arrows_of_a_tiny_face_remain_visible() -> None:
    study = directed_study()
    study = dataclasses.replace(study, pair_position=1e-3 * study.pair_position)
    shown = marked(study, stacked_boxes())
    length = np.linalg.norm(shown.places[shown.ends] - shown.places[shown.starts], axis=1)
    assert length == pytest.approx(0.02 * np.linalg.norm([0.1, 0.1, 0.11]))


def test_a_box_is_outlined_by_its_twelve_edges() -> None:
    edges = outlines(stacked_boxes(), 1)
    assert len(edges) == 12
    assert edges.min() == 8
    assert len(np.unique(edges, axis=0)) == 12


def test_flat_neighbours_have_no_outline_between_them_unless_one_is_contact() -> None:
    # two squares side by side, the second one a triangle pair
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]], dtype=float)
    sides = np.array([[0, 1, 4, 3], [1, 2, 5, 5], [1, 5, 4, 4]])

    def edges(face: list[int]) -> set[tuple[int, ...]]:
        sheet = sketch_of_boxes(
            CUBE, points=points, held=np.zeros(6, bool), sides=sides, body=np.zeros(3, int), face=np.array(face),
            mesh_sides=3,
        )  # fmt: skip
        return {tuple(edge) for edge in outlines(sheet, 0).tolist()}

    around = {(0, 1), (1, 2), (2, 5), (4, 5), (3, 4), (0, 3)}
    assert edges([-1, -1, -1]) == around
    assert edges([0, -1, -1]) == around | {(1, 4)}


def labels_of(frame: Frame, **changes: Any) -> list[Any]:
    sketch = stacked_boxes(**changes)
    return labels(synthetic_study(), sketch, frame)


@pytest.mark.parametrize("size", [(820, 560), (350, 400)])
def test_labels_are_apart_and_inside_even_where_their_places_are_one(size: tuple[int, int]) -> None:
    width, height = size
    place = np.array([[0.05, 0.05, 0.1]])
    names = tuple(f"response {number}" for number in range(5))
    changes = {"response_names": names, "response_places": np.repeat(place, 5, axis=0)}
    camera = best_camera(stacked_boxes())
    frame = Frame(camera, np.full(3, 0.05), 2000.0, width, height)
    actual = labels_of(frame, **changes)
    assert [label.words for label in actual] == ["Left face", "shaker, 5 N", *names]
    places = marked(synthetic_study(), stacked_boxes(**changes)).places
    at = 2000.0 * (places[[label.at for label in actual]] - 0.05) @ camera.axes[:2].T * [1.0, -1.0]
    middles = at + np.array([label.offset for label in actual])
    rooms = np.array([[6.8 * len(label.words), 16.0] for label in actual])
    assert (np.abs(middles) + 0.5 * rooms <= 0.5 * np.array(size)).all()
    for number in range(len(actual)):
        for other in range(number):
            apart = np.abs(middles[number] - middles[other]) >= 0.5 * (rooms[number] + rooms[other])
            assert apart.any(), (actual[number], actual[other])


def test_a_face_is_named_at_a_point_of_it() -> None:
    face = np.full(6, -1)
    face[ABOVE] = 0
    sketch = sketch_of_boxes(CUBE, face=face)
    label = labels(synthetic_study(), sketch, Frame(USUAL, np.full(3, 0.05), 2000.0, 800.0, 500.0))[0]
    assert label.words == "Left face"
    assert sketch.points[label.at][2] == 0.1


def test_a_long_name_is_shortened_and_the_size_of_a_load_is_not() -> None:
    name = "the response of a place that has a very long name"
    assert shortened(name) == f"{name[:33]}…"
    frame = Frame(USUAL, np.full(3, 0.05), 2000.0, 800.0, 500.0)
    assert f"{name[:33]}…, 5 N" in [label.words for label in labels_of(frame, load_names=(name,))]
