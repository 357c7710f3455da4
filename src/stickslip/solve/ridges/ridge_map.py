"""All ridges of peaks over a range of a parameter: their starts, their ends, and the highest of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from stickslip.core.errors import ConvergenceError, StickslipError
from stickslip.core.threads import Answer, side_by_side
from stickslip.core.validation import FloatArray
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.peaks import Peak, peaks
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.path.continuation import Branch
from stickslip.solve.ridges import ridge_coverage as cover
from stickslip.solve.ridges.ridge_intervals import Interval, apart, inaccurate_intervals
from stickslip.solve.ridges.ridge_line import Ridge
from stickslip.solve.ridges.ridge_result import ridge_result
from stickslip.solve.ridges.ridge_stage import RidgeStage, StageMaker, Work
from stickslip.solve.ridges.ridge_walk import TOO_MUCH_WORK, Pace, RidgePoint, follow
from stickslip.solve.ridges.stage_chain import StageChain
from stickslip.solve.setting_up import StageReport

# chosen: a peak is followed as long as it has at least this fraction of the highest one: others rarely rise above it
# within the range, and the curve at its other end shows those that do.
LEAST_FRACTION = 0.5
# chosen: an amplitude of a curve that is higher than all ridges by this fraction belongs to none of them; curves are
# 0.1 % above their ridges at most.
ABOVE_RIDGES = 0.01
JOINED = "another ridge continues it"
# chosen: the lower end of the range moves by this factor until the minimum is enclosed.
LOWER_BY = 2.0
# chosen: a ridge is refined where it has more than this fraction of the highest one, on both sides of a switch.
NEAR_HIGHEST = 0.95


class RidgeMap:
    """Ridges over a range of the parameter.

    ``stage_at`` gives the equations at a value, ``named`` a value in words; ``work`` limits the work; ``modes`` are the
    numbers from 0 of the stuck modes whose linear peaks count, None for all. Whole curves go beyond all linear peaks
    and ridges by the factor ``around``, None for the whole range of frequencies. The first equations have the modes of
    an ``earlier`` stage where they are the same.
    """

    def __init__(
        self,
        stage_at: StageMaker,
        bounds: tuple[float, float],
        report: StageReport,
        pace: Pace | None = None,
        named: Callable[[float], str] = "{:.4g}".format,
        work: Work | None = None,
        modes: frozenset[int] | None = None,
        around: float | None = None,
        earlier: RidgeStage | None = None,
    ) -> None:
        self.work = work or Work()
        self._stage_at = StageChain(stage_at, self.work, self._see_stuck, earlier)
        self._modes, self._around = modes, around
        self._bounds, self._passed = bounds, (math.inf, 0.0)
        self._report = report
        self._pace = pace or Pace()
        self._named = named
        self._stuck: dict[float, Peak] = {}
        self._free: dict[float, Peak] = {}
        self._unknown: list[tuple[float, float]] = []
        self.verified: set[float] = set()  # values at which a whole curve has its highest peak on a ridge
        self.ridges: list[Ridge] = []
        self.warnings: list[str] = []
        self.points_of_curves = 0

    def _see_stuck(self, value: float, stage: RidgeStage) -> None:
        """Keep the linear peak at a value."""
        if (stuck := stage.stuck_peaks(self._modes)) and stuck[0].bracketed:
            self._stuck[value] = stuck[0]

    def add_curve(self, value: float) -> None:
        """Compute the whole frequency curve at a value, and follow its peaks that are on no ridge yet."""
        self._report.stage(f"frequency curve at {self._named(value)}")
        stage = self._stage_at(value)
        if (free := stage.free_peaks[0]).bracketed:
            self._free[value] = free
        try:
            # A ridge whose points have different numbers of harmonics has false jumps where their errors are large.
            stage, branch = self.whole_curve(value, self.harmonics_near(value, stage.harmonics))
        except ConvergenceError as error:
            self.warnings.append(f"There is no frequency curve at {self._named(value)}: {error}")
            return
        if not branch.complete:
            self.warnings.append(
                f"The frequency curve at {self._named(value)} is not complete, so that a peak beyond its end may be "
                f"missing. {branch.message}"
            )
        points = [each.point for each in branch.points]
        self.add_peaks(value, points, branch.complete)
        if branch.complete and stage.amplitude(points).max() <= (1.0 + ABOVE_RIDGES) * self.highest_at(value):
            self.verified.add(value)

    def whole_curve(self, value: float, harmonics: int) -> tuple[RidgeStage, Branch[BalancePoint]]:
        """The equations at a value with a number of harmonics, and their frequency curve over :meth:`curve_window`.

        Raises ConvergenceError without a first point, and as the equations themselves."""
        return self.curve_task(value, harmonics, self.work)()

    def curve_task(
        self, value: float, harmonics: int, work: Work
    ) -> Callable[[], tuple[RidgeStage, Branch[BalancePoint]]]:
        """See :meth:`whole_curve`: a task that may run beside other work than that of another curve, with its own count
        of ``work``."""
        stage, window = self._stage_at(value).with_harmonics(harmonics).apart(work), self.curve_window(value)

        def task() -> tuple[RidgeStage, Branch[BalancePoint]]:
            branch = stage.whole_curve(window)
            self.points_of_curves += len(branch.points)
            return stage, branch

        return task

    def add_peaks(self, value: float, points: Sequence[BalancePoint], is_complete: bool) -> None:
        """Follow the peaks of a curve, given by its points, that are on no ridge yet."""
        stage = self._stage_at(value).with_harmonics(len(points[0].unknowns) // 2)
        hertz = np.array([point.trial.omega for point in points]) / (2.0 * math.pi)
        heights = stage.amplitude(points)
        found = peaks(hertz, heights)
        if is_complete and not found[0].bracketed:
            self.warnings.append(
                f"At {self._named(value)} the largest amplitude is at an end of the frequency range, "
                f"{found[0].frequency_hz:.2f} Hz: widen the range."
            )
        tops = [each for each in found if each.bracketed and each.amplitude >= LEAST_FRACTION * found[0].amplitude]
        for top in tops:
            point = points[top.point]
            self.add_from(value, point.unknowns, point.trial.omega)

    def add_stuck(self, value: float) -> None:
        """Follow the peaks near those of the linear stuck structure at a value, where they are also solutions."""
        stage = self._stage_at(value)
        found = stage.stuck_peaks(self._modes)
        for top in found:
            if top.bracketed and top.amplitude >= LEAST_FRACTION * found[0].amplitude:
                omega = 2.0 * math.pi * top.frequency_hz
                self.add_from(value, stage.search.balance.linear(omega), omega)

    def add_from(self, value: float, unknowns: FloatArray, omega: float) -> None:
        """Follow the peak near a solution in both directions; a warning where there is none."""
        stage = self._stage_at(value).with_harmonics(len(unknowns) // 2)
        point = stage.corrected(stage.curve.at(unknowns, omega))
        peak = "Newton's method did not converge" if point is None else stage.search.from_point(point)
        if isinstance(peak, str):
            self.warnings.append(
                f"A peak near {omega / (2.0 * math.pi):.2f} Hz at {self._named(value)} was not followed: {peak}."
            )
            return
        start = RidgePoint.start(value, peak, stage)
        if self._is_known(start):
            return
        start = self._pace.resolved(start, stage)
        if self._is_between(start):
            return
        (below, first), (above, last) = self._beside([partial(self._followed, start, stop) for stop in self._bounds])
        self.ridges.append(Ridge([*reversed(below), start, *above], (first, last)))

    def _followed(self, start: RidgePoint, stop: float, chain: StageChain) -> tuple[list[RidgePoint], str]:
        """See :func:`follow`, with the equations of a chain."""
        searched = partial(self._searched, chain)
        return follow(searched, start, stop, self._pace, self._needless, self._is_near_highest)

    def _beside(self, tasks: Sequence[Callable[[StageChain], Answer]]) -> list[Answer]:
        """The answers of independent tasks, each of which has a chain of its own."""
        chains = [self._stage_at.apart() for _ in tasks]
        answers = side_by_side(
            [partial(task, chain) for task, chain in zip(tasks, chains, strict=True)], self.work.stop
        )
        for chain in chains:
            self.work.add(chain.work)
        return answers

    def _searched(self, chain: StageChain, value: float) -> RidgeStage | str:
        """The equations at a value, which is reported; or why there are no equations there."""
        if chain.work.is_used_up:
            return TOO_MUCH_WORK
        low, high = map(math.log, self._bounds)
        self._passed = min(self._passed[0], value), max(self._passed[1], value)
        passed = math.log(self._passed[1] / self._passed[0])
        self._report.stage(f"peak at {self._named(value)}", min(0.99, passed / (high - low)) if high > low else 0.0)
        try:
            return chain(value)
        except StickslipError as error:  # a law or a static state that does not exist there
            return str(error)

    def _is_known(self, start: RidgePoint) -> bool:
        """Whether a ridge has this point."""
        return any(
            each.parameter == start.parameter and cover.is_same(each, start)
            for ridge in self.ridges
            for each in ridge.points
        )

    def _is_between(self, start: RidgePoint) -> bool:
        """Whether a point is between two points of a ridge, which then has it."""
        for ridge in self.ridges:
            place = cover.place_on(ridge.points, ridge.line, start)
            if place is not None:
                ridge.points.insert(place, start)
                return True
        return False

    def harmonics_near(self, value: float, least: int) -> int:
        """The most harmonics of the points of ridges nearest to a value, at ``least`` so many."""
        near = (min(each.points, key=lambda p: abs(math.log(p.parameter / value))) for each in self.ridges)
        return max((each.harmonics for each in near), default=least)

    def refine(self) -> None:
        """Add points where the interpolation of the highest ridge is least accurate, until it is accurate enough."""
        given_up: set[float] = set()
        while not self.work.is_used_up:
            intervals = [
                each
                for ridge in self.ridges
                for each in inaccurate_intervals(ridge, self._pace)
                if each.middle not in given_up and any(self._is_near_highest(point) for point in each.ends)
            ]
            worth = apart(intervals)
            if not worth:
                return
            found = self._beside([partial(self._between, each) for each in worth])
            for interval, point in zip(worth, found, strict=True):
                if point is None:
                    given_up.add(interval.middle)
                else:
                    interval.ridge.insert(point)

    def _between(self, interval: Interval, chain: StageChain) -> RidgePoint | None:
        """A point in the middle of an interval, None where there is none."""
        near = sorted(interval.ends, key=lambda each: each.harmonics)
        search = self._searched(chain, interval.middle)
        found = search if isinstance(search, str) else self._pace.next_point(search, near, interval.middle)[0]
        if isinstance(found, str):
            return None
        assert not isinstance(search, str)  # it has a point
        return self._pace.between(found, search, near)

    def check_ends(self) -> None:
        """Compute a whole curve beyond each ridge that ends inside the range as the highest one. If it has larger
        amplitudes than all ridges, as where a peak left the frequency range, the highest peak is unknown from there."""
        for ridge in tuple(self.ridges):
            ends = ridge.points[0], ridge.points[-1]
            for reason, point, bound in zip(ridge.ends, ends, self._bounds, strict=True):
                # Where the work ended, the ridge itself may go on, and nothing hides it.
                if (
                    reason in ("", TOO_MUCH_WORK, JOINED)
                    or self._fraction_of_highest(point) < 1.0 - cover.SAME_AMPLITUDE
                ):
                    continue
                step = math.copysign(2.0 * self._pace.smallest_step, bound - point.parameter)
                beyond = point.parameter * math.exp(step)
                if not self._bounds[0] < beyond < self._bounds[1] or self._is_highest_known(beyond):
                    continue
                known = [each for each in self.verified if (each - point.parameter) * step > 0.0]
                end = min(known, key=lambda each: abs(each - point.parameter), default=bound)
                low, high = sorted((point.parameter, end))
                self._unknown.append((low, high))

    def enclose_minimum(self, lowest: float) -> None:
        """Compute whole curves at the lower end and in gaps of the followed range, and follow their peaks.

        The lower end moves down, at most to ``lowest``, until the highest peak has risen above its minimum. If the
        highest ridge falls to the first lower end, that is not the case there, so the first curve is farther down.
        """
        tried: set[float] = set()
        if self._bounds[0] > lowest and cover.falls_to([ridge.points for ridge in self.ridges], self._bounds[0]):
            self._lower(max(lowest, self._bounds[0] / LOWER_BY))
        while self.ridges and not self.work.is_used_up:
            followed = [(ridge.points[0].parameter, ridge.points[-1].parameter) for ridge in self.ridges]
            value: float | None = self._bounds[0]
            if value in tried:
                value = cover.middle_of_gap(followed, tried)
            if value is None:
                if self._bounds[0] <= lowest or self.rise_below().is_enough:
                    return
                value = max(lowest, self._bounds[0] / LOWER_BY)
                self._lower(value)
            tried.add(value)
            try:
                self.add_curve(value)
            except StickslipError as error:  # a law or a static state that does not exist there
                self.warnings.append(f"There is no frequency curve at {self._named(value)}: {error}")

    def _lower(self, value: float) -> None:
        """Move the lower end of the range, and follow the ridges that reach it farther."""
        reaching = [ridge for ridge in self.ridges if ridge.points[0].parameter == self._bounds[0]]
        self._bounds = value, self._bounds[1]
        for ridge in reaching:
            part, end = self._followed(ridge.points[0], value, self._stage_at)
            ridge.points[:0] = reversed(part)
            ridge.ends = end, ridge.ends[1]

    def rise_below(self) -> cover.RiseBelow:
        """The rise of the highest peak below its minimum."""
        points = [each for ridge in self.ridges for each in ridge.points]
        parameter = np.array([each.parameter for each in points])
        stuck = np.array([each.is_stuck for each in points])
        highest = np.array([self.highest_at(each) for each in parameter])
        free = self._free.get(self._bounds[0])
        return cover.rise_below(parameter, highest, stuck, 0.0 if free is None else free.amplitude)

    def _is_highest_known(self, value: float) -> bool:
        """Whether a whole curve at a value has no larger amplitude than the ridges there."""
        if self.work.is_used_up:
            return False
        try:
            self.add_curve(value)
        except StickslipError:  # a law or a static state that does not exist there
            return False
        return value in self.verified

    def _needless(self, point: RidgePoint) -> str:
        """Why a ridge need not be followed beyond a point, or "" """
        if any(cover.passes_through(ridge.points, ridge.line, point) for ridge in self.ridges):
            return JOINED
        if self._fraction_of_highest(point) >= LEAST_FRACTION:
            return ""
        return f"beyond {self._named(point.parameter)}, it is below {LEAST_FRACTION:g} of the highest peak"

    def _is_near_highest(self, point: RidgePoint) -> bool:
        """Whether no other ridge is clearly higher at the value of a point."""
        return self._fraction_of_highest(point) >= NEAR_HIGHEST

    def _fraction_of_highest(self, point: RidgePoint) -> float:
        """Amplitude of a point over that of the highest ridge at its value."""
        return point.peak.amplitude / max(point.peak.amplitude, self.highest_at(point.parameter))

    def highest_at(self, value: float) -> float:
        """Amplitude of the highest ridge at a value, 0 where there is none."""
        at, highest = math.log(value), 0.0
        for ridge in self.ridges:
            if ridge.points[0].parameter <= value <= ridge.points[-1].parameter:
                highest = max(highest, math.exp(float(ridge.line.at(np.array([at]))[0])))
        return highest

    def result(self, name: str, unit: str, output_name: str) -> PeakRidge:
        """The ridges as a result. Raises ConvergenceError without any."""
        if not self.ridges:
            reasons = " ".join(self.warnings)
            raise ConvergenceError(f"no peak was found that could be followed over {name}. {reasons}".rstrip())
        self._see_free()
        found = ridge_result(
            self.ridges, self._bounds, (self._stuck, self._free), self._unknown, not self._pace.has_fixed_harmonics
        )
        named = replace(found, parameter_name=name, parameter_unit=unit, output_name=output_name)
        converged, message = cover.coverage(named, self._reasons(), self._named)
        work: dict[str, str | float | int] = {
            "points_of_searches": self.work.points,
            "points_of_whole_curves": self.points_of_curves,
        }
        return replace(named, converged=converged, message=message, warnings=tuple(self.warnings), settings=work)

    def _reasons(self) -> list[str]:
        """Why ridges end, each reason once."""
        found = dict.fromkeys(reason for ridge in self.ridges for reason in ridge.ends)
        return [reason for reason in found if reason not in ("", JOINED)]

    def curve_window(self, value: float) -> tuple[float, float]:
        """The range of frequencies, Hz, of a whole curve: that of all linear peaks and of the ridges there, and the
        factor ``around`` beyond."""
        stage = self._stage_at(value)
        if self._around is None:
            return stage.window
        near = (min(ridge.points, key=lambda each: abs(math.log(each.parameter / value))) for ridge in self.ridges)
        return stage.window_around(self._around, self._modes, [each.peak.omega / (2.0 * math.pi) for each in near])

    def _see_free(self) -> None:
        """The peaks without contacts at both ends of the followed range, if no whole curve gave them."""
        values = [each.parameter for ridge in self.ridges for each in ridge.points]
        for value in {min(values), max(values)} - set(self._free):
            if (free := self._stage_at(value).free_peaks[0]).bracketed:
                self._free[value] = free
