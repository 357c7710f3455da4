"""Result files of CalculiX (``.frd``): mesh, displacements and stresses at its nodes, as ASCII."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, argument_error, finite_array, real_number
from stickslip.structure.mesh import IntArray, Mesh

# Kind of cell -> number of the type, and its nodes in the order of the format: in cells with midside nodes those of
# the edges between bottom and top come before those of the top.
_TYPES: Mapping[str, tuple[int, list[int]]] = {
    "hexahedron": (1, list(range(8))),
    "wedge": (2, list(range(6))),
    "tetra": (3, list(range(4))),
    "hexahedron20": (4, [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]),
    "wedge15": (5, [*range(9), 12, 13, 14, 9, 10, 11]),
    "tetra10": (6, list(range(10))),
}
# Components of a field as its lines describe them: name, kind (2 vector, 4 tensor), indices.
_VECTOR = (("D1", 2, 1, 0), ("D2", 2, 2, 0), ("D3", 2, 3, 0))
_TENSOR = (("SXX", 4, 1, 1), ("SYY", 4, 2, 2), ("SZZ", 4, 3, 3), ("SXY", 4, 1, 2), ("SYZ", 4, 2, 3), ("SZX", 4, 3, 1))
FIELDS = {"DISP": _VECTOR, "DISPI": _VECTOR, "STRESS": _TENSOR, "STRESSI": _TENSOR}
_NODES_OF_A_LINE = 10
_LARGEST_NUMBER = 2_147_483_647  # readers use integers of 32 bits
# Exponents have two digits in the columns of a number.
_SMALLEST, _LARGEST = 1e-99, 1e99


@dataclass(frozen=True)
class FrdStep:
    """Fields at all nodes of one step.

    frequency_hz:
        of the vibration; None for a static step.
    fields:
        "DISP" and "DISPI" (n_nodes, 3) m, "STRESS" and "STRESSI" (n_nodes, 6) Pa, components xx, yy, zz, xy, yz, zx. A
        vibration is ``Re((DISP + i DISPI) exp(i w t))``, as in steps of CalculiX for steady-state dynamics.
    """

    frequency_hz: float | None
    fields: Mapping[str, FloatArray]

    __repr__ = short_repr


def write_frd(
    path: str | PathLike[str],
    mesh: Mesh,
    steps: Sequence[FrdStep],
    node_numbers: ArrayLike | None = None,
    cell_numbers: ArrayLike | None = None,
) -> Path:
    """Write a mesh with fields as a result file of CalculiX, which cgx, PrePoMax and converters for ParaView read.

    The material number of an element is that of its body plus 1. Numbers have six digits, as the format has them;
    smaller ones than 1e-99 are 0.

    Parameters
    ----------
    path:
        file to write; its name must end in ``.frd``.
    node_numbers, cell_numbers:
        (n_nodes,) and (n_cells,) different numbers from 1 in the file; by default those of the mesh plus 1.

    Raises
    ------
    InputError
        for no steps, unknown fields, arrays of another shape, numbers above 1e99 or not finite, equal node or cell
        numbers, another suffix, and a file that cannot be written.

    Source: K. Wittig, CalculiX GraphiX User's Manual, "Result Format"; the columns are those that CalculiX 2.20 writes.
    """
    target = Path(path)
    if target.suffix != ".frd":
        raise InputError(f'"{target}" must end in .frd, the ending of result files of CalculiX.')
    if not steps:
        raise argument_error("steps", "steps is empty; give at least one FrdStep with its fields.")
    nodes = _checked("node_numbers", node_numbers, mesh.n_nodes)
    lines, blocks = [*_model_lines(mesh, nodes, _checked("cell_numbers", cell_numbers, mesh.n_cells))], 0
    for number, step in enumerate(steps, start=1):
        lines += _step_lines(nodes, number, step, blocks)
        blocks += len(step.fields)
    with whole_file(target, "results", InputError) as part:
        part.write_text("\n".join([*lines, " 9999", ""]), encoding="ascii", errors="replace")
    return target


def _checked(name: str, numbers: ArrayLike | None, count: int) -> IntArray:
    """The numbers (count,) of nodes or cells in the file. Raises InputError."""
    if numbers is None:
        return np.arange(1, count + 1)
    array = np.asarray(numbers)
    if array.shape != (count,) or array.dtype.kind not in "iu":
        raise argument_error(name, f"{name} must be {count} whole numbers, but it is an array {array.shape}.")
    if array.min() < 1 or array.max() > _LARGEST_NUMBER or np.unique(array).size < count:
        raise argument_error(name, f"{name} must be different numbers from 1 to {_LARGEST_NUMBER}.")
    return array.astype(np.int64)


def _model_lines(mesh: Mesh, nodes: IntArray, numbers: IntArray) -> Iterator[str]:
    yield "    1C"
    yield f"    1U{'PGM':<18}{'stickslip':<48}"
    for number, name in enumerate(mesh.body_names, start=1):
        yield f"    1UMAT{number:5d}{name[:58]:<58}"
    yield f"    2C{'':18}{mesh.n_nodes:12d}{'':37}1"
    for number, point in zip(nodes, mesh.points, strict=True):
        yield f" -1{number:10d}{_numbers('points', point)}"
    yield " -3"
    yield f"    3C{'':18}{mesh.n_cells:12d}{'':37}1"
    first_cell = 0
    for block in mesh.blocks:
        kind, order = _TYPES[block.kind]
        own = numbers[first_cell : first_cell + len(block.cells)]
        first_cell += len(block.cells)
        for number, cell, body in zip(own, nodes[block.cells[:, order]], block.body, strict=True):
            yield f" -1{number:10d}{kind:5d}{0:5d}{body + 1:5d}"
            for first in range(0, len(cell), _NODES_OF_A_LINE):
                yield " -2" + "".join(f"{node:10d}" for node in cell[first : first + _NODES_OF_A_LINE])
    yield " -3"


def _step_lines(nodes: IntArray, number: int, step: FrdStep, before: int) -> Iterator[str]:
    """The blocks of a step with this number, which follow ``before`` other blocks. Raises InputError."""
    is_static = step.frequency_hz is None
    value = float(number) if step.frequency_hz is None else real_number("frequency_hz", step.frequency_hz)
    for block, (name, given) in enumerate(step.fields.items(), start=before + 1):
        if name not in FIELDS:
            raise argument_error("fields", f'"{name}" is not a field of this file. Use {", ".join(FIELDS)}.')
        components, values = FIELDS[name], finite_array(name, given)
        if values.shape != (nodes.size, len(components)):
            raise argument_error(
                name,
                f"{name} must have shape ({nodes.size}, {len(components)}), one row for each node, but its shape is "
                f"{values.shape}.",
            )
        yield f"    1PSTEP{'':16}{block:10d}{1:12d}{number:12d}{'':10}"
        kind = 0 if is_static else 1
        yield f"  100CL{100 + number:5d}{value:12.9g}{nodes.size:12d}{'':20}{kind:2d}{number:5d}{'':10}{1:2d}"
        # The size of a vector is one more component, which the reader computes.
        extra = 1 if components is _VECTOR else 0
        yield f" -4  {name:<8}{len(components) + extra:5d}{1:5d}"
        for label, shape, first, second in components:
            yield f" -5  {label:<8}{1:5d}{shape:5d}{first:5d}{second:5d}"
        if extra:
            yield f" -5  {'ALL':<8}{1:5d}{2:5d}{0:5d}{0:5d}{1:5d}ALL"
        for node, row in zip(nodes, values, strict=True):
            yield f" -1{node:10d}{_numbers(name, row)}"
        yield " -3"


def _numbers(name: str, row: FloatArray) -> str:
    """Numbers in columns of 12. Raises InputError for a number that is too large for its column."""
    if np.abs(row).max() >= _LARGEST:
        raise argument_error(name, f"{name} contains {row[np.abs(row).argmax()]:g}, but at most 1e99 fits in the file.")
    return "".join(f"{0.0 if abs(value) < _SMALLEST else value:12.5E}" for value in row.tolist())
