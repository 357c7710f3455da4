"""The Campbell diagram of a rotating beam and of a whirling mass: frequencies, crossings, figure and input errors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import rejects
from stickslip.structure.rotating_superelement import RPM

NATURAL = 100.0  # Hz


@pytest.fixture(scope="module")
def rotor() -> Any:
    """A mass on equal springs across the axis: it whirls at f +- speed in the rotating frame."""
    mass, squared = 2.0, (2.0 * np.pi * NATURAL) ** 2
    rest = ss.Superelement(mass * np.eye(2), mass * squared * np.eye(2))
    coriolis = 2.0 * mass * np.array([[0.0, -1.0], [1.0, 0.0]])
    empty = np.zeros(0)
    return ss.RotatingSuperelement(rest, -mass * np.eye(2), coriolis, np.zeros(2), 5000.0, empty, empty)


def ground(stiffness: float) -> Any:
    return ss.ContactPairs(np.vstack([np.eye(2), np.zeros((1, 2))]), 1.0, stiffness, 0.5, normal_load=10.0)


def test_a_whirling_mass_has_two_straight_lines_and_its_crossings(rotor: Any) -> None:
    # Forward and backward whirl are f - s and f + s at the speed s in revolutions per second; order k crosses them at
    # s = f / (k + 1) and s = f / (k - 1).
    speed = np.linspace(0.0, 5000.0, 11)
    diagram = ss.campbell_diagram(rotor, None, speed, count=3)
    np.testing.assert_allclose(diagram.free_hz[:, 0], NATURAL - speed / 60.0, rtol=1e-9)
    np.testing.assert_allclose(diagram.free_hz[:, 1], NATURAL + speed / 60.0, rtol=1e-9)
    assert np.isnan(diagram.free_hz[:, 2]).all()
    assert diagram.names[-1] == "5000 rpm"
    found = {(each.mode, each.order): each.speed_rpm for each in diagram.crossings("free")}
    expected = {(1, k): 6000.0 / (k + 1) for k in diagram.orders if 6000.0 / (k + 1) <= 5000.0}
    expected |= {(2, k): 6000.0 / (k - 1) for k in diagram.orders if k > 2}
    assert found.keys() == expected.keys()
    for key, at in expected.items():
        assert found[key] == pytest.approx(at, rel=1e-9)


def test_stuck_contact_adds_its_springs_at_each_speed(rotor: Any) -> None:
    speed = np.array([0.0, 2500.0, 5000.0])

    def joint(rpm: float) -> Any:
        return ground(1e5 + 40.0 * rpm)

    diagram = ss.campbell_diagram(rotor, joint, speed, count=2)
    alone = np.sqrt(NATURAL**2 + (1e5 + 40.0 * speed) / 2.0 / (2.0 * np.pi) ** 2)
    np.testing.assert_allclose(
        diagram.stuck_hz, np.column_stack([alone - speed / 60.0, alone + speed / 60.0]), rtol=1e-9
    )
    constant = ss.campbell_diagram(rotor, ground(1e5), speed, count=2)
    np.testing.assert_allclose(constant.stuck_hz[0], diagram.stuck_hz[0])
    figure = diagram.plot()
    axes = figure.axes[0]
    assert len(axes.lines) == 4 + len(diagram.orders) + 1  # two limits of two modes, engine orders, crossings
    marks = np.asarray(axes.lines[-1].get_xydata())
    assert len(marks) == len(diagram.crossings())
    assert [text.get_text() for text in axes.texts] == [str(order) for order in diagram.orders]


def test_input_errors(rotor: Any) -> None:
    with rejects(ss.InputError, "speed_rpm"):
        ss.campbell_diagram(rotor, None, [3000.0, 1000.0])
    with rejects(ss.InputError, "speed_rpm"):
        ss.campbell_diagram(rotor, None, [0.0, 9000.0])
    with rejects(ss.InputError, "operator"):
        ss.campbell_diagram(rotor, ss.ContactPairs(np.eye(3), 1.0, 1.0, 0.5, normal_load=1.0), [0.0, 1000.0])
    with rejects(ss.InputError, "limit"):
        ss.campbell_diagram(rotor, None, [0.0, 1000.0]).crossings("both")  # type: ignore[arg-type]


def test_the_collapse_of_the_mass_is_at_its_natural_frequency(rotor: Any) -> None:
    assert rotor.collapse_speed_rpm == pytest.approx(60.0 * NATURAL)
    assert rotor.at(3000.0).gyroscopic[1, 0] == pytest.approx(2.0 * 2.0 * 3000.0 * RPM)
