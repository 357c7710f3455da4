"""Antiresonances of linear curves against the closed form of two masses."""

from __future__ import annotations

import numpy as np

from stickslip.reporting.antiresonances import with_antiresonances
from stickslip.results.periodic_amplitude import periodic_amplitude


def receptance(frequency_hz: np.ndarray) -> np.ndarray:
    """(n, 3) coefficients of the driven one of two equal masses between three springs: it rests at 200 Hz."""
    ratio = (frequency_hz / 200.0) ** 2
    complex_gain = (1.0 - ratio + 0.002j) / ((1.0 - ratio + 0.002j) ** 2 - 0.25)
    return np.column_stack([np.zeros(frequency_hz.size), complex_gain.real, -complex_gain.imag])


def test_an_antiresonance_between_two_points_is_resolved() -> None:
    grid = np.linspace(150.0, 260.0, 38)
    exact = periodic_amplitude(receptance(np.linspace(199.0, 201.0, 4001))).min()
    coarse = periodic_amplitude(receptance(grid)).min()
    frequency, amplitude = with_antiresonances(grid, receptance(grid))
    assert coarse > 1.5 * exact  # no point of the grid is near enough
    assert exact <= amplitude.min() * (1.0 + 1e-6) < 1.2 * exact
    assert (np.diff(frequency) > 0.0).all()
    np.testing.assert_allclose(amplitude, periodic_amplitude(receptance(frequency)), rtol=2e-3)
