"""A frequency curve around a peak of an output: points at prescribed places, the peak itself, and adjoint solutions.

The place along the curve is ``s = c . (x - x_0)``, with the unit vector c along the chord around the peak. At a place
the balance ``R(x, w) = 0`` and this condition determine the point, also at a fold, where ``R_x`` is singular. The
amplitude a(s) is stationary at the peak: ``a' = 0``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.peak_values import PointValue, output_amplitude
from stickslip.solve.harmonic.reduced import BorderedSystem, NewtonSystem, Row
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane

# Relative accuracy of the place of a peak, near round-off: derivatives of a peak are wrong by the first power of it.
PLACE = 1e-13
# Largest slope at a peak, over amplitude and width. The force is sampled, so the slope jumps by about 2 / samples where
# a sample begins to slip; chosen: ten times the jump with 1024 samples. A change of contact has a slope above 0.1.
FLAT = 0.02
TANGENT_TOLERANCE = 1e-10


@dataclass(frozen=True)
class CurvePlace:
    """A point of the curve with its linearised equations.

    Attributes
    ----------
    place:
        s in m.
    point:
        the point.
    by_place:
        derivatives along s: (2H+1, m) of x and of d, and of w.
    amplitude, slope:
        the amplitude of the output and its derivative along s.
    """

    place: float
    balance: Balance
    point: BalancePoint
    system: BorderedSystem
    by_place: tuple[FloatArray, FloatArray, float]
    amplitude: PointValue
    slope: float

    def along(self, value: PointValue) -> float:
        """The derivative of a value along s."""
        relative, deviation, omega = self.by_place
        along = np.vdot(value.by_relative, relative) + np.vdot(value.by_deviation, deviation)
        return float(along + value.by_omega * omega)

    def multipliers(self, value: PointValue) -> FloatArray:
        """(2H+1, m) multipliers of the balance for a value at this place (:meth:`BorderedSystem.multipliers`)."""
        return self.system.multipliers(value.by_relative, value.by_deviation, np.array([value.by_omega]))


class CurveAtPeak:
    """The curve of a balance around a peak, from three neighbouring points of it.

    Parameters
    ----------
    balance:
        with the exact compliance in Newton's matrix too: the multipliers have no iteration that corrects them.
    output:
        (n,) row.
    around:
        the points before, at and after the highest point.
    """

    def __init__(
        self,
        balance: Balance,
        output: FloatArray,
        around: Sequence[BalancePoint],
        newton: NewtonSettings,
    ) -> None:
        self.balance, self._output = balance, output
        self._curve = FrequencyCurve(balance)
        self._newton = Newton(self._curve, newton)
        before, middle, after = around
        chord = balance.determined(after.unknowns - before.unknowns)
        length = float(np.linalg.norm(chord))
        if length == 0.0:
            raise ConvergenceError("the points around the peak are one: the curve has no direction there.")
        self._normal, self._origin = chord / length, middle
        self.ends = tuple(float(np.vdot(self._normal, each.unknowns - middle.unknowns)) for each in (before, after))
        self._nearest = self._linearised(0.0, self._at(0.0, middle))

    def _at(self, place: float, guess: BalancePoint) -> BalancePoint:
        target = self._origin.unknowns + place * self._normal
        plane = Plane(self._normal, 0.0, target, 0.0)
        correction = self._newton.correct(guess, plane)
        if not correction.converged:
            raise ConvergenceError(
                f"the solver found no point of the curve close to the peak at {self._curve.named(guess.trial.omega)}: "
                f"the relative residual is {correction.point.error:.1e}."
            )
        return correction.point

    def at(self, place: float) -> CurvePlace:
        """The point at a place. Raises ConvergenceError."""
        start = self._nearest
        relative, _, omega = start.by_place
        step = place - start.place
        guess = self._curve.at(start.point.unknowns + step * relative, start.point.trial.omega + step * omega)
        self._nearest = self._linearised(place, self._at(place, guess))
        return self._nearest

    def _linearised(self, place: float, point: BalancePoint) -> CurvePlace:
        balance, trial = self.balance, point.trial
        row = Row(np.zeros(1), relative=self._normal)
        system = BorderedSystem(NewtonSystem(balance, trial), [balance.frequency_slope(trial)], [row])
        amplitude = output_amplitude(balance, trial, self._output)
        step = system.solve(np.zeros_like(point.residual), np.ones(1), TANGENT_TOLERANCE)
        if not np.isfinite(step.parameters).all():
            raise ConvergenceError(
                f"the equations are singular at {self._curve.named(trial.omega)}, close to the peak."
            )
        by_place = step.unknowns, step.detail, float(step.parameters[0])
        slope = np.vdot(amplitude.by_deviation, by_place[1]) + amplitude.by_omega * by_place[2]
        return CurvePlace(place, balance, point, system, by_place, amplitude, float(slope))

    def peak(self) -> tuple[CurvePlace, float]:
        """The point with the largest amplitude between the outer ones, and the width of the peak in m.

        The width is the distance along s over which the amplitude changes by its own size, from its curvature between
        the outer points. Raises ConvergenceError.
        """
        slopes = [self.at(end).slope for end in self.ends]
        if not slopes[0] > 0.0 > slopes[1]:
            raise ConvergenceError(
                "the amplitude does not rise on one side of the peak and fall on the other: the points of the curve "
                "are too far apart. Use a smaller largest_step."
            )
        extent = self.ends[1] - self.ends[0]
        place = scipy.optimize.brentq(lambda s: self.at(s).slope, *self.ends, xtol=PLACE * extent)
        peak = self.at(float(place))
        width = math.sqrt(peak.amplitude.value * extent / (slopes[0] - slopes[1]))
        if abs(peak.slope) * width > FLAT * peak.amplitude.value:
            raise ConvergenceError(
                f"the curve has a corner at its peak, {self._curve.named(peak.point.trial.omega)}: the contact changes "
                "its state there, and the peak has no derivative. More samples may resolve it."
            )
        return peak, width
