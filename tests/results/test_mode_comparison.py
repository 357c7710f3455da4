"""The sentence on the differences of a quasi-static estimate from the nonlinear mode."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from sentences import printed_sentence
from stickslip.results.mode_comparison import comparison

AMPLITUDE = np.geomspace(1e-6, 1e-4, 5)


def backbone(amplitude: np.ndarray, change: float, ratio: np.ndarray) -> Any:
    """A mode whose frequency falls by a part at the largest amplitude."""
    frequency_hz = 100.0 * (1.0 + change * np.linspace(0.0, 1.0, amplitude.size))
    return SimpleNamespace(modal_amplitude=amplitude, frequency_hz=frequency_hz, damping_ratio=ratio)


def test_it_has_the_differences_at_both_ends() -> None:
    ratio = np.linspace(0.001, 0.02, 5)
    estimate = backbone(AMPLITUDE, -0.02, ratio)
    # The mode from the sliding limit has its largest amplitude first.
    mode = backbone(AMPLITUDE[::-1], 0.0, ratio[::-1])
    printed_sentence(comparison(mode, estimate))


def test_it_has_the_amplitude_from_which_on_they_differ() -> None:
    ratio = np.full(5, 0.001)
    apart = ratio * [1.0, 1.0, 1.2, 1.5, 2.0]
    words = comparison(backbone(AMPLITUDE, 0.0, ratio), backbone(AMPLITUDE, 0.0, apart))
    printed_sentence(words)
    assert "From 1e-05 m kg^0.5 on" in words


def test_only_common_amplitudes_are_compared() -> None:
    ratio = np.full(5, 0.001)
    mode, estimate = backbone(AMPLITUDE, 0.0, ratio), backbone(AMPLITUDE[:3], 0.0, ratio[:3])
    assert "instead of 0.1 % at the largest" in comparison(mode, estimate)
    assert "no amplitude in common" in comparison(mode, backbone(1e-3 * AMPLITUDE, 0.0, ratio))
