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

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.reduced import BorderedSystem
from stickslip.solve.path.arc_length import Metric, Tangent, chord_between
from stickslip.solve.path.newton import Constraint, Correction, Newton
from stickslip.solve.path.visited import Visited

# Relative accuracy of a tangent, which only predicts.
TANGENT_TOLERANCE = 1e-4
# Two solutions are the same point of a curve within this share of the chord that came near, or of their size: the legs
# of a sharp corner, where the branch turns by 180 degrees, are as close as that only at its very tip.
SAME_POINT, SAME_POINT_OF_SIZE = 0.02, 1e-8
# How often steps that came back to the branch are taken back; by how much shorter they are repeated and for how many,
# and by how much longer where they came back to the same place.
MOST_RETREATS = 6
SHORTER, LONGER = 0.25, 4.0
SLOW_STEPS = 16
# A branch that turned round is believed after as many points on its old way: at first the legs of a sharp corner are
# too close to each other for Newton to keep them apart.
POINTS_BACK = 4


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


class _Pace:
    """The longest step that is allowed now: shorter for a while after a retreat."""

    def __init__(self, largest_step: float) -> None:
        self._largest = self.limit = largest_step
        self._rest = 0.0

    def slow_down(self, limit: float) -> None:
        """Steps of at most ``limit`` for the length of ``SLOW_STEPS`` of them."""
        self.limit, self._rest = limit, SLOW_STEPS * limit

    def hurry(self) -> None:
        """Steps of any length again."""
        self.limit = self._largest

    def walked(self, length: float) -> None:
        """A step of ``length`` was made."""
        self._rest -= length
        if self._rest <= 0.0:
            self.hurry()


