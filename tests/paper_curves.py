"""Synthetic curves for the claims of the paper study: every number can be set."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.papers.rough_damper.plan import Setting
from stickslip.papers.rough_damper.records import Solved
from stickslip.results.peaks import peaks as peaks_of

PAIRS = 4
SAMPLES = 8
NUMBERS = {
    "peak_m": 1e-5,
    "peak_hz": 450.0,
    "peak_inside": 1.0,
    "stuck_peak_m": 2e-5,
    "stuck_peak_hz": 452.0,
    "first_stuck_hz": 452.0,
    "second_stuck_hz": 480.0,
    "half_power_width": 0.002,
    "equivalent_damping": 0.0015,
    "friction_energy_j": 1e-6,
    "viscous_energy_j": 1e-6,
    "input_energy_j": 2e-6,
    "normal_stiffness": 1e8,
    "tangential_stiffness": 8e7,
    "stuck": 1.0,
    "stick_slip": 2.0,
    "separating": 1.0,
    "unknowns_reduced": 699.0,
}


def resonance(frequency_hz: np.ndarray[Any, Any], peaks: tuple[tuple[float, float], ...]) -> np.ndarray[Any, Any]:
    """Sum of narrow peaks (Hz, m)."""
    return sum((a / (1.0 + ((frequency_hz - f) / 0.5) ** 2) for f, a in peaks), np.zeros_like(frequency_hz))


def curve(
    setting: dict[str, Any] | None = None,
    peaks: tuple[tuple[float, float], ...] = ((450.0, 1e-5),),
    shares: tuple[float, float, float] = (0.6, 0.4, 0.0),
    phases: Any = None,
    **numbers: float,
) -> Solved:
    """A curve with the given labels, peaks and numbers."""
    base = Setting("base", "same", 5.0, 100.0, 2.4, 1e-9, "consistent")
    frequency = np.linspace(405.0, 535.0, 1301)
    amplitude = resonance(frequency, peaks)
    return Solved(
        setting=replace(base, **(setting or {})),
        numbers={**NUMBERS, "peak_m": peaks[0][1], "peak_hz": peaks[0][0], **numbers},
        frequency_hz=frequency,
        amplitude_m=amplitude,
        stable=np.ones(frequency.size, dtype=bool),
        energy_j=1e5 * amplitude**2,
        counts=np.tile([1, 2, 1], (frequency.size, 1)),
        pair_state=np.array([0, 1, 1, 2]),
        pair_energy_j=np.zeros(PAIRS),
        pair_position=np.array([[0.0, 0.0], [1e-3, 0.0], [0.0, 0.0], [1e-3, 0.0]]),
        pair_face=np.array([0, 0, 1, 1]),
        signals=np.ones((3, 6, SAMPLES)),
        phase_state=np.zeros((3, SAMPLES), dtype=int) if phases is None else np.asarray(phases),
        sides=np.zeros((2, 3, SAMPLES)),
        shares=np.array(shares),
        peak_list=np.array([(p.frequency_hz, p.amplitude) for p in peaks_of(frequency, amplitude) if p.bracketed]),
        mode_table=np.array([[mode, 500.0, 500.01, 0.002, 0.99] for mode in range(1, 11)]),
        warnings=(),
    )
