"""Figures for files: they draw what the response holds, and are written in the formats promised."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.lines import Line2D

from sentences import rejects
from stickslip.contact.stiffness.roughness_fit import RoughnessFit
from stickslip.core.errors import InputError
from stickslip.core.shown_numbers import energy_unit, number, raised
from stickslip.core.validation import FloatArray
from stickslip.reporting import figures
from stickslip.reporting.style import STATES
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from synthetic import synthetic_response, synthetic_study


@pytest.fixture(scope="module")
def case() -> tuple[ForcedResponse, StudyRecord]:
    return synthetic_response(), synthetic_study()


def heights(line: Line2D) -> FloatArray:
    """The values of a line along y."""
    return np.asarray(line.get_ydata(), dtype=float)


def test_amplitude_frequency_draws_three_curves_and_the_peak(case: tuple[ForcedResponse, StudyRecord]) -> None:
    axes = figures.amplitude_frequency(*case).axes[0]
    labels = [line.get_label() for line in axes.lines]
    assert labels[:3] == ["linear, all stuck", "linear, no contact", "with friction"]
    amplitude = 1e6 * case[0].amplitude(case[1].outputs[case[1].response_output])
    np.testing.assert_allclose(heights(axes.lines[2]), amplitude)
    assert heights(axes.lines[3])[0] >= amplitude.max() * 0.999
    assert "Hz" in axes.get_xlabel()
    assert "0-to-peak, µm" in axes.get_ylabel()


def test_contact_states_put_every_pair_once_with_its_shape(case: tuple[ForcedResponse, StudyRecord]) -> None:
    response, study = case
    for point in (0, 25):
        panels = figures.contact_states(response, study, point).axes
        drawn = [[len(np.asarray(dots.get_offsets())) for dots in axes.collections] for axes in panels]
        for face in range(2):
            states = response.contact_state[point, study.pair_face == face]
            assert drawn[face] == [int((states == code).sum()) for code in range(3)]
    legend = panels[0].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["stuck", "stick-slip", "separating"]
    assert len({state.matplotlib_marker for state in STATES}) == len({state.plotly_symbol for state in STATES}) == 3


def test_loop_encloses_the_energy_of_its_pair(case: tuple[ForcedResponse, StudyRecord]) -> None:
    response, study = case
    point = int(response.dissipated_energy.sum(axis=1).argmax())
    pair = int(response.dissipated_energy[point].argmax())
    lines = figures.hysteresis_loop(response, study, point, pair).axes[0].lines
    area = 0.0
    for line in lines:
        x, y = 1e-6 * np.asarray(line.get_xdata()), heights(line)
        area += 0.5 * float(np.sum((y[1:] + y[:-1]) * np.diff(x)))
    assert area == pytest.approx(response.dissipated_energy[point, pair], rel=0.03)
    with rejects(InputError, "pair"):
        figures.hysteresis_loop(response, study, pair=110)


def test_structure_function_draws_measurement_and_fit_of_each_direction() -> None:
    lag = np.array([1e-6, 2e-6, 4e-6, 1e-6, 3e-6])
    values: dict[str, Any] = {field.name: 1.0 for field in dataclasses.fields(RoughnessFit)}
    values |= {
        "lag": lag,
        "structure_function": lag**1.2,
        "fitted": 1.1 * lag**1.2,
        "points_along_x": 3,
        "fractal_roughness": 2.65e-9,
    }
    lines = figures.structure_function(RoughnessFit(**values)).axes[0].lines
    np.testing.assert_allclose(np.asarray(lines[0].get_xdata()), [1.0, 2.0, 4.0])
    np.testing.assert_allclose(heights(lines[2]), 1e12 * lag[3:] ** 1.2)
    np.testing.assert_allclose(heights(lines[1]), 1.1 * heights(lines[0]))
    assert [line.get_label() for line in lines[:3:2]] == ["measured along x", "measured along y"]
    one = figures.structure_function(RoughnessFit(**(values | {"points_along_x": 5}))).axes[0].lines
    assert [line.get_label() for line in one] == ["measured", f"fit: {raised('D = 1.000, G = 2.65e-09 m')}"]


@pytest.mark.long
def test_all_figures_are_written(case: tuple[ForcedResponse, StudyRecord], tmp_path: Path) -> None:
    written = figures.save_all(tmp_path, *case, formats=("svg",))
    assert {path.name for path in written} == {
        f"{name}.svg"
        for name in (
            "amplitude_frequency",
            "contact_states",
            "energy_map",
            "hysteresis_loop",
            "energy_curve",
            "mode_comparison",
            "rest_pressure",
        )
    }
    assert all(path.read_text().startswith("<?xml") for path in written)


@pytest.mark.slow
def test_png_pdf_and_rejected_endings(case: tuple[ForcedResponse, StudyRecord], tmp_path: Path) -> None:
    figure = figures.energy_curve(*case)
    assert figures.save(figure, tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert figures.save(figure, tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")
    with rejects(InputError):
        figures.save(figure, tmp_path / "a.xyz")
    with rejects(InputError):
        figures.save(figure, tmp_path / "none" / "a.png")


def test_mode_comparison_names_the_reference_and_needs_one(case: tuple[ForcedResponse, StudyRecord]) -> None:
    axes = figures.mode_comparison(case[1]).axes[0]
    assert axes.get_title() == "Natural frequencies against modal test of the two blades"
    assert axes.patches[6].get_height() == pytest.approx(100 * (3534.42 / 3559.8 - 1))  # type: ignore[attr-defined]
    with rejects(InputError):
        figures.mode_comparison(dataclasses.replace(case[1], mode_table=({"mode": 1, "full_hz": 507.0},)))


def test_surface_shows_heights_about_their_mean() -> None:
    x, y = np.meshgrid(np.linspace(0, 0.028, 40), np.linspace(0, 0.0065, 20))
    figure = figures.surface(x, y, 3e-6 + 1e-6 * np.sign(x - 0.014))
    assert "Sq = 1 µm" in figure.axes[0].get_title()
    with rejects(InputError):
        figures.surface(x[0], y[:, 0], x)


def test_numbers_and_units_for_readers() -> None:
    assert number(-0.57031, 3) == "−0.57"
    assert number(5.4e-5) == "5.4 × 10⁻⁵"
    assert number(2.0e7) == "2 × 10⁷"
    assert number(0.0) == "0"
    assert number(1234.567) == "1235"
    assert number(110) == "110"
    assert energy_unit(3e-4) == (1e6, "µJ")
    assert energy_unit(0.02) == (1e3, "mJ")
    assert energy_unit(0.0) == (1e9, "nJ")
