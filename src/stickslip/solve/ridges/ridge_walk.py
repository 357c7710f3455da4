"""Follow a maximum of a frequency curve while a parameter changes, step by step in the logarithm of the parameter.

Maxima and minima of a smooth family of curves annihilate where a ridge folds back in the parameter (there ``g'' = 0``,
and its other part consists of minima). A ridge of maxima is therefore single-valued, and is followed at given values.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stickslip.contact.law.law import ContactState
from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.results.highest_peak import log_between
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.peak import ANOTHER_PEAK, CurvePeak, delayed
from stickslip.solve.ridges.ridge_stage import RidgeStage, StuckMode, resized_step

# chosen: the step grows or shrinks at most by these factors.
GROWTH, SHRINKAGE = 2.0, 0.5
# Polynomials through at most so many points predict the next one.
PREDICTED_FROM = 3
# chosen: a peak this close to its stuck mode, relative, may become the linear peak where its pairs no longer slip.
NEAR_MODE = 0.003
# chosen: above this fraction of the linear stuck peak few pairs slip, and the peak changes as that one does.
LITTLE_SLIP = 0.8
# chosen: a peak this close to the linear one is that one; a search has an error of 1e-4 at most.
LINEAR = 1e-3
# chosen: largest error of the extrapolated logarithm; only linear peaks, which are solutions for certain, reach it.
LARGEST_CHANGE = 0.5
# chosen: a step of so many smallest ones passes a node of the excitation.
LEAP = 2.0
# chosen: an estimated error above this fraction of the accuracy has no neighbour without an estimate.
CALM = 0.2
TOO_MUCH_WORK = "more work was not allowed"


@dataclass(frozen=True)
class RidgePoint:
    """A maximum at a value of the parameter.

    ``mode`` is the stuck mode that was closest to the start of the ridge: the frequency of the peak follows that of the
    mode. ``stuck_amplitude`` is that of the linear peak of the mode with all pairs stuck, NaN without one.
    ``estimates`` are the relative errors by neglected harmonics by the number of harmonics, that of the point the
    largest one; empty where they are not estimated. ``motion`` are all unknowns (2H, n) without the mean, of mass norm
    1, ``momentum`` is that times the mass matrix, and ``rise`` is the derivative of the logarithm of the amplitude by
    that of the parameter at fixed lag, not a number where it is not known.
    """

    parameter: float
    peak: CurvePeak
    mode: StuckMode
    stuck_amplitude: float
    motion: FloatArray
    momentum: FloatArray
    rise: float = math.nan
    estimates: Mapping[int, float] = field(default_factory=dict)

    @classmethod
    def start(cls, parameter: float, peak: CurvePeak, stage: RidgeStage) -> RidgePoint:
        """The first point of a ridge, on the equations of its parameter."""
        closest = int(np.abs(stage.stuck_omega - peak.omega).argmin())
        return cls.of_mode(parameter, peak, stage.stuck_mode(closest), stage)

    @classmethod
    def of_mode(cls, parameter: float, peak: CurvePeak, mode: StuckMode, stage: RidgeStage) -> RidgePoint:
        """A point of the ridge of a stuck mode."""
        stuck = stage.stuck_peak(mode.number)
        amplitude = peak.probe.point.trial.amplitude
        motion = amplitude @ stage.balances.stuck.modes.T / np.linalg.norm(amplitude)
        height = math.nan if stuck is None else stuck.amplitude
        return cls(parameter, peak, mode, height, motion, motion @ mode.mass)

    @property
    def harmonics(self) -> int:
        """The number of harmonics."""
        return self.peak.harmonics

    @property
    def is_stuck(self) -> bool:
        """Whether no pair slips or separates."""
        return bool((self.trial.contact.state == ContactState.STUCK).all())

    @property
    def is_linear(self) -> bool:
        """Whether it is the linear peak of the stuck mode: pairs that slip a little beside it move it."""
        return self.is_stuck and abs(self.peak.amplitude / self.stuck_amplitude - 1.0) < LINEAR

    @property
    def trial(self) -> Trial:
        """The solution at the last point of the search."""
        return self.peak.probe.point.trial

    @property
    def shape(self) -> FloatArray:
        """(2H+1, m) relative displacements there over the amplitude of the output."""
        return np.asarray(self.trial.relative / self.peak.amplitude)

    def lag_to(self, other: RidgePoint) -> float:
        """The phase lag in rad by which the motion of another point is behind: the shift in time that fits the change
        of the motion best (mass norm), a mean of those from both. Not a number in other coordinates."""
        if not self.mode.is_comparable(other.mode):
            return math.nan
        rows = 2 * max(self.harmonics, other.harmonics)
        change = with_rows(other.motion, rows) - with_rows(self.motion, rows)
        lag = 0.0
        for each in (self, other):
            turned, weights = (with_rows(delayed(array), rows) for array in (each.motion, each.momentum))
            lag += 0.5 * float(np.vdot(weights, change)) / float(np.vdot(weights, turned))
        return lag


@dataclass(frozen=True)
class Pace:
    """Step control along a ridge; steps in the natural logarithm of the parameter.

    wanted_error:
        of the extrapolated logarithm of the amplitude. The interpolation between the points is then some ten times
        better than 0.1 %.
    largest_error:
        above it the step is repeated with half its length: the search arrived at another peak. After the first point,
        which predicts no change, twice this error is allowed.
    accuracy:
        largest estimated error by neglected harmonics, relative: a point above it has more harmonics, at most
        ``most_harmonics``. Infinite for a fixed number of harmonics without estimates.
    estimate_every:
        distance in the logarithm after which a point has an estimate of this error, if that of the last one was small.
    interpolation_error:
        largest estimated error of the interpolated highest peak, relative.
    """

    first_step: float = 0.1
    smallest_step: float = 2e-3
    largest_step: float = 0.6
    wanted_error: float = 0.02
    largest_error: float = 0.1
    most_points: int = 200
    accuracy: float = math.inf
    most_harmonics: int = 0
    estimate_every: float = math.inf
    interpolation_error: float = 5e-4  # the demand is 0.1 %

    @property
    def has_fixed_harmonics(self) -> bool:
        """Whether no error by neglected harmonics is estimated."""
        return math.isinf(self.accuracy)

    def resolved(self, point: RidgePoint, stage: RidgeStage, earlier: Sequence[RidgePoint] = ()) -> RidgePoint:
        """The point with its slope, an estimate of its error, and as many harmonics as the accuracy requires; without
        the latter two if one of the ``earlier`` points is close and has a small error."""
        return self._sloped(self._accurate(point, stage, earlier), stage)

    def between(self, point: RidgePoint, stage: RidgeStage, near: Sequence[RidgePoint]) -> RidgePoint:
        """As :meth:`resolved`, for a point between two others. It has no estimate of its own if both have one that is
        small enough: the larger one of them counts."""
        if all(each.estimates and each.estimates[each.harmonics] < self.accuracy for each in near):
            return self._sloped(point, stage)
        return self.resolved(point, stage, near)

    @staticmethod
    def _sloped(point: RidgePoint, stage: RidgeStage) -> RidgePoint:
        """The point with its slope."""
        return replace(point, rise=stage.with_harmonics(point.harmonics).rise(point.peak))

    def _accurate(self, point: RidgePoint, stage: RidgeStage, earlier: Sequence[RidgePoint]) -> RidgePoint:
        """The point with an estimate and enough harmonics. Where all pairs stick nothing is neglected."""
        if self.has_fixed_harmonics:
            return point
        if point.is_stuck:
            return replace(point, estimates={point.harmonics: 0.0})
        last = next((each for each in reversed(earlier) if each.estimates and not each.is_stuck), None)
        if (
            last is not None
            and last.estimates[last.harmonics] < CALM * self.accuracy
            and abs(math.log(point.parameter / last.parameter)) < self.estimate_every
        ):
            return point
        own = stage.with_harmonics(point.harmonics)
        peak, estimates = own.refined(point.peak, self.accuracy, self.most_harmonics)
        return replace(point, peak=peak, estimates=estimates)

    def next_point(self, stage: RidgeStage, near: list[RidgePoint], value: float) -> tuple[RidgePoint | str, float]:
        """The maximum at a value from points near it, and the error of its extrapolated logarithm.

        It has the harmonics of the last of these points. Amplitudes are extrapolated over those of the linear stuck
        peak: where the force acts at a node of the stuck mode, both fall to almost nothing.
        """
        last = near[-1]
        mode = stage.same_mode(last.mode)
        # Without the same coordinates a mode is known by its number, which may become that of another mode.
        stuck = stage.stuck_peak(mode.number) if mode.is_comparable(last.mode) else None
        weights = _weights([math.log(each.parameter) for each in near], math.log(value))
        plain = _extrapolated(near, weights, value)
        highest = max(each.peak.amplitude for each in near)
        if stuck is not None and abs(math.log(last.peak.omega / last.mode.omega)) < NEAR_MODE:
            linear = stage.linear_point(stuck.frequency_hz)
            if stage.is_solution(linear) and not isinstance(found := stage.search.from_point(linear), str):
                after = RidgePoint.of_mode(value, found, mode, stage)
                # Beside a node of the excitation the logarithm has no bound.
                return after, abs(found.amplitude - math.exp(plain)) / max(found.amplitude, highest)
        height = plain
        slips_little = any(each.peak.amplitude > LITTLE_SLIP * each.stuck_amplitude for each in near)
        if stuck is not None and slips_little and not any(math.isnan(each.stuck_amplitude) for each in near):
            ratios = [math.log(each.peak.amplitude / each.stuck_amplitude) for each in near]
            height = math.log(stuck.amplitude) + _predicted(weights, ratios)
        across = last.peak.probe.tangent
        if stuck is not None and last.is_stuck:
            omega = 2.0 * math.pi * stuck.frequency_hz
            unknowns = stage.search.balance.linear(omega)
            across = resized_step(across, stage.harmonics)
        else:
            stage, rows = stage.with_harmonics(last.harmonics), 2 * last.harmonics + 1
            turned = _predicted(weights, [math.log(each.trial.omega / each.mode.omega) for each in near])
            omega = mode.omega * math.exp(turned)
            unknowns = math.exp(height) * sum(
                weight * with_rows(each.shape, rows) for weight, each in zip(weights, near, strict=True)
            )
        allowed = self.largest_error * (2.0 if len(near) == 1 else 1.0)
        found = stage.search.from_estimate(unknowns, omega, across, last.peak.curvature, math.exp(height + allowed))
        if isinstance(found, str):
            return found, math.inf
        if math.log(found.amplitude) < height - allowed:
            return ANOTHER_PEAK, math.inf
        after = RidgePoint.of_mode(value, found, mode, stage)
        return after, abs(math.log(found.amplitude) - plain)


def follow(
    stage_at: Callable[[float], RidgeStage | str],
    start: RidgePoint,
    stop: float,
    pace: Pace,
    is_needless: Callable[[RidgePoint], str] = lambda point: "",
    is_high: Callable[[RidgePoint], bool] = lambda point: True,
) -> tuple[list[RidgePoint], str]:
    """Points after ``start`` towards the value ``stop``, and why they end earlier, "" if they do not.

    ``is_needless`` gives a reason to end at a point, or ""; small steps are tried only beyond a point that ``is_high``.
    """
    points, end = [start], math.log(stop)
    direction, step, leaps = math.copysign(1.0, end - math.log(start.parameter)), pace.first_step, 0
    has_failed = False
    while len(points) < pace.most_points:
        here = math.log(points[-1].parameter)
        left = (end - here) * direction
        if left <= 0.0:
            return points[1:], ""
        is_last = step > 0.7 * left  # no tiny step at the end
        length = left if is_last else step
        value = stop if is_last else math.exp(here + direction * length)
        stage = stage_at(value)
        after: RidgePoint | str
        if isinstance(stage, str):
            after, error = stage, math.inf
        else:
            after, error = pace.next_point(stage, points[-PREDICTED_FROM:], value)
        if isinstance(after, str):
            if after == TOO_MUCH_WORK:
                return points[1:], after
            step, has_failed = SHRINKAGE * length, True
            if step < (pace.smallest_step if is_high(points[-1]) else pace.first_step * SHRINKAGE):
                # At a node of the excitation a stuck mode has no peak; beyond it the peak is there again.
                if leaps or not points[-1].is_stuck:
                    return points[1:], f"beyond {points[-1].parameter:.4g}, {after}"
                step, leaps = LEAP * pace.smallest_step, 1
            continue
        if error > LARGEST_CHANGE and length > 1.01 * LEAP * pace.smallest_step:  # right, but with what between?
            step = SHRINKAGE * length
            continue
        leaps = 0
        assert not isinstance(stage, str)  # it has a point
        points.append(pace.resolved(after, stage, points))
        if reason := is_needless(points[-1]):
            return points[1:], reason
        # The error of a polynomial of n points grows with the n-th power of the step.
        factor = (pace.wanted_error / max(error, 1e-12)) ** (1.0 / min(len(points), PREDICTED_FROM))
        # Twice the length that was right after a failure is the length that failed.
        growth, has_failed = 1.0 if has_failed else GROWTH, False
        longer = max(pace.smallest_step, length * min(growth, max(SHRINKAGE, factor)))
        step = min(pace.largest_step, longer)
    return points[1:], f"beyond {points[-1].parameter:.4g}, {pace.most_points} points were not enough"


def _extrapolated(near: Sequence[RidgePoint], weights: FloatArray, value: float) -> float:
    """The logarithm of the amplitude at a value: the polynomial through points near it, or between stuck points, where
    slopes are exact, the one of both slopes, which passes a node of the excitation."""
    before, last = near[-2:] if len(near) > 1 else (near[-1], near[-1])
    if before is not last and before.is_stuck and last.is_stuck and not math.isnan(before.rise + last.rise):
        places, heights, slopes = (
            (np.array(first), np.array(second))
            for first, second in (
                (math.log(before.parameter), math.log(last.parameter)),
                (math.log(before.peak.amplitude), math.log(last.peak.amplitude)),
                (before.rise, last.rise),
            )
        )
        return float(log_between(places, heights, slopes, np.array(math.log(value))))
    return _predicted(weights, [math.log(each.peak.amplitude) for each in near])


def _predicted(weights: FloatArray, values: list[float]) -> float:
    """The weighted sum of values at some places."""
    return float(weights @ np.array(values))


def _weights(places: list[float], at: float) -> FloatArray:
    """Weights of the polynomial through some places, at another one (Lagrange)."""
    return np.array(
        [math.prod((at - other) / (place - other) for other in places if other != place) for place in places]
    )
