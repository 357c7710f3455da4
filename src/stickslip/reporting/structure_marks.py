"""Marks on a structure: arrows of its loads, outlines of its bodies and contact faces, and labels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from stickslip.core.shown_numbers import number
from stickslip.core.validation import FloatArray
from stickslip.reporting.structure_view import Camera, area_vectors, directions
from stickslip.results.record import StudyRecord
from stickslip.results.sketch import Sketch

_ARROW_FRACTION = 0.16  # length of an arrow, of the diagonal of the box around the structure
_TANGENT_FRACTION = 0.4  # length of the arrows t1 and t2, of their face along them: nearly to its edge
_LEAST_TANGENT_FRACTION = 0.02  # and at least of the diagonal of the box around the structure
_AROUND_FACE = 1.1  # chosen: sides of a face reach farther from its middle than its pairs by at most this factor
_FLAT = 0.25  # chosen: and are nearer to its plane than this part of it, while those of the next sector are not
_SHARP_DEG = 30.0  # between the normals of two sides whose common edge is drawn
_LONGEST_LABEL = 34  # letters
_LETTER_PX, _LINE_PX = 6.8, 18.0  # width of a letter, height of a label with its margin
_REACHES_PX = (34.0, 56.0, 80.0, 108.0, 140.0)  # chosen: distances of a label from its point
_DIRECTIONS = 16


@dataclass(frozen=True)
class Marked:
    """All places that a picture of a sketch shows: ``places`` (n, 3) m, and which of them are what.

    The first are the points of the sketch; ``responses`` (r,), ``tails`` and ``tips`` (k,) are positions of the places
    of responses and of the ends of the arrows of loads. ``pulls`` (k,) says which arrows start at the place of their
    load; the others end there. ``starts`` (d,) and ``ends`` (d,) are those of the arrows of the sliding directions
    ``tangents`` (d,), t1 and t2 of each of the contact faces ``tangent_faces`` (d,) that has them; they move with the
    points ``anchors`` (d,).
    """

    places: FloatArray
    responses: NDArray[np.int64]
    tails: NDArray[np.int64]
    tips: NDArray[np.int64]
    pulls: NDArray[np.bool_]
    starts: NDArray[np.int64]
    ends: NDArray[np.int64]
    anchors: NDArray[np.int64]
    tangents: tuple[str, ...]
    tangent_faces: NDArray[np.int64]

    @property
    def free_ends(self) -> NDArray[np.int64]:
        """(k,) the ends of the arrows that are not at the places of their loads."""
        return np.where(self.pulls, self.tips, self.tails)


@dataclass(frozen=True)
class Frame:
    """A view as labels are placed in it: camera, place (3,) m in its middle, scale there, width and height in px."""

    camera: Camera
    middle: FloatArray
    px_per_m: float
    width: float
    height: float


@dataclass(frozen=True)
class Label:
    """Words at the place number ``at``; ``offset`` px to the right and down from there to the middle of the words."""

    words: str
    at: int
    offset: tuple[float, float]


def marked(study: StudyRecord, sketch: Sketch) -> Marked:
    """The places of a sketch, with an arrow for each load: all of one length, each on the side of its place that is
    farther from the middle of the bodies. The arrows of t1 and t2 begin at the middle of their contact face."""
    low, high = sketch.points.min(axis=0), sketch.points.max(axis=0)
    length = _ARROW_FRACTION * float(np.linalg.norm(high - low))
    along = length * sketch.loads / np.linalg.norm(sketch.loads, axis=1, keepdims=True)
    away = sketch.load_places - 0.5 * (low + high)
    pulls = (along * away).sum(axis=1) > 0.0
    tails = np.where(pulls[:, None], sketch.load_places, sketch.load_places - along)
    middles, tangents, faces = _tangents(study, sketch)
    groups = (sketch.points, sketch.response_places, tails, tails + along, middles, middles + tangents)
    ends = np.cumsum([len(group) for group in groups])
    responses, tail, tip, start, end = (np.arange(low, high) for low, high in pairwise(ends))
    anchors = np.array([np.linalg.norm(sketch.points - middle, axis=1).argmin() for middle in middles], dtype=np.int64)
    return Marked(
        np.vstack(groups), responses, tail, tip, pulls, start, end, anchors, ("t1", "t2") * (len(faces) // 2), faces
    )


def of_first_sector(study: StudyRecord, sketch: Sketch) -> Sketch:
    """The sketch of a disk with the contact faces of its first sector only, whose t1 and t2 are known; any other as is.

    They are the sides within the extent of the pairs from the middle of the face, near its plane.
    """
    known = study.face_directions
    if study.disk is None or known is None:
        return sketch
    centre = sketch.points[sketch.sides].mean(axis=1)
    here = np.zeros(len(centre), dtype=bool)
    for face in np.flatnonzero(known.tangent1.any(axis=1)):
        along = np.stack([known.tangent1[face], known.tangent2[face]])
        frame = np.vstack([along, np.cross(*along)])
        # positions in a map are along t2, then along t1
        reach = 0.5 * np.ptp(study.pair_position[study.pair_face == face], axis=0)[::-1]
        limits = np.maximum(np.append(_AROUND_FACE * reach, 0.0), _FLAT * reach.max())
        here |= (sketch.face == face) & (np.abs((centre - known.middle[face]) @ frame.T) <= limits).all(axis=1)
    return replace(sketch, face=np.where(here, sketch.face, -1)) if here.any() else sketch


def before_faces(shown: Marked, camera: Camera, depth: float) -> Marked:
    """The places with the arrows t1 and t2 moved by ``depth`` m out of their contact faces, towards the eye."""
    along = (shown.places[shown.ends] - shown.places[shown.starts]).reshape(-1, 2, 3)
    normal = directions(np.cross(along[:, 0], along[:, 1]))
    towards = np.repeat(normal * np.sign(normal @ camera.axes[2])[:, None], 2, axis=0)
    places = shown.places.copy()
    for ends in (shown.starts, shown.ends):
        places[ends] += depth * towards
    return replace(shown, places=places)


def _tangents(study: StudyRecord, sketch: Sketch) -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Starts (d, 3) m and vectors (d, 3) m of the arrows t1, t2 of one contact face after the other; their faces."""
    known = study.face_directions
    if known is None:
        return np.empty((0, 3)), np.empty((0, 3)), np.empty(0, dtype=np.int64)
    faces = np.flatnonzero(known.tangent1.any(axis=1))
    least = _LEAST_TANGENT_FRACTION * float(np.linalg.norm(np.ptp(sketch.points, axis=0)))
    # positions in a map are along t2, then along t1
    sizes = [np.ptp(study.pair_position[study.pair_face == face], axis=0)[::-1] for face in faces]
    lengths = np.maximum(_TANGENT_FRACTION * np.array(sizes).reshape(-1, 2), least)
    vectors = lengths[:, :, None] * np.stack([known.tangent1[faces], known.tangent2[faces]], axis=1)
    return np.repeat(known.middle[faces], 2, axis=0), vectors.reshape(-1, 3), np.repeat(faces, 2)


