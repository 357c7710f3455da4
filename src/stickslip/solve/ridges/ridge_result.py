"""Ridges with the linear limits beside them as a result."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from stickslip.contact.law.law import ContactState
from stickslip.results.checked_peak import spread
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.peaks import Peak
from stickslip.solve.ridges.ridge_line import Ridge


def ridge_result(
    ridges: Sequence[Ridge],
    bounds: tuple[float, float],
    limits: tuple[Mapping[float, Peak], Mapping[float, Peak]],
    unknown: Sequence[tuple[float, float]],
    has_estimates: bool,
) -> PeakRidge:
    """The points of ridges over a range, with the linear peaks ``limits`` by the parameter, stuck and free, and the
    ranges in which the highest peak is ``unknown``; still without names, message and warnings."""
    points = [each for ridge in ridges for each in ridge.points]
    counts = [np.bincount(each.trial.contact.state, minlength=len(ContactState)) for each in points]
    stuck, free = (sorted(each.items()) for each in limits)
    errors = None
    if has_estimates:
        errors = np.concatenate([spread([(p.harmonics, p.estimates) for p in ridge.points]) for ridge in ridges])
    return PeakRidge(
        parameter=np.array([each.parameter for each in points]),
        amplitude=np.array([each.peak.amplitude for each in points]),
        frequency_hz=np.array([each.peak.omega for each in points]) / (2.0 * math.pi),
        ridge=np.repeat(np.arange(len(ridges)), [len(each.points) for each in ridges]),
        is_corner=np.array([each.peak.is_corner for each in points]),
        curvature=np.array([each.peak.curvature for each in points]),
        pairs_stuck=np.array([each[ContactState.STUCK] for each in counts]),
        pairs_stick_slip=np.array([each[ContactState.STICK_SLIP] for each in counts]),
        pairs_separating=np.array([each[ContactState.SEPARATING] for each in counts]),
        residual=np.array([each.trial.error for each in points]),
        iterations=np.array([each.peak.iterations for each in points]),
        stuck_parameter=np.array([value for value, _ in stuck]),
        stuck_amplitude=np.array([peak.amplitude for _, peak in stuck]),
        stuck_frequency_hz=np.array([peak.frequency_hz for _, peak in stuck]),
        free_parameter=np.array([value for value, _ in free]),
        free_amplitude=np.array([peak.amplitude for _, peak in free]),
        free_frequency_hz=np.array([peak.frequency_hz for _, peak in free]),
        parameter_name="",
        parameter_unit="",
        output_name="",
        start=np.asarray(bounds[0]),
        stop=np.asarray(bounds[1]),
        estimated_error=errors,
        slope=np.concatenate([ridge.line.all_slopes for ridge in ridges]),
        point_harmonics=np.array([each.harmonics for each in points]),
        unknown=np.array(unknown).reshape(-1, 2),
        ends=tuple(each.ends for each in ridges),
        converged=False,
        message="",
        warnings=(),
        settings={},
        provenance={},
    )
