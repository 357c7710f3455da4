"""The answers of the analyses beside the frequency curve, one sentence each, for the words at the top of the page."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from stickslip.core.shown_numbers import MICRO, length, number, raised
from stickslip.core.validation import FloatArray
from stickslip.reporting.estimate_section import ESTIMATE_ALONE
from stickslip.reporting.mode_section import NONLINEAR_MODE
from stickslip.reporting.view import View
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.quasi_static_mode import QuasiStaticMode

_BESIDE, _MUCH_HIGHER = 1.25, 1.5  # chosen: factors of a value that a machine may miss, and of a peak that matters
_SAME_PLACE = 0.02  # chosen: a check is at the minimum itself, or beside it by the distance of two points


def further_answers(view: View) -> Iterator[str]:
    """What the performance curve, peaks over a key, a nonlinear mode, wear and mistuning say; nothing without them."""
    yield from _best_load(view)
    yield from _best_key(view)
    yield from _mode(view)
    yield from _wear(view)
    yield from _mistuning(view)


def _best_load(view: View) -> Iterator[str]:
    ridge = view.response.performance_curve
    if ridge is None:
        return
    force = float(ridge.settings["excitation_force_n"])
    yield from _lowest(
        ridge,
        "the centrifugal force of the damper",
        lambda ratio: f"{number(force * ratio, 3)} N",
        f"; this study has {number(float(ridge.settings['centrifugal_force_n']), 3)} N",
    )


def _best_key(view: View) -> Iterator[str]:
    ridge = view.response.peak_ridge
    if ridge is not None:
        unit = ridge.parameter_unit
        yield from _lowest(ridge, ridge.parameter_name, lambda value: f"{number(value, 4)} {unit}".rstrip(), "")


def _lowest(ridge: PeakRidge, name: str, named: Callable[[float], str], more: str) -> Iterator[str]:
    """The lowest of the highest peaks at which pairs slip, or that there is none; a checked one where there is one."""
    best = ridge.slipping_minimum
    if best is None:
        yield f"Over {name} no minimum of the highest peak has slip inside of the followed range{more}."
        return
    near = [each for each in ridge.checked if abs(each.parameter / best.parameter - 1.0) < _SAME_PLACE]
    lowest, checked = (near[0].amplitude, ", checked by a whole curve") if near else (best.amplitude, "")
    yield (
        f"Over {name} the highest peak has its lowest minimum with slip at {named(best.parameter)}: "
        f"{' '.join(length(lowest))}{checked}{more}.{_beside(ridge, best.parameter, lowest, named)}"
    )


def _beside(ridge: PeakRidge, best: float, lowest: float, named: Callable[[float], str]) -> str:
    """A sentence if a value close to the best one has a much higher peak: no one meets a design exactly."""
    ends = float(ridge.parameter.min()), float(ridge.parameter.max())
    values = max(best / _BESIDE, ends[0]), min(best * _BESIDE, ends[1])
    beside = ridge.at(values)
    peaks = [(float(a), v) for a, v, known in zip(beside.amplitude, values, beside.ridge >= 0, strict=True) if known]
    highest, value = max(peaks, default=(0.0, best))
    if highest < _MUCH_HIGHER * lowest:
        return ""
    return f" It is sharp: {named(value)} has {' '.join(length(highest))}."


def _mode(view: View) -> Iterator[str]:
    mode, estimate = view.response.nonlinear_mode, view.response.quasi_static_mode
    if mode is not None:
        along = _along_mode(view, mode, mode.harmonic_amplitude(view.output, 1), "mode")
        yield f"{along}{_doubts(mode, NONLINEAR_MODE.heading)}."
    elif estimate is not None:
        along = _along_mode(view, estimate, estimate.amplitude(view.output), "by a quasi-static estimate, mode")
        yield f"{along}{_doubts(estimate, ESTIMATE_ALONE.heading)}."


def _along_mode(view: View, mode: NonlinearMode | QuasiStaticMode, output: FloatArray, name: str) -> str:
    """Frequency and damping ratio at both ends of a mode whose amplitudes of the ``output`` are in m, and a maximum of
    the damping ratio between them."""
    low, high = (number(MICRO * float(output[at]), 3) for at in (0, -1))
    percent = [number(100.0 * float(ratio), 3) for ratio in mode.damping_ratio]
    top = int(np.argmax(mode.damping_ratio))
    inside = percent[top] not in (percent[0], percent[-1])
    most = f", with a maximum of {percent[top]} % at {number(MICRO * float(output[top]), 3)} µm" if inside else ""
    return (
        f"From {low} to {high} µm of {view.study.response_output}, {name} {mode.mode} "
        f"{_course([f'{hertz:.2f}' for hertz in mode.frequency_hz], 'Hz')}, and its damping ratio "
        f"{_course(percent, '%')}{most}"
    )


def _course(shown: list[str], unit: str) -> str:
    """What values along a mode do, as the sentence shows them."""
    if len(set(shown)) == 1:
        return f"remains constant at {shown[0]} {unit}"
    return f"goes from {shown[0]} to {shown[-1]} {unit}"


def _doubts(mode: NonlinearMode | QuasiStaticMode, heading: str) -> str:
    """A clause if a mode, shown in the section with this ``heading``, is not complete or has warnings."""
    clauses = [] if mode.converged else ["it is not complete"]
    if count := len(mode.warnings):
        clauses.append(f"section “{heading}” has {count} warning{'' if count == 1 else 's'} on it")
    return f"; {', and '.join(clauses)}" if clauses else ""


def _wear(view: View) -> Iterator[str]:
    wear = view.response.wear
    if wear is not None:
        change, depth = 100.0 * (wear.amplitude[-1] / wear.amplitude[0] - 1.0), MICRO * wear.depth[-1].max()
        yield raised(
            f"After {wear.cycles[-1]:.3g} cycles of wear, up to {depth:.3g} µm deep, the peak is "
            f"{MICRO * wear.amplitude[-1]:.4g} µm ({change:+.2g} %)."
        )


def _mistuning(view: View) -> Iterator[str]:
    result = view.response.mistuning
    if result is None:
        return
    factors = [f"{float(each.max()):.3g} at most ({words})" for words, each in result.limits.items()]
    if result.friction_factor is not None:
        factors.append(f"{float(result.friction_factor.max()):.3g} (with friction, pattern {result.shown + 1})")
    if factors:
        yield f"The amplification factor of the mistuned blades is {', '.join(factors)}."
