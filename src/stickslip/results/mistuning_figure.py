"""The plain figure of a mistuned disk, for publications and notebooks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, ORANGE, VERMILLION, blank_figure, plain_axes
from stickslip.core.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = {"contacts stuck": BLUE, "no contact": ORANGE, "friction": INK}


def exceedance(factors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Factors (n,), rising, and the fraction of patterns with at least each of them."""
    return np.sort(factors), 1.0 - np.arange(factors.size) / factors.size


def mistuning_figure(patterns: Mapping[str, FloatArray], blades: Mapping[str, FloatArray], limit: float) -> Figure:
    """Fraction of patterns above a factor with Whitehead's limit, and the factor of each blade of one pattern."""
    figure = blank_figure(6.5, 6.5)
    above, below = (plain_axes(axes) for axes in figure.subplots(2, 1))
    for name, factors in patterns.items():
        above.step(*exceedance(factors), where="post", color=_COLOURS[name], label=name)
    above.axvline(limit, color=VERMILLION, linestyle="--", label="Whitehead's limit")
    above.set_xlabel("Amplification factor")
    above.set_ylabel("Fraction of patterns above it")
    above.legend(frameon=False)
    for name, factors in blades.items():
        below.plot(np.arange(1, factors.size + 1), factors, ".-", color=_COLOURS[name], label=name)
    below.axhline(1.0, color=INK, linewidth=0.6)
    below.set_xlabel("Blade")
    below.set_ylabel("Amplification factor")
    below.legend(frameon=False)
    return figure
