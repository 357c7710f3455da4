"""Gradients of the highest peak of a study by its inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError
from stickslip.core.progress import Progress, SilentProgress
from stickslip.model.model import Model
from stickslip.model.parameters import case_parameters
from stickslip.results.peak_gradients import PeakGradients
from stickslip.results.response import ForcedResponse
from stickslip.solve.gradients.parameters import Parameter
from stickslip.solve.gradients.peak_gradients import peak_gradients


def with_gradients(
    case: Case, model: Model, response: ForcedResponse, progress: Progress, threads: int
) -> ForcedResponse:
    """The response with the gradients of the highest peak of the first output, or with a warning without them."""
    try:
        gradients = gradients_of_peak(case, model, response, case_parameters(case, model), threads, progress=progress)
    except ConvergenceError as error:  # the response is a result without them
        return replace(response, warnings=(*response.warnings, f"The gradients were not computed: {error}"))
    return replace(response, gradients=gradients)


def gradients_of_peak(
    case: Case,
    model: Model,
    response: ForcedResponse,
    parameters: Sequence[Parameter],
    threads: int,
    peak: int = 0,
    progress: Progress | None = None,
) -> PeakGradients:
    """The gradients of a peak of the first output, the highest one by default. Raises ConvergenceError."""
    listener = progress or SilentProgress()
    return peak_gradients(
        model.superelement,
        model.pairs,
        model.excitation,
        response,
        next(iter(model.outputs.values())),
        peak=peak,
        parameters=parameters,
        modal_damping_ratio=case.damping.modal_damping_ratio,
        threads=threads,
        progress=lambda fraction, detail: listener.update("Gradients", fraction, detail),
    )
