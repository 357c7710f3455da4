"""One function that reads stiffness, mass and damping from all supported kinds of files."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.core.errors import ImportFileError, concerning
from stickslip.formats.matrices.ansys_full import ansys_full
from stickslip.formats.matrices.arrays import matlab_matrices, numpy_matrices
from stickslip.formats.matrices.checks import checked_matrix
from stickslip.formats.matrices.coordinates import Matrices, calculix_matrix, matrix_market
from stickslip.formats.matrices.harwell_boeing import harwell_boeing
from stickslip.formats.matrices.model import OTHER, MatrixModel
from stickslip.formats.matrices.output4 import output4
from stickslip.formats.matrices.source import errors_naming
from stickslip.formats.matrices.unknown_map import read_node_positions, read_unknown_map
from stickslip.formats.meshes.unit_systems import find_unit_system
from stickslip.structure.mesh import IntArray

FilePath = str | PathLike[str]

_READERS: dict[str, Callable[[Path], Matrices]] = {
    ".mtx": matrix_market,
    ".mm": matrix_market,
    ".npy": numpy_matrices,
    ".npz": numpy_matrices,
    ".mat": matlab_matrices,
    ".sti": calculix_matrix,
    ".mas": calculix_matrix,
    ".hb": harwell_boeing,
    ".rsa": harwell_boeing,
    ".rua": harwell_boeing,
    ".matrix": harwell_boeing,
    ".op4": output4,
    ".full": ansys_full,
}
# Names of matrices in files of other programs that contain several.
_NAMES = {
    "stiffness": ("stiffness", "k", "kgg", "kaa", "kxx"),
    "mass": ("mass", "m", "mgg", "maa", "mxx"),
    "damping": ("damping", "c", "bgg", "baa", "bxx"),
}


def read_matrices(
    stiffness: FilePath,
    mass: FilePath,
    damping: FilePath | None = None,
    unknown_map: FilePath | None = None,
    node_positions: FilePath | None = None,
    *,
    length_unit: str = "m",
    unit_system: str | None = None,
) -> MatrixModel:
    """Matrices of another program as a checked model in SI units.

    Parameters
    ----------
    stiffness, mass, damping:
        files: Matrix Market (``.mtx``, ``.mm``), NumPy (``.npy``, ``.npz``), MATLAB (``.mat``), CalculiX (``.sti``,
        ``.mas``), Harwell-Boeing (``.hb``, ``.rsa``, ``.rua``, ``.matrix``), Nastran OUTPUT4 (``.op4``), Ansys
        (``.full``, extra ``stickslip[ansys]``). Of several matrices in a file the function takes the one with a usual
        name (K, M, C, stiffness, KGG ...), or that after ``#``: ``"model.mat#Kred"``.
    unknown_map:
        file with node and direction of each row (:func:`read_unknown_map`). By default the ``.dof`` beside a ``.sti``,
        the ``.mapping`` beside a ``.matrix``, and the map inside a ``.full``; without any of them unknown ``i``
        (counted from 0) is node ``i``, with no direction.
    node_positions:
        file with lines ``node, x, y, z`` in ``length_unit`` (:func:`read_node_positions`).
    length_unit, unit_system:
        consistent units of the files, as for meshes (:func:`find_unit_system`): mm alone means mm, t, s, N.

    Raises
    ------
    ImportFileError
        which names the file and the line or entry: for a missing, damaged or unknown file, a map with another number of
        rows, and matrices that :class:`MatrixModel` rejects.
    InputError
        for an unknown unit.
    MissingPackageError
        for a ``.full`` file without the extra.
    """
    units = find_unit_system(length_unit, unit_system)
    contents: dict[Path, Matrices] = {}  # a file with several matrices is read once
    files = {"stiffness": stiffness, "mass": mass, "damping": damping}
    matrices: dict[str, Any] = {}
    for name, file in files.items():
        if file is not None:
            with concerning(name):
                matrices[name] = _matrix(str(file), name, contents)
    source = Path(str(stiffness).partition("#")[0])
    size = matrices["stiffness"].shape[0]
    for name, matrix in matrices.items():
        if matrix.shape != (size, size):
            raise ImportFileError(
                f'the {name} in "{files[name]}" has shape {matrix.shape}, but the stiffness in "{stiffness}" has '
                f"{size} rows; all must be square and have the same size.",
                tuple(dict.fromkeys((name, "stiffness"))),
            )
    with concerning("stiffness" if unknown_map is None else "unknown_map"):
        node, direction = _unknowns(source, unknown_map, size, contents)
    scale = _unknown_scale(direction, units.length)
    factor = {"stiffness": units.mass / units.time**2, "mass": units.mass, "damping": units.mass / units.time}
    labels, position = np.empty(0, dtype=np.int64), None
    if node_positions is not None:
        with concerning("node_positions"):
            labels, position = read_node_positions(Path(node_positions))
        position = position * units.length
    messages = []
    for name, matrix in matrices.items():
        with (
            concerning(name),
            errors_naming(Path(str(files[name]))),
        ):  # the model checks again, but without names of files
            matrix, message = checked_matrix(name, matrix, node, direction)
        matrices[name] = factor[name] * (scale @ matrix @ scale)
        messages += [f'"{files[name]}": {message}'] if message else []
    with concerning("stiffness"), errors_naming(source):
        return MatrixModel(
            **matrices,
            node=node,
            direction=direction,
            node_labels=labels,
            position=position,
            messages=tuple(messages),
        )


def _unknown_scale(direction: IntArray, metres: float) -> Any:
    """Diagonal D with ``M_SI = (kg in the unit of mass) D M D``: 1 for displacements, whose unit is ``metres``.

    Rotations are in rad in any system, and other unknowns keep their numbers: their entries are energies of the file's
    units, which contain the square of a length. Without a map all unknowns are displacements.
    """
    displacement = (direction < 3) | (direction.min() == OTHER)
    return scipy.sparse.diags(np.where(displacement, 1.0, metres), format="csr")


def _unknowns(
    source: Path, unknown_map: FilePath | None, size: int, contents: dict[Path, Matrices]
) -> tuple[IntArray, IntArray]:
    """Node and direction of each row; raises ImportFileError where the map has another number of rows."""
    if unknown_map is None and source.suffix.lower() == ".full":
        node, direction = contents[source]["unknowns"].T
        return node, direction
    if unknown_map is None:
        beside = {".sti": ".dof", ".matrix": ".mapping"}.get(source.suffix.lower())
        path = source.with_suffix(beside) if beside else None
        if path is None or not path.exists():
            return np.arange(size), np.full(size, OTHER)
    else:
        path = Path(unknown_map)
    node, direction = read_unknown_map(path)
    if len(node) != size:
        raise ImportFileError(
            f'"{path}" names {len(node)} unknowns, but the stiffness in "{source}" has {size} rows; the map must have '
            "one line for each row, in the same order."
        )
    return node, direction


def _matrix(source: str, role: str, contents: dict[Path, Matrices]) -> Any:
    """The matrix of a file: that after ``#``, or the one with a name for its role."""
    file, _, wanted = source.partition("#")
    path = Path(file)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise ImportFileError(
            f'"{path}" ends in "{path.suffix}", but files of matrices must end in: {", ".join(_READERS)}.'
        )
    if path not in contents:
        contents[path] = reader(path)
    content = contents[path]
    if wanted:
        names = [name for name in content if name == wanted]
    elif len(content) == 1 and not any(next(iter(content)).lower() in names for names in _NAMES.values()):
        names = list(content)
    else:
        names = [name for name in content if name.lower() in _NAMES[role]]
    if len(names) != 1:
        shown = ", ".join(f"{name} {matrix.shape}" for name, matrix in sorted(content.items())) or "none"
        raise ImportFileError(
            f'"{path}" has no unique {role} matrix; it has: {shown}. Give the name of the matrix after #, '
            f'such as "{path.name}#{_NAMES[role][1].upper()}".'
        )
    return content[names[0]]
