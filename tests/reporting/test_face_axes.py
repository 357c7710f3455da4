"""Axes of maps, named by the directions of the structure."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from stickslip.reporting.face_axes import in_axes, map_titles
from stickslip.results.face_directions import FaceDirections
from synthetic import synthetic_study


@pytest.mark.parametrize(
    ("direction", "words"),
    [
        ((0.0, 1.0, 0.0), "y"),
        ((0.0, 0.0, -1.0), "−z"),
        ((0.5, 0.0, np.sqrt(0.75)), "0.5 x + 0.87 z"),
        ((-0.6, 0.8, 0.0), "−0.6 x + 0.8 y"),
        ((1e-4, 0.0, 1.0), "z"),
        ((0.48, -0.6, 0.64), "0.48 x − 0.6 y + 0.64 z"),
    ],
)
def test_a_direction_in_words(direction: tuple[float, ...], words: str) -> None:
    assert in_axes(np.array(direction)) == words


def test_t2_is_to_the_right_and_t1_upwards() -> None:
    tangents = np.array([[[0.0, 0.6, 0.8], [0, 0, 0]], [[1.0, 0, 0], [0, 0, 0]]])
    study = dataclasses.replace(synthetic_study(), face_directions=FaceDirections(np.zeros((2, 3)), *tangents))
    assert map_titles(study, 0) == ("t2 = x, mm", "t1, mm\n0.6 y + 0.8 z")
    unnamed = ("Along the face, mm", "Across, mm")
    assert map_titles(study, 1) == unnamed  # a closed face
    assert map_titles(synthetic_study(), 0) == unnamed  # a results file of an older version
