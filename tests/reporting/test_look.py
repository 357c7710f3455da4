"""The marks of a map: as large as asked for on a coarse grid, apart on a fine or scattered one."""

import numpy as np
import pytest

from stickslip.reporting.look import axis_look, log_axis, map_range, mark_size

DRAWING = (400.0, 160.0)


def grid(along: int, across: int) -> np.ndarray:
    x, y = np.meshgrid(np.linspace(-14.0, 14.0, along), np.linspace(-3.0, 3.0, across))
    return np.column_stack([x.ravel(), y.ravel()])


def test_a_coarse_grid_takes_the_largest_mark() -> None:
    assert mark_size(grid(11, 5), DRAWING, 17.0) == 17.0
    assert mark_size(np.zeros((1, 2)), DRAWING, 17.0) == 17.0


def test_marks_of_a_fine_grid_touch_and_do_not_overlap() -> None:
    position = grid(41, 11)
    size = mark_size(position, DRAWING, 17.0)
    spacing = 0.6 * 400.0 / np.ptp(map_range(position)[0])  # across, on a map to scale
    assert size == pytest.approx(spacing)


def test_nine_in_ten_of_scattered_marks_are_apart() -> None:
    position = np.random.default_rng(1).uniform([-14.0, -3.0], [14.0, 3.0], (130, 2))
    size = mark_size(position, DRAWING, 17.0)
    assert 3.0 <= size < 17.0
    places = position * (np.array(DRAWING) / np.ptp(map_range(position), axis=1)).min()
    distance = np.abs(places[:, None] - places).max(axis=2) + 1e9 * np.eye(len(places))
    assert (distance.min(axis=1) < size).mean() <= 0.1 or size == 3.0


def test_marks_stay_visible_in_a_crowd() -> None:
    assert mark_size(grid(400, 100), DRAWING, 17.0) == 3.0


def test_an_upright_map_is_at_least_half_as_wide_as_high_about_its_face() -> None:
    narrow = grid(11, 5)[:, ::-1] * [0.1, 1.0] + [7.0, 0.0]
    across, up = map_range(narrow)
    assert np.ptp(across) == pytest.approx(0.5 * np.ptp(up))
    assert across.mean() == pytest.approx(7.0)


def test_a_flat_map_is_as_wide_as_its_face() -> None:
    assert np.ptp(map_range(grid(11, 5))[0]) == pytest.approx(1.12 * 28.0 + 0.8)


def test_small_numbers_of_axes_have_powers_and_no_prefix_beside_the_one_of_their_unit() -> None:
    assert axis_look("Amplitude, µm")["exponentformat"] == "power"


def test_logarithmic_axes_have_plain_numbers_while_they_are_readable() -> None:
    axis = log_axis("Force, N", [0.1, 5.0, 300.0])
    assert (axis["type"], axis["tickformat"], axis["dtick"]) == ("log", ".6~g", 1)
    assert log_axis("Force, N", [2.0, 60.0])["dtick"] == "D2"
    assert "dtick" not in log_axis("Force, N", [2.0, 6.0])


def test_logarithmic_axes_beyond_have_powers_of_ten_at_every_decade() -> None:
    axis = log_axis("Depth, m", [3e-9, 2e1])
    assert axis["tickvals"] == [10.0**decade for decade in range(-9, 3)]
    assert axis["ticktext"][0] == "10<sup>−9</sup>"
    assert axis["ticktext"][9:] == ["10<sup>0</sup>", "10<sup>1</sup>", "10<sup>2</sup>"]
    assert "tickformat" not in axis


def test_a_logarithmic_axis_does_not_show_round_off() -> None:
    low, high = log_axis("Damping ratio, %", [0.1, 0.1 + 1e-15])["range"]
    assert high - low == pytest.approx(0.4)
    assert low + high == pytest.approx(-2.0)
