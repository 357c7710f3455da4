"""Follow a branch of periodic solutions in frequency by pseudo-arc length, through folds.

Steps and angles are measured in ``(u / u_scale, w / w_scale)`` with the mass norm of the whole structure's vibration:
``u_scale`` is the largest norm met so far and ``w_scale`` the width of the window, so a step is a share of the picture
that the user sees. (The relative displacements of the pairs would be a poor measure: they have a kink wherever a pair
begins to slip.) H. B. Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems" (1977), is the
source of the method.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stickslip.solve.balance import Trial
from stickslip.solve.newton import Constraint, Correction, Newton
from stickslip.solve.reduced import BorderedSystem
from stickslip.validation import FloatArray

# Relative accuracy of a tangent, which only predicts.
TANGENT_TOLERANCE = 1e-4


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

    largest_step: float = 0.08
    smallest_step: float = 1e-6
    first_step: float = 0.01
    wanted_angle_deg: float = 15.0
    largest_angle_deg: float = 45.0
    wanted_iterations: int = 4
    max_points: int = 2000


@dataclass(frozen=True)
class BranchPoint:
    """A converged point and the Newton iterations that it took."""

    trial: Trial
    iterations: int


@dataclass(frozen=True)
class Tangent:
    """Direction of the branch: changes of x (2H+1, m), of the modal amplitudes (2H, n), and of the frequency."""

    relative: FloatArray
    amplitude: FloatArray
    omega: float

    def times(self, factor: float) -> Tangent:
        """The direction with another length."""
        return Tangent(factor * self.relative, factor * self.amplitude, factor * self.omega)

    def plus(self, other: Tangent) -> Tangent:
        """The sum of two directions."""
        return Tangent(self.relative + other.relative, self.amplitude + other.amplitude, self.omega + other.omega)


@dataclass(frozen=True)
class Metric:
    """Inner product of directions: mass norm of the vibration over ``u_scale``, and frequency over ``w_scale``."""

    u_scale: float
    w_scale: float

    def product(self, first: Tangent, second: Tangent) -> float:
        """Scaled inner product."""
        vibration = float((first.amplitude * second.amplitude).sum())
        return vibration / self.u_scale**2 + first.omega * second.omega / self.w_scale**2

    def unit(self, tangent: Tangent) -> Tangent:
        """The direction with length 1."""
        return tangent.times(1.0 / math.sqrt(self.product(tangent, tangent)))

    def angle_deg(self, first: Tangent, second: Tangent) -> float:
        """Angle between two directions."""
        cosine = self.product(self.unit(first), self.unit(second))
        return math.degrees(math.acos(min(1.0, max(-1.0, cosine))))


class Branch:
    """An iterator over the points of a branch from ``start`` to ``stop_omega``.

    After the iteration ``complete`` says whether the stop frequency was reached, and ``message`` says what happened.
    """

    def __init__(
        self,
        newton: Newton,
        start: Trial,
        stop_omega: float,
        settings: ContinuationSettings,
    ) -> None:
        self._balance = newton.balance
        self._start = start
        self._stop = stop_omega
        self._newton = newton
        self._settings = settings
        self._direction = math.copysign(1.0, stop_omega - start.omega)
        self._width = abs(stop_omega - start.omega)
        self._largest = 0.0
        self.complete = False
        self.message = "The branch was not followed yet."

    def __iter__(self) -> Iterator[BranchPoint]:
        yield BranchPoint(self._start, 0)
        point, tangent = self._start, self._first_tangent()
        bend, step = tangent.times(0.0), self._settings.first_step
        for _ in range(self._settings.max_points - 1):
            outcome = self._advance(point, tangent, bend, step)
            if outcome is None:
                return
            correction, turned, taken, step = outcome
            bend = turned.plus(tangent.times(-1.0)).times(1.0 / taken)
            tangent, previous, point = turned, point, correction.trial
            if self._beyond_stop(point):
                point, iterations = self._land(previous, point)
                self.complete = True
                self.message = "The stop frequency was reached."
                yield BranchPoint(point, iterations + correction.iterations)
                return
            if (point.omega - self._start.omega) * self._direction < 0.0:
                self.message = (
                    f"The branch turned back and left the window at {_hz(point.omega):.3f} Hz, where it had started. "
                    "Start from the other end (swap start and stop), or widen the window."
                )
                return
            yield BranchPoint(point, correction.iterations)
        self.message = (
            f"{self._settings.max_points} points were not enough; the branch had come to {_hz(point.omega):.3f} Hz. "
            "Raise max_points or narrow the window."
        )

    def _measure(self, point: Trial) -> Metric:
        """The metric after ``point`` was reached."""
        self._largest = max(self._largest, float(np.linalg.norm(point.amplitude)), 1e-300)
        return Metric(self._largest, self._width)

    def _direction_of(self, point: Trial, system: BorderedSystem, constraint: float) -> Tangent:
        """Tangent at ``point`` from a Newton system; ``constraint`` fixes its orientation."""
        step = system.solve(np.zeros_like(point.relative), constraint, TANGENT_TOLERANCE)
        change = self._balance.compliance.amplitude(point.omega, None, step.deviation)
        change += step.omega * self._balance.amplitude_slope(point)
        return Tangent(step.relative, change, step.omega)

    def _first_tangent(self) -> Tangent:
        constraint = Constraint.fixed(self._start.relative, self._start.omega)
        system = self._newton.border(self._start, constraint)
        tangent = self._direction_of(self._start, system, self._direction)
        return self._measure(self._start).unit(tangent)

    def _constraint(self, point: Trial, tangent: Tangent, step: float) -> Constraint:
        """The plane across the tangent at its end, in (x, w); x is scaled so that both parts of the normal count."""
        normal = self._balance.acting(tangent.relative)
        x_size = max(float(np.linalg.norm(normal)), 1e-300)
        return Constraint(
            normal / x_size**2,
            tangent.omega / self._width**2,
            point.relative + step * tangent.relative,
            point.omega + step * tangent.omega,
        )

    def _advance(
        self, point: Trial, tangent: Tangent, bend: Tangent, step: float
    ) -> tuple[Correction, Tangent, float, float] | None:
        """One accepted step: point, tangent, length, and next length; None (and a message) if none succeeds.

        ``bend`` is the change of the tangent over the last step per length: the guess follows the curvature.
        """
        settings = self._settings
        reason = "Newton did not converge"
        while step >= settings.smallest_step:
            constraint = self._constraint(point, tangent, step)
            ahead = tangent.times(step).plus(bend.times(0.5 * step**2))
            guess = self._balance.evaluate(point.relative + ahead.relative, point.omega + ahead.omega, point.load)
            correction = self._newton.correct(guess, constraint)
            if correction.converged:
                # The last system of the correction is the point's own but for the last Newton step.
                system = correction.system or self._newton.border(correction.trial, constraint)
                turned = self._direction_of(correction.trial, system, 1.0)
                metric = self._measure(correction.trial)
                angle = max(
                    metric.angle_deg(turned, tangent), self._detour_deg(metric, point, correction.trial, tangent)
                )
                if angle <= settings.largest_angle_deg or step < 4.0 * settings.smallest_step:
                    return correction, metric.unit(turned), step, self._next_step(step, correction.iterations, angle)
                reason = f"the branch turned by {angle:.0f} degrees"
            else:
                reason = f"Newton stopped at a relative residual of {correction.trial.error:.1e}"
            step *= 0.5
        self.message = (
            f"The branch was lost at {_hz(point.omega):.3f} Hz: {reason} even at the smallest step "
            f"({settings.smallest_step:g} of the window). Try more samples, fewer harmonics, or a lower force."
        )
        return None

    @staticmethod
    def _detour_deg(metric: Metric, before: Trial, after: Trial, tangent: Tangent) -> float:
        """Twice the angle from the tangent to the chord of a step: on an arc this is how much the tangent turns.

        It is large where Newton came down on another part of the curve, whose tangent may look alike.
        """
        chord = Tangent(
            after.relative - before.relative, after.amplitude - before.amplitude, after.omega - before.omega
        )
        return 2.0 * metric.angle_deg(chord, tangent)

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
        correction = self._newton.correct(start, constraint)
        return (correction.trial, correction.iterations) if correction.converged else (after, 0)


def _hz(omega: float) -> float:
    return omega / (2.0 * math.pi)
