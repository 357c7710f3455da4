"""Directions of contact faces: their checks, and their place in a results file."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.results.face_directions import FaceDirections
from stickslip.results.storage import load_results, save_results
from synthetic import synthetic_response, synthetic_study

MIDDLE = np.array([[0.1, 0.2, 0.3], [0.0, 0.0, 0.0]])
TANGENTS = np.array([[[0.0, 0.6, 0.8], [0, 0, 0]], [[1.0, 0, 0], [0, 0, 0]]])


@pytest.mark.slow
def test_a_results_file_contains_them(tmp_path: Path) -> None:
    study = dataclasses.replace(synthetic_study(), face_directions=FaceDirections(MIDDLE, *TANGENTS))
    save_results(tmp_path / "results.nc", synthetic_response(), study)
    stored = load_results(tmp_path / "results.nc").study
    assert stored is not None
    assert stored.face_directions == study.face_directions


def test_a_direction_is_a_unit_vector_or_zero() -> None:
    with rejects(InputError, "tangent2"):
        FaceDirections(MIDDLE, TANGENTS[0], 1.01 * TANGENTS[1])


@pytest.mark.parametrize("name", ["tangent1", "tangent2"])
def test_each_face_has_both(name: str) -> None:
    arrays = {"middle": MIDDLE, "tangent1": TANGENTS[0], "tangent2": TANGENTS[1]}
    arrays[name] = arrays[name][:1]
    with rejects(InputError, name):
        FaceDirections(**arrays)


def test_they_are_those_of_the_faces_of_the_study() -> None:
    with rejects(InputError, "face_directions"):
        dataclasses.replace(synthetic_study(), face_directions=FaceDirections(MIDDLE[:1], *TANGENTS[:, :1]))
