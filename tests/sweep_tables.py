"""Tables of sweeps made by hand, for tests of tables and pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stickslip.reporting.sweep_view import SweepView
from stickslip.results.sweep_table import SweepCurve, SweepRow, SweepTable, SweptKey


def load_key(loads: tuple[float, ...]) -> SweptKey:
    labels = tuple(f"{load:g} N" for load in loads)
    return SweptKey("preload.centrifugal_force", "N", loads, loads, "N", labels)


MODE = SweptKey("excitation.mode", "", ("single", "same"), (), "", ("single", "same"))
FORCE = SweptKey("excitation.amplitude", "N", (50.0, 100.0), (50.0, 100.0), "N", ("50 N", "100 N"))


def sweep_view(
    keys: tuple[SweptKey, ...],
    peaks: Sequence[float | None],
    at_end: tuple[int, ...] = (),
    force_n: list[float] | None = None,
    points: int = 41,
    limits: Mapping[str, list[float]] | None = None,
    viscous_energy_j: float = 1e-3,
) -> SweepView:
    """A view whose row ``i`` has the peak ``peaks[i]`` in m (None: a case that failed) at 460 + i Hz.

    ``limits``: linear peaks of each row in m as "stuck", "free"; by default all stuck ones are 0.2 mm, none is free.
    """
    linear = limits or {"stuck": [2e-4] * len(peaks)}
    sizes = [len(key.values) for key in keys]
    rows: list[SweepRow] = []
    curves: list[SweepCurve | None] = []
    for place, peak in enumerate(peaks):
        chosen = np.unravel_index(place, sizes)
        values = tuple(key.values[i] for key, i in zip(keys, chosen, strict=True))
        if peak is None:
            rows.append(SweepRow(f"case-{place}", values, False, "No <first> point.", {}))
            curves.append(None)
            continue
        frequency = np.linspace(440.0, 480.0, points)
        measures = {
            "peak_amplitude_m": peak,
            "peak_frequency_hz": 460.0 + place,
            "peak_bracketed": 0.0 if place in at_end else 1.0,
            "viscous_energy_j": viscous_energy_j,
            "pairs_stuck": 3.0,
        }
        measures |= {f"{limit}_peak_amplitude_m": heights[place] for limit, heights in linear.items()}
        rows.append(SweepRow(f"case-{place}", values, True, "Done.", measures, ("Too few samples.",), f"{place}.nc"))
        curves.append(
            SweepCurve(
                frequency,
                peak / np.hypot(1.0, frequency - 460.0 - place),
                np.ones(frequency.size, bool),
                np.zeros(frequency.size, int),
            )
        )
    force = np.full(len(peaks), 50.0) if force_n is None else np.array(force_n)
    return SweepView(SweepTable(keys, tuple(rows)), tuple(curves), force)
