"""The outputs of many curves: Fourier coefficients and amplitudes of one output of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.solve.batch.curve_points import CurvePoints
from stickslip.solve.harmonic.harmonic_modes import IndexArray
from stickslip.solve.setting_up import Balances


@dataclass(frozen=True)
class Outputs:
    """The outputs of B curves: ``modal`` (B, n) of the modes, ``mean`` (B, m) m/N of mean deviations on the pairs."""

    modal: FloatArray
    mean: FloatArray

    @classmethod
    def of(cls, curves: Sequence[Balances], rows: Sequence[FloatArray]) -> Outputs:
        """The outputs ``rows`` (n,) of the unknowns of curves."""
        stuck = [each.stuck for each in curves]
        modal = [row @ each.modes for row, each in zip(rows, stuck, strict=True)]
        mean = [-(each.pairs.operator @ each.mean.solve(row)) for row, each in zip(rows, stuck, strict=True)]
        return cls(np.array(modal), np.array(mean))

    def coefficients(self, curves: IndexArray, points: CurvePoints) -> FloatArray:
        """(k, W) m, the outputs of points of some curves (k,): mean, cos 1, sin 1, ..."""
        vibration = np.einsum("kn,knh->kh", self.modal[curves], points.amplitude)
        answer = np.empty((len(curves), 2 * vibration.shape[1] + 1))
        answer[:, 0] = np.einsum("km,km->k", self.mean[curves], points.deviation_mean)
        answer[:, 1::2], answer[:, 2::2] = vibration.real, -vibration.imag
        return answer

    def amplitudes(self, curves: IndexArray, points: CurvePoints) -> FloatArray:
        """(k,) m, 0-to-peak, of points of some curves (k,)."""
        return periodic_amplitude(self.coefficients(curves, points))
