"""The natural frequencies that the forces of many curves excite: no step crosses one without a point on it.

See :mod:`stickslip.solve.path.landmarks` for one curve; here with a leading axis of curves.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.harmonic_modes import IndexArray
from stickslip.solve.harmonic.resonances import Resonances
from stickslip.solve.path.landmarks import OF_WIDTH, ON_IT, REACH, Landmark


class ManyResonances:
    """Circular frequencies and half-power widths of B curves, rad/s, in columns; NaN where a curve has fewer.

    The first columns are those of both linear limits, the others those of the tangent structure, once the same rows
    move at two successive points of a curve.
    """

    def __init__(self, curves: Sequence[Resonances], rows: int) -> None:
        self._curves = list(curves)
        self._limits = _columns([each.seen for each in curves])
        self._tangent = np.full((2, len(curves), 0), np.nan)
        self._moving = np.zeros((len(curves), rows), dtype=bool)

    def take(self, chosen: IndexArray) -> None:
        """Go on with some curves alone."""
        self._curves = [self._curves[each] for each in chosen]
        self._limits, self._tangent = self._limits[:, chosen], self._tangent[:, chosen]
        self._moving = self._moving[chosen]

    def reach(self, chosen: IndexArray, moves: BoolArray) -> None:
        """Some curves have new points, at which rows (S, m) move."""
        is_same = (moves == self._moving[chosen]).all(axis=1) & moves.any(axis=1)
        self._moving[chosen] = moves
        self._tangent[:, chosen[~is_same]] = np.nan
        for curve, rows in zip(chosen[is_same], moves[is_same], strict=True):
            own = _columns([self._curves[curve].of_moving(rows)])[:, 0]
            missing = own.shape[1] - self._tangent.shape[2]
            if missing > 0:
                more = np.full((*self._tangent.shape[:2], missing), np.nan)
                self._tangent = np.concatenate([self._tangent, more], axis=2)
            self._tangent[:, curve] = np.nan
            self._tangent[:, curve, : own.shape[1]] = own

    def first_crossed(self, chosen: IndexArray, start: FloatArray, change: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(S,) frequencies and widths of the first narrow resonance that steps from ``start`` (S,) by ``change``
        cross; NaN for none."""
        values, widths = self._of(chosen)
        ahead = (values - start[:, None]) * np.where(change > 0.0, 1.0, -1.0)[:, None]
        length = np.abs(change)[:, None]
        crossed = (ON_IT * widths < ahead) & (ahead <= length) & (length > OF_WIDTH * widths)
        if not crossed.size:
            return np.full(len(chosen), np.nan), np.full(len(chosen), np.nan)
        first = np.where(crossed, ahead, np.inf).argmin(axis=1)
        rows = np.arange(len(chosen))
        none = ~crossed[rows, first]
        return np.where(none, np.nan, values[rows, first]), np.where(none, np.nan, widths[rows, first])

    def is_long_near(self, chosen: IndexArray, start: FloatArray, end: FloatArray) -> BoolArray:
        """(S,) whether a step comes near a resonance and is long compared with its width."""
        values, widths = self._of(chosen)
        low, high = np.minimum(start, end)[:, None], np.maximum(start, end)[:, None]
        near = (low - REACH * widths <= values) & (values <= high + REACH * widths)
        return np.asarray((near & (high - low > OF_WIDTH * widths)).any(axis=1))

    def _of(self, chosen: IndexArray) -> FloatArray:
        return np.concatenate([self._limits[:, chosen], self._tangent[:, chosen]], axis=2)


def _columns(landmarks: Sequence[Sequence[Landmark]]) -> FloatArray:
    """(2, B, L) values and widths."""
    answer = np.full((2, len(landmarks), max(map(len, landmarks), default=0)), np.nan)
    for curve, own in enumerate(landmarks):
        for place, each in enumerate(own):
            answer[:, curve, place] = each.value, each.width
    return answer
