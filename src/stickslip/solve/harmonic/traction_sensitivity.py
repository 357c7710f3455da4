"""Derivatives along a curve by the residual tractions of its pairs: one linear solution each, by the adjoint.

With a retained traction T0 the force of a pair depends on ``T0 + k s``, so a change of T0 acts as a change ``T0 / k``
of the mean displacement that the law sees: ``R(x; T0) = x - r + A d(x + T0 / k)``. With ``D = dd/dx``

    (I + D A) dd + D R_w dw = D dT0 / k,    a row that keeps the place along the curve,

and the derivative of ``c . dd + c_w dw`` is ``D^T z / k``, where z solves the transposed equations with (c, c_w).
At a pair that sticks throughout, D is zero: its traction is in balance at rest and changes no motion, until the limit
is reached. Beyond, the pair slips until its traction stays within the limit, and releases at most the largest
variation of its traction in a period: ``dd = -release`` on the mean. This one-sided effect takes the place of the
derivative there, in proportion to the traction over the friction limit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.core.fourier import synthesis_matrix
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.peak_values import weights_of_extreme
from stickslip.solve.harmonic.reduced import BorderedSystem, NewtonSystem, Row

# Samples of the period for the largest variation of a traction.
INSTANTS = 512
# chosen: a stuck pair that releases less than this fraction of its limit gets no traction. Many pairs that only creep
# at their limit make curves that the path follower loses (two-blade model).
LEAST_SHARE = 0.3


@dataclass(frozen=True)
class Quantity:
    """A number of a point, and its dependence on the residual tractions, (n_pairs, 2) per N.

    ``derivative`` is zero for a pair that sticks throughout. ``released`` is zero for all others: the effect of what
    such a pair releases at its limit, over that limit.
    """

    value: float
    derivative: FloatArray
    released: FloatArray

    @property
    def by_traction(self) -> FloatArray:
        """Both together."""
        return self.derivative + self.released


class TractionSensitivity:
    """Derivatives at a point of a frequency curve with retained tractions; ``along`` (2H+1, m) is its direction there.

    The derivative is at a fixed place along the curve, so at a peak it is that of the peak, at a fold that of the fold.
    """

    def __init__(self, balance: Balance, point: BalancePoint, along: FloatArray) -> None:
        self._balance, self._trial = balance, point.trial
        chord = balance.determined(along)
        system = NewtonSystem(balance, point.trial)
        place = Row(np.zeros(1), relative=chord / float(np.linalg.norm(chord)))
        self._system = system
        self._sticks = np.asarray(~point.trial.contact.moves.any(axis=1))
        self._released_share = released_share(balance, point)
        self._bordered = BorderedSystem(system, [balance.frequency_slope(point.trial)], [place])

    def frequency(self) -> Quantity:
        """The frequency in Hz."""
        still = np.zeros_like(self._trial.deviation)
        return self._quantity(self._trial.omega / (2.0 * np.pi), still, 1.0 / (2.0 * np.pi))

    def extremes(self, output: FloatArray, of_mean: FloatArray) -> tuple[Quantity, Quantity]:
        """The largest value of ``output @ u(t)`` over the period, and that of ``-output @ u(t)``.

        ``of_mean`` (n,) is the row of the output for the mean, which differs where a body walks.
        """
        balance, trial = self._balance, self._trial
        displacement = balance.displacement([trial])[0]
        coefficients = np.concatenate([displacement[:1] @ of_mean, displacement[1:] @ output])
        upper, lower = (
            self._value_at(weights_of_extreme(coefficients, sign), coefficients, output, of_mean)
            for sign in (1.0, -1.0)
        )
        return upper, lower

    def _value_at(
        self, weights: FloatArray, coefficients: FloatArray, output: FloatArray, of_mean: FloatArray
    ) -> Quantity:
        """``weights @ coefficients`` (2H+1,) of the output."""
        compliance, trial = self._balance.compliance, self._trial
        modal = weights[1:, None] * compliance.output_modes(output)
        by_deviation = compliance.amplitude_transposed(trial.omega, modal)
        by_deviation[0] = weights[0] * compliance.mean_transposed(of_mean)
        by_omega = float((modal * self._balance.amplitude_slope(trial)).sum())
        return self._quantity(float(weights @ coefficients), by_deviation, by_omega)

    def _quantity(self, value: float, by_deviation: FloatArray, by_omega: float) -> Quantity:
        """A number with these derivatives by the deviation (2H+1, m) and by omega."""
        system = self._system
        weights = system.scatter(self._bordered.solve_transposed(by_deviation, np.array([by_omega])))
        active = system.active.pairs
        local = weights.T.reshape(self._balance.pairs.n_pairs, 3, -1)[active]
        by_mean = np.zeros((self._balance.pairs.n_pairs, 3))
        by_mean[active] = np.einsum("iap,iapb->ib", local, system.tangent[:, :, :, :, 0])
        springs = self._balance.pairs.stuck_stiffness().reshape(-1, 3)
        answer = np.divide(by_mean, springs, out=np.zeros_like(by_mean), where=springs > 0.0)
        by_force = by_deviation[0] - self._balance.compliance.mean_relative(by_mean.ravel())
        released = -by_force.reshape(-1, 3) * self._released_share[:, None]
        sticks = self._sticks[:, None]
        return Quantity(value, np.where(sticks, 0.0, answer)[:, :2], np.where(sticks, released, 0.0)[:, :2])


def released_share(balance: Balance, point: BalancePoint) -> FloatArray:
    """(n_pairs,) what a stuck pair at its limit releases, over the limit: the largest variation of its traction."""
    pairs = balance.pairs
    vibration = point.unknowns[1:].T.reshape(pairs.n_pairs, 3, -1)[:, :2]
    signal = vibration @ synthesis_matrix(balance.harmonics, INSTANTS)[:, 1:].T
    traction = pairs.stuck_stiffness().reshape(-1, 3)[:, :2, None] * signal
    variation, limit = np.hypot(traction[:, 0], traction[:, 1]).max(axis=1), pairs.largest_slip_force
    share = np.divide(variation, limit, out=np.zeros_like(variation), where=limit > 0.0)
    return np.where(share >= LEAST_SHARE, np.minimum(share, 1.0), 0.0)