class Branch:
    """An iterator over the points of a branch from ``start`` to ``stop_omega``.

    After the iteration ``points`` is the branch (without the points that were taken back because they lay on another
    curve, see ``retreats``), ``complete`` says whether the stop frequency was reached, and ``message`` says what
    happened. ``retreats`` are the frequencies in Hz where that was so, ``crossings`` those of corners that turn back
    and were passed by a longer step.
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
        self._visited = Visited()
        self._back: list[int] = []
        self._left: Trial | None = None  # where the last retreat went, and how many before it went there too
        self._again = 0
        self._pace = _Pace(settings.largest_step)
        self.points: list[BranchPoint] = []
        self.retreats: list[float] = []
        self.crossings: list[float] = []
        self.complete = False
        self.message = "The branch was not followed yet."

    def __iter__(self) -> Iterator[BranchPoint]:
        yield self._accept(BranchPoint(self._start, 0))
        tangent = self._first_tangent()
        bend, step = tangent.times(0.0), self._settings.first_step
        for _ in range(self._settings.max_points - 1):
            point = self.points[-1].trial
            outcome = self._advance(point, tangent, bend, min(step, self._pace.limit))
            if outcome is None:
                return
            correction, turned, taken, step = outcome
            self._pace.walked(taken)
            if self._beyond_stop(correction.trial):
                landed, iterations = self._land(point, correction.trial)
                self.complete = True
                self.message = "The stop frequency was reached."
                yield self._accept(BranchPoint(landed, iterations + correction.iterations))
                return
            if (correction.trial.omega - self._start.omega) * self._direction < 0.0:
                self.message = (
                    f"The branch turned back and left the window at {_hz(correction.trial.omega):.3f} Hz, where it had "
                    "started. Start from the other end (swap start and stop), or widen the window."
                )
                return
            yield self._accept(BranchPoint(correction.trial, correction.iterations))
            met = self._met()
            if met is None:
                bend = turned.plus(tangent.times(-1.0)).times(1.0 / taken)
                tangent = turned
                continue
            if len(self.retreats) == MOST_RETREATS:
                self.message = (
                    f"The branch came back to where it had been {MOST_RETREATS + 1} times, the last time at "
                    f"{_hz(self.points[-1].trial.omega):.3f} Hz: other solutions lie too close to it. Take more "
                    "samples, fewer harmonics, or more damping."
                )
                return
            tangent, step = self._retreat(met)
            bend = tangent.times(0.0)
        self.message = (
            f"{self._settings.max_points} points were not enough; the branch had come to "
            f"{_hz(self.points[-1].trial.omega):.3f} Hz. Raise max_points or narrow the window."
        )

    def _accept(self, point: BranchPoint) -> BranchPoint:
        self.points.append(point)
        self._visited.add(point.trial)
        return point

    def _met(self) -> int | None:
        """The point to go back to because the last step came back to the branch; None if it is new.

        On a loop, passed in the same direction again, that is the point before the loop's first; where the branch
        turned round, the point that it met first. Newton, held to the plane through the earlier point and started on
        the chord, decides whether that point lies on the curve that is followed now, or on one beside it.
        """
        trials = self._visited.trials
        metric = self._measure(trials[-1])
        chord = chord_between(trials[-2], trials[-1])
        for index, share in self._visited.near_last_chord(metric.u_scale, metric.w_scale):
            before, earlier = trials[-2], trials[index]
            guess = self._balance.evaluate(
                before.relative + share * chord.relative, before.omega + share * chord.omega, before.load
            )
            correction = self._newton.correct(guess, self._constraint(earlier, chord, 0.0))
            if not (correction.converged and self._same(correction.trial, earlier, chord)):
                continue
            if metric.product(chord, chord_between(earlier, trials[index + 1])) > 0.0:
                return max(index - 1, 0)
            self._back.append(index)
            return self._back[0] if len(self._back) == POINTS_BACK else None
        self._back.clear()
        return None

    def _same(self, first: Trial, second: Trial, chord: Tangent) -> bool:
        """Whether two solutions are one point of a curve that was followed along ``chord``."""

        def size(relative: FloatArray) -> float:
            return float(np.linalg.norm(self._balance.acting(relative)))

        allowed = SAME_POINT * size(chord.relative) + SAME_POINT_OF_SIZE * size(second.relative)
        allowed_omega = SAME_POINT * abs(chord.omega) + SAME_POINT_OF_SIZE * second.omega
        away = size(first.relative - second.relative)
        return away <= allowed and abs(first.omega - second.omega) <= allowed_omega

    def _retreat(self, last: int) -> tuple[Tangent, float]:
        """Forget the points after ``last``; the tangent there, and the next step.

        It is shorter than the one that left the branch; where shorter steps came back to the same place, longer ones
        are to pass it.
        """
        trials = self._visited.trials
        metric = self._measure(trials[-1])
        onward = chord_between(trials[last], trials[last + 1])
        length = math.sqrt(metric.product(onward, onward))
        self._again = self._again + 1 if self._retreated_near(trials[last], length, metric) else 0
        self._left = trials[last]
        self.retreats.append(_hz(trials[last].omega))
        if self._again == 0:
            step = max(SHORTER * length, self._settings.smallest_step)
            self._pace.slow_down(step)
        else:
            step = min(LONGER**self._again * length, self._settings.first_step)
            self._pace.hurry()
        del self.points[last + 1 :]
        self._visited.keep(last + 1)
        self._back.clear()
        system = self._newton.border(trials[last], self._constraint(trials[last], onward, 0.0))
        return metric.unit(self._direction_of(trials[last], system, 1.0)), step

    def _retreated_near(self, point: Trial, length: float, metric: Metric) -> bool:
        """Whether the last retreat went to a point within a few steps of this one."""
        if self._left is None:
            return False
        away = chord_between(self._left, point)
        return metric.product(away, away) <= (LONGER * length) ** 2

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

        ``bend`` is the change of the tangent over the last step per length: the guess follows the curvature. Where no
        shorter step succeeds, a corner that turns back lies ahead, and the plane across the tangent does not meet the
        branch there; a longer step may meet it behind the next corner, where it goes on.
        """
        settings, reason = self._settings, ""
        last: tuple[Correction, Tangent, float, float] | None = None
        for length in _lengths(step, settings):
            correction = self._newton.correct(*self._guess(point, tangent, bend, length))
            if not correction.converged:
                reason = reason or f"Newton stopped at a relative residual of {correction.trial.error:.1e}"
                continue
            # The last system of the correction is the point's own but for the last Newton step.
            system = correction.system or self._newton.border(
                correction.trial, self._constraint(point, tangent, length)
            )
            turned = self._direction_of(correction.trial, system, 1.0)
            metric = self._measure(correction.trial)
            angle = max(metric.angle_deg(turned, tangent), self._detour_deg(metric, point, correction.trial, tangent))
            found = correction, metric.unit(turned), length, self._next_step(length, correction.iterations, angle)
            if angle <= settings.largest_angle_deg:
                if length > step:
                    self.crossings.append(_hz(point.omega))
                return found
            reason = f"the branch turned by {angle:.0f} degrees"
            if length < 4.0 * settings.smallest_step:
                last = found  # a corner, if no step goes past it
        if last is None:
            self.message = (
                f"The branch was lost at {_hz(point.omega):.3f} Hz: {reason} even at the smallest step "
                f"({settings.smallest_step:g} of the window). Try more samples, fewer harmonics, or a lower force."
            )
        return last

    def _guess(self, point: Trial, tangent: Tangent, bend: Tangent, step: float) -> tuple[Trial, Constraint]:
        """Where a step would end, and the plane that holds its correction."""
        ahead = tangent.times(step).plus(bend.times(0.5 * step**2))
        guess = self._balance.evaluate(point.relative + ahead.relative, point.omega + ahead.omega, point.load)
        return guess, self._constraint(point, tangent, step)

    @staticmethod
    def _detour_deg(metric: Metric, before: Trial, after: Trial, tangent: Tangent) -> float:
        """Twice the angle from the tangent to the chord of a step: on an arc this is how much the tangent turns.

        It is large where Newton came down on another part of the curve, whose tangent may look alike.
        """
        return 2.0 * metric.angle_deg(chord_between(before, after), tangent)

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


def _lengths(step: float, settings: ContinuationSettings) -> Iterator[float]:
    """The lengths to try in turn: the wanted one and its halves, then longer ones that pass a corner."""
    length = step
    while length >= settings.smallest_step:
        yield length
        length *= 0.5
    length = 2.0 * step
    while length <= settings.first_step:
        yield length
        length *= 2.0


def _hz(omega: float) -> float:
    return omega / (2.0 * math.pi)
