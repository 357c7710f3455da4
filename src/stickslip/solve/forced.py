"""The forced response of a structure with friction joints: one call from matrices to a labelled curve."""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import Update
from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import blas_threads, thread_count
from stickslip.core.validation import (
    FloatArray,
    finite_array,
    real_number,
    require_allowed,
    require_choice,
    whole_number,
)
from stickslip.results.response import ForcedResponse
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.checks import ResolutionCheck, check_resolution, normal_work_warnings
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.harmonic.energy import CurveMeasures, measure_curve
from stickslip.solve.harmonic.linear import LinearLimit, linear_curves
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.path.continuation import Branch, BranchPoint, ContinuationSettings
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.structure.superelement import Superelement

# Residual of the equation of motion, relative to its forces, above which a curve gets a warning.
LARGEST_RESIDUAL = 1e-6

# Share of the work that is told at the end of the window: energies, checks and linear limits follow.
LARGEST_SHARE = 0.99


def forced_response(
    superelement: Superelement,
    pairs: ContactPairs,
    force_cos: ArrayLike,
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
    """Follow the periodic response to ``p(t) = sum_k force_cos[:, k-1] cos(k w t) + force_sin[:, k-1] sin(k w t)``.

    Solves ``M u'' + C u' + K u + B^T f(B u) = p(t)`` by harmonic balance (mean and ``harmonics`` harmonics), with the
    friction force of ``pairs`` sampled ``samples`` times a period in its periodic state, along the frequency by
    pseudo-arc length. Theory: docs/theory.md.

    Parameters
    ----------
    superelement:
        (n, n) matrices in SI units, without contact stiffness.
    pairs:
        the joint, with ``operator`` of shape (3 * n_pairs, n).
    force_cos, force_sin:
        N, (n,) for the first harmonic or (n, n_harmonics) for several. ``force_sin`` None means zero.
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
        called with the share of the window that is done, and a sentence.

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
    window = _checked_window(frequency_hz)
    _check_counts(harmonics, samples)
    threads = thread_count(threads)
    require_choice("update", update, get_args(Update))
    if modal_damping_ratio is not None:
        ratio = real_number("modal_damping_ratio", modal_damping_ratio)
        require_allowed("modal_damping_ratio", ratio, ratio >= 0, "0 or above, for example 0.001")
    force = _force_coefficients(force_cos, force_sin, superelement.size, harmonics)
    newton = newton or NewtonSettings()
    told = _Told(progress)
    omega_start, omega_stop = (2.0 * np.pi * f for f in window)
    with threadpool_limits(limits=blas_threads(3 * pairs.n_pairs, threads)):
        told.now(f"modes of the stuck structure, {superelement.size} unknowns")
        stuck = stuck_structure(superelement, pairs, max(omega_start, omega_stop), modal_damping_ratio)
        told.now(f"compliance of {pairs.n_pairs} pairs")
        balance = Balance(stuck.compliance(harmonics), pairs, force, samples, update)
        solver = Newton(balance, newton, told.iteration)
        settings = continuation or ContinuationSettings()

        def simpler(count: int) -> Balance:
            return Balance(stuck.compliance(count), pairs, force[: 2 * count + 1], samples, update)

        def walk(trial: Trial) -> Branch:
            return Branch(solver, trial, omega_start, settings)

        told.now("first point")
        start, how = first_point(solver, omega_start, simpler, walk)
        branch = Branch(solver, start, omega_stop, settings)
        points = _follow(branch, window, told)
        told.now("energies and checks of the curve")
        trials = [point.trial for point in points]
        measures = measure_curve(trials, balance, superelement, stuck)
        cut_off = max(harmonics, 4)
        more = np.vstack([force, np.zeros((2 * cut_off, superelement.size))])
        fine = Balance(stuck.compliance(harmonics + cut_off), pairs, more, 2 * samples, update)
        check = check_resolution(fine, trials)
        told.now("linear limits")
        closed = LinearLimit(stuck.circular_frequency, stuck.modes, stuck.modal_damping)
        free = LinearLimit.of_matrices(superelement.mass, superelement.stiffness, stuck.damping)
        linear = linear_curves(closed, free, force, window)
        told.now(f"{len(points)} points", 1.0)
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
        warnings=_warnings(
            check,
            balance,
            trials,
            measures,
            bool(stuck.damping.any()),
            free.damping_ratio(window),
            modal_damping_ratio,
        )
        + _neighbours(branch),
        harmonics=harmonics,
        samples=samples,
        pairs=pairs,
        linear=linear,
        force=np.ascontiguousarray(force.T),
        settings=_settings(window, harmonics, samples, update, newton, modal_damping_ratio, check),
        provenance={"solve_seconds": f"{time.perf_counter() - began:.2f}"},
    )


def _checked_window(frequency_hz: tuple[float, float]) -> tuple[float, float]:
    values = finite_array("frequency_hz", frequency_hz)
    if values.shape != (2,):
        raise InputError(f"frequency_hz must be (start, stop), but its shape is {values.shape}.")
    start, stop = float(values[0]), float(values[1])
    if start <= 0 or stop <= 0:
        raise InputError(f"frequency_hz is ({start:g}, {stop:g}); both ends must be above 0 Hz.")
    if start == stop:
        raise InputError(
            f"frequency_hz is ({start:g}, {stop:g}), a range of zero width. Give two different frequencies; "
            "a start above the stop sweeps downward."
        )
    return start, stop


def _check_counts(harmonics: int, samples: int) -> None:
    for name, value in (("harmonics", harmonics), ("samples", samples)):
        whole_number(name, value, 1)
    if samples < 2 * harmonics + 1:
        raise InputError(
            f"samples is {samples}, but {harmonics} harmonics need at least {2 * harmonics + 1} samples a period. "
            "Take 256 (512 with much separation): friction has kinks that few samples miss."
        )


def _force_coefficients(force_cos: ArrayLike, force_sin: ArrayLike | None, size: int, harmonics: int) -> FloatArray:
    """(2H+1, n) coefficients of the external force; raises InputError for a wrong shape or no force at all."""
    coefficients = np.zeros((2 * harmonics + 1, size))
    for offset, name, value in ((1, "force_cos", force_cos), (2, "force_sin", force_sin)):
        if value is None:
            continue
        array = finite_array(name, value)
        columns = array[:, None] if array.ndim == 1 else array
        if columns.ndim != 2 or columns.shape[0] != size:
            raise InputError(
                f"{name} must have shape ({size},) for the first harmonic or ({size}, n_harmonics) for several, "
                f"but its shape is {array.shape}."
            )
        if columns.shape[1] > harmonics:
            raise InputError(
                f"{name} has {columns.shape[1]} harmonics, but only harmonics = {harmonics} are kept. Raise harmonics."
            )
        coefficients[offset : offset + 2 * columns.shape[1] : 2] = columns.T
    if not coefficients.any():
        raise InputError("force_cos and force_sin are zero everywhere; without a force there is no forced response.")
    return coefficients


class _Told:
    """Tells the progress: the share of the window that is done, what is done now, and the iterations of Newton."""

    def __init__(self, progress: ProgressCallback | None) -> None:
        self._progress: ProgressCallback = progress or (lambda fraction, detail: None)
        self._share, self._words = 0.0, ""

    def now(self, words: str, share: float | None = None) -> None:
        """``words`` say what begins; ``share`` (0 to 1) is done where it changed."""
        self._words, self._share = words, self._share if share is None else share
        self._progress(self._share, words)

    def iteration(self, number: int, error: float) -> None:
        """Iteration ``number`` of Newton begins with the relative residual ``error``."""
        self._progress(self._share, f"{self._words}; iteration {number}, relative residual {error:.1e}")


def _follow(branch: Branch, window: tuple[float, float], told: _Told) -> list[BranchPoint]:
    """Walk the branch and tell the progress."""
    for point in branch:
        frequency = point.trial.omega / (2.0 * np.pi)
        done = (frequency - window[0]) / (window[1] - window[0])
        moving = int((point.trial.contact.state > 0).sum())
        share = min(LARGEST_SHARE, max(0.0, done))
        told.now(f"{frequency:.2f} Hz, point {len(branch.points)}, {moving} pairs moving", share)
    return branch.points


def _warnings(
    check: ResolutionCheck,
    balance: Balance,
    trials: list[Trial],
    measures: CurveMeasures,
    damped: bool,
    free_ratio: float | None,
    wanted_ratio: float | None,
) -> tuple[str, ...]:
    """What a reader must know before trusting the curve."""
    sentences = list(check.warnings(balance.harmonics, balance.samples))
    omega = np.array([trial.omega for trial in trials])
    work = measures.normal_work.sum(axis=1)
    sentences += normal_work_warnings(omega, work, measures.input_energy, balance.samples)
    closure = max(float(trial.contact.closure.max()) for trial in trials)
    if closure > 1e-6:
        sentences.append(
            f"The slider of some pair did not come to a periodic state (closure error {closure:.1e} of the friction "
            "limit); the force of that pair is uncertain by about this share."
        )
    sentences.extend(_residual(balance, trials, measures.residual))
    if not damped:
        sentences.append(
            "There is no viscous damping: the linear curves have no finite peaks (their heights in the figures mean "
            "nothing), and where nothing slips only the distance from the resonance limits the amplitude."
        )
    if free_ratio is not None and wanted_ratio and free_ratio > 1.2 * wanted_ratio:
        sentences.append(
            f"The damping ratio of {100 * wanted_ratio:.3g} % holds for the stuck modes; the free modes in the window "
            f"get up to {100 * free_ratio:.3g} % from the same matrix, part of it across the joint."
        )
    return (*sentences, *_drift(balance, trials), *_folds(trials))


def _folds(trials: list[Trial]) -> tuple[str, ...]:
    """Where the curve turns back in frequency, and what that means for a sweep."""
    frequency = np.array([trial.omega for trial in trials]) / (2.0 * np.pi)
    step = np.diff(frequency)
    turns = frequency[1:-1][step[:-1] * step[1:] < 0]
    if turns.size < 2 or np.ptp(turns) < 1e-4 * frequency.mean():
        return ()
    return (
        f"The curve folds ({_places(turns)} Hz): between folds several periodic motions exist at one frequency. "
        "Stability is not computed; a slow sweep follows the curve to a fold and jumps there.",
    )


def _neighbours(branch: Branch) -> tuple[str, ...]:
    """Warnings where other solutions lie so close that the branch came onto them, and where corners were passed."""
    sentences = []
    if branch.retreats:
        sentences.append(
            f"Near {_places(branch.retreats)} Hz the curve came back to where it had been, and was followed again from "
            "there with other steps: further periodic motions lie close to it (friction keeps tractions, and nearly "
            "symmetric structures have unsymmetric motions). Another number of samples may lead along another of them; "
            "compare twice the samples."
        )
    if branch.crossings:
        sentences.append(
            f"Near {_places(branch.crossings)} Hz the curve has corners where it turns back over less than one step; "
            "they were passed. More samples make them smaller."
        )
    return tuple(sentences)


def _places(frequencies_hz: Iterable[float]) -> str:
    """The first four frequencies in words."""
    words = list(dict.fromkeys(f"{value:.2f}" for value in frequencies_hz))
    return ", ".join(words[:4] + (["..."] if len(words) > 4 else []))


def _residual(balance: Balance, trials: list[Trial], residuals: FloatArray) -> tuple[str, ...]:
    """A warning where the equation of motion is not met, with the cause.

    The tolerance of the balance is relative to the norm of all relative displacements. Where a drift that only the
    artificial restraint of the mean bounds makes up this norm, the motion itself has fewer digits by the share of the
    motion in the norm; that the drift is the cause shows where the residual times this share is small enough.
    """
    worst = int(residuals.argmax())
    residual, relative = float(residuals[worst]), trials[worst].relative
    if residual <= LARGEST_RESIDUAL:
        return ()
    restrained = float(np.abs(balance.compliance.restraint_force(relative[0])).sum())
    means = relative[0].reshape(-1, 3)[:, :2]
    motion = relative.copy()
    motion[0].reshape(-1, 3)[:, :2] = 0.0
    share = float(np.linalg.norm(motion) / np.linalg.norm(relative))
    cause = (
        "Contact many orders stiffer than the structure loses digits; a lower contact stiffness that is still rigid in "
        "effect gives the same motion more exactly."
    )
    if restrained > 0.0 and residual * share <= LARGEST_RESIDUAL:
        cause = (
            f"The cause is a body that drifts: where the residual is largest an artificial restraint carries "
            f"{restrained:.2e} N and lets the mean slip by {float(np.linalg.norm(means, axis=1).max()):.2e} m, and the "
            "accuracy of the solution is relative to this displacement. Hold the body along its free direction."
        )
    return (
        f"The equation of motion is met only to {residual:.1e} of its forces (wanted: {LARGEST_RESIDUAL:.0e}). {cause}",
    )


def _drift(balance: Balance, trials: list[Trial]) -> tuple[str, ...]:
    """A warning where the restraint of the mean position carries a force that the model does not have."""
    traction = max(float(np.abs(balance.compliance.restraint_force(t.relative[0])).sum()) for t in trials)
    limit = float((balance.pairs.friction_coefficient * balance.pairs.static_load).sum())
    if traction <= 1e-3 * limit:
        return ()
    return (
        f"A body that only friction holds wants to drift: a mean force of {traction:.2e} N (friction limit "
        f"{limit:.2e} N) acts where nothing in the model carries it, and an artificial restraint takes it. Add a "
        "restraint along the free direction of that body.",
    )


def _settings(
    window: tuple[float, float],
    harmonics: int,
    samples: int,
    update: Update,
    newton: NewtonSettings,
    modal_damping_ratio: float | None,
    check: ResolutionCheck,
) -> dict[str, str | float | int]:
    settings: dict[str, str | float | int] = {
        "frequency_start_hz": window[0],
        "frequency_stop_hz": window[1],
        "harmonics": harmonics,
        "samples": samples,
        "update": update,
        "newton_tolerance": newton.tolerance,
        "residual_with_doubled_samples": check.sample_residual,
        "neglected_harmonics_motion": check.neglected_motion,
    }
    if check.last_harmonic_share is not None:
        settings["energy_share_of_last_harmonics"] = check.last_harmonic_share
    if modal_damping_ratio is not None:
        settings["modal_damping_ratio"] = modal_damping_ratio
    return settings
