"""The picture that turns, as data: what it shows, in which colour, how it moves, and how large it may become."""

from __future__ import annotations

import base64
import dataclasses
import json
from typing import Any

import numpy as np
import plotly.graph_objects
import pytest

from colour_vision import VISION, difference, seen
from sketches import box, shaken, sketch_of_boxes, stacked_boxes
from stickslip.reporting.structure_picture import StructurePicture, structure_picture
from stickslip.reporting.style import BODY_COLOURS, FACE_COLOURS, body_colour, face_colour
from stickslip.results.sketch import Motion, Sketch
from stickslip.study.sketching import MOST_SIDES
from synthetic import synthetic_study

CUBE = box((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))
COUNT = 148  # sides along an edge of the largest sheet


def picture_of(sketch: Sketch) -> StructurePicture:
    return structure_picture(synthetic_study(), sketch)


def unpacked(text: str, kind: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype=np.dtype(f"<{kind}"))


def triangles(picture: StructurePicture, trace: int) -> np.ndarray:
    """(k, 3, 3) mm, corners of the triangles of a trace at rest."""
    look = picture.data["figure"]["data"][trace]
    corners = np.column_stack([unpacked(look[axis]["bdata"], "i4") for axis in "ijk"])
    points = unpacked(picture.data["points"], "f4").reshape(-1, 3)
    return np.asarray(points[unpacked(picture.data["at"][trace], "i4")][corners])


def test_every_side_is_there_with_its_outward_normal_and_the_contact_has_its_colour() -> None:
    sketch = stacked_boxes()
    picture = picture_of(sketch)
    traces = picture.data["figure"]["data"]
    surfaces = [number for number, trace in enumerate(traces) if trace["type"] == "mesh3d"]
    assert [traces[number]["color"] for number in surfaces] == [body_colour(0), body_colour(1), face_colour(0)]
    actual = {}
    for number in surfaces:
        corner = triangles(picture, number)
        area = 0.5 * np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        actual[number] = area
        assert (np.einsum("ij,ij->i", area, corner.mean(axis=1) - corner.mean(axis=(0, 1))) >= -1e-9).all()
    lower, upper, contact = (np.abs(actual[number]).sum() for number in surfaces)
    assert (lower, contact) == pytest.approx((6 * 100.0**2, 20.0**2))
    assert upper == pytest.approx(20.0**2 + 4 * 20.0 * 10.0)  # without the contact face
    assert actual[surfaces[2]].sum(axis=0) == pytest.approx([0.0, 0.0, -(20.0**2)])


def test_a_contact_face_lies_a_little_inside_its_body_and_moves_with_it() -> None:
    """Else it would flicker against the side of the other body in the same plane."""
    sketch = shaken(stacked_boxes())
    picture = picture_of(sketch)
    (trace,) = (entry.traces[0] for entry in picture.legend if entry.kind == "face")
    depth = np.unique(triangles(picture, trace)[..., 2])
    assert depth == pytest.approx(100.0 + 1e-3 * 1e3 * np.linalg.norm([0.1, 0.1, 0.11]))
    at = unpacked(picture.data["at"][trace], "i4")
    shift = moved(picture, 1.0) - unpacked(picture.data["points"], "f4").reshape(-1, 3)
    assert shift[at] == pytest.approx(shift[8:12])


def test_a_triangle_is_one_triangle() -> None:
    sides = np.array([[0, 1, 2, 2], [0, 2, 3, 3]])
    sheet = sketch_of_boxes(CUBE, sides=sides, body=np.zeros(2, int), face=np.full(2, -1), mesh_sides=2)
    assert len(triangles(picture_of(sheet), 0)) == 2


def test_a_body_before_the_contact_is_transparent() -> None:
    picture = picture_of(stacked_boxes())
    assert [trace.get("opacity") for trace in picture.data["figure"]["data"] if trace["type"] == "mesh3d"] == [
        1.0,
        pytest.approx(0.14),
        None,
    ]
    assert picture.has_glass
    assert not picture_of(sketch_of_boxes(CUBE)).has_glass


