"""Thinning by shape: nothing that the eye could see is lost, and no curve is cut."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.reporting.thinning import thinned

FREQUENCY = np.linspace(400.0, 500.0, 4001)


def resonance(peak: float, at: float) -> tuple[np.ndarray, np.ndarray]:
    return FREQUENCY, peak / np.hypot(1.0, FREQUENCY - at)


def test_nothing_is_left_out_while_all_fits() -> None:
    result = thinned([resonance(1.0, 440.0)], 5000)
    assert (result.indices[0].size, result.tolerance) == (4001, 0.0)


def test_ends_peak_and_shape_stay() -> None:
    curves = [resonance(100.0, 440.0), resonance(0.01, 470.0)]
    result = thinned(curves, 200)
    assert sum(retained.size for retained in result.indices) <= 200
    for (x, y), retained in zip(curves, result.indices, strict=True):
        assert {0, int(y.argmax()), x.size - 1} <= set(retained)
        drawn = np.interp(x, x[retained], y[retained])
        # straight lines: the distance across is at most the distance in height
        slope = np.abs(np.gradient(drawn / 100.0, x / 100.0)).max()
        assert np.abs(drawn - y).max() / 100.0 <= result.tolerance * (1.0 + slope)


def test_a_fold_stays_a_fold() -> None:
    angle = np.linspace(0.0, 4.0 * np.pi, 3000)
    x, y = 450.0 + 5.0 * np.cos(angle) + angle, 10.0 + 5.0 * np.sin(angle)
    retained = thinned([(x, y)], 100).indices[0]
    assert retained.size <= 100
    assert (np.diff(x[retained]) < 0).any()
    assert x[retained].min() == pytest.approx(x.min(), abs=0.1)


@pytest.mark.slow
def test_many_curves_keep_at_least_their_ends() -> None:
    result = thinned([resonance(1.0, 430.0 + k) for k in range(20)], 10)
    assert result.tolerance == 0.02
    assert all({0, 4000} <= set(retained) for retained in result.indices)
