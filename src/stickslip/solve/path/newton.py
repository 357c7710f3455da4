"""Newton's method for the balance with the frequency as one more unknown and one scalar constraint."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.reduced import BorderedSystem, Step, bordered_system


@dataclass(frozen=True)
class NewtonSettings:
    """When to stop.

    tolerance:
        largest allowed norm of the residual ``x - r + A d`` relative to the norm of ``x``; in pairs with a gap that
        close also that of its spring force relative to the contact force.
    max_iterations:
        iterations before the step is given up.
    """

    tolerance: float = 1e-9
    max_iterations: int = 12


# A residual this many times above the tolerance that no longer falls has reached its round-off: contact much stiffer
# than the structure amplifies it. Such a point counts as converged; the equation's own residual is reported with it.
ROUND_OFF_FACTOR = 100.0

# Relative accuracy of the linear solution of a step while Newton's own error dominates, and the finest ever asked for.
FAR_STEP_TOLERANCE = 1e-3
FINEST_STEP_TOLERANCE = 1e-8
# A step that leaves more than this part of the residual did not pay.
POOR_STEP = 0.1


@dataclass(frozen=True)
class Constraint:
    """``sum(weights * (x - x_target)) + weight * (omega - omega_target) = 0``."""

    weights: FloatArray  # (2H+1, m)
    weight: float
    relative_target: FloatArray  # (2H+1, m)
    omega_target: float

    @classmethod
    def fixed(cls, relative: FloatArray, omega: float) -> Constraint:
        """The frequency stays at ``omega``."""
        return cls(np.zeros_like(relative), 1.0, relative, omega)

    def defect(self, relative: FloatArray, omega: float) -> float:
        """Left-hand side of the constraint."""
        along = float((self.weights * (relative - self.relative_target)).sum())
        return along + self.weight * (omega - self.omega_target)


@dataclass(frozen=True)
class Correction:
    """Outcome of a Newton correction; ``system`` is the last one solved (None if none was needed)."""

    trial: Trial
    converged: bool
    iterations: int
    system: BorderedSystem | None


class Newton:
    """Newton's method for one balance; ``told`` hears the number and the residual of each iteration that begins."""

    def __init__(
        self, balance: Balance, settings: NewtonSettings, told: Callable[[int, float], None] | None = None
    ) -> None:
        self.balance = balance
        self.settings = settings
        self.told = told or (lambda iteration, error: None)

    def border(self, trial: Trial, constraint: Constraint) -> BorderedSystem:
        """The Newton system of ``trial``, bordered by ``constraint``."""
        slope = self.balance.frequency_slope(trial)
        return bordered_system(self.balance, trial, slope, constraint.weights, constraint.weight)

    def _step_tolerance(self, error: float, sharper: float) -> float:
        """Digits that a step can use: quadratic convergence ends far steps, the tolerance of Newton the last one.

        ``sharper`` asks for more where steps did not pay: near corners of the branch the system is badly conditioned.
        """
        wanted = FAR_STEP_TOLERANCE
        if error * error <= self.settings.tolerance:
            wanted = min(wanted, 0.1 * self.settings.tolerance / error)
        return max(FINEST_STEP_TOLERANCE, sharper * wanted)

    def correct(self, start: Trial, constraint: Constraint) -> Correction:
        """Iterate from ``start`` until the residual is below the tolerance or the iterations are used up.

        The law has kinks where a time sample switches state, so a full step can overshoot; a step that enlarges the
        residual is halved up to three times and the best of them taken.
        """
        trial, system, sharper = start, None, 1.0
        for iteration in range(self.settings.max_iterations + 1):
            if trial.error <= self.settings.tolerance:
                return Correction(trial, True, iteration, system)
            if iteration == self.settings.max_iterations or not np.isfinite(trial.error):
                break
            self.told(iteration + 1, trial.error)
            system = self.border(trial, constraint)
            defect = constraint.defect(trial.relative, trial.omega)
            step = system.solve(trial.residual, -defect, self._step_tolerance(trial.error, sharper))
            if not (np.isfinite(step.relative).all() and np.isfinite(step.omega)):
                break
            improved = _best_along(self.balance, trial, step)
            if trial.error <= ROUND_OFF_FACTOR * self.settings.tolerance and improved.error > 0.5 * trial.error:
                best = improved if improved.error < trial.error else trial
                return Correction(best, True, iteration + 1, system)
            if improved.error > POOR_STEP * trial.error:
                sharper *= FAR_STEP_TOLERANCE
            trial = improved
        return Correction(trial, False, self.settings.max_iterations, system)


def _best_along(balance: Balance, trial: Trial, step: Step) -> Trial:
    """The trial after a full step, or the best of shortened ones where the full step enlarges the residual."""
    best: Trial | None = None
    for fraction in (1.0, 0.5, 0.25, 0.125):
        moved = trial.relative + fraction * step.relative
        candidate = balance.evaluate(moved, trial.omega + fraction * step.omega, trial.load)
        if best is None or candidate.error < best.error:
            best = candidate
        if candidate.error < trial.error:
            break
    assert best is not None
    return best
