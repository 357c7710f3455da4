"""The points of a curve as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from stickslip.contact.law.law import CodeArray
from stickslip.core.validation import FloatArray
from stickslip.solve.batch.equations import StackedTrial
from stickslip.solve.harmonic.gain import ComplexArray
from stickslip.solve.harmonic.harmonic_modes import IndexArray


@dataclass(frozen=True)
class CurvePoints:
    """The points of one curve in their order.

    ``omega`` (k,) rad/s, ``relative`` (k, m, W) m, ``deviation_mean`` (k, m) N, ``amplitude`` (k, n, H),
    ``contact_state`` (k, P), ``error`` (k,).
    """

    omega: FloatArray
    relative: FloatArray
    deviation_mean: FloatArray
    amplitude: ComplexArray
    contact_state: CodeArray
    error: FloatArray

    def with_points(self, places: IndexArray, others: CurvePoints) -> CurvePoints:
        """With ``others`` inserted before ``places``."""
        names = [item.name for item in fields(self)]
        return CurvePoints(*(np.insert(getattr(self, n), places, getattr(others, n), axis=0) for n in names))

    def put(self, place: int, others: CurvePoints, which: int) -> None:
        """Replace a point by one of ``others``."""
        for item in fields(self):
            getattr(self, item.name)[place] = getattr(others, item.name)[which]

    @classmethod
    def of(cls, trial: StackedTrial, chosen: IndexArray) -> CurvePoints:
        """The trials of some curves, one point of each."""
        states = trial.contact.state.reshape(len(trial.omega), -1)
        return cls(
            trial.omega[chosen], trial.relative[chosen], trial.deviation[chosen, :, 0], trial.amplitude[chosen],
            states[chosen], trial.error[chosen],
        )  # fmt: skip

    @classmethod
    def joined(cls, parts: Sequence[CurvePoints]) -> CurvePoints:
        """All points of some parts."""
        return cls(*(np.concatenate([getattr(each, item.name) for each in parts]) for item in fields(cls)))

    def take(self, chosen: IndexArray) -> CurvePoints:
        """Some of the points."""
        return CurvePoints(*(getattr(self, item.name)[chosen] for item in fields(self)))
