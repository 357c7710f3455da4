"""A writer of small Ansys archives (.cdb) for the tests, in the layout of CDWRITE."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from model_writers import STEEL_MM, face_of, kind_of
from stickslip.structure.mesh import Mesh

# Bricks collapsed as the element reference of SOLID185 and SOLID186 says.
_COLLAPSED = {"tetra": [0, 1, 2, 2, 3, 3, 3, 3], "wedge": [0, 1, 2, 2, 3, 4, 5, 5]}
_COLLAPSED |= {
    "tetra10": [0, 1, 2, 2, 3, 3, 3, 3, 4, 5, 2, 6, 3, 3, 3, 3, 7, 8, 9, 9],
    "wedge15": [0, 1, 2, 2, 3, 4, 5, 5, 6, 7, 2, 8, 9, 10, 5, 11, 12, 13, 14, 14],
}


def block_rows(numbers: list[int], width: int = 10, each: int = 8) -> list[str]:
    """Numbers in fields of equal width."""
    return ["".join(f"{n:{width}d}" for n in numbers[at : at + each]) for at in range(0, len(numbers), each)]


_TRIANGLES = {3: [0, 1, 2, 2], 6: [0, 1, 2, 2, 3, 4, 2, 5]}  # of contact elements; targets have 3 or 6 nodes
_NATIVE = {"hexahedron": 185, "hexahedron20": 186, "tetra": 285, "tetra10": 187}


def write_cdb(path: Path, mesh: Mesh, faces: list[str], fixed: str, collapse: bool = True) -> None:
    """An archive in mm, t, s: one material a body, node components, a clamped set, and the first face on the second."""
    kind = kind_of(mesh).name
    is_quadratic = kind_of(mesh).is_quadratic
    number = 186 if is_quadratic else 185
    if kind in _NATIVE and not (collapse and kind in _COLLAPSED):
        number = _NATIVE[kind]
    text = ["/COM, written by a test", "/PREP7", f"ET,1,{number}", f"ET,2,{174 if is_quadratic else 173}"]
    text += ["ET,3,TARGE170", "KEYOP,2,12,0", f"NBLOCK,6,SOLID,{mesh.n_nodes},{mesh.n_nodes}", "(3i9,6e21.13e3)"]
    for label, place in enumerate(1e3 * mesh.points, start=1):
        text.append(f"{label:9d}{0:9d}{0:9d}" + "".join(f"{x:21.13E}" for x in place))
    text += ["N,R5.3,LOC,       -1,", "EBLOCK,19,SOLID,0,0", "(19i10)"]
    order = _COLLAPSED[kind] if number in (185, 186) and kind in _COLLAPSED else slice(None)
    elements = [(int(body) + 1, 1, 1, *cell[order] + 1) for body, cell in zip(mesh.body, mesh.cells, strict=True)]
    for side, name in enumerate(faces):
        nodes = face_of(mesh, name) + 1
        nodes = nodes[:, _TRIANGLES[nodes.shape[1]]] if side == 0 and nodes.shape[1] in _TRIANGLES else nodes
        elements += [(3, 2 + side, 5, *row) for row in nodes]
    for label, (material, of_type, real, *cell) in enumerate(elements, start=1):
        head = [material, of_type, real, 1, 0, 0, 0, 0, len(cell), 0, label]
        rows = [[*head, *cell[:8]], *([cell[8:]] if len(cell) > 8 else [])]
        text += ["".join(f"{n:10d}" for n in row) for row in rows]
    text.append("        -1")
    for name, members in mesh.node_sets.items():
        labels = np.sort(members + 1).tolist()
        text += [f"CMBLOCK,{name.upper():8},NODE,{len(labels):8d}  ! of a test", "(8i10)", *block_rows(labels)]
    for material in range(1, int(mesh.body.max()) + 2):
        for constant, value in zip(("EX  ", "PRXY", "DENS"), STEEL_MM, strict=True):
            text.append("MPTEMP,R5.0, 1, 1,  0.00000000    ,")
            text.append(f"MPDATA,R5.0, 1,{constant},{material:8d}, 1, {value:.12g}    ,")
    text.append("MPDATA,R5.0, 1,MU  ,       3, 1, 0.2    ,")
    for label in np.sort(mesh.node_sets[fixed] + 1):
        text += [f"D,{label:7d},{axis},  0.00000000    ,  0.00000000    " for axis in ("UX", "UY", "UZ")]
    text += ["ACEL,  0.00000000    ,  0.00000000    ,  0.00000000", "/GO", "FINISH"]
    path.write_text("\n".join(text) + "\n", encoding="utf-8")
