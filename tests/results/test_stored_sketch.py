"""The sketch of a structure in the study record: its shapes are checked, and a results file gives it back equal."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import pytest

from sentences import rejects
from sketches import shaken, sketch_of_boxes, stacked_boxes
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.results.record import StudyRecord
from stickslip.results.sketch import Motion, Sketch
from stickslip.results.storage import load_results, save_results
from synthetic import synthetic_response, synthetic_study


@pytest.fixture
def study() -> StudyRecord:
    return dataclasses.replace(synthetic_study(4, 3), sketch=stacked_boxes())


def stored(folder: Path, study: StudyRecord) -> Path:
    path = folder / "results.nc"
    save_results(path, synthetic_response(columns=4, rows=3, n_points=20), study)
    return path


@pytest.mark.slow
def test_a_sketch_comes_back_equal(study: StudyRecord, tmp_path: Path) -> None:
    again = load_results(stored(tmp_path, study)).study
    assert again == study
    assert again is not None
    assert isinstance(again.sketch, Sketch)
    assert again.sketch.held.dtype == bool
    assert again != dataclasses.replace(study, sketch=stacked_boxes(load_names=("another",)))
    assert again != dataclasses.replace(study, sketch=None)


@pytest.mark.slow
def test_a_sketch_without_loads_or_responses_comes_back_equal(study: StudyRecord, tmp_path: Path) -> None:
    none = {"load_names": (), "load_places": np.empty((0, 3)), "loads": np.empty((0, 3)), "constant": np.empty(0, bool)}
    bare = stacked_boxes(**none, response_names=(), response_places=np.empty((0, 3)))
    record = dataclasses.replace(study, sketch=bare)
    assert load_results(stored(tmp_path, record)).study == record


@pytest.mark.slow
def test_a_file_without_a_sketch_is_read_as_one(study: StudyRecord, tmp_path: Path) -> None:
    path = stored(tmp_path, study)
    with h5py.File(path, "r+") as file:
        del file["sketch"]
    actual = load_results(path).study
    assert actual == dataclasses.replace(study, sketch=None)


@pytest.mark.slow
def test_a_motion_comes_back_equal_in_single_precision(study: StudyRecord, tmp_path: Path) -> None:
    moving = dataclasses.replace(study, sketch=shaken(stacked_boxes()))
    path = stored(tmp_path, moving)
    again = load_results(path).study
    assert again == moving
    assert again != study
    assert again.sketch is not None
    assert again.sketch.motion is not None
    assert again.sketch.motion.points.dtype == np.float32
    assert again != dataclasses.replace(study, sketch=shaken(stacked_boxes(), amplitude=1e-4))
    with h5py.File(path, "r") as file:
        assert file["sketch/motion_of_points_cosine"].dtype == np.float32
        assert file["sketch/motion_of_points_cosine"].shape == (16, 3, 3)


@pytest.mark.slow
def test_a_motion_without_loads_or_responses_comes_back_equal(study: StudyRecord, tmp_path: Path) -> None:
    none = {"load_names": (), "load_places": np.empty((0, 3)), "loads": np.empty((0, 3)), "constant": np.empty(0, bool)}
    bare = shaken(stacked_boxes(**none, response_names=(), response_places=np.empty((0, 3))))
    record = dataclasses.replace(study, sketch=bare)
    assert load_results(stored(tmp_path, record)).study == record


@pytest.mark.slow
def test_a_file_without_a_motion_is_read_as_one(study: StudyRecord, tmp_path: Path) -> None:
    """Files of versions before the motion was stored open as they are."""
    path = stored(tmp_path, dataclasses.replace(study, sketch=shaken(stacked_boxes())))
    with h5py.File(path, "r+") as file:
        for name in [name for name in file["sketch"] if name.startswith("motion")]:
            del file["sketch"][name]
    assert load_results(path).study == study


@pytest.mark.parametrize(
    ("change", "keys"),
    [
        ({"points": np.zeros((16, 3, 4))}, ()),
        ({"points": np.zeros((16, 2, 5))}, ()),
        ({"loads": np.zeros((1, 3, 3))}, ()),
        ({"responses": np.full((1, 3, 5), np.inf)}, ()),
        ({"responses": np.zeros((2, 3, 5))}, ("motion",)),
    ],
)
def test_a_motion_that_does_not_fit_is_rejected(change: dict[str, Any], keys: tuple[str, ...]) -> None:
    parts = {"points": np.zeros((16, 3, 5)), "loads": np.zeros((1, 3, 5)), "responses": np.zeros((1, 3, 5))}
    with rejects(InputError, *keys):
        stacked_boxes(motion=Motion(**parts | change, frequency_hz=400.0))


def test_a_motion_of_another_run_is_rejected(study: StudyRecord, tmp_path: Path) -> None:
    other = dataclasses.replace(study, sketch=shaken(stacked_boxes(), harmonics=2))
    with rejects(InputError):
        stored(tmp_path, other)


@pytest.mark.slow
@pytest.mark.parametrize(
    "damaged",
    [
        {"motion_frequency": np.zeros(2)},
        {"motion_of_loads_sine": np.zeros((1, 3, 4))},
        {"motion_of_points_mean": None},
    ],
)
def test_a_damaged_motion_is_reported(study: StudyRecord, tmp_path: Path, damaged: dict[str, Any]) -> None:
    path = stored(tmp_path, dataclasses.replace(study, sketch=shaken(stacked_boxes())))
    with h5py.File(path, "r+") as file:
        for name, values in damaged.items():
            del file["sketch"][name]
            if values is not None:
                file["sketch"].create_dataset(name, data=values)
    with rejects(ResultsFileError):
        load_results(path)


@pytest.mark.slow
def test_no_group_where_there_is_no_sketch(study: StudyRecord, tmp_path: Path) -> None:
    path = stored(tmp_path, dataclasses.replace(study, sketch=None))
    with h5netcdf.File(path, "r") as file:
        assert "sketch" not in file.groups


@pytest.mark.parametrize(
    ("change", "keys"),
    [
        ({"points": np.zeros((16, 2))}, ()),
        ({"points": np.full((16, 3), np.nan)}, ()),
        ({"sides": np.empty((0, 4), dtype=int)}, ()),
        ({"sides": np.full((12, 4), 16)}, ("sides",)),
        ({"body": np.full(12, 2)}, ("body",)),
        ({"body": np.zeros(11, dtype=int)}, ("body",)),
        ({"held": np.zeros(3, dtype=bool)}, ("held",)),
        ({"loads": np.zeros((2, 3))}, ("loads",)),
        ({"constant": np.zeros(2, dtype=bool)}, ("constant",)),
        ({"response_names": ()}, ("response_places",)),
        ({"loads": np.zeros((1, 3))}, ("loads",)),
        ({"mesh_sides": 11}, ("mesh_sides",)),
    ],
)
def test_what_does_not_fit_is_rejected(change: dict[str, Any], keys: tuple[str, ...]) -> None:
    with rejects(InputError, *keys):
        stacked_boxes(**change)


@pytest.mark.parametrize("face", [-2, 2])
def test_a_face_that_the_record_does_not_have_is_rejected(study: StudyRecord, face: int) -> None:
    with rejects(InputError, "face"):
        dataclasses.replace(study, sketch=stacked_boxes(face=np.full(12, face)))


def test_a_sketch_of_fewer_sides_than_the_mesh_is_coarser() -> None:
    assert not sketch_of_boxes(stacked_boxes().points[:8]).is_coarsened
    assert stacked_boxes(mesh_sides=13).is_coarsened
