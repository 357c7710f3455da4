"""Input files of CalculiX from our models: the same mesh, material and supports in another program."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.validation import require_choice
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import IntArray, Mesh

Step = Literal["frequency", "matrices"]

BRICKS = ("C3D8I", "C3D8")
# Element types of CalculiX for our other kinds of cells. Its node order is that of VTK for all of them.
ELEMENT_TYPES = {"hexahedron20": "C3D20", "tetra": "C3D4", "tetra10": "C3D10", "wedge": "C3D6", "wedge15": "C3D15"}
_MOST_CHARACTERS = 20  # of a number
# Stresses 11, 22, 33, 12, 13, 23 of CalculiX in the order xx, yy, zz, xy, yz, zx of an elastic matrix.
_CALCULIX_ORDER = [0, 1, 2, 3, 5, 4]


class TiedPairs(Protocol):
    """Pairs of coincident nodes to tie."""

    @property
    def first_node(self) -> IntArray: ...

    @property
    def second_node(self) -> IntArray: ...


def write_calculix_deck(
    path: str | PathLike[str],
    mesh: Mesh,
    materials: Material | Sequence[Material],
    *,
    element: str = "C3D8I",
    fixed_nodes: ArrayLike | None = None,
    pairs: TiedPairs | None = None,
    step: Step = "frequency",
    count: int = 10,
) -> Path:
    """Write a model as an input file (``.inp``) in m, N, kg, s; node numbers count from 1 (those of the mesh plus 1).

    Parameters
    ----------
    materials:
        one for all bodies, or one for each.
    element:
        type of 8-node bricks: ``C3D8I`` (incompatible modes) or ``C3D8``. Every other kind of cell has one type.
    fixed_nodes:
        nodes to constrain; by default those of the node set ``fixed``.
    pairs:
        node pairs to tie: the second node's displacements follow the first one's (``*EQUATION``).
    step:
        ``frequency``: natural frequencies into the ``.dat`` file; ``matrices``: K and M into ``.sti``, ``.mas`` and the
        map of their unknowns into ``.dof``, which :func:`read_matrices` reads.
    count:
        number of frequencies.

    Node sets of the mesh are written under their names.

    Raises
    ------
    InputError
        for an element or step that does not exist, a number of materials that is not that of the bodies, and a
        file that cannot be written.
    """
    target = Path(path)
    if target.suffix != ".inp":
        raise InputError(f'"{target}" must end in .inp, the ending of CalculiX input files.')
    require_choice("step", step, ("frequency", "matrices"))
    require_choice("element", element, BRICKS)
    blocks = mesh.cell_arrays()
    types = [element if kind == "hexahedron" else ELEMENT_TYPES[kind] for kind, _ in blocks]
    n_bodies = int(mesh.body.max()) + 1
    each = [materials] * n_bodies if isinstance(materials, Material) else list(materials)
    if len(each) != n_bodies:
        raise InputError(
            f"materials has {len(each)} entries, but the mesh has {n_bodies} bodies; give one for each.",
            arguments=["materials"],
        )
    if fixed_nodes is None:
        fixed_nodes = mesh.node_sets.get("fixed", ())
    fixed = np.unique(np.asarray(fixed_nodes, dtype=np.int64))
    parts = [
        _mesh_lines(mesh, blocks, types),
        _set_lines(mesh, fixed),
        _equation_lines(pairs) if pairs is not None else (),
        _material_lines(each),
        _step_lines(step, count),
    ]
    with whole_file(target, "CalculiX input", InputError) as part:
        part.write_text("\n".join(line for lines in parts for line in lines) + "\n", encoding="ascii")
    return target


def _mesh_lines(mesh: Mesh, blocks: Sequence[tuple[str, IntArray]], types: Sequence[str]) -> Iterator[str]:
    yield "*NODE, NSET=all_nodes"
    for number, (x, y, z) in enumerate(mesh.points.tolist(), start=1):
        yield f"{number}, {_number(x)}, {_number(y)}, {_number(z)}"
    first = 0
    for (_, cells), name in zip(blocks, types, strict=True):
        body = mesh.body[first : first + len(cells)]
        for number in np.unique(body):
            yield f"*ELEMENT, TYPE={name}, ELSET=body_{number}"
            for at in np.flatnonzero(body == number):
                yield from _wrapped([int(first + at + 1), *(cells[at] + 1)])
        first += len(cells)


def _set_lines(mesh: Mesh, fixed: IntArray) -> Iterator[str]:
    for name, nodes in mesh.node_sets.items():
        if nodes.size:
            yield f"*NSET, NSET=set_{name}"
            yield from _wrapped(nodes + 1)
    if fixed.size:
        yield "*NSET, NSET=clamped"
        yield from _wrapped(fixed + 1)
        yield "*BOUNDARY"
        yield "clamped, 1, 3"


def _number(value: float) -> str:
    """Every digit of a number, or those that CalculiX reads: it truncates after 20 characters, also an exponent."""
    exact = repr(float(value))
    return exact if len(exact) <= _MOST_CHARACTERS else f"{value:.13e}"


def _wrapped(numbers: Iterable[int]) -> Iterator[str]:
    """Lines of at most 16 numbers; a line that continues ends in a comma."""
    words = [str(number) for number in numbers]
    lines = [", ".join(words[at : at + 16]) for at in range(0, len(words), 16)]
    yield from (f"{line}," for line in lines[:-1])
    yield lines[-1]


def _equation_lines(pairs: TiedPairs) -> Iterator[str]:
    for first, second in zip(pairs.first_node.tolist(), pairs.second_node.tolist(), strict=True):
        for axis in (1, 2, 3):
            yield "*EQUATION"
            yield "2"
            yield f"{second + 1}, {axis}, 1.0, {first + 1}, {axis}, -1.0"


def _material_lines(materials: Sequence[Material]) -> Iterator[str]:
    for number, material in enumerate(materials):
        yield f"*MATERIAL, NAME=material_{number}"
        if material.elastic is None:
            yield "*ELASTIC"
            yield f"{_number(material.young_modulus)}, {_number(material.poisson_ratio)}"
        else:
            # D1111, D1122, D2222, D1133 ...: the upper triangle column by column, in the order 11, 22, 33, 12, 13, 23
            matrix = material.elastic_matrix()[np.ix_(_CALCULIX_ORDER, _CALCULIX_ORDER)]
            values = [_number(matrix[row, column]) for column in range(6) for row in range(column + 1)]
            yield "*ELASTIC, TYPE=ANISOTROPIC"
            yield from (", ".join(values[at : at + 8]) for at in range(0, 24, 8))
        yield "*DENSITY"
        yield _number(material.density)
        yield f"*SOLID SECTION, ELSET=body_{number}, MATERIAL=material_{number}"


def _step_lines(step: Step, count: int) -> Iterator[str]:
    yield "*STEP"
    yield "*FREQUENCY" if step == "frequency" else "*FREQUENCY, SOLVER=MATRIXSTORAGE"
    yield str(count)
    yield "*END STEP"
