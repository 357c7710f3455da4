"""The answer of a run in plain words: what the joint does to the peak, by how much, and what limits trust in it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from stickslip.core.shown_numbers import length, number
from stickslip.reporting.further_answers import further_answers
from stickslip.reporting.style import shown_number
from stickslip.reporting.view import View
from stickslip.results.peaks import Peak

# chosen: a smaller change of the peak, as a fraction, is none in words.
NO_CHANGE = 0.005
# chosen: percent of the loss that friction must dissipate to be worth its number.
NO_FRICTION = 0.05


@dataclass(frozen=True)
class Verdict:
    """``sentences`` on the answer, and what ``limits`` trust in it; no limits are known if it is empty."""

    sentences: tuple[str, ...]
    limits: tuple[str, ...]


def verdict(view: View, warnings: int) -> Verdict:
    """The answer of a run, whose page shows a number of ``warnings``."""
    return Verdict((*_peak(view), _friction(view), *further_answers(view)), tuple(_limits(view, warnings)))


def _peak(view: View) -> Iterator[str]:
    measures, output = view.summary, view.study.response_output
    note = measures.caution(measures.peak)
    reduction, own = measures.reduction_from_stuck, _words(measures.peak)
    if reduction is None:
        yield f"The peak of {output} is {own}" + (f" ({note})." if note else ".")
    elif abs(reduction) < NO_CHANGE:
        yield f"The joint hardly changes the peak of {output}: {own}, as with all contacts stuck."
    else:
        change, causes = "lower" if reduction > 0.0 else "raise", _causes(view)
        cause = f"{' and '.join(causes).capitalize()} in the joint" if causes else "The joint"
        verb = change if len(causes) > 1 else f"{change}s"
        yield (
            f"{cause} {verb} the peak of {output} by {number(100.0 * abs(reduction), 2)} %: {own}, against "
            f"{_words(measures.stuck_peak)} with all contacts stuck."
        )
    if measures.reduction_from_free is not None:
        rise = -measures.reduction_from_free
        by = f": contact raises it by {number(100.0 * rise, 2)} %" if rise >= NO_CHANGE else ""
        yield f"Without contact it would be {_words(measures.free_peak)}{by}."


def _causes(view: View) -> list[str]:
    """What changes the peak: states that at least one pair has."""
    _, slipping, separating = view.summary.state_counts
    return [words for words, count in (("slip", slipping), ("separation", separating)) if count]


def _words(peak: Peak) -> str:
    return f"{' '.join(length(peak.amplitude))} at {shown_number(peak.frequency_hz, 'Hz')} Hz"


def _friction(view: View) -> str:
    measures = view.summary
    moving, count = sum(measures.state_counts[1:]), sum(measures.state_counts)
    percent = 100.0 * measures.friction_share
    if not moving:
        return f"None of the {count} contact pairs slips or separates at the peak: friction dissipates nothing."
    energy = "almost nothing" if percent < NO_FRICTION else f"{number(percent, 2)} %"
    pairs = f"{moving} of {count} contact pairs"
    return f"At the peak {pairs} slip or separate, and friction dissipates {energy} of the loss."


def _limits(view: View, warnings: int) -> Iterator[str]:
    response, measures = view.response, view.summary
    if not response.converged:
        yield "the curve is not complete, so a higher peak may be missing"
    elif not measures.peak.bracketed:
        yield "the largest amplitude is at an end of the range, so the true peak may be higher"
    if response.estimated_error is not None:
        error = 100.0 * float(response.estimated_error[measures.peak.point])
        yield f"the estimated error of the peak by neglected harmonics is {number(error, 2)} %"
    if measures.sweeps_differ:
        yield "a slow sweep up or down does not reach this peak"
    if response.stiffness_band is not None:
        yield "the contact stiffness was not measured"
    if warnings:
        yield "the warning below" if warnings == 1 else f"the {warnings} warnings below"
