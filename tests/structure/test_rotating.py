"""A rotating structure: closed forms of a rod, of beams and of collapse; CalculiX at a speed; input errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg

import stickslip as ss
from calculix_rotation import RPM, speed_frequencies
from sectors import annulus
from sentences import rejects
from stickslip.structure.mesh import Mesh
from structure_fixtures import brick_block

STEEL = ss.Material(200e9, 0.3, 7800.0)


def cantilever(counts: Any, lengths: Any, element: Any = "incompatible", material: Any = STEEL) -> Any:
    """A block clamped at x = 0, with its axis y = z = 0 through the middle of its section."""
    mesh: Any = brick_block(counts, lengths)
    mesh = Mesh(mesh.points - np.array([0.0, lengths[1] / 2.0, lengths[2] / 2.0]), mesh.cells)
    mesh = mesh.quadratic() if element == "serendipity" else mesh
    return ss.assemble(mesh, material, element, np.flatnonzero(mesh.points[:, 0] < 1e-9))


def test_a_rod_stretches_by_its_closed_form() -> None:
    # u(L) = rho W^2 L^3 / (3 E) without Poisson's effect
    rod = cantilever((12, 1, 1), (0.3, 0.01, 0.01), "serendipity", ss.Material(200e9, 0.0, 7800.0))
    tip = ss.rotating(rod, (0, 0, 2.0)).static_displacement(6000.0).reshape(-1, 3)[:, 0].max()
    assert tip == pytest.approx(7800.0 * (6000.0 * RPM) ** 2 * 0.3**3 / (3.0 * 200e9), rel=1e-3)


# The uniform rotating cantilever without hub, out of the plane of rotation: W and w in sqrt(E I / (rho A L^4)).
# A. D. Wright, C. E. Smith, R. W. Thresher, J. L. C. Wang, Vibration modes of centrifugally stiffened beams, J. Appl.
# Mech. 49 (1982) 197-202.
FLAP = {0.0: (3.5160, 22.0345), 2.0: (4.1373, 22.6149), 6.0: (7.3604, 26.8091), 12.0: (13.1702, 37.6031)}


@pytest.mark.slow
@pytest.mark.parametrize("speed", FLAP)
def test_a_rotating_cantilever_has_the_frequencies_of_the_beam(speed: float) -> None:
    length, width, depth = 1.0, 0.02, 0.01
    beam = cantilever((40, 1, 1), (length, width, depth), material=ss.Material(200e9, 0.0, 7800.0))
    unit = np.sqrt(200e9 * depth**2 / 12.0 / (7800.0 * length**4))
    lead = np.sqrt(200e9 * width**2 / 12.0 / (7800.0 * length**4))
    flap = ss.rotating(beam, (0, 0, 1)).natural_frequencies(speed * unit / RPM, 4) * 2.0 * np.pi / unit
    for expected in FLAP[speed]:
        assert np.abs(flap / expected - 1.0).min() < 2e-3
    # In the plane of rotation the softening takes the square of the speed: w_lead^2 = w_flap^2 - W^2.
    in_plane = ss.rotating(beam, (0, 0, 1)).natural_frequencies(speed * lead / RPM, 4, coriolis=False)
    expected = np.sqrt(FLAP[speed][0] ** 2 - speed**2)
    assert np.abs(in_plane * 2.0 * np.pi / lead / expected - 1.0).min() < 4e-3


def test_stiffness_collapses_where_a_dense_solution_says_so() -> None:
    rotor = ss.rotating(cantilever((4, 1, 1), (0.2, 0.02, 0.01)), (0.0, 1.0, 0.0), (0.02, 0.0, 0.0))
    largest = scipy.linalg.eigvalsh(-rotor.speed_stiffness.toarray(), rotor.structure.stiffness.toarray())[-1]
    collapse_rpm = 1.0 / np.sqrt(largest) / RPM
    assert rotor.at(0.9999 * collapse_rpm).stiffness.shape == rotor.structure.stiffness.shape
    with pytest.raises(ss.InputError) as caught:
        rotor.at(1.5 * collapse_rpm)
    said = float(str(caught.value).partition("collapses at ")[2].partition(" rpm")[0])
    assert said == pytest.approx(collapse_rpm, rel=2e-4)
    assert said >= collapse_rpm
    with rejects(ss.InputError, "speed_rpm"):
        rotor.at(70_000.0)


@pytest.mark.slow
@pytest.mark.parametrize(("element", "kind"), [("serendipity", "C3D20"), ("incompatible", "C3D8I")])
def test_frequencies_of_a_beam_at_a_speed_are_those_of_calculix(tmp_path: Path, element: Any, kind: str) -> None:
    beam = cantilever((10, 2, 2), (0.3, 0.02, 0.01), element)
    axis = np.array([-0.05, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    rotor = ss.rotating(beam, axis[1], axis[0])
    rest, speed = (
        (speed_frequencies(tmp_path, beam.mesh, STEEL, beam.fixed_nodes, axis, rpm, 5, 20), rpm)
        for rpm in (1.0, 10_000.0)
    )
    for coriolis in (False, True):
        theirs = speed[0][coriolis] / rest[0][coriolis]
        ours = rotor.natural_frequencies(speed[1], 5, coriolis) / rotor.natural_frequencies(1.0, 5, coriolis)
        # C3D8I has other incompatible modes, so only the effect of the speed is compared.
        np.testing.assert_allclose(ours, theirs, rtol=1e-3)
        assert theirs[0] > 2.0  # the first mode more than doubles
        if kind == "C3D20":
            np.testing.assert_allclose(rotor.natural_frequencies(speed[1], 5, coriolis), speed[0][coriolis], rtol=5e-4)


@pytest.mark.slow
def test_travelling_waves_of_a_disk_split_as_in_calculix(tmp_path: Path) -> None:
    mesh: Any = annulus(12, (0.03, 0.15), 0.01, (4, 1, 1), of=12)
    mesh = Mesh(np.round(mesh.points, 12), mesh.cells).quadratic()
    fixed = np.flatnonzero(np.hypot(mesh.points[:, 0], mesh.points[:, 1]) < 0.0301)
    disk = ss.assemble(mesh, STEEL, "serendipity", fixed)
    axis = np.zeros(3), np.array([0.0, 0.0, 1.0])
    rotor, speed = ss.rotating(disk, axis[1]), 20_000.0
    without, whirling = speed_frequencies(tmp_path, mesh, STEEL, fixed, axis, speed, 16, 40)
    np.testing.assert_allclose(rotor.natural_frequencies(speed, 16, coriolis=False), without, rtol=1e-3)
    ours = rotor.natural_frequencies(speed, 16)
    # CalculiX omits one of two waves whose frequencies differ little: each of its frequencies is one of ours.
    nearest = ours[np.abs(ours - whirling[:9, None]).argmin(axis=1)]
    np.testing.assert_allclose(nearest, whirling[:9], rtol=1e-3)
    for waves in (slice(3, 5), slice(5, 7)):  # two and three nodal diameters: equal without Coriolis forces
        centre = without[waves].mean()
        assert np.ptp(without[waves]) < 1e-6 * centre
        split, own = (np.ptp(each[np.abs(each - centre).argsort()[:2]]) for each in (whirling, ours))
        assert split > 2e-3 * centre
        assert own == pytest.approx(split, rel=0.01)


def test_input_errors() -> None:
    beam = cantilever((2, 1, 1), (0.2, 0.02, 0.01))
    with rejects(ss.InputError, "axis"):
        ss.rotating(beam, (0, 0, 0))
    with rejects(ss.InputError, "point"):
        ss.rotating(beam, (0, 0, 1), (0, 0))
    with rejects(ss.InputError, "structure"):
        ss.rotating(ss.assemble(beam.mesh, STEEL, fixed_nodes=[]), (0, 0, 1))
    with rejects(ss.InputError, "structure"):
        ss.rotating(ss.Structure(beam.mesh, beam.stiffness, beam.mass, beam.fixed_nodes, "incompatible"), (0, 0, 1))
    with rejects(ss.InputError, "speed_rpm"):
        ss.rotating(beam, (0, 0, 1)).at(-1.0)
    with rejects(ss.InputError, "speed_rpm"):  # bent by an axis beside it
        ss.rotating(cantilever((10, 1, 1), (0.2, 0.02, 0.01)), (0, 0, 1), (0, 0.5, 0)).at(6000.0)
