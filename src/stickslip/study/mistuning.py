"""Mistuning of a study of a sector: amplification factors of the linear disk over patterns, and with friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stickslip.case.case import Case, CyclicCase
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.progress import Progress
from stickslip.core.validation import FloatArray
from stickslip.model.kinds.mistuning import deviations, mistuning_words, unequal_dampers
from stickslip.model.model import ReducedModel
from stickslip.results.mistuning import LIMITS, Mistuning
from stickslip.results.response import ForcedResponse
from stickslip.solve.cyclic.amplification import Amplification, unreported_factors
from stickslip.solve.cyclic.mistuned_response import unreported_mistuned
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings


def with_mistuning(
    case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress, threads: int | None
) -> ForcedResponse:
    """The response with the amplification factors of its [mistuning], if it has any. Raises InputError."""
    if not isinstance(case, CyclicCase) or case.mistuning is None:
        return response
    result = _linear(case, model, response, progress)
    if case.mistuning.friction_curve:
        result = _with_friction(case, model, result, response.resolution_at().harmonics, progress, threads)
        tuned = response.amplitude(next(iter(model.outputs.values())))
        disks = {"mistuned": result.ring_amplitude, "tuned": tuned[:, None]}
        ends = [name for name, each in disks.items() if each is not None and is_highest_at_end(each)]
        if ends:
            words = (
                f"With friction, the {' and the '.join(ends)} disk move most at an end of the frequency range, so a "
                "higher amplitude may be outside: widen the range of [solver]."
            )
            result = replace(result, warnings=(*result.warnings, words))
    return replace(response, mistuning=result)


def _linear(case: CyclicCase, model: ReducedModel, response: ForcedResponse, progress: Progress) -> Mistuning:
    """The factors of both linear limits over all patterns."""
    section, sector, blade = case.mistuning, model.substructure.require_sector(), model.reduced.blade
    assert section is not None
    assert blade is not None  # the layout of a case with mistuning has its nodes
    patterns = deviations(section, sector.sectors)
    warnings: list[str] = []
    without: dict[str, str] = {}
    found: dict[str, FloatArray] = {}
    for name, words in LIMITS.items():
        try:
            factors = _factors(case, model, patterns, name == "stuck", progress)
        except InputError as error:
            if error.keys != ("frequency_hz",):
                raise
            without[words] = str(error)
            continue
        found |= {f"{name}_factor": factors.blade_factor, f"{name}_peak_hz": factors.peak_hz}
        if not factors.converged:
            warnings.append(f"Linear, {words}: {factors.message}")
    # The range of a joint that is closed has seldom a mode without contact: no reason for a warning.
    left_out = (
        "" if not found else "".join(f" No factors, {words}: no mode there is in the range." for words in without)
    )
    warnings += [f"No linear amplification factors, {words}: {why}" for words, why in without.items() if not found]
    first = next(iter(found.values()), np.ones_like(patterns))
    return Mistuning(
        deviation=patterns,
        blade_alone_hz=blade.frequency_hz,
        shown=int(first.max(axis=1).argmax()),
        tuned_amplitude=response.amplitude(next(iter(model.outputs.values()))).max(),
        converged=True,
        message=f"{mistuning_words(section)}.{left_out}",
        warnings=tuple(warnings),
        **found,
    )


def _with_friction(
    case: CyclicCase, model: ReducedModel, linear: Mistuning, harmonics: int, progress: Progress, threads: int | None
) -> Mistuning:
    """The curve of all sectors with friction for the shown pattern, over the range of [solver], beside the factors."""
    settings, ratio, blade = case.solver, case.damping.modal_damping_ratio, model.reduced.blade
    assert case.mistuning is not None
    assert ratio is not None
    assert blade is not None
    try:
        curve = unreported_mistuned(
            model.substructure.require_sector(),
            blade,
            linear.deviation[linear.shown],
            unequal_dampers(case.mistuning, model.pairs.with_update(settings.update)),
            model.excitation,
            next(iter(model.outputs.values())),
            frequency_hz=(settings.frequency_start, settings.frequency_stop),
            modal_damping_ratio=ratio,
            harmonics=harmonics,
            samples=settings.samples,
            newton=NewtonSettings(tolerance=settings.tolerance),
            continuation=ContinuationSettings(
                largest_step=settings.largest_step,
                smallest_step=settings.smallest_step,
                first_step=settings.first_step,
            ),
            threads=threads,
            progress=lambda fraction, detail: progress.update("Mistuned disk", fraction, detail),
        )
    except ConvergenceError as error:  # the factors of the linear disk are a result without it
        words = f"The mistuned disk with friction was not solved: {error}"
        return replace(linear, warnings=(*linear.warnings, words))
    return replace(
        linear,
        ring_hz=curve.frequency_hz,
        ring_amplitude=curve.amplitude,
        converged=curve.converged,
        message=f"{linear.message} With friction: {curve.message}",
        warnings=(*linear.warnings, *curve.warnings),
    )


def is_highest_at_end(amplitude: FloatArray) -> bool:
    """Whether the highest amplitude (n_points, N) of all is at the first or the last point."""
    return int(amplitude.max(axis=1).argmax()) in (0, len(amplitude) - 1)


def _factors(
    case: CyclicCase, model: ReducedModel, patterns: FloatArray, is_stuck: bool, progress: Progress
) -> Amplification:
    """The factors of a linear limit."""
    ratio, blade, settings = case.damping.modal_damping_ratio, model.reduced.blade, case.solver
    assert ratio is not None  # a case with mistuning has it
    assert blade is not None
    progress.update("Mistuning", 0.0 if is_stuck else 0.5, LIMITS["stuck" if is_stuck else "free"])
    return unreported_factors(
        model.substructure.require_sector(),
        blade,
        patterns,
        model.excitation,
        next(iter(model.outputs.values())),
        frequency_hz=(settings.frequency_start, settings.frequency_stop),
        modal_damping_ratio=ratio,
        pairs=model.pairs if is_stuck else None,
    )
