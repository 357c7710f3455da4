"""Stress of CalculiX and of stickslip from the same displacements of all nodes."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np

from helpers import absent_tool
from stickslip.core.validation import FloatArray
from stickslip.formats.calculix_deck import write_calculix_deck
from stickslip.structure.elasticity import Material, Structure
from stickslip.structure.mesh import Mesh
from stickslip.structure.stress import cell_stress, stress_points

# Order of our points among those of CalculiX, which counts xi fastest.
_POINTS_OF_CALCULIX = {
    8: [0, 4, 2, 6, 1, 5, 3, 7],
    10: [1, 0, 3, 2],
    15: [0, 3, 6, 1, 4, 7, 2, 5, 8],
    20: np.arange(27).reshape(3, 3, 3).transpose(2, 1, 0).ravel().tolist(),
}


def calculix_stress(folder: Path, mesh: Mesh, element: str, displacement: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stress (m, q, 6) at integration points and (n_nodes, 6) at nodes, from prescribed displacements of all nodes."""
    program = shutil.which("ccx")
    if program is None:
        absent_tool("ccx", "CalculiX is not on the path (apt-get install calculix-ccx).")
    brick = element if element in ("C3D8I", "C3D8") else "C3D8I"
    deck = write_calculix_deck(folder / "stress.inp", mesh, Material(), element=brick, fixed_nodes=[])
    model = deck.read_text().split("*STEP")[0]
    lines = ["*STEP", "*STATIC", "*BOUNDARY"]
    for node, moved in enumerate(displacement.reshape(-1, 3).tolist(), start=1):
        lines += [f"{node}, {axis}, {axis}, {value:.12e}" for axis, value in enumerate(moved, start=1)]
    for body in np.unique(mesh.body):
        lines += [f"*EL PRINT, ELSET=body_{body}", "S"]
    deck.write_text(model + "\n".join([*lines, "*ELEMENT OUTPUT", "S", "*END STEP", ""]))
    assert program is not None
    quiet = os.environ | {"OMP_NUM_THREADS": "1"}
    subprocess.run([program, "-i", "stress"], cwd=folder, check=True, capture_output=True, timeout=300, env=quiet)
    text = (folder / "stress.dat").read_text()
    rows = np.array([line.split() for line in re.findall(r"^ +\d+ +\d+ +[-\d].*$", text, re.MULTILINE)], dtype=float)
    cell, point = rows[:, 0].astype(int) - 1, rows[:, 1].astype(int) - 1
    stress = np.zeros((mesh.n_cells, point.max() + 1, 6))
    stress[cell, point] = rows[:, [2, 3, 4, 5, 7, 6]]  # xx, yy, zz, xy, xz, yz
    raw = (folder / "stress.frd").read_bytes()
    start = raw.index(b" -4  STRESS")
    while raw[start : start + 3] in (b" -4", b" -5"):
        start = raw.index(b"\n", start) + 1
    record = np.dtype([("node", "<i4"), ("stress", "<f4", 6)])  # the binary form of *ELEMENT OUTPUT
    nodes = np.frombuffer(raw, record, mesh.n_nodes, start)
    np.testing.assert_array_equal(nodes["node"], np.arange(1, mesh.n_nodes + 1))
    return stress, nodes["stress"].astype(float)


def rounded(field: FloatArray) -> FloatArray:
    """The numbers that the deck contains."""
    return np.array([float(f"{value:.12e}") for value in field.ravel()])


def our_stress(structure: Structure, displacement: FloatArray) -> FloatArray:
    """(m, q, 6) in the order of the points of CalculiX."""
    cells = structure.mesh.blocks[0].cells
    n_nodes = cells.shape[1]
    unknowns = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), -1)
    stress = cell_stress(structure, cells, 0, displacement[unknowns][:, :, None], stress_points(n_nodes))[..., 0]
    return stress[:, _POINTS_OF_CALCULIX.get(n_nodes, slice(None))]
