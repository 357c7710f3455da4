"""The shapes of a nonlinear mode at the nodes of a mesh, beside the linear modes of both limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import stickslip as ss
from sentences import rejects
from sketches import stacked_boxes
from stickslip.core.errors import InputError
from stickslip.model.model import Model, build_model
from stickslip.results.mode_shapes import ModeShapes
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.sketch import Sketch
from stickslip.results.storage import load_results, save_results
from stickslip.study.mode_shapes import MeshShapes
from sweep_cases import quick_case
from synthetic import synthetic_response, synthetic_study


@pytest.fixture(scope="module")
def model() -> Model:
    return build_model(quick_case())


def mode_from(model: Model, motions: np.ndarray, amplitude: np.ndarray) -> NonlinearMode:
    """A mode with only what the shapes need: motions (n_points, n, 2) of the first harmonic."""
    displacement = np.concatenate([np.zeros((*motions.shape[:2], 1)), motions], axis=2)
    mode = object.__new__(NonlinearMode)
    object.__setattr__(mode, "displacement", displacement)
    object.__setattr__(mode, "modal_amplitude", amplitude)
    assert displacement.shape[1] == model.superelement.size
    return mode


def test_the_shape_is_the_motion_over_the_modal_amplitude_whatever_its_phase(model: Model) -> None:
    rng = np.random.default_rng(1)
    shape = rng.normal(size=model.superelement.size)
    shape /= np.sqrt(shape @ model.superelement.mass @ shape)
    amplitude = np.array([1e-4, 1e-8])  # the branch may begin at its largest amplitude
    phases = np.array([[np.cos(1.0), np.sin(1.0)], [np.cos(4.0), np.sin(4.0)]])
    motions = amplitude[:, None, None] * shape[:, None] * phases[:, None, :]
    shapes = MeshShapes.of(model, mode_from(model, motions, amplitude))
    assert shapes is not None
    np.testing.assert_array_equal(shapes.modal_amplitude, [1e-8, 1e-4])
    expected = np.asarray(model.superelement.recovery @ shape).reshape(-1, 3)
    sign = np.sign(np.vdot(expected, shapes.displacement[0]))
    scale = np.abs(expected).max()
    np.testing.assert_allclose(sign * shapes.displacement[0], expected, atol=1e-9 * scale)
    np.testing.assert_allclose(shapes.displacement[1], shapes.displacement[0], atol=1e-9 * scale)
    nodes = np.array([3, 7])
    np.testing.assert_allclose(shapes.at(nodes).displacement, shapes.displacement[:, nodes], rtol=1e-6)


def test_without_a_mode_there_are_none(model: Model) -> None:
    assert MeshShapes.of(model, None) is None


@pytest.mark.long
def test_a_study_with_a_mode_has_its_shapes() -> None:
    changes = {"analysis.kind": "mode", "analysis.largest_amplitude": "10 um"}
    sketch = ss.solve_case(quick_case().replace(changes)).record.sketch
    assert sketch is not None
    shapes = sketch.mode_shapes
    assert shapes is not None
    assert shapes.displacement.shape == (2, len(sketch.points), 3)
    assert not shapes.displacement[:, sketch.held].any()
    first, last = shapes.displacement.reshape(2, -1)
    assert first @ last > 0.99 * np.linalg.norm(first) * np.linalg.norm(last)  # the mode is still almost linear


def shaped() -> Sketch:
    sketch = stacked_boxes()
    values = np.arange(6 * len(sketch.points), dtype=np.float32).reshape(2, -1, 3)
    return replace(sketch, mode_shapes=ModeShapes(values, np.array([1e-8, 1e-4])))


def test_a_file_gives_the_shapes_back(tmp_path: object) -> None:
    path = f"{tmp_path}/results.nc"
    record = replace(synthetic_study(4, 3), sketch=shaped())
    save_results(path, synthetic_response(columns=4, rows=3, n_points=20), record)
    assert load_results(path).study == record


def test_shapes_that_do_not_fit_are_rejected() -> None:
    with rejects(InputError):
        ModeShapes(np.zeros((2, 5), dtype=np.float32), np.ones(2))
    with rejects(InputError, "mode_shapes"):
        replace(stacked_boxes(), mode_shapes=ModeShapes(np.zeros((2, 5, 3), dtype=np.float32), np.ones(2)))
