"""A writer of small I-DEAS universal files (.unv) for the tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from model_writers import face_of, kind_of
from stickslip.structure.mesh import Mesh

_TYPES = {"tetra": 111, "tetra10": 118, "wedge": 112, "wedge15": 113, "hexahedron": 115, "hexahedron20": 116}
_SURFACES = {3: 91, 6: 92, 4: 94, 8: 95}
# Positions in VTK order of the nodes in the order of the file: corners and middles round each face in turn.
_ORDERS = {
    "tetra10": [0, 4, 1, 5, 2, 6, 7, 8, 9, 3],
    "wedge15": [0, 6, 1, 7, 2, 8, 12, 13, 14, 3, 9, 4, 10, 5, 11],
    "hexahedron20": [0, 8, 1, 9, 2, 10, 3, 11, 16, 17, 18, 19, 4, 12, 5, 13, 6, 14, 7, 15],
}
_OF_FACES = {6: [0, 3, 1, 4, 2, 5], 8: [0, 4, 1, 5, 2, 6, 3, 7]}


def fields(numbers: list[int], each: int = 8) -> list[str]:
    """Lines of whole numbers."""
    return ["".join(f"{n:10d}" for n in numbers[at : at + each]) for at in range(0, len(numbers), each)]


def write_unv(path: Path, mesh: Mesh, body_names: list[str], faces: list[str]) -> None:
    """A file in mm with a group for each body and face, and for each other node set."""
    text = ["    -1", "   164", "         5mm (newton)                  2", "  1.0000000000000000D+03" * 3, "    -1"]
    text += ["    -1", "  2411"]
    for label, place in enumerate(1e3 * mesh.points, start=1):
        text += [*fields([label, 1, 1, 11]), "".join(f"{x:25.16E}".replace("E", "D") for x in place)]
    text += ["    -1", "    -1", "  2412"]
    kind = kind_of(mesh).name
    groups: dict[str, list[tuple[int, int]]] = {}
    for label, (body, cell) in enumerate(zip(mesh.body, mesh.cells, strict=True), start=1):
        nodes = cell[_ORDERS.get(kind, slice(None))] + 1
        text += [*fields([label, _TYPES[kind], 1, 1, 7, len(nodes)]), *fields(nodes.tolist())]
        groups.setdefault(body_names[body], []).append((8, label))
    label = len(mesh.cells)
    for name in faces:
        for side in face_of(mesh, name):
            nodes, label = side[_OF_FACES.get(len(side), slice(None))] + 1, label + 1
            text += [*fields([label, _SURFACES[len(side)], 2, 1, 7, len(nodes)]), *fields(nodes.tolist())]
            groups.setdefault(name, []).append((8, label))
    text += [*fields([label + 1, 21, 3, 1, 7, 2]), *fields([0, 1, 1]), *fields([1, 2]), "    -1"]
    for name, members in mesh.node_sets.items():
        if name not in faces:
            groups[name] = [(7, int(node) + 1) for node in np.sort(members)]
    text += ["    -1", "  2467"]
    for number, (name, entries) in enumerate(groups.items(), start=1):
        rows = fields([n for kind_of_member, member in entries for n in (kind_of_member, member, 0, 0)])
        text += [*fields([number, 0, 0, 0, 0, 0, 0, len(entries)]), name, *rows]
    path.write_text("\n".join([*text, "    -1"]) + "\n", encoding="utf-8")
