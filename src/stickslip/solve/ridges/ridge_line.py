"""Ridges as points in the order of the parameter, and the line between them: places, heights, slopes, and values."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.results.highest_peak import (
    ERROR_OF_LEFT_OUT,
    ERROR_OF_SMOOTH,
    MORE_THAN_TWO,
    known_slopes,
    left_out_errors,
    log_interpolated,
    slope_differences,
)
from stickslip.solve.ridges.ridge_walk import RidgePoint

# chosen: distance in the logarithm of the parameter of a node of the excitation from a peak that it does not lower.
NEARBY = 0.1


@dataclass(frozen=True)
class RidgeLine:
    """(n,) logarithms of the parameter, rising, and of the amplitude, the slopes of the latter, not a number where they
    are not known, and whether the peak is the linear one."""

    places: FloatArray
    heights: FloatArray
    slopes: FloatArray
    linear: NDArray[np.bool_]

    @classmethod
    def of(cls, points: Sequence[RidgePoint]) -> RidgeLine:
        """The line through points in the order of the parameter.

        The search ends where the slope ``g'`` along the frequency curve is small, not zero: while the lag of the peak
        changes by ``s'`` with the parameter, the amplitude changes by ``g' s'`` more than at fixed lag.
        """
        places = np.log([each.parameter for each in points])
        heights = np.log([each.peak.amplitude for each in points])
        rises = np.array([each.rise for each in points])
        if len(points) > 1:
            turned = [before.lag_to(after) for before, after in itertools.pairwise(points)]
            lag = np.concatenate([[0.0], np.cumsum(turned)])
            turning = np.gradient(lag, places, edge_order=2 if len(points) > 2 else 1)
            rises = rises + np.array([each.peak.probe.slope for each in points]) * turning
        return cls(places, heights, rises, np.array([each.is_linear for each in points]))

    @property
    def all_slopes(self) -> FloatArray:
        """(n,) the slopes, where they are not known those of the line."""
        if self.places.size == 1:
            return np.nan_to_num(self.slopes)
        return known_slopes(self.places, self.heights, self.slopes)

    def at(self, places: FloatArray) -> FloatArray:
        """Logarithms of the amplitude at logarithms of the parameter."""
        return log_interpolated(self.places, self.heights, places, self.slopes)

    def interval_errors(self) -> FloatArray:
        """(n-1,) estimated errors of the line between two points.

        From the smaller distance of both points from the line through all others, because a corner beside one of them
        is none between them; and from the difference to the line with slopes of neighbours. Without known slopes, from
        the larger distance. Linear peaks have no corner: their errors are those of smooth curves, from the larger one.
        """
        if self.places.size < MORE_THAN_TWO:
            return np.zeros(self.places.size - 1)
        left_out = left_out_errors(self.places, self.heights, self.slopes) / ERROR_OF_LEFT_OUT
        left_out[[0, -1]] = left_out[[1, -2]]  # nothing is known of an end
        known = ~np.isnan(self.slopes)
        smaller, larger = (each(left_out[:-1], left_out[1:]) for each in (np.minimum, np.maximum))
        errors = np.where(known[:-1] & known[1:], smaller, larger)
        differences = slope_differences(self.places, self.heights, self.slopes)
        smooth = self.linear[:-1] & self.linear[1:]
        errors = np.where(smooth, larger * ERROR_OF_LEFT_OUT / ERROR_OF_SMOOTH, np.maximum(errors, differences))
        # Beside a node of the excitation the logarithm has no bound: there the error is one of the higher peaks nearby.
        near = np.abs(self.places[:, None] - self.places) < NEARBY
        lowered = self.heights - np.where(near, self.heights, -np.inf).max(axis=1)
        return np.asarray(errors * np.exp(np.maximum(lowered[:-1], lowered[1:])))


@dataclass
class Ridge:
    """A ridge in the order of the parameter, and the reasons why it ends below and above."""

    points: list[RidgePoint]
    ends: tuple[str, str]
    _line: tuple[tuple[int, ...], RidgeLine] | None = None

    def insert(self, point: RidgePoint) -> None:
        """Add a point at its place."""
        bisect.insort(self.points, point, key=lambda each: each.parameter)

    @property
    def line(self) -> RidgeLine:
        """The line through the points."""
        own = tuple(map(id, self.points))
        if self._line is None or self._line[0] != own:
            self._line = own, RidgeLine.of(self.points)
        return self._line[1]
