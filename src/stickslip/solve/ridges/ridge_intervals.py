"""Intervals between the points of a ridge in which its line is not accurate enough."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from stickslip.solve.ridges.ridge_line import Ridge
from stickslip.solve.ridges.ridge_walk import Pace, RidgePoint

# chosen: an interval that is not divided, over the smallest step: a corner may be beside the end of such a step.
SHORTEST = 0.5
# chosen: intervals that are divided at once; the error of an interval follows from so many neighbours on each side.
AT_ONCE, NEIGHBOURS = 4, 2


class Interval(NamedTuple):
    """An interval after a point of a ridge; ``area`` is the length times the error, between two lines."""

    ridge: Ridge
    place: int
    area: float

    @property
    def ends(self) -> list[RidgePoint]:
        """The points at its ends."""
        return self.ridge.points[self.place : self.place + 2]

    @property
    def middle(self) -> float:
        """The value of the parameter in its middle."""
        return math.sqrt(math.prod(each.parameter for each in self.ends))


def apart(intervals: Iterable[Interval]) -> list[Interval]:
    """The largest of some intervals, at most so many as are divided at once, none of them close to another."""
    chosen: list[Interval] = []
    for each in sorted(intervals, key=lambda interval: -interval.area):
        near = (other for other in chosen if other.ridge is each.ridge)
        if all(abs(other.place - each.place) > NEIGHBOURS for other in near):
            chosen.append(each)
    return chosen[:AT_ONCE]


def inaccurate_intervals(ridge: Ridge, pace: Pace) -> Iterator[Interval]:
    """Intervals of a ridge with an estimated error above the accuracy."""
    errors, lengths = ridge.line.interval_errors(), np.diff(ridge.line.places)
    for place in np.flatnonzero(errors > pace.interpolation_error).tolist():
        if lengths[place] > SHORTEST * pace.smallest_step:
            yield Interval(ridge, place, float(errors[place] * lengths[place]))
