"""After a curve: were the harmonics and the samples enough? Numbers, and sentences where they were not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial

LARGEST_SAMPLE_RESIDUAL = 2e-3
LARGEST_NEGLECTED_MOTION = 2e-2
# Work of the normal forces over the input of the same point, where the input is more than a share of the largest one.
LARGEST_NORMAL_WORK, SMALLEST_INPUT = 1e-2, 1e-3


@dataclass(frozen=True)
class ResolutionCheck:
    """Worst values over the checked points, and where they are.

    sample_residual:
        relative residual of the kept harmonics when the friction law is sampled twice as finely; about the relative
        error of the relative displacements that the sampling causes.
    neglected_motion:
        relative displacement that the contact force would cause in the harmonics that were cut off (as many again as
        were kept, at least four), over the kept one.
    last_harmonic_share:
        share of the kinetic energy in the two highest kept harmonics that are not excited (two, because symmetry can
        empty one of them); None where all kept harmonics are excited.
    """

    sample_residual: float
    sample_omega: float
    neglected_motion: float
    neglected_omega: float
    last_harmonic_share: float | None

    def warnings(self, harmonics: int, samples: int) -> tuple[str, ...]:
        """A sentence for each number above its limit."""
        sentences = []
        if self.sample_residual > LARGEST_SAMPLE_RESIDUAL:
            sentences.append(
                f"Too few samples: with {2 * samples} instead of {samples} samples the residual is "
                f"{100 * self.sample_residual:.2f} % of the relative displacement at "
                f"{self.sample_omega / (2 * np.pi):.2f} Hz (wanted: below {100 * LARGEST_SAMPLE_RESIDUAL:.1f} %). "
                f"Run again with samples = {2 * samples}."
            )
        if self.neglected_motion > LARGEST_NEGLECTED_MOTION:
            last = self.last_harmonic_share
            kept = "" if last is None else f"; the highest kept ones hold {100 * last:.2g} % of the kinetic energy"
            more = 2 if self.neglected_motion < 5.0 * LARGEST_NEGLECTED_MOTION else harmonics
            sentences.append(
                f"Too few harmonics: those above {harmonics} would move the joint by "
                f"{100 * self.neglected_motion:.1f} % of its motion at {self.neglected_omega / (2 * np.pi):.2f} Hz "
                f"(wanted: below {100 * LARGEST_NEGLECTED_MOTION:.0f} %){kept}. "
                f"Run again with harmonics = {harmonics + max(2, more)}."
            )
        return tuple(sentences)


def normal_work_warnings(
    omega: FloatArray, normal_work: FloatArray, input_energy: FloatArray, samples: int
) -> tuple[str, ...]:
    """A sentence where the sampled normal forces do work; arrays (n_points,), rad/s and J per cycle.

    A normal force that depends on the closing alone does none. A pair that closes for a few samples only seems to: its
    force acts as a source or a sink of energy that the joint does not have, and the amplitude is wrong by about half
    its share.
    """
    counted = input_energy > SMALLEST_INPUT * input_energy.max()
    share = np.where(counted, np.abs(normal_work) / np.where(counted, input_energy, 1.0), 0.0)
    worst = int(share.argmax())
    if share[worst] <= LARGEST_NORMAL_WORK:
        return ()
    verb = "give" if normal_work[worst] < 0.0 else "take"
    return (
        f"Too few samples: the normal forces of the pairs {verb} {100 * share[worst]:.1f} % of the energy of the "
        f"excitation at {omega[worst] / (2 * np.pi):.2f} Hz (wanted: below {100 * LARGEST_NORMAL_WORK:.0f} %), because "
        f"some are closed for a few samples of the period only. Run again with samples = {2 * samples}.",
    )


def check_resolution(
    fine: Balance,
    trials: Sequence[Trial],
    limit: int = 24,
) -> ResolutionCheck:
    """Check up to ``limit`` points spread over the curve, always with the one of largest relative displacement.

    ``fine`` is the same balance with more harmonics and twice the samples.
    """
    size = [float(np.linalg.norm(trial.relative[1:])) for trial in trials]
    spread = np.linspace(0, len(trials) - 1, min(limit, len(trials))).round().astype(int)
    chosen = [trials[i] for i in sorted({*spread.tolist(), int(np.argmax(size))})]
    residuals = np.array([_fine_residuals(fine, trial) for trial in chosen])
    excited: NDArray[np.bool_] = np.abs(fine.applied(chosen)).max(axis=(0, 2)) > 0
    shares = [last_harmonic_share(trial.amplitude, excited) for trial in chosen]
    known = [share for share in shares if share is not None]
    sample, neglected = residuals.argmax(axis=0)
    return ResolutionCheck(
        float(residuals[sample, 0]),
        chosen[sample].omega,
        float(residuals[neglected, 1]),
        chosen[neglected].omega,
        max(known) if known else None,
    )


def _fine_residuals(fine: Balance, trial: Trial) -> tuple[float, float]:
    """Residuals of a trial in the finer balance, in kept and in neglected harmonics, over the relative displacement."""
    kept = trial.relative.shape[0]
    padded = np.zeros((2 * fine.harmonics + 1, trial.relative.shape[1]))
    padded[:kept] = trial.relative
    residual = fine.evaluate(padded, trial.omega, trial.load).residual
    scale = max(float(np.linalg.norm(trial.relative)), 1e-300)
    return float(np.linalg.norm(residual[:kept])) / scale, float(np.linalg.norm(residual[kept:])) / scale


def last_harmonic_share(amplitude: FloatArray, excited: NDArray[np.bool_]) -> float | None:
    """Share of the kinetic energy in the two highest kept harmonics that no force excites; None if there is none.

    ``amplitude`` (2H, n) of mass-normalised modes; ``excited`` (>= 2H+1,) says which coefficients the force has.
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
