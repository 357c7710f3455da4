"""Adjoint motions of values at points of a curve, and the work of changed matrices on them.

With the multipliers z of the balance and the derivative q_u of a value by the displacement, the adjoint motion is
``v = Zbar^-T (q_u + B^T z)``: a force e on the unknowns changes the value by ``v . e`` (docs/theory_gradients.md).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.curve_at_peak import CurvePlace
from stickslip.solve.harmonic.peak_values import PointValue
from stickslip.solve.setting_up import Balances


@dataclass(frozen=True)
class Adjoint:
    """A value of a point with its multipliers z (2H+1, m) and its adjoint motion v: (2H+1, n), modal (2H, n)."""

    place: CurvePlace
    value: PointValue
    multipliers: FloatArray
    motion: FloatArray
    amplitude: FloatArray

    @classmethod
    def of(cls, place: CurvePlace, value: PointValue, balances: Balances, output: FloatArray) -> Adjoint:
        """The adjoint of a value at a place of the curve, by one transposed solution."""
        multipliers, stuck, compliance = place.multipliers(value), balances.stuck, place.balance.compliance
        weights = value.by_coefficients if value.by_coefficients.size else np.zeros(len(multipliers))
        load = multipliers[1:] @ stuck.contact_modes + weights[1:, None] * compliance.output_modes(output)
        amplitude = compliance.adjoint_amplitude(place.point.trial.omega, load)
        mean = stuck.mean.solve(weights[0] * output + balances.pairs.operator.T @ multipliers[0])
        return cls(place, value, multipliers, np.vstack([mean, amplitude @ stuck.modes.T]), amplitude)


class Motions:
    """The motions u and adjoint motions v (k, 2H+1, N) of k adjoints, and the stuck modes (n_modes, N), in one space.

    The space is that of the unknowns, or that of the full mesh: ``lift`` converts rows (j, n) that vibrate with
    circular frequencies squared (j,) to rows (j, N). Only the lowest ``n_modes`` stuck modes are part of it.
    """

    def __init__(
        self,
        adjoints: Sequence[Adjoint],
        modes: FloatArray,
        lift: Callable[[FloatArray, FloatArray], FloatArray],
    ) -> None:
        trials = [adjoint.place.point.trial for adjoint in adjoints]
        self.omega = np.array([trial.omega for trial in trials])
        self.amplitude = np.array([trial.amplitude for trial in trials])[:, :, : len(modes)]
        self.adjoint_amplitude = np.array([adjoint.amplitude for adjoint in adjoints])[:, :, : len(modes)]
        self._adjoints, self._lift, self._modes = adjoints, lift, modes

    @cached_property
    def motion(self) -> FloatArray:
        """u (k, 2H+1, N)."""
        motions: dict[float, FloatArray] = {}
        for adjoint in self._adjoints:
            if adjoint.place.place not in motions:
                place = adjoint.place
                trial = place.point.trial
                motions[place.place] = self._lifted(place.balance.displacement([trial])[0], trial.omega)
        return np.array([motions[adjoint.place.place] for adjoint in self._adjoints])

    @cached_property
    def adjoint(self) -> FloatArray:
        """v (k, 2H+1, N)."""
        return np.array([self._lifted(each.motion, each.place.point.trial.omega) for each in self._adjoints])

    def _lifted(self, motion: FloatArray, omega: float) -> FloatArray:
        """Rows (2H+1, N) of coefficients (2H+1, n)."""
        order = (np.arange(len(motion)) + 1) // 2
        return self._lift(motion, np.asarray(order * omega, dtype=float) ** 2)

    @cached_property
    def modes(self) -> FloatArray:
        """(n_modes, N)."""
        return self._lift(self._modes, np.zeros(len(self._modes)))

    def static_work(self, matrix: Any) -> FloatArray:
        """(k,) ``v . A u`` over all harmonics."""
        return np.asarray((self.adjoint * _times(matrix, self.motion)).sum(axis=(1, 2)))

    def inertial_work(self, matrix: Any) -> FloatArray:
        """(k,) ``-(h w)^2 v . A u``."""
        product = (self.adjoint * _times(matrix, self.motion))[:, 1:].sum(axis=2)
        order = np.repeat(np.arange(1, self.motion.shape[1] // 2 + 1), 2)
        return np.asarray(-(product * order**2).sum(axis=1) * self.omega**2)

    def viscous_work(self, matrix: Any) -> FloatArray:
        """(k,) ``v . A u'``."""
        return self._viscous(self.adjoint[:, 1:], _times(matrix, self.motion)[:, 1:])

    def modal_viscous_work(self, matrix: FloatArray) -> FloatArray:
        """(k,) ``v . C u'`` for a damping matrix (n_modes, n_modes) in the stuck modes."""
        return self._viscous(self.adjoint_amplitude, self.amplitude @ matrix)

    def _viscous(self, adjoint: FloatArray, product: FloatArray) -> FloatArray:
        # The velocity of c cos + s sin is h w (s cos - c sin).
        order = np.arange(1, adjoint.shape[1] // 2 + 1)
        work = (adjoint[:, 0::2] * product[:, 1::2] - adjoint[:, 1::2] * product[:, 0::2]).sum(axis=2)
        return np.asarray((order * work).sum(axis=1) * self.omega)

    def modal_form(self, matrix: Any) -> FloatArray:
        """(n_modes, n_modes) ``phi^T A phi``."""
        return np.asarray(self.modes @ _times(matrix, self.modes).T)


def _times(matrix: Any, rows: FloatArray) -> FloatArray:
    """A symmetric matrix (N, N), which may be sparse, times each of the rows (..., N)."""
    flat = rows.reshape(-1, rows.shape[-1])
    return np.asarray(matrix @ flat.T).T.reshape(rows.shape)
