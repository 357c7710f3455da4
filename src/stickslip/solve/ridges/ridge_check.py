"""The highest peak at one value of the parameter of a ridge, from a whole curve with more harmonics than the ridge."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from stickslip.core.errors import ConvergenceError
from stickslip.core.fourier import with_rows
from stickslip.results.checked_peak import CheckedPeak
from stickslip.results.peaks import peaks
from stickslip.solve.harmonic.peak import CurvePeak
from stickslip.solve.harmonic.varying_harmonics import LADDER
from stickslip.solve.path.problem import Step
from stickslip.solve.ridges.ridge_stage import RidgeStage

# chosen: peaks with at least this fraction of the highest one could be the highest; estimates of errors are smaller.
NEAR_HIGHEST = 0.8
# chosen: most harmonics of a check. A peak that needs more has an error that the check reports.
MOST_HARMONICS = 9


def checked_peak(
    stage_of: Callable[[int], RidgeStage], value: float, harmonics: int, accuracy: float, window: tuple[float, float]
) -> CheckedPeak | str:
    """The highest peak at a ``value`` of the parameter, or why it is not known.

    ``stage_of`` gives the equations there with a number of harmonics. The whole curve over a ``window`` in Hz has the
    next number above the ``harmonics`` of the ridge. Its highest peak has more, until its estimated error is below the
    ``accuracy`` or ``MOST_HARMONICS`` are reached. Raises InputError.
    """
    count = _more(harmonics)
    stage = stage_of(count)
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
            tops.append((peak, stage.estimated_error(peak), count))
    tops.sort(key=lambda each: -each[0].amplitude)
    tops[0] = _refined(stage_of, *tops[0], accuracy)
    best, error, count = max(tops, key=lambda each: each[0].amplitude)
    highest = max(peak.amplitude * (1.0 + wrong) for peak, wrong, _ in tops)
    error = max(error, highest / best.amplitude - 1.0)
    return CheckedPeak(value, best.amplitude, best.omega / (2.0 * math.pi), error, count)


def _refined(
    stage_of: Callable[[int], RidgeStage], peak: CurvePeak, error: float, harmonics: int, accuracy: float
) -> tuple[CurvePeak, float, int]:
    """A peak with its error and its harmonics: more of them until the error is below the accuracy."""
    while error > accuracy and harmonics < MOST_HARMONICS:
        more = _more(harmonics)
        stage, tangent = stage_of(more), peak.probe.tangent
        rows = 2 * more + 1
        wide = Step(with_rows(tangent.unknowns, rows), tangent.parameters, with_rows(tangent.detail, rows))
        unknowns = with_rows(peak.probe.point.unknowns, rows)
        found = stage.search.from_estimate(unknowns, float(peak.probe.point.parameters[0]), wide, peak.curvature)
        if isinstance(found, str):
            break
        peak, error, harmonics = found, stage.estimated_error(found), more
    return peak, error, harmonics


def _more(harmonics: int) -> int:
    """The next number of harmonics."""
    return next((each for each in LADDER if each > harmonics), harmonics + 2)
