"""The exchange format: a superelement in one ``.npz`` file, specified in docs/matrices.md."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np

from stickslip.core.errors import ImportFileError, InputError
from stickslip.core.files import whole_file
from stickslip.formats.matrices.model import OTHER, MatrixModel
from stickslip.formats.matrices.source import errors_naming, numpy_arrays
from stickslip.structure.mesh import IntArray
from stickslip.structure.superelement import Superelement, require_no_gyroscopic

FORMAT = "stickslip superelement"
FORMAT_VERSION = 1  # raised when older code cannot read a new file
FILE_NAME = "superelement.npz"
_SET = "set_"


def write_superelement(path: str | PathLike[str], superelement: Superelement) -> Path:
    """Write a superelement, its unknown map, positions and node sets to one ``.npz`` file, completely or not at all.

    ``path`` is the file, or a folder for ``superelement.npz``. The recovery is not stored: it belongs to the program
    that has the full model. Raises ImportFileError where the file cannot be written, and InputError for a superelement
    with a gyroscopic matrix or with relative displacements of contact pairs as unknowns, which the format does not
    contain.
    """
    require_no_gyroscopic(superelement, "the exchange format")
    if superelement.joint_rows is not None:
        raise InputError(
            f"superelement contains the relative displacements of {superelement.joint_rows.shape[0] // 3} contact "
            "pairs as unknowns, which the exchange format does not contain. Reduce to all nodes of the pairs with "
            "craig_bampton.",
            arguments=["superelement"],
        )
    target = Path(path)
    if target.is_dir():
        target = target / FILE_NAME
    nodes = superelement.boundary_nodes
    n_other = superelement.size - 3 * len(nodes)
    arrays = {
        "format": np.array(FORMAT),
        "format_version": np.array(FORMAT_VERSION),
        "mass": superelement.mass,
        "stiffness": superelement.stiffness,
        "node": np.concatenate([np.repeat(nodes, 3), np.full(n_other, -1, dtype=np.int64)]),
        "direction": np.concatenate([np.tile(np.arange(3), len(nodes)), np.full(n_other, OTHER)]),
    }
    if superelement.damping is not None:
        arrays["damping"] = superelement.damping
    if superelement.positions is not None:
        arrays |= {"node_labels": nodes, "position": superelement.positions}
    arrays |= {f"{_SET}{name}": members for name, members in superelement.node_sets.items()}
    with whole_file(target, "superelement", ImportFileError) as part, part.open("wb") as stream:
        np.savez_compressed(stream, allow_pickle=False, **arrays)
    return target


def read_superelement(path: str | PathLike[str]) -> Superelement:
    """Read a superelement from the exchange format: a ``.npz`` file, or a folder with ``superelement.npz``.

    Nodes with all of x, y, z become boundary nodes, in the order of their first row; all other unknowns follow in the
    order of the file. Raises ImportFileError, naming the file and the array, for a file that is missing, damaged, of
    another format or version, or whose arrays are not a superelement.
    """
    source = Path(path)
    if source.is_dir():
        source = source / FILE_NAME
    if source.is_file() and source.suffix.lower() != ".npz":
        raise ImportFileError(
            f'"{source}" is not a superelement, an .npz file in the format of docs/matrices.md. Use read_matrices for '
            "stiffness and mass in other files (structure.stiffness and structure.mass in a study), and read_model for "
            'a mesh (structure.kind = "mesh").'
        )
    arrays = numpy_arrays(source)
    if arrays.get("format") is None or str(arrays["format"]) != FORMAT:
        raise ImportFileError(
            f'"{source}" is not a stickslip superelement: its array "format" must be "{FORMAT}". docs/matrices.md '
            "describes the arrays; use read_matrices for matrices in other arrays."
        )
    version = arrays.get("format_version", np.array("missing"))
    if version.shape != () or version.dtype.kind not in "iu" or int(version) != FORMAT_VERSION:
        raise ImportFileError(
            f'"{source}" has format_version {version}, but this version of stickslip reads {FORMAT_VERSION}.'
        )
    missing = [name for name in ("mass", "stiffness", "node", "direction") if name not in arrays]
    if missing:
        raise ImportFileError(f'"{source}" lacks the array "{missing[0]}"; it has: {", ".join(sorted(arrays))}.')
    if ("position" in arrays) != ("node_labels" in arrays):
        raise ImportFileError(f'"{source}" must have both "position" and "node_labels", or neither.')
    with errors_naming(source):
        model = MatrixModel(
            stiffness=arrays["stiffness"],
            mass=arrays["mass"],
            damping=arrays.get("damping"),
            node=arrays["node"],
            direction=arrays["direction"],
            node_labels=arrays.get("node_labels", np.empty(0, dtype=np.int64)),
            position=arrays.get("position"),
            node_sets={name.removeprefix(_SET): part for name, part in arrays.items() if name.startswith(_SET)},
        )
        return as_superelement(model)


def as_superelement(model: MatrixModel) -> Superelement:
    """The matrices of a small model as they are, with the unknowns in the order of a superelement.

    Raises InputError for a node set with a node that has not all of x, y, z, and for missing positions.
    """
    nodes, boundary = boundary_unknowns(model)
    order = np.concatenate([boundary, np.setdiff1d(np.arange(model.size), boundary)])
    return Superelement(
        mass=model.mass[order][:, order],
        stiffness=model.stiffness[order][:, order],
        damping=None if model.damping is None else model.damping[order][:, order],
        boundary_nodes=nodes,
        positions=model.positions_of(nodes),
        node_sets=model.node_sets,
    )


def boundary_unknowns(model: MatrixModel) -> tuple[IntArray, IntArray]:
    """Nodes (k,) that have all of x, y, z, in the order of their first row, and their unknowns (3 k,) x, y, z."""
    moving = np.flatnonzero((model.direction < 3) & (model.node >= 0))
    nodes, first, count = np.unique(model.node[moving], return_index=True, return_counts=True)
    nodes = nodes[count == 3][np.argsort(first[count == 3])]
    row = {(int(model.node[i]), int(model.direction[i])): int(i) for i in moving}
    unknowns = [row[(int(node), axis)] for node in nodes for axis in range(3)]
    return nodes.astype(np.int64), np.array(unknowns, dtype=np.int64)
