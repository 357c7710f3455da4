"""Analyses of a model: one function for each kind of [analysis], and the choice among them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from stickslip.case.analysis import AnalysisSection, ForcedAnalysis, ModeAnalysis, RidgeAnalysis, WearAnalysis
from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError
from stickslip.core.progress import Progress, SilentProgress
from stickslip.core.resolution import LEAST_SAMPLES, SAMPLES_PER_HARMONIC
from stickslip.model.model import ReducedModel
from stickslip.results.record import run_provenance
from stickslip.results.response import ForcedResponse
from stickslip.results.sweep_table import Again
from stickslip.solve.forced import unreported_response
from stickslip.solve.other_solutions import search_other_solutions
from stickslip.solve.partial_joint import partial_response
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.transient.integrate import check_integration
from stickslip.study.mistuning import with_mistuning
from stickslip.study.mode import allowed_mode
from stickslip.study.nonlinear_mode import with_mode
from stickslip.study.ridge import unreported_ridge
from stickslip.study.wear import wear_of_study, worn_faces

# chosen: points of the curve of one of many cases, and with them its work, 2100 iterations. The default study takes 106
# points and 340 iterations, with a light damper in gross slip 122 and 1112.
MOST_POINTS = 300

# chosen: the tolerances of the balance of such a curve at its peaks and elsewhere, over the accuracy, and the largest
# residual with doubled samples at its peak, also over the accuracy (2e-3, that of all curves, for 2 %). Most points
# need one iteration then, whose linear solution and tangent need no more digits than these.
DIGITS, DIGITS_ELSEWHERE, SAMPLED_SHARE = 1e-4, 2e-2, 0.1
FINEST_STEP, TANGENT = 1e-5, 1e-2
# chosen: its longest step. With 0.2 in place of 0.14 the default case has 58 points, not 69, but as many iterations.
LONGEST_STEP = 0.2
# chosen: where its harmonics are too few, so many more follow, at most so often; a single case takes some three times
# as long.
MORE_HARMONICS, MOST_TRIES = 2, 2
# Entries of the settings of a response: why quick curves were no result, in words, and the kinds of these reasons.
SOLVED_AGAIN, AGAIN_BECAUSE = "solved_again", "solved_again_because"

Analyse = Callable[[Case, ReducedModel, Progress, int | None], ForcedResponse]


@dataclass(frozen=True)
class CurveNumbers:
    """The numbers of a curve in place of those of [solver]: harmonics instead of an accuracy, samples of a period,
    tolerance at the peaks and elsewhere, and largest step. Such a curve is checked at its peak only, and only the
    response output gets points at its maxima."""

    harmonics: int
    samples: int
    tolerance: float
    tolerance_elsewhere: float
    largest_step: float


def solve(
    case: Case,
    model: ReducedModel,
    progress: Progress | None = None,
    threads: int | None = None,
    checks: bool = True,
    harmonics: int | None = None,
) -> ForcedResponse:
    """The analysis of the case with its settings; the provenance has inputs and versions.

    Without ``checks`` this is only the curve of one of many cases, without multipliers and search for missed peaks. It
    ends with a message at ``MOST_POINTS``. With the ``harmonics`` that a similar case required, and an accuracy, it is
    first solved with these (:func:`sample_curve`). Raises ConvergenceError.
    """
    listener = progress or SilentProgress()
    if checks:
        response = _ANALYSES[type(case.analysis)](case, model, listener, threads)
        response = with_mistuning(case, model, response, listener, threads)
    else:
        response = sample_curve(case, model, listener, threads, harmonics)
    return replace(response, provenance={**response.provenance, **run_provenance()})


def sample_curve(
    case: Case, model: ReducedModel, listener: Progress, threads: int | None, harmonics: int | None = None
) -> ForcedResponse:
    """The curve of one of many cases, without checks of stability and missed peaks.

    With an accuracy and the ``harmonics`` that a similar case required, the whole curve has these, and no more samples
    and digits than the accuracy needs. It is the result if its estimated errors at the peak are within the accuracy.
    Where its harmonics or samples are too few, it follows again with more of them (:func:`_more_numbers`); else the
    curve is solved again as that of a single case. Raises ConvergenceError.
    """
    accuracy, reasons = case.solver.accuracy, list[tuple[Again, str]]()

    def reported(response: ForcedResponse) -> ForcedResponse:
        if not reasons:
            return response
        words = "; then ".join(sentence for _, sentence in reasons)
        because = ", ".join(kind for kind, _ in reasons)
        return replace(response, settings={**response.settings, SOLVED_AGAIN: words, AGAIN_BECAUSE: because})

    if accuracy is not None and harmonics is not None:
        numbers: CurveNumbers | None = _quick_numbers(case, accuracy, harmonics)
        while numbers is not None:
            try:
                quick = forced_curve(case, model, listener, threads, False, MOST_POINTS, numbers)
            except ConvergenceError as error:
                reasons.append((Again.EARLY, str(error)))
                break
            reason = _why_not(quick, accuracy)
            if reason is None:
                return reported(quick)
            reasons.append(reason)
            numbers = _more_numbers(case, numbers, [kind for kind, _ in reasons])
    return reported(forced_curve(case, model, listener, threads, checks=False, most_points=MOST_POINTS))


def again_because(settings: Mapping[str, str | float | int]) -> tuple[Again, ...]:
    """The reasons why the curve with these settings was solved again."""
    return tuple(Again(kind) for kind in str(settings.get(AGAIN_BECAUSE, "")).split(", ") if kind)


def _quick_numbers(case: Case, accuracy: float, harmonics: int) -> CurveNumbers:
    """The numbers of a curve whose points and interpolation are within the accuracy.

    Around a peak the motion is a chord of a circle: a step s, over the largest motion, is an angle s of the phase, and
    a straight line in its place is s^2 / 8 too low: an eighth of the accuracy for s = accuracy^0.5.
    """
    settings = case.solver
    least = max(LEAST_SAMPLES, SAMPLES_PER_HARMONIC * harmonics)
    return CurveNumbers(
        harmonics,
        min(settings.samples, max(least, settings.samples // 2)),
        max(settings.tolerance, DIGITS * accuracy),
        max(settings.tolerance, DIGITS_ELSEWHERE * accuracy),
        max(settings.largest_step, min(accuracy**0.5, LONGEST_STEP)),
    )


def _more_numbers(case: Case, numbers: CurveNumbers, reasons: Sequence[Again]) -> CurveNumbers | None:
    """The numbers of the next quick curve after one that has the last of the ``reasons``; None for no other one.

    ``MORE_HARMONICS`` more at most ``MOST_TRIES`` times, as far as the samples of [solver] resolve them, and all these
    samples.
    """
    samples, reason = case.solver.samples, reasons[-1]
    if reason is Again.SAMPLES and numbers.samples < samples:
        return replace(numbers, samples=samples)
    more = numbers.harmonics + MORE_HARMONICS
    least = SAMPLES_PER_HARMONIC * more
    if reason is Again.HARMONICS and reasons.count(reason) <= MOST_TRIES and least <= samples:
        return replace(numbers, harmonics=more, samples=max(least, numbers.samples))
    return None


def _why_not(response: ForcedResponse, accuracy: float) -> tuple[Again, str] | None:
    """The reason why a curve with few checks is no result, and its sentence; None if it is one."""
    if not response.converged:
        return Again.EARLY, response.message
    neglected = float(response.settings["error_by_neglected_harmonics"])
    sampled = float(response.settings["residual_with_doubled_samples"])
    if not neglected <= accuracy:
        return Again.HARMONICS, Again.HARMONICS.sentence(neglected)
    if not sampled <= SAMPLED_SHARE * accuracy:
        return Again.SAMPLES, Again.SAMPLES.sentence(sampled)
    return None


def forced_curve(
    case: Case,
    model: ReducedModel,
    listener: Progress,
    threads: int | None,
    checks: bool = True,
    most_points: int = ContinuationSettings.max_points,
    numbers: CurveNumbers | None = None,
) -> ForcedResponse:
    """The forced response over the window of [solver], ``checks`` as :func:`forced_response` has them, with at most so
    many points and the work of these; ``numbers`` replace those of [solver]."""
    settings, analysis = case.solver, case.analysis
    outputs = np.array(list(model.outputs.values()))
    compiling = "preparation; the first run on a machine compiles the friction law, which takes about a minute"
    listener.update("Response", 0.0, compiling)
    if analysis.search:
        check_integration(model.superelement, model.pairs)
    newton = NewtonSettings(tolerance=numbers.tolerance if numbers else settings.tolerance)
    few_digits = None
    if numbers is not None:
        few_digits = NewtonSettings(tolerance=numbers.tolerance_elsewhere, finest_step=FINEST_STEP, tangent=TANGENT)
    continuation = ContinuationSettings(
        largest_step=numbers.largest_step if numbers else settings.largest_step,
        smallest_step=settings.smallest_step,
        first_step=settings.first_step,
        max_points=most_points,
    )
    curve_of = partial(
        unreported_response,
        excitation=model.excitation,
        frequency_hz=(settings.frequency_start, settings.frequency_stop),
        harmonics=numbers.harmonics if numbers else settings.harmonics,
        accuracy=None if numbers else settings.accuracy,
        samples=numbers.samples if numbers else settings.samples,
        modal_damping_ratio=case.damping.modal_damping_ratio,
        update=settings.update,
        newton=newton,
        continuation=continuation,
        traction_band=next(iter(model.outputs.values())) if analysis.traction_band else None,
        traction_starts=analysis.traction_starts,
        outputs=outputs[:1] if numbers else outputs,
        checks=checks,
        few_digits=few_digits,
        threads=threads,
        progress=lambda fraction, detail: listener.update("Response", fraction, detail),
    )
    moving = model.reduced.moving
    if moving is not None:
        return partial_response(model.superelement, model.pairs, moving, curve_of)
    response = curve_of(model.substructure, model.pairs)
    if not analysis.search:
        return response
    return search_other_solutions(
        model.superelement,
        model.pairs,
        model.excitation,
        response,
        starts=analysis.search_starts,
        seed=analysis.search_seed,
        modal_damping_ratio=case.damping.modal_damping_ratio,
        newton=newton,
        continuation=continuation,
        threads=threads,
        progress=lambda fraction, detail: listener.update("Other solutions", fraction, detail),
    )


def _mode(case: Case, model: ReducedModel, listener: Progress, threads: int | None) -> ForcedResponse:
    """The forced response, and beside it the nonlinear mode. Raises InputError for a mode or amplitudes that
    :func:`allowed_mode` rejects."""
    first = allowed_mode(case, model)
    return with_mode(case, model, forced_curve(case, model, listener, threads), first, listener, threads)


def _ridge(case: Case, model: ReducedModel, listener: Progress, threads: int | None) -> ForcedResponse:
    """The forced response, and beside it the ridge of peaks, whose key and range were checked with the structure."""
    analysis = case.analysis
    assert isinstance(analysis, RidgeAnalysis)
    limits = analysis.over_from, analysis.over_to
    response = forced_curve(case, model, listener, threads)
    try:
        peaks = unreported_ridge(case, analysis.over, limits, response.harmonics, model, listener, threads)
    except ConvergenceError as error:  # the response is a result without it
        return replace(response, warnings=(*response.warnings, f"The ridge of peaks was not computed: {error}"))
    return replace(response, peak_ridge=peaks)


def _wear(case: Case, model: ReducedModel, listener: Progress, threads: int | None) -> ForcedResponse:
    """The forced response, and beside it the wear of the joint. Raises InputError for a joint that cannot wear."""
    worn_faces(case, model.joint)
    response = forced_curve(case, model, listener, threads)
    try:
        worn = wear_of_study(case, model, response, listener, threads)
    except ConvergenceError as error:  # the response is a result without it
        return replace(response, warnings=(*response.warnings, f"The wear was not computed: {error}"))
    return replace(response, wear=worn)


# Class of the section [analysis] -> function that computes it.
_ANALYSES: dict[type[AnalysisSection], Analyse] = {
    ForcedAnalysis: forced_curve,
    ModeAnalysis: _mode,
    RidgeAnalysis: _ridge,
    WearAnalysis: _wear,
}
