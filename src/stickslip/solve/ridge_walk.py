"""Follow a maximum of a frequency curve while a parameter changes, step by step in the logarithm of the parameter.

Maxima and minima of a smooth family of curves annihilate where a ridge folds back in the parameter (there ``g'' = 0``,
and its other part consists of minima). A ridge of maxima is therefore single-valued, and is followed at given values.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.peak import CurvePeak
from stickslip.solve.ridge_stage import RidgeStage

# chosen: the step grows or shrinks at most by these factors.
GROWTH, SHRINKAGE = 1.6, 0.5
# Polynomials through at most so many points predict the next one.
PREDICTED_FROM = 3
TOO_MUCH_WORK = "more work was not allowed"


@dataclass(frozen=True)
class RidgePoint:
    """A maximum at a value of the parameter.

    ``mode`` is the number from 0 of the stuck mode that was closest to the start of the ridge, ``mode_omega`` its
    circular frequency at this value: the frequency of the peak follows that of the mode.
    """

    parameter: float
    peak: CurvePeak
    mode: int
    mode_omega: float

    @classmethod
    def start(cls, parameter: float, peak: CurvePeak, stuck_omega: FloatArray) -> RidgePoint:
        """The first point of a ridge; ``stuck_omega`` (n,) are the frequencies of the stuck modes there."""
        mode = int(np.abs(stuck_omega - peak.omega).argmin())
        return cls(parameter, peak, mode, float(stuck_omega[mode]))

    @property
    def trial(self) -> Trial:
        """The solution at the last point of the search."""
        return self.peak.probe.point.trial

    @property
    def shape(self) -> FloatArray:
        """(2H+1, m) relative displacements there over the amplitude of the output."""
        return np.asarray(self.trial.relative / self.peak.amplitude)


@dataclass(frozen=True)
class Pace:
    """Step control along a ridge; steps in the natural logarithm of the parameter.

    wanted_error:
        of the extrapolated logarithm of the amplitude. The interpolation between the points is then some ten times
        better than 0.1 %.
    largest_error:
        above it the step is repeated with half its length: the search arrived at another peak. After the first point,
        which predicts no change, twice this error is allowed.
    """

    first_step: float = 0.1
    smallest_step: float = 2e-3
    largest_step: float = 0.6
    wanted_error: float = 0.02
    largest_error: float = 0.1
    most_points: int = 200

    def next_point(self, stage: RidgeStage, near: list[RidgePoint], value: float) -> tuple[RidgePoint | str, float]:
        """The maximum at a value from an extrapolation of points near it, and the error of its logarithm."""
        weights = _weights([math.log(each.parameter) for each in near], math.log(value))

        def predicted(of: Callable[[RidgePoint], FloatArray | float]) -> FloatArray:
            return np.asarray(sum(weight * of(each) for weight, each in zip(weights, near, strict=True)))

        height = float(predicted(lambda each: math.log(each.peak.amplitude)))
        mode = near[-1].mode
        mode_omega = float(stage.stuck_omega[mode])
        omega = mode_omega * math.exp(float(predicted(lambda each: math.log(each.trial.omega / each.mode_omega))))
        unknowns = math.exp(height) * predicted(lambda each: each.shape)
        last = near[-1].peak
        found = stage.search.from_estimate(unknowns, omega, last.probe.tangent, last.curvature)
        if isinstance(found, str):
            return found, math.inf
        error = abs(math.log(found.amplitude) - height)
        if error > self.largest_error * (2.0 if len(near) == 1 else 1.0):
            return "the peak becomes another one", error
        return RidgePoint(value, found, mode, mode_omega), error


def follow(
    stage_at: Callable[[float], RidgeStage | str],
    start: RidgePoint,
    stop: float,
    pace: Pace,
    is_needless: Callable[[RidgePoint], str] = lambda point: "",
) -> tuple[list[RidgePoint], str]:
    """Points after ``start`` towards the value ``stop``, and why they end earlier, "" if they do not.

    ``is_needless`` gives a reason to end at a point, or "".
    """
    points, end = [start], math.log(stop)
    direction, step = math.copysign(1.0, end - math.log(start.parameter)), pace.first_step
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
            step = SHRINKAGE * length
            if step < pace.smallest_step:
                return points[1:], f"beyond {points[-1].parameter:.4g}, {after}"
            continue
        points.append(after)
        if reason := is_needless(after):
            return points[1:], reason
        # The error of a polynomial of n points grows with the n-th power of the step.
        factor = (pace.wanted_error / max(error, 1e-12)) ** (1.0 / min(len(points), PREDICTED_FROM))
        step = min(pace.largest_step, length * min(GROWTH, max(SHRINKAGE, factor)))
    return points[1:], f"beyond {points[-1].parameter:.4g}, {pace.most_points} points were not enough"


def _weights(places: list[float], at: float) -> FloatArray:
    """Weights of the polynomial through some places, at another one (Lagrange)."""
    return np.array(
        [math.prod((at - other) / (place - other) for other in places if other != place) for place in places]
    )
