"""Linear peaks and the beginning of slip against closed forms of one mass, and against the nonlinear response."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence
from stickslip.solve.ridges.slip_onset import slip_onset

FREE, SPRING, LIMIT, RATIO, FORCE = 4e6, 1e6, 30.0, 0.02, 10.0
ROW = np.array([1.0, 0.0])


def problem() -> tuple[ss.Superelement, ss.ContactPairs, ss.Excitation]:
    """A mass of 1 kg on a spring, with a pair to the ground that slips along its motion; a second mass is far off."""
    structure = ss.Superelement(np.eye(2), np.diag([FREE, 1e9]))
    pairs = ss.ContactPairs([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]], 1e6, SPRING, 0.3, LIMIT / 0.3)
    return structure, pairs, ss.Excitation.force([FORCE, 0.0])


def test_peaks_and_first_slip_of_one_mass_are_closed_forms() -> None:
    onset = slip_onset(*problem(), ROW, modal_damping_ratio=RATIO)
    assert onset.stuck_peak is not None
    assert onset.free_peak is not None
    damped = np.sqrt(1.0 - 2.0 * RATIO**2)
    assert onset.stuck_peak.frequency_hz == pytest.approx(np.sqrt(FREE + SPRING) * damped / (2.0 * np.pi), rel=1e-5)
    height = FORCE / (FREE + SPRING) / (2.0 * RATIO * np.sqrt(1.0 - RATIO**2))
    assert onset.stuck_peak.amplitude == pytest.approx(height, rel=1e-5)
    assert onset.free_peak.frequency_hz == pytest.approx(np.sqrt(FREE) / (2.0 * np.pi), rel=2e-3)
    # the pair slips where its spring carries the friction limit
    assert onset.first == pytest.approx(LIMIT / SPRING / height, rel=2e-3)
    assert onset.nearly_all is not None
    assert onset.nearly_all[0] == pytest.approx(onset.first, rel=0.01)  # the only pair is the first one and all
    assert onset.trouble == ""


@pytest.mark.slow
def test_the_nonlinear_response_begins_to_slip_at_that_force() -> None:
    structure, pairs, excitation = problem()
    onset = slip_onset(structure, pairs, excitation, ROW, modal_damping_ratio=RATIO)
    assert onset.first is not None
    assert onset.stuck_peak is not None
    window = (0.98 * onset.stuck_peak.frequency_hz, 1.02 * onset.stuck_peak.frequency_hz)
    for factor, slips in ((0.98, False), (1.02, True)):
        response = ss.forced_response(
            structure, pairs, [factor * onset.first * FORCE, 0.0], frequency_hz=window, harmonics=1, samples=64,
            modal_damping_ratio=RATIO, threads=1,
        )  # fmt: skip
        assert (response.contact_state == ss.ContactState.STICK_SLIP).any() == slips


def test_a_normal_force_in_phase_lets_a_pair_shake_down() -> None:
    """|T| exceeds mu N at one end of the motion only, so the slider moves once: the limits of both ends add up."""
    structure = ss.Superelement(np.eye(1), np.array([[FREE]]))
    pairs = ss.ContactPairs([[1.0], [0.0], [1.0]], 1e6, SPRING, 0.3, LIMIT / 0.3)
    onset = slip_onset(structure, pairs, ss.Excitation.force([FORCE]), [1.0], modal_damping_ratio=RATIO)
    assert onset.stuck_peak is not None
    assert onset.first == pytest.approx(LIMIT / SPRING / onset.stuck_peak.amplitude, rel=2e-3)


def test_what_is_not_known_has_a_reason() -> None:
    undamped = slip_onset(*problem(), ROW)
    assert (undamped.first, undamped.nearly_all) == (None, None)
    printed_sentence(undamped.trouble)
    structure, _, excitation = problem()
    still = ss.ContactPairs([[0.0, 1.0], [0.0, 0.0], [0.0, 0.0]], 1e6, SPRING, 0.3, 1.0)
    at_rest = slip_onset(structure, still, excitation, ROW, modal_damping_ratio=RATIO)
    assert at_rest.first is None
    printed_sentence(at_rest.trouble)


@pytest.mark.slow
def test_a_mass_that_only_contact_holds_has_no_peak_without_contact() -> None:
    """Two masses joined by a spring, with a pair between the first one and the ground: free, both move as one body."""
    inner, ground = 9e6, 1e6
    stiffness = np.array([[inner, -inner], [-inner, inner]])
    structure = ss.Superelement(np.eye(2), stiffness)
    pairs = ss.ContactPairs([[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]], 1e6, ground, 0.3, LIMIT / 0.3)
    excitation = ss.Excitation.force([0.0, FORCE])
    onset = slip_onset(structure, pairs, excitation, [0.0, 1.0], modal_damping_ratio=RATIO)
    stuck = np.sqrt(np.linalg.eigvalsh(stiffness + np.diag([ground, 0.0]))[0] * (1.0 - 2.0 * RATIO**2))
    assert onset.is_loose
    assert onset.free_peak is None
    assert onset.stuck_peak is not None
    assert onset.stuck_peak.frequency_hz == pytest.approx(stuck / (2.0 * np.pi), rel=2e-3)
    # held by a spring of its own it is no longer loose
    held = ss.Superelement(np.eye(2), stiffness + np.diag([0.0, 1e5]))
    assert not slip_onset(held, pairs, excitation, [0.0, 1.0], modal_damping_ratio=RATIO).is_loose
    assert not slip_onset(*problem(), ROW, modal_damping_ratio=RATIO).is_loose
