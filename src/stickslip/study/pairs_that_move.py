"""A study whose structure has unknowns of the moving pairs alone: pairs join them until the others rest."""

from __future__ import annotations

from functools import partial

from stickslip.case.case import Case
from stickslip.core.progress import Progress
from stickslip.model.model import Model, model_of_moving_pairs
from stickslip.results.response import ForcedResponse
from stickslip.solve.partial_joint import not_resting
from stickslip.study.analyses import solve


def solved_with_moving_pairs(
    case: Case, model: Model, progress: Progress, threads: int, checks: bool = True
) -> tuple[Model, ForcedResponse]:
    """The response of a model, and the model whose pairs beside the moving ones rest at all of its points.

    ``checks`` as :func:`stickslip.study.analyses.solve` has them.

    Each time some of these move, they join the moving ones, and structure and curve are computed again; with all pairs
    this ends. A model with unknowns for all pairs is solved as it is.
    """
    response, moving = solve(case, model, progress, threads, checks), model.reduced.moving
    while moving is not None:
        others = not_resting(response, moving)
        if not others.any():
            break
        moving = moving | others
        shown = partial(_report, progress, f"{int(moving.sum())} of {moving.size} pairs move")
        model = model_of_moving_pairs(case, model.structure, model.joint, moving, threads, shown)
        response = solve(case, model, progress, threads, checks)
    return model, response


def _report(progress: Progress, words: str, share: float, detail: str) -> None:
    """Report the finished share of another reduction."""
    progress.update("Structure", share, f"{words}; {detail}")
