"""Warnings on a curve: resolution, residuals, drift, folds and neighbouring solutions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.law import ContactState
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.checks import ResolutionCheck, normal_work_warnings
from stickslip.solve.harmonic.energy import CurveMeasures
from stickslip.solve.harmonic.walk import walk_warnings
from stickslip.solve.path.retreats import Crossing

# chosen: residual of the equation of motion, relative to its forces, above which a curve has a warning; converged
# points have 1e-9 or less (NewtonSettings.tolerance) unless a drift or round-off dominates.
LARGEST_RESIDUAL = 1e-6
# chosen: closure error of a slider, over the friction limit, above which its force is uncertain; the state after many
# cycles closes to 1 / coulomb_period.CYCLES of the distance that they have moved the slider.
LARGEST_CLOSURE = 1e-5
# chosen: a free mode with more than this multiple of the modal damping ratio has a warning.
NOTABLE_DAMPING = 1.2
# chosen: force of the restraint on the mean, over the sum of the friction limits, above which there is a warning.
LARGEST_RESTRAINT = 1e-3
# Folds closer together than this fraction of their frequency are round-off of a vertical tangent.
SMALLEST_FOLD = 1e-4


def curve_warnings(
    check: ResolutionCheck,
    balance: Balance,
    samples: NDArray[np.int64],
    trials: list[Trial],
    measures: CurveMeasures,
    damped: bool,
    free_ratio: float | None,
    wanted_ratio: float | None,
    tolerance: float,
) -> tuple[str, ...]:
    """All warnings on a curve; ``balance`` is that of its point with most harmonics, ``samples`` (n,) are those of each
    point, and ``tolerance`` is the coarsest one of Newton's method."""
    sentences = [
        *check.warnings(balance.harmonics, balance.samples),
        *motion_warnings(balance, samples, trials, measures, tolerance),
    ]
    if not damped:
        sentences.append(
            "There is no viscous damping: the linear curves have no finite peaks (their heights in the figures have no "
            "meaning), and if no pair slips, only the distance from the resonance limits the amplitude."
        )
    if free_ratio is not None and wanted_ratio and free_ratio > NOTABLE_DAMPING * wanted_ratio:
        sentences.append(
            f"The damping ratio of {100 * wanted_ratio:.3g} % applies to the stuck modes; the free modes in the "
            f"frequency range have up to {100 * free_ratio:.3g} % from the same matrix, part of it across the joint."
        )
    return (*sentences, *_folds(trials))


def motion_warnings(
    balance: Balance, samples: NDArray[np.int64], trials: Sequence[Trial], measures: CurveMeasures, tolerance: float
) -> tuple[str, ...]:
    """Warnings on the motions of a curve with ``samples`` (n,) and a ``tolerance`` of Newton's method: work of normal
    forces, sliders, residuals, drift and walk."""
    omega = np.array([trial.omega for trial in trials])
    work = measures.normal_work.sum(axis=1)
    sentences = list(normal_work_warnings(omega, work, measures.input_energy, samples))
    closure = max(float(trial.contact.closure.max()) for trial in trials)
    if closure > LARGEST_CLOSURE:
        sentences.append(
            f"The slider of at least one pair did not reach a periodic state (closure error {closure:.1e} of the "
            "friction limit); the force of that pair is uncertain by about this fraction."
        )
    return (
        *sentences,
        *_residual(measures.residual, max(LARGEST_RESIDUAL, tolerance)),
        *_drift(balance, trials),
        *walk_warnings(balance.pairs, trials),
    )


def _folds(trials: list[Trial]) -> tuple[str, ...]:
    """A warning where the curve turns back in frequency, with the consequence for a sweep."""
    frequency = np.array([trial.omega for trial in trials]) / (2.0 * np.pi)
    step = np.diff(frequency)
    turns = frequency[1:-1][step[:-1] * step[1:] < 0]
    if turns.size < 2 or np.ptp(turns) < SMALLEST_FOLD * frequency.mean():
        return ()
    return (
        f"The curve folds ({_places(turns)} Hz): between folds several periodic motions exist at one frequency. "
        "A slow sweep follows the curve to a fold and jumps there, so a sweep up and a sweep down may have different "
        "peaks.",
    )


