"""Derivatives along a curve by the residual tractions of its pairs: one linear solution each, by the adjoint.

With a retained traction T0 the force of a pair depends on ``T0 + k s``, so a change of T0 acts as a change ``T0 / k``
of the mean displacement that the law sees: ``R(x; T0) = x - r + A d(x + T0 / k)``. With ``D = dd/dx``

    (I + D A) dd + D R_w dw = D dT0 / k,    a row that keeps the place along the curve,

and the derivative of ``c . dd + c_w dw`` is ``D^T z / k``, where z solves the transposed equations with (c, c_w).
At a pair that sticks throughout, D is zero: its traction is in balance at rest and changes no motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.core.fourier import synthesis_matrix
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.reduced import BorderedSystem, NewtonSystem, Row

# Samples of the period for the instant of the largest displacement; its error enters only to second order.
INSTANTS = 512


@dataclass(frozen=True)
class Quantity:
    """A number of a point, and its derivative by the residual tractions, (n_pairs, 2) per N."""

    value: float
    by_traction: FloatArray


class TractionSensitivity:
    """Derivatives at one point of a frequency curve with retained tractions; ``before`` and ``after`` are neighbours.

    The derivative is at a fixed place along the curve, so at a peak it is that of the peak, at a fold that of the fold.
    """

    def __init__(self, balance: Balance, point: BalancePoint, before: BalancePoint, after: BalancePoint) -> None:
        self._balance, self._trial = balance, point.trial
        chord = balance.determined(after.unknowns - before.unknowns)
        system = NewtonSystem(balance, point.trial)
        along = Row(np.zeros(1), relative=chord / float(np.linalg.norm(chord)))
        self._system = system
        self._bordered = BorderedSystem(system, [balance.frequency_slope(point.trial)], [along])

    def frequency(self) -> Quantity:
        """The frequency in Hz."""
        still = np.zeros_like(self._trial.deviation)
        return Quantity(self._trial.omega / (2.0 * np.pi), self._by_traction(still, 1.0) / (2.0 * np.pi))

    def extremes(self, output: FloatArray) -> tuple[Quantity, Quantity]:
        """The largest value of ``output @ u(t)`` over the period, and that of ``-output @ u(t)``."""
        balance, trial = self._balance, self._trial
        coefficients = balance.displacement([trial])[0] @ output
        synthesis = synthesis_matrix(balance.harmonics, INSTANTS)
        signal = synthesis @ coefficients
        return tuple(  # type: ignore[return-value]
            self._value_at(synthesis[int((sign * signal).argmax())] * sign, coefficients, output)
            for sign in (1.0, -1.0)
        )

    def _value_at(self, weights: FloatArray, coefficients: FloatArray, output: FloatArray) -> Quantity:
        """``weights @ coefficients`` (2H+1,) of the output."""
        compliance, trial = self._balance.compliance, self._trial
        modal = weights[1:, None] * compliance.output_modes(output)
        by_deviation = compliance.amplitude_transposed(trial.omega, modal)
        by_deviation[0] = weights[0] * compliance.mean_transposed(output)
        by_omega = float((modal * self._balance.amplitude_slope(trial)).sum())
        return Quantity(float(weights @ coefficients), self._by_traction(by_deviation, by_omega))

    def _by_traction(self, by_deviation: FloatArray, by_omega: float) -> FloatArray:
        """(n_pairs, 2) the derivative of a number with these derivatives by the deviation (2H+1, m) and by omega."""
        system = self._system
        weights = system.scatter(self._bordered.solve_transposed(by_deviation, np.array([by_omega])))
        active = system.active.pairs
        local = weights.T.reshape(self._balance.pairs.n_pairs, 3, -1)[active]
        answer = np.zeros((self._balance.pairs.n_pairs, 3))
        answer[active] = np.einsum("iap,iapb->ib", local, system.tangent[:, :, :, :, 0])
        springs = self._balance.pairs.stuck_stiffness().reshape(-1, 3)
        np.divide(answer, springs, out=answer, where=springs > 0.0)
        return answer[:, :2]
