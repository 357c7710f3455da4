"""Nonlinear modes: one call from matrices to frequency and damping of a mode against its amplitude."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.completeness import reported
from stickslip.core.errors import ConvergenceError
from stickslip.core.progress import ProgressCallback
from stickslip.core.resolution import SAMPLES_PER_HARMONIC
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import FloatArray
from stickslip.results.nonlinear_mode import LARGEST_RATIO_OF_PEAKS, NonlinearMode
from stickslip.solve.curve_result import LARGEST_UNBALANCE, fields_of
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import least_harmonics
from stickslip.solve.harmonic.curve_warnings import motion_warnings
from stickslip.solve.harmonic.energy import measure_curve
from stickslip.solve.harmonic.mode_shapes import (
    LISTED_MODES,
    MODES_ABOVE,
    exchange_warnings,
    fold_warnings,
    shapes_of,
    sliding_limit,
    start_warnings,
    step_warnings,
)
from stickslip.solve.harmonic.varying_harmonics import LADDER
from stickslip.solve.modes.linear_mode import Limit, LinearMode, checked_amplitudes, require_allowed_amplitude
from stickslip.solve.modes.mode_branch import STEPS, ModeBranch, follow_mode
from stickslip.solve.modes.mode_checks import (
    CHECKED_POINTS,
    HarmonicsChange,
    accuracy_warnings,
    harmonics_warnings,
    largest_change,
    sample_warnings,
    work_warning,
)
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.setting_up import Balances, StageReport, prepare_balances
from stickslip.structure.superelement import Superelement

# chosen: work of all branches with an accuracy, in entries of the Newton matrix (unknowns squared) over all points. The
# two blades, all 110 pairs in gross slip, have 4e8 of them for each 10 to 20 s of processor time with 5 harmonics.
MOST_ENTRIES = 4e9
# chosen: if the accuracy is missed by more than the factor FAR, numbers of harmonics closer than the ratio are omitted.
FAR, LEAST_GROWTH = 4.0, 1.5
OTHER: dict[Limit, Limit] = {"stuck": "sliding", "sliding": "stuck"}


def nonlinear_mode(
    superelement: Superelement,
    pairs: ContactPairs,
    mode: int,
    amplitude: tuple[float, float],
    *,
    limit: Limit = "stuck",
    harmonics: int | None = None,
    accuracy: float | None = None,
    samples: int = 256,
    modal_damping_ratio: float | None = None,
    update: Update = "tractrix",
    newton: NewtonSettings | None = None,
    continuation: ContinuationSettings | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
    raise_on_failure: bool = False,
) -> NonlinearMode:
    """Follow a nonlinear mode over its modal amplitude: frequency, damping ratio, shape, contact states and energies.

    Solves ``M u'' + (C - xi M) u' + K u + B^T f(B u) = 0`` for periodic motions about the state at rest, with the
    frequency and xi as unknowns (extended periodic motion concept; M. Krack, Comput. Struct. 154 (2015) 59-71). Theory
    and limits of use: docs/theory_modes.md.

    Parameters
    ----------
    superelement, pairs, samples, modal_damping_ratio, update, newton, continuation, threads, progress,
    raise_on_failure:
        as in :func:`forced_response`; steps of the continuation are fractions of the range of the logarithm of the
        amplitude, and of the shape.
    mode:
        number of a linear mode from 1, in the order of their frequencies. Bodies that move freely are no modes.
    amplitude:
        (lowest, highest) modal amplitude, m kg^(1/2): mass norm of the first harmonic of the motion.
    harmonics:
        harmonics of the motion, 5 if neither they nor ``accuracy`` are given.
    accuracy:
        instead of ``harmonics``: the whole mode is computed again with more harmonics until twice as many change its
        damping ratio by at most this fraction of it, and its frequency by a twentieth of this fraction, at points along
        the branch; for example 0.005. A warning reports where that was not reached.
    limit:
        "stuck": the mode is counted with all pairs that are closed at rest stuck, and the branch starts at the lowest
        amplitude. "sliding": it is counted with these pairs in contact without friction, and the branch starts at the
        highest amplitude. Where both branches are one curve, they have the same points.

    Returns
    -------
    NonlinearMode
        also if the branch ends early: ``converged`` is then False and ``message`` gives the amplitude and the reason.

    Raises
    ------
    InputError
        for inputs that cannot be used, such as a mode that does not exist, or an amplitude at which a law has no
        restoring force.
    ConvergenceError
        if there is no first point.
    """
    result = unreported_mode(
        superelement, pairs, mode, amplitude, limit=limit, harmonics=harmonics, accuracy=accuracy, samples=samples,
        modal_damping_ratio=modal_damping_ratio, update=update, newton=newton, continuation=continuation,
        threads=threads, progress=progress,
    )  # fmt: skip
    return reported(result, raise_on_failure)


def unreported_mode(
    superelement: Superelement, pairs: ContactPairs, mode: int, amplitude: tuple[float, float], *, limit: Limit,
    harmonics: int | None, accuracy: float | None, samples: int, modal_damping_ratio: float | None, update: Update,
    newton: NewtonSettings | None, continuation: ContinuationSettings | None, threads: int | None,
    progress: ProgressCallback | None,
) -> NonlinearMode:  # fmt: skip
    """:func:`nonlinear_mode`, for a caller that reports a branch that ends early itself."""
    began = time.perf_counter()
    lowest, highest = checked_amplitudes(amplitude)
    threads = thread_count(threads)
    newton = newton or NewtonSettings()
    report = StageReport(progress)
    with_load = Excitation.force(np.ones(superelement.size))  # any of one harmonic
    least = least_harmonics(harmonics, accuracy, samples, with_load)
    with solver_threads(threads):
        report.stage("linear modes")
        start = LinearMode.of(superelement, pairs, mode, limit)
        require_allowed_amplitude(pairs, start, highest)
        balances = prepare_balances(
            superelement, pairs, Excitation.force(superelement.mass @ start.load_shape), start.omega, least,
            samples, modal_damping_ratio, update, report.stage,
        )  # fmt: skip
        ends = (lowest, highest) if limit == "stuck" else (highest, lowest)
        steps = continuation or STEPS

        def followed(count: int) -> ModeBranch:
            return follow_mode(balances, start, count, ends, newton, steps, report)

        if accuracy is None:
            mode_branch = followed(least)
            report.stage("check of the harmonics")
            # Two more: a symmetric motion has only odd or only even ones besides.
            doubts = harmonics_warnings(mode_branch.points, mode_branch.with_harmonics(balances, least + 2), newton)
        else:
            mode_branch, doubts = _by_accuracy(followed, balances, accuracy, least, newton, report)
        result = _result(mode_branch, balances, start, doubts, newton.tolerance, report)
    provenance = {"solve_seconds": f"{time.perf_counter() - began:.2f}"}
    options = {
        **({} if accuracy is None else {"accuracy": accuracy}),
        "amplitude_start": ends[0],
        "amplitude_stop": ends[1],
        "newton_tolerance": newton.tolerance,
    }
    return replace(result, settings={**result.settings, **options}, provenance=provenance)


def _by_accuracy(
    followed: Callable[[int], ModeBranch], balances: Balances, accuracy: float, least: int, newton: NewtonSettings,
    report: StageReport,
) -> tuple[ModeBranch, tuple[str, ...]]:  # fmt: skip
    """The branch with harmonics that reach an accuracy, or with a warning with the most that the work allows.

    Twice the harmonics are the reference: two more can change little where the harmonics decay slowly. Raises
    ConvergenceError if no number of harmonics has a first point.
    """
    reached: tuple[ModeBranch, tuple[str, ...]] | None = None
    failed: ConvergenceError | None = None
    ladder = [least, *(each for each in LADDER if least < each <= balances.samples // SAMPLES_PER_HARMONIC)]
    entries, points, next_count = 0.0, 0, least
    for count in ladder:
        if count < next_count and count != ladder[-1]:
            continue
        expected = (3.0 * balances.pairs.n_pairs * (2 * count + 1)) ** 2
        if reached is not None and entries + points * expected > MOST_ENTRIES:
            return reached[0], (*reached[1], work_warning(count))
        try:
            mode_branch = followed(count)
        except ConvergenceError as error:
            failed = error
            continue
        points = len(mode_branch.points)
        entries += points * expected
        report.stage(f"check of {count} harmonics")
        try:
            change: HarmonicsChange | str = largest_change(
                mode_branch.points,
                mode_branch.with_harmonics(balances, 2 * count),
                newton,
                CHECKED_POINTS,
                accuracy,
                stops_above=count != ladder[-1],
            )
        except ConvergenceError as error:
            change = str(error)
        reached = mode_branch, accuracy_warnings(change, accuracy, count)
        if not reached[1]:
            break
        is_far = not isinstance(change, str) and change.over(accuracy) > FAR
        next_count = math.ceil(LEAST_GROWTH * count) if is_far else count
    if reached is None:
        assert failed is not None  # the ladder has at least one number
        raise failed
    return reached


def _result(
    followed: ModeBranch, balances: Balances, start: LinearMode, doubts: tuple[str, ...], tolerance: float,
    report: StageReport,
) -> NonlinearMode:  # fmt: skip
    """The labelled result of a branch, solved to a ``tolerance``: energies, shapes, checks and warnings."""
    report.stage("energies and checks of the mode")
    superelement, stuck = balances.superelement, balances.stuck
    branch, curve, points = followed.branch, followed.curve, followed.points
    balance = curve.balance
    # The load of the balance stands for the inertia of the mode; it is no excitation.
    trials = [replace(point.trial, load=0.0) for point in points]
    measures = measure_curve(trials, lambda harmonics: balance, balances.equation)
    wrong = np.flatnonzero(~(measures.residual <= LARGEST_UNBALANCE))
    complete, message = branch.complete, branch.message
    if wrong.size:
        end = int(wrong[0])
        complete, message = (
            False,
            (
                f"At {curve.named(float(points[end].parameters[0]))} the equation of motion is satisfied only to "
                f"{measures.residual[end]:.1e} of its forces, but a result requires {LARGEST_UNBALANCE:.0e}. Contact "
                "many orders stiffer than the structure loses all digits: lower its stiffness."
            ),
        )
        if not end:
            raise ConvergenceError(message)
        points, trials, measures = points[:end], trials[:end], measures.first(end)
    amplitude = np.array([point.modal_amplitude for point in points])
    omega, growth = (np.array([getattr(trial, name) for trial in trials]) for name in ("omega", "growth"))
    frequency_hz, ratio = omega / (2.0 * np.pi), growth / (2.0 * omega)
    sliding = sliding_limit(superelement, balances.pairs, stuck.damping)
    listed = max(LISTED_MODES, start.number + MODES_ABOVE)
    shapes = shapes_of(trials, superelement, stuck, sliding, listed)
    stuck_hz = stuck.circular_frequency[:listed] / (2.0 * np.pi)
    sliding_hz = sliding.natural_hz[~sliding.rigid][:listed]
    macs, linear_hz = (shapes.stuck, stuck_hz) if start.limit == "stuck" else (shapes.sliding, sliding_hz)
    fine = balances.with_harmonics(balance.harmonics, 2 * balance.samples)
    motion, _ = balances.motion(trials, measures.displacement)
    own, first = start.number - 1, (frequency_hz[0], linear_hz[start.number - 1], amplitude[0])
    return NonlinearMode(
        modal_amplitude=amplitude,
        frequency_hz=frequency_hz,
        damping_ratio=ratio,
        **fields_of(branch.points, trials, measures, motion),
        stuck_frequency_hz=stuck_hz,
        stuck_mac=shapes.stuck,
        sliding_frequency_hz=sliding_hz,
        sliding_mac=shapes.sliding,
        step_mac=shapes.step,
        mode=start.number,
        limit=start.limit,
        converged=complete,
        message=_words(complete, message, start.limit),
        warnings=(
            *motion_warnings(balance, np.full(len(trials), balance.samples), trials, measures, tolerance),
            *sample_warnings(points, curve, fine),
            *doubts,
            *start_warnings(macs[0, own], *first, trials[0].contact.state, start.number, start.limit),
            *exchange_warnings(macs, frequency_hz, linear_hz, start.number, start.limit),
            *step_warnings(shapes.step, frequency_hz, amplitude),
            *fold_warnings(amplitude),
            *_damping_warnings(amplitude, ratio),
        ),
        harmonics=balance.harmonics,
        samples=balance.samples,
        pairs=balances.pairs,
        settings={
            "harmonics": balance.harmonics,
            "samples": balance.samples,
            "update": balances.update,
            **({} if balances.modal_damping_ratio is None else {"modal_damping_ratio": balances.modal_damping_ratio}),
        },
        provenance={},
    )


def _words(complete: bool, message: str, limit: Limit) -> str:
    """The message on the end of a branch, with what may help."""
    if complete:
        return "The mode covers the range of modal amplitudes."
    return f'{message} The branch from the other limit may continue: limit = "{OTHER[limit]}".'


def _damping_warnings(amplitude: FloatArray, ratio: FloatArray) -> tuple[str, ...]:
    """A warning where the damping is so high that forced responses have their peaks elsewhere."""
    high = amplitude[ratio > LARGEST_RATIO_OF_PEAKS]
    if not high.size:
        return ()
    return (
        f"From {high.min():.3g} to {high.max():.3g} m kg^0.5 the damping ratio is above "
        f"{100 * LARGEST_RATIO_OF_PEAKS:.0f} %, at most {100 * float(ratio.max()):.3g} %: there the mode no longer "
        "passes through the peaks of forced responses. Use forced responses for amplitudes.",
    )
