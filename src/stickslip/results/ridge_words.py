"""Words on a minimum of a ridge of peaks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.results.checked_peak import percent_words

# chosen: values between the points at which the highest ridge is determined.
GRID_PER_INTERVAL = 8
# Largest error of the search of a peak (docs/theory_ridge.md, 1), which no estimate contains.
SMALLEST_ERROR = 1e-4
STUCK_OPTIMUM = (
    "No pair slips there: the excitation hardly drives the stuck mode, so the peak is low without friction, and only "
    "in a range so narrow that this value is approximate. With slip, the lowest peak is that of the other minima."
)


def error_words(grid: FloatArray, error_at: Callable[[FloatArray], FloatArray], parameter: float) -> str:
    """The estimated error of a minimum of a ridge, to follow its amplitude.

    It is the largest one up to an interval of the ``grid`` beside the place, which is as uncertain as the curve around
    it; ``error_at`` gives it for values of the parameter.
    """
    place = int(np.argmin(np.abs(grid - parameter)))
    near = error_at(grid[max(0, place - GRID_PER_INTERVAL) : place + GRID_PER_INTERVAL + 1])
    return f", estimated error {percent_words(max(SMALLEST_ERROR, float(np.nanmax(near))))}"
