"""The quasi-static estimate of a mode: closed form of one slider, and the nonlinear mode at low amplitude."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from known_modes import friction_beam, one_mass
from sentences import printed_sentence, rejects


@pytest.mark.slow
def test_one_mass_with_a_slider_is_its_closed_form() -> None:
    superelement, pairs = one_mass(ratio=0.002)
    result = ss.quasi_static_mode(superelement, pairs, 1, (1e-6, 1e-3), points_per_decade=100)
    assert result.converged, result.message
    length = result.modal_amplitude / np.sqrt(2.0)
    slips = 5e5 * length > 10.0
    secant = 1e6 + np.where(slips, 10.0 / length, 5e5)
    omega = 2.0 * np.pi * result.frequency_hz
    assert omega**2 * 2.0 == pytest.approx(secant, rel=1e-9)
    energy = np.where(slips, 4.0 * 10.0 * (length - 10.0 / 5e5), 0.0)
    assert result.friction_energy == pytest.approx(energy, rel=2e-3, abs=2e-3 * energy.max() * 0.01)
    viscous = 2.0 * 0.002 * np.sqrt(0.75e6) / (2.0 * omega)
    ratio = energy / (2.0 * np.pi * secant * length**2) + viscous
    assert result.damping_ratio == pytest.approx(ratio, rel=2e-3, abs=2e-5)
    assert (result.contact_state[:, 0] == slips).all()


@pytest.mark.slow
def test_it_agrees_with_the_nonlinear_mode_at_low_amplitude() -> None:
    """With an Iwan joint, which slips at any amplitude under a constant normal load."""
    superelement, slider, _ = friction_beam()
    joint = ss.IwanJoint(np.array([1e7]), np.array([15.0]), np.array([-0.5]), np.array([1.0]))
    pairs = ss.ContactPairs.with_laws(slider.operator, [joint])
    exact = ss.nonlinear_mode(superelement, pairs, 1, (1e-7, 2e-5), harmonics=3, samples=128)
    estimate = ss.quasi_static_mode(superelement, pairs, 1, (1e-7, 2e-5))
    assert exact.damping_ratio[-1] > 1.9 * exact.damping_ratio[0]
    for name, allowed in (("frequency_hz", 1e-3), ("damping_ratio", 5e-3)):
        logarithm = np.log(exact.modal_amplitude)
        beside = np.interp(logarithm, np.log(estimate.modal_amplitude), getattr(estimate, name))
        assert beside == pytest.approx(getattr(exact, name), rel=allowed)


def test_stuck_pairs_dissipate_exactly_nothing() -> None:
    """The deviation of stuck pairs from their springs is round-off, of either sign."""
    stiffness, operator = np.diag([1e6, 2e6, 3e6]), np.eye(3) * np.pi
    pairs = ss.ContactPairs(operator, 1e5 / 3.0, 1e5 / 7.0, 0.3, 10.0)
    result = ss.quasi_static_mode(ss.Superelement(np.eye(3), stiffness), pairs, 1, (1e-8, 1e-3))
    stuck = result.moving_fraction == 0.0
    assert 0 < stuck.sum() < stuck.size
    assert (result.friction_energy[stuck] == 0.0).all()
    assert (result.friction_energy[~stuck] > 0.0).all()


def test_normal_forces_that_change_have_a_warning() -> None:
    operator = np.eye(3)
    operator[2, 0] = 1.0
    pairs = ss.ContactPairs(operator, 1e5, 1e5, 0.3, 10.0)
    result = ss.quasi_static_mode(ss.Superelement(np.eye(3), np.diag([1e6, 2e6, 3e6])), pairs, 1, (1e-7, 1e-3))
    (words,) = result.warnings
    printed_sentence(words)


def test_what_is_no_estimate_is_rejected() -> None:
    superelement, pairs = one_mass()
    with rejects(ss.InputError, "mode"):
        ss.quasi_static_mode(superelement, pairs, 2, (1e-6, 1e-3))
    with rejects(ss.InputError, "amplitude"):
        ss.quasi_static_mode(superelement, pairs, 1, (1e-3, 1e-6))
    with rejects(ss.InputError, "points_per_decade"):
        ss.quasi_static_mode(superelement, pairs, 1, (1e-6, 1e-3), points_per_decade=0)
