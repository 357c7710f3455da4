"""Narrow peaks where a higher harmonic of the contact excites a natural frequency."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence

SMALL_MASS = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0])


def two_masses() -> tuple[ss.Superelement, ss.ContactPairs]:
    """A mass on a spring and a pair that slips, and a small one at its side, whose natural frequency of about 38.7 Hz
    the third harmonic of the friction force excites at a third of it."""
    square = (2.0 * np.pi * 10.0) ** 2
    stiffness = np.diag([1.0, 400.0, 400.0, 0.3, 8.0, 8.0]) * square
    stiffness[0, 3] = stiffness[3, 0] = -0.02 * square
    operator = np.hstack([np.eye(3), np.zeros((3, 3))])
    pairs = ss.ContactPairs(operator, 1e-3 * square, 0.5 * square, 0.5, 0.09 * square)
    return ss.Superelement(np.diag([1.0, 1.0, 1.0, 0.02, 0.02, 0.02]), stiffness), pairs


def curve(low_hz: float, high_hz: float) -> ss.ForcedResponse:
    force = np.array([0.15 * (2.0 * np.pi * 10.0) ** 2, 0.0, 0.0, 0.0, 0.0, 0.0])
    return ss.forced_response(
        *two_masses(), force, frequency_hz=(low_hz, high_hz), harmonics=3, samples=512, modal_damping_ratio=1e-4,
        outputs=SMALL_MASS, checks=False,
    )  # fmt: skip


@pytest.mark.slow
def test_a_peak_of_a_harmonic_that_the_curve_stepped_over_has_a_warning() -> None:
    """No step ends at a third of a natural frequency, because no force excites it there."""
    whole, part = curve(11.0, 15.0), curve(12.89, 12.93)
    near = np.abs(whole.frequency_hz - 12.91) < 0.4
    assert part.converged
    assert part.amplitude(SMALL_MASS).max() > 10.0 * whole.amplitude(SMALL_MASS)[near].max()
    (warning,) = [each for each in whole.warnings if "narrow peaks of an output" in each]
    printed_sentence(warning, "12.91", numbers=False)
    assert not any("narrow peaks" in each for each in part.warnings)


@pytest.mark.slow
def test_where_all_pairs_stick_no_harmonic_excites_anything() -> None:
    superelement, pairs = two_masses()
    response = ss.forced_response(
        superelement, pairs, 1e-3 * np.ones(6), frequency_hz=(11.0, 15.0), modal_damping_ratio=1e-4, outputs=SMALL_MASS
    )
    assert not any("narrow peaks" in each for each in response.warnings)
