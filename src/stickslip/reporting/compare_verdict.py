"""The answer of a comparison in plain words: which peak is lowest, by how much, and which inputs differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from stickslip.core.shown_numbers import length, number
from stickslip.reporting.style import shown_number
from stickslip.results.comparison import Compared

_MOST_PERCENT = 200.0  # chosen: above it a factor is easier to read
_MOST_KEYS = 5  # chosen: named in a sentence; the table below has all
_SAME_PERCENT = 0.5  # chosen: peaks that are nearer than this are the same in words, as on the page of a run


def compare_verdict(
    compared: Sequence[Compared], measures: Sequence[Mapping[str, float]], inputs: Mapping[str, object]
) -> tuple[str, ...]:
    """Sentences on results with these measures, whose ``inputs`` differ."""
    return (*_ranking(compared, measures), *_inputs(inputs))


def _ranking(compared: Sequence[Compared], measures: Sequence[Mapping[str, float]]) -> Iterator[str]:
    if len({each.study.response_output for each in compared}) > 1:
        yield "The results have different responses, so their peaks have no order."
        return
    ranked = [
        (each["peak_amplitude_m"], each["peak_frequency_hz"], place)
        for place, each in enumerate(measures)
        if compared[place].response.converged and each["peak_bracketed"] == 1.0
    ]
    unknown = [each.name for place, each in enumerate(compared) if place not in {at for _, _, at in ranked}]
    if len(ranked) > 1:
        ranked.sort()
        lowest, highest = ranked[0], ranked[-1]
        more = 100.0 * (highest[0] / lowest[0] - 1.0)
        if more < _SAME_PERCENT:
            yield f"All peaks are equal within {number(_SAME_PERCENT)} %: {_peak(lowest)}."
        else:
            times = f"{number(1.0 + more / 100.0, 2)} times as high"
            yield (
                f"The lowest peak is that of {compared[lowest[2]].name}: {_peak(lowest)}. The highest one, "
                f"{compared[highest[2]].name}, is {f'{number(more, 2)} % higher' if more < _MOST_PERCENT else times}: "
                f"{_peak(highest)}."
            )
    if unknown:
        yield (
            f"Without a rank: {'; '.join(unknown)}. The curve is not complete or its largest amplitude is at an end of "
            "the range, so the true peak may be higher."
        )


def _peak(ranked: tuple[float, float, int]) -> str:
    amplitude, frequency_hz, _ = ranked
    return f"{' '.join(length(amplitude))} at {shown_number(frequency_hz, 'Hz')} Hz"


def _inputs(inputs: Mapping[str, object]) -> Iterator[str]:
    if not inputs:
        yield "The inputs are the same."
        return
    keys = list(inputs)
    more = f" and {len(keys) - _MOST_KEYS} more" if len(keys) > _MOST_KEYS else ""
    yield f"{len(keys)} input{'s differ' if len(keys) > 1 else ' differs'}: {', '.join(keys[:_MOST_KEYS])}{more}."
    if any(key == "excitation.amplitude" or key.startswith("forces.") for key in keys):
        yield "The excitation differs too, so a lower peak does not follow from the joint alone."
