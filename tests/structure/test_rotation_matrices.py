"""Coriolis, softening and stress stiffness: symmetries, exact properties of every element, and a rotating ring."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg

from calculix import cut_bricks
from stickslip.structure.body_load import centrifugal_load
from stickslip.structure.elasticity import Material, assemble_bodies
from stickslip.structure.factor import factorize
from stickslip.structure.mesh import Mesh
from stickslip.structure.rotation_matrices import (
    coriolis_matrix,
    nodal_mass,
    softening_matrix,
    stress_stiffness_matrix,
)
from structure_fixtures import brick_block

STEEL = Material(200e9, 0.3, 7800.0)
AXIS, POINT = np.array([0.6, 0.0, 0.8]), np.array([0.01, -0.02, 0.0])
KINDS = ("incompatible", "trilinear", "hexahedron20", "tetra", "tetra10", "wedge", "wedge15")


def block(kind: str) -> tuple[Mesh, Any]:
    """A distorted block in cells of one kind, clamped at x = 0, and its structure."""
    mesh: Any = brick_block((3, 2, 2), (0.06, 0.03, 0.02))
    if kind == "hexahedron20":
        mesh = mesh.quadratic()
    elif kind not in ("incompatible", "trilinear"):
        mesh = cut_bricks(mesh, kind)
    bend = np.array([[1.0, 0.1, 0.0], [0.0, 1.0, 0.2], [0.1, 0.0, 1.0]])  # cells that are no cubes, but parallelepipeds
    fixed = np.flatnonzero(mesh.points[:, 0] < 1e-9)
    mesh = Mesh(mesh.points @ bend, mesh.cells)
    element: Any = kind if kind in ("incompatible", "trilinear") else "incompatible"
    return mesh, assemble_bodies(mesh, [STEEL], element, fixed_nodes=fixed)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_rotation_about_the_axis_changes_no_force(kind: str) -> None:
    # Rotated about the axis, the body has the same stress and the same centrifugal load, both rotated: the force of its
    # stress stiffness is that of its softening. This is exact in every element, because rotations are linear.
    mesh, structure = block(kind)
    load = centrifugal_load(mesh, [STEEL], AXIS, POINT)
    static = structure.expand(factorize(structure.stiffness).solve(structure.gather(load)))
    change = stress_stiffness_matrix(structure, static) - softening_matrix(nodal_mass(mesh, [STEEL]), AXIS)
    rotation = np.cross(AXIS, mesh.points - POINT).ravel()
    force = change @ rotation
    assert np.abs(force[structure.free_unknowns]).max() < 1e-11 * np.abs(load).max()
    assert np.abs(force[structure.fixed_unknowns]).max() > 0.1 * np.abs(load).max()  # reactions, which do not rotate


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_symmetries(kind: str) -> None:
    mesh, structure = block(kind)
    random = np.random.default_rng(1).standard_normal(structure.full_size)
    stress, mass = stress_stiffness_matrix(structure, random), nodal_mass(mesh, [STEEL])
    assert abs(stress - stress.T).max() < 1e-12 * abs(stress).max()
    translation = np.tile(np.eye(3), (mesh.n_nodes, 1))
    assert np.abs(stress @ translation).max() < 1e-10 * abs(stress).max()
    coriolis, softening = coriolis_matrix(mass, AXIS), softening_matrix(mass, AXIS)
    assert abs(coriolis + coriolis.T).max() < 1e-14 * abs(coriolis).max()
    assert abs(softening - softening.T).max() < 1e-14 * abs(softening).max()
    total = mass.sum()
    # A velocity v has the Coriolis force 2 m a x v, a displacement d the centrifugal force m (d - (a d) a).
    np.testing.assert_allclose(
        translation.T @ coriolis @ translation, 2.0 * total * np.cross(AXIS, np.eye(3)).T, atol=1e-12
    )
    np.testing.assert_allclose(
        translation.T @ softening @ translation, total * (np.eye(3) - np.outer(AXIS, AXIS)), atol=1e-12
    )


def ring(around: int, radius: float, width: float, depth: float) -> Mesh:
    """A thin ring of one 8-node brick through its section about the z axis."""
    angle = np.arange(around) * 2.0 * np.pi / around
    corners = np.array([[radius + s * width / 2.0, t * depth / 2.0] for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    points = np.array([[r * np.cos(a), r * np.sin(a), z] for a in angle for r, z in corners])
    here = 4 * np.arange(around)[:, None]
    ahead = 4 * ((np.arange(around) + 1) % around)[:, None]
    return Mesh(points, np.hstack([here + np.arange(4), ahead + np.arange(4)])[:, [0, 1, 5, 4, 3, 2, 6, 7]])


@pytest.mark.slow
def test_a_free_ring_whirls_with_the_frequencies_of_the_closed_form() -> None:
    # In-plane, inextensional: w = 2 n W / (n^2 + 1) +- sqrt(n^2 (n^2 - 1)^2 / (n^2 + 1) (E I / (rho A R^4) + W^2 / (n^2
    # + 1))) in the rotating frame, with the hoop tension of the rotation.
    young, density, radius, width = 200e9, 7800.0, 0.5, 0.01
    material = Material(young, 0.0, density)
    mesh = ring(72, radius, width, 0.01)
    flat = 3 * np.arange(mesh.n_nodes) + 2
    free = assemble_bodies(mesh, [material], fixed_unknowns=flat)
    # Three supports that carry nothing under a load with the symmetry of the ring.
    far = int(np.argmin(mesh.points[:, 0]))
    supported = assemble_bodies(mesh, [material], fixed_unknowns=[*flat, 0, 1, 3 * far + 1])
    axis = np.array([0.0, 0.0, 1.0])
    load = centrifugal_load(mesh, [material], axis, np.zeros(3))
    static = supported.expand(factorize(supported.stiffness).solve(supported.gather(load)))
    mass = nodal_mass(mesh, [material])
    unknowns = free.free_unknowns
    change, coriolis = (
        matrix[unknowns][:, unknowns].toarray()
        for matrix in (
            stress_stiffness_matrix(free, static) - softening_matrix(mass, axis),
            coriolis_matrix(mass, axis),
        )
    )
    values, modes = scipy.linalg.eigh(free.stiffness.toarray(), free.mass.toarray(), subset_by_index=(0, 39))
    bending = young * width**2 / 12.0 / (density * radius**4)
    at_rest, omega = np.sqrt(values.clip(0.0)), 60.0
    stiffness = np.diag(values) + omega**2 * (modes.T @ change @ modes)
    state = np.block([[np.zeros((40, 40)), np.eye(40)], [-stiffness, -omega * (modes.T @ coriolis @ modes)]])
    found = np.abs(np.linalg.eigvals(state).imag)
    for n in (2, 3):
        factor = n**2 * (n**2 - 1) ** 2 / (n**2 + 1)
        root, apart = np.sqrt(factor * (bending + omega**2 / (n**2 + 1))), 2.0 * n * omega / (n**2 + 1)
        forward, backward = (found[np.abs(found - root - sign * apart).argmin()] for sign in (1.0, -1.0))
        own = at_rest[np.abs(at_rest - np.sqrt(factor * bending)).argmin()]
        # The flat sides of the mesh cost 1 % of the frequency at rest, which is not the matter of this test.
        assert own == pytest.approx(np.sqrt(factor * bending), rel=0.01)
        assert forward - backward == pytest.approx(2.0 * apart, rel=5e-3)
        stiffening = factor * omega**2 / (n**2 + 1)
        assert (0.5 * (forward + backward)) ** 2 - own**2 == pytest.approx(stiffening, rel=0.015)
