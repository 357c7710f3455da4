"""Follow a branch of periodic solutions in frequency by pseudo-arc length, through folds.

The step is measured in ``(x / x_scale, w / w_scale)``: ``x_scale`` is the largest norm met so far on the branch and
``w_scale`` the width of the window, so a step is a share of the picture that the user sees. H. B. Keller, "Numerical
solution of bifurcation and nonlinear eigenvalue problems" (1977), is the source of the method.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stickslip.solve.balance import Balance, Trial
from stickslip.solve.newton import Constraint, Correction, NewtonSettings, Parameter, bordered_factor, correct
from stickslip.validation import FloatArray


@dataclass(frozen=True)
class ContinuationSettings:
    """Step control; steps are shares of the window (or of the largest response), angles between successive tangents.

    largest_step, smallest_step, first_step:
        allowed lengths of a step.
    wanted_angle_deg, largest_angle_deg:
        the step follows the curvature towards the wanted angle; a step that turns by more than the largest is repeated
        with half its length.
    wanted_iterations:
        the step grows while Newton needs fewer.
    max_points:
        the branch ends here at the latest.
    """

    largest_step: float = 0.04
    smallest_step: float = 1e-6
    first_step: float = 0.01
    wanted_angle_deg: float = 12.0
    largest_angle_deg: float = 35.0
    wanted_iterations: int = 4
    max_points: int = 2000


@dataclass(frozen=True)
class BranchPoint:
    """A converged point and the Newton iterations that it took."""

    trial: Trial
    iterations: int


@dataclass(frozen=True)
class Tangent:
    """Unit tangent of the branch in the scaled norm."""

    relative: FloatArray
    omega: float

    @classmethod
    def scaled(cls, relative: FloatArray, omega: float, scale: tuple[float, float]) -> Tangent:
        """Normalise a direction."""
        length = math.hypot(float(np.linalg.norm(relative)) / scale[0], omega / scale[1])
        return cls(relative / length, omega / length)

    def angle_deg(self, other: Tangent, scale: tuple[float, float]) -> float:
        """Angle to another tangent in the scaled norm."""
        cosine = float((self.relative * other.relative).sum()) / scale[0] ** 2
        cosine += self.omega * other.omega / scale[1] ** 2
        return math.degrees(math.acos(min(1.0, max(-1.0, cosine))))


class Branch:
    """An iterator over the points of a branch from ``start`` to ``stop_omega``.

    After the iteration ``complete`` says whether the stop frequency was reached, and ``message`` says what happened.
    """

    def __init__(
        self,
        balance: Balance,
        start: Trial,
        stop_omega: float,
        newton: NewtonSettings,
        settings: ContinuationSettings,
    ) -> None:
        self._balance = balance
        self._start = start
        self._stop = stop_omega
        self._newton = newton
        self._settings = settings
        self._direction = math.copysign(1.0, stop_omega - start.omega)
        self._width = abs(stop_omega - start.omega)
        self._largest = float(np.linalg.norm(start.relative))
        self.complete = False
        self.message = "The branch was not followed yet."

    def __iter__(self) -> Iterator[BranchPoint]:
        yield BranchPoint(self._start, 0)
        point, tangent = self._start, self._first_tangent()
        step = self._settings.first_step
        for _ in range(self._settings.max_points - 1):
            outcome = self._advance(point, tangent, step)
            if outcome is None:
                return
            correction, tangent, step = outcome
            previous, point = point, correction.trial
            if self._beyond_stop(point):
                point, iterations = self._land(previous, point)
                self.complete = True
                self.message = "The stop frequency was reached."
                yield BranchPoint(point, iterations + correction.iterations)
                return
            yield BranchPoint(point, correction.iterations)
            if (point.omega - self._start.omega) * self._direction < -0.02 * self._width:
                self.message = (
                    f"The branch turned back and left the window at {_hz(point.omega):.3f} Hz, where it had started. "
                    "Start from the other end (swap start and stop), or widen the window."
                )
                return
        self.message = (
            f"{self._settings.max_points} points were not enough; the branch had come to {_hz(point.omega):.3f} Hz. "
            "Raise max_points or narrow the window."
        )

    @property
    def _scale(self) -> tuple[float, float]:
        return max(self._largest, 1e-300), self._width

    def _first_tangent(self) -> Tangent:
        constraint = Constraint.fixed(self._start.relative, self._start.omega)
        factor = bordered_factor(self._balance, self._start, Parameter.FREQUENCY, constraint)
        relative, omega = factor.solve(np.zeros_like(self._start.relative), self._direction)
        return Tangent.scaled(relative, omega, self._scale)

    def _constraint(self, point: Trial, tangent: Tangent, step: float) -> Constraint:
        x_scale, w_scale = self._scale
        return Constraint(
            tangent.relative / x_scale**2,
            tangent.omega / w_scale**2,
            point.relative + step * tangent.relative,
            point.omega + step * tangent.omega,
        )

    def _advance(self, point: Trial, tangent: Tangent, step: float) -> tuple[Correction, Tangent, float] | None:
        """One accepted step: point, tangent and next step length; None (and a message) if none succeeds."""
        settings = self._settings
        reason = "Newton did not converge"
        while step >= settings.smallest_step:
            constraint = self._constraint(point, tangent, step)
            guess = self._balance.evaluate(constraint.relative_target, constraint.parameter_target, point.load)
            correction = correct(self._balance, guess, Parameter.FREQUENCY, constraint, self._newton)
            if correction.converged:
                turned = self._tangent_at(correction, constraint)
                angle = turned.angle_deg(tangent, self._scale)
                if angle <= settings.largest_angle_deg or step < 4.0 * settings.smallest_step:
                    self._largest = max(self._largest, float(np.linalg.norm(correction.trial.relative)))
                    rescaled = Tangent.scaled(turned.relative, turned.omega, self._scale)
                    return correction, rescaled, self._next_step(step, correction.iterations, angle)
                reason = f"the branch turned by {angle:.0f} degrees"
            else:
                reason = f"Newton stopped at a relative residual of {correction.trial.error:.1e}"
            step *= 0.5
        self.message = (
            f"The branch was lost at {_hz(point.omega):.3f} Hz: {reason} even at the smallest step "
            f"({settings.smallest_step:g} of the window). Try more samples, fewer harmonics, or a lower force."
        )
        return None

    def _tangent_at(self, correction: Correction, constraint: Constraint) -> Tangent:
        """Tangent from the last factor of the correction: the point's own but for the last Newton step."""
        factor = correction.factor
        if factor is None:
            factor = bordered_factor(self._balance, correction.trial, Parameter.FREQUENCY, constraint)
        relative, omega = factor.solve(np.zeros_like(correction.trial.relative), 1.0)
        return Tangent.scaled(relative, omega, self._scale)

    def _next_step(self, step: float, iterations: int, angle_deg: float) -> float:
        settings = self._settings
        by_angle = settings.wanted_angle_deg / max(angle_deg, 1e-3)
        by_iterations = (settings.wanted_iterations + 1.0) / (iterations + 1.0)
        factor = min(2.0, max(0.4, min(by_angle, by_iterations)))
        return min(settings.largest_step, max(settings.smallest_step, step * factor))

    def _beyond_stop(self, point: Trial) -> bool:
        return (point.omega - self._stop) * self._direction >= 0.0

    def _land(self, before: Trial, after: Trial) -> tuple[Trial, int]:
        """The solution exactly at the stop frequency; the point beyond it if that does not converge."""
        share = (self._stop - before.omega) / (after.omega - before.omega)
        guess = before.relative + share * (after.relative - before.relative)
        start = self._balance.evaluate(guess, self._stop, after.load)
        constraint = Constraint.fixed(guess, self._stop)
        correction = correct(self._balance, start, Parameter.FREQUENCY, constraint, self._newton)
        return (correction.trial, correction.iterations) if correction.converged else (after, 0)


def _hz(omega: float) -> float:
    return omega / (2.0 * math.pi)
