"""The gradients of the peak on the page: tornado plot, table, and what it says of large changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stickslip.reporting.gradient_section import change_rows, derivative_rows, labels, tornado
from stickslip.reporting.page import page
from stickslip.reporting.view import View
from stickslip.results.peak_gradients import PeakGradients
from stickslip.results.response import ForcedResponse
from synthetic import synthetic_response, synthetic_study

STUDY = synthetic_study(columns=4, rows=3)


def with_gradients(largest: float) -> ForcedResponse:
    """The curve, and gradients of which the strongest changes the peak by ``largest`` for 10 %."""
    relative = np.array([0.02, -10.0 * largest, 1e-9, 0.3])
    value = np.array([0.3, 7.0, 3.0, 2.4])
    gradients = PeakGradients(
        names=("friction.coefficient", "geometry.airfoil_thickness", "geometry.excitation_height", "a <b> & c.d_e"),
        units=("1", "mm", "um", "1"),
        value=value,
        amplitude=np.array(2e-5),
        frequency_hz=np.array(440.0),
        friction_energy=np.array(1e-4),
        by_amplitude=2e-5 * relative / value,
        by_frequency_hz=440.0 * np.array([0.1, -0.5, 0.0, 1e-9]) / value,
        by_friction_energy=1e-4 * np.array([1.0, 2.0, 0.0, 3.0]) / value,
        error_amplitude=np.zeros(4),
        error_frequency_hz=np.zeros(4),
        error_friction_energy=np.zeros(4),
        messages=("One message.",),
    )
    return replace(synthetic_response(columns=4, rows=3, n_points=20), gradients=gradients)


def section(response: ForcedResponse) -> str:
    text = page(response, STUDY)
    return text[text.index("<h2>Which input matters most</h2>") :].partition("</section>")[0]


@pytest.mark.slow
def test_the_page_shows_the_strongest_inputs_first() -> None:
    response = with_gradients(0.2)
    words = section(response)
    assert "20 µm at 440.00 Hz" in words
    assert "First order" in words
    assert "<li>One message.</li>" in words
    assert "is not an estimate" not in words
    assert "a &lt;b&gt; &amp; c.<wbr>d_<wbr>e" in words  # a long key may break on a phone
    view = View.of(response, STUDY)
    changes, derivatives = change_rows(view), derivative_rows(view)
    assert [row[0] for row in changes][:2] == ["geometry.airfoil_thickness", "a <b> & c.d_e"]
    assert [row[0] for row in derivatives] == [row[0] for row in changes]
    assert changes[0][1:] == ["7\u00a0mm", "−20", "−22", "+20"]
    assert derivatives[0][1:] == ["mm", "−5.71", "−31.4", "28.6"]
    assert changes[-1][1:] == ["3\u00a0µm", "0", "0", "0"]
    assert derivatives[-1][1:] == ["µm", "0", "0", "0"]


def test_the_bars_go_to_both_sides() -> None:
    more, less = tornado(View.of(with_gradients(0.2), STUDY))["data"]
    assert more["y"] == ["airfoil thickness", "d e", "friction coefficient"]  # the fourth has no effect
    assert more["x"] == [-20.0, 3.0, 0.2]
    assert less["x"] == [20.0, -3.0, -0.2]
    assert more["text"] == ["−20", "+3", "+0.2"]
    assert more["marker"]["pattern"]["shape"] != less["marker"]["pattern"]["shape"]


@pytest.mark.slow
def test_bars_beyond_the_first_order_are_truncated_and_named() -> None:
    response = with_gradients(2.7)
    more, _ = tornado(View.of(response, STUDY))["data"]
    assert more["x"][0] == -50.0
    assert more["text"][0] == "−270"
    assert "Use the derivative by airfoil thickness for smaller changes only" in section(response)


def test_labels_of_inputs() -> None:
    names = ["friction.coefficient", "interfaces.left.friction", "forces.N1.amplitude", "factor of normal load"]
    assert labels(names) == ["friction coefficient", "left: friction", "N1: amplitude", "factor of normal load"]
    assert labels(["bodies.a.density", "interfaces.a.density"]) == ["bodies.a.density", "interfaces.a.density"]


@pytest.mark.slow
def test_a_page_without_gradients_has_no_such_section() -> None:
    assert "Which input matters most" not in page(synthetic_response(columns=4, rows=3, n_points=20), STUDY)
