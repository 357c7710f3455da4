"""Newton's method for a problem with parameters and a plane that constrains the correction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

import numpy as np

from stickslip.solve.path.problem import Linearised, Plane, PointT, Problem, Step

# chosen: relative accuracy of the linear solution of a step while Newton's own error dominates, and the finest one;
# quadratic convergence uses no more digits.
FAR_STEP_TOLERANCE = 1e-3
FINEST_STEP_TOLERANCE = 1e-8
# Relative accuracy of a tangent, which is only a prediction.
TANGENT_TOLERANCE = 1e-4
# chosen: relative size of a step above which the error is not round-off.
ROUND_OFF_STEP = 1e-5
# The error over that of some iterations before, above which a correction is stuck.
HALF = 0.5
# chosen: a step that leaves more than this fraction of the residual had too few digits.
POOR_STEP = 0.1


@dataclass(frozen=True)
class NewtonSettings:
    """Tolerance and limits of the iteration.

    tolerance:
        largest allowed relative error of a point (for a balance: the norm of the residual ``x - r + A d`` relative to
        the norm of ``x``; in pairs with a gap that close also that of its spring force relative to the contact force).
    max_iterations:
        largest number of iterations.
    round_off_factor:
        a point whose error is at most this many times the tolerance and no longer falls has reached its round-off:
        contact much stiffer than the structure amplifies it. Such a point counts as converged; the residual of the
        equation is reported with it.
    fractions:
        fractions of a step, in the order of the attempts, until one lowers the error; otherwise the best of them
        counts.
    finest_step:
        finest relative accuracy of the linear solution of a step, which poor steps approach.
    tangent:
        relative accuracy of the tangents of a curve.
    """

    tolerance: float = 1e-9
    max_iterations: int = 12
    round_off_factor: float = 100.0
    fractions: tuple[float, ...] = (1.0, 0.5, 0.25, 0.125)
    finest_step: float = FINEST_STEP_TOLERANCE
    tangent: float = TANGENT_TOLERANCE


@dataclass(frozen=True)
class Correction(Generic[PointT]):
    """Result of a Newton correction; ``system`` is the last linear system (None for a start that already converged)."""

    point: PointT
    converged: bool
    iterations: int
    system: Linearised | None


class Newton(Generic[PointT]):
    """Newton's method for one problem; ``on_iteration`` receives number and error of each iteration."""

    def __init__(
        self,
        problem: Problem[PointT],
        settings: NewtonSettings,
        on_iteration: Callable[[int, float], None] | None = None,
    ) -> None:
        self.problem = problem
        self.settings = settings
        self.on_iteration = on_iteration or (lambda iteration, error: None)

    def __repr__(self) -> str:
        return f"<Newton method for {type(self.problem).__name__}, tolerance {self.settings.tolerance:g}>"

    def _step_tolerance(self, error: float, sharper: float) -> float:
        """Digits that a step can use: quadratic convergence ends far steps, the tolerance of Newton the last one.

        ``sharper`` lowers the tolerance after poor steps: near corners of the branch the system is badly conditioned.
        """
        wanted = FAR_STEP_TOLERANCE
        if error * error <= self.settings.tolerance:
            wanted = min(wanted, 0.1 * self.settings.tolerance / error)
        return max(self.settings.finest_step, sharper * wanted)

    def correct(self, start: PointT, plane: Plane | None = None, patience: int | None = None) -> Correction[PointT]:
        """Iterate from ``start`` until the error is below the tolerance or ``max_iterations`` are done.

        A law may have kinks, so a full step can overshoot; a step that enlarges the error is shortened. With
        ``patience`` a correction fails if so many iterations do not halve the error: near a corner of the equations
        they go round between the pieces that meet there.
        """
        settings = self.settings
        point, system, sharper = start, None, 1.0
        errors: list[float] = []
        for iteration in range(settings.max_iterations + 1):
            if point.error <= settings.tolerance:
                return Correction(point, True, iteration, system)
            errors.append(point.error)
            if iteration == settings.max_iterations or not np.isfinite(point.error) or self._is_stuck(errors, patience):
                break
            self.on_iteration(iteration + 1, point.error)
            system = self.problem.linearised(point, plane)
            defect = 0.0 if plane is None else plane.defect(point)
            tolerance = self._step_tolerance(point.error, sharper)
            step = system.solve(point.residual, point.conditions, defect, tolerance)
            if not (np.isfinite(step.unknowns).all() and np.isfinite(step.parameters).all()):
                break
            improved = self._best_along(point, step)
            near = point.error <= settings.round_off_factor * settings.tolerance
            if near and improved.error > 0.5 * point.error and self._is_round_off(point, step):
                best = improved if improved.error < point.error else point
                return Correction(best, True, iteration + 1, system)
            if improved.error > POOR_STEP * point.error:
                sharper *= FAR_STEP_TOLERANCE
            point = improved
        return Correction(point, False, len(errors) - 1, system)

    def _is_stuck(self, errors: list[float], patience: int | None) -> bool:
        """Whether the last ``patience`` iterations did not halve the error, and it is above round-off."""
        settings = self.settings
        if patience is None or len(errors) <= patience:
            return False
        return errors[-1] > max(HALF * errors[-1 - patience], settings.round_off_factor * settings.tolerance)

    def _is_round_off(self, point: PointT, step: Step) -> bool:
        """Whether the step is too small to matter: a larger one says that the solution is elsewhere."""
        size, whole = (float(np.linalg.norm(self.problem.determined(each))) for each in (step.unknowns, point.unknowns))
        return size <= ROUND_OFF_STEP * whole

    def _best_along(self, point: PointT, step: Step) -> PointT:
        """The point after a full step, or the best of shortened ones where the full step enlarges the error."""
        best: PointT | None = None
        for fraction in self.settings.fractions:
            moved = point.unknowns + fraction * step.unknowns
            candidate = self.problem.evaluate(moved, point.parameters + fraction * step.parameters)
            if best is None or candidate.error < best.error:
                best = candidate
            if candidate.error < point.error:
                break
        assert best is not None
        return best
