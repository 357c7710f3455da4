"""The result of wear: volumes and depths of its states, the file, the words and the figure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import rejects


def wear_of(**changes: Any) -> ss.Wear:
    """Two pairs of 1 and 3 mm2 over three states; the second one opens."""
    arguments: dict[str, Any] = {
        "cycles": np.array([0.0, 1e6, 3e6]),
        "depth": 1e-6 * np.array([[0.0, 0.0], [1.0, 2.0], [2.0, 6.0]]),
        "normal_load": np.array([[10.0, 20.0], [20.0, 10.0], [30.0, 0.0]]),
        "friction_energy": 1e-6 * np.array([[10.0, 60.0], [20.0, 70.0], [40.0, 90.0]]),
        "amplitude": np.array([1e-4, 8e-5, 1.2e-4]),
        "frequency_hz": np.array([450.0, 451.0, 449.5]),
        "normal_stiffness": np.full((3, 2), 1e7),
        "area": np.array([1e-6, 3e-6]),
        "energy_wear_coefficient": np.full(2, 1e-13),
        "converged": True,
        "message": "The wear covers 3e+06 cycles.",
        "warnings": ("A warning of the wear.",),
        "settings": {"motion": "highest peak"},
        "provenance": {},
    }
    return ss.Wear(**(arguments | changes))


def test_volume_and_mean_depth_are_those_of_both_pairs() -> None:
    worn = wear_of()
    assert worn.volume == pytest.approx([0.0, 7e-12, 20e-12])
    assert worn.mean_depth == pytest.approx([0.0, 1.75e-6, 5e-6])
    assert worn.open_pairs.tolist() == [0, 0, 1]


def test_the_energy_times_the_coefficient_is_an_integral_over_the_cycles() -> None:
    # It rises by 20 uJ in 1e6 cycles: 80 uJ in the mean of the first 1e6, then 110 uJ for 2e6.
    assert wear_of().energy_volume == pytest.approx([0.0, 8e-12, 30e-12])


def test_the_file_comes_back_equal(tmp_path: Path) -> None:
    wear_of().save(tmp_path / "wear.nc")
    assert ss.Wear.load(tmp_path / "wear.nc") == wear_of()


def test_the_words_tell_what_wears_and_what_it_does() -> None:
    words = list(wear_of().words())
    assert "up to 6 µm, 5 µm in the mean, in all 0.02 mm³" in words[0]
    assert "from 100 to 120 µm (+20 %), between 80 and 120 µm" in words[1]
    assert words[2] == "Pairs without load at rest: 0 of 2 before, 1 after."
    assert repr(wear_of()).startswith("Wear(3e+06 cycles in 3 states: depth up to 6 um")
    assert "NOT converged" in repr(wear_of(converged=False))


def test_a_change_of_the_stiffness_is_told_from_a_thousandth_on() -> None:
    """Also one that returns to its first value."""
    rises = np.array([[1e7, 1e7], [1.5e7, 1e7], [3e7, 1e7]])
    worn = wear_of(normal_stiffness=rises)
    assert worn.changes_stiffness
    assert worn.total_normal_stiffness == pytest.approx([2e7, 2.5e7, 4e7])
    assert "from 2e+07 to 4e+07 N/m (+100 %), because" in list(worn.words())[2]
    returns = wear_of(normal_stiffness=np.array([[1e7, 1e7], [1.5e7, 1e7], [1e7, 1e7]]))
    assert returns.changes_stiffness
    assert not wear_of(normal_stiffness=1e7 * np.array([[1.0, 1.0], [1.0005, 1.0], [1.001, 1.0]])).changes_stiffness


def test_the_figure_shows_amplitude_frequency_and_depth() -> None:
    above, middle, below = wear_of().plot().axes
    assert above.lines[0].get_ydata() == pytest.approx([100.0, 80.0, 120.0])
    assert middle.lines[0].get_ydata() == pytest.approx([450.0, 451.0, 449.5])
    assert [np.asarray(line.get_ydata())[-1] for line in below.lines] == pytest.approx([6.0, 5.0])


@pytest.mark.parametrize(
    ("argument", "changes"),
    [
        ("cycles", {"cycles": np.array([0.0, 2.0, 1.0])}),
        ("cycles", {"cycles": np.array([1.0, 2.0, 3.0])}),
        ("area", {"area": np.array([1e-6, 0.0])}),
        ("amplitude", {"amplitude": np.ones(2)}),
    ],
)
def test_states_that_do_not_fit_are_rejected(argument: str, changes: dict[str, Any]) -> None:
    with rejects(ss.InputError, argument):
        wear_of(**changes)
