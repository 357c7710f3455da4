"""The result of a ridge of peaks: interpolation, optimum, switches, its file and its figure."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from ridges import ridge_of, valley
from sentences import printed_sentence, rejects
from stickslip.core.validation import FloatArray
from stickslip.results.checked_peak import CheckedPeak, spread
from stickslip.results.ridge_words import STUCK_OPTIMUM

LOADS = np.geomspace(1.0, 100.0, 15)
FALLING = ridge_of((LOADS, 1e-5 / LOADS))


def test_the_interpolation_is_that_of_logarithms() -> None:
    ridge, between = ridge_of((LOADS, valley(LOADS))), np.geomspace(1.0, 100.0, 57)
    top = ridge.at(between)
    assert top.amplitude == pytest.approx(valley(between), rel=5e-4)
    assert top.frequency_hz == pytest.approx(50.0, rel=1e-12)
    power = FALLING.at(between)
    assert power.amplitude == pytest.approx(1e-5 / between, rel=1e-12)


def test_known_slopes_make_the_line_between_distant_points_right() -> None:
    """A valley of seven points over two decades: parabolas through neighbours miss it by several per cent."""
    few, between = np.geomspace(1.0, 100.0, 7), np.geomspace(1.0, 100.0, 57)
    slopes = 0.5 * (few / 10.0 - 10.0 / few) / (few / 10.0 + 10.0 / few)
    errors = [
        float(np.abs(ridge_of((few, valley(few)), **known).at(between).amplitude / valley(between) - 1.0).max())
        for known in ({}, {"slope": slopes})
    ]
    assert errors[1] < 0.004
    assert errors[0] > 4.0 * errors[1]


def test_the_line_passes_a_node_between_two_points() -> None:
    """The square of a resonance that the force hardly drives is a parabola; its logarithm has almost a pole."""
    node, floor = 0.02, 0.001

    def height(load: FloatArray) -> FloatArray:
        return np.asarray(1e-5 * np.hypot(np.log(load) - node, floor))

    loads = np.exp(np.array([-0.1, -0.05, 0.08, 0.15]))
    place = np.log(loads) - node
    ridge = ridge_of((loads, height(loads)), slope=place / (place**2 + floor**2))
    between = np.exp(np.linspace(-0.05, 0.08, 14))
    assert np.abs(ridge.at(between).amplitude - height(between)).max() < 0.02 * height(loads[2:3])[0]
    assert ridge.optimum.parameter == pytest.approx(np.exp(node), rel=0.01)
    assert ridge.optimum.amplitude < 0.1 * height(loads[1:2])[0]


def test_beyond_the_range_nothing_is_known() -> None:
    top = FALLING.at([0.5, 1.0, 200.0])
    assert np.isnan(top.amplitude).tolist() == [True, False, True]
    assert top.ridge.tolist() == [-1, 0, -1]


def test_the_optimum_is_the_lowest_valley_inside() -> None:
    best = ridge_of((LOADS, valley(LOADS))).optimum
    assert best.is_inside
    assert best.parameter == pytest.approx(10.0, rel=0.05)
    assert best.amplitude == pytest.approx(1e-5 * np.sqrt(2.0), rel=1e-3)


def test_a_lower_end_is_the_lowest_peak_and_the_valley_another_minimum() -> None:
    rise = np.where(LOADS < 30.0, valley(LOADS), valley(np.full(15, 30.0)) * (30.0 / LOADS) ** 2)
    ridge = ridge_of((LOADS, rise))
    assert ridge.optimum.parameter == pytest.approx(100.0)
    assert ridge.optimum.edge == "the upper end of the followed range"
    (other,) = ridge.other_minima
    assert other.is_inside
    assert other.parameter == pytest.approx(10.0, rel=0.05)
    printed_sentence("\n".join(ridge.words()))


def test_a_lower_valley_is_the_optimum_and_a_dip_is_not() -> None:
    """The lowest of two valleys counts, although the other one is nearer to the middle."""
    dips = valley(LOADS, 3.0) * np.where((LOADS > 25.0) & (LOADS < 40.0), 0.5, 1.0)
    ridge = ridge_of((LOADS, dips))
    lowest = LOADS[np.argmin(dips)]
    assert ridge.optimum.is_inside
    assert ridge.optimum.parameter == pytest.approx(lowest, rel=0.2)
    assert len(ridge.other_minima) == 1


def test_a_minimum_beside_a_gap_is_no_optimum() -> None:
    unknown = np.array([[LOADS[7], LOADS[10]]])
    ridge = ridge_of((LOADS, valley(LOADS)), unknown=unknown)
    assert ridge.optimum.parameter == pytest.approx(10.0)
    assert ridge.optimum.edge == "the edge of a gap in which the highest peak is unknown"


def test_a_stuck_minimum_is_named_as_one() -> None:
    stuck = dict.fromkeys(("pairs_stick_slip", "pairs_separating"), np.zeros(LOADS.size, dtype=int))
    assert STUCK_OPTIMUM in ridge_of((LOADS, valley(LOADS)), **stuck).words()
    assert STUCK_OPTIMUM not in ridge_of((LOADS, valley(LOADS))).words()


def test_without_a_valley_the_lowest_peak_is_at_an_end() -> None:
    assert FALLING.optimum.edge == "the upper end of the followed range"
    assert not FALLING.other_minima
    assert FALLING.optimum.parameter == pytest.approx(100.0)


def test_the_highest_ridge_switches() -> None:
    rising = 1e-6 * LOADS
    ridge = ridge_of((LOADS, 1e-5 / LOADS), (LOADS, rising))
    assert list(ridge.switches()) == pytest.approx([np.sqrt(10.0)], rel=1e-6)
    assert ridge.at([2.0, 5.0]).ridge.tolist() == [0, 1]
    # The highest peak is lowest at the switch.
    assert ridge.optimum.parameter == pytest.approx(np.sqrt(10.0), rel=0.05)


def test_a_ridge_that_begins_inside_counts_where_it_is_known() -> None:
    ridge = ridge_of((LOADS, 1e-5 / LOADS), (LOADS[10:], np.full(5, 1e-4)))
    assert ridge.at(LOADS[9:11]).ridge.tolist() == [0, 1]


@pytest.mark.slow
def test_the_file_comes_back_equal(tmp_path: Path) -> None:
    ridge = replace(FALLING, ends=(("", "beyond 3 N, the peak leaves the frequency range, at 60.00 Hz"),))
    ridge.save(tmp_path / "ridge.nc")
    assert ss.PeakRidge.load(tmp_path / "ridge.nc") == ridge
    assert ridge.to_dataset()["amplitude"].attrs["units"] == "m"


def test_another_scale_of_the_parameter() -> None:
    ratio = FALLING.over(10.0, "load over force", "")
    assert ratio.at(1.0).amplitude == pytest.approx(FALLING.at(10.0).amplitude)
    assert float(ratio.start) == pytest.approx(0.1)
    assert ratio.parameter_name == "load over force"


def test_the_figure_shows_peaks_limits_and_optimum() -> None:
    above, below = ridge_of((LOADS, valley(LOADS))).plot().axes
    labels = above.get_legend_handles_labels()[1]
    assert labels == ["linear, all stuck", "linear, no contact", "highest peak", "optimum:\n14.14 µm at 10 N"]
    assert above.get_yscale() == above.get_xscale() == "log"
    assert below.get_xlabel() == "load, N"


@pytest.mark.slow
def test_checks_and_doubtful_points_are_in_words_file_and_figure(tmp_path: Path) -> None:
    error = np.where(LOADS < 5.0, 0.2 / LOADS, 0.003)
    check = CheckedPeak(10.0, 1.5e-5, 49.5, 0.004, 7)
    ridge = ridge_of((LOADS, valley(LOADS)), estimated_error=error, checked=(check,))
    printed_sentence("\n".join(ridge.words()), "15 µm", "7 harmonics")
    ridge.save(tmp_path / "ridge.nc")
    assert ss.PeakRidge.load(tmp_path / "ridge.nc") == ridge
    assert ridge.over(10.0, "load over force", "").checked == (check._replace(parameter=1.0),)
    figure = ridge.over(1.0, "load", "").plot()  # without a unit
    assert figure.axes[0].get_legend_handles_labels()[1][-1] == "minimum with slip, checked:\n15 µm at 10"
    figure = ridge.plot()
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert labels[2] == "computed peaks, error above 1 %"
    assert labels[-1] == "minimum with slip, checked:\n15 µm at 10 N"
    figure.draw_without_rendering()
    legend = figure.legends[0].get_window_extent()
    assert figure.bbox.x0 < legend.x0 < legend.x1 < figure.bbox.x1
    assert legend.y1 < figure.bbox.y1


def test_without_doubtful_points_only_the_optimum_has_an_error() -> None:
    known = ridge_of((LOADS, valley(LOADS)), estimated_error=np.full(15, 0.009))
    first, *rest = known.words()
    plain, *others = ridge_of((LOADS, valley(LOADS))).words()
    assert rest == others
    assert first.startswith(plain.removesuffix(".") + ", estimated error 0.9")


def test_a_minimum_carries_the_largest_error_beside_it() -> None:
    """That of the points on both sides, and of the line between them."""
    error = np.where(LOADS > 8.0, 0.004, 0.06)
    smooth = ridge_of((LOADS, valley(LOADS)), estimated_error=error)
    assert float(next(smooth.words()).rpartition("error ")[2].split()[0]) == pytest.approx(6.0, abs=0.5)
    far = ridge_of((LOADS, valley(LOADS, 40.0)), estimated_error=error)
    assert float(next(far.words()).rpartition("error ")[2].split()[0]) == pytest.approx(0.4, abs=0.2)
    dip = valley(LOADS, 40.0) * np.where((LOADS > 25.0) & (LOADS < 40.0), 0.5, 1.0)
    line = ridge_of((LOADS, dip), estimated_error=error)
    assert float(next(line.words()).rpartition("error ")[2].split()[0]) > 2.0


def test_an_error_is_not_below_that_of_the_search_of_a_peak() -> None:
    fine = np.geomspace(1.0, 100.0, 200)
    ridge = ridge_of((fine, valley(fine)), estimated_error=np.zeros(200))
    assert next(ridge.words()).endswith("estimated error 0.01 %.")


def test_the_table_has_harmonics_and_errors_if_they_are_known() -> None:
    (plain,) = FALLING.tables("ridge", {})
    known = replace(FALLING, estimated_error=np.full(15, 0.02), point_harmonics=np.full(15, 5))
    (table,) = known.tables("ridge", {})
    added = [each for each in table.columns if each.name not in {own.name for own in plain.columns}]
    assert [(each.name, each.values[0]) for each in added] == [("harmonics", 5), ("estimated error", 0.02)]


def test_the_minimum_with_slip_is_not_the_stuck_one() -> None:
    dips = valley(LOADS, 3.0) * np.where((LOADS > 25.0) & (LOADS < 40.0), 0.2, 1.0)
    stuck = np.where(LOADS > 20.0, 0, 1)
    ridge = ridge_of((LOADS, dips), pairs_stick_slip=stuck, pairs_separating=np.zeros(15, dtype=int))
    assert ridge.optimum.parameter > 20.0
    assert ridge.slipping_minimum == ridge.other_minima[0]
    assert FALLING.slipping_minimum is None


def test_a_point_without_an_estimate_has_the_larger_one_of_its_neighbours() -> None:
    errors = [None, 0.1, None, 0.3, None, 0.2, 0.0, None]
    found = spread([(3, {} if error is None else {3: error}) for error in errors])
    assert found.tolist() == [0.1, 0.1, 0.3, 0.3, 0.3, 0.2, 0.0, 0.0]


def test_a_point_with_fewer_harmonics_than_its_neighbour_has_the_error_of_fewer() -> None:
    better = {3: 0.04, 5: 0.002}
    assert spread([(3, {3: 0.01}), (3, {}), (5, better), (5, {}), (3, {})]).tolist() == [0.01, 0.04, 0.002, 0.002, 0.04]


def test_the_error_between_points_contains_the_interpolation() -> None:
    """A dip between two points of a smooth curve, whose points are exact."""

    def exact(load: FloatArray) -> FloatArray:
        return valley(load) * (1.0 - 0.4 * np.exp(-((np.log(load / 30.0) / 0.25) ** 2)))

    ridge = ridge_of((LOADS, exact(LOADS)), estimated_error=np.full(15, 0.002), point_harmonics=np.full(15, 3))
    assert ridge.error_at(LOADS) == pytest.approx(0.002)
    between = np.geomspace(1.0, 100.0, 400)
    error = np.abs(ridge.at(between).amplitude / exact(between) - 1.0)
    estimate = ridge.error_at(between)
    assert error.max() > 0.02
    assert np.all(estimate > 0.5 * error)
    assert np.isnan(ridge.error_at(200.0)).all()
    printed_sentence("\n".join(ridge.words()), "line between the computed peaks")


def test_one_point_is_a_ridge() -> None:
    ridge = ridge_of((np.array([2.0]), np.array([1e-5])))
    assert ridge.at(2.0).amplitude == pytest.approx(1e-5)
    assert ridge.switches() == ()


@pytest.mark.parametrize(
    ("changes", "argument"),
    [
        ({"amplitude": np.ones(3)}, "amplitude"),
        ({"curvature": np.full(15, np.nan)}, "curvature"),
        ({"parameter": np.linspace(0.0, 1.0, 15)}, "parameter"),
    ],
)
def test_arrays_that_do_not_fit_are_rejected(changes: dict[str, Any], argument: str) -> None:
    with rejects(ss.InputError, argument):
        ridge_of((LOADS, 1e-5 / LOADS), **changes)


def test_a_value_that_is_not_positive_is_rejected() -> None:
    with rejects(ss.InputError, "parameter"):
        FALLING.at([1.0, 0.0])
