"""Natural frequencies at a speed of rotation by CalculiX: prestress, spin softening and Coriolis forces."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np

from helpers import absent_tool
from stickslip.formats.calculix_deck import write_calculix_deck
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import Mesh

RPM = 2.0 * np.pi / 60.0
_ROWS = {n: re.compile(r"^\s+\d+" + n * r"\s+(\S+)" + r"\s*$", flags=re.MULTILINE) for n in (3, 4)}


def speed_frequencies(
    folder: Path,
    mesh: Mesh,
    material: Material,
    fixed: np.ndarray,
    axis: tuple[np.ndarray, np.ndarray],
    speed_rpm: float,
    count: int,
    basis: int,
) -> tuple[np.ndarray, np.ndarray]:
    """(count,) Hz without and with Coriolis forces about ``axis`` (point, direction).

    A linear static step under ``*CENTRIF`` gives the prestress; the steps with PERTURBATION contain its stress
    stiffness and the spin softening. CalculiX computes the frequencies with Coriolis forces in the ``basis`` lowest
    modes without them.
    """
    program = shutil.which("ccx")
    if program is None:
        absent_tool("ccx", "CalculiX is not on the path (apt-get install calculix-ccx).")
    deck = write_calculix_deck(folder / "rotation.inp", mesh, material, fixed_nodes=fixed)
    head = deck.read_text().partition("*STEP")[0]
    numbers = ", ".join(repr(float(each)) for each in ((RPM * speed_rpm) ** 2, *axis[0], *axis[1]))
    load = f"*DLOAD\nbody_0, CENTRIF, {numbers}"
    steps = [
        f"*STEP\n*STATIC\n{load}\n*END STEP",
        f"*STEP, PERTURBATION\n*FREQUENCY, STORAGE=YES\n{basis}\n*END STEP",
        f"*STEP, PERTURBATION\n*COMPLEX FREQUENCY, CORIOLIS\n{count}\n{load}\n*END STEP",
    ]
    deck.write_text(head + "\n".join(steps) + "\n")
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    command = [program, "-i", "rotation"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=300, env=environment)
    text = (folder / "rotation.dat").read_text()
    _, real, with_coriolis = text.split("E I G E N V A L U E   O U T P U T")
    first = np.array([float(row[2]) for row in _ROWS[4].findall(real.partition("P A R T")[0])])
    second = np.array([float(row[1]) for row in _ROWS[3].findall(with_coriolis.partition("P A R T")[0])])
    return first[:count], second[:count]
