"""The lowest minimum with slip of the highest peaks, made certain by whole curves, and its peak with more harmonics."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from stickslip.results.checked_peak import CheckedPeak
from stickslip.solve.harmonic.peak import CurvePeak
from stickslip.solve.ridges.ridge_map import RidgeMap
from stickslip.solve.ridges.ridge_stage import RidgeStage

# chosen: most harmonics of a check. A peak that needs more has an error that the check reports.
MOST_HARMONICS = 9
# chosen: a minimum moves when a whole curve shows a peak that no ridge had; so many curves follow it.
MOST_CURVES = 3
# chosen: a minimum that moves by less, relative, is at its place: the distance of the grid of a ridge.
SAME_PLACE = 0.01


def checked_minimum(
    ridges: RidgeMap, stage_at: Callable[[float], RidgeStage], accuracy: float
) -> CheckedPeak | str | None:
    """The highest peak at the lowest minimum with slip: why it is not known, None without such a minimum.

    A whole curve at the minimum shows peaks that no ridge has. They are followed, and the next curve is at the minimum
    that remains. The highest peak has more harmonics, until its estimated error is below the ``accuracy`` or
    ``MOST_HARMONICS`` are reached, and so have peaks that could be as high. Raises InputError.
    """
    value = None
    for _ in range(MOST_CURVES):
        minimum = _minimum(ridges)
        if minimum is None:
            return None
        if value is not None and abs(math.log(minimum / value)) < SAME_PLACE:
            break
        value = minimum
        ridges.add_curve(value)
        if value not in ridges.verified:
            return "the whole curve there shows no peak that could be followed."
    minimum = _minimum(ridges)
    if minimum is None or value is None or abs(math.log(minimum / value)) >= SAME_PLACE:
        return f"it moved with each of {MOST_CURVES} whole curves."
    best, error = highest_of(stage_at(value), _peaks_at(ridges, value), accuracy)
    return CheckedPeak(value, best.amplitude, best.omega / (2.0 * math.pi), error, best.harmonics)


def _minimum(ridges: RidgeMap) -> float | None:
    """The place of the lowest minimum with slip."""
    minimum = ridges.result("parameter", "", "").slipping_minimum
    return None if minimum is None else minimum.parameter


def _peaks_at(ridges: RidgeMap, value: float) -> list[CurvePeak]:
    """The peaks at a value of a whole curve, which are points of ridges."""
    return [each.peak for ridge in ridges.ridges for each in ridge.points if each.parameter == value]


def highest_of(stage: RidgeStage, peaks: Sequence[CurvePeak], accuracy: float) -> tuple[CurvePeak, float]:
    """The highest of some peaks, and its estimated error, with that of others which could be as high.

    The highest peak has more harmonics, and so has each other one whose error does not rule it out.
    """
    known: list[tuple[CurvePeak, float]] = []
    for peak in sorted(peaks, key=lambda each: -each.amplitude):
        own = stage.with_harmonics(peak.harmonics)
        highest = max((other.amplitude for other, _ in known), default=0.0)
        if peak.amplitude * (1.0 + own.estimated_error(peak)) > highest:
            refined, errors = own.refined(peak, accuracy, MOST_HARMONICS)
            known.append((refined, errors[refined.harmonics]))
    best, error = max(known, key=lambda each: each[0].amplitude)
    possible = max(peak.amplitude * (1.0 + wrong) for peak, wrong in known)
    return best, max(error, possible / best.amplitude - 1.0)
