"""The forced response of a structure with friction joints: one call from matrices to a labelled curve."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import Update
from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import blas_threads, thread_count
from stickslip.results.response import ForcedResponse
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.checks import ResolutionCheck, check_resolution
from stickslip.solve.harmonic.curve_warnings import curve_warnings, neighbour_warnings
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.energy import measure_curve
from stickslip.solve.harmonic.linear import LinearLimit, linear_curves
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.path.continuation import Accepted, Branch, ContinuationSettings, Corner, Retreat
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.setting_up import Balances, StageReport, checked_window, prepare_balances
from stickslip.structure.superelement import Superelement

# Fraction of the work that is reported at the end of the window: energies, checks and linear limits follow.
LARGEST_FRACTION = 0.99
# The check of the resolution takes as many harmonics again, and at least so many more.
LEAST_CUT_OFF = 4


def forced_response(
    superelement: Superelement,
    pairs: ContactPairs,
    excitation: Excitation | ArrayLike,
    force_sin: ArrayLike | None = None,
    *,
    frequency_hz: tuple[float, float],
    harmonics: int = 5,
    samples: int = 256,
    modal_damping_ratio: float | None = None,
    update: Update = "tractrix",
    newton: NewtonSettings | None = None,
    continuation: ContinuationSettings | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
) -> ForcedResponse:
    """Follow the periodic response to a harmonic excitation along the frequency.

    Solves ``M u'' + C u' + K u + B^T f(B u) = p(t)`` by harmonic balance (mean and ``harmonics`` harmonics), with the
    friction force of ``pairs`` sampled ``samples`` times a period in its periodic state, along the frequency by
    pseudo-arc length. Theory: docs/theory.md.

    Parameters
    ----------
    superelement:
        (n, n) matrices in SI units, without contact stiffness.
    pairs:
        the joint, with ``operator`` of shape (3 * n_pairs, n).
    excitation, force_sin:
        an :class:`Excitation`; or the force ``p(t) = sum_k cos[:, k-1] cos(k w t) + sin[:, k-1] sin(k w t)`` as arrays
        in N, (n,) for the first harmonic or (n, n_harmonics) for several. ``force_sin`` None means zero.
    frequency_hz:
        (start, stop) of the first harmonic; start above stop sweeps downward.
    harmonics, samples:
        kept harmonics and time samples; ``samples >= 2 * harmonics + 1``, 256 for smooth curves, 512 with much
        separation.
    modal_damping_ratio:
        the same ratio for every mode of the stuck structure, instead of a damping matrix in ``superelement``.
    update:
        "tractrix" (second order) or "radial" return of the friction law.
    newton, continuation:
        tolerances and step control.
    threads:
        threads of the linear algebra, used where the joint is large enough; None takes the environment variable
        STICKSLIP_THREADS, or else the usable cores, at most 4.
    progress:
        called with the fraction of the window that is done, and a sentence.

    Returns
    -------
    ForcedResponse
        also when the curve could not be followed to its end: ``converged`` is then False and ``message`` says where
        and why; all points that it holds are converged.

    Raises
    ------
    InputError
        for inputs that cannot be used. ConvergenceError if not even the first point was found.
    """
    began = time.perf_counter()
    window = checked_window(frequency_hz)
    threads = thread_count(threads)
    excitation = as_excitation(excitation, force_sin)
    newton = newton or NewtonSettings()
    settings = continuation or ContinuationSettings()
    report = StageReport(progress)
    start_omega, stop_omega = (2.0 * np.pi * f for f in window)
    with threadpool_limits(limits=blas_threads(3 * pairs.n_pairs, threads)):
        balances = prepare_balances(
            superelement, pairs, excitation, max(start_omega, stop_omega), harmonics, samples, modal_damping_ratio,
            update, report.stage,
        )  # fmt: skip
        balance = balances.with_harmonics(harmonics)
        curve = FrequencyCurve(balance)
        solver = Newton(curve, newton, report.iteration)

        def walk(point: BalancePoint) -> Branch[BalancePoint]:
            return Branch(solver, point, start_omega, settings)

        report.stage("first point")
        start, how = first_point(solver, curve, start_omega, balances.with_harmonics, walk)
        branch = Branch(solver, start, stop_omega, settings, follower(window, report))
        points = branch.follow()
        report.stage("energies and checks of the curve")
        trials = [point.point.trial for point in points]
        measures = measure_curve(trials, balance, superelement, balances.stuck)
        check = checked_resolution(balances, trials, harmonics)
        report.stage("linear limits")
        closed, free = linear_limits(balances)
        linear = linear_curves(closed, free, balances.force, window)
        report.stage(f"{len(points)} points", 1.0)
    places_hz = [[omega / (2.0 * np.pi) for omega in each] for each in (branch.retreats, branch.corners)]
    damped = bool(balances.stuck.damping.any())
    return ForcedResponse(
        frequency_hz=np.array([trial.omega for trial in trials]) / (2.0 * np.pi),
        displacement=np.ascontiguousarray(measures.displacement.transpose(0, 2, 1)),
        contact_state=np.array([trial.contact.state for trial in trials], dtype=np.int8),
        dissipated_energy=measures.dissipated_energy,
        normal_work=measures.normal_work,
        closure=np.array([trial.contact.closure for trial in trials]),
        residual=measures.residual,
        iterations=np.array([point.iterations for point in points]),
        input_energy=measures.input_energy,
        viscous_energy=measures.viscous_energy,
        converged=branch.complete,
        message=f"{how} {branch.message}",
        warnings=curve_warnings(
            check, balance, trials, measures, damped, free.damping_ratio(window), modal_damping_ratio
        )
        + neighbour_warnings(*places_hz),
        harmonics=harmonics,
        samples=samples,
        pairs=pairs,
        linear=linear,
        force=np.ascontiguousarray(balances.force.coefficients(start_omega).T),
        settings=_settings(window, harmonics, balance, newton, excitation, modal_damping_ratio, check),
        provenance={"solve_seconds": f"{time.perf_counter() - began:.2f}"},
    )


def as_excitation(excitation: Excitation | ArrayLike, force_sin: ArrayLike | None) -> Excitation:
    """An excitation as it is, or that of arrays of force. Raises InputError where both are mixed."""
    if isinstance(excitation, Excitation):
        if force_sin is not None:
            raise InputError("force_sin belongs to a force given as arrays; the excitation has its own sine parts.")
        return excitation
    return Excitation.force(excitation, force_sin)


def linear_limits(balances: Balances) -> tuple[LinearLimit, LinearLimit]:
    """The structure with all pairs that are closed at rest stuck, and without contact."""
    stuck, superelement = balances.stuck, balances.superelement
    closed = LinearLimit(stuck.circular_frequency, stuck.modes, stuck.modal_damping)
    return closed, LinearLimit.of_matrices(superelement.mass, superelement.stiffness, stuck.damping)


def checked_resolution(balances: Balances, trials: list[Trial], harmonics: int) -> ResolutionCheck:
    """Whether harmonics and samples are enough, by a balance with more harmonics and twice the samples."""
    fine = balances.with_harmonics(harmonics + max(harmonics, LEAST_CUT_OFF), 2 * balances.samples)
    return check_resolution(fine, trials)


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
        moving = int((trial.contact.state > 0).sum())
        fraction = min(LARGEST_FRACTION, max(0.0, done))
        report.stage(f"{frequency_hz:.2f} Hz, point {event.count}, {moving} pairs moving", fraction)

    return on_event


def _settings(
    window: tuple[float, float],
    harmonics: int,
    balance: Balance,
    newton: NewtonSettings,
    excitation: Excitation,
    modal_damping_ratio: float | None,
    check: ResolutionCheck,
) -> dict[str, str | float | int]:
    settings: dict[str, str | float | int] = {
        "frequency_start_hz": window[0],
        "frequency_stop_hz": window[1],
        "harmonics": harmonics,
        "samples": balance.samples,
        "update": balance.update,
        "excitation": excitation.describe(),
        "newton_tolerance": newton.tolerance,
        "residual_with_doubled_samples": check.sample_residual,
        "neglected_harmonics_motion": check.neglected_motion,
    }
    if check.last_harmonic_share is not None:
        settings["energy_share_of_last_harmonics"] = check.last_harmonic_share
    if modal_damping_ratio is not None:
        settings["modal_damping_ratio"] = modal_damping_ratio
    return settings
