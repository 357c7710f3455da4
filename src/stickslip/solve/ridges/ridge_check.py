"""The highest peak at one value of the parameter of a ridge, from a whole curve with more harmonics than the ridge."""

from __future__ import annotations

import math

import numpy as np

from stickslip.core.errors import ConvergenceError
from stickslip.results.checked_peak import CheckedPeak
from stickslip.results.peaks import peaks
from stickslip.solve.ridges.ridge_stage import RidgeStage

# chosen: peaks with at least this fraction of the highest one could be the highest; estimates of errors are smaller.
NEAR_HIGHEST = 0.8
# chosen: most harmonics of a check. A peak that needs more has an error that the check reports.
MOST_HARMONICS = 9


def checked_peak(stage: RidgeStage, value: float, accuracy: float, window: tuple[float, float]) -> CheckedPeak | str:
    """The highest peak at a ``value`` of the parameter, or why it is not known.

    ``stage`` gives the equations there, with the harmonics of the whole curve over a ``window`` in Hz. Its highest peak
    has more, until its estimated error is below the ``accuracy`` or ``MOST_HARMONICS`` are reached. Raises InputError.
    """
    try:
        branch = stage.whole_curve(window)
    except ConvergenceError as failure:
        return str(failure)
    if not branch.complete:
        return f"its frequency curve is not complete. {branch.message}"
    points = [each.point for each in branch.points]
    hertz = np.array([point.trial.omega for point in points]) / (2.0 * math.pi)
    found = peaks(hertz, stage.amplitude(points))
    if not found[0].bracketed:
        return f"its largest amplitude is at an end of the frequency range, {found[0].frequency_hz:.2f} Hz."
    tops = []
    for top in found:
        if top.bracketed and top.amplitude >= NEAR_HIGHEST * found[0].amplitude:
            peak = stage.search.from_point(points[top.point])
            if isinstance(peak, str):
                return f"its peak at {top.frequency_hz:.2f} Hz was not found: {peak}."
            tops.append((peak, stage.estimated_error(peak)))
    tops.sort(key=lambda each: -each[0].amplitude)
    refined, errors = stage.refined(tops[0][0], accuracy, MOST_HARMONICS)
    tops[0] = refined, errors[refined.harmonics]
    best, error = max(tops, key=lambda each: each[0].amplitude)
    highest = max(peak.amplitude * (1.0 + wrong) for peak, wrong in tops)
    error = max(error, highest / best.amplitude - 1.0)
    return CheckedPeak(value, best.amplitude, best.omega / (2.0 * math.pi), error, best.harmonics)