def outlines(sketch: Sketch, body: int) -> NDArray[np.int64]:
    """(e, 2) edges of a body to draw: those where it is sharp or ends, and those around its contact faces."""
    here = sketch.body == body
    sides, face, normal = sketch.sides[here], sketch.face[here], directions(area_vectors(sketch)[here])
    ends = np.sort(np.stack([sides, np.roll(sides, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(sides)), 4)
    real = ends[:, 0] != ends[:, 1]
    ends, owner = ends[real], owner[real]
    edges, position, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(position.ravel(), kind="stable")
    first = owner[order[np.cumsum(count) - count]]
    last = owner[order[np.cumsum(count) - 1]]
    turned = (normal[first] * normal[last]).sum(axis=1) < np.cos(np.radians(_SHARP_DEG))
    return np.asarray(edges[(count != 2) | turned | (face[first] != face[last])])


def labels(study: StudyRecord, sketch: Sketch, frame: Frame) -> list[Label]:
    """Names of contact faces, loads with their size, and responses, placed so that they do not overlap in a view."""
    shown, sizes = marked(study, sketch), np.linalg.norm(sketch.loads, axis=1)
    faces = np.unique(sketch.face[sketch.face >= 0])
    named = [
        *((shortened(study.face_names[face]), _middle_of_face(sketch, int(face))) for face in faces),
        *(
            (f"{shortened(name)}, {number(float(size))} N", int(end))
            for name, size, end in zip(sketch.load_names, sizes, shown.free_ends, strict=True)
        ),
        *((shortened(name), int(at)) for name, at in zip(sketch.response_names, shown.responses, strict=True)),
    ]
    words, at = [text for text, _ in named], [place for _, place in named]
    seen = frame.px_per_m * (shown.places[at] - frame.middle) @ frame.camera.axes[:2].T * np.array([1.0, -1.0])
    offsets = _spread(seen, words, 0.5 * np.array([frame.width, frame.height]))
    return [Label(*each) for each in zip(words, at, offsets, strict=True)]


def shortened(name: str) -> str:
    """A name, shortened for a label."""
    return name if len(name) <= _LONGEST_LABEL else f"{name[: _LONGEST_LABEL - 1]}…"


def _middle_of_face(sketch: Sketch, face: int) -> int:
    """The point of a contact face that is nearest to its middle."""
    corners = np.unique(sketch.sides[sketch.face == face])
    places = sketch.points[corners]
    return int(corners[np.argmin(np.linalg.norm(places - places.mean(axis=0), axis=1))])


def _spread(places: FloatArray, words: list[str], limits: FloatArray) -> list[tuple[float, float]]:
    """Offsets (right, down) px of labels at ``places`` (m, 2) px: outwards, as near as can be, off each other.

    ``limits`` (2,) px are half of the width and the height of the view.
    """
    angles = 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    turns = np.column_stack([np.cos(angles), np.sin(angles)])
    occupied: list[tuple[FloatArray, FloatArray]] = []
    answer = []
    for place, text in zip(places, words, strict=True):
        room = np.array([_LETTER_PX * len(text) + 8.0, _LINE_PX])
        outwards = turns[np.argsort(-(turns @ place), kind="stable")]
        # Half of the width is added sideways, so that a label is beside its point and not over it.
        choices = [reach * turn + 0.5 * room * [turn[0], 0.0] for reach in _REACHES_PX for turn in outwards]
        free = (
            choice
            for choice in choices
            if (np.abs(place + choice) + 0.5 * room <= limits).all()
            and all((np.abs(place + choice - other) >= 0.5 * (room + size)).any() for other, size in occupied)
        )
        best = next(free, choices[0])
        occupied.append((place + best, room))
        answer.append((float(best[0]), float(best[1])))
    return answer
