"""The nonlinear mode of a study, before anything is reduced or solved."""

from __future__ import annotations

from stickslip.case.analysis import ModeAnalysis
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.model.joint import Joint
from stickslip.model.layout import AnyStructure
from stickslip.model.study_structure import study_structure


def reduced_unknowns(case: Case, structure: AnyStructure, joint: Joint) -> tuple[int, int]:
    """Unknowns of boundary nodes, and modes with fixed boundary, of the reduced structure; matrices have no modes."""
    return study_structure(structure).reduced_unknowns(joint.layout, case.reduction.modes)


def require_mode(case: Case, structure: AnyStructure, joint: Joint) -> None:
    """Raise InputError for a mode above the number of unknowns of the reduced structure.

    Rigid bodies are no modes either: a run that knows their number rejects the last few numbers before its curve.
    """
    analysis = case.analysis
    most = sum(reduced_unknowns(case, structure, joint))
    if isinstance(analysis, ModeAnalysis) and analysis.mode > most:
        raise InputError(
            f"mode is {analysis.mode}, but it must be at most {most}, the number of unknowns of the reduced structure. "
            "Choose a lower mode.",
            ("analysis.mode",),
        )
