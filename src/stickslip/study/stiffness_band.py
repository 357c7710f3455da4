"""The band of a contact stiffness that was not measured: the curves with 1/3 and 3 times the stiffness of the law."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stickslip.case.analysis import ForcedAnalysis
from stickslip.case.case import Case
from stickslip.contact.stiffness.believable import BAND
from stickslip.core.errors import StickslipError
from stickslip.core.progress import Progress
from stickslip.model.model import ReducedModel, connect, load_joint
from stickslip.model.rough_face import roughness_section
from stickslip.results.response import ForcedResponse
from stickslip.results.stiffness_band import StiffnessBand
from stickslip.study.analyses import MOST_POINTS, forced_curve

KEY = "roughness.stiffness_factor"
# chosen: relative error of the balance of curves whose stiffness is uncertain by a factor 3.
TOLERANCE = 1e-6
# Stiffness over that of the study -> name of the curve.
FACTORS = {1.0 / BAND: f"contact stiffness × 1/{BAND:g}", BAND: f"contact stiffness × {BAND:g}"}


def has_stiffness_band(case: Case) -> bool:
    """Whether a run computes the band: the stiffness of a face follows from its roughness, so nobody measured it. Not
    in the unknowns of the pairs that move with one stiffness."""
    return case.analysis.stiffness_band and case.has_rough_faces and case.reduction.pairs == "all"


@dataclass(frozen=True)
class _Stage:
    """Progress of one of the curves, as a part of the band."""

    listener: Progress
    place: int

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """The finished fraction of the band."""
        self.listener.update("Stiffness band", (self.place + fraction) / len(FACTORS), detail)


def with_stiffness_band(
    case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress, threads: int
) -> ForcedResponse:
    """The response with its stiffness band, if the case has one; a warning for a curve that could not be computed."""
    if not has_stiffness_band(case):
        return response
    warnings, curves = list(response.warnings), {}
    # chosen: a curve beside the one of the study may take twice its points and the work of these, not that of a whole
    # search for what goes on beyond an end.
    most_points = max(MOST_POINTS, 2 * response.n_points)
    for place, factor in enumerate(FACTORS):
        try:
            other = _with_stiffness(case, model, response, factor)
            curve = forced_curve(*other, _Stage(progress, place), threads, checks=False, most_points=most_points)
        except StickslipError as error:
            warnings.append(f"The curve with {FACTORS[factor]} was not computed: {error}")
            continue
        curves[factor] = curve
        if not curve.converged:
            warnings.append(f"The curve with {FACTORS[factor]} is not complete: {curve.message}")
    band = _stored(curves).with_harmonics(response.harmonics) if curves else None
    return replace(response, stiffness_band=band, warnings=tuple(warnings))


def _with_stiffness(
    case: Case, model: ReducedModel, response: ForcedResponse, factor: float
) -> tuple[Case, ReducedModel]:
    """The case with ``factor`` times the stiffness of its rough faces, with harmonics and samples of its peak, and its
    model. Raises InputError, RoughnessError, ConvergenceError."""
    highest = int(response.amplitude(next(iter(model.outputs.values()))).argmax())
    changed = case.replace(
        {
            KEY: factor * roughness_section(case).stiffness_factor,
            "solver.accuracy": None,
            "solver.harmonics": response.harmonics_at([highest]),
            "solver.samples": response.resolution_at([highest]).samples,
            "solver.tolerance": max(TOLERANCE, case.solver.tolerance),
        }
    ).model_copy(update={"analysis": ForcedAnalysis()})
    return changed, connect(changed, model.reduced, load_joint(changed, model.joint.layout))


def _stored(curves: dict[float, ForcedResponse]) -> StiffnessBand:
    """The curves as a result, with the most harmonics of a curve; those that another lacks are zero."""
    width = max(each.displacement.shape[2] for each in curves.values())
    padded = [
        np.pad(each.displacement, ((0, 0), (0, 0), (0, width - each.displacement.shape[2]))) for each in curves.values()
    ]
    return StiffnessBand(
        tuple(FACTORS[factor] for factor in curves),
        np.array([each.converged for each in curves.values()]),
        np.repeat(np.arange(len(curves)), [each.n_points for each in curves.values()]),
        np.concatenate([each.frequency_hz for each in curves.values()]),
        np.concatenate(padded),
        np.array(list(curves)),
    )
