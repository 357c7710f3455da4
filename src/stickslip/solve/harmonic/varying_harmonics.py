"""A frequency curve whose points have as many harmonics as an accuracy requires.

The curve is followed in pieces of one number of harmonics. Each new point has an estimate of its error
(:mod:`stickslip.solve.harmonic.neglected`). Where it is above the accuracy the point is solved again with more
harmonics, from the linearised correction, and the path continues from there; where it is far below, with fewer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.core.fourier import with_rows
from stickslip.core.resolution import SAMPLES_PER_HARMONIC
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.harmonic.neglected import (
    CurveAccuracy,
    Neglected,
    more_harmonics,
    neglected,
    plane_across,
    resized_plane,
)
from stickslip.solve.path.arc_length import Tangent, chord_between
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.landmarks import LandmarkSource
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Linearised, Plane, Step
from stickslip.solve.path.stepping import Accepted, BranchPoint, ContinuationSettings, Corner, Retreat, Revision
from stickslip.solve.path.work import Work

BranchEvent = Accepted[Any] | Retreat | Corner

# chosen: the numbers of harmonics, odd ones, because motions are often nearly half-wave symmetric, where even harmonics
# are small.
LADDER = (1, 3, 5, 7, 9, 11, 13, 15, 19, 23, 29, 37, 47)
LEAST_HARMONICS = 3
# The error that is expected with fewer harmonics, over the accuracy. chosen: far enough below 1 that the number does
# not change back at the next points.
AIM_OF_FEWER = 0.5
# A smaller estimate, over the accuracy, counts as this: harmonics above those of the estimate can be as large (a true
# error of 0.11 of the accuracy where the estimate was 0.05, in the default two-blade case).
LEAST_ESTIMATE = 0.1
# chosen: more harmonics than the first number only if a system with twice as many, that of the estimate, has no more
# rows than the second (110 pairs that all separate, 286 coordinates: 9 harmonics). With 26,600 rows (23 harmonics) a
# step of the estimate takes seconds, and the error falls slowly: 2.8 % with 7 harmonics, 1.3 % with 15, 0.3 % with 23.
ALWAYS_HARMONICS, MOST_ROWS = 7, 12_000
# chosen: where the last estimate is below a fraction of the accuracy so many next points have none at first, and then
# the larger one of their neighbours, unless this is above the accuracy.
CALM = ((0.15, 8), (0.2, 4), (0.5, 2), (0.8, 1))


@dataclass(frozen=True)
class VaryingPoint(BalancePoint):
    """A point whose arrays have as many rows as those of the point with most harmonics so far; its trial has its own.

    ``neglected`` is the estimated error by neglected harmonics, None before it is estimated.
    """

    curve: VaryingCurve
    neglected: float | None = None

    @property
    def harmonics(self) -> int:
        """The number of harmonics of the point."""
        return len(self.trial.amplitude) // 2

    @property
    def unknowns(self) -> FloatArray:
        return with_rows(self.trial.relative, self.curve.rows)

    @property
    def residual(self) -> FloatArray:
        return with_rows(self.trial.residual, self.curve.rows)

    @property
    def measured(self) -> FloatArray:
        return with_rows(self.trial.amplitude, self.curve.rows - 1)


class _Linearised:
    """The equations of the harmonics of a point; the others stay zero."""

    def __init__(self, system: Linearised, rows: int, curve: VaryingCurve) -> None:
        self._system, self._rows, self._curve = system, rows, curve

    def solve(self, residual: FloatArray, conditions: FloatArray, plane: float, tolerance: float) -> Step:
        step = self._system.solve(with_rows(residual, self._rows), conditions, plane, tolerance)
        return replace(step, unknowns=with_rows(step.unknowns, self._curve.rows))


class VaryingCurve:
    """:class:`FrequencyCurve` as a problem with a number of harmonics that may change from point to point.

    ``use`` sets that of the points that follow; ``work`` counts.
    """

    def __init__(self, balance_of: Callable[[int], Balance], harmonics: int, work: Work | None = None) -> None:
        self._balance_of = balance_of
        self._curves: dict[int, FrequencyCurve] = {}
        self.last_factor = LastFactor()  # of all numbers of harmonics
        self.work = work or Work()
        self.harmonics = self.widest = harmonics

    def use(self, harmonics: int) -> None:
        """Points that follow have this number of harmonics."""
        self.harmonics, self.widest = harmonics, max(self.widest, harmonics)

    @property
    def rows(self) -> int:
        """Number of coefficients of a point with most harmonics so far."""
        return 2 * self.widest + 1

    def with_harmonics(self, harmonics: int) -> FrequencyCurve:
        """The curve with a fixed number of harmonics."""
        if harmonics not in self._curves:
            balance = self._balance_of(harmonics)
            self._curves[harmonics] = FrequencyCurve(balance, last=self.last_factor, work=self.work)
        return self._curves[harmonics]

    def lifted(self, point: BalancePoint) -> VaryingPoint:
        """A point of the curve with a fixed number of harmonics."""
        return VaryingPoint(point.trial, point.parameters, point.conditions, point.error, self)

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray) -> VaryingPoint:
        fixed = self.with_harmonics(self.harmonics)
        return self.lifted(fixed.evaluate(with_rows(unknowns, 2 * self.harmonics + 1), parameters))

    def linearised(self, point: VaryingPoint, plane: Plane | None) -> _Linearised:
        rows = 2 * point.harmonics + 1
        system = self.with_harmonics(point.harmonics).linearised(point, plane and resized_plane(plane, rows))
        return _Linearised(system, rows, self)

    def measured_change(self, point: VaryingPoint, step: Step) -> FloatArray:
        return with_rows(self.with_harmonics(point.harmonics).measured_change(point, step), self.rows - 1)

    def determined(self, unknowns: FloatArray) -> FloatArray:
        return self.with_harmonics(self.harmonics).determined(unknowns)

    def named(self, parameter: float) -> str:
        return self.with_harmonics(self.harmonics).named(parameter)


class RememberedHarmonics:
    """A branch that returns to one of its points continues with the harmonics of this point.

    ``use`` sets the number of the points that follow.
    """

    def __init__(self, use: Callable[[int], None]) -> None:
        self._use = use
        self._accepted: list[int] = []

    def begin(self, harmonics: int, on_event: Callable[[BranchEvent], None]) -> Callable[[BranchEvent], None]:
        """A new branch begins with a number of harmonics; the listener for its events, which passes them on."""
        self._accepted.clear()
        self._use(harmonics)

        def listen(event: BranchEvent) -> None:
            if isinstance(event, Accepted):
                self._accepted.append(event.point.harmonics)
            elif isinstance(event, Retreat):
                del self._accepted[event.count :]
                self._use(self._accepted[-1])
            on_event(event)

        return listen


class HarmonicsByAccuracy:
    """Chooses the harmonics of the points of a curve, so that their estimated error is below ``accuracy``.

    Parameters
    ----------
    balance_of:
        the balance with a number of harmonics.
    accuracy:
        largest error, relative (:mod:`stickslip.solve.harmonic.neglected`).
    least:
        smallest number of harmonics, such as that of the excitation.
    samples:
        samples of a period.
    damped:
        see :func:`stickslip.solve.harmonic.neglected.more_harmonics`.
    work:
        that of the whole curve.
    """

    def __init__(
        self,
        balance_of: Callable[[int], Balance],
        accuracy: float,
        least: int,
        samples: int,
        settings: NewtonSettings,
        on_iteration: Callable[[int, float], None],
        damped: int | None = None,
        work: Work | None = None,
    ) -> None:
        self._accuracy, self._samples, self._damped = accuracy, samples, damped
        first = max(least, LEAST_HARMONICS)
        most = samples // SAMPLES_PER_HARMONIC
        self._ladder = sorted({first, *(each for each in LADDER if first < each <= most)})
        self._remembered = RememberedHarmonics(self._use)
        self._skip = 0  # points that have no estimate at first
        self._limited = False  # whether the limit of the work, and not that of the samples, stopped at some point
        self.curve = VaryingCurve(balance_of, first, work)
        self.newton = Newton[VaryingPoint](self.curve, settings, on_iteration)

    def widest(self, points: Sequence[VaryingPoint]) -> Balance:
        """The balance with most harmonics of some points; a point with more may have been removed from the curve."""
        return self.curve.with_harmonics(max(each.harmonics for each in points)).balance

    def follow(
        self,
        start: BalancePoint,
        stop: float,
        settings: ContinuationSettings,
        on_event: Callable[[BranchEvent], None],
        landmarks: LandmarkSource[BalancePoint],
    ) -> Branch[VaryingPoint]:
        """The branch from ``start`` to ``stop`` (rad/s), with estimated errors of all points."""
        lifted = self.curve.lifted(start)
        listen = self._remembered.begin(lifted.harmonics, on_event)
        at_one_frequency = Tangent(np.zeros_like(lifted.unknowns), np.zeros_like(lifted.measured), np.ones(1))
        first = self.revised(lifted, at_one_frequency)
        work = self.curve.work
        branch = Branch(self.newton, first.point, stop, settings, listen, landmarks, revise=self.revised, work=work)
        self._complete(branch.follow())
        self.end()
        return branch

    def begin(self, point: VaryingPoint) -> None:
        """A new point, beside a known one, has its harmonics at first, and an estimate of its own."""
        self._use(point.harmonics)
        self._skip = 0

    def end(self) -> None:
        """Points that follow have the most harmonics of all points."""
        self.curve.use(self.curve.widest)

    def reached(self, points: Sequence[VaryingPoint]) -> CurveAccuracy:
        """Harmonics and errors of points that :meth:`follow` found."""
        errors = [np.inf if each.neglected is None else each.neglected for each in points]
        harmonics = np.array([each.harmonics for each in points])
        return CurveAccuracy(self._accuracy, harmonics, np.array(errors), errors[_highest(points)], self._limited)

    def revised(self, point: VaryingPoint, along: Tangent) -> Revision[VaryingPoint]:
        """The point with its estimated error and with as many harmonics as it requires; ``along`` is the direction of
        the curve."""
        if not point.trial.contact.moves.any():
            # Linear: harmonics that no force excites are zero.
            self._use(self._ladder[0])
            self._skip = 0
            return Revision(replace(point, neglected=0.0))
        if self._skip:
            self._skip -= 1
            return Revision(point)
        revision = self._resolved(point, along)
        share = (revision.point.neglected or 0.0) / self._accuracy
        self._skip = next((count for limit, count in CALM if share < limit), 0)
        return revision

    def _complete(self, points: list[BranchPoint[VaryingPoint]]) -> None:
        """Give an estimate to all points of a curve, one of its own to the highest point."""
        top, last = _highest([each.point for each in points]), len(points) - 1
        for index, each in enumerate(points):
            point, beside = each.point, self._beside(points, index)
            if index != top and point.neglected is None and beside is not None:
                points[index] = replace(each, point=replace(point, neglected=beside))
            elif index == top or point.neglected is None:
                self.begin(point)
                sides = (points[min(max(i, 0), last)].point for i in (index - 1, index + 1))
                revision = self.revised(point, chord_between(*sides))
                points[index] = replace(each, point=revision.point)

    def _beside(self, points: Sequence[BranchPoint[VaryingPoint]], index: int) -> float | None:
        """The larger estimate of the nearest points with one on both sides; None where it is no bound: if it is above
        the accuracy, or if one of them required more harmonics."""
        sides = (points[:index][::-1], points[index + 1 :])
        nearest = [next((each.point for each in side if each.point.neglected is not None), None) for side in sides]
        errors = [each.neglected for each in nearest if each and each.harmonics <= points[index].point.harmonics]
        known = [error for error in errors if error is not None and error <= self._accuracy]
        return max(known) if len(known) == len(sides) else None

    def _use(self, harmonics: int) -> None:
        if harmonics != self.curve.harmonics:
            self.curve.use(harmonics)
            self._skip = 0

    def _fine(self, point: VaryingPoint) -> Balance:
        return self.curve.with_harmonics(more_harmonics(point.harmonics, self._samples, self._damped)).balance

    def _own(self, point: VaryingPoint) -> Balance:
        return self.curve.with_harmonics(point.harmonics).balance

    def _estimate(self, point: VaryingPoint, along: Tangent) -> Neglected:
        fine = self._fine(point)
        self.curve.work.iterate(2 * fine.harmonics + 1)
        return neglected(point.trial, self._own(point), fine, along, self.curve.last_factor)

    def _resolved(self, point: VaryingPoint, along: Tangent) -> Revision[VaryingPoint]:
        """The point with an estimate, and again with more or fewer harmonics until that fits."""
        estimate, system = self._estimate(point, along), None
        plane = plane_across(point.trial, self._own(point), along)
        while estimate.error > self._accuracy:
            more = self._more(point)
            solved = None if more is None else self._solved(point, plane, estimate, more)
            if solved is None:
                break
            point, system = solved
            estimate = self._estimate(point, along)
        fewer = self._fewer(point, estimate)
        if system is None and fewer < point.harmonics:
            solved = self._solved(point, plane, estimate, fewer)
            after = solved and self._estimate(solved[0], along)
            if solved and after and after.error <= self._accuracy:
                (point, system), estimate = solved, after
            else:
                self._use(point.harmonics)
        return Revision(replace(point, neglected=max(estimate.error, LEAST_ESTIMATE * self._accuracy)), system)

    def _solved(
        self, point: VaryingPoint, plane: Plane, estimate: Neglected, harmonics: int
    ) -> tuple[VaryingPoint, Linearised] | None:
        """The point on the plane with another number of harmonics, and its equations; None where Newton fails."""
        before, widest = self.curve.harmonics, self.curve.widest
        self._use(harmonics)
        wide, rows = resized_plane(plane, self.curve.rows), self.curve.rows
        starts = [(point.unknowns, point.parameters)]
        if harmonics > point.harmonics and estimate.step is not None:
            corrected = point.unknowns + with_rows(estimate.step.unknowns, rows)
            starts.insert(0, (corrected, point.parameters + estimate.step.parameters))
        for start in starts:
            correction = self.newton.correct(self.curve.evaluate(*start), wide)
            if correction.converged:
                return correction.point, self.curve.linearised(correction.point, wide)
        self._use(before)
        self.curve.widest = widest  # the directions of the path have no more rows
        return None

    def _more(self, point: VaryingPoint) -> int | None:
        """The next larger number: an estimate with few harmonics predicts large numbers poorly.

        None if the samples, or the limit of the work, do not allow one.
        """
        more = next((each for each in self._ladder if each > point.harmonics), None)
        if more is None or more <= ALWAYS_HARMONICS:
            return more
        rows = int(point.trial.contact.moves.sum()) * (4 * more + 1)
        if rows <= MOST_ROWS:
            return more
        self._limited = True
        return None

    def _fewer(self, point: VaryingPoint, estimate: Neglected) -> int:
        """The fewest harmonics for which the error, in proportion to the neglected motion, is low."""
        whole = max(estimate.tail(point.trial.relative, point.harmonics), 1e-300)
        for harmonics in self._ladder:
            share = estimate.tail(point.trial.relative, harmonics) / whole
            if harmonics >= point.harmonics or estimate.error * share <= AIM_OF_FEWER * self._accuracy:
                return harmonics
        return point.harmonics


def _highest(points: Sequence[VaryingPoint]) -> int:
    """The point with the largest motion."""
    return int(np.argmax([np.linalg.norm(each.trial.amplitude) for each in points]))
