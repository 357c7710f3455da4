"""Residual tractions on the page: how far the curve can move with them, in words and as lines."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from stickslip.core.plain_figure import GREY
from stickslip.core.shown_numbers import MICRO, number
from stickslip.reporting.look import PlotMarkup, line_trace
from stickslip.reporting.section import Section
from stickslip.reporting.style import shown_number
from stickslip.reporting.view import View
from stickslip.results.curve_figure import TRACTION_CURVES
from stickslip.results.traction_band import TractionBand

_WHY = (
    "Statics does not determine the tractions of friction at rest, and a pair retains its own until it slips: this "
    "curve is one of a continuum."
)
_NOT_COMPUTED = (
    "How far peak and jumps can move with them was not computed, because it requires several further curves: use "
    "stickslip run --traction-band, or set traction_band = true in [analysis] of the study file."
)
_LIMITS = (
    "Each of these curves is a solution, so the true range is at least as wide. It can be wider, because the tractions "
    "are the extreme ones to first order and those of a local optimisation, within the friction limit of each pair at "
    "rest and with the same normal loads. Tractions that vibration leaves in stuck pairs on the way from one frequency "
    "to another are not among them, and peaks outside of the computed part are not either."
)
_NOT_OF_A_SECTOR = "How far peak and jumps can move with them is not computed for a sector of a disk."
# chosen: local extremes within this fraction of the farthest one agree with it.
SAME = 0.01


def traction_lines(view: View) -> Iterator[dict[str, Any]]:
    """A thin line for each curve with other tractions, all under one name of the legend."""
    band = view.response.traction_band
    if band is None:
        return
    for place, curve in enumerate(band.curves(view.output)):
        words = PlotMarkup("{}: {}<br>%{{x:.2f}} Hz<br>%{{y:.4g}} µm<extra></extra>").format(
            TRACTION_CURVES, curve.name
        )
        yield line_trace(
            TRACTION_CURVES,
            curve.frequency_hz,
            MICRO * curve.amplitude,
            GREY,
            width=1.0,
            legendgroup=TRACTION_CURVES,
            showlegend=not place,
            hovertemplate=words,
        )


def _sentences(view: View) -> Iterator[str]:
    band = view.response.traction_band
    yield _WHY
    if band is None:
        yield _NOT_COMPUTED if view.study.disk is None else _NOT_OF_A_SECTOR
        return
    yield from _ranges(view, band)
    yield from _starts(band)
    early = int((~band.complete).sum())
    if early:
        yield f"{early} of the curves end early, so the range may be too narrow."
    yield _LIMITS


def _ranges(view: View, band: TractionBand) -> Iterator[str]:
    measures, low, high = view.summary, band.frequency_hz.min(), band.frequency_hz.max()
    assert measures.traction_peaks is not None  # the summary has it with a band
    least, most = (number(MICRO * value) for value in measures.traction_peaks)
    yield (
        f"Over this curve and {band.n_curves} with extreme tractions at rest, from {shown_number(low, 'Hz')} to "
        f"{shown_number(high, 'Hz')} Hz, the highest peak is {least} to {most} µm (this curve: "
        f"{number(MICRO * measures.peak.amplitude)} µm)."
    )
    for direction, places in (("up", measures.traction_jumps_up_hz), ("down", measures.traction_jumps_down_hz)):
        if places is not None:
            first, last = (shown_number(place, "Hz") for place in places)
            yield f"The largest jump of a slow sweep {direction} is at {first} to {last} Hz."


def _starts(band: TractionBand) -> Iterator[str]:
    """The number of starts of the optimisation that agree."""
    for values, name, best_of in ((band.raised_peaks, "highest", max), (band.lowered_peaks, "lowest", min)):
        if values is not None:
            best = best_of(values.tolist())
            same = int((abs(values - best) <= SAME * best).sum())
            yield (
                f"Of {values.size} optimisations of the tractions for the {name} peak, {same} reached "
                f"{number(MICRO * best)} µm within {100 * SAME:g} %."
            )


def _applies(view: View) -> bool:
    """Whether a pair has a residual traction that statics does not determine."""
    return bool(view.response.pairs.largest_slip_force.any()) and "coulomb" in view.response.pairs.law_names


TRACTIONS = Section(
    "Residual tractions",
    """<p class="note">{{ words }}</p>""",
    lambda view: {"words": " ".join(_sentences(view))},
    applies=_applies,
)
