"""The nonlinear mode of a study beside its curve, and the quasi-static estimate of it."""

from __future__ import annotations

from dataclasses import replace

from stickslip.case.analysis import ModeAnalysis
from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError
from stickslip.core.progress import Progress
from stickslip.model.model import ReducedModel
from stickslip.results.mode_comparison import comparison
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.quasi_static_mode import QuasiStaticMode
from stickslip.results.response import ForcedResponse
from stickslip.solve.modes.nonlinear_mode import unreported_mode
from stickslip.solve.modes.quasi_static_mode import POINTS_PER_DECADE, unreported_estimate
from stickslip.solve.path.newton import NewtonSettings
from stickslip.study.mode import FirstMotion, has_estimate
from stickslip.study.mode_doubts import amplitude_doubts, node_doubts


def with_mode(
    case: Case,
    model: ReducedModel,
    response: ForcedResponse,
    first: FirstMotion,
    listener: Progress,
    threads: int | None,
) -> ForcedResponse:
    """The response with the nonlinear mode and, of a stuck mode, the quasi-static estimate, or with the estimate alone;
    where one of them was not computed, a warning gives the reason."""
    analysis = case.analysis
    assert isinstance(analysis, ModeAnalysis)
    name, output = next(iter(model.outputs.items()))
    doubts = node_doubts(name, first, analysis)
    mode, estimate, failures = None, None, list[str]()
    if analysis.mode_method == "periodic":
        try:
            mode = _nonlinear_mode(case, model, analysis, first, listener, threads)
            doubts = (*doubts, *amplitude_doubts(mode, name, output, analysis))
            mode = replace(mode, warnings=(*doubts, *mode.warnings))
        except ConvergenceError as error:  # the response is a result without it
            failures.append(f"The nonlinear mode was not computed: {error}")
    if has_estimate(analysis, model.pairs.n_pairs):
        try:
            estimate = _estimate(case, model, analysis, first, listener, threads)
            if mode is not None:
                estimate = replace(estimate, message=f"{estimate.message} {comparison(mode, estimate)}")
            else:
                estimate = replace(estimate, warnings=(*doubts, *estimate.warnings))
        except ConvergenceError as error:
            failures.append(f"The quasi-static estimate of the mode was not computed: {error}")
    warnings = (*response.warnings, *failures)
    return replace(response, nonlinear_mode=mode, quasi_static_mode=estimate, warnings=warnings)


def with_mode_doubts(response: ForcedResponse, doubts: tuple[str, ...]) -> ForcedResponse:
    """The response with these warnings of its nonlinear mode, or else of the estimate."""
    if response.nonlinear_mode is not None:
        mode = response.nonlinear_mode
        return replace(response, nonlinear_mode=replace(mode, warnings=(*doubts, *mode.warnings)))
    if response.quasi_static_mode is not None:
        estimate = response.quasi_static_mode
        return replace(response, quasi_static_mode=replace(estimate, warnings=(*doubts, *estimate.warnings)))
    return response


def _nonlinear_mode(
    case: Case, model: ReducedModel, analysis: ModeAnalysis, first: FirstMotion, listener: Progress, threads: int | None
) -> NonlinearMode:
    """The nonlinear mode. Raises ConvergenceError."""
    settings = case.solver
    return unreported_mode(
        model.superelement,
        model.pairs,
        analysis.mode,
        _modal_amplitudes(analysis, first),
        limit=analysis.limit,
        harmonics=settings.harmonics,
        accuracy=settings.accuracy,
        samples=settings.samples,
        modal_damping_ratio=case.damping.modal_damping_ratio,
        update=settings.update,
        newton=NewtonSettings(tolerance=settings.tolerance),
        threads=threads,
        continuation=None,
        progress=lambda fraction, detail: listener.update("Nonlinear mode", fraction, detail),
    )


def _estimate(
    case: Case, model: ReducedModel, analysis: ModeAnalysis, first: FirstMotion, listener: Progress, threads: int | None
) -> QuasiStaticMode:
    """The quasi-static estimate. Raises ConvergenceError."""
    listener.update("Quasi-static estimate", 0.0, "load steps in the shape of the mode")
    estimate = unreported_estimate(
        model.superelement,
        model.pairs,
        analysis.mode,
        _modal_amplitudes(analysis, first),
        POINTS_PER_DECADE,
        case.damping.modal_damping_ratio,
        threads,
    )
    listener.update("Quasi-static estimate", 1.0, f"{estimate.modal_amplitude.size} points")
    return estimate


def _modal_amplitudes(analysis: ModeAnalysis, first: FirstMotion) -> tuple[float, float]:
    """(lowest, highest) modal amplitude, m kg^0.5."""
    return analysis.smallest_amplitude / first.in_mode, analysis.largest_amplitude / first.in_mode
