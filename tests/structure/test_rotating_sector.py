"""One sector of a rotating disk: prestress and frequencies are those of the full ring and of CalculiX."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from helpers import absent_tool
from sectors import annulus
from sentences import rejects
from stickslip.structure.rotating_superelement import RPM

STEEL = ss.Material(200e9, 0.33, 7850.0)
SECTORS, RADII, THICKNESS, COUNTS, SPEED = 6, (0.05, 0.2), 0.02, (3, 2, 1), 15_000.0
AXIS = (0.0, 0.0, 1.0)


def plate(of: int, element: Any = "incompatible") -> Any:
    mesh: Any = annulus(SECTORS, RADII, THICKNESS, COUNTS, of=of)
    mesh = mesh.quadratic() if element == "serendipity" else mesh
    inner = np.hypot(mesh.points[:, 0], mesh.points[:, 1]) < mesh.points[mesh.node_sets["inner"][0], 0] + 1e-9
    return ss.assemble(mesh, STEEL, element, np.flatnonzero(inner))


def boundaries(structure: Any) -> tuple[Any, Any]:
    angle = np.arctan2(structure.mesh.points[:, 1], structure.mesh.points[:, 0])
    return np.flatnonzero(np.abs(angle) < 1e-9), np.flatnonzero(np.abs(angle - 2.0 * np.pi / SECTORS) < 1e-9)


@pytest.fixture(scope="module")
def sector() -> Any:
    return plate(1)


@pytest.fixture(scope="module")
def symmetry(sector: Any) -> Any:
    return ss.cyclic_symmetry(sector.mesh.points, *boundaries(sector))


@pytest.mark.slow
def test_a_sector_has_the_static_state_and_the_frequencies_of_the_ring(sector: Any, symmetry: Any) -> None:
    rotor, ring = ss.rotating(sector, AXIS, symmetry=symmetry), ss.rotating(plate(SECTORS), AXIS)
    own, full = (each.static_displacement(SPEED).reshape(-1, 3) for each in (rotor, ring))
    where = np.abs(ring.structure.mesh.points[None] - sector.mesh.points[:, None]).max(axis=2).argmin(axis=1)
    np.testing.assert_allclose(own, full[where], atol=1e-9 * np.abs(full).max())
    found = ss.sector_frequencies(rotor.at(SPEED), symmetry, range(SECTORS // 2 + 1), 6)
    both = [np.repeat(hz, 1 if 2 * diameter % SECTORS == 0 else 2) for diameter, hz in found.items()]
    expected = ring.natural_frequencies(SPEED, 16, coriolis=False)
    np.testing.assert_allclose(np.sort(np.concatenate(both))[:16], expected, rtol=1e-8)
    assert expected[0] > 1.02 * ring.natural_frequencies(0.0, 1, coriolis=False)[0]


@pytest.mark.slow
def test_frequencies_of_all_nodal_diameters_at_a_speed_are_those_of_calculix(tmp_path: Path) -> None:
    program = shutil.which("ccx")
    if program is None:
        absent_tool("ccx", "CalculiX is not on the path (apt-get install calculix-ccx).")
    disk = plate(1, "serendipity")
    left, right = (np.setdiff1d(nodes, disk.fixed_nodes) for nodes in boundaries(disk))
    mesh = replace(disk.mesh, node_sets={"left": left, "right": right})
    deck = ss.write_calculix_deck(tmp_path / "sector.inp", mesh, STEEL, fixed_nodes=disk.fixed_nodes)
    model = deck.read_text().partition("*STEP")[0]
    deck.write_text(
        f"{model}*SURFACE, NAME=dependent, TYPE=NODE\nset_right\n*SURFACE, NAME=independent, TYPE=NODE\nset_left\n"
        "*TIE, CYCLIC SYMMETRY, NAME=both, POSITION TOLERANCE=1e-6\ndependent, independent\n"
        f"*CYCLIC SYMMETRY MODEL, N={SECTORS}, TIE=both\n0, 0, 0, 0, 0, 1\n"
        f"*STEP\n*STATIC\n*DLOAD\nbody_0, CENTRIF, {(SPEED * RPM) ** 2!r}, 0., 0., 0., 0., 0., 1.\n*END STEP\n"
        "*STEP, PERTURBATION\n*FREQUENCY\n8\n*SELECT CYCLIC SYMMETRY MODES, NMIN=0, NMAX=3\n*END STEP\n"
    )
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    subprocess.run(
        [program, "-i", "sector"], cwd=tmp_path, check=True, capture_output=True, timeout=60, env=environment
    )
    pattern = r"^\s+(\d+)\s+\d+" + 4 * r"\s+(\d\.\d+E[+-]\d+)" + r"\s*$"
    table = re.findall(pattern, (tmp_path / "sector.dat").read_text(), flags=re.MULTILINE)
    symmetry = ss.cyclic_symmetry(disk.mesh.points, *boundaries(disk))
    rotor = ss.rotating(disk, AXIS, symmetry=symmetry)
    at_speed, at_rest = (ss.sector_frequencies(rotor.at(rpm), symmetry, range(4), 4) for rpm in (SPEED, 0.0))
    for diameter, expected in at_speed.items():
        theirs = np.sort([float(row[3]) for row in table if int(row[0]) == diameter])
        np.testing.assert_allclose(theirs[::2], expected, rtol=1e-3)  # CalculiX lists the waves in both directions
    assert at_speed[0][0] > 1.02 * at_rest[0][0]


@pytest.mark.slow
def test_input_errors(sector: Any, symmetry: Any) -> None:
    with rejects(ss.InputError, "axis"):
        ss.rotating(sector, (0.0, 0.1, 1.0), symmetry=symmetry)
    with rejects(ss.InputError, "point"):
        ss.rotating(sector, AXIS, (0.01, 0.0, 0.0), symmetry=symmetry)
    assert ss.rotating(sector, (0.0, 0.0, -2.0), (0.0, 0.0, 0.5), symmetry=symmetry).at(SPEED) is not None
    rotor = ss.rotating(sector, AXIS, symmetry=symmetry)
    with rejects(ss.InputError, "rotor"):
        rotor.natural_frequencies(SPEED, 3)
    with rejects(ss.InputError, "rotor"):
        ss.rotating_superelement(rotor, [int(sector.mesh.n_nodes - 1)], SPEED)
    with rejects(ss.InputError, "structure"):
        free = ss.assemble(sector.mesh, STEEL, fixed_nodes=[])
        ss.rotating(free, AXIS, symmetry=symmetry)
