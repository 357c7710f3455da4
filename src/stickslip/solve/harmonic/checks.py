"""Checks of a curve: errors from the number of harmonics and samples, with warnings where they are large."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.harmonic.neglected import UNKNOWN, CurveAccuracy, chord_of, neglected

LARGEST_SAMPLE_RESIDUAL = 2e-3  # chosen: 0.2 % of the relative displacement, below what a plot shows
LARGEST_NEGLECTED = 1e-2  # chosen: 1 % of the motion of the structure, with the margin of the estimate
# chosen: the error by neglected harmonics is estimated at the highest point and at this number of others.
ESTIMATES = 8
# chosen: work of the normal forces over the input of the same point, and the fraction of the largest input below which
# the work does not count; an error of the work is about twice that of the amplitude.
LARGEST_NORMAL_WORK, SMALLEST_INPUT = 1e-2, 1e-3


@dataclass(frozen=True)
class ResolutionCheck:
    """Worst values over the checked points, and their frequencies.

    sample_residual:
        relative residual of the harmonics of the solution with twice the samples; about the relative error of the
        relative displacements by sampling.
    neglected_error:
        estimated error by neglected harmonics (:mod:`stickslip.solve.harmonic.neglected`).
    last_harmonic_fraction:
        fraction of the kinetic energy in the two highest harmonics that are not excited (two, because one may be zero
        by symmetry); None if all harmonics are excited.
    accuracy:
        wanted accuracy, where it determines the harmonics.
    limited:
        whether the limit of the work, not that of the samples, stopped the harmonics at some point.
    harmonics_there:
        harmonics of the point with the largest neglected error, None with an accuracy.
    samples_there:
        samples of the point with the largest residual; points with more harmonics may have more.
    """

    sample_residual: float
    sample_omega: float
    neglected_error: float
    neglected_omega: float
    last_harmonic_fraction: float | None
    accuracy: float | None = None
    limited: bool = False
    harmonics_there: int | None = None
    samples_there: int | None = None

    def warnings(self, harmonics: int, samples: int) -> tuple[str, ...]:
        """A warning for each number above its limit."""
        sentences, sampled = [], self.samples_there or samples
        largest_residual = min(LARGEST_SAMPLE_RESIDUAL, self.accuracy or LARGEST_SAMPLE_RESIDUAL)
        if self.sample_residual > largest_residual:
            sentences.append(
                f"Too few samples: with {2 * sampled} instead of {sampled} samples the residual is "
                f"{100 * self.sample_residual:.2f} % of the relative displacement at "
                f"{self.sample_omega / (2 * np.pi):.2f} Hz (required: below {100 * largest_residual:.3g} %). "
                f"Run again with samples = {2 * sampled}."
            )
        there = self.harmonics_there or harmonics
        where = f"{self.neglected_omega / (2.0 * np.pi):.2f} Hz"
        if self.neglected_error >= UNKNOWN:
            sentences.append(
                f"The error by neglected harmonics is as large as the motion at {where}, or not known: the solution "
                f"with more harmonics is far away. Run again with harmonics = {2 * there}, and compare."
            )
        elif self.accuracy is not None and self.neglected_error > self.accuracy:
            remedy = f"Run again with samples = {2 * samples}, which allow more harmonics, or with a coarser accuracy."
            if self.limited:
                remedy = (
                    "More harmonics of so many moving pairs exceed the limit of the work. Run again with a coarser "
                    f"accuracy, or with fixed harmonics = {2 * harmonics}, which requires much time."
                )
            sentences.append(
                f"The accuracy of {100 * self.accuracy:.3g} % is not reached: the estimated error by neglected "
                f"harmonics is {100 * self.neglected_error:.2g} % of the motion at {where}, with up to {harmonics} "
                f"harmonics. {remedy}"
            )
        elif self.accuracy is None and self.neglected_error > LARGEST_NEGLECTED:
            last = self.last_harmonic_fraction
            energy_words = (
                ""
                if last is None
                else f"; the highest ones of the solution have {100 * last:.2g} % of the kinetic energy"
            )
            more = 2 if self.neglected_error < 5.0 * LARGEST_NEGLECTED else there
            sentences.append(
                f"Too few harmonics: those above {there} would move the curve by about "
                f"{100 * self.neglected_error:.3g} % of its motion at {where} "
                f"(required: below "
                f"{100 * LARGEST_NEGLECTED:.0f} %){energy_words}. Run again with harmonics = "
                f"{there + max(2, more)}, or with an accuracy."
            )
        return tuple(sentences)


def normal_work_warnings(
    omega: FloatArray, normal_work: FloatArray, input_energy: FloatArray, samples: NDArray[np.int64]
) -> tuple[str, ...]:
    """A warning where the sampled normal forces do work; arrays (n_points,), rad/s, J per cycle and samples.

    A normal force that depends on the closing alone does no work. For a pair that closes only for a few samples the
    sampled work is not zero: an energy source or sink that the joint does not have. The relative error of the amplitude
    is about half the work over the input.
    """
    counted = input_energy > SMALLEST_INPUT * input_energy.max()
    share = np.where(counted, np.abs(normal_work) / np.where(counted, input_energy, 1.0), 0.0)
    worst = int(share.argmax())
    if share[worst] <= LARGEST_NORMAL_WORK:
        return ()
    verb = "supply" if normal_work[worst] < 0.0 else "dissipate"
    return (
        f"Too few samples: the normal forces of the pairs {verb} {100 * share[worst]:.1f} % of the energy of the "
        f"excitation at {omega[worst] / (2 * np.pi):.2f} Hz (required: below {100 * LARGEST_NORMAL_WORK:.0f} %), "
        f"because some are closed for a few samples of the period only. Run again with samples = {2 * samples[worst]}.",
    )


def check_resolution(
    balance: Balance,
    fine: Balance,
    trials: Sequence[Trial],
    reached: CurveAccuracy | None = None,
    limit: int = 24,
    at: Sequence[int] | None = None,
    with_more: Callable[[int], tuple[Balance, Balance]] | None = None,
) -> ResolutionCheck:
    """Check up to ``limit`` points spread over the curve, always including that of largest relative displacement.

    With ``at`` only these points are checked.

    ``balance`` is that of the trials; ``fine`` the same with more harmonics and twice the samples. With a wanted
    accuracy, where trials have different numbers of harmonics, the points have ``reached`` estimated errors. Without
    one ``with_more`` gives both balances for a number of harmonics, if trials have different numbers (and samples).
    """
    size = [float(np.linalg.norm(trial.relative[1:])) for trial in trials]
    highest = int(np.argmax(size))
    spread = np.linspace(0, len(trials) - 1, min(limit, len(trials))).round().astype(int)
    chosen = sorted({*spread.tolist(), highest} if at is None else set(at))
    with_more = with_more or (lambda number: (balance, fine))
    both = [with_more(_harmonics(trials[i])) for i in chosen]
    samples = np.array([sample_residual(more, trials[i]) for i, (_, more) in zip(chosen, both, strict=True)])
    if reached is None:
        places = _estimated(trials, highest) if at is None else chosen
        errors = _estimated_errors(with_more, trials, places)
    else:
        errors = dict(enumerate(reached.errors[: len(trials)].tolist()))
    worst = max(errors, key=lambda i: errors[i])
    excited: NDArray[np.bool_] = np.abs(fine.applied([trials[i] for i in chosen])).max(axis=(0, 2)) > 0
    shares = [last_harmonic_fraction(trials[i].amplitude, excited) for i in chosen]
    valid = [share for share in shares if share is not None]
    sample = int(samples.argmax())
    return ResolutionCheck(
        float(samples[sample]),
        trials[chosen[sample]].omega,
        errors[worst],
        trials[worst].omega,
        max(valid) if valid else None,
        None if reached is None else reached.accuracy,
        reached is not None and reached.limited,
        None if reached is not None else _harmonics(trials[worst]),
        both[sample][0].samples,
    )


def _harmonics(trial: Trial) -> int:
    return len(trial.amplitude) // 2


def points_at_peak(trials: Sequence[Trial]) -> list[int]:
    """The points of largest vibration and of largest relative displacement."""
    motions = [trial.amplitude for trial in trials], [trial.relative[1:] for trial in trials]
    return sorted({int(np.argmax([float(np.linalg.norm(each)) for each in motion])) for motion in motions})


def _estimated(trials: Sequence[Trial], highest: int) -> list[int]:
    """The highest point, and points spread over those where pairs move."""
    moving = [i for i, trial in enumerate(trials) if trial.contact.moves.any()]
    if not moving:
        return [highest]
    spread = np.linspace(0, len(moving) - 1, min(ESTIMATES, len(moving))).round().astype(int)
    return sorted({*(moving[place] for place in spread), highest})


def _estimated_errors(
    with_more: Callable[[int], tuple[Balance, Balance]], trials: Sequence[Trial], places: Sequence[int]
) -> dict[int, float]:
    """Estimated error by neglected harmonics at some points; 0 where no pair moves."""
    errors, last, end = {}, LastFactor(), len(trials) - 1
    for i in places:
        errors[i] = 0.0
        if not trials[i].contact.moves.any():
            continue
        own, fine = with_more(_harmonics(trials[i]))
        more = fine
        if own.samples > 2 * fine.harmonics:
            more = Balance(fine.compliance, fine.pairs, fine.force, own.samples)
        along = chord_of(trials[max(i - 1, 0)], trials[min(i + 1, end)])
        errors[i] = neglected(trials[i], own, more, along, last).error
    return errors


def sample_residual(fine: Balance, trial: Trial) -> float:
    """Residual of a trial with the samples of ``fine``, in its own harmonics, over the relative displacement."""
    width = len(trial.relative)
    padded = with_rows(trial.relative, 2 * fine.harmonics + 1)
    residual = fine.evaluate(padded, trial.omega, trial.load).residual[:width]
    return float(np.linalg.norm(residual)) / max(float(np.linalg.norm(trial.relative)), 1e-300)


def last_harmonic_fraction(amplitude: FloatArray, excited: NDArray[np.bool_]) -> float | None:
    """Fraction of the kinetic energy in the two highest harmonics that no force excites; None if there are none.

    ``amplitude`` (2H, n) of mass-normalised modes; ``excited`` (>= 2H+1,) marks the nonzero coefficients of the force.
    """
    harmonics = amplitude.shape[0] // 2
    free = [h for h in range(1, harmonics + 1) if not excited[2 * h - 1 : 2 * h + 1].any()]
    if not free:
        return None
    order = np.repeat(np.arange(1, harmonics + 1), 2)
    energy = order**2 * (amplitude**2).sum(axis=1)
    total = float(energy.sum())
    last = float(energy[np.isin(order, free[-2:])].sum())
    return last / total if total > 0 else 0.0
