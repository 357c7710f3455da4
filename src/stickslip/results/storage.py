"""One NetCDF-4 file for one run: the response, and the record of the study that the report needs.

Layout (read it with xarray, MATLAB, Panoply, ncdump): the curve and the response in the root group, the linear limits
in ``linear``, the joint in ``pairs``, the study in ``study``, the picture of its structure, if there is one, in
``sketch``. Cosine and sine parts are separate real arrays.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.metadata import version
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import ResultsFileError
from stickslip.core.files import whole_file
from stickslip.core.plain_data import plain
from stickslip.core.validation import FloatArray
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse, LinearCurves
from stickslip.results.rough_patch import RoughPatch
from stickslip.results.sketch import Motion, Sketch

if TYPE_CHECKING:
    import xarray

FORMAT_VERSION = 2
_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_STATES = "0 stuck, 1 stick-slip, 2 separating"


@dataclass(frozen=True)
class SavedResults:
    """A results file in memory: the response, and the study record or None if none was stored."""

    response: ForcedResponse
    study: StudyRecord | None


def save_results(path: str | PathLike[str], response: ForcedResponse, study: StudyRecord | None = None) -> None:
    """Write one NetCDF-4 file, whole or not at all: a hidden file beside it takes its name once it is complete.

    Raises InputError if ``study`` does not belong to ``response``, ResultsFileError if the place cannot be written.
    """
    if study is not None:
        study.require_fit(response)
    target = Path(path)
    groups = {None: _response_dataset(response), "linear": _linear_dataset(response), "pairs": _pairs_dataset(response)}
    if study is not None:
        groups["study"] = _study_dataset(study)
        if study.sketch is not None:
            groups["sketch"] = _sketch_dataset(study.sketch)
    with whole_file(target, "results", ResultsFileError) as part:
        for group, dataset in groups.items():
            encoding = {
                str(name): {"zlib": True, "complevel": 1, "shuffle": True, "fletcher32": True}
                for name, variable in dataset.variables.items()
                if variable.ndim and variable.dtype.kind in "fi"
            }
            mode: Literal["w", "a"] = "w" if group is None else "a"
            dataset.to_netcdf(part, mode=mode, group=group, engine="h5netcdf", encoding=encoding)


def load_results(path: str | PathLike[str]) -> SavedResults:
    """Read a file that :func:`save_results` wrote; the response and the study are equal to those saved.

    Raises
    ------
    ResultsFileError
        for a file that is missing, is not NetCDF-4, is not of stickslip, is of another version, or is damaged.
    """
    source = Path(path)
    try:
        with source.open("rb") as stream:
            signature = stream.read(len(_HDF5_SIGNATURE))
    except OSError as error:
        raise ResultsFileError(
            f'the results file "{source}" could not be opened: {error.strerror}. "stickslip run" writes it as '
            "results.nc in its output folder."
        ) from error
    if signature != _HDF5_SIGNATURE:
        raise ResultsFileError(
            f'"{source}" is not a NetCDF-4 file (its first bytes are {signature!r}). Give the results.nc that '
            '"stickslip run" wrote.'
        )
    try:
        return _read(source)
    except ResultsFileError:
        raise
    except (OSError, KeyError, ValueError, RuntimeError, AttributeError) as error:
        raise ResultsFileError(
            f'the results file "{source}" is damaged or incomplete ({type(error).__name__}: {error}). Copy it again '
            "from where it was made, or solve again."
        ) from error


def _read(source: Path) -> SavedResults:
    import h5netcdf
    import xarray

    with h5netcdf.File(source, "r") as file:
        found, groups = file.attrs.get("stickslip_format"), set(file.groups)
    if found is None:
        raise ResultsFileError(
            f'"{source}" is a NetCDF-4 file, but not one of stickslip: it has no attribute stickslip_format. Give the '
            'results.nc that "stickslip run" wrote.'
        )
    if int(found) != FORMAT_VERSION:
        raise ResultsFileError(
            f'the results file "{source}" has format {int(found)}, but this version of stickslip reads format '
            f"{FORMAT_VERSION}. Open it with the stickslip that wrote it, or solve again."
        )

    def group(name: str | None) -> xarray.Dataset:
        return xarray.load_dataset(source, group=name, engine="h5netcdf")

    response = _response_from(group(None), group("linear"), group("pairs"))
    if "study" not in groups:
        return SavedResults(response, None)
    sketch = _sketch_from(group("sketch")) if "sketch" in groups else None  # younger than the format
    return SavedResults(response, _study_from(group("study"), sketch))


def _variable(dims: tuple[str, ...], values: Any, unit: str, long_name: str) -> tuple[Any, ...]:
    return (dims, values, {"units": unit, "long_name": long_name})


def _text(value: Any, long_name: str) -> tuple[Any, ...]:
    """A scalar text variable: JSON unless it is text already. Attributes of HDF5 end at 64 kB, variables do not."""
    return ((), value if isinstance(value, str) else json.dumps(plain(value)), {"long_name": long_name})


def _split(
    name: str, array: FloatArray, dims: tuple[str, ...], unit: str, what: str, harmonic: str = "harmonic"
) -> dict[str, tuple[Any, ...]]:
    """Mean (..., n), cosine and sine parts (..., n, harmonics) of coefficients (..., n, 2 * harmonics + 1)."""
    return {
        f"{name}_mean": _variable(dims, array[..., 0], unit, f"{what}, mean over the period"),
        f"{name}_cosine": _variable((*dims, harmonic), array[..., 1::2], unit, f"{what}, cosine part"),
        f"{name}_sine": _variable((*dims, harmonic), array[..., 2::2], unit, f"{what}, sine part"),
    }


def _excited(array: FloatArray) -> FloatArray:
    """Coefficients (..., 2H+1) without the harmonics above the highest one that is not zero, but at least the first."""
    present = np.flatnonzero(array.any(axis=tuple(range(array.ndim - 1))))
    harmonics = max(1, (int(present.max(initial=0)) + 1) // 2)
    return array[..., : 2 * harmonics + 1]


def _joined(dataset: xarray.Dataset, name: str, harmonics: int) -> FloatArray:
    """Coefficients (..., 2 * harmonics + 1); harmonics that were not stored are zero."""
    mean, cosine = dataset[f"{name}_mean"].values, dataset[f"{name}_cosine"].values
    array = np.zeros((*mean.shape, 2 * harmonics + 1))
    stop = 2 * cosine.shape[-1] + 1
    array[..., 0], array[..., 1:stop:2], array[..., 2:stop:2] = mean, cosine, dataset[f"{name}_sine"].values
    return array


def _response_dataset(response: ForcedResponse) -> xarray.Dataset:
    import xarray

    curve, pairs = ("point",), ("point", "pair")
    of_unknowns = "m for boundary unknowns, own scaling for modal ones"
    closure = "relative distance between slider at start and end of the period"
    dissipated = "energy taken by the contact force per cycle: friction and normal_work"
    normal = "work of the normal force per cycle, an error of sampling"
    data = {
        "frequency": _variable(curve, response.frequency_hz, "Hz", "excitation frequency along the curve, may fold"),
        **_split("displacement", response.displacement, ("point", "unknown"), "m", f"displacement ({of_unknowns})"),
        "contact_state": _variable(pairs, response.contact_state, "1", f"contact state: {_STATES}"),
        "dissipated_energy": _variable(pairs, response.dissipated_energy, "J", dissipated),
        "normal_work": _variable(pairs, response.normal_work, "J", normal),
        "closure": _variable(pairs, response.closure, "1", closure),
        "residual": _variable(curve, response.residual, "1", "relative residual of the balance"),
        "iterations": _variable(curve, response.iterations, "1", "Newton iterations"),
        "input_energy": _variable(curve, response.input_energy, "J", "work of the excitation per cycle"),
        "viscous_energy": _variable(curve, response.viscous_energy, "J", "energy lost to viscous damping per cycle"),
        **_split("force", response.force, ("unknown",), "N", "excitation force"),
        "message": _text(response.message, "how the solve ended"),
        "warnings": _text(response.warnings, "warnings of the solver, JSON list"),
        "settings": _text(response.settings, "settings of the solve, JSON object"),
        "provenance": _text(response.provenance, "software and machine, JSON object"),
    }
    harmonic = {"harmonic": _variable(("harmonic",), np.arange(1, response.harmonics + 1), "1", "harmonic number")}
    attributes = {
        "title": "Forced response of a structure with rough, dry-friction joints",
        "source": f"stickslip {version('stickslip')}",
        "stickslip_format": FORMAT_VERSION,
        "converged": int(response.converged),
        "samples": response.samples,
    }
    return xarray.Dataset(data, coords=harmonic, attrs=attributes)


def _linear_dataset(response: ForcedResponse) -> xarray.Dataset:
    import xarray

    linear = response.linear
    dims = ("linear_point", "unknown")
    data = {
        "frequency": _variable(("linear_point",), linear.frequency_hz, "Hz", "excitation frequency"),
        **_split(
            "stuck", _excited(linear.stuck), dims, "m", "displacement, contacts closed at rest stuck", "stuck_harmonic"
        ),
        **_split("free", _excited(linear.free), dims, "m", "displacement without contact", "free_harmonic"),
        "stuck_frequency": _variable(
            ("stuck_mode",), linear.stuck_frequency_hz, "Hz", "natural frequency, contacts closed at rest stuck"
        ),
        "free_frequency": _variable(("free_mode",), linear.free_frequency_hz, "Hz", "natural frequency, no contact"),
    }
    return xarray.Dataset(data)


def _pairs_dataset(response: ForcedResponse) -> xarray.Dataset:
    import xarray

    pairs = response.pairs
    tangential = ("pair", "tangent")[: pairs.tangential_stiffness.ndim]
    data = {
        "operator": _variable(("row", "unknown"), pairs.operator, "1", "relative displacement t1, t2, n of each pair"),
        "normal_stiffness": _variable(("pair",), pairs.normal_stiffness, "N m-1", "normal stiffness"),
        "tangential_stiffness": _variable(tangential, pairs.tangential_stiffness, "N m-1", "tangential stiffness"),
        "friction_coefficient": _variable(("pair",), pairs.friction_coefficient, "1", "friction coefficient"),
        "preload": _variable(("pair",), pairs.preload, "N", "normal force at rest"),
    }
    if pairs.residual_traction is not None:
        rest = "traction at rest that friction keeps"
        data["residual_traction"] = _variable(("pair", "tangent"), pairs.residual_traction, "N", rest)
    return xarray.Dataset(data)


def _response_from(root: xarray.Dataset, linear: xarray.Dataset, pairs: xarray.Dataset) -> ForcedResponse:
    joint = ContactPairs(
        pairs["operator"].values,
        **{
            name: pairs[name].values
            for name in ("normal_stiffness", "tangential_stiffness", "friction_coefficient", "preload")
        },
        residual_traction=pairs["residual_traction"].values if "residual_traction" in pairs else None,
    )
    harmonics = int(root.sizes["harmonic"])
    curves = LinearCurves(
        frequency_hz=linear["frequency"].values,
        stuck=_joined(linear, "stuck", harmonics),
        free=_joined(linear, "free", harmonics),
        stuck_frequency_hz=linear["stuck_frequency"].values,
        free_frequency_hz=linear["free_frequency"].values,
    )
    return ForcedResponse(
        frequency_hz=root["frequency"].values,
        displacement=_joined(root, "displacement", harmonics),
        **{
            name: root[name].values
            for name in (
                "contact_state",
                "dissipated_energy",
                "normal_work",
                "closure",
                "residual",
                "iterations",
                "input_energy",
                "viscous_energy",
            )
        },
        converged=bool(root.attrs["converged"]),
        message=str(root["message"].item()),
        warnings=tuple(json.loads(root["warnings"].item())),
        harmonics=harmonics,
        samples=int(root.attrs["samples"]),
        pairs=joint,
        linear=curves,
        force=_joined(root, "force", harmonics),
        settings=json.loads(root["settings"].item()),
        provenance=json.loads(root["provenance"].item()),
    )


def _study_dataset(study: StudyRecord) -> xarray.Dataset:
    import xarray

    position = "place of the pair in its face: along the length, across the width"
    outputs = np.stack(list(study.outputs.values()))
    data = {
        "title": _text(study.title, "title"),
        "description": _text(study.description, "description"),
        "inputs": _text(study.inputs, "study file"),
        "output_rows": _variable(("output", "unknown"), outputs, "1", "rows that read a displacement"),
        "output_names": _text(list(study.outputs), "names of the output rows, JSON list"),
        "signal_groups": _text(study.signal_groups, "outputs drawn together, JSON object"),
        "face_names": _text(study.face_names, "names of the contact faces, JSON list"),
        "pair_face": _variable(("pair",), study.pair_face, "1", "face of each pair"),
        "pair_position": _variable(("pair", "direction"), study.pair_position, "m", position),
        "pair_area": _variable(("pair",), study.pair_area, "m2", "nominal area of the pair"),
        "mode_table": _text(study.mode_table, "mode table, JSON list of rows"),
        "mode_contact": _text(study.mode_contact, "how the pairs were held for the mode table"),
        "derived": _text(study.derived, "derived quantities, JSON list of name, value, unit, explanation"),
        "warnings": _text(study.warnings, "warnings of the study, JSON list"),
        **_rough_variables(study.rough_patch),
    }
    return xarray.Dataset(data)


def _rough_variables(patch: RoughPatch | None) -> dict[str, tuple[Any, ...]]:
    """The picture of a rough face, where there is one."""
    if patch is None:
        return {}
    numbers = {"length": patch.length, "width": patch.width, "sq": patch.sq, "sdq": patch.sdq}
    return {
        "rough_height": _variable(("rough_across", "rough_along"), patch.height, "m", "heights of a rough face"),
        "rough_numbers": _text(numbers, "length and width of that face, Sq (m) and Sdq of its roughness, JSON object"),
    }


def _study_from(data: xarray.Dataset, sketch: Sketch | None) -> StudyRecord:
    def parsed(name: str) -> Any:
        return json.loads(data[name].item())

    return StudyRecord(
        title=str(data["title"].item()),
        description=str(data["description"].item()),
        inputs=str(data["inputs"].item()),
        outputs=dict(zip(parsed("output_names"), data["output_rows"].values, strict=True)),
        signal_groups=parsed("signal_groups"),
        face_names=parsed("face_names"),
        pair_face=data["pair_face"].values,
        pair_position=data["pair_position"].values,
        pair_area=data["pair_area"].values,
        mode_table=tuple(parsed("mode_table")),
        mode_contact=str(data["mode_contact"].item()) if "mode_contact" in data else "tied",
        derived=tuple(parsed("derived")),
        warnings=tuple(parsed("warnings")),
        rough_patch=RoughPatch(height=data["rough_height"].values, **parsed("rough_numbers"))
        if "rough_height" in data
        else None,
        sketch=sketch,
    )


def _sketch_dataset(sketch: Sketch) -> xarray.Dataset:
    import xarray

    of_point, of_side, of_load = ("point",), ("side",), ("load", "axis")
    body, face = "body of each side", "contact face that the side is part of, -1 for none"
    data = {
        "points": _variable(("point", "axis"), sketch.points, "m", "corners of the outer sides of the mesh"),
        "held": _variable(of_point, sketch.held.astype(np.int8), "1", "1 where the point is held"),
        "sides": _variable(("side", "corner"), sketch.sides.astype(np.int32), "1", "corners, seen from outside"),
        "body": _variable(of_side, sketch.body.astype(np.int32), "1", body),
        "face": _variable(of_side, sketch.face.astype(np.int32), "1", face),
        "body_names": _text(sketch.body_names, "names of the bodies, JSON list"),
        "load_names": _text(sketch.load_names, "names of the loads, JSON list"),
        "load_places": _variable(of_load, sketch.load_places, "m", "where the loads act"),
        "loads": _variable(of_load, sketch.loads, "N", "vectors of the loads, harmonic ones 0-to-peak"),
        "constant": _variable(("load",), sketch.constant.astype(np.int8), "1", "1 where the load is constant"),
        "response_names": _text(sketch.response_names, "names of the responses, JSON list"),
        "response_places": _variable(("response", "axis"), sketch.response_places, "m", "where responses are read"),
        "mesh_sides": _variable((), sketch.mesh_sides, "1", "number of outer sides of the mesh"),
        **_motion_variables(sketch.motion),
    }
    return xarray.Dataset(data)


_MOTION_OF = {"points": "point", "loads": "load", "responses": "response"}


def _motion_variables(motion: Motion | None) -> dict[str, tuple[Any, ...]]:
    """How the picture moves at the peak, where that is known."""
    if motion is None:
        return {}
    variables = {"motion_frequency": _variable((), motion.frequency_hz, "Hz", "frequency of the motion")}
    for name, dim in _MOTION_OF.items():
        what = f"displacement of the {name} at the peak of the response"
        variables |= _split(f"motion_of_{name}", getattr(motion, name), (dim, "axis"), "m", what)
    return variables


def _motion_from(data: xarray.Dataset) -> Motion | None:
    if "motion_frequency" not in data:  # younger than the format
        return None
    harmonics = int(data.sizes["harmonic"])
    parts = {name: _joined(data, f"motion_of_{name}", harmonics).astype(np.float32) for name in _MOTION_OF}
    return Motion(**parts, frequency_hz=float(data["motion_frequency"]))


def _sketch_from(data: xarray.Dataset) -> Sketch:
    def names(of: str) -> tuple[str, ...]:
        return tuple(json.loads(data[f"{of}_names"].item()))

    arrays = ("points", "sides", "body", "face", "load_places", "loads", "response_places")
    return Sketch(
        **{name: data[name].values for name in arrays},
        held=data["held"].values != 0,
        constant=data["constant"].values != 0,
        body_names=names("body"),
        load_names=names("load"),
        response_names=names("response"),
        mesh_sides=int(data["mesh_sides"]),
        motion=_motion_from(data),
    )
