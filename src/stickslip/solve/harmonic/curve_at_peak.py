"""A frequency curve around a peak of an output: points at prescribed places, and adjoint solutions there.

The place along the curve is ``s = c . (x - x_0)``, with the unit vector c along the tangent at the peak x_0. At a place
the balance ``R(x, w) = 0`` and this condition determine the point, also at a fold, where ``R_x`` is singular. The
amplitude a(s) is stationary at the peak: ``a' = 0``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.peak import CurvePeak
from stickslip.solve.harmonic.peak_values import PointValue, output_amplitude
from stickslip.solve.harmonic.reduced import BorderedSystem, NewtonSystem, Row
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane

# chosen: digits of a tangent; differences of neighbouring places are derivatives, so they are more than in peak.py.
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
    """The curve of a balance around its peak.

    Parameters
    ----------
    balance:
        with the exact compliance in Newton's matrix too: the multipliers have no iteration that corrects them.
    output:
        (n,) row.
    peak:
        the exact peak, at the place zero; the chord has the direction of the tangent there.
    """

    def __init__(self, balance: Balance, output: FloatArray, peak: CurvePeak, newton: NewtonSettings) -> None:
        self.balance, self._output = balance, output
        self._curve = FrequencyCurve(balance)
        self._newton = Newton(self._curve, newton)
        chord = balance.determined(peak.probe.tangent.unknowns)
        length = float(np.linalg.norm(chord))
        if length == 0.0:
            raise ConvergenceError("the relative displacements do not change along the curve at the peak.")
        self._normal, self._origin = chord / length, peak.probe.point
        self.top = self._nearest = self._linearised(0.0, self._origin)
        # Of the logarithm of the amplitude by the lag, of which the chord is the derivative.
        self.width = length / math.sqrt(-peak.curvature)

    def at(self, place: float) -> CurvePlace:
        """The point at a place. Raises ConvergenceError."""
        start = self._nearest
        relative, _, omega = start.by_place
        step = place - start.place
        guess = self._curve.at(start.point.unknowns + step * relative, start.point.trial.omega + step * omega)
        plane = Plane(self._normal, 0.0, self._origin.unknowns + place * self._normal, 0.0)
        correction = self._newton.correct(guess, plane)
        if not correction.converged:
            raise ConvergenceError(
                f"the solver found no point of the curve close to the peak at {self._curve.named(guess.trial.omega)}: "
                f"the relative residual is {correction.point.error:.1e}."
            )
        self._nearest = self._linearised(place, correction.point)
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
