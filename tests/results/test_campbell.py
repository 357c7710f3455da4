"""The Campbell diagram: speeds from the inputs, crossings with engine orders in closed form, and its figure."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from stickslip.reporting.campbell_figure import campbell_figure, crossing_rows
from stickslip.reporting.compare_page import compare_page
from stickslip.results.campbell import Campbell, campbell, crossings
from stickslip.results.comparison import Compared
from synthetic import synthetic_response, synthetic_study


def turning(name: str, speed: str, factor: float) -> Compared:
    """The synthetic result at a speed, with its stuck frequencies times a factor."""
    response, study = synthetic_response(), synthetic_study()
    linear = dataclasses.replace(response.linear, stuck_frequency_hz=factor * response.linear.stuck_frequency_hz)
    inputs = f'{study.inputs}\n[rotation]\nspeed = "{speed}"\n' if speed else study.inputs
    return Compared(name, dataclasses.replace(response, linear=linear), dataclasses.replace(study, inputs=inputs))


def test_crossings_of_straight_lines() -> None:
    """f = 100 + rpm / 60 Hz crosses k rpm / 60 where rpm / 60 = 100 / (k - 1)."""
    speed = np.array([0.0, 3000.0, 9000.0])
    found = crossings(speed, 100.0 + speed[:, None] / 60.0, (1, 2, 3, 5))
    assert [(each.order, each.mode) for each in found] == [(5, 1), (3, 1), (2, 1)]
    for each in found:
        assert each.speed_rpm / 60.0 == pytest.approx(100.0 / (each.order - 1))
        assert each.frequency_hz == pytest.approx(each.order * each.speed_rpm / 60.0)


def test_a_crossing_at_a_computed_speed_counts_once_and_missing_modes_not_at_all() -> None:
    speed = np.array([1000.0, 3000.0, 6000.0])
    constant = np.column_stack([np.full(3, 100.0), [np.nan, 100.0, np.nan]])
    found = crossings(speed, constant, (2,))
    assert [(each.mode, each.speed_rpm) for each in found] == [(1, 3000.0)]


def test_the_diagram_is_in_the_order_of_the_speeds() -> None:
    results = [turning("fast", "600 rad/s", 1.2), turning("still", "", 1.0), turning("slow", "3000 rpm", 1.1)]
    diagram = campbell(results)
    assert diagram is not None
    assert diagram.names == ("slow", "fast")
    assert diagram.speed_rpm == pytest.approx([3000.0, 600.0 * 30.0 / np.pi])
    first = synthetic_response().linear.stuck_frequency_hz[0]
    assert diagram.stuck_hz[:, 0] == pytest.approx([1.1 * first, 1.2 * first])
    assert campbell(results[:2]) is None


def test_engine_orders_of_the_excitation_are_the_only_ones() -> None:
    frequency = np.array([[100.0], [100.0]])
    diagram = Campbell(("a", "b"), np.array([600.0, 6000.0]), frequency, 0.8 * frequency, asked=(4,))
    assert [each.order for each in diagram.crossings()] == [4]
    figure = campbell_figure(diagram)
    lines = [trace["name"] for trace in figure["data"] if trace["name"].startswith("engine order")]
    assert lines == ["engine order 4"]
    assert [note["text"] for note in figure["layout"]["annotations"]] == ["4"]


@pytest.mark.slow
def test_the_page_has_the_diagram_with_its_crossings() -> None:
    results = [turning("slow", "3000 rpm", 1.0), turning("fast", "9000 rpm", 1.01)]
    text = compare_page(results)
    assert "Campbell diagram" in text
    assert "contain stress stiffening" in text
    assert "Campbell diagram" not in compare_page([turning("a", "", 1.0), turning("b", "", 1.0)])
    diagram = Campbell(("a", "b"), np.array([600.0, 6000.0]), np.array([[100.0], [100.0]]), np.array([[80.0], [80.0]]))
    figure = campbell_figure(diagram)
    marks = figure["data"][-1]
    assert marks["x"] == pytest.approx(sorted(6000.0 / order for order in range(1, 11)))
    assert crossing_rows(diagram)[-1] == ("1", "1", "6000", "100.00")
    names = [note["text"] for note in figure["layout"]["annotations"]]
    assert names == [str(order) for order in range(1, 11)]  # beside each other or in rows


def test_names_of_engine_orders_do_not_overlap() -> None:
    speeds, frequency = np.array([600.0, 6000.0]), np.array([[900.0], [900.0]])
    diagram = Campbell(("a", "b"), speeds, frequency, 0.8 * frequency)
    few, named = campbell_figure(diagram), [str(order) for order in diagram.orders][:15]
    many = campbell_figure(Campbell(("a", "b"), speeds, frequency, 0.8 * frequency, asked=tuple(range(1, 60))))
    assert [note["text"] for note in few["layout"]["annotations"]][:15] == named
    places = [(note["x"] / 6000.0, note["y"] / (1.08 * 900.0)) for note in many["layout"]["annotations"]]
    assert len(places) < 59  # no room for all
    for at, (x, y) in enumerate(places):
        assert all(abs(x - other) >= 0.0499 or abs(y - height) >= 0.0449 for other, height in places[:at])
