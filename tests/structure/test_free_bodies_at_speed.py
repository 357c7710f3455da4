"""Effects of the speed on a structure with bodies that only contact supports, and with mass points."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg

import stickslip as ss
from sectors import annulus
from sentences import rejects
from stickslip.structure.attachments import Attachments, attach
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.elasticity import assemble_bodies, natural_frequencies
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.rotating_superelement import RPM
from structure_fixtures import brick_block

STEEL = ss.Material(200e9, 0.3, 7800.0)
AXIS, SPEED = (0.0, 0.0, 1.0), 6000.0


def block(at: float = 0.0) -> Mesh:
    """20 elements along x from ``at`` on, across the axis y = z = 0."""
    mesh: Any = brick_block((20, 1, 1), (0.3, 0.02, 0.01))
    return Mesh(mesh.points + np.array([at, -0.01, -0.005]), mesh.cells)


def beside(first: Any, second: Any) -> Mesh:
    cells = np.vstack([first.cells, second.cells + first.n_nodes])
    return Mesh(np.vstack([first.points, second.points]), cells, body=np.repeat([0, 1], [20, 20]))


def clamped(mesh: Mesh) -> IntArray:
    return np.flatnonzero(mesh.points[:, 0] < 1e-9)


@pytest.fixture(scope="module")
def alone() -> Any:
    mesh = block()
    return ss.rotating(ss.assemble(mesh, STEEL, fixed_nodes=clamped(mesh)), AXIS)


@pytest.fixture(scope="module")
def both() -> Any:
    mesh = beside(block(), block(0.4))
    structure = assemble_bodies(mesh, [STEEL, STEEL], fixed_nodes=clamped(mesh))
    return ss.rotating(structure, AXIS, free_bodies="at rest")


@pytest.mark.slow
def test_a_free_body_is_at_rest_and_the_other_one_as_if_alone(alone: Any, both: Any) -> None:
    size = alone.structure.stiffness.shape[0]
    change = both.speed_stiffness.toarray()
    own = alone.speed_stiffness.toarray()
    np.testing.assert_allclose(change[:size, :size], own, atol=1e-9 * np.abs(own).max())
    assert not change[size:].any()
    assert not change[:, size:].any()
    assert not both.coriolis.toarray()[size:].any()
    np.testing.assert_array_equal(both.unsupported, np.arange(size, both.structure.stiffness.shape[0]))
    # its load is complete
    nodes = both.structure.mesh.points[:, 0] > 0.35
    pull = both.load.reshape(-1, 3)[nodes].sum(axis=0)
    np.testing.assert_allclose(pull, [7800.0 * 6e-5 * 0.55, 0.0, 0.0], atol=1e-9)


@pytest.mark.slow
def test_frequencies_at_a_speed_and_collapse_are_those_of_the_supported_body(alone: Any, both: Any) -> None:
    loose = ss.assemble(block(), STEEL)
    elastic = natural_frequencies(loose.stiffness, loose.mass, 9)[0][6:]
    expected = np.sort(np.concatenate([alone.natural_frequencies(SPEED, 4, coriolis=False), elastic]))
    found = both.natural_frequencies(SPEED, 11, coriolis=False)
    np.testing.assert_allclose(found[6:], expected[:5], rtol=1e-6)
    assert found[5] < 1.0  # six rigid motions of the free body
    messages = []
    for rotor in (alone, both):
        across = ss.rotating(rotor.structure, (0, 1, 0), (0.02, 0.0, 0.0), free_bodies="at rest")
        with rejects(ss.InputError, "speed_rpm") as caught:
            across.at(60_000.0)
        messages.append(str(caught.value))
    assert messages[0] == messages[1]


def test_without_permission_or_a_constraint_it_is_rejected(both: Any) -> None:
    with rejects(ss.InputError, "structure"):
        ss.rotating(both.structure, AXIS)
    with rejects(ss.InputError, "free_bodies"):
        ss.rotating(both.structure, AXIS, free_bodies="ignored")  # type: ignore[arg-type]
    with rejects(ss.InputError, "structure"):
        ss.rotating(ss.assemble(block(), STEEL), AXIS, free_bodies="at rest")
    with rejects(ss.InputError, "masses"):
        ss.rotating(both.structure, AXIS, masses=[1.0])


def test_a_mass_point_at_the_tip_stretches_and_softens() -> None:
    """A light rod with a heavy tip: u = m r W^2 / (E A / L), and the tip loses m W^2 of its stiffness."""
    mesh = block()
    light = ss.Material(200e9, 0.0, 1e-3)
    tip = np.flatnonzero(mesh.points[:, 0] > 0.2999)
    masses = np.zeros(mesh.n_nodes)
    masses[tip] = 0.5 / tip.size
    none = np.empty((0, 2), dtype=np.int64)
    rod = attach(ss.assemble(mesh, light, fixed_nodes=clamped(mesh)), Attachments(masses, none, np.empty(0)))
    rotor = ss.rotating(rod, AXIS, masses=masses)
    stretch = rotor.static_displacement(SPEED).reshape(-1, 3)[tip, 0]
    expected = 0.5 * 0.3 * (SPEED * RPM) ** 2 * 0.3 / (200e9 * 0.02 * 0.01)
    np.testing.assert_allclose(stretch, expected, rtol=1e-6)
    across = np.zeros(3 * mesh.n_nodes)
    across[3 * tip + 1] = 1.0
    across = rod.gather(across)
    assert across @ rotor.softening @ across == pytest.approx(0.5, rel=1e-6)
    without = ss.rotating(rod, AXIS)
    assert abs(across @ without.softening @ across) < 1e-6


def sector_with_block() -> tuple[Any, CyclicSymmetry]:
    """A sector of a clamped plate with a free block above it."""
    plate: Any = annulus(6, (0.05, 0.2), 0.02, (3, 2, 1), of=1)
    loose = brick_block((1, 1, 1), (0.02, 0.02, 0.01))
    points = np.vstack([plate.points, loose.points + np.array([0.1, 0.03, 0.05])])
    cells = np.vstack([plate.cells, loose.cells + plate.n_nodes])
    mesh = Mesh(points, cells, body=np.repeat([0, 1], [len(plate.cells), 1]))
    angle = np.arctan2(points[: plate.n_nodes, 1], points[: plate.n_nodes, 0])
    left, right = (np.flatnonzero(np.abs(angle - each) < 1e-9) for each in (0.0, np.pi / 3.0))
    bore = np.flatnonzero(np.hypot(*plate.points[:, :2].T) < 0.0501)
    structure = assemble_bodies(mesh, [STEEL, STEEL], fixed_nodes=bore)
    return structure, ss.cyclic_symmetry(points, left, right)


@pytest.mark.slow
def test_a_sector_with_a_free_body_has_the_frequencies_of_the_plate() -> None:
    structure, symmetry = sector_with_block()
    rotor = ss.rotating(structure, AXIS, symmetry=symmetry, free_bodies="at rest")
    assert rotor.unsupported.size == 24
    plate: Any = annulus(6, (0.05, 0.2), 0.02, (3, 2, 1), of=6)
    bore = np.flatnonzero(np.hypot(*plate.points[:, :2].T) < 0.0501)
    ring = ss.rotating(ss.assemble(plate, STEEL, fixed_nodes=bore), AXIS)
    expected = np.sqrt(
        scipy.linalg.eigh(
            ring.at(15_000.0).stiffness.toarray(), ring.structure.mass.toarray(), eigvals_only=True,
            subset_by_index=(0, 11),
        )
    ) / (2.0 * np.pi)  # fmt: skip
    found = ss.sector_frequencies(rotor.at(15_000.0), symmetry, range(4), 10)
    twice = [np.repeat(hz[6:], 1 if 2 * diameter % 6 == 0 else 2) for diameter, hz in found.items()]
    np.testing.assert_allclose(np.sort(np.concatenate(twice))[:12], expected, rtol=1e-6)
    with rejects(ss.InputError, "speed_rpm"):
        rotor.at(1e6)


@pytest.mark.slow
def test_one_reduction_of_a_free_body_beside_a_supported_one(alone: Any, both: Any) -> None:
    """The collapse is that of the supported body, and the highest speed has the frequencies of the mesh."""
    across = {
        name: ss.rotating(each.structure, (0, 1, 0), (0.02, 0.0, 0.0), free_bodies="at rest")
        for name, each in (("alone", alone), ("both", both))
    }
    points = both.structure.mesh.points
    tip, loose = (np.flatnonzero(points[:, 0] > 0.2999)[:4], np.flatnonzero(points[:, 0] > 0.39)[[0, 5, 21, 40]])
    own = ss.rotating_superelement(across["alone"], tip, 3000.0, n_modes=15)
    reduced = ss.rotating_superelement(across["both"], np.concatenate([tip, loose]), 3000.0, n_modes=15)
    assert reduced.collapse_speed_rpm == pytest.approx(own.collapse_speed_rpm, rel=2e-3)
    assert np.abs(reduced.difference_percent).max() < 0.5
    expected = across["both"].natural_frequencies(3000.0, 10, coriolis=False)[6:]
    superelement = reduced.at(3000.0, coriolis=False)
    squares = scipy.linalg.eigh(superelement.stiffness, superelement.mass, eigvals_only=True)
    np.testing.assert_allclose(np.sqrt(squares[6:10]) / (2.0 * np.pi), expected, rtol=2e-3)
