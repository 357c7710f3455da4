"""Checks of a curve: errors from the number of harmonics and samples, with warnings where they are large."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial

LARGEST_SAMPLE_RESIDUAL = 2e-3  # chosen: 0.2 % of the relative displacement, below what a plot shows
LARGEST_NEGLECTED_MOTION = 2e-2  # chosen: 2 % of the motion of the joint; that of the structure is far less
# chosen: work of the normal forces over the input of the same point, and the fraction of the largest input below which
# the work does not count; an error of the work is about twice that of the amplitude.
LARGEST_NORMAL_WORK, SMALLEST_INPUT = 1e-2, 1e-3


@dataclass(frozen=True)
class ResolutionCheck:
    """Worst values over the checked points, and their frequencies.

    sample_residual:
        relative residual of the harmonics of the solution with twice the samples; about the relative error of the
        relative displacements by sampling.
    neglected_motion:
        relative displacement by the contact force in neglected harmonics (as many as in the solution, at least four),
        over that of the solution.
    last_harmonic_fraction:
        fraction of the kinetic energy in the two highest harmonics that are not excited (two, because one may be zero
        by symmetry); None if all harmonics are excited.
    """

    sample_residual: float
    sample_omega: float
    neglected_motion: float
    neglected_omega: float
    last_harmonic_fraction: float | None

    def warnings(self, harmonics: int, samples: int) -> tuple[str, ...]:
        """A warning for each number above its limit."""
        sentences = []
        if self.sample_residual > LARGEST_SAMPLE_RESIDUAL:
            sentences.append(
                f"Too few samples: with {2 * samples} instead of {samples} samples the residual is "
                f"{100 * self.sample_residual:.2f} % of the relative displacement at "
                f"{self.sample_omega / (2 * np.pi):.2f} Hz (required: below {100 * LARGEST_SAMPLE_RESIDUAL:.1f} %). "
                f"Run again with samples = {2 * samples}."
            )
        if self.neglected_motion > LARGEST_NEGLECTED_MOTION:
            last = self.last_harmonic_fraction
            energy_words = (
                ""
                if last is None
                else f"; the highest ones of the solution have {100 * last:.2g} % of the kinetic energy"
            )
            more = 2 if self.neglected_motion < 5.0 * LARGEST_NEGLECTED_MOTION else harmonics
            sentences.append(
                f"Too few harmonics: those above {harmonics} would move the joint by {100 * self.neglected_motion:.1f} "
                f"% of its motion at {self.neglected_omega / (2 * np.pi):.2f} Hz (required: below "
                f"{100 * LARGEST_NEGLECTED_MOTION:.0f} %){energy_words}. Run again with harmonics = "
                f"{harmonics + max(2, more)}."
            )
        return tuple(sentences)


def normal_work_warnings(
    omega: FloatArray, normal_work: FloatArray, input_energy: FloatArray, samples: int
) -> tuple[str, ...]:
    """A warning where the sampled normal forces do work; arrays (n_points,), rad/s and J per cycle.

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
        f"because some are closed for a few samples of the period only. Run again with samples = {2 * samples}.",
    )


def check_resolution(
    fine: Balance,
    trials: Sequence[Trial],
    limit: int = 24,
) -> ResolutionCheck:
    """Check up to ``limit`` points spread over the curve, always including that of largest relative displacement.

    ``fine`` is the same balance with more harmonics and twice the samples.
    """
    size = [float(np.linalg.norm(trial.relative[1:])) for trial in trials]
    spread = np.linspace(0, len(trials) - 1, min(limit, len(trials))).round().astype(int)
    chosen = [trials[i] for i in sorted({*spread.tolist(), int(np.argmax(size))})]
    residuals = np.array([_fine_residuals(fine, trial) for trial in chosen])
    excited: NDArray[np.bool_] = np.abs(fine.applied(chosen)).max(axis=(0, 2)) > 0
    shares = [last_harmonic_fraction(trial.amplitude, excited) for trial in chosen]
    valid = [share for share in shares if share is not None]
    sample, neglected = residuals.argmax(axis=0)
    return ResolutionCheck(
        float(residuals[sample, 0]),
        chosen[sample].omega,
        float(residuals[neglected, 1]),
        chosen[neglected].omega,
        max(valid) if valid else None,
    )


def _fine_residuals(fine: Balance, trial: Trial) -> tuple[float, float]:
    """Residuals of a trial in the finer balance, in its own and in neglected harmonics, over the relative
    displacement."""
    width = trial.relative.shape[0]
    padded = np.zeros((2 * fine.harmonics + 1, trial.relative.shape[1]))
    padded[:width] = trial.relative
    residual = fine.evaluate(padded, trial.omega, trial.load).residual
    scale = max(float(np.linalg.norm(trial.relative)), 1e-300)
    return float(np.linalg.norm(residual[:width])) / scale, float(np.linalg.norm(residual[width:])) / scale


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
