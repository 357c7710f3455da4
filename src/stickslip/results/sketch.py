"""Data for a picture of the structure: its outer sides, positions of contact, constraints, loads and responses, and the
motion of all of them at the peak."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, argument_error, finite_array, real_number
from stickslip.results.mode_shapes import ModeShapes
from stickslip.results.stress import SurfaceStress
from stickslip.results.variables import (
    Coefficients,
    Count,
    Embedded,
    Flags,
    Json,
    Labelled,
    Numbers,
    WholeNumbers,
    stored,
)

SinglePrecision = NDArray[np.float32]


def _displacement(of: str, dimension: str) -> Coefficients:
    """Storage of the displacement of points, loads or responses."""
    words = f"displacement of the {of} at the peak of the response"
    return Coefficients((dimension, "axis"), "m", words, name=f"motion_of_{of}")


@dataclass(frozen=True, eq=False)
class Motion(Labelled):
    """Motion of the objects of a sketch over one period, at one point of the response curve.

    Parameters
    ----------
    points, loads, responses:
        (n, 3, 2H+1), (k, 3, 2H+1) and (r, 3, 2H+1) m, single precision: displacements x, y, z of the points, loads and
        responses of the sketch, as coefficients mean, cos 1, sin 1, ...
    frequency_hz:
        of the response at that point.

    Raises
    ------
    InputError
        for arrays of another shape, and for numbers that are not finite.
    """

    points: SinglePrecision = field(metadata=stored(_displacement("points", "point")))
    loads: SinglePrecision = field(metadata=stored(_displacement("loads", "load")))
    responses: SinglePrecision = field(metadata=stored(_displacement("responses", "response")))
    frequency_hz: float = field(metadata=stored(Numbers((), "Hz", "frequency of the motion", name="motion_frequency")))

    def __post_init__(self) -> None:
        columns = np.shape(self.points)[-1] if np.ndim(self.points) == 3 else 0
        for name in ("points", "loads", "responses"):
            array = finite_array(f"motion of the {name}", getattr(self, name))
            if array.ndim != 3 or array.shape[1] != 3 or array.shape[2] != columns or columns % 2 == 0:
                raise InputError(
                    f"the motion of the {name} must have the shape (count, 3, 2H+1) with the same harmonics H for all, "
                    f"but its shape is {array.shape}."
                )
            object.__setattr__(self, name, array.astype(np.float32))
        object.__setattr__(self, "frequency_hz", real_number("frequency of the motion", self.frequency_hz))

    @property
    def harmonics(self) -> int:
        """Number of harmonics, that of the response."""
        return int(self.points.shape[2] - 1) // 2

    def __repr__(self) -> str:
        return f"Motion({len(self.points)} points at {self.frequency_hz:g} Hz, {self.harmonics} harmonics)"


@dataclass(frozen=True, eq=False)
class Sketch(Labelled):
    """The outer surface of a mesh and its marks.

    Parameters
    ----------
    points:
        (n, 3) m, corners of the sides.
    held:
        (n,) whether the point is constrained along one axis or more.
    sides:
        (m, 4) corners of each side, counter-clockwise seen from outside; a triangle repeats its last corner.
    body:
        (m,) index into ``body_names`` of each side.
    face:
        (m,) number of the contact face (in ``StudyRecord.face_names``) that the side is part of, -1 for none.
    body_names:
        names of the bodies.
    load_names, load_places, loads:
        name of each load, its position (k, 3) m, and its vector (k, 3) N; a harmonic one is 0-to-peak.
    constant:
        (k,) whether the load is constant instead of harmonic.
    response_names, response_places:
        names and positions (r, 3) m of the responses.
    mesh_sides:
        number of outer sides of the mesh; above m where the sketch is coarser than the mesh.
    motion:
        the motion at the peak of the response; None for results files of older versions.
    stress:
        the stress at the points, at the peak of the response; None if it was not computed.
    mode_shapes:
        the shapes of the nonlinear mode at the points; None without such a mode.

    Raises
    ------
    InputError
        for arrays that do not fit together, a load of 0 N, and a number of a point or a body that does not exist.
    """

    points: FloatArray = field(
        metadata=stored(Numbers(("point", "axis"), "m", "corners of the outer sides of the mesh"))
    )
    held: NDArray[np.bool_] = field(metadata=stored(Flags(("point",), "1", "1 if the point is constrained")))
    sides: NDArray[np.int64] = field(
        metadata=stored(WholeNumbers(("side", "corner"), "1", "corners in the order seen from outside", np.int32))
    )
    body: NDArray[np.int64] = field(metadata=stored(WholeNumbers(("side",), "1", "body of each side", np.int32)))
    face: NDArray[np.int64] = field(
        metadata=stored(WholeNumbers(("side",), "1", "contact face that the side is part of, -1 for none", np.int32))
    )
    body_names: tuple[str, ...] = field(metadata=stored(Json(list[str], "names of the bodies, JSON list")))
    load_names: tuple[str, ...] = field(metadata=stored(Json(list[str], "names of the loads, JSON list")))
    load_places: FloatArray = field(metadata=stored(Numbers(("load", "axis"), "m", "positions of the loads")))
    loads: FloatArray = field(
        metadata=stored(Numbers(("load", "axis"), "N", "vectors of the loads, harmonic ones 0-to-peak"))
    )
    constant: NDArray[np.bool_] = field(metadata=stored(Flags(("load",), "1", "1 if the load is constant")))
    response_names: tuple[str, ...] = field(metadata=stored(Json(list[str], "names of the responses, JSON list")))
    response_places: FloatArray = field(
        metadata=stored(Numbers(("response", "axis"), "m", "positions of the responses"))
    )
    mesh_sides: int = field(metadata=stored(Count("number of outer sides of the mesh")))
    motion: Motion | None = field(
        default=None, metadata=stored(Embedded(Motion, name="motion_frequency", optional=True))
    )
    stress: SurfaceStress | None = field(
        default=None, metadata=stored(Embedded(SurfaceStress, name="surface_von_mises", optional=True))
    )
    mode_shapes: ModeShapes | None = field(
        default=None, metadata=stored(Embedded(ModeShapes, name="mode_shape", optional=True))
    )

    def __post_init__(self) -> None:
        points = finite_array("sketch points", self.points)
        sides = np.asarray(self.sides, dtype=np.int64)
        if points.ndim != 2 or sides.ndim != 2 or points.shape[1:] != (3,) or sides.shape[1:] != (4,) or not len(sides):
            raise InputError(
                "a sketch requires points (n, 3) and at least one of its sides (m, 4), but the shapes are "
                f"{points.shape} and {sides.shape}."
            )
        m, k, r = len(sides), len(self.load_names), len(self.response_names)
        self._require_shape("held", (len(points),))
        self._require_shape("body", (m,))
        self._require_shape("face", (m,))
        self._require_shape("load_places", (k, 3))
        self._require_shape("loads", (k, 3))
        self._require_shape("constant", (k,))
        self._require_shape("response_places", (r, 3))
        body = np.asarray(self.body, dtype=np.int64)
        for name, numbers, count in (("sides", sides, len(points)), ("body", body, len(self.body_names))):
            if numbers.min() < 0 or numbers.max() >= count:
                raise InputError(
                    f"{name} of the sketch must contain numbers from 0 to {count - 1}, but has others.",
                    arguments=[name],
                )
        if not np.any(self.loads, axis=1).all():
            raise InputError(
                "loads of the sketch contains a load of 0 N, which has no direction; remove it.", arguments=["loads"]
            )
        if self.mesh_sides < m:
            raise InputError(
                f"mesh_sides is {self.mesh_sides}, but the sketch has {m} sides; it cannot have more.",
                arguments=["mesh_sides"],
            )
        if self.motion is not None:
            shapes = (self.motion.points.shape[0], self.motion.loads.shape[0], self.motion.responses.shape[0])
            if shapes != (len(points), k, r):
                raise InputError(
                    f"motion of the sketch has {shapes[0]} points, {shapes[1]} loads and {shapes[2]} responses, but "
                    f"the sketch has {len(points)}, {k} and {r}.",
                    arguments=["motion"],
                )
        if self.stress is not None and self.stress.von_mises.size != len(points):
            raise InputError(
                f"stress of the sketch has {self.stress.von_mises.size} points, but the sketch has {len(points)}.",
                arguments=["stress"],
            )
        if self.mode_shapes is not None and self.mode_shapes.displacement.shape[1] != len(points):
            raise InputError(
                f"mode_shapes of the sketch has {self.mode_shapes.displacement.shape[1]} points, but the sketch has "
                f"{len(points)}.",
                arguments=["mode_shapes"],
            )
        changed: dict[str, Any] = {
            "points": points,
            "held": np.asarray(self.held, dtype=bool),
            "sides": sides,
            "body": body,
            "face": np.asarray(self.face, dtype=np.int64),
            "body_names": tuple(self.body_names),
            "load_names": tuple(self.load_names),
            "load_places": finite_array("load_places", self.load_places),
            "loads": finite_array("loads", self.loads),
            "constant": np.asarray(self.constant, dtype=bool),
            "response_names": tuple(self.response_names),
            "response_places": finite_array("response_places", self.response_places),
        }
        for name, value in changed.items():
            object.__setattr__(self, name, value)

    def _require_shape(self, name: str, shape: tuple[int, ...]) -> None:
        actual = np.shape(getattr(self, name))
        if actual != shape:
            raise argument_error(name, f"{name} of the sketch must have shape {shape}, but its shape is {actual}.")

    def __repr__(self) -> str:
        return f"Sketch({len(self.sides)} of {self.mesh_sides} outer sides of {', '.join(self.body_names)})"

    @property
    def is_coarsened(self) -> bool:
        """Whether it has fewer sides than the mesh."""
        return self.mesh_sides > len(self.sides)
