"""Motions of the mesh of a sector and of the whole disk, against the full ring assembled by the ordinary path."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

from sectors import annulus
from stickslip.core.errors import InputError
from stickslip.structure.cyclic_sector import folded
from stickslip.structure.elasticity import Material, Structure, assemble
from stickslip.structure.ring import Ring
from stickslip.structure.sector_boundaries import cyclic_symmetry
from stickslip.structure.sector_structure import SectorStructure

SECTORS = 6
MESH = annulus(SECTORS, (0.05, 0.15), 0.01, (3, 2, 1))
SYMMETRY = cyclic_symmetry(MESH.points, MESH.node_set("left"), MESH.node_set("right"))
RING = Ring.of(MESH, SYMMETRY)


def sector() -> SectorStructure:
    return SectorStructure(assemble(MESH, Material(), fixed_nodes=MESH.node_set("inner")), SYMMETRY)


def ring() -> Structure:
    return assemble(RING.mesh, Material(), fixed_nodes=RING.mesh.node_set("inner"))


def test_the_ring_is_the_plate() -> None:
    whole = annulus(SECTORS, (0.05, 0.15), 0.01, (3, 2, 1), of=SECTORS)
    assert RING.mesh.n_nodes == whole.n_nodes
    distance = np.linalg.norm(RING.mesh.points[:, None] - whole.points, axis=2).min(axis=1)
    assert distance.max() < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("waves", [0, 1, -1, 2, -2, 3])
def test_a_mode_of_the_reduced_sector_on_the_whole_disk(waves: int) -> None:
    """Its Rayleigh quotient on the full ring is the square of its frequency, and so is its residual along itself."""
    own, full = sector(), ring()
    outer = int(np.argmax(np.linalg.norm(MESH.points, axis=1) - 1e3 * np.isin(np.arange(MESH.n_nodes), SYMMETRY.right)))
    reduced = own.reduced(np.array([outer]), 12)
    matrices = reduced.lagged(waves)
    squares, modes = scipy.linalg.eigh(matrices.stiffness, matrices.mass)
    shape = modes[:, 1] * np.exp(0.7j)
    coefficients = np.stack([np.zeros(reduced.size), shape.real, -shape.imag], axis=1)
    motion = own.motion(reduced, coefficients, [waves])
    sectors = []
    for ahead in range(SECTORS):
        amplitude = (motion[:, 1] - 1j * motion[:, 2]) * np.exp(2j * np.pi * waves * ahead / SECTORS)
        sectors.append(np.stack([motion[:, 0], amplitude.real, -amplitude.imag], axis=1))
    moved = RING.motion(np.stack(sectors))
    amplitude = (moved[:, 1] - 1j * moved[:, 2])[full.free_unknowns]
    quotient = (amplitude.conj() @ (full.stiffness @ amplitude)) / (amplitude.conj() @ (full.mass @ amplitude))
    np.testing.assert_allclose(quotient.real, squares[1], rtol=1e-9)
    # the kinetic energy of the ring is that of all sectors, so no part of the mesh is missing or counted twice
    np.testing.assert_allclose((amplitude.conj() @ (full.mass @ amplitude)).real, SECTORS, rtol=1e-9)
    assert folded(waves, SECTORS) == abs(waves)


def test_a_sector_without_recovery() -> None:
    reduced = sector().reduced(np.array([MESH.n_nodes // 2]), 4).without_recovery()
    with pytest.raises(InputError, match="fixed-interface modes"):
        sector().motion(reduced, np.zeros((reduced.size, 3)), [1])
