"""The nodal-diameter diagram of a disk, and the line of all engine orders at a speed (SAFE diagram)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, VERMILLION, one_panel
from stickslip.core.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def nodal_diameter_figure(
    frequencies: Mapping[int, FloatArray],
    sectors: int,
    speed_rpm: float | None,
    other: Mapping[int, FloatArray] | None = None,
) -> Figure:
    """Natural frequencies (count,) Hz of each nodal diameter; lines connect those of one number from below.

    With Coriolis forces ``frequencies`` are those of forward waves, and ``other`` those of backward ones.

    With a speed a line shows the frequency ``engine order x speed`` at the nodal diameter that this engine order
    excites: it turns back at N / 2 and at 0. A resonance is possible where it meets a natural frequency.
    """
    figure, axes = one_panel(7.0, 4.5)
    diameters = np.array(sorted(frequencies))
    tables = [frequencies] if other is None else [frequencies, other]
    names = ["natural frequency"] if other is None else ["forward wave", "backward wave"]
    top = 0.0
    for table, dash, name in zip(tables, ("-", ":"), names, strict=False):
        rows = np.array([table[diameter] for diameter in diameters])
        top = max(top, 1.08 * float(rows.max()))
        for number, row in enumerate(rows.T):
            label = name if number == 0 else None
            axes.plot(diameters, row, dash, color=BLUE, marker="o", markersize=4.0, linewidth=1.0, label=label)
    if speed_rpm is not None:
        orders = np.arange(int(top / (speed_rpm / 60.0)) + 2)
        # The corners of the line are at multiples of N / 2, which an odd N does not have as a nodal diameter.
        place = np.abs((orders + sectors / 2.0) % sectors - sectors / 2.0)
        axes.plot(place, orders * speed_rpm / 60.0, color=VERMILLION, marker="s", markersize=3.0, linewidth=1.0,
                  linestyle="--", label=f"engine orders at {speed_rpm:g} rpm")  # fmt: skip
    axes.set_xlim(-0.3, max(sectors // 2, 1) + 0.3)
    axes.set_ylim(0.0, top)
    axes.set_xlabel(f"Nodal diameter of {sectors} sectors")
    axes.set_ylabel("Frequency, Hz")
    axes.locator_params(axis="x", integer=True)
    axes.tick_params(colors=INK)
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3)
    return figure
