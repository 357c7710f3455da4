"""Forces of the slices of a crowned line: sums, limits, the closed form of a linear contact, open ends."""

from __future__ import annotations

import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.crowned_line import crowned_forces
from stickslip.contact.pairing.line_pairs import crown_drop
from stickslip.contact.stiffness.hertz_line import HertzLine, LineBody
from stickslip.core.errors import InputError

LINE = HertzLine(6.6e-3, *(LineBody(2e11, 0.3, 1e-3),) * 2)
LENGTH = 28e-3
POSITION = np.linspace(-0.5, 0.5, 401) * LENGTH
SLICE = np.full(POSITION.size, LENGTH / POSITION.size)


def test_a_straight_line_carries_a_uniform_force() -> None:
    forces = crowned_forces(LINE, 300.0, SLICE, np.zeros(SLICE.size))
    np.testing.assert_allclose(forces, 300.0 / SLICE.size, rtol=1e-12)


@pytest.mark.parametrize("drop", [0.3e-6, 20e-6])
def test_forces_have_the_sum_and_the_shape_of_the_profile(drop: float) -> None:
    profile = crown_drop(POSITION, LENGTH, drop)
    assert profile[[0, 200, 400]] == pytest.approx([drop, 0.0, drop])
    forces = crowned_forces(LINE, 300.0, SLICE, profile)
    closed = forces > 0.0
    assert forces[closed].sum() == pytest.approx(300.0, rel=1e-12)
    approach = LINE.approach(forces[closed] / SLICE[closed]) + profile[closed]
    np.testing.assert_allclose(approach, approach[0], rtol=1e-9)  # one approach for all slices
    assert closed.all() == (drop < 1e-6)
    assert forces.argmax() == 200
    stiffness = LINE.stiffness(np.array([300.0 / LENGTH]))[0]
    gap = profile[~closed] - approach[0]
    np.testing.assert_allclose(forces[~closed], -stiffness * SLICE[~closed] * gap, rtol=1e-9)


def test_a_strong_crown_has_the_length_of_a_linear_contact() -> None:
    """For springs k per length: delta = (3 F / (8 k) sqrt(4 D) / L)^(2/3), contact from -a to a, a = L sqrt(delta / D)
    / 2. The line's stiffness hardly changes between the slices, so both agree to some percent."""
    drop = 50e-6
    forces = crowned_forces(LINE, 300.0, SLICE, crown_drop(POSITION, LENGTH, drop))
    found = np.count_nonzero(forces > 0.0) / forces.size * LENGTH
    secant = forces.max() / SLICE[0] / LINE.approach(np.array([forces.max() / SLICE[0]]))[0]
    delta = (3.0 * 300.0 * np.sqrt(drop) / (2.0 * secant * LENGTH)) ** (2.0 / 3.0)
    assert found == pytest.approx(LENGTH * np.sqrt(delta / drop), rel=0.03)


def test_loads_that_no_line_carries() -> None:
    shallow = HertzLine(6.6e-3, *(LineBody(2e11, 0.3, 1e-5),) * 2)
    with rejects(InputError, "total"):
        crowned_forces(shallow, 1e6, SLICE, np.zeros(SLICE.size))
    with rejects(InputError, "total"):
        crowned_forces(LINE, 0.0, SLICE, np.zeros(SLICE.size))
