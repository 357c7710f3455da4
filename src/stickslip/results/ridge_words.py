"""Words on a minimum of a ridge of peaks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stickslip.results.highest_peak import Optimum

if TYPE_CHECKING:
    from stickslip.results.peak_ridge import PeakRidge

# chosen: values between the points at which the highest ridge is determined.
GRID_PER_INTERVAL = 8
# Largest error of the search of a peak (docs/theory_ridge.md, 1), which no estimate contains.
SMALLEST_ERROR = 1e-4
STUCK_OPTIMUM = (
    "No pair slips there: the excitation hardly drives the stuck mode, so the peak is low without friction, and only "
    "in a range so narrow that this value is approximate. With slip, the lowest peak is that of the other minima."
)


def error_words(ridge: PeakRidge, at: Optimum) -> str:
    """The estimated error of a minimum, to follow its amplitude; "" where nothing was estimated.

    It is the largest one up to an interval beside the place, which is as uncertain as the curve around it.
    """
    if ridge.estimated_error is None:
        return ""
    grid = ridge.grid
    place = int(np.argmin(np.abs(grid - at.parameter)))
    near = ridge.error_at(grid[max(0, place - GRID_PER_INTERVAL) : place + GRID_PER_INTERVAL + 1])
    return f", estimated error {100.0 * max(SMALLEST_ERROR, float(np.nanmax(near))):.2g} %"
