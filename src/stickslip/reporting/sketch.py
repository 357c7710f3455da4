"""The structure of a study as a drawing in the page: SVG without a script, from the sketch of the study record."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from stickslip.core.plain_figure import VERMILLION
from stickslip.core.validation import FloatArray
from stickslip.reporting.painting import PIXEL, Painting, paint
from stickslip.reporting.sketch_labels import Box, Label, Labels, text_size
from stickslip.reporting.sketch_marks import (
    arrow_mark,
    arrows,
    contact_overlay,
    held_marks,
    margins_for_arrows,
    polygons,
    response_mark,
    scale_bar,
    triad,
)
from stickslip.reporting.sketch_view import (
    Window,
    area_vectors,
    best_camera,
    contact_window,
    glass_bodies,
    whole_window,
)
from stickslip.reporting.style import BODY_COLOURS, number
from stickslip.reporting.svg import Element
from stickslip.reporting.templates import rendered
from stickslip.results.record import StudyRecord
from stickslip.results.sketch import Sketch

_WIDTH, _HEIGHTS = 480, (260, 500)  # px of a view
_MARGINS = (34.0, 28.0, 34.0, 52.0)  # px: left, top, right, and below for the axes and the scale
_SHADES = 9
_DARKEST = 0.7
_LIGHT = np.array([-0.3, 0.6, 0.9])  # right, up, towards the eye
_FINEST_LINES_PX = 3.5  # mean width of a side whose edges are drawn
_NAMED_BODIES = 12
_MARK_PX = 6.0  # half the room that the mark of a response needs


def structure_content(study: StudyRecord) -> Markup:
    """The drawing of the structure with its legend; nothing for a study without a sketch."""
    sketch = study.sketch
    if sketch is None:
        return Markup("")
    camera = best_camera(sketch)
    whole = whole_window(sketch, camera, _WIDTH, _HEIGHTS, _MARGINS)
    whole = whole_window(sketch, camera, _WIDTH, _HEIGHTS, margins_for_arrows(sketch, whole, _MARGINS))
    close = contact_window(sketch, whole)
    figures = [_figure("Whole structure", study, sketch, whole, close)]
    if close is not None:
        figures.append(_figure("Close-up of the contact", study, sketch, close, None, is_close=True))
    values = {"caption": _caption(sketch, close), "legend": _legend(sketch), "figures": figures}
    return rendered("structure.html", values)


def _caption(sketch: Sketch, close: Window | None) -> str:
    words = [
        "Parallel projection; the scale holds for lengths in the plane of the picture. Marks and the outlines of "
        "contact faces are drawn over the bodies, also where these hide them."
    ]
    if sketch.held.any():
        words.append("Of held nodes only some are marked.")
    if close is not None and glass_bodies(sketch, close.camera).any():
        words.append("In the close-up, bodies that stand before the contact are glass.")
    if sketch.is_coarsened:
        words.append(
            f"The mesh has {sketch.mesh_sides} outer sides, too many for a page: they are drawn as "
            f"{len(sketch.sides)} coarser ones. mode_shapes.vtu of the run shows the mesh itself in ParaView."
        )
    return " ".join(words)


def _legend(sketch: Sketch) -> list[tuple[Element, str]]:
    """Icons and what they mean."""
    names = list(sketch.body_names)
    entries: list[tuple[tuple[Element, ...], str]] = [
        ((_swatch(_body_colour(body)),), name) for body, name in enumerate(names[:_NAMED_BODIES])
    ]
    if len(names) > _NAMED_BODIES:
        entries.append(((), f"and {len(names) - _NAMED_BODIES} more bodies; colours repeat"))
    if (sketch.face >= 0).any():
        entries.append(((_swatch(VERMILLION),), "contact face"))
    if sketch.held.any():
        entries.append(((_path("held", "M7 1l6 12h-12z"),), "held node"))
    for constant, words in ((False, "harmonic force"), (True, "constant force")):
        if (sketch.constant == constant).any():
            kind = "load constant" if constant else "load"
            entries.append(((_path(kind, "M0 7h8"), _path("head", "M14 7l-7-4v8z")), words))
    if sketch.response_names:
        entries.append(((Element("circle", {"class": "response", "cx": 7, "cy": 7, "r": 5}),), "response"))
    frame = {"viewBox": "0 0 14 14", "aria-hidden": "true"}
    return [(Element("svg", frame, icon), words) for icon, words in entries]


def _swatch(colour: str) -> Element:
    look = {"fill": colour, "stroke": "#6b7787", "stroke-width": ".7"}
    return Element("rect", {"x": ".5", "y": ".5", "width": "13", "height": "13", "rx": "2", **look})


def _path(kind: str, path: str) -> Element:
    return Element("path", {"class": kind, "d": path})


def _figure(
    heading: str, study: StudyRecord, sketch: Sketch, window: Window, inset: Window | None, is_close: bool = False
) -> tuple[str, Element]:
    """One view with its heading; ``inset`` is the window of the close-up, which is framed and has its own names."""
    places = window.places(sketch.points)
    glass = glass_bodies(sketch, window.camera)[sketch.body] if is_close else np.zeros(len(sketch.sides), dtype=bool)
    painting = paint(places, sketch.sides, ~glass, window.width, window.height)
    held, held_boxes = held_marks(sketch, window, places, painting.order)
    axes, axes_box = triad(window.camera, window.height)
    scale, scale_box = scale_bar(window)
    marks, labels, boxes = _marks(study, sketch, window, inset, is_close)
    setter = Labels(painting.covered, PIXEL, window.width, window.height, [*held_boxes, *axes_box, *scale_box, *boxes])
    words = [each for label in labels for each in setter.svg(label)]
    name = "clip-close" if is_close else "clip-whole"
    edge = Element("rect", {"width": window.width, "height": window.height})
    surfaces = (_bodies(sketch, window, places, painting, glass), *contact_overlay(sketch, window, places))
    solid = Element("g", {"transform": "scale(.2)"}, surfaces)
    clipped = (solid, *held, *_frame(window, inset, is_close), *marks)
    view = {"viewBox": f"0 0 {window.width} {window.height}", "role": "img"}
    clip = Element("clipPath", {"id": name}, (edge,))
    inside = (clip, Element("g", {"clip-path": f"url(#{name})"}, clipped), *axes, *scale, *words)
    return heading, Element("svg", {**view, "aria-label": _spoken(heading, study, sketch)}, inside)


def _spoken(heading: str, study: StudyRecord, sketch: Sketch) -> str:
    """The drawing in words."""
    faces = [study.face_names[face] for face in np.unique(sketch.face[sketch.face >= 0])]
    loads = [
        f"{name}, {number(float(np.linalg.norm(load)))} N along {_along(load)}"
        for name, load in zip(sketch.load_names, sketch.loads, strict=True)
    ]
    parts = [
        f"{heading}. {'Bodies' if len(sketch.body_names) > 1 else 'Body'}: {', '.join(sketch.body_names)}.",
        f"Contact faces: {', '.join(faces)}." if faces else "",
        f"Loads: {'; '.join(loads)}." if loads else "",
        f"Responses: {'; '.join(sketch.response_names)}." if sketch.response_names else "",
        "Held nodes are marked by triangles." if sketch.held.any() else "",
    ]
    return " ".join(part for part in parts if part)


def _along(load: FloatArray) -> str:
    """The direction of a load in words: an axis, or a unit vector."""
    unit = load / np.linalg.norm(load)
    axis = int(np.abs(unit).argmax())
    if abs(unit[axis]) > 1.0 - 1e-9:
        return f"{'−' if unit[axis] < 0 else ''}{'xyz'[axis]}"
    return f"({', '.join(number(float(each), 3) for each in unit)})"


def _body_colour(body: int) -> str:
    return BODY_COLOURS[body % len(BODY_COLOURS)]


def _bodies(
    sketch: Sketch, window: Window, places: FloatArray, painting: Painting, glass: NDArray[np.bool_]
) -> Element:
    """The visible sides from far to near, each run of one colour as one path."""
    order = painting.order
    vectors = area_vectors(sketch)[order]
    area = np.linalg.norm(vectors, axis=1)
    unit = vectors / np.where(area > 0.0, area, 1.0)[:, None]
    bright = (unit @ window.camera.axes.T @ (_LIGHT / np.linalg.norm(_LIGHT))).clip(0.0)
    shade = np.rint(bright * (_SHADES - 1)).astype(np.int64)
    kind = np.where(sketch.face[order] >= 0, len(BODY_COLOURS), sketch.body[order] % len(BODY_COLOURS))
    code = (kind * _SHADES + shade) * 2 + glass[order]
    starts = np.flatnonzero(np.append(True, np.diff(code) != 0)) if order.size else order
    pieces = polygons(places, sketch.sides[order])
    runs = []
    for start, stop in zip(starts, np.append(starts[1:], len(order)), strict=True):
        tone, is_glass = divmod(int(code[start]), 2)
        colour = _shaded((*BODY_COLOURS, VERMILLION)[tone // _SHADES], tone % _SHADES)
        look = {"class": "glass"} if is_glass else {}
        runs.append(Element("path", {**look, "color": colour, "d": "".join(pieces[start:stop])}))
    seen = sketch.sides[order]
    widths = np.linalg.norm(np.diff(places[seen][:, :, :2], axis=1), axis=2)
    with_lines = order.size and not sketch.is_coarsened and float(np.median(widths[widths > 0])) >= _FINEST_LINES_PX
    return Element("g", {"class": "bodies lines" if with_lines else "bodies"}, tuple(runs))


def _shaded(colour: str, shade: int) -> str:
    """A colour at one of the steps from the darkest to the brightest."""
    factor = _DARKEST + (1.0 - _DARKEST) * shade / (_SHADES - 1)
    return "#" + "".join(f"{round(factor * int(colour[at : at + 2], 16)):02x}" for at in (1, 3, 5))


def _frame(window: Window, inset: Window | None, is_close: bool) -> tuple[Element, ...]:
    """The frame of the close-up: around it, and where it lies in the whole."""
    if inset is None:
        around = Element("rect", {"class": "inset", "width": window.width, "height": window.height})
        return (around,) if is_close else ()
    width, height = np.array([inset.width, inset.height]) * window.scale / inset.scale
    x, y = (inset.middle - window.middle) * window.scale * np.array([1.0, -1.0])
    left, top = 0.5 * window.width + x - 0.5 * width, 0.5 * window.height + y - 0.5 * height
    sizes = {"x": left, "y": top, "width": width, "height": height}
    return (Element("rect", {"class": "inset", **{name: f"{size:.1f}" for name, size in sizes.items()}}),)


def _marks(
    study: StudyRecord, sketch: Sketch, window: Window, inset: Window | None, is_close: bool
) -> tuple[list[Element], list[Label], list[Box]]:
    """Loads and responses in the view, the words for them, and the room that they need.

    Contact faces, and responses that the close-up holds, are named there alone.
    """
    parts: list[Element] = []
    labels: list[Label] = []
    boxes: list[Box] = []
    if inset is None:
        labels += _face_labels(study, sketch, window)
    at_loads, at_responses = window.places(sketch.load_places), window.places(sketch.response_places)
    drawn = arrows(sketch, window)
    for load in np.flatnonzero(window.holds(at_loads)):
        arrow, size = drawn[load], float(np.linalg.norm(sketch.loads[load]))
        parts += arrow_mark(arrow)
        labels.append(Label(f"{sketch.load_names[load]}, {number(size)} N", arrow.free_end))
        ends = np.stack([arrow.tail, arrow.tip])
        (left, top), (right, bottom) = ends.min(axis=0) - 4.0, ends.max(axis=0) + 4.0
        boxes.append((left, top, right, bottom))
    for response in np.flatnonzero(window.holds(at_responses)):
        place = at_responses[response, :2]
        parts.append(response_mark(place))
        boxes.append((*(place - _MARK_PX), *(place + _MARK_PX)))
        if inset is None or not inset.holds(inset.places(sketch.response_places[[response]]))[0]:
            labels.append(Label(sketch.response_names[response], place))
    return parts, labels, boxes


def _face_labels(study: StudyRecord, sketch: Sketch, window: Window) -> list[Label]:
    """The name of each contact face, at a side of it near to its middle that no mark of a response covers."""
    marks = window.places(sketch.response_places)[:, None, :2]
    labels = []
    for face in np.unique(sketch.face[sketch.face >= 0]):
        middles = window.places(sketch.points[sketch.sides[sketch.face == face]].mean(axis=1))[:, :2]
        away = np.linalg.norm(middles - middles.mean(axis=0), axis=1)
        room = 0.5 * np.array(text_size(study.face_names[face])) + _MARK_PX
        hidden = (np.abs(marks - middles) < room).all(axis=2).any(axis=0)
        best = int(np.argmin(np.where(hidden, away + 1e6, away)))
        labels.append(Label(study.face_names[face], middles[best], may_cover=True))
    return labels