def test_the_legend_names_what_is_there_and_which_traces_that_is() -> None:
    sketch = stacked_boxes(
        load_names=("shaker", "weight"), load_places=CUBE[[5, 6]], loads=np.array([[3.0, 4.0, 0.0], [0.0, 0.0, -2.0]]),
        constant=np.array([False, True]),
    )  # fmt: skip
    picture = picture_of(sketch)
    words = ["box 1", "box 2", "contact, Left face", "constrained node", "harmonic force", "constant force", "response"]
    assert [entry.words for entry in picture.legend] == words
    shown = [trace for entry in picture.legend for trace in entry.traces]
    assert shown == list(range(len(picture.data["figure"]["data"])))
    kinds = [[picture.data["figure"]["data"][trace]["type"] for trace in entry.traces] for entry in picture.legend]
    assert kinds[0] == ["mesh3d", "scatter3d"]
    assert kinds[4] == kinds[5] == ["scatter3d", "cone"]
    solid, dashed = (picture.data["figure"]["data"][picture.legend[entry].traces[0]]["line"] for entry in (4, 5))
    assert (solid["dash"], dashed["dash"]) == ("solid", "dash")
    bare = picture_of(sketch_of_boxes(CUBE))
    assert [entry.words for entry in bare.legend] == ["box 1", "harmonic force", "response"]


def test_a_cone_points_along_its_load_with_its_tip_at_the_end_of_the_shaft() -> None:
    sketch = sketch_of_boxes(CUBE, loads=np.array([[0.0, -3.0, 4.0]]))
    picture = picture_of(sketch)
    shaft, head = picture.legend[1].traces
    cone = picture.data["figure"]["data"][head]
    assert np.array([cone[axis][0] for axis in "uvw"]) / np.hypot(cone["v"][0], cone["w"][0]) == pytest.approx(
        [0.0, -0.6, 0.8]
    )
    line = unpacked(picture.data["at"][shaft], "i4")
    assert line.tolist() == [line[0], unpacked(picture.data["at"][head], "i4")[0], -1]


def test_lengths_have_one_scale_along_all_axes() -> None:
    scene = picture_of(shaken(stacked_boxes())).data["figure"]["layout"]["scene"]
    assert scene["aspectmode"] == "manual"
    per_mm = [scene["aspectratio"][axis] / np.ptp(scene[f"{axis}axis"]["range"]) for axis in "xyz"]
    assert per_mm == pytest.approx([per_mm[0]] * 3, rel=1e-6)
    assert [scene[f"{axis}axis"]["title"]["text"] for axis in "xyz"] == ["x, mm", "y, mm", "z, mm"]


def moved(picture: StructurePicture, phase: float) -> np.ndarray:
    """(n, 3) mm, the points at a phase in rad, as structure.js computes them."""
    motion = picture.data["motion"]
    values = unpacked(motion["values"], "i2").reshape(motion["coefficients"], -1, 3)
    order = (np.arange(motion["coefficients"]) + 1) // 2
    weights = np.where(np.arange(motion["coefficients"]) % 2, np.cos(order * phase), np.sin(order * phase))
    weights[0] = 1.0
    points = unpacked(picture.data["points"], "f4").reshape(-1, 3)
    step: float = motion["step"]
    return np.asarray(points + step * np.einsum("c,cij->ij", weights, values.astype(float)))


@pytest.mark.parametrize("phase", [0.0, 1.0, 4.0])
def test_the_deflected_shape_is_the_motion_times_the_magnification(phase: float) -> None:
    sketch = shaken(stacked_boxes())
    picture = picture_of(sketch)
    shape = picture.deflection
    assert shape is not None
    diagonal = float(np.linalg.norm(np.ptp(sketch.points, axis=0)))
    assert shape.magnification * shape.largest == pytest.approx(0.08 * diagonal, rel=0.05)
    time = np.linspace(0.0, 2 * np.pi, 20_001)
    assert shape.largest == pytest.approx(2e-4 * np.abs(0.5 + np.sin(time) + 0.25 * np.cos(2 * time)).max(), rel=1e-3)
    assert shape.frequency_hz == 410.5
    assert shape.left_out == 0.0
    share = 0.5 + np.sin(phase) + 0.25 * np.cos(2 * phase)
    expected = 1e3 * sketch.points
    expected[:, 0] += 1e3 * shape.magnification * 2e-4 * share * sketch.points[:, 2] / 0.11
    actual = moved(picture, phase)
    reach = 1e3 * shape.magnification * shape.largest
    assert actual[:16] == pytest.approx(expected, abs=1e-4 * reach)
    shift = actual - unpacked(picture.data["points"], "f4").reshape(-1, 3)
    assert shift[17] == pytest.approx(shift[18])  # tail and tip of the arrow move as one
    limits = picture.data["figure"]["layout"]["scene"]["xaxis"]["range"]
    assert limits[0] < actual[:, 0].min() < actual[:, 0].max() < limits[1]


