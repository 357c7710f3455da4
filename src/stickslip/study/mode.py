"""The nonlinear mode of a study, before anything is solved."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stickslip.case.analysis import ModeAnalysis
from stickslip.case.case import Case
from stickslip.core.errors import InputError, concerning
from stickslip.core.validation import FloatArray
from stickslip.model.joint import Joint
from stickslip.model.layout import AnyStructure, Setup
from stickslip.model.model import ReducedModel, build_model
from stickslip.model.study_structure import study_structure
from stickslip.solve.modes.linear_mode import LinearMode, require_allowed_amplitude

# chosen: an output that moves less in a mode, over the largest motion of the mode, is at a node of it. The round-off of
# shapes in the default study is 1e-14 to 1e-10 there; stiffer contact has more.
LEAST_MOTION = 1e-6
# chosen: pairs up to which a nonlinear mode has the quasi-static estimate beside it. It takes 0.4 s with 110
# pairs, 7 s with 400, and 40 s with 970.
MOST_PAIRS_BESIDE = 400


@dataclass(frozen=True)
class FirstMotion:
    """The motion of the first output in a linear mode.

    in_mode:
        m with the modal amplitude 1 m kg^0.5.
    share:
        over the largest motion of the structure in this mode.
    """

    in_mode: float
    share: float


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


def has_estimate(analysis: ModeAnalysis, n_pairs: int) -> bool:
    """Whether a run computes the quasi-static estimate: that of a stuck mode, alone or beside the mode of few pairs."""
    return analysis.limit == "stuck" and (analysis.mode_method == "quasi-static" or n_pairs <= MOST_PAIRS_BESIDE)


def words_beyond_reduction(case: Case, structure: AnyStructure) -> Iterator[str]:
    """A sentence on a mode with a higher number than the reduction has modes; matrices are not reduced."""
    analysis, kept = case.analysis, case.reduction.modes
    # The mode n of a structure is not above its nth one with fixed boundary, so these span the first modes at least.
    if isinstance(analysis, ModeAnalysis) and study_structure(structure).full_model and analysis.mode > kept:
        yield (
            f"analysis.mode is {analysis.mode}, but the reduction has {kept} modes with fixed boundary, so this mode "
            "may not be one of the full model. A run compares both before its curve, and rejects a mode that the full "
            "model does not have. Give more reduction.modes, or a lower mode."
        )


def linear_mode(analysis: ModeAnalysis, model: ReducedModel) -> LinearMode:
    """The linear mode of an analysis. Raises InputError for one that does not exist."""
    with concerning("analysis.mode"):
        return LinearMode.of(model.superelement, model.pairs, analysis.mode, analysis.limit)


def allowed_mode(case: Case, model: ReducedModel) -> FirstMotion:
    """The motion of the first output in the linear mode of a mode analysis.

    Raises InputError for a mode that does not exist, or that does not move the first output, and for amplitudes at
    which a law does not resist.
    """
    analysis = case.analysis
    assert isinstance(analysis, ModeAnalysis)
    linear = linear_mode(analysis, model)
    name, row = next(iter(model.outputs.items()))
    motion = abs(float(row @ linear.shape))
    share = motion / _largest_motion(model, linear.shape, row)
    if share <= LEAST_MOTION:
        raise InputError(
            f'mode is {analysis.mode}, which moves the output "{name}" by at most {LEAST_MOTION:g} of its largest '
            "motion, so this amplitude does not determine that of the mode. Choose another mode, or another first "
            "output.",
            ("analysis.mode",),
        )
    with concerning("analysis.largest_amplitude"):
        require_allowed_amplitude(model.pairs, linear, analysis.largest_amplitude / motion, motion)
    return FirstMotion(motion, share)


def _largest_motion(model: ReducedModel, shape: FloatArray, row: FloatArray) -> float:
    """The largest displacement of the mesh in a shape (n,); without a mesh, the largest that the ``row`` (n,) of an
    output could have with unknowns of this size."""
    recovery = model.superelement.recovery
    if recovery is not None:
        return float(np.abs(recovery @ shape).max())
    return float(np.abs(row).sum() * np.abs(shape).max())
