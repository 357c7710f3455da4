"""The section of the page that shows the structure: the words around the picture that turns and the still one."""

from __future__ import annotations

import base64

import numpy as np

from stickslip.core.shown_numbers import MICRO, number
from stickslip.core.validation import FloatArray
from stickslip.reporting.section import Content, Section
from stickslip.reporting.structure_marks import of_first_sector
from stickslip.reporting.structure_picture import STRESS_WORDS, LegendEntry, StructurePicture, structure_picture
from stickslip.reporting.structure_still import still_picture
from stickslip.reporting.style import shown_number
from stickslip.reporting.templates import rendered
from stickslip.reporting.view import View
from stickslip.results.record import StudyRecord
from stickslip.results.sketch import Sketch

_NAMED_BODIES = 12


def _content(view: View) -> Content:
    """The picture with its legend and the words around it."""
    study = view.study
    assert study.sketch is not None  # the section applies only where there is one
    sketch = of_first_sector(study, study.sketch)
    picture = structure_picture(study, sketch)
    values = {
        "caption": _caption(sketch, picture, study.disk is not None),
        "legend": _legend(picture, len(sketch.body_names)),
        "deflection": _deflection(view, picture),
        "stresses": [] if sketch.stress is None else list(STRESS_WORDS.values()),
        "has_close_view": picture.has_close_view,
        "words": _words(study, sketch),
        "still": base64.b64encode(still_picture(study, sketch)).decode("ascii"),
    }
    return Content(rendered("structure.html", values), {"structure-data": picture.data})


def _caption(sketch: Sketch, picture: StructurePicture, is_disk: bool) -> str:
    words = ["All axes have one scale."]
    if is_disk:
        words.append("Contact faces and the directions t1 and t2 are those of the first sector.")
    if picture.has_glass:
        words.append("Bodies that would hide the contact are transparent.")
    if sketch.is_coarsened:
        words.append(
            f"The mesh has {sketch.mesh_sides} outer sides, too many for a page: the picture shows {len(sketch.sides)} "
            "coarser ones. mode_shapes.vtu of the run shows the complete mesh in ParaView."
        )
    return " ".join(words)


def _deflection(view: View, picture: StructurePicture) -> str:
    """The words below the deflected shape; empty if the motion is unknown."""
    shape = picture.deflection
    if shape is None:
        return ""
    words = "mean and all harmonics"
    if shape.left_out:
        words = (
            f"about their mean. The mean, up to {number(MICRO * shape.left_out)} µm, is omitted: it is far larger than "
            "the motion, as for a body that only friction supports, which has no unique mean position"
        )
    return (
        f"Deflected shape at the peak, {shown_number(view.shown_frequency_hz(shape.frequency_hz), 'Hz')} Hz: "
        f"displacements × {number(shape.magnification)}, {words}. The largest true displacement in the picture is "
        f"{number(MICRO * shape.largest)} µm."
    )


def _legend(picture: StructurePicture, n_bodies: int) -> list[LegendEntry]:
    """The entries; bodies after the first ones share an entry."""
    entries = list(picture.legend)
    if n_bodies <= _NAMED_BODIES:
        return entries
    more = tuple(trace for entry in entries[_NAMED_BODIES:n_bodies] for trace in entry.traces)
    words = f"{n_bodies - _NAMED_BODIES} more bodies; colours repeat"
    shared = LegendEntry("body", entries[_NAMED_BODIES].colour, words, more)
    return [*entries[:_NAMED_BODIES], shared, *entries[n_bodies:]]


def _words(study: StudyRecord, sketch: Sketch) -> str:
    """The picture in words, with the names whole that its labels shorten."""
    faces = [study.face_names[face] for face in np.unique(sketch.face[sketch.face >= 0])]
    loads = [
        f"{name}, {number(float(np.linalg.norm(load)))} N along {_along(load)}"
        for name, load in zip(sketch.load_names, sketch.loads, strict=True)
    ]
    parts = [
        f"{'Bodies' if len(sketch.body_names) > 1 else 'Body'}: {', '.join(sketch.body_names)}.",
        f"Contact faces: {', '.join(faces)}." if faces else "",
        f"Loads: {'; '.join(loads)}." if loads else "",
        f"Responses: {'; '.join(sketch.response_names)}." if sketch.response_names else "",
        "Constrained nodes are marked." if sketch.held.any() else "",
    ]
    return " ".join(part for part in parts if part)


def _along(load: FloatArray) -> str:
    """The direction of a load in words: an axis, or a unit vector."""
    unit = load / np.linalg.norm(load)
    axis = int(np.abs(unit).argmax())
    if abs(unit[axis]) > 1.0 - 1e-9:
        return f"{'−' if unit[axis] < 0 else ''}{'xyz'[axis]}"
    return f"({', '.join(number(float(each), 3) for each in unit)})"


STRUCTURE = Section(
    "Structure",
    _content,
    applies=lambda view: view.study.sketch is not None,
    identity="structure",
    scripts=("structure.js",),
)
