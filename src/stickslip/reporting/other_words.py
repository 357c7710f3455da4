"""Other solutions on the page: what a search looked for and found, in words and as lines."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.core.plain_figure import VERMILLION
from stickslip.core.shown_numbers import MICRO, number
from stickslip.reporting.look import PlotMarkup, broken_line
from stickslip.reporting.section import Section
from stickslip.reporting.view import View
from stickslip.results.curve_figure import OTHER_CURVES
from stickslip.results.sweeps_of_curve import unstable_steps

_LIMITS = (
    "A motion that attracts few states can be missed, and motions whose period is a multiple of that of the excitation "
    "are not looked for. Slow sweeps above follow the curve alone: whether a jump or a disturbance leads to one of "
    "these motions is not computed."
)


def other_lines(view: View) -> Iterator[dict[str, Any]]:
    """The curves that a search found, stable parts solid and unstable parts dashed, under one name of the legend."""
    others = view.response.other_solutions
    if others is None:
        return
    for place, curve in enumerate(others.curves(view.output)):
        words = PlotMarkup("{}: {}<br>%{{x:.2f}} Hz<br>%{{y:.4g}} µm<extra></extra>").format(OTHER_CURVES, curve.name)
        unstable = unstable_steps(curve.stable)
        for drawn, dash in ((~unstable, "solid"), (unstable, "dash")):
            yield broken_line(
                OTHER_CURVES,
                curve.frequency_hz,
                MICRO * curve.amplitude,
                drawn,
                VERMILLION,
                dash,
                2.0,
                legendgroup=OTHER_CURVES,
                showlegend=not place and dash == "solid",
                hovertemplate=words,
            )


def _words(view: View) -> Iterator[str]:
    others = view.response.other_solutions
    assert others is not None  # else the page has no such section
    words = others.words()
    yield f"{words[0].upper()}{words[1:]}."
    for curve in others.curves(view.output):
        top = int(np.argmax(curve.amplitude))
        yield (
            f"The largest amplitude on {curve.name} is {number(MICRO * float(curve.amplitude[top]))} µm at "
            f"{curve.frequency_hz[top]:.2f} Hz."
        )
    yield _LIMITS


OTHER_SOLUTIONS = Section(
    "Other solutions",
    """<p class="note">{{ words }}</p>""",
    lambda view: {"words": " ".join(_words(view))},
    applies=lambda view: view.response.other_solutions is not None,
)
