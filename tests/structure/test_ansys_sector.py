"""A cyclic modal analysis of Ansys: one sector of 8, four 20-node bricks, 30 frequencies of harmonic indices 0 to 4.

Mesh and frequencies are those of ``file_cyclic.rst`` of github.com/ansys/example-data (MIT licence). SOLID186 takes
2 x 2 x 2 points for the stiffness and 14 for the mass (B. M. Irons, Quadrature rules for brick based finite elements,
Int. J. Numer. Methods Eng. 3 (1971) 293). With these points the two programs must agree to the last digits of the file;
with its own 27 points stickslip is stiffer, as four bricks are a coarse mesh.
"""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from stickslip.structure.elasticity import assemble
from stickslip.structure.mesh import Mesh
from stickslip.structure.sector_reduction import sector_frequencies
from stickslip.structure.shapes import Rule, gauss_points

DATA: Any = json.loads((Path(__file__).parents[1] / "data" / "ansys_cyclic_sector.json").read_text("utf-8"))
INDICES = range(5)


def irons_rule() -> Rule:
    """14 points: six on the axes, eight on the diagonals."""
    axes, diagonals = np.sqrt(19.0 / 30.0) * np.eye(3), np.sqrt(19.0 / 33.0)
    points = np.vstack([axes, -axes, diagonals * np.array(list(itertools.product((1.0, -1.0), repeat=3)))])
    return points, np.repeat([320.0 / 361.0, 121.0 / 361.0], [6, 8])


def differences() -> dict[int, np.ndarray]:
    """Harmonic index -> frequencies over those of Ansys, less 1; pairs of equal ones count once."""
    mesh = Mesh(np.array(DATA["points_m"]), np.array(DATA["cells"]))
    sector = assemble(mesh, ss.Material(200e9, 0.3, 7850.0), "serendipity", fixed_nodes=DATA["fixed"])
    symmetry = ss.cyclic_symmetry(mesh.points, DATA["left"], DATA["right"])
    assert symmetry.sectors == 8
    ours, theirs, answer = sector_frequencies(sector, symmetry, INDICES, 6), np.array(DATA["frequency_hz"]), {}
    for index in INDICES:
        given = np.sort(theirs[np.array(DATA["harmonic_index"]) == index])
        given = given if index in (0, 4) else given[::2]
        answer[index] = ours[index][: given.size] / given - 1.0
    return answer


def test_with_the_points_of_ansys_all_frequencies_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stickslip.structure.shapes.stiffness_rule", lambda nodes: gauss_points(2))
    monkeypatch.setattr("stickslip.structure.shapes.mass_rule", lambda nodes: irons_rule())
    for difference in differences().values():
        np.testing.assert_allclose(difference, 0.0, atol=1e-8)


def test_with_27_points_the_same_mesh_is_stiffer() -> None:
    for difference in differences().values():
        assert (difference > 0.0).all()
        assert difference[0] < 0.014
        assert difference.max() < 0.054
