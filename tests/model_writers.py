"""Writers of small model files for the tests of the importers, by hand or through meshio."""

from __future__ import annotations

from pathlib import Path
from unittest.mock import patch

import meshio
import numpy as np
from meshio._mesh import topological_dimension

from stickslip.structure.cell_kinds import CORNERS_OF_SIDE, KIND_OF_SIZE, CellKind
from stickslip.structure.mesh import Mesh

STEEL_MM = (210_000.0, 0.3, 7.85e-9)  # MPa, -, t/mm3
ABAQUS_TYPES = {"hexahedron": "C3D8I", "hexahedron20": "C3D20", "tetra": "C3D4", "tetra10": "C3D10"}
ABAQUS_TYPES |= {"wedge": "C3D6", "wedge15": "C3D15"}
SURFACES = {3: "triangle", 6: "triangle6", 4: "quad", 8: "quad8"}
VTK_TO_NASTRAN = {"hexahedron20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]}
VTK_TO_NASTRAN |= {"wedge15": [*range(9), 12, 13, 14, 9, 10, 11]}
NASTRAN_TYPES = {"hexahedron": "CHEXA", "tetra": "CTETRA", "wedge": "CPENTA"}


def kind_of(mesh: Mesh) -> CellKind:
    """The kind of the cells of a mesh, which are of one kind."""
    (block,) = mesh.blocks
    return KIND_OF_SIZE[block.cells.shape[1]]


def face_of(mesh: Mesh, name: str) -> np.ndarray:
    """Sides of a face, which are of one kind."""
    (sides,) = mesh.sides(name)
    return sides


def rows(numbers: list[object], width: int = 8) -> str:
    """Comma lists, continued lines ending in a comma."""
    parts = [numbers[at : at + width] for at in range(0, len(numbers), width)]
    return ",\n".join(", ".join(map(str, part)) for part in parts)


def write_inp(path: Path, mesh: Mesh, body_names: list[str], faces: list[str], fixed: str) -> None:
    """A deck in mm, t, s with one element set, section and material a body, surfaces and a clamped node set."""
    young, poisson, density = STEEL_MM
    text = ["*HEADING", "written by a test", "*NODE, NSET=everything"]
    text += [f"{n + 1}, {x:.12g}, {y:.12g}, {z:.12g}" for n, (x, y, z) in enumerate(1e3 * mesh.points)]
    for number, name in enumerate(body_names):
        text.append(f"*ELEMENT, TYPE={ABAQUS_TYPES[kind_of(mesh).name]}, ELSET={name}")
        text += [rows([int(cell) + 1, *(mesh.cells[cell] + 1)]) for cell in np.flatnonzero(mesh.body == number)]
    for name in mesh.node_sets:
        if name not in faces:
            text += [f"*NSET, NSET={name}", rows(list(mesh.node_sets[name] + 1))]
    for name in faces:
        text.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        text += [f"{cell + 1}, S{side + 1}" for cell, side in sides_of(mesh, name)]
    text += ["*MATERIAL, NAME=steel", "*ELASTIC", f"{young}, {poisson}", "*DENSITY", f"{density}"]
    text += [f"*SOLID SECTION, ELSET={name.upper()}, MATERIAL=Steel" for name in body_names]
    text += ["*BOUNDARY", f"{fixed}, 1, 3"]
    path.write_text("\n".join(text) + "\n", encoding="utf-8")


def rotation_matrix(start: np.ndarray, stop: np.ndarray, angle_degrees: float) -> np.ndarray:
    """R = I + sin(w) K + (1 - cos(w)) K K of a right-handed turn about the axis from start to stop."""
    x, y, z = (stop - start) / np.linalg.norm(stop - start)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = np.radians(angle_degrees)
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)


