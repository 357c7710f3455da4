"""From a branch of the balance to a labelled response: energies, checks, linear limits, warnings."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.contact.law.law import ContactState
from stickslip.core.validation import FloatArray
from stickslip.results.response import ForcedResponse
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.checks import ResolutionCheck, check_resolution
from stickslip.solve.harmonic.curve_warnings import curve_warnings, neighbour_warnings
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.energy import measure_curve
from stickslip.solve.harmonic.linear import LinearLimit, linear_curves
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.path.stepping import Accepted, Corner, Retreat
from stickslip.solve.setting_up import Balances, StageReport

# Fraction of the work that is reported at the end of the window: energies, checks and linear limits follow.
LARGEST_FRACTION = 0.99
# The check of the resolution takes as many harmonics again, and at least so many more.
LEAST_CUT_OFF = 4


def follower(
    window: tuple[float, float], report: StageReport
) -> Callable[[Accepted[BalancePoint] | Retreat | Corner], None]:
    """What reports the progress of a branch through ``window`` (Hz)."""

    def on_event(event: Accepted[BalancePoint] | Retreat | Corner) -> None:
        if not isinstance(event, Accepted):
            return
        trial = event.point.trial
        frequency_hz = trial.omega / (2.0 * np.pi)
        done = (frequency_hz - window[0]) / (window[1] - window[0])
        moving = int((trial.contact.state != ContactState.STUCK).sum())
        fraction = min(LARGEST_FRACTION, max(0.0, done))
        report.stage(f"{frequency_hz:.2f} Hz, point {event.count}, {moving} pairs moving", fraction)

    return on_event


def response_of(
    branch: Branch[BalancePoint],
    balances: Balances,
    balance: Balance,
    window: tuple[float, float],
    newton: NewtonSettings,
    how: str,
    report: StageReport,
) -> ForcedResponse:
    """The response along a branch that was followed through ``window`` (Hz); ``how`` says how it began."""
    superelement, stuck, harmonics = balances.superelement, balances.stuck, balance.harmonics
    report.stage("energies and checks of the curve")
    trials = [point.point.trial for point in branch.points]
    measures = measure_curve(trials, balance, superelement, stuck)
    fine = balances.with_harmonics(harmonics + max(harmonics, LEAST_CUT_OFF), 2 * balances.samples)
    check = check_resolution(fine, trials)
    report.stage("linear limits")
    closed = LinearLimit(stuck.circular_frequency, stuck.modes, stuck.modal_damping)
    free = LinearLimit.of_matrices(superelement.mass, superelement.stiffness, stuck.damping)
    linear = linear_curves(closed, free, balances.force, window)
    damped, free_ratio = bool(stuck.damping.any()), free.damping_ratio(window)
    warnings = curve_warnings(check, balance, trials, measures, damped, free_ratio, balances.modal_damping_ratio)
    places_hz = [[omega / (2.0 * np.pi) for omega in each] for each in (branch.retreats, branch.corners)]
    report.stage(f"{len(trials)} points", 1.0)
    return ForcedResponse(
        frequency_hz=np.array([trial.omega for trial in trials]) / (2.0 * np.pi),
        displacement=np.ascontiguousarray(measures.displacement.transpose(0, 2, 1)),
        contact_state=np.array([trial.contact.state for trial in trials], dtype=np.int8),
        dissipated_energy=measures.dissipated_energy,
        normal_work=measures.normal_work,
        closure=np.array([trial.contact.closure for trial in trials]),
        residual=measures.residual,
        iterations=np.array([point.iterations for point in branch.points]),
        input_energy=measures.input_energy,
        viscous_energy=measures.viscous_energy,
        converged=branch.complete,
        message=f"{how} {'The stop frequency was reached.' if branch.complete else branch.message}",
        warnings=warnings + neighbour_warnings(*places_hz),
        harmonics=harmonics,
        samples=balance.samples,
        pairs=balances.pairs,
        linear=linear,
        force=_mean_force(trials, balance).T,
        settings=_settings(window, balances, balance, newton, check),
        provenance={},
        load_factor=np.array([trial.load for trial in trials]),
    )


def _mean_force(trials: list[Trial], balance: Balance) -> FloatArray:
    """(2H+1, n) N at a load of 1, at the middle of the frequencies."""
    omega = [trial.omega for trial in trials]
    return balance.force.coefficients(0.5 * (min(omega) + max(omega)))


def _settings(
    window: tuple[float, float],
    balances: Balances,
    balance: Balance,
    newton: NewtonSettings,
    check: ResolutionCheck,
) -> dict[str, str | float | int]:
    settings: dict[str, str | float | int] = {
        "frequency_start_hz": window[0],
        "frequency_stop_hz": window[1],
        "harmonics": balance.harmonics,
        "samples": balance.samples,
        "update": balances.update,
        "excitation": balances.excitation.describe(),
        "newton_tolerance": newton.tolerance,
        "residual_with_doubled_samples": check.sample_residual,
        "neglected_harmonics_motion": check.neglected_motion,
    }
    if check.last_harmonic_share is not None:
        settings["energy_share_of_last_harmonics"] = check.last_harmonic_share
    if balances.modal_damping_ratio is not None:
        settings["modal_damping_ratio"] = balances.modal_damping_ratio
    return settings
