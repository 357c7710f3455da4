"""A clamped body under pressure on a face and gravity in CalculiX: displacements and reactions."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from helpers import absent_tool
from model_writers import sides_of
from stickslip.formats.calculix_deck import write_calculix_deck
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import Mesh


def calculix_static(
    folder: Path,
    mesh: Mesh,
    element: str,
    materials: Sequence[Material],
    face: str,
    pressure: float,
    acceleration: Sequence[float],
) -> tuple[np.ndarray, np.ndarray, Path]:
    """Displacements (n_nodes, 3) m, the sum of the reactions (3,) N, and the ``.frd`` file.

    ``face`` is loaded by ``*DLOAD`` P, all bodies by ``*DLOAD`` GRAV; the nodes of the set ``fixed`` are clamped.
    """
    program = shutil.which("ccx")
    if program is None:
        absent_tool("ccx", "CalculiX is not on the path (apt-get install calculix-ccx).")
    brick = element if element in ("C3D8I", "C3D8") else "C3D8I"
    deck = write_calculix_deck(folder / "static.inp", mesh, list(materials), element=brick)
    lines = ["*STEP", "*STATIC", "*DLOAD"]
    lines += [f"{cell + 1}, P{side + 1}, {pressure:.10e}" for cell, side in sides_of(mesh, face)]
    size = float(np.linalg.norm(acceleration))
    direction = ", ".join(f"{part / size:.10e}" for part in acceleration)
    lines += [f"body_{body}, GRAV, {size:.10e}, {direction}" for body in np.unique(mesh.body)]
    lines += ["*NODE PRINT, NSET=all_nodes", "U", "*NODE PRINT, NSET=clamped, TOTALS=ONLY", "RF"]
    lines += ["*NODE FILE", "U", "*EL FILE", "S", "*END STEP", ""]
    deck.write_text(deck.read_text(encoding="ascii").split("*STEP")[0] + "\n".join(lines), encoding="ascii")
    quiet = os.environ | {"OMP_NUM_THREADS": "1"}
    assert program is not None
    subprocess.run([program, "-i", "static"], cwd=folder, check=True, capture_output=True, timeout=300, env=quiet)
    printed, totals = (folder / "static.dat").read_text().split("total force")
    rows = re.findall(r"^ +(\d+)" + 3 * r" +(\S+)" + r" *$", printed, re.MULTILINE)
    displacement = np.zeros((mesh.n_nodes, 3))
    for node, *moved in rows:
        displacement[int(node) - 1] = [float(value) for value in moved]
    assert len(rows) == mesh.n_nodes
    reaction = re.findall(r"^" + 3 * r" +(-?\d\S+)" + r" *$", totals, re.MULTILINE)
    return displacement, np.array(reaction[0], dtype=float), folder / "static.frd"
