"""Which part of a range the ridges cover, and whether they enclose the lowest of the highest peaks."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.results.highest_peak import log_interpolated
from stickslip.results.peak_ridge import PeakRidge
from stickslip.solve.harmonic.balance import relative_norm
from stickslip.solve.ridges.ridge_line import RidgeLine
from stickslip.solve.ridges.ridge_walk import RidgePoint

# chosen: the minimum is enclosed below where the highest peak has risen to this multiple of it; the dips of friction
# dampers beside their optimum are shallower.
ENCLOSED = 2.5
# chosen: or to this multiple at the end itself, as the highest peak below the minimum, with a higher one still without
# contact, to which the peak rises as the load vanishes. Doubtful peaks are wrong by less. Only this is no certainty: a
# light damper that bounces may have dips (up to 1.45 deep in the rough casting).
RISEN = 1.25
# chosen: a gap of more than this factor of the parameter may contain another minimum.
GAP = 1.03

# chosen: a point is on another ridge if its frequency and its amplitude agree so far with those interpolated there,
# which are up to 1 % off in amplitude. Neglected harmonics move both: the amplitude by the estimated error, the
# frequency of a flat peak by this fraction of it.
JOINED_FREQUENCY, JOINED_AMPLITUDE, FREQUENCY_ERROR = 1e-4, 1e-2, 0.05

# chosen: two peaks at one value of the parameter are one if their amplitudes agree so far, and their motions (mass
# norm): a peak has an error of 1e-4 at most, and its motion turns by a few hundredths of a radian over this rise. With
# another number of harmonics the amplitude may be farther off.
SAME_AMPLITUDE, SAME_MOTION, OTHER_HARMONICS = 1e-3, 0.1, 0.03

# chosen: a peak between two points of a ridge belongs to it if its relative motion over its amplitude differs from that
# between theirs by at most this fraction. Those of two ridges differ by their own size.
SAME_SHAPE = 0.3

Interval = tuple[float, float]


def merged(intervals: Sequence[Interval]) -> list[Interval]:
    """The union of intervals, rising."""
    joined: list[Interval] = []
    for low, high in sorted(intervals):
        if joined and low <= joined[-1][1]:
            joined[-1] = joined[-1][0], max(joined[-1][1], high)
        else:
            joined.append((low, high))
    return joined


def middle_of_gap(followed: Sequence[Interval], tried: Collection[float]) -> float | None:
    """The middle of the longest gap between intervals that contains no value that was ``tried``; None without one."""
    covered = merged(followed)
    gaps = [(high, low) for (_, high), (low, _) in itertools.pairwise(covered)]
    for below, above in sorted(gaps, key=lambda gap: gap[0] / gap[1]):
        if above / below > GAP and not any(below < each < above for each in tried):
            return math.sqrt(below * above)
    return None


class RiseBelow(NamedTuple):
    """The rise of the highest peak below the value of its minimum, over that minimum.

    ``at_end`` is that at the lower end, ``most`` the largest one, ``free`` that of the peak without contact, 0 if that
    is not known.
    """

    at_end: float
    most: float
    free: float

    @property
    def is_certain(self) -> bool:
        """Whether a lower minimum below the lower end is as good as excluded."""
        return self.most >= ENCLOSED

    @property
    def is_enough(self) -> bool:
        """Whether the minimum is enclosed."""
        return self.is_certain or (self.at_end >= RISEN and self.at_end >= self.most and self.free >= self.at_end)


def rise_below(parameter: FloatArray, highest: FloatArray, is_stuck: NDArray[np.bool_], free: float) -> RiseBelow:
    """The rise of the highest peak below its minimum.

    ``parameter`` (n,) are points, ``highest`` (n,) the highest peak there, ``free`` is the peak without contact at the
    lower end, 0 if it is not known. Points at which ``is_stuck``, because no pair slips, are no minimum of a friction
    damper: there the excitation does not reach the mode. They count if all points are stuck.
    """
    moving = ~is_stuck if not is_stuck.all() else np.ones_like(is_stuck)
    best = np.flatnonzero(moving)[int(np.argmin(highest[moving]))]
    below = highest[parameter <= parameter[best]].max()
    return RiseBelow(*(float(each / highest[best]) for each in (highest[np.argmin(parameter)], below, free)))


def falls_to(ridges: Sequence[Sequence[RidgePoint]], start: float) -> bool:
    """Whether the highest of the ridges, given by their points, falls to its first point, at ``start``."""
    first = [points[:2] for points in ridges if points[0].parameter == start]
    highest = max(first, key=lambda points: points[0].peak.amplitude, default=[])
    return len(highest) > 1 and highest[0].peak.amplitude < highest[1].peak.amplitude


def is_same(point: RidgePoint, other: RidgePoint) -> bool:
    """Whether two peaks at one value of the parameter are one."""
    rows = 2 * max(point.harmonics, other.harmonics)
    motions = [with_rows(each.trial.amplitude, rows) for each in (point, other)]
    tolerance = SAME_AMPLITUDE if point.harmonics == other.harmonics else OTHER_HARMONICS
    return (
        abs(math.log(point.peak.amplitude / other.peak.amplitude)) < tolerance
        and relative_norm(motions[0] - motions[1], motions[1]) < SAME_MOTION
    )


def passes_through(points: Sequence[RidgePoint], line: RidgeLine, point: RidgePoint) -> bool:
    """Whether the ridge of these points, in the order of the parameter, with their line, continues through another."""
    places, at = line.places, np.array([math.log(point.parameter)])
    if not places[0] < at[0] < places[-1]:
        return False
    omega = np.log([each.peak.omega for each in points])
    error = point.estimates.get(point.harmonics, 0.0)
    return bool(
        abs(log_interpolated(places, omega, at)[0] - math.log(point.peak.omega))
        < max(JOINED_FREQUENCY, FREQUENCY_ERROR * error)
        and abs(line.at(at)[0] - math.log(point.peak.amplitude)) < max(JOINED_AMPLITUDE, error)
    )


def place_on(points: Sequence[RidgePoint], line: RidgeLine, point: RidgePoint) -> int | None:
    """The place among the points of a ridge, in the order of the parameter, at which another point is its next one:
    amplitude and motion are those between the points on both sides. None if it is on another ridge, or beyond."""
    places, at = line.places, math.log(point.parameter)
    after = int(np.searchsorted(places, at))
    if not places[0] < at < places[-1] or places[after] == at:
        return None
    low, high = points[after - 1], points[after]
    if abs(float(line.at(np.array([at]))[0]) - math.log(point.peak.amplitude)) > OTHER_HARMONICS:
        return None
    fraction = (at - places[after - 1]) / (places[after] - places[after - 1])
    rows = 2 * max(each.harmonics for each in (low, high, point)) + 1
    shapes = [with_rows(each.shape, rows) for each in (low, high, point)]
    between = (1.0 - fraction) * shapes[0] + fraction * shapes[1]
    return after if np.linalg.norm(between - shapes[2]) < SAME_SHAPE * np.linalg.norm(shapes[2]) else None


def coverage(ridge: PeakRidge, reasons: Collection[str], named: Callable[[float], str]) -> tuple[bool, str]:
    """Whether the highest peak is known over the whole range, and words on it.

    ``reasons`` are those why ridges end, ``named`` is a value of the parameter in words.
    """
    top = ridge.highest()
    known = np.flatnonzero(top.ridge >= 0)
    if known.size == top.ridge.size:
        return True, "The highest peak is known over the whole range."
    low, high = (named(float(top.parameter[place])) for place in (known[0], known[-1]))
    gaps = " with gaps" if known[-1] - known[0] + 1 > known.size else ""
    return False, f"The highest peak is known from {low} to {high} only{gaps}: {'; '.join(reasons)}."
