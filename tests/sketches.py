"""Sketches of simple bodies with known sides, for the tests of the record, its file and the page."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from stickslip.results.sketch import Motion, Sketch

_CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float
)
# In the order -z, +z, -y, +x, +y, -x; counter-clockwise seen from outside.
BOX_SIDES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
BELOW, ABOVE, FRONT, RIGHT, BACK, LEFT = range(6)


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> np.ndarray:
    """(8, 3) m, the corners of a box; its sides are ``BOX_SIDES``."""
    corners: np.ndarray = np.array(low) + _CORNERS * (np.array(high) - np.array(low))
    return corners


def sketch_of_boxes(*boxes: np.ndarray, **changes: Any) -> Sketch:
    """Boxes, each of them one body, without contact; a load of 5 N along x and a response at corners of the first."""
    count = len(boxes)
    values: dict[str, Any] = {
        "points": np.vstack(boxes),
        "held": np.zeros(8 * count, dtype=bool),
        "sides": np.vstack([BOX_SIDES + 8 * number for number in range(count)]),
        "body": np.repeat(np.arange(count), 6),
        "face": np.full(6 * count, -1),
        "body_names": tuple(f"box {number + 1}" for number in range(count)),
        "load_names": ("shaker",),
        "load_places": boxes[0][[5]],
        "loads": np.array([[5.0, 0.0, 0.0]]),
        "constant": np.array([False]),
        "response_names": ("tip",),
        "response_places": boxes[0][[6]],
        "mesh_sides": 6 * count,
    }
    return Sketch(**values | changes)


def stacked_boxes(**changes: Any) -> Sketch:
    """A box of 0.1 m and a small one on its upper side; face 0 is where they touch. The bottom is held."""
    held = np.zeros(16, dtype=bool)
    held[:4] = True
    face = np.full(12, -1)
    face[6 + BELOW] = 0
    lower, upper = box((0.0, 0.0, 0.0), (0.1, 0.1, 0.1)), box((0.04, 0.04, 0.1), (0.06, 0.06, 0.11))
    return sketch_of_boxes(lower, upper, **{"held": held, "face": face} | changes)


def shaken(sketch: Sketch, amplitude: float = 2e-4, harmonics: int = 3) -> Sketch:
    """The sketch with a motion: all of it goes to and fro along x by ``amplitude`` m times its height, 0 at z = 0.

    ``u = amplitude z / z_max (0.5 + sin(w t) + 0.25 cos(2 w t))``
    """
    top = sketch.points[:, 2].max()

    def of(places: np.ndarray) -> np.ndarray:
        coefficients = np.zeros((len(places), 3, 2 * harmonics + 1))
        coefficients[:, 0, [0, 2, 3]] = np.outer(amplitude * places[:, 2] / top, [0.5, 1.0, 0.25])
        return coefficients

    motion = Motion(of(sketch.points), of(sketch.load_places), of(sketch.response_places), frequency_hz=410.5)
    return dataclasses.replace(sketch, motion=motion)