def write_parts(path: Path, mesh: Mesh, body_names: list[str], faces: list[str], fixed: str) -> None:
    """The deck of :func:`write_inp` with a part for each body, numbered from 1 and drawn elsewhere, and its instance.

    Sets and surfaces stand in the assembly; no node may belong to two bodies.
    """
    young, poisson, density = STEEL_MM
    parts, instances, nodes_of = [], [], []
    sets: list[str] = []
    for number, name in enumerate(body_names):
        cells = np.flatnonzero(mesh.body == number)
        nodes = np.unique(mesh.cells[cells])
        nodes_of.append((nodes, cells))
        move, start, stop = np.array([1.5, -2.0 - number, 4.0]), np.array([3.0, 1.0, -2.0]), np.array([1.0, 2.0, 5.0])
        angle = 37.0 + 60.0 * number
        drawn = (1e3 * mesh.points[nodes] - start) @ rotation_matrix(start, stop, angle) + start - move
        parts += [f"*Part, name=part-{name}", "*Node"]
        parts += [f"{n + 1}, " + ", ".join(map(repr, place)) for n, place in enumerate(drawn.tolist())]
        parts.append(f"*Element, type={ABAQUS_TYPES[kind_of(mesh).name]}")
        parts += [rows([n + 1, *(np.searchsorted(nodes, mesh.cells[cell]) + 1)]) for n, cell in enumerate(cells)]
        parts += ["*Elset, elset=all, generate", f"1, {len(cells)}, 1"]
        parts += ["*Solid Section, elset=ALL, material=Steel", ",", "*End Part"]
        instances += [f"*Instance, name={name}, part=PART-{name}", ", ".join(map(str, move))]
        instances += [", ".join(map(str, [*start, *stop, angle])), "*End Instance"]
    for name in mesh.node_sets:
        for body, (nodes, _) in zip(body_names, nodes_of, strict=True):
            mine = np.flatnonzero(np.isin(nodes, mesh.node_sets[name]))
            if name not in faces and mine.size:
                sets += [f"*Nset, nset={name}, instance={body.upper()}", rows(list(mine + 1))]
    for name in faces:
        actual = sides_of(mesh, name)
        for side in sorted({side for _, side in actual}):
            for body, (_, cells) in zip(body_names, nodes_of, strict=True):
                mine = np.flatnonzero(np.isin(cells, [cell for cell, each in actual if each == side]))
                if mine.size:
                    sets += [f"*Elset, elset=_{name}_S{side + 1}, internal, instance={body}", rows(list(mine + 1))]
        sets.append(f"*Surface, type=ELEMENT, name={name}")
        sets += [f"_{name}_S{side + 1}, S{side + 1}" for side in sorted({side for _, side in actual})]
    text = ["*Heading", "written by a test", *parts, "*Assembly, name=Assembly", *instances, *sets, "*End Assembly"]
    text += ["*Material, name=STEEL", "*Density", f"{density},", "*Elastic", f"{young}, {poisson}"]
    text += ["*Boundary", f"{fixed}, 1, 3"]
    path.write_text("\n".join(text) + "\n", encoding="utf-8")


def sides_of(mesh: Mesh, name: str) -> list[tuple[int, int]]:
    """(cell, position of the side) of a face given by its node set."""
    wanted = {tuple(sorted(side)) for side in face_of(mesh, name).tolist()}
    return [
        (number, position)
        for number, cell in enumerate(mesh.cells)
        for position, side in enumerate(kind_of(mesh).sides)
        if tuple(sorted(cell[side].tolist())) in wanted
    ]


def write_bdf(path: Path, mesh: Mesh, body_names: list[str], faces: list[str], fixed: str, large: bool) -> None:
    """Bulk data in mm, t, s: PSOLID a body, shells on the faces, SPC1 on the fixed nodes."""
    young, poisson, density = STEEL_MM
    text = ["SOL 103", "CEND", "SPC = 1", "BEGIN BULK"]
    for n, point in enumerate(1e3 * mesh.points):
        if large:
            x, y, z = (f"{value:16.9f}" for value in point)
            text += [f"GRID*   {n + 1:16d}{'':16s}{x}{y}", f"*       {z}"]
        else:
            text.append(f"GRID,{n + 1},,{point[0]:.12g},{point[1]:.12g},{point[2]:.12g}")
    name = next(card for kind, card in NASTRAN_TYPES.items() if kind_of(mesh).name.startswith(kind))
    order = VTK_TO_NASTRAN.get(kind_of(mesh).name, list(range(kind_of(mesh).n_nodes)))
    for number, cell in enumerate(mesh.cells):
        fields = [number + 1, mesh.body[number] + 1, *(cell[order] + 1)]
        parts = [fields[at : at + 8] for at in range(0, len(fields), 8)]
        text += [f"{name if not at else '':8s}" + "".join(f"{v:8d}" for v in part) for at, part in enumerate(parts)]
    label = len(mesh.cells) + 1
    for position, face in enumerate(faces):
        text.append(f'$HMNAME PROP {100 + position}"{face}" 5')
        for side in face_of(mesh, face):
            corners = side[: CORNERS_OF_SIDE[len(side)]] + 1
            text.append(
                f"{'CTRIA3' if len(corners) == 3 else 'CQUAD4'},{label},{100 + position}," + ",".join(map(str, corners))
            )
            label += 1
    for number, body in enumerate(body_names):
        text += [f'$HMNAME PROP {number + 1}"{body}" 5', f"PSOLID,{number + 1},7"]
    text.append(f"MAT1,7,{young},,{poisson},{density}")
    for position, (set_name, nodes) in enumerate(mesh.node_sets.items()):
        if set_name == fixed:
            text += [f"SPC1,1,123,{node + 1}" for node in nodes]
        elif set_name not in faces:
            text.append(f"SET1,{position}," + ",".join(str(node + 1) for node in nodes[:6]))
    path.write_text("\n".join([*text, "ENDDATA", ""]), encoding="utf-8")


