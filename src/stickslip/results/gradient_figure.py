"""The plain tornado plot of gradients, for publications and notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, ORANGE, one_panel
from stickslip.core.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def tornado_figure(names: Sequence[str], percent: FloatArray, change_percent: float) -> Figure:
    """Bars to both sides of zero: ``percent`` (k,) is the change of the amplitude by an increase of each parameter."""
    figure, axes = one_panel(7.0, 1.2 + 0.3 * len(names))
    places = np.arange(len(names))[::-1]
    for sign, colour, hatch in ((1.0, BLUE, ""), (-1.0, ORANGE, "///")):
        label = f"{'+' if sign > 0 else '−'}{change_percent:g} %"
        axes.barh(places, sign * percent, color=colour, hatch=hatch, edgecolor=INK, linewidth=0.5, label=label)
    axes.axvline(0.0, color=INK, linewidth=1.0)
    axes.set_yticks(places, names)
    axes.set_xlabel("Change of the peak amplitude, %, first order")
    axes.legend(frameon=False, title="Change of the input")
    return figure
