"""The structure as a figure of plotly.js that can be turned, with its motion over one period at the peak.

``structure.js`` puts the coordinates into the traces: those of the structure at rest, and those of the deflected shape,
which it computes from Fourier coefficients. So the page contains each point and its motion only once, as packed
numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.fourier import synthesis_matrix
from stickslip.core.plain_figure import BLUE, INK
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import Figure, PlotMarkup, figure_of, plain_figures
from stickslip.reporting.packing import FULL_SCALE, packed
from stickslip.reporting.structure_marks import Frame, Label, Marked, before_faces, labels, marked, outlines
from stickslip.reporting.structure_view import (
    Camera,
    Extent,
    area_vectors,
    best_camera,
    contact_extent,
    directions,
    glass_bodies,
    round_length,
)
from stickslip.reporting.style import body_colour, face_colour
from stickslip.results.record import StudyRecord
from stickslip.results.sketch import Motion, Sketch
from stickslip.results.stress import SurfaceStress

WIDE_PX, NARROW_PX = (820, 560), (350, 400)  # width and height of the picture on a screen and on a phone
_MM = 1e3  # m to mm
_MPA = 1e-6  # Pa to MPa
# Measure of the stress at the surface -> title of its colours.
STRESS_WORDS = {"von_mises": "Largest von Mises stress, MPa", "alternating": "Alternating stress, MPa"}
_GLASS = 0.14  # opacity of bodies that would hide the contact
_DEFLECTION_FRACTION = 0.08  # of the diagonal of the structure, for its largest displacement
_LEAST_HARMONIC = 1e-3  # of the largest coefficient; harmonics that nowhere reach it are left out of the picture
# chosen: multiple of the motion about the mean; a larger mean is not shown. A body that only friction supports has no
# unique mean.
_LARGEST_MEAN = 10.0
_SUNK = 1e-3  # of the diagonal of the structure, for contact faces
_TICKS = 5  # along the longest axis
_CONE_FRACTION = 0.3  # of the length of an arrow, for its head
_HALF_ANGLE = np.tan(np.radians(22.5))  # plotly.js sees 45 degrees from bottom to top
_AROUND = 1.2  # room in a view for the axes and the labels, of the size of what it shows
_MATT = {"ambient": 0.7, "diffuse": 0.5, "specular": 0.02, "roughness": 0.9, "fresnel": 0.02}
_BRIGHT = _MATT | {"ambient": 0.85, "diffuse": 0.3}  # of contact faces, for their true colour
_LIGHT = np.array([-3e4, 6e4, 9e4])  # right, up, towards the eye; as far away as plotly.js takes it


@dataclass(frozen=True)
class LegendEntry:
    """A line of the legend: ``kind`` and ``colour`` of its mark, its words, and the traces that it shows and hides."""

    kind: str
    colour: str
    words: str
    traces: tuple[int, ...]


@dataclass(frozen=True)
class Deflection:
    """Numbers of the deflected shape.

    ``largest`` is the largest displacement shown, in m, before the magnification; ``left_out`` is the largest mean
    displacement in m where the shape is shown about its mean, else 0.
    """

    magnification: float
    largest: float
    left_out: float
    frequency_hz: float


@dataclass(frozen=True)
class StructurePicture:
    """``data`` is what structure.js reads: the figure, the packed points and their motion, the views."""

    data: dict[str, Any]
    legend: tuple[LegendEntry, ...]
    deflection: Deflection | None
    has_close_view: bool
    has_glass: bool


@dataclass(frozen=True)
class _Trace:
    """A trace of plotly without its coordinates; ``at`` are the numbers of its points, -1 for a gap in a line."""

    look: dict[str, Any]
    at: NDArray[np.int64]


@dataclass(frozen=True)
class _Contact:
    """The points of contact faces a second time, a little inside their bodies.

    There no side of another body lies in the same plane, which would be drawn in turn with the contact face.
    ``points`` (c,) are the points of the sketch, ``places`` (c, 3) m where they are drawn, and ``number`` (n,) is what
    each of these points of the sketch is numbered in the picture.
    """

    points: NDArray[np.int64]
    places: FloatArray
    number: NDArray[np.int64]

    @classmethod
    def of(cls, sketch: Sketch, first: int) -> _Contact:
        """The points of a sketch, numbered from ``first``."""
        here = sketch.face >= 0
        sides, vectors = sketch.sides[here], area_vectors(sketch)[here]
        outwards = np.zeros_like(sketch.points)
        for corner in range(4):
            np.add.at(outwards, sides[:, corner], vectors)
        points = np.unique(sides)
        depth = _SUNK * float(np.linalg.norm(np.ptp(sketch.points, axis=0)))
        places = sketch.points[points] - depth * directions(outwards[points])
        number = np.full(len(sketch.points), -1)
        number[points] = first + np.arange(points.size)
        return cls(points, places, number)


def structure_picture(study: StudyRecord, sketch: Sketch) -> StructurePicture:
    """The picture of the structure of a study."""
    camera = best_camera(sketch)
    depth = _SUNK * float(np.linalg.norm(np.ptp(sketch.points, axis=0)))
    shown = before_faces(marked(study, sketch), camera, 2.0 * depth)
    contact = _Contact.of(sketch, len(shown.places))
    traces, legend = _traces(study, sketch, camera, shown, contact)
    motion, deflection = (
        (None, None) if sketch.motion is None else _packed_motion(sketch, sketch.motion, shown, contact)
    )
    extent = _extent(shown.places, 0.0 if deflection is None else deflection.magnification * deflection.largest)
    close = contact_extent(sketch, camera)
    words, narrow = (labels(study, sketch, _frame(extent, camera, size)) for size in (WIDE_PX, NARROW_PX))
    data = {
        "figure": plain_figures(_figure(words, extent, [trace.look for trace in traces])),
        "points": packed(_MM * np.vstack([shown.places, contact.places]), "f4"),
        "at": [packed(trace.at, "i4") for trace in traces],
        "labels": [label.at for label in words],
        "motion": motion,
        "stress": None if sketch.stress is None else _packed_stress(sketch.stress, len(shown.places), contact),
        "views": {"whole": _view(extent, extent, camera)}
        | ({} if close is None else {"contact": _view(close, extent, camera)}),
        "narrow": {"height": NARROW_PX[1], "offsets": [label.offset for label in narrow]},
    }
    has_glass = bool(glass_bodies(sketch, camera).any())
    return StructurePicture(data, tuple(legend), deflection, close is not None, has_glass)


def _traces(
    study: StudyRecord, sketch: Sketch, camera: Camera, shown: Marked, contact: _Contact
) -> tuple[list[_Trace], list[LegendEntry]]:
    traces: list[_Trace] = []
    legend: list[LegendEntry] = []

    def show(kind: str, colour: str, words: str, *made: _Trace) -> None:
        legend.append(LegendEntry(kind, colour, words, tuple(range(len(traces), len(traces) + len(made)))))
        traces.extend(made)

    glass = glass_bodies(sketch, camera)
    light = dict(zip("xyz", (_LIGHT @ camera.axes).round().tolist(), strict=True))
    for body, name in enumerate(sketch.body_names):
        sides = sketch.sides[(sketch.body == body) & (sketch.face < 0)]
        look = {"lightposition": light, "lighting": _MATT, "opacity": _GLASS if glass[body] else 1.0}
        surface = _surface(name, body_colour(body), sides, look)
        show("body", body_colour(body), name, surface, _lines(outlines(sketch, body), INK, 1.5))
    for face in np.unique(sketch.face[sketch.face >= 0]):
        name, colour, sides = (
            study.face_names[face],
            face_colour(int(face)),
            contact.number[sketch.sides[sketch.face == face]],
        )
        look = {"lightposition": light, "lighting": _BRIGHT}
        show("face", colour, f"contact, {name}", _surface(name, colour, sides, look))
    if sketch.held.any():
        show("held", INK, "constrained node", _marks("held", np.flatnonzero(sketch.held), INK, "square", 1.8))
    for constant, words in ((False, "harmonic force"), (True, "constant force")):
        which = np.flatnonzero(sketch.constant == constant)
        if which.size:
            tail, tip = shown.tails[which], shown.tips[which]
            shafts = _lines(np.column_stack([tail, tip]), INK, 5.0, "dash" if constant else "solid")
            along = shown.places[tip] - shown.places[tail]
            heads = _cones([sketch.load_names[load] for load in which], tip, _CONE_FRACTION * _MM * along)
            show("constant" if constant else "load", INK, words, shafts, heads)
    if shown.tangents:
        along = _MM * (shown.places[shown.ends] - shown.places[shown.starts])
        shafts = _lines(np.column_stack([shown.starts, shown.ends]), INK, 4.0)
        heads = _cones(list(shown.tangents), shown.ends, _CONE_FRACTION * along)
        show("tangent", INK, "sliding directions t1, t2", shafts, heads, _words(shown.tangents, shown.ends))
    if sketch.response_names:
        marks = _marks("response", shown.responses, BLUE, "circle", 3.5)
        marks.look["hovertemplate"] = [_hover(name) for name in sketch.response_names]
        show("response", BLUE, "response", marks)
    return traces, legend


def _hover(name: str) -> PlotMarkup:
    return PlotMarkup("{}<br>x %{{x:.4g}}, y %{{y:.4g}}, z %{{z:.4g}} mm<extra></extra>").format(name)


def _surface(name: str, colour: str, sides: NDArray[np.int64], options: dict[str, Any]) -> _Trace:
    """Sides (m, 4) as triangles; ``options`` of plotly win over the common look."""
    at, corner = np.unique(sides, return_inverse=True)
    corner = corner.reshape(-1, 4)
    second = corner[corner[:, 2] != corner[:, 3]]
    triangles = np.concatenate([corner[:, :3], second[:, [0, 2, 3]]])
    look = {
        "type": "mesh3d",
        **{axis: _typed(triangles[:, place]) for place, axis in enumerate("ijk")},
        "color": colour,
        "flatshading": True,
        "hovertemplate": _hover(name),
    }
    return _Trace(look | options, at)


def _typed(numbers: NDArray[np.int64]) -> dict[str, str]:
    """Whole numbers in the form that plotly.js unpacks itself."""
    return {"dtype": "i4", "bdata": packed(numbers, "i4")}


def _lines(edges: NDArray[np.int64], colour: str, width: float, dash: str = "solid") -> _Trace:
    """Edges (e, 2) as one line with gaps."""
    at = np.column_stack([edges, np.full(len(edges), -1)]).ravel()
    line = {"color": colour, "width": width, "dash": dash}
    return _Trace({"type": "scatter3d", "mode": "lines", "line": line, "hoverinfo": "skip"}, at)


def _marks(name: str, at: NDArray[np.int64], colour: str, symbol: str, size: float) -> _Trace:
    marker = {"color": colour, "symbol": symbol, "size": size, "line": {"color": "#ffffff", "width": 1}}
    return _Trace({"type": "scatter3d", "mode": "markers", "marker": marker, "hovertemplate": _hover(name)}, at)


def _words(words: tuple[str, ...], at: NDArray[np.int64]) -> _Trace:
    look = {"type": "scatter3d", "mode": "text", "text": list(words), "textposition": "top right", "hoverinfo": "skip"}
    return _Trace(look | {"textfont": {"size": 13, "color": INK}}, at)


def _cones(names: list[str], at: NDArray[np.int64], along: FloatArray) -> _Trace:
    """Heads of arrows with their tips at points; ``along`` (k, 3) mm is their length and direction."""
    look = {
        "type": "cone",
        **{axis: along[:, place].round(6).tolist() for place, axis in enumerate("uvw")},
        "anchor": "tip",
        "sizemode": "raw",
        "sizeref": 1,
        "colorscale": [[0, INK], [1, INK]],
        "showscale": False,
        "text": names,
        "hovertemplate": PlotMarkup("%{text}<extra></extra>"),
    }
    return _Trace(look, at)


def _packed_motion(
    sketch: Sketch, motion: Motion, shown: Marked, contact: _Contact
) -> tuple[dict[str, Any], Deflection]:
    """Coefficients as 16-bit numbers, one row of all points for each coefficient, in units of ``step`` mm."""
    parts = [part.astype(float) for part in (motion.points, motion.responses, motion.loads)]
    mean, swing = _largest_displacement(parts[0][..., :1]), _largest_displacement(_about_mean(parts[0]))
    left_out = mean if mean > _LARGEST_MEAN * swing else 0.0
    if left_out:
        parts = [_about_mean(part) for part in parts]
    columns = _columns_to_show(parts[0])
    of_points, responses, loads = (part[..., :columns] for part in parts)
    largest = _largest_displacement(of_points)
    size = float(np.linalg.norm(np.ptp(sketch.points, axis=0)))
    magnification = float(f"{_DEFLECTION_FRACTION * size / largest:.2g}") if largest > 0.0 else 1.0
    tangents = of_points[shown.anchors]
    moving = np.concatenate(
        [of_points, responses, loads, loads, tangents, tangents, of_points[contact.points]]
    )  # tail and tip of an arrow move with its place
    step = float(np.abs(moving).max()) / FULL_SCALE or 1.0
    numbers = np.rint(moving / step).transpose(2, 0, 1)
    data = {"values": packed(numbers, "i2"), "coefficients": columns, "step": _MM * step * magnification}
    return data, Deflection(magnification, largest, left_out, motion.frequency_hz)


def _packed_stress(stress: SurfaceStress, n_places: int, contact: _Contact) -> list[dict[str, Any]]:
    """Values of each point of the picture in MPa, 0 at its marks, with the words of their bar."""
    measures = []
    for key, words in STRESS_WORDS.items():
        values = _MPA * np.asarray(getattr(stress, key), dtype=float)
        places = np.concatenate([values, np.zeros(n_places - len(values)), values[contact.points]])
        measures.append({"words": words, "largest": float(values.max()), "values": packed(places, "f4")})
    return measures


def _about_mean(coefficients: FloatArray) -> FloatArray:
    """Coefficients (..., 2H+1) of the motion about its mean over the period."""
    changed = coefficients.copy()
    changed[..., 0] = 0.0
    return changed


def _columns_to_show(coefficients: FloatArray) -> int:
    """Number of visible columns: 2H+1 with at least one harmonic if there is one."""
    height = np.abs(coefficients).max(axis=(0, 1))
    seen = int(np.flatnonzero(height >= _LEAST_HARMONIC * height.max()).max())
    return min(int(coefficients.shape[2]), 2 * max(1, (seen + 1) // 2) + 1)


def _largest_displacement(coefficients: FloatArray) -> float:
    """m, the largest distance of a point from its place at rest over the period."""
    harmonics = (coefficients.shape[2] - 1) // 2
    times = synthesis_matrix(harmonics, 32 * max(harmonics, 1))
    return max(float(np.linalg.norm(coefficients @ row, axis=1).max()) for row in times)


def _extent(places: FloatArray, reach: float) -> Extent:
    """The box around all shown objects, including ``reach`` m of motion."""
    extent = Extent.around(places, 1.02)
    return Extent(extent.middle, extent.size + 2.0 * reach)


def _figure(words: list[Label], extent: Extent, traces: list[dict[str, Any]]) -> Figure:
    tick = round_length(_MM * float(extent.size.max()) / _TICKS)
    axes = {}
    for place, axis in enumerate("xyz"):
        low = _MM * (extent.middle[place] - 0.5 * extent.size[place])
        axes[f"{axis}axis"] = {
            "title": {"text": f"{axis}, mm"},
            "range": [low, low + _MM * extent.size[place]],
            "dtick": tick,
            "tick0": 0,
            "showbackground": False,
            "gridcolor": "#dde3e8",
            "zeroline": False,
            "showspikes": False,
            "linecolor": "#9aa5b1",
        }
    notes = [
        {
            "text": label.words,
            "ax": label.offset[0],
            "ay": label.offset[1],
            "showarrow": True,
            "arrowhead": 0,
            "arrowwidth": 1,
            "arrowcolor": INK,
            "bgcolor": "rgba(255,255,255,.82)",
            "borderpad": 1,
            "font": {"size": 12, "color": INK},
        }
        for label in words
    ]
    # The aspect "data" of plotly.js looks at the coordinates and not at the ranges, so it would change with the motion.
    ratio = dict(zip("xyz", (extent.size / _unit(extent)).tolist(), strict=True))
    scene = {"aspectmode": "manual", "aspectratio": ratio, "dragmode": "turntable", "annotations": notes, **axes}
    return figure_of(traces, WIDE_PX[1], scene=scene, margin={"l": 0, "r": 0, "t": 0, "b": 0}, showlegend=False)


def _view(shown: Extent, whole: Extent, camera: Camera) -> dict[str, list[Any]]:
    """What structure.js makes a camera from for a picture of any shape, so that a box fills it.

    Lengths are in units of the scene, from the middle of the box of the axes: ``centre`` (3,), the unit vector
    ``towards`` the eye (3,), and ``corners`` (8, 3) of the box to the right, up and towards the eye from its centre.
    """
    return {
        "centre": ((shown.middle - whole.middle) / _unit(whole)).round(6).tolist(),
        "towards": camera.axes[2].round(6).tolist(),
        "corners": (_projected_corners(shown, camera) / _unit(whole)).round(6).tolist(),
    }


def _unit(whole: Extent) -> float:
    """m, the unit of length of the scene of plotly.js: the box of the axes has the volume 1, which suits its camera."""
    return float(np.cbrt(whole.size.prod()))


def _projected_corners(shown: Extent, camera: Camera) -> FloatArray:
    """(8, 3) m to the right, up and towards the eye from the middle of a box, with room around it."""
    return (shown.corners - shown.middle) @ camera.axes.T * [_AROUND, _AROUND, 1.0]


def _frame(shown: Extent, camera: Camera, size: tuple[int, int]) -> Frame:
    """The view of a box in a picture of ``size`` px, as structure.js shows it."""
    width, height = size
    right, up, towards = np.abs(_projected_corners(shown, camera)).T
    distance = float((np.maximum(right * height / width, up) / _HALF_ANGLE + towards).max())
    return Frame(camera, shown.middle, 0.5 * height / (_HALF_ANGLE * distance), width, height)
