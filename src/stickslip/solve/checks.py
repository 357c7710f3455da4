"""After a curve: were the harmonics and the samples enough? Numbers, and sentences where they were not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.solve.balance import Balance, Trial
from stickslip.validation import FloatArray

LARGEST_SAMPLE_RESIDUAL = 2e-3
LARGEST_LAST_HARMONIC_SHARE = 1e-3


@dataclass(frozen=True)
class ResolutionCheck:
    """Worst values over the checked points.

    sample_residual:
        relative residual of the solution when the friction law is sampled twice as finely; about the relative error
        of the relative displacements that the sampling causes.
    last_harmonic_share:
        share of the kinetic energy in the two highest kept harmonics (two, because symmetry can empty one of them).
    """

    sample_residual: float
    sample_omega: float
    last_harmonic_share: float
    harmonic_omega: float

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
        if self.last_harmonic_share > LARGEST_LAST_HARMONIC_SHARE:
            sentences.append(
                f"Too few harmonics: the highest of {harmonics} harmonics hold "
                f"{100 * self.last_harmonic_share:.2f} % of the kinetic energy at "
                f"{self.harmonic_omega / (2 * np.pi):.2f} Hz (wanted: below "
                f"{100 * LARGEST_LAST_HARMONIC_SHARE:.1f} %). Run again with harmonics = {harmonics + 2}."
            )
        return tuple(sentences)


def check_resolution(
    fine: Balance, trials: Sequence[Trial], displacements: Sequence[FloatArray], mass: FloatArray, limit: int = 24
) -> ResolutionCheck:
    """Check up to ``limit`` points spread over the curve, always with the one of largest response.

    ``fine`` is the same balance with twice the samples; ``displacements[i]`` (2H+1, n) belongs to ``trials[i]``.
    """
    size = [float(np.linalg.norm(u)) for u in displacements]
    spread = np.linspace(0, len(trials) - 1, min(limit, len(trials))).round().astype(int)
    chosen = sorted({*spread.tolist(), int(np.argmax(size))})
    residuals = [fine.evaluate(trials[i].relative, trials[i].omega, trials[i].load).error for i in chosen]
    shares = [last_harmonic_share(displacements[i], mass) for i in chosen]
    worst_sample, worst_share = int(np.argmax(residuals)), int(np.argmax(shares))
    return ResolutionCheck(
        residuals[worst_sample],
        trials[chosen[worst_sample]].omega,
        shares[worst_share],
        trials[chosen[worst_share]].omega,
    )


def last_harmonic_share(displacement: FloatArray, mass: FloatArray) -> float:
    """Share of the kinetic energy in the highest two harmonics above the first; 0 with one harmonic."""
    motion = displacement[1:]
    harmonics = motion.shape[0] // 2
    if harmonics == 1:
        return 0.0
    order = np.repeat(np.arange(1, harmonics + 1), 2)
    energy = order**2 * np.einsum("hi,ij,hj->h", motion, mass, motion, optimize=True)
    total = float(energy.sum())
    last = float(energy[order > max(1, harmonics - 2)].sum())
    return last / total if total > 0 else 0.0
