"""Coriolis forces in one sector of a disk: a rotating ring in closed form, the full ring, and CalculiX."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

import stickslip as ss
from calculix_rotation import speed_frequencies
from sectors import annulus
from sentences import rejects
from stickslip.structure.gyroscopic import gyroscopic_modes
from stickslip.structure.mesh import Mesh
from stickslip.structure.rotation_matrices import coriolis_matrix, nodal_mass
from stickslip.structure.sector_reduction import lagged_model

STEEL = ss.Material(200e9, 0.3, 7800.0)
AXIS = (0.0, 0.0, 1.0)
SECTORS, SPEED = 6, 15_000.0


def plate(mesh: Any, radius: float, element: Any = "incompatible") -> Any:
    """A plate that is clamped at its bore of a radius."""
    inner = np.hypot(mesh.points[:, 0], mesh.points[:, 1]) < radius + 1e-6
    return ss.assemble(mesh, STEEL, element, np.flatnonzero(inner))


def symmetry_of(structure: Any, sectors: int) -> Any:
    angle = np.arctan2(structure.mesh.points[:, 1], structure.mesh.points[:, 0])
    left, right = np.abs(angle) < 1e-9, np.abs(angle - 2.0 * np.pi / sectors) < 1e-9
    return ss.cyclic_symmetry(structure.mesh.points, np.flatnonzero(left), np.flatnonzero(right), sectors=sectors)


def small(of: int) -> Any:
    return plate(annulus(SECTORS, (0.05, 0.2), 0.02, (2, 1, 1), of=of), 0.05)


@pytest.fixture(scope="module")
def rotor() -> Any:
    sector = small(1)
    return ss.rotating(sector, AXIS, symmetry=symmetry_of(sector, SECTORS))


def of_both_directions(of_direction: Any, sectors: int) -> Any:
    """All frequencies of the ring from those of a diameter and direction; standing waves come once."""
    waves = [(d, way) for d in range(sectors // 2 + 1) for way in ("forward", "backward")]
    once = [(d, way) for d, way in waves if way == "forward" or 2 * d % sectors]
    return np.sort(np.concatenate([of_direction(d, way) for d, way in once]))


def all_whirling_hz(stiffness: Any, mass: Any, gyroscopic: Any) -> Any:
    """All natural frequencies with Coriolis forces, without a choice of modes."""
    squares, modes = scipy.linalg.eigh(stiffness.toarray(), mass.toarray())
    return gyroscopic_modes(np.sqrt(squares), modes.conj().T @ (gyroscopic @ modes))[0] / (2.0 * np.pi)


@pytest.mark.slow
def test_frequencies_of_all_waves_are_those_of_the_full_ring(rotor: Any) -> None:
    ring = ss.rotating(small(SECTORS), AXIS)
    at_speed = ring.at(SPEED)
    expected = all_whirling_hz(at_speed.stiffness, at_speed.mass, ring.coriolis_at(SPEED))
    sector = rotor.at(SPEED)
    model = lagged_model(sector, rotor.symmetry, rotor.coriolis_at(SPEED))
    every: Any = {}
    for diameter in range(SECTORS // 2 + 1):
        parts = (*model.at(diameter, SECTORS)[:2], model.gyroscopic_at(diameter, SECTORS))
        every |= {(diameter, "backward"): all_whirling_hz(*parts)}
        every |= {(diameter, "forward"): all_whirling_hz(*(each.conj() for each in parts))}
    found = of_both_directions(lambda d, way: every[d, way], SECTORS)
    np.testing.assert_allclose(found, expected, rtol=1e-8)
    # The reduction with nearly all modes: an iteration cannot give the last two.
    rim = np.flatnonzero(np.hypot(*sector.mesh.points[:, :2].T) > 0.199)
    own = np.setdiff1d(rim, rotor.symmetry.right)
    inside = sector.free_unknowns.size - 3 * np.setdiff1d(rotor.symmetry.right, sector.fixed_nodes).size - 3 * own.size
    reduced = ss.cyclic_sector(sector, rotor.symmetry, own, n_modes=inside - 2, gyroscopic=rotor.coriolis_at(SPEED))
    found = of_both_directions(lambda d, way: reduced.natural_frequencies(d, None, way), SECTORS)
    np.testing.assert_allclose(found[:12], expected[:12], rtol=1e-5)
    # The unreduced sector in a basis of modes.
    few = of_both_directions(
        lambda d, way: ss.sector_frequencies(
            sector, rotor.symmetry, [d], 3, gyroscopic=rotor.coriolis_at(SPEED), direction=way
        )[d],
        SECTORS,
    )
    np.testing.assert_allclose(few[:12], expected[:12], rtol=1e-4)
    still = ss.sector_frequencies(sector, rotor.symmetry, [1], 3)[1]
    assert np.abs(reduced.natural_frequencies(1, 3) / still - 1.0).max() > 1e-2


@pytest.mark.slow
def test_waves_of_a_rotating_ring_split_by_the_closed_form() -> None:
    """In the frame of a thin ring that rotates at W the backward wave is faster by ``4 n W / (n^2 + 1)``.

    G. H. Bryan, On the beats in the vibrations of a revolving cylinder or bell, Proc. Camb. Phil. Soc. 7 (1890) 101.
    """
    sectors, speed = 24, 10.0
    mesh = annulus(sectors, (0.0995, 0.1005), 0.01, (1, 3, 1), of=1)
    ring = ss.assemble(mesh, ss.Material(200e9, 0.0, 7800.0), fixed_nodes=[])
    whirl = speed * coriolis_matrix(nodal_mass(mesh, ring.materials), np.array(AXIS))
    symmetry = symmetry_of(ring, sectors)
    forward, backward, still = (
        ss.sector_frequencies(ring, symmetry, [2, 3], 3, gyroscopic=given, direction=way)  # type: ignore[arg-type]
        for given, way in ((whirl, "forward"), (whirl, "backward"), (None, "forward"))
    )
    for waves in (2, 3):
        split = 2.0 * np.pi * (backward[waves] - forward[waves])[0]
        assert split == pytest.approx(4.0 * waves * speed / (waves**2 + 1), rel=4e-3)
        middle = 0.5 * (backward[waves] + forward[waves])[0]
        assert forward[waves][0] < still[waves][0] < backward[waves][0]
        assert middle == pytest.approx(still[waves][0], rel=5e-4)  # the split is of first order in W


@pytest.mark.slow
def test_waves_split_as_in_the_full_ring_of_calculix(tmp_path: Path) -> None:
    """CalculiX rejects Coriolis forces with cyclic symmetry, so that its mesh is the full ring of the same cells."""
    sectors, speed = 12, 20_000.0
    meshes = [annulus(sectors, (0.03, 0.15), 0.01, (4, 1, 1), of=of) for of in (1, sectors)]
    own, mesh = (Mesh(np.round(each.points, 12), each.cells).quadratic() for each in meshes)
    sector = plate(own, 0.0301, "serendipity")
    fixed = plate(mesh, 0.0301, "serendipity").fixed_nodes
    rotor: Any = ss.rotating(sector, AXIS, symmetry=symmetry_of(sector, sectors))
    axis = np.zeros(3), np.array(AXIS)
    without, whirling = speed_frequencies(tmp_path, mesh, STEEL, fixed, axis, speed, 16, 40)
    still = ss.sector_frequencies(rotor.at(speed), rotor.symmetry, range(4), 1)
    waves = {
        way: ss.sector_frequencies(
            rotor.at(speed), rotor.symmetry, range(7), 3, gyroscopic=rotor.coriolis_at(speed), direction=way
        )
        for way in ("forward", "backward")
    }
    every = np.concatenate([each[d] for each in waves.values() for d in each])
    # CalculiX omits one of two waves whose frequencies differ little: each of its frequencies is one of ours.
    nearest = every[np.abs(every - whirling[:9, None]).argmin(axis=1)]
    np.testing.assert_allclose(nearest, whirling[:9], rtol=1e-3)
    for diameter in (2, 3):
        centre = still[diameter][0]
        assert np.abs(without - centre).min() < 1e-3 * centre
        theirs = np.sort(whirling[np.abs(whirling - centre).argsort()[:2]])
        ours = waves["forward"][diameter][0], waves["backward"][diameter][0]
        assert ours[1] - ours[0] > 2e-3 * centre
        assert ours[1] - ours[0] == pytest.approx(np.ptp(theirs), rel=0.01)


@pytest.mark.slow
def test_a_disk_that_rotates_the_other_way_has_exchanged_waves(rotor: Any) -> None:
    other = ss.rotating(rotor.structure, (0.0, 0.0, -1.0), symmetry=rotor.symmetry)
    directions: Any = (rotor, "forward"), (other, "backward")
    one, reverse = (
        ss.sector_frequencies(
            each.at(SPEED), rotor.symmetry, [1, 2], 4, gyroscopic=each.coriolis_at(SPEED), direction=way
        )
        for each, way in directions
    )
    for diameter, hz in one.items():
        np.testing.assert_allclose(reverse[diameter], hz, rtol=1e-9)


@pytest.mark.slow
def test_the_diagram_of_a_disk_has_both_waves(rotor: Any) -> None:
    nodes = [int(np.argmax(np.hypot(*rotor.structure.mesh.points[:, :2].T)))]
    reduced = ss.cyclic_sector(rotor.at(SPEED), rotor.symmetry, nodes, n_modes=6, gyroscopic=rotor.coriolis_at(SPEED))
    axes = reduced.plot(2).axes[0]
    rows = [np.asarray(line.get_ydata()) for line in axes.lines]
    assert len(rows) == 4
    np.testing.assert_allclose(rows[2], [reduced.natural_frequencies(d, 1, "backward")[0] for d in range(4)])
    assert reduced.has_coriolis
    # Standing waves have one frequency.
    for diameter in (0, 3):
        forward, backward = (reduced.natural_frequencies(diameter, 4, way) for way in ("forward", "backward"))
        np.testing.assert_allclose(forward, backward, rtol=1e-12)


def test_input_errors(rotor: Any) -> None:
    structure, symmetry, nodes = rotor.structure, rotor.symmetry, [1]
    whirl = rotor.coriolis_at(SPEED)
    with rejects(ss.InputError, "gyroscopic"):
        ss.sector_frequencies(structure, symmetry, [1], 2, gyroscopic=whirl[:-1, :-1])
    with rejects(ss.InputError, "gyroscopic"):
        ss.cyclic_sector(structure, symmetry, nodes, gyroscopic=scipy.sparse.identity(whirl.shape[0], format="csr"))
    with rejects(ss.InputError, "direction"):
        ss.sector_frequencies(structure, symmetry, [1], 2, direction="up")  # type: ignore[arg-type]
    with rejects(ss.InputError, "speed_rpm"):
        rotor.coriolis_at(-1.0)
    matrices = ss.CyclicSector.of_matrices(
        np.eye(6), 2.0 * np.eye(6), gyroscopic=np.diag([1.0], 5) - np.diag([1.0], -5), left=[0], right=[3], sectors=4
    )
    one = matrices.diameters[1]
    with rejects(ss.InputError, "diameters"):
        replace(matrices, diameters={**matrices.diameters, 1: replace(one, gyroscopic=np.eye(5))})
    with rejects(ss.InputError, "diameters"):
        replace(matrices, diameters={**matrices.diameters, 1: replace(one, gyroscopic=None)})
