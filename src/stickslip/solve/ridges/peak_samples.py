"""The highest peak at single values of a parameter, each by a whole frequency curve.

For structures whose peaks cannot be followed: with a solved preload pairs open and close while the load changes, so
that contact stiffness and peaks jump (docs/theory_ridge.md).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial

from stickslip.core.errors import ConvergenceError, StickslipError
from stickslip.core.threads import side_by_side
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.peaks import Peak
from stickslip.solve.ridges.ridge_check import peaks_of_curve
from stickslip.solve.ridges.ridge_line import Ridge
from stickslip.solve.ridges.ridge_result import ridge_result
from stickslip.solve.ridges.ridge_stage import RidgeStage, StageMaker, Work
from stickslip.solve.ridges.ridge_walk import TOO_MUCH_WORK, Pace, RidgePoint
from stickslip.solve.ridges.stage_chain import StageChain
from stickslip.solve.setting_up import StageReport

# chosen: so many values side by side; more than two threads would share the time of the interpreter.
AT_ONCE = 2
# chosen: a curve that takes more than this part of the whole work ends, so that the others remain.
MOST_OF_ONE = 0.25
# chosen: values closer than this factor are not divided.
CLOSE = 1.1
BETWEEN = (
    "Each computed peak has a frequency curve of its own. Between them pairs open and close with the load, so that the "
    "line is a guess. Lower and higher peaks are not excluded there and beyond the ends."
)


class PeakSamples:
    """Highest peaks at values of the parameter; arguments as in :class:`stickslip.solve.ridges.ridge_map.RidgeMap`.

    The digits of a peak depend on the values before it, not on the number of threads.
    """

    def __init__(
        self,
        stage_at: StageMaker,
        report: StageReport,
        pace: Pace,
        named: Callable[[float], str],
        work: Work,
        modes: frozenset[int] | None,
        around: float,
        earlier: RidgeStage | None = None,
    ) -> None:
        self.work = work
        self._stage_at = StageChain(stage_at, work, self._see_limits, earlier)
        self._report, self._pace, self._named = report, pace, named
        self._modes, self._around = modes, around
        self._stuck: dict[float, Peak] = {}
        self._free: dict[float, Peak] = {}
        self.points: list[RidgePoint] = []
        self.failures: dict[float, str] = {}
        self.points_of_curves = 0

    def _see_limits(self, value: float, stage: RidgeStage) -> None:
        """Keep the linear peaks at a value."""
        for kept, found in ((self._stuck, stage.stuck_peaks(self._modes)), (self._free, stage.free_peaks)):
            if found and found[0].bracketed:
                kept[value] = found[0]

    def add(self, values: Iterable[float]) -> None:
        """Compute the highest peaks at values."""
        left = list(values)
        while left:
            some, left = left[:AT_ONCE], left[AT_ONCE:]
            done = self.work.done / max(self.work.most, 1.0)
            self._report.stage(f"frequency curve at {' and '.join(map(self._named, some))}", min(0.99, done))
            chains = [self._stage_at.apart() for _ in some]
            for chain in chains:
                chain.work.most = min(chain.work.most, MOST_OF_ONE * self.work.most)
            found = side_by_side(
                [partial(self._highest, value, chain) for value, chain in zip(some, chains, strict=True)],
                self.work.stop,
            )
            for value, chain, (point, count) in zip(some, chains, found, strict=True):
                self.work.add(chain.work)
                self.points_of_curves += count
                if isinstance(point, str):
                    self.failures[value] = point
                else:
                    self.points.append(point)
        self.points.sort(key=lambda each: each.parameter)

    def divide_lowest(self) -> None:
        """Compute two more peaks, on both sides of the lowest one with slip, or of the lowest one if all stick."""
        moving = [each for each in self.points if not each.is_stuck] or self.points
        if not moving:
            return
        lowest = min(moving, key=lambda each: each.peak.amplitude)
        place = self.points.index(lowest)
        beside = self.points[max(0, place - 1) : place + 2]
        ends = [(low.parameter, high.parameter) for low, high in itertools.pairwise(beside)]
        self.add([math.sqrt(low * high) for low, high in ends if high / low > CLOSE])

    def _highest(self, value: float, chain: StageChain) -> tuple[RidgePoint | str, int]:
        """The highest peak at a value, or why it is not known; the number of points of whole curves."""
        count, found = 0, TOO_MUCH_WORK
        if chain.work.is_used_up:
            return found, count
        try:
            stage = chain(value)
            for window in (stage.window_around(self._around, self._modes), stage.window):
                branch = stage.whole_curve(window)
                count += len(branch.points)
                if not branch.complete:
                    return branch.message, count
                tops = peaks_of_curve(stage, [each.point for each in branch.points])
                if not isinstance(tops, str):
                    highest = max(tops, key=lambda each: each.amplitude)
                    return self._pace.resolved(RidgePoint.start(value, highest, stage), stage), count
                found = tops
        except StickslipError as error:  # no static state, or no first point
            return str(error), count
        return found, count

    def result(self, bounds: tuple[float, float], name: str, unit: str, output_name: str) -> PeakRidge:
        """The peaks as one ridge. Raises ConvergenceError without any."""
        if not self.points:
            reasons = "; ".join(dict.fromkeys(self.failures.values()))
            raise ConvergenceError(f"no frequency curve over {name} has a peak: {reasons}")
        found = ridge_result(
            [Ridge(self.points, ("", ""))], bounds, (self._stuck, self._free), self._unknown(bounds),
            not self._pace.has_fixed_harmonics,
        )  # fmt: skip
        message = f"The highest peak is known at {len(self.points)} values, each by a whole frequency curve."
        if self.failures:
            message += f" At {len(self.failures)} other value(s) it is unknown."
        return replace(
            found,
            parameter_name=name,
            parameter_unit=unit,
            output_name=output_name,
            converged=not self.failures,
            message=message,
            warnings=(
                BETWEEN,
                *(f"At {self._named(each)}: {self.failures[each]}" for each in sorted(self.failures)),
            ),
            settings={"points_of_searches": self.work.points, "points_of_whole_curves": self.points_of_curves},
        )

    def _unknown(self, bounds: tuple[float, float]) -> Sequence[tuple[float, float]]:
        """Ranges between known peaks, or the ends, in which a curve failed."""
        known = [bounds[0], *(each.parameter for each in self.points), bounds[1]]
        return [
            (low, high) for low, high in itertools.pairwise(known) if any(low <= each <= high for each in self.failures)
        ]