def excursion_warning(frequency_hz: FloatArray, window_hz: tuple[float, float]) -> tuple[str, ...]:
    """A warning where the curve leaves its range through the start, folds and comes back."""
    low, high = min(window_hz), max(window_hz)
    # The last point of a curve may lie beyond the stop by less than a step, where no point exactly at it was found.
    outside = frequency_hz[:-1][(frequency_hz[:-1] < low) | (frequency_hz[:-1] > high)]
    outside = outside[np.abs(outside - window_hz[0]) > SMALLEST_FOLD * window_hz[0]]
    if not outside.size:
        return ()
    far = float(outside[np.abs(outside - window_hz[0]).argmax()])
    return (
        f"The curve leaves the range through its start, goes to {far:.3f} Hz, folds and returns; its points outside "
        "of the range are part of it, and peaks and slow sweeps count them. Start the range beyond that fold for a "
        "curve without them.",
    )


def neighbour_warnings(
    retreats_hz: Sequence[float], corners_hz: Sequence[float], crossings: Sequence[Crossing]
) -> tuple[str, ...]:
    """Warnings where the branch came onto other solutions close by, where it passed corners, and where it was lost and
    continues close beyond (rad/s)."""
    sentences = [_crossing_words(crossings)] if crossings else []
    if retreats_hz:
        sentences.append(
            f"Near {_places(retreats_hz)} Hz the solver returned to a part of the curve that it had already computed, "
            "and continued from there with other steps: further periodic motions are close to the curve (friction "
            "retains tractions, and nearly symmetric structures have unsymmetric motions). Another number of samples "
            "may lead to another of these motions; compare with twice the samples."
        )
    if corners_hz:
        sentences.append(
            f"Near {_places(corners_hz)} Hz the curve has corners where it turns back over less than one step; the "
            "solver passed them. More samples make them smaller."
        )
    return tuple(sentences)


def _crossing_words(crossings: Sequence[Crossing]) -> str:
    """The positions where the branch was lost, the distances to its continuation, and the omitted parts."""
    farthest = max(abs(each.after - each.before) for each in crossings) / (2.0 * np.pi)
    words = (
        f"Near {_places(each.before / (2.0 * np.pi) for each in crossings)} Hz the solver lost the curve in corners "
        f"finer than its steps and went on at most {farthest:.2g} Hz beyond, where the motion differs by at most "
        f"{100.0 * max(each.motion for each in crossings):.2g} %."
    )
    left_out = [each for each in crossings if each.left_out is not None]
    if left_out:
        words += (
            " Parts of the curve that begin there and have no end are omitted; their motion is at most "
            f"{max(each.highest for each in left_out):.4g} times as large as at their begin."
        )
    return f"{words} Twice the samples make corners smaller."


def _places(frequencies_hz: Iterable[float]) -> str:
    """The first four frequencies in words."""
    words = list(dict.fromkeys(f"{value:.2f}" for value in frequencies_hz))
    return ", ".join(words[:4] + (["..."] if len(words) > 4 else []))


def _residual(residuals: FloatArray, allowed: float) -> tuple[str, ...]:
    """A warning where the solution does not satisfy the equation of motion, beyond what its tolerance allows."""
    if residuals.max() <= allowed:
        return ()
    return (
        f"The equation of motion is satisfied only to {residuals.max():.1e} of its forces (required: "
        f"{allowed:.0e}). Contact many orders stiffer than the structure loses digits; a lower contact "
        "stiffness that is still rigid in effect gives the same motion more exactly.",
    )


def _drift(balance: Balance, trials: Sequence[Trial]) -> tuple[str, ...]:
    """A warning where the restraint of the mean position carries a force that the model does not have."""
    slipping = [trial for trial in trials if (trial.contact.state != ContactState.STUCK).any()]
    forces = [float(np.abs(balance.compliance.restraint_force(trial.relative[0])).sum()) for trial in slipping]
    traction = max(forces, default=0.0)  # where all pairs stick, they carry it
    limit = float(balance.pairs.largest_slip_force.sum())
    if traction <= LARGEST_RESTRAINT * limit:
        return ()
    remedy = ""
    if balance.pairs.released:
        remedy = (
            ', or solve the preload and retain its tractions (preload.method = "solved", residual_traction = "kept"), '
            "which then support it"
        )
    return (
        f"A body that only friction supports tends to drift: a mean force of {traction:.2e} N (friction limit "
        f"{limit:.2e} N) acts on it in a direction without support, and an artificial restraint carries this force. "
        f"Constrain that body along its free direction{remedy}.",
    )
