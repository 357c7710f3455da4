"""From a branch of the balance to a labelled response: energies, checks, linear limits, warnings."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Protocol

import numpy as np

from stickslip.contact.law.law import ContactState
from stickslip.core.errors import ConvergenceError
from stickslip.core.resolution import Resolution
from stickslip.core.validation import FloatArray
from stickslip.results.response import ForcedResponse
from stickslip.results.stability import Bifurcation, BifurcationKind
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.checks import ResolutionCheck, check_resolution, points_at_peak
from stickslip.solve.harmonic.curve_warnings import curve_warnings, excursion_warning, neighbour_warnings
from stickslip.solve.harmonic.energy import CurveMeasures, measure_curve
from stickslip.solve.harmonic.linear import linear_curves
from stickslip.solve.harmonic.missed_peaks import PeakCheck
from stickslip.solve.harmonic.neglected import CurveAccuracy, more_harmonics
from stickslip.solve.lent_harmonics import LentNumbers
from stickslip.solve.output_maxima import AddedMaxima
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.path.retreats import Crossing
from stickslip.solve.path.stepping import Accepted, BranchPoint, Corner, Retreat
from stickslip.solve.setting_up import CurveBalances, StageReport
from stickslip.solve.stability.curve import CurveStability, reason_without

# Reported fraction of the work at the end of the window: energies, checks and linear limits follow.
LARGEST_FRACTION = 0.99
# A point with a larger fraction of unbalanced forces is not a result. This is half of the limit of the sampling check
# (checks.LARGEST_SAMPLE_RESIDUAL), so that the error of the arithmetic is below that of the discretisation.
LARGEST_UNBALANCE = 1e-3
# chosen: a warning lists up to this number of places.
FEW_PLACES = 4
# chosen: a warning reports a larger distance from 1 of the multiplier at a fold.
LARGEST_ERROR_AT_FOLDS = 0.05
# chosen: points of the linear limits of one of many curves (see ``refined_grid``). Their peaks, between the three
# highest points, are the same; all points would take a sixth of the time of such a curve and two thirds of its file.
FEW_UNIFORM, FEW_BESIDE = 31, 9


class Followed(Protocol):
    """A branch, or the pieces of one, that was followed."""

    @property
    def points(self) -> Sequence[BranchPoint[Any]]:
        """(n_points,) points of a balance."""

    complete: bool
    message: str
    retreats: list[float]
    corners: list[float]
    crossings: list[Crossing]


def follower(window: tuple[float, float], report: StageReport) -> Callable[[Accepted[Any] | Retreat | Corner], None]:
    """A listener that reports the progress of a branch through ``window`` (Hz)."""

    def on_event(event: Accepted[Any] | Retreat | Corner) -> None:
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
    branch: Followed,
    balances: CurveBalances,
    balance: Balance,
    window: tuple[float, float],
    newton: NewtonSettings,
    how: str,
    report: StageReport,
    *,
    peaks: PeakCheck | None = None,
    added: AddedMaxima | None = None,
    no_stability: str = "",
    accuracy: CurveAccuracy | None = None,
    breaks: Sequence[int] = (),
    warnings: Sequence[str] = (),
    few_digits: NewtonSettings | None = None,
    lent: LentNumbers | None = None,
) -> ForcedResponse:
    """The response along a branch through ``window`` (Hz); ``how`` describes its first point.

    ``peaks`` is the search for peaks that the branch missed, ``added`` that for maxima of outputs; ``no_stability``
    says why its points get no multipliers; ``accuracy`` are harmonics and errors of its points, if they differ, and
    ``lent`` their harmonics on a curve without an accuracy: ``balance`` then has the most of them. ``breaks`` are the
    points after which the branch is interrupted, ``warnings`` sentences on them. With ``few_digits``, the settings of
    Newton's method away from the peaks, samples and harmonics are checked at the peak, not over the whole curve, and
    the linear limits have few points.

    It ends before the first point that does not satisfy the equation of motion. Raises ConvergenceError if that is the
    first point of all.
    """
    harmonics = balance.harmonics
    report.stage("energies and checks of the curve")
    trials = [point.point.trial for point in branch.points]

    @cache
    def balance_of(number: int) -> Balance:
        if lent is not None:
            return lent.balance_of(number)
        return balance if number == harmonics else balances.with_harmonics(number)

    measures = measure_curve(trials, balance_of, balances.equation)
    converged, message = branch.complete, branch.message
    wrong = np.flatnonzero(~(measures.residual <= LARGEST_UNBALANCE))
    if wrong.size:
        end = int(wrong[0])
        message = _unbalanced(trials, end, float(measures.residual[end]), damped=balances.is_damped)
        if not end:
            raise ConvergenceError(message)
        converged, trials, measures = False, trials[:end], measures.first(end)

    @cache
    def with_more(number: int) -> tuple[Balance, Balance]:
        own = balance_of(number)
        more = more_harmonics(number, 2 * own.samples, balances.damped_harmonics)
        return own, balances.with_harmonics(more, 2 * own.samples)

    check = check_resolution(
        balance, with_more(harmonics)[1], trials, accuracy,
        at=points_at_peak(trials) if few_digits else None,
        with_more=None if lent is None else with_more,
    )  # fmt: skip
    point_harmonics = None if lent is None else lent.of_points
    if accuracy is not None:
        point_harmonics = accuracy.harmonics
    report.stage("stability of the points")
    reason = no_stability or reason_without(balance.pairs) or balances.no_stability
    breaks = [each for each in breaks if each < len(trials) - 1]
    verdict, stability_message = _stability(trials, breaks, balance, balances, reason)
    report.stage("linear limits")
    grid = {"uniform": FEW_UNIFORM, "beside": FEW_BESIDE} if few_digits else {}
    linear = linear_curves(
        balances.closed, balances.shown_free, balances.force.with_harmonics(harmonics), window, **grid
    )
    damped, free_ratio = balances.is_damped, balances.shown_free.damping_ratio(window)
    samples = np.array([balance_of(len(trial.amplitude) // 2).samples for trial in trials])
    notes = curve_warnings(
        check, balance, samples, trials, measures, damped, free_ratio, balances.modal_damping_ratio,
        (few_digits or newton).tolerance,
    )  # fmt: skip
    motion, walk = balances.motion(trials, measures.displacement)
    retreats_hz, corners_hz = ([omega / (2.0 * np.pi) for omega in each] for each in (branch.retreats, branch.corners))
    report.stage(f"{len(trials)} points", 1.0)
    hertz = np.array([trial.omega for trial in trials]) / (2.0 * np.pi)
    return ForcedResponse(
        frequency_hz=hertz,
        **fields_of(branch.points, trials, measures, motion),
        converged=converged,
        message=f"{how} {'The curve reached the stop frequency.' if converged else message}",
        warnings=notes
        + excursion_warning(hertz, window)
        + neighbour_warnings(retreats_hz, corners_hz, branch.crossings)
        + tuple(warnings)
        + (() if peaks is None else peaks.warnings())
        + (() if added is None else added.warnings())
        + _stability_warnings(verdict, hertz),
        harmonics=harmonics,
        samples=balance.samples,
        pairs=balances.shown_pairs,
        linear=linear,
        force=balances.shown(_mean_force(trials, balance)).T,
        settings=_settings(window, balances, _asked(balance, lent), newton, check, accuracy)
        | ({} if peaks is None else {"search_for_missed_peaks": peaks.words()})
        | ({} if added is None else {"maxima_between_points": added.words()})
        | ({} if few_digits is None else {"newton_tolerance_away_from_peaks": few_digits.tolerance}),
        point_harmonics=None if point_harmonics is None else point_harmonics[: len(trials)],
        estimated_error=None if accuracy is None else accuracy.errors[: len(trials)],
        provenance={} if accuracy is None else {"accuracy": accuracy.words()},
        load_factor=np.array([trial.load for trial in trials]),
        kinetic_energy=measures.kinetic_energy,
        walk=walk,
        part=np.searchsorted(breaks, np.arange(len(trials))),
        stable=None if verdict is None else verdict.stable,
        doubtful=None if verdict is None else verdict.doubtful,
        multipliers=None if verdict is None else verdict.multipliers,
        bifurcations=() if verdict is None else verdict.bifurcations,
        stability_message=stability_message,
    )


def fields_of(
    points: Sequence[BranchPoint[Any]], trials: Sequence[Trial], measures: CurveMeasures, motion: FloatArray
) -> dict[str, Any]:
    """Fields of :class:`stickslip.results.periodic_motions.PeriodicMotions` and energies of the ``trials``, the first
    ``points`` of a branch; ``motion`` (n_points, 2H+1, n) m are their displacements."""
    return {
        "displacement": np.ascontiguousarray(motion.transpose(0, 2, 1)),
        "contact_state": np.array([trial.contact.state for trial in trials], dtype=np.int8),
        "dissipated_energy": measures.dissipated_energy,
        "normal_work": measures.normal_work,
        "closure": np.array([trial.contact.closure for trial in trials]),
        "residual": measures.residual,
        "iterations": np.array([point.iterations for point in points[: len(trials)]]),
        "input_energy": measures.input_energy,
        "viscous_energy": measures.viscous_energy,
    }


def _stability(
    trials: list[Trial], breaks: Sequence[int], balance: Balance, balances: CurveBalances, reason: str
) -> tuple[CurveStability | None, str]:
    """The stability of the points and a sentence; None for a ``reason`` against it."""
    if reason:
        return None, reason
    ends = [0, *(each + 1 for each in breaks), len(trials)]
    # Corrections with more harmonics need the samples that resolve the most harmonics of the curve.
    balances = balances.with_samples(balance.samples)
    parts = [balances.stability(trials[i:j], balance.pairs) for i, j in itertools.pairwise(ends)]
    stability = CurveStability.joined(parts)
    unstable = int((~stability.stable).sum())
    sentence = f"{unstable} of {len(trials)} points are unstable." if unstable else "All points are stable."
    undecided, unconfirmed = int(stability.undecided.sum()), int(stability.unconfirmed.sum())
    if undecided:
        sentence += (
            f" {undecided} have no sure verdict: they are too close to a change of stability, or a disturbance that "
            "takes pairs away from the friction limit that they touch, to one that they nearly touch, or is larger "
            "than their slip, may grow."
        )
    if unconfirmed:
        sentence += f" At {unconfirmed} more harmonics do not confirm the verdict."
    return stability, sentence


def _stability_warnings(stability: CurveStability | None, hertz: FloatArray) -> tuple[str, ...]:
    """Warnings where the stability changes without a fold, which errors of the multipliers can feign, where the
    multiplier at a fold is far from 1, and where more harmonics do not confirm the verdict."""
    if stability is None:
        return ()
    warnings = []
    changes = [each for each in stability.bifurcations if each.kind != "fold"]
    if changes:
        places = ", ".join(_places_of(kind, changes) for kind in dict.fromkeys(each.kind for each in changes))
        warnings.append(
            f"Stability changes without a fold ({places}). Multipliers have errors by samples and harmonics, up to "
            "some percent where many pairs slip and separate: run again with more harmonics, or a finer accuracy, "
            "before you trust it, or the jumps of slow sweeps there."
        )
    if stability.error_at_folds > LARGEST_ERROR_AT_FOLDS:
        warnings.append(
            f"At a fold a multiplier is {stability.error_at_folds:.2f} from 1, where it belongs: the solution neglects "
            "harmonics that its small disturbances contain. Near the folds the verdicts follow from them; elsewhere "
            "real multipliers have an error of this size. Run again with more harmonics, or with a finer accuracy."
        )
    unconfirmed = hertz[stability.unconfirmed]
    if unconfirmed.size:
        warnings.append(
            f"The stability of {unconfirmed.size} of {hertz.size} points from {unconfirmed.min():.3f} to "
            f"{unconfirmed.max():.3f} Hz is doubtful: corrected with more harmonics, the motion has another verdict, "
            "multipliers that still change too much, or is not known. Run again with more harmonics, or with a finer "
            "accuracy, before you trust stable and unstable parts or the jumps of slow sweeps there."
        )
    return tuple(warnings)


def _places_of(kind: BifurcationKind, changes: Sequence[Bifurcation]) -> str:
    """Where the changes of one kind are: a list of few, the range of many."""
    hertz = [each.frequency_hz for each in changes if each.kind == kind]
    if len(hertz) <= FEW_PLACES:
        return f"{kind} {', '.join(f'{each:.3f}' for each in hertz)} Hz"
    return f"{kind} at {len(hertz)} places from {min(hertz):.3f} to {max(hertz):.3f} Hz"


def _unbalanced(trials: list[Trial], end: int, residual: float, damped: bool) -> str:
    """The reason why the curve has no point ``end``: its residual and the most likely cause."""
    hertz = trials[end].omega / (2.0 * np.pi)
    words = f"{residual:.1e}" if np.isfinite(residual) else "no number"
    where = f"The curve ends at {trials[end - 1].omega / (2.0 * np.pi):.3f} Hz" if end else "There is no curve"
    cause = (
        "Contact many orders stiffer than the structure loses all digits: lower its stiffness, or check for unknowns "
        "with almost no mass."
    )
    if not damped:
        cause = (
            "There is no viscous damping, and friction does not limit the motion there, so the amplitude has no bound: "
            "give a damping matrix or modal_damping_ratio."
        )
    return (
        f"{where}: at {hertz:.3f} Hz the equation of motion is satisfied only to {words} of its forces, but a result "
        f"requires {LARGEST_UNBALANCE:.0e}. {cause}"
    )


def _mean_force(trials: list[Trial], balance: Balance) -> FloatArray:
    """(2H+1, n) N at a load of 1, at the middle of the frequencies."""
    omega = [trial.omega for trial in trials]
    return balance.force.coefficients(0.5 * (min(omega) + max(omega)))


def _asked(balance: Balance, lent: LentNumbers | None) -> Resolution:
    """The harmonics and samples that a curve was asked for; with an accuracy those of the ``balance`` with most."""
    return Resolution(balance.harmonics, balance.samples) if lent is None else Resolution(lent.own, lent.samples)


def _settings(
    window: tuple[float, float],
    balances: CurveBalances,
    asked: Resolution,
    newton: NewtonSettings,
    check: ResolutionCheck,
    accuracy: CurveAccuracy | None,
) -> dict[str, str | float | int]:
    settings: dict[str, str | float | int] = {
        "frequency_start_hz": window[0],
        "frequency_stop_hz": window[1],
        "harmonics": asked.harmonics,
        "samples": asked.samples,
        "update": balances.update,
        "excitation": balances.excitation.describe(),
        "newton_tolerance": newton.tolerance,
        "residual_with_doubled_samples": check.sample_residual,
        "error_by_neglected_harmonics": check.neglected_error,
    }
    if check.last_harmonic_fraction is not None:
        settings["energy_share_of_last_harmonics"] = check.last_harmonic_fraction
    if accuracy is not None:
        settings["accuracy"] = accuracy.accuracy
        settings["estimated_error_of_the_peak"] = accuracy.at_peak
    if balances.modal_damping_ratio is not None:
        settings["modal_damping_ratio"] = balances.modal_damping_ratio
    return settings
