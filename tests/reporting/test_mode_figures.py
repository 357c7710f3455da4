"""Energies and shapes of a nonlinear mode on the page."""

from __future__ import annotations

import base64
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from matplotlib.image import imread

from sketches import stacked_boxes
from stickslip.reporting.mode_figures import energies_of_mode, shape_pictures, shape_words
from stickslip.reporting.view import View
from stickslip.results.mode_shapes import ModeShapes
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.record import StudyRecord
from synthetic import synthetic_response, synthetic_study
from synthetic_mode import with_mode


def mode_of() -> NonlinearMode:
    mode = with_mode(0.02).nonlinear_mode
    assert mode is not None
    return mode


def study_with_shapes() -> StudyRecord:
    """The lower box rests; the upper one moves along x at the smallest, and along y at the largest amplitude."""
    sketch = stacked_boxes()
    shapes = np.zeros((2, len(sketch.points), 3), dtype=np.float32)
    shapes[0, 8:, 0], shapes[1, 8:, 1] = 0.7, 0.2
    return replace(
        synthetic_study(4, 3), sketch=replace(sketch, mode_shapes=ModeShapes(shapes, np.array([1e-8, 1e-4])))
    )


def test_the_energies_are_sums_over_the_pairs_on_logarithmic_axes() -> None:
    mode = mode_of()
    amplitude = mode.modal_amplitude
    friction, viscous = 1e3 * amplitude**3, 2.0 * amplitude**2
    per_pair = np.outer(friction, np.ones(mode.dissipated_energy.shape[1])) / mode.dissipated_energy.shape[1]
    mode = replace(mode, dissipated_energy=per_pair, viscous_energy=viscous, input_energy=friction + viscous)
    figure = energies_of_mode(mode)
    traces = {trace["name"]: np.array(trace["y"]) for trace in figure["data"]}
    assert list(traces) == ["supplied", "friction, all pairs", "viscous damping"]
    assert traces["friction, all pairs"] == pytest.approx(friction, rel=1e-6)
    assert traces["friction, all pairs"] + traces["viscous damping"] == pytest.approx(traces["supplied"], rel=1e-6)
    slope = np.diff(np.log(traces["viscous damping"])) / np.diff(np.log(amplitude))
    assert slope == pytest.approx(2.0, abs=1e-5)
    assert {figure["layout"][axis]["type"] for axis in ("xaxis", "yaxis")} == {"log"}


def test_an_energy_that_is_round_off_is_not_drawn() -> None:
    mode = mode_of()
    none = replace(
        mode,
        dissipated_energy=np.zeros_like(mode.dissipated_energy),
        viscous_energy=np.ones(mode.n_points),
        input_energy=np.ones(mode.n_points),
    )
    assert [trace["name"] for trace in energies_of_mode(none)["data"]] == ["supplied", "viscous damping"]


def test_both_shapes_have_one_view_and_differ() -> None:
    view = View.of(synthetic_response(columns=4, rows=3, n_points=20), study_with_shapes())
    first, last = shape_pictures(view)
    assert tuple(each.words.replace("\N{NO-BREAK SPACE}", " ") for each in (first, last)) == (
        "At the smallest modal amplitude, 1 × 10⁻⁸ m √kg",
        "At the largest modal amplitude, 1 × 10⁻⁴ m √kg",
    )
    pixels = [imread(BytesIO(base64.b64decode(each.png)), format="png")[..., :3] for each in (first, last)]
    assert pixels[0].shape == pixels[1].shape
    changed = np.abs(pixels[0] - pixels[1]).max(axis=2) > 0.1
    assert 0.001 < changed.mean() < 0.2


def test_without_shapes_there_is_no_picture() -> None:
    response = synthetic_response(columns=4, rows=3, n_points=20)
    assert shape_pictures(View.of(response, synthetic_study(4, 3))) == []


def test_the_words_say_how_far_the_shape_changes() -> None:
    mode = mode_of()
    mac = np.tile([0.1, 0.9], (mode.n_points, 1))
    mac[0], mac[-1] = [0.0, 1.0], [0.4, 0.5]
    words = shape_words(replace(mode, stuck_mac=mac))
    assert "with linear stuck mode 2 it is 1.000 and 0.500 and with linear sliding mode 1 it is 1.000" in words
