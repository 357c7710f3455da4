"""Points at maxima of outputs that lie between two points of a frequency curve.

The vibration of the whole structure measures the steps of a curve (:mod:`stickslip.solve.path.continuation`). The
amplitude of an output that moves little may therefore have a flat maximum within a step, without a resonance there. The
motion within a step is here the cubic through both points with the tangents of the curve (Hermite interpolation over
the length of the step). What has no tangent is linear: the mean, and the part of an output at a contact that the modal
amplitudes of a large joint lack (:mod:`stickslip.solve.harmonic.kept_modes`). Where the amplitude of an output on this
cubic exceeds both points, the curve gets a point, a solution of the equations like all others, and both parts of the
step are looked at again.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.solve.harmonic.curves import BalancePointT
from stickslip.solve.harmonic.energy import CHUNK
from stickslip.solve.harmonic.missed_peaks import HIGHER, VISIBLE, MissedPeak, highest_of, in_hz
from stickslip.solve.harmonic.overtones import overtone_places
from stickslip.solve.path.arc_length import Metric, Tangent, chord_between
from stickslip.solve.path.corrector import SMALLEST_MOTION, Corrector
from stickslip.solve.path.newton import Newton
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import BranchPoint, ContinuationSettings, Effort, Revision
from stickslip.solve.path.work import Work
from stickslip.solve.setting_up import CurveBalances

# chosen: fractions of a step at which the cubic is evaluated. The top of a parabola with equal ends is at one of them;
# between two of them it is higher by at most 1/256 of its rise.
PLACES = np.arange(1, 16) / 16.0
# chosen: how often a step of the curve is divided; once or twice suffices except at corners.
DEPTH = 3
# chosen: a solution farther from the cubic than this fraction of the step is on another part of the curve.
NEAR = 0.5
# A maximum that is higher than both points by as much as a missed peak is looked for where the cubic has half of this
# rise: at a corner, where a pair begins to slip, the curve reaches the crossing of both tangents, and the cubic half of
# that height.
RISE = 1.0 + 0.5 * (HIGHER - 1.0)


class Curve(Protocol[BalancePointT]):
    """A curve with points that may have others between them."""

    points: list[BranchPoint[BalancePointT]]
    breaks: list[int]  # numbers of the points after which it is interrupted


@dataclass(frozen=True)
class AddedMaxima:
    """The number of outputs and of new points, and the places in Hz of expected maxima without a solution near them.

    ``highest`` are the numbers of the points where each output has its largest amplitude, ``missed`` peaks at places
    where a higher harmonic of the contact excites a mode (:mod:`stickslip.solve.harmonic.overtones`).
    """

    outputs: int
    points: int
    failed_hz: tuple[float, ...]
    highest: tuple[int, ...] = ()
    missed: tuple[MissedPeak, ...] = ()

    def words(self) -> str:
        """One sentence."""
        if not self.outputs:
            return "no output is given"
        return (
            f"outputs: {self.outputs}; points added between points of the curve: {self.points}; "
            f"places without a solution: {len(self.failed_hz)}"
        )

    def warnings(self) -> tuple[str, ...]:
        """A warning for missed peaks, and one for places without a solution."""
        return self._missed_warning() + self._failed_warning()

    def _missed_warning(self) -> tuple[str, ...]:
        if not self.missed:
            return ()
        worst, places = highest_of(self.missed), in_hz(each.frequency_hz for each in self.missed)
        return (
            f"The curve stepped over narrow peaks of an output near {places} Hz, where a harmonic of the contact "
            f"excites a natural frequency: at {worst.frequency_hz:.3f} Hz the output has {worst.factor:.3g} times the "
            "amplitude of the curve. Run this part of the range again as a range of its own.",
        )

    def _failed_warning(self) -> tuple[str, ...]:
        if not self.failed_hz:
            return ()
        places = in_hz(self.failed_hz)
        return (
            f"An output may have a maximum near {places} Hz that the curve does not have: its amplitude rises between "
            "two points, and the solver found no point there. Run this part of the range again with a smaller "
            "largest_step.",
        )


def output_rows(outputs: ArrayLike | None, size: int) -> FloatArray:
    """(k, size) rows of outputs, given as one row or several, (0, size) for None. Raises InputError."""
    if outputs is None:
        return np.zeros((0, size))
    rows = finite_array("outputs", outputs)
    if rows.ndim not in (1, 2) or rows.shape[-1] != size:
        raise InputError(
            f"outputs must be the row ({size},) of an output, or rows (n_outputs, {size}), but its shape is "
            f"{rows.shape}.",
            arguments=["outputs"],
        )
    return np.atleast_2d(rows)


@dataclass(frozen=True)
class _Sampled(Generic[BalancePointT]):
    """A point of the curve with the Fourier coefficients (2H+1, k) of the outputs and their amplitudes (k,), m."""

    branch_point: BranchPoint[BalancePointT]
    coefficients: FloatArray
    amplitude: FloatArray

    @property
    def point(self) -> BalancePointT:
        return self.branch_point.point


@dataclass(frozen=True)
class _Cubic:
    """The curve after a point as a cubic over s from 0 to 1, in Bernstein form.

    ``controls`` are the changes from the point to the other three control points, the last one the ``chord`` of the
    step, ``length`` is that of the chord.
    """

    controls: tuple[Tangent, Tangent, Tangent]
    length: float

    def ahead(self, place: float) -> Tangent:
        """The change from the point to s."""
        return _sum(self.controls, bernstein(place)[1:])

    def direction(self, place: float) -> Tangent:
        """The derivative by s."""
        rest = 1.0 - place
        weights = rest**2 - 2.0 * rest * place, 2.0 * rest * place - place**2, place**2
        return _sum(self.controls, [3.0 * each for each in weights])


def bernstein(place: FloatArray | float) -> FloatArray:
    """(..., 4) weights of the control points of a cubic."""
    rest = 1.0 - place
    return np.stack([rest**3, 3.0 * rest**2 * place, 3.0 * rest * place**2, place**3], axis=-1)


def _sum(tangents: Sequence[Tangent], weights: Iterable[float]) -> Tangent:
    first, *others = (each.times(float(weight)) for each, weight in zip(tangents, weights, strict=True))
    return functools.reduce(Tangent.plus, others, first)


def cubic_between(before: BranchPoint[Any], after: BranchPoint[Any], metric: Metric) -> _Cubic | None:
    """The curve between two points; with one tangent a parabola, None without any."""
    chord = chord_between(before.point, after.point)
    length = math.sqrt(metric.product(chord, chord))
    known = [None if each.tangent is None else _along(each.tangent, chord, metric) for each in (before, after)]
    start, end = (None if each is None else each.times(length) for each in known)
    if length == 0.0 or (start is None and end is None):
        return None
    # The tangents of a parabola have the chord as their mean.
    start = start or _mirrored(end, chord)
    end = end or _mirrored(start, chord)
    return _Cubic((start.times(1.0 / 3.0), chord.plus(end.times(-1.0 / 3.0)), chord), length)


def _mirrored(tangent: Tangent | None, chord: Tangent) -> Tangent:
    """The tangent at the other end of a parabola."""
    assert tangent is not None  # at most one of both is unknown
    return chord.times(2.0).plus(tangent.times(-1.0))


def _along(tangent: Tangent, chord: Tangent, metric: Metric) -> Tangent:
    """The unit tangent in the direction of a chord: a part of the curve may have been followed backwards."""
    rows = len(chord.unknowns)  # later points of the curve may have more harmonics
    wide = Tangent(with_rows(tangent.unknowns, rows), with_rows(tangent.measured, rows - 1), tangent.parameters)
    return metric.unit(wide).times(math.copysign(1.0, metric.product(wide, chord)))


class OutputMaxima(Generic[BalancePointT]):
    """Looks for maxima of outputs between the points of a curve.

    Parameters
    ----------
    newton:
        solves the equations of the curve.
    balances:
        those of the curve.
    outputs:
        (k, n) rows of the unknowns of results.
    width:
        rad/s, the range of the curve, which measures the length of a step.
    work:
        that on the whole curve, at whose limit no more points follow.
    begin, revise:
        where points have different numbers of harmonics: ``begin`` sets those of a new point from a known one,
        ``revise`` is that of the branch.
    """

    def __init__(
        self,
        newton: Newton[BalancePointT],
        balances: CurveBalances,
        outputs: FloatArray,
        width: float,
        work: Work,
        begin: Callable[[BalancePointT], None] = lambda point: None,
        revise: Callable[[BalancePointT, Tangent], Revision[BalancePointT]] = lambda point, along: Revision(point),
    ) -> None:
        self._newton, self._balances, self._outputs = newton, balances, outputs
        self._work, self._begin, self._revise = work, begin, revise
        self._balance_of = functools.cache(balances.with_harmonics)
        self._vibration_of = balances.vibration_of(outputs)
        self._corrector = Corrector(newton, width, Effort(ContinuationSettings()))
        self._highest = np.zeros(len(outputs))
        self._failed_hz: list[float] = []
        self._missed: list[MissedPeak] = []

    def add(self, curve: Curve[BalancePointT]) -> AddedMaxima:
        """Add points to a curve."""
        if not len(self._outputs):
            return AddedMaxima(0, 0, ())
        known = [each for points in _of_one_size(curve.points) for each in self._sampled(points)]
        self._highest = np.max([each.amplitude for each in known], axis=0)
        for each in known:
            self._corrector.measure(each.point)  # the largest motion of all is the scale
        points, breaks, amplitudes = curve.points[:1], [], [known[0].amplitude]
        places = overtone_places(self._balances.closed, [each.point for each in known])
        for index, (before, after) in enumerate(itertools.pairwise(known)):
            if index in curve.breaks:
                breaks.append(len(points) - 1)
            else:
                self._look_at(before, after, places.get(index, ()))
                new = self._within(before, after, DEPTH)
                points += [each.branch_point for each in new]
                amplitudes += [each.amplitude for each in new]
            points.append(after.branch_point)
            amplitudes.append(after.amplitude)
        highest = tuple(np.argmax(amplitudes, axis=0).tolist())
        added = AddedMaxima(
            len(self._outputs), len(points) - len(known), tuple(self._failed_hz), highest, tuple(self._missed)
        )
        curve.points, curve.breaks = points, breaks
        return added

    def _look_at(
        self, before: _Sampled[BalancePointT], after: _Sampled[BalancePointT], places: Sequence[float]
    ) -> None:
        """Solve between two points at ``places`` in rad/s, and note the highest one over the cubic, if that is a missed
        peak."""
        metric = self._corrector.measure(after.point)
        cubic = cubic_between(before.branch_point, after.branch_point, metric)
        if cubic is None or not places:
            return
        controls, peaks = self._controls(before, after, cubic), list[MissedPeak]()
        start, end = (float(each.point.trial.omega) for each in (before, after))
        for omega in places:
            if self._work.limit_words:
                break
            self._begin(before.point)
            place = (omega - start) / (end - start)
            ahead = cubic.ahead(place)
            guess = self._newton.problem.evaluate(before.point.unknowns + ahead.unknowns, np.array([omega]))
            correction = self._corrector.correct(guess, Plane.fixed(guess.unknowns, omega))
            if not correction.converged:
                self._failed_hz.append(omega / (2.0 * math.pi))
                continue
            (found,) = self._sampled([BranchPoint(correction.point, 0)])
            smooth = _amplitudes(np.tensordot(bernstein(np.array([place])), controls, axes=1))[0]
            least = np.maximum(smooth, np.maximum(VISIBLE * self._highest, SMALLEST_MOTION))
            factor = float((found.amplitude / least).max())
            if factor > HIGHER:
                peaks.append(MissedPeak(omega / (2.0 * math.pi), factor))
        if peaks:
            self._missed.append(highest_of(peaks))

    def _within(
        self, before: _Sampled[BalancePointT], after: _Sampled[BalancePointT], depth: int
    ) -> list[_Sampled[BalancePointT]]:
        """The new points between two points."""
        metric = self._corrector.measure(after.point)
        cubic = cubic_between(before.branch_point, after.branch_point, metric)
        place = None if cubic is None else self._highest_place(before, after, cubic)
        if cubic is None or place is None:
            return []
        is_allowed = depth > 0 and not self._work.limit_words
        middle = self._solved(before.point, cubic, place, metric) if is_allowed else None
        if middle is None:
            self._failed_hz.append(float(before.point.trial.omega + cubic.ahead(place).parameter) / (2.0 * math.pi))
            return []
        return [*self._within(before, middle, depth - 1), middle, *self._within(middle, after, depth - 1)]

    def _highest_place(
        self, before: _Sampled[BalancePointT], after: _Sampled[BalancePointT], cubic: _Cubic
    ) -> float | None:
        """Where an output exceeds both points most on a cubic; None if no visible one does by RISE.

        The amplitude is a norm, and a cubic remains in the convex hull of its control points: none of its points is
        higher than the highest one of them, so most steps need no more than these.
        """
        controls = self._controls(before, after, cubic)
        lowest = RISE * np.maximum(np.maximum(before.amplitude, after.amplitude), VISIBLE * self._highest)
        if (_amplitudes(controls[1:3]) <= lowest).all():
            return None
        amplitude = _amplitudes(np.tensordot(bernstein(PLACES), controls, axes=1))
        rise = (amplitude / np.maximum(lowest, SMALLEST_MOTION)).max(axis=1)
        return float(PLACES[rise.argmax()]) if rise.max() > 1.0 else None

    def _controls(self, before: _Sampled[BalancePointT], after: _Sampled[BalancePointT], cubic: _Cubic) -> FloatArray:
        """(4, 2H+1, k) coefficients of the outputs at the control points of a cubic."""
        rows = max(len(before.coefficients), len(after.coefficients))
        first, last = (with_rows(each.coefficients, rows) for each in (before, after))
        vibration = self._vibration(np.stack([each.measured for each in cubic.controls]))
        start, end, chord = (with_rows(each, rows) for each in vibration)
        linear = (last - first - chord) / 3.0
        return np.stack([first, first + start + linear, first + end + 2.0 * linear, last])

    def _solved(
        self, before: BalancePointT, cubic: _Cubic, place: float, metric: Metric
    ) -> _Sampled[BalancePointT] | None:
        """The point of the curve near a place of a cubic, in the plane across it; None without one near it."""
        self._begin(before)
        ahead, problem = cubic.ahead(place), self._newton.problem
        guess = problem.evaluate(before.unknowns + ahead.unknowns, before.parameters + ahead.parameters)
        plane = self._corrector.plane(guess, metric.unit(cubic.direction(place)), 0.0)
        correction = self._corrector.correct(guess, plane)
        away = chord_between(guess, correction.point)
        if not correction.converged or metric.product(away, away) > (NEAR * cubic.length) ** 2:
            return None
        system = correction.system or problem.linearised(correction.point, plane)
        tangent = metric.unit(self._corrector.direction_of(correction.point, system, 1.0))
        revision = self._revise(correction.point, tangent)
        if revision.system is not None:
            tangent = metric.unit(self._corrector.direction_of(revision.point, revision.system, 1.0))
        return self._sampled([BranchPoint(revision.point, correction.iterations, tangent)])[0]

    def _sampled(self, points: Sequence[BranchPoint[BalancePointT]]) -> list[_Sampled[BalancePointT]]:
        """The outputs at points with one number of harmonics."""
        trials = [each.point.trial for each in points]
        balance = self._balance_of(len(trials[0].amplitude) // 2)
        motion, _ = self._balances.motion(trials, balance.displacement(trials))
        coefficients = motion @ self._outputs.T
        return [
            _Sampled(point, each, periodic_amplitude(each.T)) for point, each in zip(points, coefficients, strict=True)
        ]

    def _vibration(self, amplitude: FloatArray) -> FloatArray:
        """Coefficients (2, 2H+1, k) of the outputs for changes (2, 2H, n) of the modal amplitudes; no mean."""
        vibration = self._vibration_of(self._balance_of(amplitude.shape[1] // 2), amplitude)
        return np.concatenate([np.zeros_like(vibration[:, :1]), vibration], axis=1)


def _of_one_size(points: Sequence[BranchPoint[BalancePointT]]) -> Iterator[list[BranchPoint[BalancePointT]]]:
    """Successive points with one number of harmonics, at most CHUNK: one product with all modes serves for them."""
    for _, group in itertools.groupby(points, lambda each: len(each.point.trial.amplitude)):
        while chunk := list(itertools.islice(group, CHUNK)):
            yield chunk


def _amplitudes(coefficients: FloatArray) -> FloatArray:
    """(m, k) amplitudes of signals (m, 2H+1, k)."""
    count, rows, outputs = coefficients.shape
    return periodic_amplitude(coefficients.swapaxes(1, 2).reshape(-1, rows)).reshape(count, outputs)
