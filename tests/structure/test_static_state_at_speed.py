"""The joint in its static state at a speed: a rod that grows until it touches, from one reduction."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from stickslip.structure.rotating_superelement import RPM
from structure_fixtures import brick_block

YOUNG, DENSITY, LENGTH, SIDE, GAP = 200e9, 7800.0, 0.3, 0.01, 10e-6
CONTACT = 5e7  # N/m


@pytest.fixture(scope="module")
def rotor() -> Any:
    block: Any = brick_block((12, 1, 1), (LENGTH, SIDE, SIDE))
    mesh = ss.Mesh(block.points - np.array([0.0, SIDE / 2.0, SIDE / 2.0]), block.cells)
    rod = ss.assemble(mesh, ss.Material(YOUNG, 0.0, DENSITY), fixed_nodes=np.flatnonzero(mesh.points[:, 0] < 1e-9))
    tip = np.flatnonzero(mesh.points[:, 0] > LENGTH - 1e-9)
    return ss.rotating_superelement(ss.rotating(rod, (0, 0, 1)), tip, 9000.0, n_modes=4)


@pytest.mark.slow
@pytest.mark.parametrize("speed", [1000.0, 5000.0, 9000.0])
def test_a_rod_touches_a_wall_above_a_speed(rotor: Any, speed: float) -> None:
    # Free growth rho W^2 L^3 / (3 E); beyond the gap the rod and the contact are two springs in a row.
    superelement = rotor.at(speed, coriolis=False)
    operator = np.zeros((12, superelement.size))
    for corner, node in enumerate(superelement.boundary_nodes):
        for row, direction in enumerate(((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))):
            operator[3 * corner + row] = superelement.selector(int(node), direction)
    pairs = ss.ContactPairs(operator, CONTACT / 4.0, CONTACT / 8.0, 0.2, gap=GAP)
    state = ss.static_preload(superelement, pairs, rotor.load_at(speed))
    growth = DENSITY * (speed * RPM) ** 2 * LENGTH**3 / (3.0 * YOUNG)
    rod = YOUNG * SIDE**2 / LENGTH
    expected = max(growth - GAP, 0.0) / (1.0 / rod + 1.0 / CONTACT)
    assert state.normal_force.sum() == pytest.approx(expected, rel=0.01, abs=1e-6)
    assert (expected > 0.0) == (speed > 2000.0)
    closed = state.about(pairs, keep_traction=True)
    stuck, free = (
        ss.campbell_diagram(rotor, lambda rpm: closed, [speed - 1.0, speed], count=3).stuck_hz[1],
        ss.campbell_diagram(rotor, None, [speed - 1.0, speed], count=3).free_hz[1],
    )
    assert bool((stuck > 1.001 * free).any()) == (expected > 0.0)  # the joint adds its springs where it is closed