GMSH_TYPES = {"triangle": 2, "triangle6": 9, "quad": 3, "quad8": 16, "hexahedron": 5, "hexahedron20": 17}
VTK_TO_GMSH = {"hexahedron20": [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14]}


def write_gmsh_1(path: Path, points: np.ndarray, cells: list[tuple[str, np.ndarray]], tags: list[np.ndarray]) -> None:
    """A file of version 1, which has no names of groups, with bricks."""
    text = ["$NOD", f"{len(points)}"]
    text += [f"{n + 1} {x:.12g} {y:.12g} {z:.12g}" for n, (x, y, z) in enumerate(points)]
    text += ["$ENDNOD", "$ELM", f"{sum(map(len, tags))}"]
    for (kind, block), tag in zip(cells, tags, strict=True):
        order = VTK_TO_GMSH.get(kind, slice(None))
        for cell, group in zip(block[:, order] + 1, tag, strict=True):
            entry = [len(text), GMSH_TYPES[kind], group, group, len(cell), *cell]
            text.append(" ".join(map(str, entry)))
    path.write_text("\n".join([*text, "$ENDELM"]) + "\n", encoding="utf-8")


@patch.dict(topological_dimension, {"wedge15": 3})  # which meshio forgets
def write_meshio(path: Path, mesh: Mesh, body_names: list[str], faces: list[str], form: str) -> None:
    """A file in mm with the bodies and faces as groups, of .msh (form gmsh22, gmsh1), .vtu (vtu), .vtk (vtk, vtk42) or
    .med (med)."""
    cells: list[tuple[str, np.ndarray]] = []
    tags: list[np.ndarray] = []
    names: dict[str, tuple[int, int]] = {}
    for number, name in enumerate(body_names):
        block = mesh.cells[mesh.body == number]
        cells.append((kind_of(mesh).name, block))
        tags.append(np.full(len(block), number + 1))
        names[name] = (number + 1, 3)
    for number, name in enumerate(faces, start=len(body_names) + 1):
        sides = face_of(mesh, name)
        cells.append((SURFACES[sides.shape[1]], sides))
        tags.append(np.full(len(sides), number))
        names[name] = (number, 2)
    points = 1e3 * mesh.points
    if form == "gmsh1":
        write_gmsh_1(path, points, cells, tags)
    elif form.startswith("gmsh"):
        data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
        field = {name: np.array(value) for name, value in names.items()}
        meshio.Mesh(points, cells, cell_data=data, field_data=field).write(
            path, file_format="gmsh22", binary=form == "gmsh22b"
        )
    elif form.startswith("vt"):
        flags = {name: [np.asarray(tag == value[0], dtype=np.int32) for tag in tags] for name, value in names.items()}
        own = {
            name: np.isin(np.arange(mesh.n_nodes), nodes).astype(np.int32)
            for name, nodes in mesh.node_sets.items()
            if name not in faces
        }
        meshio.Mesh(points, cells, cell_data=flags, point_data=own).write(
            path, file_format=form, **({"binary": False} if form == "vtk42" else {})
        )
    else:
        merged: dict[str, list[int]] = {}
        for at, (kind, _) in enumerate(cells):
            merged.setdefault(kind, []).append(at)
        whole = [(kind, np.concatenate([cells[at][1] for at in parts])) for kind, parts in merged.items()]
        family = [-np.concatenate([tags[at] for at in parts]) for parts in merged.values()]
        model = meshio.Mesh(points, whole, cell_data={"cell_tags": family})
        model.cell_tags = {-value[0]: [name] for name, value in names.items()}
        model.point_tags = {}
        model.write(path)
