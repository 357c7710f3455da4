"""Equivalent damping from energies against the damping that a linear structure has."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from stickslip.results.measures import equivalent_damping, summary

RATIO = 0.004


def oscillators(cosine: list[float], sine: list[float]) -> ss.ForcedResponse:
    """Equal oscillators on a stuck contact, k = 5e6 N/m and 1 kg each, through their resonance at 355.9 Hz."""
    superelement = ss.Superelement(np.eye(3), 4e6 * np.eye(3))
    pairs = ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3, 1e9)
    excitation = ss.Excitation.force(np.array(cosine)[:, None], np.array(sine)[:, None])
    window = (345.0, 367.0)
    return ss.forced_response(
        superelement, pairs, excitation, frequency_hz=window, harmonics=1, modal_damping_ratio=RATIO
    )


@pytest.mark.long
@pytest.mark.parametrize(
    ("cosine", "sine"),
    [([1.0, 0.0, 0.0], [0.0, 0.0, 0.0]), ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])],
    ids=["one alone", "two a quarter period apart"],
)
def test_it_is_the_modal_damping_at_resonance_whatever_the_phases_are(cosine: list[float], sine: list[float]) -> None:
    response = oscillators(cosine, sine)
    output = np.array([1.0, 0.0, 0.0])
    measures = summary(response, output)
    assert measures.equivalent_damping == pytest.approx(RATIO, rel=5e-3)
    assert measures.half_power_width == pytest.approx(RATIO, rel=0.05)
    # off resonance the loss per cycle of a viscous damper is c w |u|^2 pi, so the ratio falls with the frequency
    natural = np.sqrt(5e6) / (2 * np.pi)
    assert equivalent_damping(response) == pytest.approx(RATIO * natural / response.frequency_hz, rel=1e-6)
    amplitude, omega = response.harmonic_amplitude(output, 1), 2 * np.pi * response.frequency_hz
    moving = sum(1 for part in (cosine, sine) if any(part))
    assert response.kinetic_energy == pytest.approx(moving * 0.5 * omega**2 * amplitude**2, rel=1e-9)
