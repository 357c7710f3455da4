"""Gradients of the highest peak of a study by its inputs."""

from __future__ import annotations

from dataclasses import replace

from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError
from stickslip.core.progress import Progress
from stickslip.model.model import Model
from stickslip.model.parameters import case_parameters
from stickslip.results.response import ForcedResponse
from stickslip.solve.peak_gradients import peak_gradients


def with_gradients(
    case: Case, model: Model, response: ForcedResponse, progress: Progress, threads: int
) -> ForcedResponse:
    """The response with the gradients of the highest peak of the first output, or with a warning without them."""
    try:
        gradients = peak_gradients(
            model.superelement,
            model.pairs,
            model.excitation,
            response,
            next(iter(model.outputs.values())),
            parameters=case_parameters(case, model),
            modal_damping_ratio=case.damping.modal_damping_ratio,
            threads=threads,
            progress=lambda fraction, detail: progress.update("Gradients", fraction, detail),
        )
    except ConvergenceError as error:  # the response is a result without them
        return replace(response, warnings=(*response.warnings, f"The gradients were not computed: {error}"))
    return replace(response, gradients=gradients)
