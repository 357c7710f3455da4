"""A curve with a fixed number of harmonics that has more where its equations lack a motion that exists.

Contact that opens for a small part of the period excites many harmonics. With few of them the branch may end or lose
itself where the structure has a periodic motion, to which a time integration settles. The curve then goes on from this
motion with as many harmonics as give it, and returns to its own number at the first point that this number confirms.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.neglected import plane_across, resized_plane
from stickslip.solve.harmonic.varying_harmonics import BranchEvent, RememberedHarmonics, VaryingCurve, VaryingPoint
from stickslip.solve.path.arc_length import Tangent
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.corrector import Known
from stickslip.solve.path.landmarks import LandmarkSource
from stickslip.solve.path.newton import Newton
from stickslip.solve.path.stepping import BranchPoint, ContinuationSettings, Revision
from stickslip.solve.setting_up import CurveBalances
from stickslip.solve.settled_motion import enough_samples

# chosen: the own number of harmonics is tried at every so many points, twice as many after each motion that begins a
# piece with more: else a curve that lacks many motions would return and be lost without end.
FIRST_WAIT = 4
# chosen: the own number confirms a motion if it changes the relative displacements by no more than this fraction, and
# is tried where its neglected harmonics are no larger.
SAME = 0.05


@dataclass(frozen=True)
class LentNumbers:
    """The harmonics of points (n,), some with more than the curve, which was asked for ``own`` ones and ``samples``.

    ``balance_of`` gives the balance of the points with a number of harmonics.
    """

    of_points: NDArray[np.int64]
    own: int
    samples: int
    balance_of: Callable[[int], Balance]


class LentHarmonics:
    """Follows branches with the harmonics of their start, and returns to those of the curve.

    Parameters
    ----------
    newton:
        solves the curve with its own number of harmonics.
    curve:
        that curve; its work counts.
    balances:
        those of the curve.
    """

    def __init__(self, newton: Newton[BalancePoint], curve: FrequencyCurve, balances: CurveBalances) -> None:
        self._own_newton, self._own, self._work = newton, curve.balance.harmonics, curve.work
        self._balances = balances
        self._varying = VaryingCurve(self._balance_of, self._own, curve.work)
        self.newton = Newton[VaryingPoint](self._varying, newton.settings, newton.on_iteration)
        self._remembered = RememberedHarmonics(self._varying.use)
        self._begun: BalancePoint | None = None
        self._wait, self._since = FIRST_WAIT, 0

    def follow(
        self,
        start: BalancePoint,
        stop: float,
        settings: ContinuationSettings,
        on_event: Callable[[BranchEvent], None],
        landmarks: LandmarkSource[BalancePoint],
        known: Known[BalancePoint] | None = None,
    ) -> Branch[BalancePoint]:
        """The branch from ``start`` to ``stop`` (rad/s); with its own number, ``known`` as in :class:`Branch`."""
        if harmonics_of(start) == self._own:
            plain = Branch(self._own_newton, start, stop, settings, on_event, landmarks, work=self._work, known=known)
            plain.follow()
            return plain
        if self._begun is not None and start is not self._begun:
            self._wait *= 2
        self._begun, self._since = start, 0
        listen = self._remembered.begin(harmonics_of(start), on_event)
        lifted = self._varying.lifted(start)
        cost = (2 * harmonics_of(start) + 1) / (2 * self._own + 1)
        branch = Branch(
            self.newton, lifted, stop, settings, listen, landmarks, revise=self._revised, work=self._work, cost=cost
        )  # fmt: skip
        branch.follow()
        return cast("Branch[BalancePoint]", branch)  # it is only read from here on

    def has_more(self, points: Sequence[BranchPoint[BalancePoint]]) -> bool:
        """Whether some point has more harmonics than the curve."""
        return any(harmonics_of(each.point) != self._own for each in points)

    def lifted(self, points: Sequence[BranchPoint[BalancePoint]]) -> list[BranchPoint[VaryingPoint]]:
        """All points, and their tangents, as those of one problem with different numbers of harmonics."""
        rows = self._varying.rows

        def wide(tangent: Tangent | None) -> Tangent | None:
            if tangent is None:
                return None
            unknowns, measured = with_rows(tangent.unknowns, rows), with_rows(tangent.measured, rows - 1)
            return replace(tangent, unknowns=unknowns, measured=measured)

        return [BranchPoint(self._varying.lifted(each.point), each.iterations, wide(each.tangent)) for each in points]

    def begin(self, point: BalancePoint) -> None:
        """A new point, beside a known one, has its harmonics."""
        self._varying.use(harmonics_of(point))

    def widest(self, points: Sequence[BranchPoint[VaryingPoint]]) -> Balance:
        """The balance with most harmonics of some points."""
        return self._balance_of(max(harmonics_of(each.point) for each in points))

    def numbers(self, points: Sequence[BranchPoint[VaryingPoint]]) -> LentNumbers:
        """The harmonics of points."""
        of_points = np.array([harmonics_of(each.point) for each in points])
        return LentNumbers(of_points, self._own, self._balances.samples, self._balance_of)

    def warning(self, points: Sequence[BranchPoint[VaryingPoint]]) -> str:
        """Where the curve has more harmonics, and why."""
        numbers = np.array([harmonics_of(each.point) for each in points])
        hertz = np.array([each.point.trial.omega for each in points]) / (2.0 * np.pi)
        there = numbers != self._own
        most, least = numbers[there].max(), numbers[there].min()
        number = f"{most}" if most == least else f"{least} to {most}"
        return (
            f"From {hertz[there].min():.3f} to {hertz[there].max():.3f} Hz {there.sum()} of {len(points)} points have "
            f"{number} harmonics instead of {self._own}: where the part begins, a time integration settles on a "
            f"periodic motion that the equations of {self._own} harmonics do not have. Points "
            f"beside this range may lack harmonics too: compare with harmonics = {most}, or with an "
            "accuracy."
        )

    def _balance_of(self, harmonics: int) -> Balance:
        """The balance with a number of harmonics, and samples that resolve them."""
        samples = self._balances.samples
        return self._balances.with_harmonics(
            harmonics, samples if harmonics == self._own else enough_samples(harmonics, samples)
        )

    def _revised(self, point: VaryingPoint, along: Tangent) -> Revision[VaryingPoint]:
        """The point with the own number of harmonics if that confirms it."""
        self._since += 1
        if point.harmonics == self._own or self._since % self._wait or self._neglected(point) > SAME:
            return Revision(point)
        own = self._varying.with_harmonics(point.harmonics).balance
        wide = resized_plane(plane_across(point.trial, own, along), self._varying.rows)
        self._varying.use(self._own)
        correction = self.newton.correct(self._varying.evaluate(point.unknowns, point.parameters), wide)
        change = _norm(correction.point.unknowns[1:] - point.unknowns[1:])
        if correction.converged and change <= SAME * _norm(point.unknowns[1:]):
            return Revision(correction.point, self._varying.linearised(correction.point, wide))
        self._varying.use(point.harmonics)
        return Revision(point)

    def _neglected(self, point: VaryingPoint) -> float:
        """The fraction of the relative displacements in harmonics above the own ones."""
        return _norm(point.unknowns[2 * self._own + 1 :]) / max(_norm(point.unknowns[1:]), 1e-300)


def harmonics_of(point: BalancePoint) -> int:
    """The number of harmonics of a point."""
    return len(point.trial.amplitude) // 2


def _norm(coefficients: FloatArray) -> float:
    return float(np.linalg.norm(coefficients))
