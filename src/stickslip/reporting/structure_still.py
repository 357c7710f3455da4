"""The structure as a still picture, for paper and for browsers that cannot draw the one that turns."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.plain_figure import BLUE, INK, blank_figure
from stickslip.core.validation import FloatArray
from stickslip.reporting.structure_marks import Frame, Label, Marked, labels, marked, outlines
from stickslip.reporting.structure_view import (
    Camera,
    Extent,
    area_vectors,
    best_camera,
    contact_extent,
    directions,
    glass_bodies,
    round_length,
    visible_faces,
)
from stickslip.reporting.style import body_colour, face_colour
from stickslip.results.record import StudyRecord
from stickslip.results.sketch import Sketch

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PANEL_INCHES = 4.0
_HEADING_INCHES = 0.25
_BAR_INCHES = 0.6  # for a bar of colours below the panels
COLOUR_MAP = "viridis"  # for everyone: its lightness rises evenly
_DPI = 150  # chosen: sharp on screens and in print
_POINTS_PER_PX = 0.6  # labels are placed for a view of structure_picture, which is larger than a panel
_GLASS = 0.22  # opacity of bodies that would hide the contact
_AXES_FRACTION = 0.2  # of the width of a panel, for the axes below and the labels above
_FILLED = 0.8  # of a panel, by the box that it shows
_DARKEST = 0.65
_LEAST_VISIBLE = 0.05  # chosen: of a contact face whose sliding directions are shown
_NEARER = 0.01  # of the diagonal of the structure
_LIGHT = np.array([-0.3, 0.6, 0.9])  # right, up, towards the eye
_MM = 1e3  # m to mm


@dataclass(frozen=True)
class Paint:
    """Values (n,) at the points of a sketch that colour its sides instead of the bodies, and the words of their bar."""

    values: FloatArray
    words: str

    @property
    def norm(self) -> Any:
        """From 0 to the largest value, as matplotlib takes it."""
        from matplotlib.colors import Normalize

        return Normalize(0.0, float(self.values.max()) or 1.0)

    def of_sides(self, sketch: Sketch) -> FloatArray:
        """(m, 4) colour of each side, opaque, from the mean of its corners."""
        from matplotlib import colormaps

        return np.asarray(colormaps[COLOUR_MAP](self.norm(self.values[sketch.sides].mean(axis=1))))


@dataclass(frozen=True)
class Views:
    """What a picture shows: the whole structure, and a ``close`` view of its contact or None."""

    camera: Camera
    whole: Extent
    close: Extent | None

    @classmethod
    def of(cls, sketch: Sketch, places: FloatArray) -> Views:
        """The best ones of a sketch with its marks, all at ``places`` (n, 3) m."""
        camera = best_camera(sketch)
        return cls(camera, Extent.around(places), contact_extent(sketch, camera))


def still_picture(study: StudyRecord, sketch: Sketch, paint: Paint | None = None, views: Views | None = None) -> bytes:
    """A PNG of the structure as the sketch has it, with a second view of its contact where that is small."""
    stream = BytesIO()
    structure_figure(study, sketch, paint, views).savefig(stream, format="png", dpi=_DPI)
    return stream.getvalue()


def structure_figure(
    study: StudyRecord, sketch: Sketch, paint: Paint | None = None, chosen: Views | None = None
) -> Figure:
    """The figure of :func:`still_picture`; with ``paint`` it has a bar of colours instead of names.

    Pictures with the same ``chosen`` views can be compared; by default the views are the best ones of the sketch.
    """
    shown = marked(study, sketch)
    chosen = chosen or Views.of(sketch, shown.places)
    camera, whole, close = chosen.camera, chosen.whole, chosen.close
    views = {"": whole} if close is None else {"Whole structure": whole, "Contact": close}
    panel = _PANEL_INCHES * max(_height_fraction(extent, camera) for extent in views.values())
    bar = 0.0 if paint is None else _BAR_INCHES
    height = panel + bar + (_HEADING_INCHES if close is not None else 0.0)
    figure = blank_figure(_PANEL_INCHES * len(views), height)
    figure.set_layout_engine("none")  # each panel says where it is
    for place, (heading, extent) in enumerate(views.items()):
        # matplotlib draws into a square; what a low panel cuts off above and below is empty.
        left, below = place / len(views), (bar + 0.5 * (panel - _PANEL_INCHES)) / height
        axes: Any = figure.add_axes((left, below, 1.0 / len(views), _PANEL_INCHES / height), projection="3d")
        _set_view(axes, camera, extent, extent is close)
        _bodies(axes, sketch, camera, paint)
        _marks(axes, sketch, shown)
        if paint is None:
            visible = visible_faces(sketch, camera, int(shown.tangent_faces.max(initial=-1)) + 1)
            _tangents(axes, shown, visible, named=extent is close or close is None)
        width = _PANEL_INCHES * 72.0 / _POINTS_PER_PX
        px_per_m = _FILLED * width / float(extent.projected_size(camera)[:2].max())
        frame = Frame(camera, extent.middle, px_per_m, width, width * panel / _PANEL_INCHES)
        for label in labels(study, sketch, frame) if paint is None else ():
            if (np.abs(shown.places[label.at] - extent.middle) <= 0.5 * extent.size * (1.0 + 1e-9)).all():
                _write(axes, label, shown.places[label.at])
        figure.text(left + 0.01, 0.99, heading, fontsize=9, weight="bold", va="top", color=INK)
    if paint is not None:
        _colour_bar(figure, paint, height)
    return figure


def _colour_bar(figure: Figure, paint: Paint, height: float) -> None:
    from matplotlib.cm import ScalarMappable

    axes = figure.add_axes((0.25, 0.6 * _BAR_INCHES / height, 0.5, 0.2 * _BAR_INCHES / height))
    bar = figure.colorbar(ScalarMappable(paint.norm, COLOUR_MAP), cax=axes, orientation="horizontal")
    bar.set_label(paint.words, fontsize=8, color=INK)
    bar.ax.tick_params(labelsize=7, colors=INK)


def _height_fraction(extent: Extent, camera: Camera) -> float:
    """Height of a panel that shows a box, with its axes and labels, of its width."""
    right, up, _ = extent.projected_size(camera)
    return float(min(1.0, up / max(right, up) + _AXES_FRACTION))


def _set_view(axes: Any, camera: Camera, extent: Extent, is_close: bool) -> None:
    from matplotlib.ticker import MultipleLocator

    axes.set_proj_type("ortho")
    axes.view_init(elev=camera.elevation_deg, azim=camera.azimuth_deg)
    axes.computed_zorder = False
    ends = _MM * (extent.middle + 0.5 * np.array([[-1.0], [1.0]]) * extent.size)
    axes.set(xlim=ends[:, 0], ylim=ends[:, 1], zlim=ends[:, 2])
    # matplotlib shows a box whose diagonal is as long as the panel is wide.
    zoom = _FILLED * float(np.linalg.norm(extent.size) / extent.projected_size(camera)[:2].max())
    axes.set_box_aspect(tuple(extent.size), zoom=zoom)  # an array would be changed in place
    axes.grid(False)
    if is_close:
        axes.set_axis_off()
    tick = round_length(_MM * float(extent.size.max()) / 4.0)
    for name, axis in zip("xyz", (axes.xaxis, axes.yaxis, axes.zaxis), strict=True):
        axis.pane.set_visible(False)
        axis.set_tick_params(labelsize=6, colors=INK, pad=-2)
        axis.set_major_locator(MultipleLocator(tick))
        axis.label.set(text=f"{name}, mm", fontsize=7, color=INK)
        axis.labelpad = -6


def _bodies(axes: Any, sketch: Sketch, camera: Camera, paint: Paint | None) -> None:
    """The sides that look here, all contact faces, and the outlines of all bodies, painted from far to near."""
    from matplotlib.colors import to_rgba
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    vectors = area_vectors(sketch)
    contact = sketch.face >= 0
    here = (vectors @ camera.axes[2] > 0.0) | (contact & (paint is None))
    edges = np.concatenate([outlines(sketch, body) for body in range(len(sketch.body_names))])
    # Lines are a little nearer to the eye than the sides that they bound, and contact faces than what they touch; along
    # the view that changes their depth alone.
    nearer = _NEARER * float(np.linalg.norm(np.ptp(sketch.points, axis=0))) * camera.axes[2]
    lines = sketch.points[edges[:, [0, 1, 1, 0]]] + nearer
    sides = sketch.points[sketch.sides] + 0.5 * nearer * contact[:, None, None]
    none, n_sides = to_rgba(INK, 0.0), int(here.sum())
    colours = _side_colours(sketch, vectors, camera) if paint is None else paint.of_sides(sketch)
    painted = Poly3DCollection(
        _MM * np.concatenate([sides[here], lines]),
        facecolors=np.concatenate([colours[here], np.tile(none, (len(lines), 1))]),
        edgecolors=[none] * n_sides + [to_rgba(INK)] * len(lines),
        linewidths=0.4,  # one for all: matplotlib sorts the colours by depth, but not the widths
    )
    painted.set_zorder(1)
    axes.add_collection3d(painted)


def _side_colours(sketch: Sketch, vectors: FloatArray, camera: Camera) -> FloatArray:
    """(m, 4) colour of each side in the light, and how opaque it is."""
    from matplotlib.colors import to_rgb

    bodies = np.array([to_rgb(body_colour(body)) for body in range(len(sketch.body_names))])
    faces = np.array([to_rgb(face_colour(face)) for face in range(int(sketch.face.max()) + 1)]).reshape(-1, 3)
    contact: NDArray[np.bool_] = sketch.face >= 0
    colours = bodies[sketch.body]
    colours[contact] = faces[sketch.face[contact]]
    bright = directions(vectors) @ camera.axes.T @ (_LIGHT / np.linalg.norm(_LIGHT))
    bright = np.where(contact, np.abs(bright), bright.clip(0.0))  # one shade for both sides that touch
    opaque = np.where(glass_bodies(sketch, camera)[sketch.body] & ~contact, _GLASS, 1.0)
    return np.column_stack([colours * (_DARKEST + (1.0 - _DARKEST) * bright)[:, None], opaque])


def _marks(axes: Any, sketch: Sketch, shown: Marked) -> None:
    constrained = _MM * sketch.points[sketch.held]
    axes.scatter(*constrained.T, marker="^", s=5, color=INK, linewidths=0.0, zorder=3, depthshade=False)
    ends = (_MM * shown.places[numbers] for numbers in (shown.tails, shown.tips))
    for tail, tip, constant in zip(*ends, sketch.constant, strict=True):
        style = "dashed" if constant else "solid"
        axes.quiver(*tail, *(tip - tail), color=INK, linewidth=1.6, linestyle=style, arrow_length_ratio=0.3, zorder=4)
    places = _MM * sketch.response_places
    axes.scatter(*places.T, s=22, color=BLUE, edgecolor="white", linewidths=0.6, zorder=5, depthshade=False)


def _tangents(axes: Any, shown: Marked, visible: FloatArray, named: bool) -> None:
    """The sliding directions of the contact faces, of each of which the fraction ``visible`` (n_faces,) is seen.

    Names on a small contact would cover each other, so only a view that shows it large is ``named``.
    """
    from matplotlib.patheffects import withStroke

    arrows = zip(shown.starts, shown.ends, shown.tangents, shown.tangent_faces, strict=True)
    for start, end, name, face in arrows:
        if visible[face] < _LEAST_VISIBLE:
            continue
        tail, tip = _MM * shown.places[start], _MM * shown.places[end]
        axes.quiver(*tail, *(tip - tail), color=INK, linewidth=1.0, arrow_length_ratio=0.3, zorder=4)
        if not named:
            continue
        halo = [withStroke(linewidth=2.0, foreground="white")]
        axes.text(*(tail + 1.15 * (tip - tail)), name, fontsize=6, color=INK, path_effects=halo, zorder=6)


def _write(axes: Any, label: Label, place: FloatArray) -> None:
    from matplotlib.patheffects import withStroke
    from mpl_toolkits.mplot3d import proj3d

    x, y, _ = proj3d.proj_transform(*(_MM * place), axes.get_proj())
    right, down = _POINTS_PER_PX * np.array(label.offset)
    axes.annotate(
        label.words,
        (x, y),
        (right, -down),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=7,
        color=INK,
        parse_math=False,
        path_effects=[withStroke(linewidth=2.0, foreground="white")],
        arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 0.5},
        zorder=6,
    )
