"""The record of the study of a response, and the versions of the software."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version

import numpy as np
from numpy.typing import NDArray

from stickslip import __version__
from stickslip.core.errors import InputError
from stickslip.core.plain_data import dotted, plain
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.disk import Disk
from stickslip.results.face_directions import FaceDirections
from stickslip.results.response import ForcedResponse
from stickslip.results.rough_patch import RoughPatch
from stickslip.results.sketch import Sketch
from stickslip.results.stress import StressSummary
from stickslip.results.variables import (
    Embedded,
    InGroup,
    Json,
    Labelled,
    NamedRows,
    Numbers,
    Text,
    WholeNumbers,
    require_shape,
    stored,
)

Value = str | float | int
ModeRow = Mapping[str, Value]
MODE_COLUMNS = ("mode", "description", "full_hz", "reduced_hz", "difference_percent", "mac", "reference_hz")
# Earlier versions had one reference, with a column of its own: the frequencies that their geometry was fitted to.
EARLIER_REFERENCE = ("table2_hz", "the frequencies to which the default geometry was fitted")


# Name of the derived quantity of a study whose contact stiffness follows the momentary pressure.
CONSTANT_STIFFNESS_PEAK = "Peak with a constant contact stiffness"


@dataclass(frozen=True, eq=False)
class StudyRecord(Labelled):
    """Data for the report beside the response.

    Parameters
    ----------
    title, description:
        a heading, and one or two sentences under it.
    inputs:
        text of the study file as it was read.
    outputs:
        name -> row (n,) of one displacement, in m. The first is the response of the curve.
    signal_groups:
        heading -> names of outputs drawn together over one period, for example
        ``{"Damper, left side": ("damper left x", "damper left y", "damper left z")}``.
    face_names:
        names of the contact faces.
    pair_face:
        (n_pairs,) index into ``face_names``.
    pair_position:
        (n_pairs, 2) m, position of each pair in its face: along the length, across the width.
    pair_area:
        (n_pairs,) m2.
    pair_point:
        (n_pairs, 3) m, position of each pair in the axes of the mesh; None for matrices without positions, and in files
        of earlier versions.
    mode_table:
        rows with some of the keys mode, description, full_hz, reduced_hz, difference_percent, mac, reference_hz; no
        difference and mac where a body moves freely, no reference_hz for a mode that has none.
    mode_contact:
        contact of the mode table: "tied", "stuck" on their springs, or "stuck (pairs closed at rest)", where pairs that
        are open at rest have no spring.
    mode_reference:
        source of the ``reference_hz`` of the mode table: a measurement, another program, a publication.
    derived:
        (name, value, unit, explanation) of derived quantities: face stiffness, Sq, preload, ...
    warnings:
        messages of the study itself; those of the solver are in the response.
    notes:
        what was read from a model file and assumed about it; none in files of earlier versions.
    face_directions:
        position and sliding directions of each face in the structure; None for results files of older versions.
    sketch:
        data for a picture of the structure; None for matrices without a mesh, and for the cases of a sweep.
    stress:
        the stress at the peak; None for matrices without a mesh, and if it was not computed.
    disk:
        natural frequencies of a disk of which one sector was solved; None for any other structure.
    rough_patch:
        heights of a rough face for a picture, or None; the cases of a sweep have none.

    Raises
    ------
    InputError
        for arrays that do not fit together, and for a signal group, a key of the mode table or a face of the sketch
        that does not exist.
    """

    title: str = field(metadata=stored(Text("title")))
    description: str = field(metadata=stored(Text("description")))
    inputs: str = field(metadata=stored(Text("study file")))
    outputs: dict[str, FloatArray] = field(
        metadata=stored(
            NamedRows(
                ("output", "unknown"),
                "1",
                "rows that give a displacement",
                "output_names",
                "names of the output rows, JSON list",
                name="output_rows",
            )
        )
    )
    signal_groups: dict[str, tuple[str, ...]] = field(
        metadata=stored(Json(dict[str, list[str]], "outputs plotted together, JSON object"))
    )
    face_names: tuple[str, ...] = field(metadata=stored(Json(list[str], "names of the contact faces, JSON list")))
    pair_face: NDArray[np.int64] = field(metadata=stored(WholeNumbers(("pair",), "1", "face of each pair")))
    pair_position: FloatArray = field(
        metadata=stored(
            Numbers(("pair", "direction"), "m", "position of the pair in its face: along the length, across the width")
        )
    )
    pair_area: FloatArray = field(metadata=stored(Numbers(("pair",), "m2", "nominal area of the pair")))
    pair_point: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(("pair", "axis"), "m", "position of the pair: x, y, z of the mesh", optional=True)),
    )
    mode_table: tuple[dict[str, str | float | int], ...] = field(
        default=(), metadata=stored(Json(list[dict[str, Value]], "mode table, JSON list of rows"))
    )
    mode_contact: str = field(default="tied", metadata=stored(Text("contact of the mode table", optional=True)))
    mode_reference: str = field(
        default="", metadata=stored(Text("source of the reference frequencies of the mode table", optional=True))
    )
    derived: tuple[tuple[str, str | float | int, str, str], ...] = field(
        default=(),
        metadata=stored(
            Json(
                list[tuple[str, Value, str, str]],
                "derived quantities, JSON list of name, value, unit, explanation",
            )
        ),
    )
    warnings: tuple[str, ...] = field(default=(), metadata=stored(Json(list[str], "warnings of the study, JSON list")))
    notes: tuple[str, ...] = field(
        default=(), metadata=stored(Json(list[str], "notes on the model file, JSON list", optional=True))
    )
    face_directions: FaceDirections | None = field(
        default=None, metadata=stored(InGroup.of(FaceDirections, optional=True))
    )
    sketch: Sketch | None = field(default=None, metadata=stored(InGroup.of(Sketch, optional=True)))
    stress: StressSummary | None = field(default=None, metadata=stored(InGroup.of(StressSummary, optional=True)))
    disk: Disk | None = field(default=None, metadata=stored(InGroup.of(Disk, optional=True)))
    rough_patch: RoughPatch | None = field(
        default=None, metadata=stored(Embedded(RoughPatch, name="rough_height", optional=True))
    )

    def __post_init__(self) -> None:
        if not self.outputs:
            raise InputError(
                "outputs is empty; give at least the row of the response that the curve shows.", arguments=["outputs"]
            )
        rows = {name: finite_array(f'outputs["{name}"]', row) for name, row in self.outputs.items()}
        if any(row.ndim != 1 or row.shape != next(iter(rows.values())).shape for row in rows.values()):
            shapes = ", ".join(f"{name} {row.shape}" for name, row in rows.items())
            raise InputError(
                f"outputs must all be rows (n,) of one length, but the shapes are {shapes}.", arguments=["outputs"]
            )
        missing = sorted({name for group in self.signal_groups.values() for name in group} - set(rows))
        if missing:
            raise InputError(
                f'signal_groups names the output "{missing[0]}", but outputs has only {", ".join(rows)}.',
                arguments=["signal_groups"],
            )
        face = np.asarray(self.pair_face)
        position, area = finite_array("pair_position", self.pair_position), finite_array("pair_area", self.pair_area)
        if face.ndim != 1 or position.shape != (face.size, 2) or area.shape != face.shape:
            raise InputError(
                "pair_face (n_pairs,), pair_position (n_pairs, 2) and pair_area (n_pairs,) must agree, but their "
                f"shapes are {face.shape}, {position.shape} and {area.shape}.",
                arguments=["pair_face"],
            )
        if self.pair_point is not None:
            require_shape("pair_point", finite_array("pair_point", self.pair_point), (face.size, 3))
        if not np.isin(face, np.arange(len(self.face_names))).all():
            raise InputError(
                f"pair_face must number the faces 0 to {len(self.face_names) - 1} of face_names.",
                arguments=["pair_face"],
            )
        if self.sketch is not None and not np.isin(self.sketch.face, np.arange(-1, len(self.face_names))).all():
            raise InputError(
                f"face of the sketch must be -1 or a face from 0 to {len(self.face_names) - 1}.", arguments=["face"]
            )
        if self.face_directions is not None and len(self.face_directions.middle) != len(self.face_names):
            raise InputError(
                f"face_directions has {len(self.face_directions.middle)} faces, but face_names has "
                f"{len(self.face_names)}.",
                arguments=["face_directions"],
            )
        mode_table, mode_reference = _with_reference(self.mode_table, self.mode_reference)
        object.__setattr__(self, "outputs", rows)
        object.__setattr__(self, "signal_groups", {key: tuple(names) for key, names in self.signal_groups.items()})
        object.__setattr__(self, "face_names", tuple(self.face_names))
        object.__setattr__(self, "pair_face", face.astype(np.int64))
        object.__setattr__(self, "pair_position", position)
        object.__setattr__(self, "pair_area", area)
        object.__setattr__(self, "mode_table", mode_table)
        object.__setattr__(self, "mode_reference", mode_reference)
        object.__setattr__(self, "derived", tuple(tuple(plain(row)) for row in self.derived))
        object.__setattr__(self, "warnings", tuple(self.warnings))
        object.__setattr__(self, "notes", tuple(self.notes))

    def __repr__(self) -> str:
        return (
            f'StudyRecord("{self.title}": {len(self.outputs)} outputs, {self.pair_face.size} pairs on '
            f"{', '.join(self.face_names)})"
        )

    @property
    def response_output(self) -> str:
        """Name of the output that the amplitude curve shows."""
        return next(iter(self.outputs))

    def input_values(self) -> dict[str, str]:
        """Dotted key -> value as text of :attr:`inputs`. Raises InputError for a text that is not TOML."""
        try:
            return dict(dotted(tomllib.loads(self.inputs)))
        except tomllib.TOMLDecodeError as error:
            raise InputError(f'the inputs of "{self.title}" are not the text of a study file: {error}.') from error

    def require_fit(self, response: ForcedResponse) -> None:
        """Raise InputError unless the rows, pairs and harmonics of this record are those of ``response``."""
        n = self.outputs[self.response_output].size
        if n != response.n_unknowns or self.pair_face.size != response.pairs.n_pairs:
            raise InputError(
                f"the study record has outputs of {n} unknowns and {self.pair_face.size} pairs, but the response has "
                f"{response.n_unknowns} unknowns and {response.pairs.n_pairs} pairs; they belong to different runs."
            )
        motion = None if self.sketch is None else self.sketch.motion
        if motion is not None and motion.harmonics != response.harmonics:
            raise InputError(
                f"the motion of the sketch has {motion.harmonics} harmonics, but the response has "
                f"{response.harmonics}; they belong to different runs."
            )


def _with_reference(table: Sequence[ModeRow], source: str) -> tuple[tuple[ModeRow, ...], str]:
    """The rows of a mode table and the source of their reference, also of a file of an earlier version.

    Raises InputError for an unknown key, a reference that is no frequency above 0, and one without a source.
    """
    earlier, earlier_source = EARLIER_REFERENCE
    if any(earlier in row for row in table):
        source = source or earlier_source
    rows = tuple({"reference_hz" if key == earlier else key: plain(row[key]) for key in row} for row in table)
    unknown = sorted({key for row in rows for key in row} - set(MODE_COLUMNS))
    if unknown:
        raise InputError(
            f'mode_table has the key "{unknown[0]}"; the keys are {", ".join(MODE_COLUMNS)}.', arguments=["mode_table"]
        )
    references = [row["reference_hz"] for row in rows if "reference_hz" in row]
    wrong = [value for value in references if isinstance(value, str) or not value > 0]
    if wrong:
        raise InputError(
            f"mode_table has the reference_hz {wrong[0]!r}; omit it if a mode has none above 0.",
            arguments=["mode_table"],
        )
    if references and not source:
        raise InputError(
            "mode_table has reference_hz, but no mode_reference, which gives their source.",
            arguments=["mode_reference"],
        )
    return rows, source


def reference_deviation(row: ModeRow) -> float | None:
    """Deviation in percent of the model of a row of the mode table; None where model or reference is missing.

    The model is the full one, or the reduced one where there is no full one.
    """
    model, reference = model_frequency(row), row.get("reference_hz")
    return None if model is None or reference is None else frequency_deviation(model, float(reference))


def model_frequency(row: ModeRow) -> float | None:
    """Natural frequency in Hz of the model of a row of the mode table: the full one if there is one."""
    value = row.get("full_hz", row.get("reduced_hz"))
    return None if value is None else float(value)


def frequency_deviation(frequency: float, reference: float) -> float:
    """``100 (frequency / reference - 1)`` in percent."""
    return 100.0 * (frequency / reference - 1.0)


def compared_model(table: Sequence[ModeRow]) -> str:
    """Which model of a mode table is compared with its reference, in words."""
    return "Full model" if any("full_hz" in row for row in table) else "Reduced model"


@cache
def _version_of(package: str) -> str:
    """The version of a package, which takes 8 ms to look up."""
    return version(package)


def run_provenance() -> dict[str, str]:
    """Date (UTC), and versions of stickslip, Python and the numerical packages, to be kept with a response."""
    import platform

    packages = ("numpy", "scipy", "numba", "scikit-fem", "xarray", "h5netcdf")
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "stickslip": __version__,
        **{name: _version_of(name) for name in packages},
    }
