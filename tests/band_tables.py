"""Samples of a band made by hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip.results.band import STRESS_MEASURES, TractionRange, limit_of, wants_stress
from stickslip.results.band_statistics import BandStatistics
from stickslip.results.influence import Coordinate
from stickslip.results.sweep_table import SweepCurve, SweepRow, SweepTable, SweptKey

FORCE_TEXT = ("excitation.amplitude", "1 N .. 3 N", "uniform", "1 N to 3 N")


def band_table(peaks: Sequence[float | None], at_end: tuple[int, ...] = (), with_stress: bool = False) -> SweepTable:
    """Samples with these peaks in m (None: failed) at 460 Hz, proportional to a force of as many N; stresses of 2 and
    1 MPa for each um."""
    forces = tuple(1.0 if peak is None else peak for peak in peaks)
    key = SweptKey("excitation.amplitude", "N", forces, forces, "N", tuple(f"{force:g} N" for force in forces))
    rows = []
    for place, (peak, force) in enumerate(zip(peaks, forces, strict=True)):
        if peak is None:
            rows.append(SweepRow(f"case-{place}", (force,), False, "No <first> point.", {}))
            continue
        measures = {f"{way}peak_amplitude_m": peak for way in ("", "upward_", "downward_")}
        measures |= {f"{way}peak_frequency_hz": 460.0 for way in ("", "upward_", "downward_")}
        if with_stress:
            measures |= {"stress_pa": 2e12 * peak, "alternating_stress_pa": 1e12 * peak}
        measures["peak_bracketed"] = 0.0 if place in at_end else 1.0
        rows.append(SweepRow(f"case-{place}", (force,), True, "Done.", measures, file=f"{place}.nc"))
    further = {each.column: (each.unit, each.words) for each in STRESS_MEASURES.values()} if with_stress else {}
    return SweepTable((key,), tuple(rows), further)


def band_statistics(
    peaks: Sequence[float | None],
    limits: Sequence[str] = (),
    at_end: tuple[int, ...] = (),
    tractions: TractionRange | str | None = None,
) -> BandStatistics:
    """Their statistics, with curves of one resonance at 460 Hz."""
    required = [limit_of(text) for text in limits]
    table = band_table(peaks, at_end, wants_stress(required))
    frequency = np.linspace(440.0, 480.0, 81)
    curves = tuple(
        None
        if peak is None
        else SweepCurve(frequency, peak / np.hypot(1.0, frequency - 460.0), np.ones(81, bool), np.zeros(81, int))
        for peak in peaks
    )
    nodes, weights = np.polynomial.legendre.leggauss(16)
    forces = np.array(table.keys[0].shown)
    middle, half = 0.5 * (forces.max() + forces.min()), 0.5 * np.ptp(forces) or 1.0
    coordinate = Coordinate("excitation.amplitude", (forces - middle) / half, nodes, 0.5 * weights)
    return BandStatistics.of(table, curves, [FORCE_TEXT], [coordinate], required, tractions)
