"""The line between the points of a ridge: their places, heights and slopes, and its values between them."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.results.highest_peak import known_slopes, left_out_errors, log_interpolated
from stickslip.solve.ridges.ridge_walk import RidgePoint


@dataclass(frozen=True)
class RidgeLine:
    """(n,) logarithms of the parameter, rising, and of the amplitude, and the slopes of the latter, not a number where
    they are not known."""

    places: FloatArray
    heights: FloatArray
    slopes: FloatArray

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
        return cls(places, heights, rises)

    @property
    def all_slopes(self) -> FloatArray:
        """(n,) the slopes, where they are not known those of the line."""
        if self.places.size == 1:
            return np.nan_to_num(self.slopes)
        return known_slopes(self.places, self.heights, self.slopes)

    def at(self, places: FloatArray) -> FloatArray:
        """Logarithms of the amplitude at logarithms of the parameter."""
        return log_interpolated(self.places, self.heights, places, self.slopes)

    def left_out_errors(self) -> FloatArray:
        """(n,) distance of each point from the line through all others."""
        return left_out_errors(self.places, self.heights, self.slopes)
