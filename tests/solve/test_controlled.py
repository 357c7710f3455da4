"""Held amplitude or phase: closed form of a linear structure, the middle branch of a fold, exact derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.optimize

import stickslip as ss
from helpers import Blade
from sentences import printed_sentence, rejects
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.harmonic.curves import Control, ControlledCurve
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import ContinuationSettings

STIFFNESS, MASS, RATIO = 4e6, 1.0, 0.01


def stuck_mass() -> tuple[ss.Superelement, ss.ContactPairs, ss.Excitation]:
    """A mass on springs and a contact that sticks: k = 5e6 N/m along the force of 10 N."""
    superelement = ss.Superelement(MASS * np.eye(3), STIFFNESS * np.eye(3))
    return superelement, ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3, 1e9), ss.Excitation.force([10.0, 0.0, 0.0])


@pytest.mark.slow
def test_the_force_for_an_amplitude_of_a_linear_structure() -> None:
    superelement, pairs, excitation = stuck_mass()
    response = ss.controlled_response(
        superelement,
        pairs,
        excitation,
        [1.0, 0.0, 0.0],
        amplitude=1e-5,
        frequency_hz=(320.0, 390.0),
        harmonics=1,
        samples=64,
        modal_damping_ratio=RATIO,
    )
    assert response.converged, response.message
    omega, stuck = 2 * np.pi * response.frequency_hz, np.sqrt(5e6)
    receptance = 1.0 / np.abs(5e6 - omega**2 + 2j * RATIO * stuck * omega)
    assert response.load_factor * 10.0 == pytest.approx(1e-5 / receptance, rel=1e-9)
    assert response.harmonic_amplitude([1.0, 0.0, 0.0], 1) == pytest.approx(1e-5, rel=1e-9)
    assert response.residual.max() < 1e-9
    # The energies add up at every load.
    assert response.viscous_energy == pytest.approx(response.input_energy, rel=1e-6)
    # The control passes folds, so no sweep jumps.
    up, down = response.slow_sweeps([1.0, 0.0, 0.0])
    assert response.jumps([1.0, 0.0, 0.0]) == ()
    assert up.peak == down.peak
    assert len(up.points()) == len(down.points()) == response.n_points


def test_the_phase_resonance_of_a_linear_structure_is_its_natural_frequency() -> None:
    """It is that phase at no other frequency, whatever the load is, so a range cannot be walked."""
    superelement, pairs, excitation = stuck_mass()
    natural_hz = np.sqrt(5e6) / (2 * np.pi)
    with pytest.warns(ss.NotConvergedWarning):
        response = ss.controlled_response(
            superelement, pairs, excitation, [1.0, 0.0, 0.0], phase_deg=90.0,
            frequency_hz=(natural_hz, 1.1 * natural_hz), harmonics=1, samples=64, modal_damping_ratio=RATIO,
        )  # fmt: skip
    assert not response.converged
    printed_sentence(response.message)
    coefficients = response.coefficients([1.0, 0.0, 0.0])[0]
    assert np.degrees(np.arctan2(coefficients[2], coefficients[1])) == pytest.approx(90.0)
    assert response.frequency_hz == pytest.approx(natural_hz, rel=1e-9)


@pytest.mark.slow
def test_a_prescribed_amplitude_reaches_the_middle_of_a_fold(blade: Blade) -> None:
    """The ten-contact blade folds between 683.7 and 686.1 Hz; a held amplitude has one force at every frequency."""
    settings: dict[str, Any] = {"harmonics": 3, "samples": 128}
    forced = ss.forced_response(
        blade.superelement, blade.pairs, blade.force_cos, blade.force_sin, frequency_hz=(660.0, 700.0), **settings
    )
    amplitude = forced.harmonic_amplitude(blade.tip, 1)
    backwards = np.flatnonzero(np.diff(forced.frequency_hz) < 0)
    assert backwards.size >= 2
    middle = int(backwards[backwards.size // 2])
    place, level = forced.frequency_hz[middle], amplitude[middle]
    held = ss.controlled_response(
        blade.superelement, blade.pairs, ss.Excitation.force(blade.force_cos, blade.force_sin), blade.tip,
        amplitude=level, frequency_hz=(670.0, place), **settings,
    )  # fmt: skip
    assert held.converged, held.message
    assert (np.diff(held.frequency_hz) > 0).all()
    assert held.harmonic_amplitude(blade.tip, 1) == pytest.approx(level, rel=1e-8)
    assert held.frequency_hz[-1] == pytest.approx(place, rel=1e-12)
    assert held.load_factor[-1] == pytest.approx(1.0, rel=1e-6)
    assert held.contact_state[-1].tolist() == forced.contact_state[middle].tolist()


@pytest.mark.parametrize(("held", "target"), [("amplitude", 1e-4), ("phase", 0.7)])
def test_the_bordered_system_is_the_exact_derivative(blade: Blade, held: Control, target: float) -> None:
    force = ss.Excitation.force(blade.force_cos, blade.force_sin) + ss.Excitation.unbalance(
        blade.force_sin, blade.force_cos, 1e-8
    )
    stuck = stuck_structure(blade.superelement, blade.pairs, 2 * np.pi * 1100.0, None)
    balance = Balance(stuck.compliance(3), blade.pairs, force.on(blade.superelement, 3), 128)
    curve = ControlledCurve(balance, blade.tip, held, target)
    omega, generator = 2 * np.pi * 690.0, np.random.default_rng(5)
    relative = 0.3 * balance.linear(omega)
    relative += 0.02 * np.abs(relative).max() * generator.normal(size=relative.shape)
    point = curve.evaluate(relative, np.array([omega, 0.8]))
    weights = generator.normal(size=relative.shape) / np.abs(relative).max()
    plane = Plane(weights, 1.0 / omega, point.unknowns, omega)
    step = curve.linearised(point, plane).solve(point.residual, point.conditions, -0.3, 1e-10)
    small = 1e-6
    ahead, behind = (
        curve.evaluate(point.unknowns + sign * small * step.unknowns, point.parameters + sign * small * step.parameters)
        for sign in (1.0, -1.0)
    )
    residual = (ahead.residual - behind.residual) / (2 * small)
    assert np.linalg.norm(residual + point.residual) < 2e-5 * np.linalg.norm(point.residual)
    condition = (ahead.conditions - behind.conditions) / (2 * small)
    assert condition == pytest.approx(-point.conditions, rel=1e-4)
    assert (weights * step.unknowns).sum() + step.parameters[0] / omega == pytest.approx(0.3, rel=1e-8)
    motion = (ahead.measured - behind.measured) / (2 * small)
    assert curve.measured_change(point, step) == pytest.approx(motion, rel=1e-4, abs=1e-5 * np.abs(motion).max())


def test_what_cannot_be_constrained_is_rejected(blade: Blade) -> None:
    excitation = ss.Excitation.force(blade.force_cos)

    def call(output: object = None, **options: object) -> None:
        row = blade.tip if output is None else output
        ss.controlled_response(blade.superelement, blade.pairs, excitation, row, frequency_hz=(650.0, 700.0), **options)  # type: ignore[arg-type]

    with rejects(ss.InputError, "amplitude", "phase_deg"):
        call()
    with rejects(ss.InputError, "amplitude", "phase_deg"):
        call(amplitude=1e-5, phase_deg=90.0)
    with rejects(ss.InputError, "amplitude"):
        call(amplitude=-1e-5)
    with rejects(ss.InputError, "output"):
        call(output=np.zeros(3), amplitude=1e-5)


def two_masses_beside_a_contact() -> tuple[ss.Superelement, ss.ContactPairs, ss.Excitation, float]:
    """Two coupled masses, a contact that does not move, and the circular frequency of the opposed mode."""
    stiffness = np.diag([2e6, 2e6, 1e9, 1e9, 1e9])
    stiffness[0, 1] = stiffness[1, 0] = -1e6
    damping = np.zeros((5, 5))
    damping[:2, :2] = 1e-5 * stiffness[:2, :2]
    pairs = ss.ContactPairs(np.eye(3, 5, k=2), 1e6, 1e6, 0.3, 1e3)
    excitation = ss.Excitation.force([1.0, 0.0, 0.0, 0.0, 0.0])
    return ss.Superelement(np.eye(5), stiffness, damping), pairs, excitation, float(np.sqrt(3e6))


@pytest.mark.slow
@pytest.mark.parametrize("phase_deg", [90.0, -90.0])
def test_the_opposite_of_a_prescribed_phase_is_not_mistaken_for_it(phase_deg: float) -> None:
    """At the opposed mode the far mass lags by -90 degrees: tan of the phase alone cannot tell it from 90."""
    superelement, pairs, excitation, natural = two_masses_beside_a_contact()
    stiffness, damping = superelement.stiffness[:2, :2], superelement.damping[:2, :2]  # type: ignore[index]

    def across(omega: float) -> float:
        matrix = stiffness - omega**2 * np.eye(2) + 1j * omega * damping
        return float(np.linalg.solve(matrix, [1.0, 0.0])[1].real)

    omega = float(scipy.optimize.brentq(across, 0.99 * natural, 1.01 * natural, xtol=1e-12, rtol=1e-15))
    window = (omega / (2 * np.pi), 1.0001 * omega / (2 * np.pi))

    def start() -> ss.ForcedResponse:  # the first point tells; without limit the walk from it takes seconds
        return ss.controlled_response(
            superelement, pairs, excitation, [0.0, 1.0, 0.0, 0.0, 0.0], frequency_hz=window, phase_deg=phase_deg,
            continuation=ContinuationSettings(max_points=2),
        )  # fmt: skip

    if phase_deg > 0:
        with rejects(ss.ConvergenceError):
            start()
    else:
        with pytest.warns(ss.NotConvergedWarning):
            response = start()
        coefficients = response.coefficients([0.0, 1.0, 0.0, 0.0, 0.0])[0]
        assert np.degrees(np.arctan2(coefficients[2], coefficients[1])) == pytest.approx(-90.0, abs=1e-6)


@pytest.mark.slow
def test_a_contact_that_does_not_move_lets_the_path_continue() -> None:
    """The plane of the path has no part of unknowns that stand still; its normal was divided by zero."""
    superelement, pairs, excitation, natural = two_masses_beside_a_contact()
    window = (0.9 * natural / (2 * np.pi), 1.1 * natural / (2 * np.pi))
    response = ss.controlled_response(
        superelement, pairs, excitation, [0.0, 1.0, 0.0, 0.0, 0.0], frequency_hz=window, amplitude=1e-5
    )
    assert response.converged, response.message
    assert response.harmonic_amplitude([0.0, 1.0, 0.0, 0.0, 0.0], 1) == pytest.approx(1e-5, rel=1e-9)
