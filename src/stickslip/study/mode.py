"""The nonlinear mode of a study, before anything is solved."""

from __future__ import annotations

import numpy as np

from stickslip.case.analysis import ModeAnalysis
from stickslip.case.case import Case
from stickslip.core.errors import InputError, concerning
from stickslip.model.joint import Joint
from stickslip.model.layout import AnyStructure, Setup
from stickslip.model.model import ReducedModel, build_model
from stickslip.model.study_structure import study_structure
from stickslip.solve.modes.linear_mode import LinearMode, require_allowed_amplitude

# chosen: an output that moves less in a mode, over the largest unknown, is at a node of it.
LEAST_MOTION = 1e-9


def reduced_unknowns(case: Case, structure: AnyStructure, joint: Joint) -> tuple[int, int]:
    """Unknowns of boundary nodes, and modes with fixed boundary, of the reduced structure; matrices have no modes."""
    return study_structure(structure).reduced_unknowns(joint.layout, case.reduction.modes)


def require_possible_mode(case: Case, setup: Setup) -> None:
    """Raise InputError for a mode above the unknowns that any reduction of a structure has, before its matrices."""
    analysis, most = case.analysis, setup.most_unknowns(case.reduction.modes)
    if isinstance(analysis, ModeAnalysis) and analysis.mode > most:
        raise _too_high(analysis.mode, most)


def require_mode(case: Case, structure: AnyStructure, joint: Joint) -> None:
    """Raise InputError for a mode above the number of unknowns of the reduced structure.

    Rigid bodies are no modes either: a run that knows their number rejects the last few numbers before its curve.
    """
    analysis = case.analysis
    most = sum(reduced_unknowns(case, structure, joint))
    if isinstance(analysis, ModeAnalysis) and analysis.mode > most:
        raise _too_high(analysis.mode, most)


def _too_high(mode: int, most: int) -> InputError:
    return InputError(
        f"mode is {mode}, but the reduced structure has at most {most} unknowns and modes. Choose a lower one.",
        ("analysis.mode",),
    )


def require_allowed_mode(case: Case, structure: AnyStructure, joint: Joint) -> None:
    """:func:`allowed_mode` without a run, for a joint whose law resists only up to some motion: only this requires the
    reduction of the structure. A solved preload, on which that motion depends, is checked by the run alone."""
    limited = any(np.isfinite(getattr(law, "largest_motion", np.inf)).any() for _, law, _ in joint.laws)
    if isinstance(case.analysis, ModeAnalysis) and limited and case.preload.method == "prescribed":
        allowed_mode(case, build_model(case, structure, joint))


def allowed_mode(case: Case, model: ReducedModel) -> float:
    """The motion of the first output, m, in the linear mode of a mode analysis with the modal amplitude 1 m kg^0.5.

    Raises InputError for a mode that does not exist, or that does not move the first output, and for amplitudes at
    which a law does not resist.
    """
    analysis = case.analysis
    assert isinstance(analysis, ModeAnalysis)
    with concerning("analysis.mode"):
        linear = LinearMode.of(model.superelement, model.pairs, analysis.mode, analysis.limit)
    name, row = next(iter(model.outputs.items()))
    motion, largest = abs(float(row @ linear.shape)), float(np.abs(linear.shape).max())
    if motion <= LEAST_MOTION * float(np.abs(row).max()) * largest:
        raise InputError(
            f'mode is {analysis.mode}, which does not move the output "{name}", so its amplitude does not determine '
            "that of the mode. Choose another mode, or another first output.",
            ("analysis.mode",),
        )
    with concerning("analysis.largest_amplitude"):
        require_allowed_amplitude(model.pairs, linear, analysis.largest_amplitude / motion, motion)
    return motion
