"""The result of a nonlinear mode: its file, its figure, and what does not fit together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from known_modes import one_mass
from sentences import rejects
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.response import ForcedResponse


@pytest.fixture(scope="module")
def mode() -> NonlinearMode:
    return ss.nonlinear_mode(*one_mass(ratio=0.002), 1, (1e-6, 1e-3), harmonics=3, samples=64)


@pytest.mark.slow
def test_the_file_comes_back_equal(mode: NonlinearMode, tmp_path: Path) -> None:
    mode.save(tmp_path / "mode.nc")
    assert NonlinearMode.load(tmp_path / "mode.nc") == mode


@pytest.mark.slow
def test_a_response_stores_its_mode(mode: NonlinearMode, tmp_path: Path) -> None:
    superelement, pairs = one_mass(ratio=0.002)
    response = ss.forced_response(superelement, pairs, [1.0], frequency_hz=(130.0, 140.0), harmonics=1, samples=64)
    estimate = ss.quasi_static_mode(superelement, pairs, 1, (1e-6, 1e-3))
    both = replace(response, nonlinear_mode=mode, quasi_static_mode=estimate)
    both.save(tmp_path / "both.nc")
    assert ForcedResponse.load(tmp_path / "both.nc") == both
    assert both.nonlinear_mode == mode
    assert both.quasi_static_mode == estimate
    assert list(both.parts) == ["nonlinear_mode", "quasi_static_mode"]
    assert both != response


@pytest.mark.slow
def test_the_dataset_has_units(mode: NonlinearMode) -> None:
    dataset = mode.to_dataset()
    assert dataset["modal_amplitude"].attrs["units"] == "m kg0.5"
    assert dataset["damping_ratio"].values == pytest.approx(mode.damping_ratio)
    estimate = ss.quasi_static_mode(*one_mass(), 1, (1e-6, 1e-3), points_per_decade=5)
    assert estimate.to_dataset()["frequency"].attrs["units"] == "Hz"


@pytest.mark.slow
def test_the_figure_shows_mode_linear_limits_and_estimate(mode: NonlinearMode) -> None:
    above, below = mode.plot(ss.quasi_static_mode(*one_mass(), 1, (1e-6, 1e-3), points_per_decade=5)).axes
    labels = above.get_legend_handles_labels()[1]
    assert labels == [
        "nonlinear mode",
        "linear stuck mode 1",
        "linear sliding mode 1",
        "quasi-static estimate (Masing)",
    ]
    assert below.get_xscale() == "log"
    assert len(mode.plot().axes[1].lines) == 1


def test_one_line_describes_it(mode: NonlinearMode) -> None:
    assert repr(mode).startswith("NonlinearMode(stuck mode 1, ")
    assert "Hz, damping ratio 0.002 to" in repr(mode)
    fractions = mode.state_fractions
    assert sum(fractions.values()) == pytest.approx(1.0)
    assert fractions[ss.ContactState.STUCK][0] == 1.0


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("modal_amplitude", np.zeros(3)),
        ("stuck_mac", np.zeros((2, 1))),
        ("frequency_hz", np.empty(0)),
        ("contact_state", "seven"),
    ],
)
def test_what_does_not_fit_is_rejected(mode: NonlinearMode, name: str, value: Any) -> None:
    if isinstance(value, str):
        value = np.full_like(mode.contact_state, 7)
    with rejects(ss.InputError, name):
        replace(mode, **{name: value})


def test_a_mode_without_motion_is_rejected(mode: NonlinearMode) -> None:
    with rejects(ss.InputError, "modal_amplitude"):
        replace(mode, modal_amplitude=np.zeros(mode.n_points))
