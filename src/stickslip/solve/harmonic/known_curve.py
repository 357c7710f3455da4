"""Whether a solution is on a computed curve: a comparison that also works at folds and between points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.path.newton import Newton
from stickslip.solve.path.problem import Plane

# chosen: the curve is searched along chords that a solution projects onto, up to this fraction beyond their ends, and
# from which it is no farther than their length: an arc that turns by 45 degrees rises by a tenth of its chord.
BEYOND_CHORD, FROM_CHORD = 0.5, 1.0


class KnownCurve:
    """The points of a curve within a frequency ``width`` in rad/s; ``newton`` solves its problem."""

    def __init__(self, newton: Newton[BalancePoint], points: Sequence[BalancePoint], width: float) -> None:
        self._newton, self._points, self._width = newton, points, width
        motion = np.array([self._flat(point.unknowns) for point in points])
        self._scale = float(np.linalg.norm(motion, axis=1).max()) or 1.0
        self._places = np.column_stack([motion / self._scale, self._omega / width])

    @property
    def _omega(self) -> FloatArray:
        return np.array([point.trial.omega for point in self._points])

    def _flat(self, unknowns: FloatArray) -> FloatArray:
        """The unknowns that some force depends on, as one row."""
        return self._newton.problem.determined(unknowns).ravel()

    def passes(self, solution: BalancePoint, allowed: float) -> bool:
        """Whether the curve passes within ``allowed`` of a solution, relative to its size.

        Newton's method finds the point of the curve in the plane through the solution across a chord near it.
        """
        place = np.append(self._flat(solution.unknowns) / self._scale, solution.trial.omega / self._width)
        chords, away = np.diff(self._places, axis=0), place - self._places[:-1]
        squares = np.maximum((chords**2).sum(axis=1), np.finfo(float).tiny)
        shares = (away * chords).sum(axis=1) / squares
        distances = ((away - shares[:, None] * chords) ** 2).sum(axis=1)
        near = (np.abs(shares - 0.5) <= 0.5 + BEYOND_CHORD) & (distances <= FROM_CHORD**2 * squares)
        return any(self._meets(int(k), float(shares[k]), solution, allowed) for k in np.flatnonzero(near))

    def _meets(self, number: int, share: float, solution: BalancePoint, allowed: float) -> bool:
        """Whether the curve beside a chord goes through a solution."""
        before, after = self._points[number], self._points[number + 1]
        chord, rise = after.unknowns - before.unknowns, after.parameters - before.parameters
        weights = self._newton.problem.determined(chord) / self._scale**2
        plane = Plane(weights, float(rise[0]) / self._width**2, solution.unknowns, solution.trial.omega)
        guess = self._newton.problem.evaluate(before.unknowns + share * chord, before.parameters + share * rise)
        correction = self._newton.correct(guess, plane)
        if not correction.converged:
            return False
        reached, own = self._flat(correction.point.unknowns), self._flat(solution.unknowns)
        size = float(np.linalg.norm(own)) or 1.0
        apart = abs(correction.point.trial.omega - solution.trial.omega) / self._width
        return max(float(np.linalg.norm(reached - own)) / size, apart) <= allowed
