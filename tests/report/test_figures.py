"""Single figures: what they draw is what the response holds, and files are written whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from stickslip.errors import InputError
from stickslip.report.figures import (
    FIGURES,
    amplitude_frequency,
    contact_states,
    energy_map,
    hysteresis,
    surface,
    write_figures,
)
from stickslip.report.view import View
from synthetic import synthetic_response, synthetic_study


@pytest.fixture(scope="module")
def view() -> View:
    return View.of(synthetic_response(), synthetic_study())


def test_amplitude_curve_holds_the_amplitudes_and_units(view: View) -> None:
    axes = amplitude_frequency(view).axes[0]
    lines = {line.get_label(): line for line in axes.lines}
    assert np.allclose(lines["with friction"].get_ydata(), view.amplitude_um)
    assert np.allclose(lines["linear, all stuck"].get_ydata(), view.stuck_um)
    assert "Hz" in axes.get_xlabel()
    assert "0-to-peak, µm" in axes.get_ylabel()


def test_state_map_shows_every_pair_once(view: View) -> None:
    figure = contact_states(view)
    assert len(figure.axes) == 2
    shown = sum(len(line.get_xdata()) for axes in figure.axes for line in axes.lines)
    assert shown == view.response.pairs.n_pairs
    legend = [text.get_text() for text in figure.axes[-1].get_legend().get_texts()]
    assert legend == ["stuck", "stick-slip", "separating"]


def test_energy_map_has_one_scale(view: View) -> None:
    dots = [axes.collections[0] for axes in energy_map(view).axes[:2]]
    assert dots[0].get_clim() == dots[1].get_clim()
    energy = view.energy_factor * view.response.dissipated_energy[view.point]
    assert np.allclose(np.sort(np.concatenate([d.get_array() for d in dots])), np.sort(energy))


def test_loop_closes(view: View) -> None:
    loop = hysteresis(view).axes[0].lines[0]
    x, y = loop.get_data()
    assert (x[0], y[0]) == (x[-1], y[-1])


def test_surface_is_drawn_about_its_mean() -> None:
    x, y = np.meshgrid(np.linspace(0, 1e-3, 5), np.linspace(0, 1e-3, 4))
    heights = 1e-6 * np.arange(20.0).reshape(4, 5)
    drawn = surface(x, y, heights).axes[0].collections[0].get_array()
    assert np.mean(drawn) == pytest.approx(0.0, abs=1e-12)
    assert np.ptp(drawn) == pytest.approx(19.0)
    with pytest.raises(InputError, match="grids of one shape"):
        surface(x, y, heights[0])


def test_files_in_each_format(view: View, tmp_path: Path) -> None:
    files = list(write_figures(tmp_path, view.response, view.study, ("svg", "png")))
    assert len(files) == 2 * len(FIGURES)
    assert {path.name for path in tmp_path.iterdir()} == {path.name for path in files}
    assert all(path.stat().st_size > 1000 for path in files)


def test_same_figure_same_svg(view: View, tmp_path: Path) -> None:
    for name in ("a", "b"):
        list(write_figures(tmp_path / name, view.response, view.study, ("svg",)))
    first, second = ((tmp_path / name / "energy_per_cycle.svg").read_bytes() for name in ("a", "b"))
    assert first == second


def test_folder_that_cannot_be_made(view: View, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    with pytest.raises(InputError, match="could not be written"):
        list(write_figures(tmp_path / "file", view.response, view.study, ("png",)))
