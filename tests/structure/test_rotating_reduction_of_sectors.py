"""One reduction of a sector for all speeds against the sector without reduction at each speed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sectors import annulus
from sentences import rejects
from stickslip.structure.sector_structure import SectorStructure

SECTORS, AXIS, TOP = 5, (0.0, 0.0, 1.0), 20_000.0


@pytest.fixture(scope="module")
def rotor() -> Any:
    mesh = annulus(SECTORS, (0.05, 0.2), 0.02, (7, 4, 1), of=1)
    inner = np.flatnonzero(np.hypot(mesh.points[:, 0], mesh.points[:, 1]) < 0.0501)
    disk = ss.assemble(mesh, ss.Material(200e9, 0.33, 7850.0), fixed_nodes=inner)
    angle = np.arctan2(mesh.points[:, 1], mesh.points[:, 0])
    left, right = (np.flatnonzero(np.abs(angle - each) < 1e-9) for each in (0.0, 2.0 * np.pi / SECTORS))
    symmetry = ss.cyclic_symmetry(mesh.points, left, right)
    return ss.rotating(disk, AXIS, symmetry=symmetry)


def rim_of(rotor: Any) -> Any:
    points = rotor.structure.mesh.points
    rim = np.flatnonzero(np.hypot(points[:, 0], points[:, 1]) > 0.1999)
    return np.setdiff1d(rim, rotor.symmetry.right)


@pytest.fixture(scope="module")
def reduced(rotor: Any) -> Any:
    return ss.rotating_sector(rotor, rim_of(rotor), TOP, n_modes=14)


@pytest.mark.slow
@pytest.mark.parametrize("speed", [0.0, 12_000.0, TOP])
@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_frequencies_of_all_waves_at_all_speeds(rotor: Any, reduced: Any, speed: float, direction: Any) -> None:
    sector, whirl = reduced.at(speed, coriolis=True), rotor.coriolis_at(speed)
    expected = ss.sector_frequencies(rotor.at(speed), rotor.symmetry, range(3), 3, whirl, direction)
    for diameter, full in expected.items():
        np.testing.assert_allclose(sector.natural_frequencies(diameter, 3, direction), full, rtol=1e-4)
    assert expected[0][0] < 1.3 * reduced.at(0.0).natural_frequencies(0, 1)[0]


def test_the_speed_changes_the_frequencies_that_are_compared(reduced: Any) -> None:
    still, fast = (reduced.at(speed).natural_frequencies(1, 1)[0] for speed in (0.0, TOP))
    assert fast > 1.02 * still
    both = [reduced.at(TOP, coriolis=True).natural_frequencies(1, 1, each)[0] for each in ("forward", "backward")]
    assert abs(both[0] / both[1] - 1.0) > 0.003
    assert reduced.at(TOP).diameters[1].gyroscopic is None


@pytest.mark.slow
def test_the_static_state_at_a_speed_is_that_of_the_sector(rotor: Any, reduced: Any) -> None:
    """The load and the stiffness at half the speed move the boundary nodes as those of the mesh do."""
    speed = 0.5 * TOP
    mean = reduced.at(speed).mean_structure()
    moved = np.linalg.solve(mean.stiffness, reduced.load_at(speed))[: 3 * mean.boundary_nodes.size]
    sector = ss.cyclic_sector(rotor.at(speed), rotor.symmetry, rim_of(rotor), diameters=[0], n_modes=60)
    exact = SectorStructure(rotor.at(speed), rotor.symmetry).reduced_load(sector, rotor.load[:, None])[:, 0]
    omega = speed * np.pi / 30.0
    expected = np.linalg.solve(sector.mean_structure().stiffness, omega**2 * exact)[: moved.size]
    np.testing.assert_allclose(moved, expected, atol=1e-4 * np.abs(expected).max())


def test_all_diameters_have_one_number_of_unknowns(reduced: Any) -> None:
    assert len({each.mass.shape for each in reduced.at_rest.diameters.values()}) == 1
    assert reduced.at_rest.size > 3 * reduced.at_rest.boundary_nodes.size + 6
    assert "RotatingSector" in repr(reduced)


@pytest.mark.slow
def test_bad_input(rotor: Any, reduced: Any) -> None:
    with rejects(ss.InputError, "speed_rpm"):
        reduced.at(TOP + 1.0)
    with rejects(ss.InputError, "top_speed_rpm"):
        ss.rotating_sector(rotor, rim_of(rotor), 1e7)
    with rejects(ss.InputError, "n_modes"):
        ss.rotating_sector(rotor, rim_of(rotor), TOP, n_modes=100_000)
    with rejects(ss.InputError, "boundary_nodes"):
        ss.rotating_sector(rotor, rotor.symmetry.right[-1:], TOP)
    with rejects(ss.InputError, "diameters"):
        ss.rotating_sector(rotor, rim_of(rotor), TOP, diameters=[7])
    with rejects(ss.InputError, "diameters"):
        ss.rotating_sector(rotor, rim_of(rotor), TOP, diameters=[1], n_modes=3).load_at(100.0)
    complete = ss.rotating(rotor.structure, AXIS)
    with rejects(ss.InputError, "rotor"):
        ss.rotating_sector(complete, rim_of(rotor), TOP)