def test_harmonics_that_cannot_be_seen_are_left_out_of_the_page() -> None:
    sketch = shaken(stacked_boxes(), harmonics=9)
    motion = picture_of(sketch).data["motion"]
    assert motion["coefficients"] == 5


def test_a_mean_that_is_far_larger_than_the_motion_is_left_out_and_that_is_reported() -> None:
    """A body that only friction holds has no unique mean position: its mean can be a metre at a motion of 50 um."""
    sketch = shaken(stacked_boxes())
    assert sketch.motion is not None
    points = sketch.motion.points.copy()
    points[8:, 1, 0] = 1.0
    drifted = dataclasses.replace(sketch, motion=dataclasses.replace(sketch.motion, points=points))
    picture = picture_of(drifted)
    assert picture.deflection is not None
    assert picture.deflection.left_out == pytest.approx(1.0)
    assert picture.deflection.largest < 3e-4
    assert moved(picture, 1.0)[8:16, 1] == pytest.approx(1e3 * sketch.points[8:, 1])


def test_a_structure_that_rests_has_a_picture_that_rests() -> None:
    rest, place = np.zeros((8, 3, 3), np.float32), np.zeros((1, 3, 3), np.float32)
    still = Motion(rest, place, place, 400.0)
    picture = picture_of(sketch_of_boxes(CUBE, motion=still))
    assert picture.deflection is not None
    assert (picture.deflection.largest, picture.deflection.magnification) == (0.0, 1.0)
    assert moved(picture, 1.0)[:8] == pytest.approx(1e3 * CUBE)


def test_without_a_motion_there_is_the_structure_alone() -> None:
    picture = picture_of(stacked_boxes())
    assert picture.deflection is None
    assert picture.data["motion"] is None


def test_the_figure_is_valid_plotly() -> None:
    constant = picture_of(shaken(stacked_boxes(constant=np.array([True]))))
    figure = json.loads(json.dumps(constant.data["figure"]))
    plotly.graph_objects.Figure(figure)  # raises for an unknown key or value


def test_names_reach_plotly_escaped() -> None:
    nasty = "<b>%{x} & co</b>"
    sketch = stacked_boxes(load_names=(nasty,), response_names=(nasty,), body_names=(nasty, nasty))
    study = dataclasses.replace(synthetic_study(), face_names=(nasty, nasty))
    text = json.dumps(structure_picture(study, sketch).data["figure"])
    assert "<b>" not in text
    assert "&lt;b&gt;&#37;{x} &amp; co&lt;/b&gt;" in text


def rough_sheet(count: int, harmonics: int = 5) -> Sketch:
    """``count`` x ``count`` sides that all look up, with a motion whose coefficients are all large."""
    line = np.linspace(0.0, 1.0, count + 1)
    rng = np.random.default_rng(1)
    points = np.column_stack(
        [np.repeat(line, count + 1), np.tile(line, count + 1), rng.uniform(0.0, 0.4 / count, (count + 1) ** 2)]
    )
    number = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    sides = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    middle = points[sides].mean(axis=1)[:, :2]
    face = np.where((np.abs(middle - 0.5) < 0.15).all(axis=1), 0, -1)
    held = np.zeros(len(points), dtype=bool)
    columns = 2 * harmonics + 1
    place = np.zeros((1, 3, columns), np.float32)
    motion = Motion(rng.normal(size=(len(points), 3, columns)).astype(np.float32), place, place, 400.0)
    body = np.zeros(count**2, dtype=int)
    values: dict[str, Any] = {"points": points, "sides": sides, "face": face, "held": held, "motion": motion}
    return sketch_of_boxes(CUBE, body=body, mesh_sides=count**2, **values)


@pytest.mark.slow
def test_the_largest_picture_is_smaller_than_its_limit() -> None:
    assert COUNT**2 <= MOST_SIDES < (COUNT + 1) ** 2
    text = json.dumps(picture_of(rough_sheet(COUNT)).data)
    assert 2_000_000 < len(text) < 3_500_000


@pytest.mark.parametrize("vision", VISION)
def test_colours_of_bodies_and_faces_keep_apart_and_contact_stands_out(vision: str) -> None:
    bodies, faces = ([seen(colour, vision) for colour in colours] for colours in (BODY_COLOURS, FACE_COLOURS))
    for colours, least in ((bodies, 8.0), (faces, 15.0)):
        for number, colour in enumerate(colours):
            assert all(difference(colour, other) > least for other in colours[:number])
    assert all(difference(face, body) > 20.0 for face in faces for body in bodies)
