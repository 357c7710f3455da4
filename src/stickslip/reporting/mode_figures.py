"""Energies of a nonlinear mode against its amplitude, and pictures of its shapes, for its section of the page."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, ORANGE
from stickslip.core.shown_numbers import number, typeset
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import Figure, PlotMarkup, axis_look, figure_of, line_trace, log_axis
from stickslip.reporting.structure_still import Paint, Views, still_picture
from stickslip.reporting.structure_view import Extent, best_camera
from stickslip.reporting.view import View
from stickslip.results.mode_figure import MODAL_AMPLITUDE
from stickslip.results.mode_shapes import ModeShapes
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.record import StudyRecord

_DEFLECTION = 0.08  # chosen: largest displacement in a picture, of the diagonal of the structure
_LEAST_SHARE = 1e-6  # chosen: of the supplied energy; round-off and less would only lengthen the axis

_NO_MARKS: dict[str, Any] = {
    "load_names": (),
    "load_places": np.empty((0, 3)),
    "loads": np.empty((0, 3)),
    "constant": np.empty(0, dtype=bool),
    "response_names": (),
    "response_places": np.empty((0, 3)),
}


def energies_of_mode(mode: NonlinearMode) -> Figure:
    """Energy per cycle against modal amplitude: supplied, and dissipated by friction of all pairs and viscously."""
    parts = (
        ("supplied", mode.input_energy, INK, "solid"),
        ("friction, all pairs", mode.dissipated_energy.sum(axis=1), ORANGE, "dash"),
        ("viscous damping", mode.viscous_energy, BLUE, "dot"),
    )
    drawn = {name: energy >= _LEAST_SHARE * mode.input_energy for name, energy, _, _ in parts}
    traces = [
        line_trace(
            name, mode.modal_amplitude[drawn[name]], energy[drawn[name]], colour, dash,
            hovertemplate=PlotMarkup("{}: %{{y:.3g}} J").format(name),
        )
        for name, energy, colour, dash in parts
        if drawn[name].any()
    ]  # fmt: skip
    shown = np.concatenate([energy[drawn[name]] for name, energy, _, _ in parts])
    return figure_of(
        traces,
        320,
        xaxis=log_axis(MODAL_AMPLITUDE, mode.modal_amplitude),
        yaxis=log_axis("Energy per cycle, J", shown) if shown.size else axis_look("Energy per cycle, J"),
        hovermode="x unified",
    )


@dataclass(frozen=True)
class ShapePicture:
    """A PNG in base64 of the structure in a shape of the mode, and the words below it."""

    words: str
    png: str


def shape_words(mode: NonlinearMode) -> str:
    """Sentences on the pictures, with how far the shape changes between them."""
    ends = [int(mode.modal_amplitude.argmin()), int(mode.modal_amplitude.argmax())]
    macs = [mac[:, mac.max(axis=0).argmax()][ends] for mac in (mode.stuck_mac, mode.sliding_mac)]
    changes = " and ".join(
        f"with {name} it is {first:.3f} and {last:.3f}"
        for (name, _), (first, last) in zip(mode.closest_linear_modes, macs, strict=True)
    )
    return (
        "The shape is that of the first harmonic at the instant of its largest motion. Both pictures have the same "
        f"largest displacement. The MAC at the smallest and at the largest amplitude, with mass: {changes}."
    )


def shape_pictures(view: View) -> list[ShapePicture]:
    """The shapes at the smallest and at the largest amplitude; none for matrices, and results of older versions."""
    sketch = view.study.sketch
    if sketch is None or sketch.mode_shapes is None:
        return []
    return list(_pictures(view.study, sketch.mode_shapes))


def _pictures(study: StudyRecord, shapes: ModeShapes) -> Iterator[ShapePicture]:
    """Both have one view, in which the structure moves to both sides, and no marks, which would remain at rest."""
    sketch = study.sketch
    assert sketch is not None  # it has the shapes
    reach = _DEFLECTION * float(np.linalg.norm(np.ptp(sketch.points, axis=0)))
    around = Extent.around(sketch.points)
    views = Views(best_camera(sketch), Extent(around.middle, around.size + 2.0 * reach), None)
    bare = replace(sketch, motion=None, **_NO_MARKS)
    for end, displacement, amplitude in zip(
        ("smallest", "largest"), shapes.displacement.astype(float), shapes.modal_amplitude, strict=True
    ):
        moved: FloatArray = np.linalg.norm(displacement, axis=1)
        largest = float(moved.max()) or 1.0
        deflected = replace(bare, points=sketch.points + reach / largest * displacement)
        paint = Paint(moved / largest, "Displacement over the largest one")
        picture = base64.b64encode(still_picture(study, deflected, paint, views)).decode("ascii")
        yield ShapePicture(typeset(f"At the {end} modal amplitude, {number(amplitude)} m kg^0.5"), picture)
