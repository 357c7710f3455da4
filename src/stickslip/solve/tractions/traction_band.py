"""The range of a frequency curve with the residual tractions of its pairs: extreme tractions and their curves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.friction_law import FrictionLaw
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.peaks import peaks
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.results.traction_band import TractionBand
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curve_warnings import SMALLEST_FOLD
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.harmonic.support import mean_factor
from stickslip.solve.harmonic.traction_sensitivity import Quantity, TractionSensitivity
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.landmarks import LandmarkSource
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.setting_up import Balances, StageReport
from stickslip.solve.tractions.extreme_tractions import (
    PeakOverTractions,
    Selection,
    TractionPeak,
    highest,
    local_extreme,
    lowest,
    with_residual_traction,
)

# chosen: the curves cover the frequencies between points with this fraction of the largest motion, and this multiple of
# that range on both sides; a curve that does not fall to a fraction of its peak at both ends is followed through the
# whole range.
NEAR_PEAK, MARGIN, FALLEN = 0.5, 0.5, 0.7
# The tractions that move a peak most are selected again about the new curve while that promises this fraction more and
# changes a traction by a fraction of the largest limit, at most SELECTIONS times: one was enough on the bench blades.
WORTHWHILE, UNCHANGED, SELECTIONS = 0.01, 0.01, 3
# chosen: a curve of the band ends after this multiple of the points of the whole curve.
MOST_POINTS = 4
# Tractions that give this fraction of the largest linear change replace another curve.
AS_GOOD = 0.95
# chosen: an optimised peak gets a curve if it is farther out by this fraction.
FURTHER = 1e-3
# chosen: random tractions from which the optimisation begins, and their seed: the same model gives the same band.
DEFAULT_STARTS, SEED = 2, 20_241_114
# chosen: iterations of Newton's method in the band after which tractions are no longer optimised, for each point of
# the curve (about 15 curves), and at least so many, which small models do in seconds.
MOST_ITERATIONS, LEAST_WORK = 50, 5_000
RAISED, LOWERED = "peak raised", "peak lowered"
# Tractions are this fraction of the friction limit at most, so that round-off does not exceed it.
WITHIN = 1.0 - 1e-9


def checked_band_output(pairs: ContactPairs, output: ArrayLike, n_unknowns: int) -> FloatArray:
    """The output row of a traction band. Raises InputError if it or the joint does not allow one."""
    row = finite_array("traction_band", output)
    if row.shape != (n_unknowns,) or not row.any():
        raise InputError(
            f"traction_band must be the row ({n_unknowns},) of an output, with an entry that is not zero, but its "
            f"shape is {row.shape}.",
            arguments=["traction_band"],
        )
    if not friction_limit(pairs).any():
        raise InputError(
            "traction_band requires pairs with Coulomb friction under a normal load: no other pair has residual "
            "tractions that the solver can vary. Leave it out.",
            arguments=["traction_band"],
        )
    return row


def friction_limit(pairs: ContactPairs) -> FloatArray:
    """(n_pairs,) N, the largest residual traction of each pair; zero for laws without Coulomb friction."""
    limit = np.zeros(pairs.n_pairs)
    for law, members in zip(pairs.laws, pairs.members, strict=True):
        if isinstance(law, FrictionLaw):
            limit[members] = law.largest_slip_force
    return limit


@dataclass(frozen=True)
class _Traced:
    """A curve with a residual traction: its points, and at each the motion (2H+1, n) and the output amplitude."""

    name: str
    traction: FloatArray
    balance: Balance
    points: Sequence[BalancePoint]
    complete: bool
    motion: FloatArray
    amplitude: FloatArray

    @property
    def omega(self) -> FloatArray:
        return np.array([point.trial.omega for point in self.points])

    def sensitivity(self, index: int) -> TractionSensitivity:
        """The derivatives at a point."""
        before, after = self.points[max(index - 1, 0)], self.points[min(index + 1, len(self.points) - 1)]
        return TractionSensitivity(self.balance, self.points[index], after.unknowns - before.unknowns)

    @property
    def highest_peak(self) -> float:
        """Its amplitude, between the points."""
        return peaks(self.omega, self.amplitude)[0].amplitude

    @property
    def top(self) -> int:
        """The point with the largest amplitude."""
        return int(self.amplitude.argmax())

    def folds(self) -> list[int]:
        """The first and the last point at which the curve turns; none where that is round-off."""
        omega = self.omega
        step = np.diff(omega)
        turns = np.flatnonzero(step[:-1] * step[1:] < 0.0) + 1
        if turns.size < 2 or np.ptp(omega[turns]) < SMALLEST_FOLD * omega.mean():
            return []
        return [int(turns[0]), int(turns[-1])]


class TractionBandSearch:
    """Extreme residual tractions of a finished curve.

    Parameters
    ----------
    balances:
        those of the curve; ``landmarks`` too.
    window:
        (start, stop) of the curve in rad/s.
    output:
        (n,) row, whose peak the tractions raise and lower.
    starts:
        random tractions from which the extremes are optimised, beside zero and those to first order.
    """

    def __init__(
        self,
        balances: Balances,
        harmonics: int,
        landmarks: LandmarkSource[BalancePoint],
        window: tuple[float, float],
        output: FloatArray,
        newton: NewtonSettings,
        continuation: ContinuationSettings,
        report: StageReport,
        starts: int,
    ) -> None:
        pairs = with_residual_traction(balances.pairs, np.zeros((balances.pairs.n_pairs, 2)))
        mean, restraint = mean_factor(balances.superelement, pairs)
        stuck = replace(balances.stuck, pairs=pairs, mean=mean, mean_restraint=restraint)
        self._balances = replace(balances, pairs=pairs, stuck=stuck)
        self._harmonics, self._landmarks, self._window = harmonics, landmarks, window
        self._output, self._newton, self._continuation, self._report = output, newton, continuation, report
        self._limit = WITHIN * friction_limit(pairs)
        self._starts = starts
        self._traced: list[_Traced] = []
        self._extremes_found: dict[str, FloatArray] = {}
        self.warnings: list[str] = []
        self._iterations, self._most_iterations = 0, LEAST_WORK

    def _iterate(self, number: int, error: float) -> None:
        """Count an iteration of Newton's method, and report it."""
        self._iterations += 1
        self._report.iteration(number, error)

    def _is_used_up(self) -> bool:
        """Whether the tractions may not be optimised further."""
        return self._iterations >= self._most_iterations

    def band(self, points: Sequence[BalancePoint]) -> TractionBand | None:
        """The band around the highest peak of a curve with these points; None without a single curve."""
        span = self._span(points)
        most = min(self._continuation.max_points, MOST_POINTS * (len(points) + 1))
        self._continuation = replace(self._continuation, max_points=most)
        self._most_iterations = max(LEAST_WORK, MOST_ITERATIONS * (len(points) + 1))
        still = self._follow("no traction at rest", np.zeros((self._limit.size, 2)), span)
        if still is not None and still.complete:
            raised = self._move_peak(still, RAISED, span, highest)
            lowered = self._move_peak(still, LOWERED, span, lowest)
            for fold in still.folds():
                self._move_fold(still, fold, span)
            self._optimise(still, raised, lowered, span)
        early = [each.name for each in self._traced if not each.complete]
        if early:
            self.warnings.append(
                f"The band of residual tractions is incomplete: {len(early)} of its curves end early "
                f"({', '.join(early)}), so the peak can be outside of it. Tractions are varied only about a complete "
                "curve without traction at rest."
            )
        return _stored_band(self._traced, self._extremes_found) if self._traced else None

    def _span(self, points: Sequence[BalancePoint]) -> tuple[float, float]:
        """Start and stop (rad/s) of the part of the window around the highest peak."""
        omega = np.array([point.trial.omega for point in points])
        size = np.array([np.linalg.norm(point.measured) for point in points])
        near = omega[size >= NEAR_PEAK * size.max()]
        margin = MARGIN * float(np.ptp(near)) or MARGIN * abs(self._window[1] - self._window[0])
        low, high = near.min() - margin, near.max() + margin
        start, stop = (float(np.clip(end, low, high)) for end in self._window)
        return start, stop

    def _follow(self, name: str, traction: FloatArray, span: tuple[float, float]) -> _Traced | None:
        """The curve with a residual traction; None, and a warning, without a first point."""
        self._report.stage(f"band of residual tractions: {name}")
        traced = self._attempt(name, traction, span)
        if traced is not None and span != self._window and not self._covers_peak(traced):
            traced = self._attempt(name, traction, self._window) or traced
        if traced is None:
            self.warnings.append(
                f'The band of residual tractions is incomplete: the solver found no first point with "{name}", so the '
                "peak can be outside of the band."
            )
            return None
        self._traced.append(traced)
        return traced

    def _follow_from(self, name: str, peak: TractionPeak, span: tuple[float, float]) -> None:
        """The curve with a residual traction from its peak to both sides, so that it contains the peak even if the path
        follower loses it."""
        self._report.stage(f"band of residual tractions: {name}")
        balances = replace(self._balances, pairs=with_residual_traction(self._balances.pairs, peak.traction))
        curve = FrequencyCurve(balances.with_harmonics(self._harmonics))
        newton = Newton(curve, self._newton, self._iterate)
        start = peak.peak.probe.point
        sides = [Branch(newton, start, end, self._continuation, landmarks=self._landmarks) for end in span]
        below, above = ([each.point for each in side.follow()] for side in sides)
        complete = all(side.complete for side in sides)
        self._traced.append(self._as_traced(name, peak.traction, curve, [*below[:0:-1], *above], complete))

    def _attempt(self, name: str, traction: FloatArray, span: tuple[float, float]) -> _Traced | None:
        balances = replace(self._balances, pairs=with_residual_traction(self._balances.pairs, traction))
        curve = FrequencyCurve(balances.with_harmonics(self._harmonics))
        newton = Newton(curve, self._newton, self._iterate)
        try:
            start, _ = first_point(newton, curve, span[0], balances.with_harmonics)
        except ConvergenceError:
            return None
        branch = Branch(newton, start, span[1], self._continuation, landmarks=self._landmarks)
        return self._as_traced(name, traction, curve, [each.point for each in branch.follow()], branch.complete)

    def _as_traced(
        self, name: str, traction: FloatArray, curve: FrequencyCurve, points: Sequence[BalancePoint], complete: bool
    ) -> _Traced:
        """A curve with the motion and the amplitude of its points."""
        trials = [point.trial for point in points]
        motion, _ = self._balances.motion(trials, curve.balance.displacement(trials))
        return _Traced(
            name, traction, curve.balance, points, complete, motion, periodic_amplitude(motion @ self._output)
        )

    @staticmethod
    def _covers_peak(traced: _Traced) -> bool:
        """Whether the curve falls at both ends."""
        return bool(traced.amplitude[[0, -1]].max() < FALLEN * traced.amplitude.max())

    def _move_peak(self, still: _Traced, name: str, span: tuple[float, float], select: Selection) -> _Traced:
        """Curves with the tractions that move the peak most to first order; the last of them."""
        traced = still
        for number in range(SELECTIONS):
            top = float(traced.amplitude.max())
            extremes = self._extremes(traced, traced.top)
            if not self._usable(name, extremes):
                return traced
            traction, predicted = select(extremes, traced.traction, self._limit, math.inf)
            same = np.abs(traction - traced.traction).max() <= UNCHANGED * self._limit.max()
            if same or abs(predicted - top) <= WORTHWHILE * top:
                return traced
            following = self._follow(name if number == 0 else f"{name}, selection {number + 1}", traction, span)
            if following is None or not following.complete:
                return traced
            traced = following
        return traced

    def _optimise(self, still: _Traced, raised: _Traced, lowered: _Traced, span: tuple[float, float]) -> None:
        """Curves with the tractions whose peak no small change raises or lowers further, the best of several starts."""
        low, high = min(span), max(span)
        tops = PeakOverTractions(
            self._balances, self._harmonics, self._output, (low, high), self._newton, self._iterate
        )
        still_peak = tops.near(still.traction, still.points[still.top])
        if still_peak is None:
            self.warnings.append(
                "The tractions of the band were not optimised: the search for the peak without traction at rest did "
                "not converge. The band is that of extreme tractions to first order."
            )
            return
        effects = self._extremes(still, still.top)
        starts = [still_peak, *self._random_peaks(tops, still_peak, effects)]
        sides = ((RAISED, raised, highest, max), (LOWERED, lowered, lowest, min))
        for name, traced, select, best_of in sides:
            self._report.stage(f"band of residual tractions: {name}, optimised")
            own = tops.near(traced.traction, traced.points[traced.top]) if traced.traction.any() else None
            extremes = [
                local_extreme(tops, start, select, self._limit, self._is_used_up)
                for start in (*starts, *([own] if own else []))
            ]
            self._extremes_found[name] = np.array([each.amplitude for each in extremes])
            best = best_of(extremes, key=lambda each: each.amplitude)
            reached = best_of(each.highest_peak for each in self._traced if each.complete)
            if best_of(best.amplitude, reached) != reached and abs(best.amplitude - reached) > FURTHER * reached:
                self._follow_from(f"{name}, optimised", best, (low, high))
        self._work_warning()

    def _work_warning(self) -> None:
        if self._is_used_up():
            self.warnings.append(
                f"The tractions of the band were optimised until {self._iterations} iterations of Newton's method "
                f"(limit: {self._most_iterations}), not to their end, so the band can be wider. Fewer traction_starts, "
                "pairs or harmonics need less work."
            )

    def _random_peaks(
        self, tops: PeakOverTractions, still: TractionPeak, effects: Sequence[Quantity]
    ) -> Iterator[TractionPeak]:
        """The peaks of random tractions, of which every other has all pairs at their limits.

        Pairs that stick far below their limits have none (``LEAST_SHARE``).
        """
        random = np.random.default_rng(SEED)
        limit = self._limit * np.any([each.by_traction.any(axis=1) for each in effects], axis=0)
        for number in range(self._starts):
            angle = random.uniform(0.0, 2.0 * np.pi, self._limit.size)
            size = np.sqrt(random.uniform(0.0, 1.0, self._limit.size)) if number % 2 else 1.0
            traction = (limit * size)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
            if self._is_used_up():
                return
            if (there := tops.moved(still, traction)) is not None:
                yield there

    def _extremes(self, traced: _Traced, index: int) -> tuple[Quantity, Quantity]:
        """Those of the output at a point, with their derivatives."""
        of_mean = self._balances.mean_row(traced.points[index].trial, self._output)
        return traced.sensitivity(index).extremes(self._output, of_mean)

    def _move_fold(self, still: _Traced, fold: int, span: tuple[float, float]) -> None:
        """Curves with the tractions that move a fold most, unless earlier curves have tractions that are as good."""
        quantity = still.sensitivity(fold).frequency()
        place = f"fold at {quantity.value:.2f} Hz moved"
        if not self._usable(place, [quantity]):
            return
        for sign, way in ((1.0, "up"), (-1.0, "down")):
            traction = sign * highest([quantity], np.zeros((self._limit.size, 2)), self._limit)[0]
            most = float(np.vdot(quantity.by_traction, traction))
            if any(
                sign * float(np.vdot(quantity.by_traction, each.traction)) >= AS_GOOD * abs(most)
                for each in self._traced
            ):
                continue
            self._follow(f"{place} {way}", traction, span)

    def _usable(self, name: str, quantities: Sequence[Quantity]) -> bool:
        """Whether derivatives are finite; a warning if not."""
        finite = all(np.isfinite(each.by_traction).all() for each in quantities)
        if not finite:
            self.warnings.append(
                f'The band of residual tractions is incomplete: the equations are singular where "{name}" is selected.'
            )
        return finite


def _stored_band(traced: Sequence[_Traced], extremes: Mapping[str, FloatArray]) -> TractionBand:
    """The curves as a result, and the extremes that were reached from each start."""
    return TractionBand(
        tuple(each.name for each in traced),
        np.array([each.complete for each in traced]),
        np.repeat(np.arange(len(traced)), [len(each.points) for each in traced]),
        np.concatenate([each.omega for each in traced]) / (2.0 * np.pi),
        np.ascontiguousarray(np.concatenate([each.motion for each in traced]).transpose(0, 2, 1)),
        np.array([each.traction for each in traced]),
        extremes.get(RAISED),
        extremes.get(LOWERED),
    )
