"""Figures of a disk of which one sector was solved: nodal-diameter diagram, and the deflected disk at the peak."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from stickslip.core.shown_numbers import MICRO
from stickslip.reporting.structure_still import Paint, structure_figure
from stickslip.results.measures import summary
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.structure.nodal_diameter_figure import nodal_diameter_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DEFLECTION = 0.06  # chosen: largest displacement in the picture, of the size of the disk


def disk_figures(response: ForcedResponse, study: StudyRecord) -> dict[str, Figure]:
    """Name -> figure; empty for any other structure."""
    if study.disk is None:
        return {}
    disk = study.disk
    peak_hz = summary(response, study.outputs[study.response_output]).peak.frequency_hz
    frequencies = dict(zip(disk.diameters.tolist(), disk.stuck_hz, strict=True))
    speed_rpm = float(round(60.0 * peak_hz / disk.engine_order)) if disk.engine_order else None
    drawn = {"nodal_diameters": nodal_diameter_figure(frequencies, disk.sectors, speed_rpm)}
    if study.sketch is not None and study.sketch.motion is not None:
        drawn["disk"] = _deflected(study)
    return drawn


def _deflected(study: StudyRecord) -> Figure:
    """All sectors at one instant of the period at the peak, without the mean; the colour is the displacement."""
    sketch = study.sketch
    assert sketch is not None
    assert sketch.motion is not None
    size = float(np.ptp(sketch.points, axis=0).max())
    motion = sketch.motion.points[:, :, 1::2].sum(axis=2).astype(float)  # the instant t = 0
    moved = np.linalg.norm(motion, axis=1)
    scale = _DEFLECTION * size / float(moved.max()) if moved.any() else 1.0
    shape = replace(sketch, points=sketch.points + scale * motion)
    words = f"Displacement at one instant, µm; shown × {float(f'{scale:.2g}'):g}"
    figure = structure_figure(study, shape, Paint(MICRO * moved, words))
    for collection in figure.axes[0].collections[:1]:
        collection.set_rasterized(True)  # the thousands of sides
    return figure
