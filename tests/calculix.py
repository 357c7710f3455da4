"""Shared by the tests against CalculiX: coarse blades, bricks cut into tetrahedra, ties, and running `ccx`."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import scipy.sparse
from scipy.spatial import cKDTree

from helpers import absent_tool
from solid_cells import PARTS
from stickslip.formats.calculix_deck import write_calculix_deck
from stickslip.model.kinds.two_blade_geometry import BladePairElements
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.elasticity import Element, Material, Structure, assemble, assemble_bodies, natural_frequencies
from stickslip.structure.mesh import Mesh

COARSE = BladePairElements(
    shank_columns=2, shank_rows=4, platform_rows=2, airfoil_rows=8, inner_columns=1, contact_columns=2, chordwise=4,
    damper_columns=2, damper_flank_rows=1,
)  # fmt: skip
# Elements of CalculiX, the cells that they are, and our element for them.
ELEMENTS: dict[str, tuple[str, Element | Literal[""]]] = {
    "C3D8I": ("hexahedron", "incompatible"),
    "C3D8": ("hexahedron", "trilinear"),
    "C3D20": ("hexahedron20", "serendipity"),
    "C3D10": ("tetra10", ""),
    "C3D4": ("tetra", ""),
    "C3D15": ("wedge15", ""),
    "C3D6": ("wedge", ""),
}


@dataclass(frozen=True)
class Pairs:
    """Coincident nodes that are tied: the second one follows."""

    first_node: np.ndarray
    second_node: np.ndarray


def blades(kind: str, elements: BladePairElements | None = COARSE) -> tuple[Mesh, Pairs]:
    """The two blades and their damper in cells of one kind, and the node pairs of the two contact faces."""
    mesh: Any = blade_pair_mesh(elements=elements)
    if kind == "hexahedron20":
        mesh = mesh.quadratic()
    elif kind != "hexahedron":
        mesh = cut_bricks(mesh, kind)
    first, second = [], []
    for side in ("left", "right"):
        damper, blade = mesh.node_sets[f"damper_{side}_face"], mesh.node_sets[f"{side}_face"]
        distance, partner = cKDTree(mesh.points[blade]).query(mesh.points[damper])
        assert distance.max() < 1e-9
        first.append(damper)
        second.append(blade[partner])
    return mesh, Pairs(np.concatenate(first), np.concatenate(second))


def cut_bricks(mesh: Mesh, kind: str) -> Mesh:
    """Each brick as six tetrahedra around its diagonal 0-6, or two wedges; neighbours fit where their bricks have the
    same axes. The bodies are left, right and damper as far as the mesh has them."""
    local = PARTS["tetra" if kind.startswith("tetra") else "wedge"]
    (bricks,) = mesh.blocks
    cells = bricks.cells[:, np.array(local)].reshape(-1, len(local[0]))
    points, sets = mesh.points, dict(mesh.node_sets)
    if CELL_KINDS[kind].is_quadratic:
        ends = np.sort(cells[:, CELL_KINDS[kind].edges], axis=2)
        edges, position = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
        cells = np.hstack([cells, len(points) + position.reshape(len(cells), -1)])
        sets = {
            name: np.append(nodes, len(points) + np.flatnonzero(np.isin(edges, nodes).all(axis=1)))
            for name, nodes in sets.items()
        }
        points = np.vstack([points, points[edges].mean(axis=1)])
    names = ("left", "right", "damper")[: mesh.body.max() + 1]
    return Mesh(points, cells, np.repeat(mesh.body, len(local)), sets, names)


def our_structure(mesh: Mesh, element: Element | Literal[""]) -> Structure:
    """Our matrices of a mesh, clamped at its base; only bricks have a choice of elements."""
    if mesh.blocks[0].kind.startswith("hexahedron"):
        assert element
        return assemble(mesh, Material(), element)
    return assemble_bodies(mesh, [Material()] * 3, fixed_nodes=mesh.node_sets["fixed"])


def tied(structure: Structure, pairs: Pairs) -> tuple[Any, Any, np.ndarray]:
    """Stiffness and mass with the pairs tied, and the position of each unknown among the displacements."""
    size = structure.full_size
    follows = np.arange(size).reshape(-1, 3)
    follows[pairs.second_node] = follows[pairs.first_node]
    retained = np.setdiff1d(structure.free_unknowns, (3 * pairs.second_node[:, None] + np.arange(3)).ravel())
    column = np.full(size, -1)
    column[retained] = np.arange(len(retained))
    tie = scipy.sparse.csr_matrix(
        (
            np.ones(len(structure.free_unknowns)),
            (np.arange(len(structure.free_unknowns)), column[follows.ravel()[structure.free_unknowns]]),
        ),
        shape=(len(structure.free_unknowns), len(retained)),
    )
    return tie.T @ structure.stiffness @ tie, tie.T @ structure.mass @ tie, retained


def run_calculix(folder: Path, mesh: Mesh, element: str, pairs: Pairs, count: int) -> np.ndarray:
    """Frequencies in Hz that CalculiX finds; its matrices are in ``matrices.sti``, ``.mas`` and ``.dof``."""
    program = shutil.which("ccx")
    if program is None:
        absent_tool("ccx", "CalculiX is not on the path (apt-get install calculix-ccx).")
    for name in ("frequency", "matrices"):
        brick = element if element in ("C3D8I", "C3D8") else "C3D8I"
        write_calculix_deck(
            folder / f"{name}.inp", mesh, Material(), element=brick, pairs=pairs, step=name, count=count
        )
        subprocess.run(
            [program, "-i", name],
            cwd=folder,
            check=True,
            capture_output=True,
            timeout=300,
            env=os.environ | {"OMP_NUM_THREADS": "1"},
        )
    table = re.findall(
        r"^\s+\d+" + 4 * r"\s+(\S+)" + r"\s*$", (folder / "frequency.dat").read_text(), flags=re.MULTILINE
    )
    return np.array([float(row[2]) for row in table[:count]])


def frequencies(stiffness: Any, mass: Any, count: int) -> np.ndarray:
    """Natural frequencies in Hz."""
    return natural_frequencies(stiffness, mass, count)[0]
