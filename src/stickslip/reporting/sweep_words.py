"""Slow sweeps along a curve, in words for its page."""

from __future__ import annotations

from collections.abc import Iterator

from stickslip.core.shown_numbers import MICRO, number
from stickslip.reporting.style import shown_number
from stickslip.reporting.view import View


def sweep_words(view: View) -> str:
    """Which parts are stable, where slow sweeps jump, and where they leave the curve."""
    return " ".join(_sentences(view))


def _sentences(view: View) -> Iterator[str]:
    response = view.response
    yield response.stability_message
    if not response.stable_points.all():
        known = "Solid parts are stable, dashed parts unstable"
        unknown = "Dashed parts run back between two folds, so they are unstable"
        yield f"{unknown if response.stable is None else known}: no test stays on them."
    for jump in view.summary.notable_jumps:
        before, after = (number(MICRO * amplitude) for amplitude in (jump.amplitude_from, jump.amplitude_to))
        yield f"A slow sweep {jump.direction} jumps at {_hertz(jump.frequency_hz)} from {before} to {after} µm."
    for sweep in view.slow_sweeps:
        slow = f"A slow sweep {sweep.direction}"
        if sweep.leaves_at_hz is not None:
            yield f"{slow} leaves the computed curve at {_hertz(sweep.leaves_at_hz)}, so its peak may be higher."
        for first, last in sweep.gaps_hz:
            yield f"{slow} finds no stable point of the curve from {_hertz(first)} to {_hertz(last)}."


def _hertz(frequency: float) -> str:
    return f"{shown_number(frequency, 'Hz')} Hz"
