"""Mistuning of a study of a sector: amplification factors of the linear disk over patterns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stickslip.case.case import Case, CyclicCase
from stickslip.core.errors import InputError
from stickslip.core.progress import Progress
from stickslip.core.validation import FloatArray
from stickslip.model.kinds.mistuning import deviations, mistuning_words
from stickslip.model.model import ReducedModel
from stickslip.results.mistuning import LIMITS, Mistuning
from stickslip.results.response import ForcedResponse
from stickslip.solve.cyclic.amplification import Amplification, unreported_factors


def with_mistuning(case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress) -> ForcedResponse:
    """The response with the amplification factors of its [mistuning], if it has any. Raises InputError."""
    if not isinstance(case, CyclicCase) or case.mistuning is None:
        return response
    return replace(response, mistuning=_mistuning(case, model, response, progress))


def _mistuning(case: CyclicCase, model: ReducedModel, response: ForcedResponse, progress: Progress) -> Mistuning:
    section, sector, blade = case.mistuning, model.substructure.require_sector(), model.reduced.blade
    assert section is not None
    assert blade is not None  # the layout of a case with mistuning has its nodes
    patterns = deviations(section, sector.sectors)
    warnings: list[str] = []
    found: dict[str, FloatArray] = {}
    for name, words in LIMITS.items():
        try:
            factors = _factors(case, model, patterns, name == "stuck", progress)
        except InputError as error:
            if error.keys != ("frequency_hz",):
                raise
            warnings.append(f"No linear amplification factors, {words}: {error}")
            continue
        found |= {f"{name}_factor": factors.blade_factor, f"{name}_peak_hz": factors.peak_hz}
        if not factors.converged:
            warnings.append(f"Linear, {words}: {factors.message}")
    first = next(iter(found.values()), np.ones_like(patterns))
    return Mistuning(
        deviation=patterns,
        blade_alone_hz=blade.frequency_hz,
        shown=int(first.max(axis=1).argmax()),
        tuned_amplitude=response.amplitude(next(iter(model.outputs.values()))).max(),
        converged=True,
        message=f"{mistuning_words(section)}.",
        warnings=tuple(warnings),
        **found,
    )


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
