"""From where the structure is seen, which bodies are transparent, and the view of the contact."""

from __future__ import annotations

import numpy as np
import pytest

from sketches import ABOVE, BACK, FRONT, LEFT, RIGHT, box, sketch_of_boxes, stacked_boxes
from stickslip.reporting.structure_view import Camera, Extent, best_camera, contact_extent, glass_bodies, round_length

CUBE = box((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))


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
        axes = Camera(azimuth, 30.0).axes
        assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
        assert np.cross(axes[0], axes[1]) == pytest.approx(axes[2])
        assert axes[0][2] == 0.0
        assert axes[1][2] > 0.0


def test_a_body_before_the_contact_is_transparent() -> None:
    sketch = stacked_boxes()
    assert glass_bodies(sketch, best_camera(sketch)).tolist() == [False, True]


def test_small_contact_has_a_view_of_its_own_and_large_contact_none() -> None:
    sketch = stacked_boxes()
    close = contact_extent(sketch, best_camera(sketch))
    assert close is not None
    assert close.middle == pytest.approx([0.05, 0.05, 0.1])
    assert close.size[:2] == pytest.approx(1.7 * np.array([0.02, 0.02]))
    face = np.full(6, -1)
    assert contact_extent(sketch_of_boxes(CUBE), Camera(-60.0, 30.0)) is None
    face[ABOVE] = 0
    assert contact_extent(sketch_of_boxes(CUBE, face=face), Camera(-60.0, 30.0)) is None


def test_the_box_of_a_plane_has_a_thickness_and_its_corners_span_it() -> None:
    extent = Extent.around(np.array([[0.0, 0.0, 1.0], [2.0, 1.0, 1.0]]))
    assert extent.size.tolist() == [2.0, 1.0, 0.04]
    assert np.ptp(extent.corners, axis=0) == pytest.approx(extent.size)
    assert extent.corners.mean(axis=0) == pytest.approx([1.0, 0.5, 1.0])
    camera = Camera(20.0, 40.0)
    assert extent.projected_size(camera) == pytest.approx(np.ptp(extent.corners @ camera.axes.T, axis=0))


@pytest.mark.parametrize(
    ("least", "found"), [(36.25, 50.0), (0.3, 0.5), (1.0, 1.0), (1.5, 2.0), (99, 100), (7e-4, 1e-3)]
)
def test_ticks_are_round(least: float, found: float) -> None:
    assert round_length(least) == found
