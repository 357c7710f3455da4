"""The lowest minimum with slip of the highest peaks, made certain by whole curves, and its peak with more harmonics."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from stickslip.core.errors import ConvergenceError
from stickslip.core.threads import side_by_side
from stickslip.results.checked_peak import CheckedPeak
from stickslip.results.peaks import peaks
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.peak import CurvePeak
from stickslip.solve.ridges.ridge_coverage import OTHER_HARMONICS
from stickslip.solve.ridges.ridge_map import RidgeMap
from stickslip.solve.ridges.ridge_stage import RidgeStage, Work, more_than

# chosen: peaks with at least this fraction of the highest one could be the highest; estimates of errors are smaller.
NEAR_HIGHEST = 0.8
# chosen: most harmonics of a check. A peak that needs more has an error that the check reports.
MOST_HARMONICS = 9
# chosen: a minimum moves when a whole curve shows a peak that no ridge had; so many curves follow it.
MOST_CURVES = 3
# chosen: a minimum that moves by less, relative, is at its place: the distance of the grid of a ridge.
SAME_PLACE = 0.01


def checked_minimum(
    ridges: RidgeMap, accuracy: float, beside: Callable[[], None] = lambda: None
) -> CheckedPeak | str | None:
    """The highest peak at the lowest minimum with slip: why it is not known, None without such a minimum.

    A whole curve there has more harmonics than the ridges, and its highest peak even more, until its estimated error is
    below the ``accuracy`` or ``MOST_HARMONICS`` are reached. If that peak is none of the ridges, whole curves with
    their harmonics follow: they show peaks that no ridge has. These are followed, and the next curve is at the minimum
    that remains. There the check is repeated. ``beside`` is work on the ridges at the time of the first check, which is
    repeated where the minimum moves in it. Raises InputError.
    """
    value = _minimum(ridges)
    if value is None:
        beside()
        return None
    work = ridges.work.rest()
    check = _check_task(ridges, value, accuracy, work)
    tasks: list[Callable[[], CheckedPeak | str | None]] = [beside, check]
    found = side_by_side(tasks, ridges.work.stop)[1]
    ridges.work.add(work)
    minimum = _minimum(ridges)
    if minimum is None:
        return None
    if found is None or abs(math.log(minimum / value)) >= SAME_PLACE:
        value = minimum
        found = _check(ridges, value, accuracy)
    if not isinstance(found, str) and found.amplitude <= (1.0 + OTHER_HARMONICS) * ridges.highest_at(value):
        ridges.verified.add(value)
        return found
    settled = _settled_minimum(ridges, value)
    if not isinstance(settled, float):
        return settled
    return found if settled == value else _check(ridges, settled, accuracy)


def _settled_minimum(ridges: RidgeMap, value: float) -> float | str | None:
    """The minimum whose whole curve shows no peak that moves it, from one at a value; why it is not known."""
    for _ in range(MOST_CURVES):
        ridges.add_curve(value)
        if value not in ridges.verified:
            return "the whole curve there shows no peak that could be followed."
        minimum = _minimum(ridges)
        if minimum is None:
            return None
        if abs(math.log(minimum / value)) < SAME_PLACE:
            return value
        value = minimum
    return f"it moved with each of {MOST_CURVES} whole curves."


def _minimum(ridges: RidgeMap) -> float | None:
    """The place of the lowest minimum with slip."""
    minimum = ridges.result("parameter", "", "").slipping_minimum
    return None if minimum is None else minimum.parameter


def _check(ridges: RidgeMap, value: float, accuracy: float) -> CheckedPeak | str:
    """The highest peak of a whole curve with more harmonics than the ridges, or why it is not known."""
    return _check_task(ridges, value, accuracy, ridges.work)()


def _check_task(ridges: RidgeMap, value: float, accuracy: float, work: Work) -> Callable[[], CheckedPeak | str]:
    """See :func:`_check`: a task that may run beside other work, with its own count of ``work``."""
    curve = ridges.curve_task(value, more_than(ridges.harmonics_near(value, 1)), work)

    def task() -> CheckedPeak | str:
        try:
            stage, branch = curve()
        except ConvergenceError as failure:
            return str(failure)
        if not branch.complete:
            return f"its frequency curve is not complete. {branch.message}"
        found = peaks_of_curve(stage, [each.point for each in branch.points])
        if isinstance(found, str):
            return found
        best, error = highest_of(stage, found, accuracy)
        return CheckedPeak(value, best.amplitude, best.omega / (2.0 * math.pi), error, best.harmonics)

    return task


def peaks_of_curve(stage: RidgeStage, points: Sequence[BalancePoint]) -> list[CurvePeak] | str:
    """The peaks of a whole curve that could be its highest with more harmonics, or why they are not known."""
    hertz = np.array([point.trial.omega for point in points]) / (2.0 * math.pi)
    tops = peaks(hertz, stage.amplitude(points))
    if not tops[0].bracketed:
        return f"its largest amplitude is at an end of the frequency range, {tops[0].frequency_hz:.2f} Hz."
    found = []
    for top in tops:
        if top.bracketed and top.amplitude >= NEAR_HIGHEST * tops[0].amplitude:
            point = stage.corrected(points[top.point])
            peak = "Newton's method did not converge" if point is None else stage.search.from_point(point)
            if isinstance(peak, str):
                return f"its peak at {top.frequency_hz:.2f} Hz was not found: {peak}."
            found.append(peak)
    return found


def highest_of(stage: RidgeStage, candidates: Sequence[CurvePeak], accuracy: float) -> tuple[CurvePeak, float]:
    """The highest of some peaks, and its estimated error, with that of others which could be as high.

    The highest peak has more harmonics, and so has each other one whose error does not rule it out.
    """
    known: list[tuple[CurvePeak, float]] = []
    for peak in sorted(candidates, key=lambda each: -each.amplitude):
        own = stage.with_harmonics(peak.harmonics)
        highest = max((other.amplitude for other, _ in known), default=0.0)
        if not known or peak.amplitude * (1.0 + own.estimated_error(peak)) > highest:
            refined, errors = own.refined(peak, accuracy, MOST_HARMONICS)
            known.append((refined, errors[refined.harmonics]))
    best, error = max(known, key=lambda each: each[0].amplitude)
    possible = max(peak.amplitude * (1.0 + wrong) for peak, wrong in known)
    return best, max(error, possible / best.amplitude - 1.0)
