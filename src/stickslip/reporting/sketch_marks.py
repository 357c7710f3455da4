"""What is drawn over the bodies of a sketch: contact, held points, loads, responses, axes and the scale."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.reporting.sketch_labels import LETTER_PX, Box, words_at
from stickslip.reporting.sketch_view import Camera, Margins, Window, area_vectors
from stickslip.reporting.svg import Element
from stickslip.results.sketch import Sketch

_ARROW_PX = 58.0
_HEAD_PX = 12.0
_ROOM_PX = 22.0  # between the free end of an arrow and the edge of the view, for its words
_SHORTEST_ARROW = 0.25  # of its length; below that the load points to the eye or away
_OFF_PLACE_PX = 3.0  # between the place of a load and its arrow, so that a response there is seen, too
_HELD_APART_PX = 9.0
_SCALE_PX = 110.0  # at most
_AXIS_PX = 30.0
_TRIAD = (40.0, 44.0)  # px of its origin from the left and the bottom edge


def contact_overlay(sketch: Sketch, window: Window, places: FloatArray) -> tuple[Element, ...]:
    """The contact faces as if the bodies before them were not there: a tint, and their outlines."""
    contact = sketch.face >= 0
    sides = sketch.sides[contact]
    inside = window.holds(places, -0.5 * window.width)[sides].any(axis=1)
    if not inside.any():
        return ()
    towards = area_vectors(sketch)[contact] @ window.camera.axes[2] > 0.0
    # Sides that look here and sides that look away would cancel each other in one path.
    tints = ["".join(polygons(places, sides[inside & which])) for which in (towards, ~towards)]
    outlines = [
        segments(places, _border(sides[inside & (sketch.face[contact] == face) & which]))
        for face in np.unique(sketch.face[contact])
        for which in (towards, ~towards)
    ]
    tint = tuple(Element("path", {"d": path}) for path in tints if path)
    return Element("g", {"class": "tint"}, tint), Element("path", {"class": "edge", "d": "".join(outlines)})


def _border(sides: NDArray[np.int64]) -> NDArray[np.int64]:
    """(e, 2) edges that only one of the sides (k, 4) has."""
    edges = np.sort(np.stack([sides, np.roll(sides, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edges, count = np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0, return_counts=True)
    return np.asarray(edges[count == 1])


def polygons(places: FloatArray, sides: NDArray[np.int64]) -> list[str]:
    """Each of the sides (k, 4) as a closed piece of a path, in fifths of px with steps from corner to corner."""
    corners = np.rint(5.0 * places[sides, :2]).astype(np.int64)
    steps = np.diff(corners, axis=1).reshape(-1, 6).tolist()
    triangle = (sides[:, 2] == sides[:, 3]).tolist()
    return [
        f"M{x} {y}l{_steps(step[:4] if three else step)}z"
        for (x, y), step, three in zip(corners[:, 0].tolist(), steps, triangle, strict=True)
    ]


def segments(places: FloatArray, edges: NDArray[np.int64]) -> str:
    """Edges (k, 2) as pieces of one path, in fifths of px."""
    ends = np.rint(5.0 * places[edges, :2]).astype(np.int64).reshape(-1, 4).tolist()
    return "".join(f"M{x} {y}l{_steps([u - x, v - y])}" for x, y, u, v in ends)


def _steps(numbers: list[int]) -> str:
    """Whole numbers with a space between them where no minus sign keeps them apart."""
    return " ".join(map(str, numbers)).replace(" -", "-")


def held_marks(
    sketch: Sketch, window: Window, places: FloatArray, seen: NDArray[np.int64]
) -> tuple[tuple[Element, ...], list[Box]]:
    """Triangles at some of the held points, and the room that they need.

    Of a body with held points on sides that are ``seen`` (k,) these are marked, else all; no two nearer than some px.
    """
    in_view = sketch.held & window.holds(places)
    chosen = []
    for body in range(len(sketch.body_names)):
        held = np.unique(sketch.sides[sketch.body == body])
        held = held[in_view[held]]
        visible = np.intersect1d(held, sketch.sides[seen])
        chosen.append(visible if visible.size else held)
    at = _apart(places[np.unique(np.concatenate(chosen)), :2], _HELD_APART_PX)
    path = "".join(f"M{x:.1f} {y:.1f}l4 8h-8z" for x, y in at.tolist())
    boxes: list[Box] = [(x - 4.0, y, x + 4.0, y + 8.0) for x, y in at.tolist()]
    return ((Element("path", {"class": "held", "d": path}),) if path else ()), boxes


def _apart(places: FloatArray, distance: float) -> FloatArray:
    """Some of the places (k, 2), no two of them nearer than ``distance``, and none of the others farther from one."""
    kept: list[FloatArray] = []
    waiting = places[np.lexsort((places[:, 0], places[:, 1]))]
    while len(waiting):
        kept.append(waiting[0])
        waiting = waiting[np.linalg.norm(waiting - waiting[0], axis=1) >= distance]
    return np.array(kept).reshape(-1, 2)


@dataclass(frozen=True)
class Arrow:
    """A load in a view, in px.

    ``pointing`` is 1 where it points to the eye, -1 away from it and 0 across; only then it has a length from ``tail``
    to ``tip`` (2,). ``free_end`` (2,) is the end that is not at the place, where its words belong.
    """

    tail: FloatArray
    tip: FloatArray
    pointing: int
    constant: bool
    free_end: FloatArray


def arrows(sketch: Sketch, window: Window) -> list[Arrow]:
    """The loads of a sketch as arrows of one length; each stands on the side of its place that is farther from the
    middle of the bodies."""
    places = window.places(sketch.points)[:, :2]
    centre = 0.5 * (places.min(axis=0) + places.max(axis=0))
    answer = []
    for place, load, constant in zip(
        window.places(sketch.load_places)[:, :2], sketch.loads, sketch.constant, strict=True
    ):
        right, up, towards = window.camera.axes @ load / np.linalg.norm(load)
        flat = np.array([right, -up])
        share = float(np.linalg.norm(flat))
        if share < _SHORTEST_ARROW:
            answer.append(Arrow(place, place, int(np.sign(towards)), bool(constant), place))
            continue
        near, far = _OFF_PLACE_PX / share * flat, (_ARROW_PX + _OFF_PLACE_PX / share) * flat
        pushes = np.linalg.norm(place - far - centre) >= np.linalg.norm(place + far - centre)
        tail, tip = (place - far, place - near) if pushes else (place + near, place + far)
        answer.append(Arrow(tail, tip, 0, bool(constant), tail if pushes else tip))
    return answer


def arrow_mark(arrow: Arrow) -> tuple[Element, ...]:
    """An arrow; a circle with a dot or a cross where the load points to the eye or away from it."""
    kind = "load constant" if arrow.constant else "load"
    if arrow.pointing:
        x, y = arrow.tip
        sign = _circle("dot", arrow.tip, "2.2")
        if arrow.pointing < 0:
            sign = Element("path", {"class": "load", "d": f"M{x - 4:.1f} {y - 4:.1f}l8 8m0-8l-8 8"})
        return _circle("load ring", arrow.tip, "7.5"), sign
    along = (arrow.tip - arrow.tail) / np.linalg.norm(arrow.tip - arrow.tail)
    base, across = arrow.tip - _HEAD_PX * along, 5.0 * np.array([-along[1], along[0]])
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in (arrow.tip, base + across, base - across))
    (x, y), (u, v) = arrow.tail, base
    shaft = Element("path", {"class": kind, "d": f"M{x:.1f} {y:.1f}L{u:.1f} {v:.1f}"})
    return shaft, Element("polygon", {"class": "head", "points": points})


def _circle(kind: str, place: FloatArray, radius: str) -> Element:
    return Element("circle", {"class": kind, "cx": f"{place[0]:.1f}", "cy": f"{place[1]:.1f}", "r": radius})


def margins_for_arrows(sketch: Sketch, window: Window, least: Margins) -> Margins:
    """Margins (left, top, right, bottom) px that keep the arrows of the loads in the view."""
    left, top, right, bottom = least
    for arrow in arrows(sketch, window):
        x, y = arrow.free_end
        left, right = max(left, left + _ROOM_PX - x), max(right, right + _ROOM_PX + x - window.width)
        top, bottom = max(top, top + _ROOM_PX - y), max(bottom, bottom + _ROOM_PX + y - window.height)
    return left, top, right, bottom


def response_mark(place: FloatArray) -> Element:
    """A filled circle with a white ring."""
    return _circle("response", place, "5")


def triad(camera: Camera, height: int) -> tuple[tuple[Element, ...], list[Box]]:
    """Axes x, y and z in the lower left corner."""
    origin = np.array([_TRIAD[0], height - _TRIAD[1]])
    parts: list[Element] = []
    for name, axis in zip("xyz", camera.axes.T, strict=True):
        flat = np.array([axis[0], -axis[1]])
        tip, word = (
            origin + _AXIS_PX * flat,
            origin + _AXIS_PX * flat + 9.0 * flat / max(float(np.linalg.norm(flat)), 0.3),
        )
        line = f"M{origin[0]:.1f} {origin[1]:.1f}L{tip[0]:.1f} {tip[1]:.1f}"
        parts += [Element("path", {"class": "axis", "d": line}), words_at(word[0], word[1], "middle", name)]
    reach = _AXIS_PX + LETTER_PX
    box = (origin[0] - reach, origin[1] - reach, origin[0] + reach, origin[1] + reach)
    return tuple(parts), [box]


def scale_bar(window: Window) -> tuple[tuple[Element, ...], list[Box]]:
    """A bar of a round length in the lower right corner."""
    length_mm = max(_round_lengths(1e3 * _SCALE_PX / window.scale))
    length = 1e-3 * length_mm * window.scale
    right, bottom = window.width - 14.0, window.height - 12.0
    bar = Element("path", {"class": "scale", "d": f"M{right - length:.1f} {bottom - 5:.1f}v5h{length:.1f}v-5"})
    middle = {"x": f"{right - 0.5 * length:.1f}", "y": f"{bottom - 7:.1f}", "text-anchor": "middle"}
    words = Element("text", middle, (f"{length_mm:g} mm",))
    return (bar, words), [(right - max(length, 60.0), bottom - 26.0, right, bottom)]


def _round_lengths(most: float) -> Iterator[float]:
    """1, 2 and 5 times a power of ten, none above ``most``, and at least one of them."""
    power = 10.0 ** np.floor(np.log10(most))
    yield from (float(f"{factor * power:.3g}") for factor in (1, 2, 5) if factor * power <= most * (1 + 1e-12))
