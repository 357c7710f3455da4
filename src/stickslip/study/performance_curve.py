"""The performance curve of two blades: peak amplitude and frequency against centrifugal force over excitation force.

Each point is the highest peak under the excitation force of the study. With the centrifugal force of the damper the
normal load changes, and with it the contact stiffness if that follows from the roughness: this is the damper of the
study with another mass or at another speed, not only another preload at constant stiffness.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stickslip.case.case import Case, TwoBladeCase
from stickslip.core.errors import StickslipError
from stickslip.core.progress import Progress
from stickslip.core.validation import FloatArray
from stickslip.model.model import Model
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.peaks import peaks
from stickslip.results.response import ForcedResponse
from stickslip.solve.ridge import LEAST_FRACTION, RidgeMap, Work
from stickslip.solve.ridge_walk import Pace
from stickslip.solve.setting_up import StageReport
from stickslip.study.ridge import CaseFamily, CaseStages

KEY = "preload.centrifugal_force"
# chosen: three decades of centrifugal force over excitation force contain the optimum of dampers (of the order of 1 to
# 10) and come near both limits.
LOWEST_RATIO, HIGHEST_RATIO = 0.1, 100.0
# A picture: coarser steps than those of a ridge, and it ends where a bouncing damper would need tiny ones.
PACE = Pace(first_step=0.2, smallest_step=0.02, largest_step=0.8, wanted_error=0.04)
# chosen: work of the curve over that of the frequency curve of the study; with the preparation of the values it takes
# less than the time of three of them.
MOST_CURVES = 2.0


def performance_curve(
    case: Case, model: Model, response: ForcedResponse, progress: Progress, threads: int
) -> PeakRidge | str:
    """The ridge of peaks over the centrifugal force, from the peaks of the response of the case; or why there is none.

    The highest peak of the response and those of the stuck structure under the largest force are followed.
    """
    assert isinstance(case, TwoBladeCase)
    force = case.preload.centrifugal_force
    if force is None:
        return "the study gives no centrifugal_force"
    family = CaseFamily.of(case, KEY)
    amplitude = case.excitation.amplitude
    low, high = (ratio * amplitude for ratio in (LOWEST_RATIO, HIGHEST_RATIO))
    bounds = min(low, force), max(high, force)
    report = StageReport(lambda fraction, detail: progress.update("Performance curve", fraction, detail))
    stages = CaseStages(family, model, report, threads)
    work = Work(MOST_CURVES * float(response.iterations.sum() + response.n_points))
    ridges = RidgeMap(stages, bounds, report, PACE, "{:.4g} N".format, work)
    try:
        _follow_response(ridges, stages, force, response)
        ridges.add_stuck(bounds[1])
        ridges.refine()
        return ridges.result(KEY, "N", next(iter(model.outputs)))
    except StickslipError as error:
        return str(error)


def _follow_response(ridges: RidgeMap, stages: CaseStages, force: float, response: ForcedResponse) -> None:
    """Follow the high peaks of the response of the case."""
    output = next(iter(stages.model.outputs.values()))
    found = peaks(response.frequency_hz, response.amplitude(output), response.part)
    for top in found:
        if top.bracketed and top.amplitude >= LEAST_FRACTION * found[0].amplitude:
            unknowns = response.pair_coefficients(top.point).reshape(3 * response.pairs.n_pairs, -1).T
            omega = 2.0 * np.pi * float(response.frequency_hz[top.point])
            ridges.add_from(force, unknowns, omega)
