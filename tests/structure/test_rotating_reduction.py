"""One reduction for all speeds against the mesh at each speed, and the polynomial of its matrices."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.linalg

import stickslip as ss
from sentences import rejects
from stickslip.structure.gyroscopic import gyroscopic_modes
from stickslip.structure.rotating_superelement import RPM
from structure_fixtures import brick_block

TOP = 12_000.0


@pytest.fixture(scope="module")
def rotor() -> Any:
    """A beam clamped near an axis that is a little inclined and off its middle, so that the rotation bends it."""
    mesh: Any = brick_block((20, 2, 2), (0.3, 0.02, 0.01))
    beam = ss.assemble(mesh, ss.Material(200e9, 0.3, 7800.0), fixed_nodes=np.flatnonzero(mesh.points[:, 0] < 1e-9))
    return ss.rotating(beam, (0.002, 0.0, 1.0), (-0.05, 0.011, 0.005))


@pytest.fixture(scope="module")
def reduced(rotor: Any) -> Any:
    tip = np.flatnonzero(rotor.structure.mesh.points[:, 0] > 0.3 - 1e-9)
    return ss.rotating_superelement(rotor, tip, TOP, n_modes=15)


def whirling_hz(superelement: Any, count: int) -> Any:
    squares, modes = scipy.linalg.eigh(superelement.stiffness, superelement.mass)
    coupling = modes.T @ (superelement.gyroscopic if superelement.gyroscopic is not None else 0.0 * modes) @ modes
    return gyroscopic_modes(np.sqrt(squares), coupling)[0][:count] / (2.0 * np.pi)


@pytest.mark.slow
@pytest.mark.parametrize("speed", [0.0, 0.5 * TOP, TOP])
def test_one_reduction_has_the_frequencies_of_the_mesh_at_every_speed(rotor: Any, reduced: Any, speed: float) -> None:
    np.testing.assert_allclose(whirling_hz(reduced.at(speed), 6), rotor.natural_frequencies(speed, 6), rtol=2e-4)
    without = reduced.at(speed, coriolis=False)
    assert without.gyroscopic is None
    mesh = rotor.natural_frequencies(speed, 6, coriolis=False)
    np.testing.assert_allclose(whirling_hz(without, 6), mesh, rtol=2e-4)
    assert (whirling_hz(without, 6) >= (1.0 - 1e-9) * mesh).all()  # a Ritz basis is too stiff


@pytest.mark.slow
def test_a_basis_of_rest_alone_would_be_worse(rotor: Any, reduced: Any) -> None:
    nodes = reduced.at_rest.boundary_nodes
    rest = ss.craig_bampton(rotor.structure, nodes, 15)
    basis = np.linalg.qr(np.asarray(rest.recovery @ np.eye(rest.size))[rotor.structure.free_unknowns])[0]
    stiff = rotor.at(TOP)
    hz = np.sqrt(scipy.linalg.eigh(basis.T @ (stiff.stiffness @ basis), basis.T @ (stiff.mass @ basis))[0]) / 2 / np.pi
    mesh = rotor.natural_frequencies(TOP, 6, coriolis=False)
    worse = hz[:6] / mesh - 1.0
    assert worse.max() > 5.0 * (whirling_hz(reduced.at(TOP, coriolis=False), 6) / mesh - 1.0).max()


def test_the_error_at_the_highest_speed_is_reported(rotor: Any, reduced: Any) -> None:
    np.testing.assert_allclose(reduced.full_hz, rotor.natural_frequencies(TOP, 10, coriolis=False), rtol=1e-8)
    np.testing.assert_allclose(reduced.reduced_hz, whirling_hz(reduced.at(TOP, coriolis=False), 10), rtol=1e-8)
    assert 0.0 < reduced.difference_percent.max() < 0.3


def test_static_displacement_and_load_belong_together(rotor: Any, reduced: Any) -> None:
    # The boundary moves as in the mesh under the centrifugal load, which is exact in a Craig-Bampton basis.
    solved = np.linalg.solve(reduced.at_rest.stiffness, reduced.load_at(TOP))
    own = rotor.static_displacement(TOP).reshape(-1, 3)[reduced.at_rest.boundary_nodes]
    np.testing.assert_allclose(solved[: own.size], own.ravel(), rtol=1e-7, atol=1e-9 * np.abs(own).max())
    mesh = reduced.at_rest.recovery @ solved
    np.testing.assert_allclose(mesh, rotor.static_displacement(TOP), atol=1e-3 * np.abs(own).max())


def test_matrices_are_polynomials_of_the_speed(reduced: Any) -> None:
    assert reduced.at(0.0).gyroscopic is None
    omega = RPM * TOP
    half, full = reduced.at(0.5 * TOP), reduced.at(TOP)
    change = full.stiffness - reduced.at_rest.stiffness
    np.testing.assert_allclose(
        half.stiffness - reduced.at_rest.stiffness, 0.25 * change, atol=1e-9 * np.abs(change).max()
    )
    np.testing.assert_allclose(full.gyroscopic, omega * reduced.coriolis)
    np.testing.assert_allclose(half.gyroscopic, 0.5 * full.gyroscopic)
    assert np.array_equal(reduced.coriolis, -reduced.coriolis.T)


def test_input_errors(rotor: Any, reduced: Any) -> None:
    nodes = reduced.at_rest.boundary_nodes
    for speed in (-1.0, 1.01 * TOP):
        with rejects(ss.InputError, "speed_rpm"):
            reduced.at(speed)
    with rejects(ss.InputError, "top_speed_rpm"):
        ss.rotating_superelement(rotor, nodes, 0.0)
    with rejects(ss.InputError, "n_modes"):
        ss.rotating_superelement(rotor, nodes, TOP, n_modes=10_000)
    with rejects(ss.InputError, "coriolis"):
        replace(reduced, coriolis=np.eye(reduced.at_rest.size))
    with rejects(ss.InputError, "load"):
        replace(reduced, load=reduced.load[1:])


def mass_on_a_spring(stiffness: float) -> Any:
    empty = np.zeros(0)
    rest = ss.Superelement(2.0 * np.eye(1), stiffness * np.eye(1))
    return ss.RotatingSuperelement(rest, -2.0 * np.eye(1), np.zeros((1, 1)), np.zeros(1), 1000.0, empty, empty)


def test_a_mass_on_a_spring_collapses_at_its_natural_frequency() -> None:
    assert mass_on_a_spring(5e4).collapse_speed_rpm == pytest.approx(np.sqrt(5e4 / 2.0) / RPM, rel=1e-12)
    with rejects(ss.InputError, "top_speed_rpm"):
        mass_on_a_spring(2.0 * (999.0 * RPM) ** 2)
    with rejects(ss.InputError):
        mass_on_a_spring(0.0)


def test_whirling_modes_satisfy_their_equation() -> None:
    random = np.random.default_rng(2)
    coupling = 40.0 * random.standard_normal((6, 6))
    coupling -= coupling.T
    frequency = np.array([0.0, 10.0, 30.0, 55.0, 70.0, 100.0])  # one without stiffness
    whirl, shapes = gyroscopic_modes(frequency, coupling)
    for omega, shape in zip(whirl, shapes.T, strict=True):
        left = -(omega**2) * shape + 1j * omega * coupling @ shape + frequency**2 * shape
        assert np.abs(left).max() < 1e-9 * 100.0**2
        size = omega**2 * np.vdot(shape, shape).real + (frequency**2 * np.abs(shape) ** 2).sum()
        assert size == pytest.approx(2.0 * omega**2, rel=1e-9)
    np.testing.assert_allclose(gyroscopic_modes(frequency[1:], np.zeros((5, 5)))[0], frequency[1:], rtol=1e-12)
