"""Decks of two blocks of 20-node bricks with ties, and the frequencies that CalculiX finds for them."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np

from helpers import absent_tool
from model_writers import rows
from stickslip.formats.meshes.read import read_model
from stickslip.structure.elasticity import Material, natural_frequencies
from stickslip.structure.mesh import Mesh

STEEL = Material(210e9, 0.3, 7850.0)


def block(counts: tuple[int, int, int], low: tuple[float, float, float], high: tuple[float, float, float]) -> Mesh:
    """A block of 8-node bricks, in m."""
    x, y, z = (np.linspace(a, b, n + 1) for a, b, n in zip(low, high, counts, strict=True))
    points = np.array([[a, b, c] for c in z for b in y for a in x])
    nx, ny, nz = counts
    corner = np.arange(nx)[None, None] + (nx + 1) * (
        np.arange(ny)[None, :, None] + (ny + 1) * np.arange(nz)[:, None, None]
    )
    steps = np.array([0, 1, nx + 2, nx + 1])
    steps = np.concatenate([steps, steps + (nx + 1) * (ny + 1)])
    return Mesh(points, corner.reshape(-1, 1) + steps)


def two_blocks(gap: float = 0.0) -> Mesh:
    """A lower block of 2 x 2 x 2 and an upper one of 3 x 2 x 2 quadratic bricks, sets bottom, lower, upper, top."""
    low = block((2, 2, 2), (0, 0, 0), (20e-3, 16e-3, 30e-3))
    high = block((3, 2, 2), (0, 0, 30e-3 + gap), (20e-3, 16e-3, 55e-3))
    count = low.n_nodes
    points = np.vstack([low.points, high.points])
    height, above = points[:, 2], np.arange(len(points)) >= count
    sets = {
        "bottom": np.flatnonzero(height == 0.0),
        "lower": np.flatnonzero((height == 30e-3) & ~above),
        "upper": np.flatnonzero((height == 30e-3 + gap) & above),
        "top": np.flatnonzero(height == 55e-3),
    }
    body = np.repeat([0, 1], [len(low.bricks()), len(high.bricks())])
    return Mesh(points, np.vstack([low.bricks(), high.bricks() + count]), body, sets, ("a", "b")).quadratic()


def write_deck(path: Path, mesh: Mesh, cards: str, clamped: str = "bottom", more_nodes: str = "") -> None:
    """A deck in m, N, kg with C3D20, the sets and their surfaces, the cards, and a step of ten frequencies."""
    text = ["*NODE, NSET=ALL"]
    text += [f"{n + 1}, {x:.15g}, {y:.15g}, {z:.15g}" for n, (x, y, z) in enumerate(mesh.points)]
    text += ["*NODE", more_nodes] if more_nodes else []
    for number, name in enumerate(mesh.body_names):
        text.append(f"*ELEMENT, TYPE=C3D20, ELSET={name}")
        text += [
            rows([int(cell) + 1, *(np.asarray(mesh.cells[cell]) + 1)]) for cell in np.flatnonzero(mesh.body == number)
        ]
    for name, nodes in mesh.node_sets.items():
        text += [f"*NSET, NSET={name}", rows(list(nodes + 1))]
    for name in ("lower", "upper", "top"):
        text.append(f"*SURFACE, NAME=s{name}, TYPE=ELEMENT")
        members = mesh.node_sets[name]
        for cell, nodes in enumerate(mesh.cells):
            for side, corners in (("S1", [0, 1, 2, 3]), ("S2", [4, 5, 6, 7])):
                if np.isin(nodes[corners], members).all():
                    text.append(f"{cell + 1}, {side}")
    text += ["*MATERIAL, NAME=steel", "*ELASTIC", "210e9, 0.3", "*DENSITY", "7850."]
    text += [f"*SOLID SECTION, ELSET={name}, MATERIAL=steel" for name in mesh.body_names]
    text += [cards.strip()]
    text += ["*BOUNDARY", f"{clamped}, 1, 3"] if clamped else []
    text += ["*STEP", "*FREQUENCY", "10", "*END STEP"]
    path.write_text("\n".join(text) + "\n", encoding="utf-8")


def frequencies_of(path: Path, count: int = 10) -> np.ndarray:
    """Hz, of stickslip, free of contact."""
    model = read_model(path, "m")
    structure = model.assemble(dict.fromkeys(model.mesh.body_names, STEEL))
    return natural_frequencies(structure.stiffness, structure.mass, count)[0]


def frequencies_of_calculix(path: Path, count: int = 10) -> np.ndarray:
    """Hz, of the same deck."""
    program = shutil.which("ccx")
    if program is None:
        absent_tool("ccx", "CalculiX is not on the path (apt-get install calculix-ccx).")
    subprocess.run(
        [str(program), "-i", path.stem],
        cwd=path.parent,
        check=True,
        capture_output=True,
        timeout=120,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    table = re.findall(r"^\s+\d+" + 4 * r"\s+(\S+)" + r"\s*$", path.with_suffix(".dat").read_text(), flags=re.MULTILINE)
    return np.array([float(row[2]) for row in table[:count]])
