"""Wear of the joint of a study."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stickslip.case.analysis import WearAnalysis
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.core.progress import Progress
from stickslip.core.validation import FloatArray
from stickslip.model.joint import Joint
from stickslip.model.model import ReducedModel, kind_of
from stickslip.model.worn_faces import RunningIn, WornFaces
from stickslip.results.record import run_provenance
from stickslip.results.response import ForcedResponse
from stickslip.results.wear import Wear
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.wear.wear import DEFAULT_ACCURACY, unreported_wear


def worn_faces(case: Case, joint: Joint) -> WornFaces | None:
    """The stiffness of the faces while they wear; None if it is an input of the study, which wear does not change.

    Raises InputError for a joint that cannot wear.
    """
    analysis = case.analysis
    assert isinstance(analysis, WearAnalysis)
    if case.preload.method == "prescribed" and not (joint.preload > 0.0).any():
        raise InputError(
            'kind is "wear", but no pair is closed at rest, so nothing presses the joint while it wears. Give a normal '
            "load.",
            ("analysis.kind",),
        )
    settings = kind_of(case).face_settings(case)
    running_in = None
    if analysis.running_in_sq is not None and analysis.running_in_depth is not None:
        if not any(own.is_rough for own in settings):
            raise InputError(
                "running_in_sq has no effect: the stiffness of no face follows from [roughness]. Remove it.",
                ("analysis.running_in_sq",),
            )
        running_in = RunningIn.of(case, analysis.running_in_sq, analysis.running_in_depth)
    return WornFaces(case, joint, settings, running_in) if any(own.is_pressed for own in settings) else None


def energy_coefficients(analysis: WearAnalysis, joint: Joint) -> FloatArray:
    """(n_pairs,) m3/J: as given, or Archard's coefficient over the friction coefficient of each pair."""
    if analysis.wear_coefficient is not None:
        return analysis.wear_coefficient / joint.friction_coefficient
    assert analysis.energy_wear_coefficient is not None  # the section has one of the two
    return analysis.energy_wear_coefficient + 0.0 * joint.friction_coefficient


def wear_of_study(
    case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress, threads: int | None
) -> Wear:
    """The wear of the joint at the highest peak of the first output, or at a frequency of the study.

    It has the harmonics and samples of the study, or those of the ``response`` there if they are more.

    Raises InputError for a joint that cannot wear, ConvergenceError without a motion before the wear.
    """
    analysis, settings, faces = case.analysis, case.solver, worn_faces(case, model.joint)
    assert isinstance(analysis, WearAnalysis)
    window = settings.frequency_start, settings.frequency_stop
    output, hertz = next(iter(model.outputs.values())), response.frequency_hz
    if analysis.wear_frequency is None:
        place = response.amplitude(output).argmax()
    else:
        place = np.abs(hertz - analysis.wear_frequency).argmin()
    resolution = response.resolution_at([int(place)])
    result = unreported_wear(
        model.superelement,
        model.pairs,
        model.excitation,
        output,
        area=model.joint.face_pairs.area,
        energy_wear_coefficient=energy_coefficients(analysis, model.joint),
        cycles=analysis.wear_cycles,
        frequency_hz=window if analysis.wear_frequency is None else analysis.wear_frequency,
        accuracy=DEFAULT_ACCURACY,
        stiffness=None if faces is None else faces.stiffness,
        harmonics=resolution.harmonics,
        samples=resolution.samples,
        modal_damping_ratio=case.damping.modal_damping_ratio,
        update=settings.update,
        newton=NewtonSettings(tolerance=settings.tolerance),
        threads=threads,
        progress=lambda fraction, detail: progress.update("Wear", fraction, detail),
    )
    return replace(result, provenance={**result.provenance, **run_provenance()})
