"""Orthotropic and anisotropic elasticity: closed forms, rotations, patch tests, and the average over directions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sentences import rejects
from solid_cells import require_constant_strain
from stickslip.core.errors import InputError
from stickslip.structure.anisotropy import anisotropic_material, orthotropic_matrix, rotated_matrix
from stickslip.structure.elasticity import Material, assemble
from stickslip.structure.mesh import Mesh

# Pa; E, nu, G of a laminate with three different directions.
LAMINATE = ((160e9, 11e9, 9e9), (0.3, 0.25, 0.4), (6e9, 5e9, 3e9))
# Single-crystal nickel: C11, C12, C44 in Pa.
CUBIC = (250e9, 160e9, 118e9)
TURN = Rotation.from_euler("zyx", [0.3, -0.7, 1.1])
DIRECTIONS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))


def cubic() -> np.ndarray:
    c11, c12, c44 = CUBIC
    matrix = np.diag([c11 - c12] * 3 + [c44] * 3)
    matrix[:3, :3] += c12
    return matrix


def strain_vector(tensor: np.ndarray) -> np.ndarray:
    return np.array([tensor[i, j] * (1 if i == j else 2) for i, j in DIRECTIONS])


def stress_tensor(vector: np.ndarray) -> np.ndarray:
    tensor = np.zeros((3, 3))
    for value, (i, j) in zip(vector, DIRECTIONS, strict=True):
        tensor[i, j] = tensor[j, i] = value
    return tensor


def test_isotropic_constants_give_the_isotropic_matrix() -> None:
    steel = Material(210e9, 0.3, 7850.0)
    shear = 210e9 / 2.6
    matrix = orthotropic_matrix([210e9] * 3, [0.3] * 3, [shear] * 3)
    np.testing.assert_allclose(matrix, steel.elastic_matrix(), rtol=1e-12, atol=1.0)
    np.testing.assert_allclose(rotated_matrix(matrix, TURN.as_matrix()), matrix, rtol=1e-12, atol=1e-3)
    again = anisotropic_material(matrix, 7850.0)
    assert (again.young_modulus, again.poisson_ratio) == pytest.approx((210e9, 0.3))


def test_tension_along_each_axis() -> None:
    """Strains under uniaxial stress are those of the definition of the constants."""
    moduli, (nu12, nu13, nu23), shears = LAMINATE
    compliance = np.linalg.inv(orthotropic_matrix(*LAMINATE))
    np.testing.assert_allclose(1.0 / np.diag(compliance)[:3], moduli)
    np.testing.assert_allclose(-compliance[1, 0] / compliance[0, 0], nu12)
    np.testing.assert_allclose(-compliance[2, 0] / compliance[0, 0], nu13)
    np.testing.assert_allclose(-compliance[2, 1] / compliance[1, 1], nu23)
    g12, g13, g23 = shears
    np.testing.assert_allclose(1.0 / np.diag(compliance)[3:], [g12, g23, g13])


def test_rotation_against_rotated_strain_and_stress() -> None:
    """Strain into the axes of the material, stress there, and back into x, y, z."""
    axes = TURN.as_matrix()
    local = orthotropic_matrix(*LAMINATE)
    strain = np.random.default_rng(1).normal(size=(3, 3))
    strain += strain.T
    stress = axes.T @ stress_tensor(local @ strain_vector(axes @ strain @ axes.T)) @ axes
    turned = rotated_matrix(local, axes)
    np.testing.assert_allclose(stress_tensor(turned @ strain_vector(strain)), stress, rtol=1e-12, atol=1e-3)


def test_modulus_of_a_cubic_crystal_along_a_diagonal() -> None:
    """1 / E(n) = S11 - 2 (S11 - S12 - S44 / 2) (l^2 m^2 + m^2 n^2 + n^2 l^2), Nye, Physical Properties of Crystals."""
    s = np.linalg.inv(cubic())
    n = np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0)
    axes = np.vstack([n, [0, 0, 1], np.cross(n, [0, 0, 1])])  # rows: the frame of the specimen in that of the crystal
    along = np.linalg.inv(rotated_matrix(cubic(), axes.T))[0, 0]
    assert along == pytest.approx(s[0, 0] - 2.0 * (s[0, 0] - s[0, 1] - 0.5 * s[3, 3]) * 0.25)


def test_average_of_a_cubic_crystal() -> None:
    """K = (C11 + 2 C12) / 3; G between Reuss and Voigt."""
    c11, c12, c44 = CUBIC
    crystal = anisotropic_material(rotated_matrix(cubic(), TURN.as_matrix()), 8000.0)
    voigt = (c11 - c12 + 3.0 * c44) / 5.0
    reuss = 5.0 * (c11 - c12) * c44 / (4.0 * c44 + 3.0 * (c11 - c12))
    bulk, shear = (c11 + 2.0 * c12) / 3.0, 0.5 * (voigt + reuss)
    assert crystal.young_modulus == pytest.approx(9.0 * bulk * shear / (3.0 * bulk + shear))
    assert crystal.poisson_ratio == pytest.approx((3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear))


def test_a_modulus_beside_an_elastic_matrix_is_rejected() -> None:
    """It would have no effect on the structure."""
    crystal = anisotropic_material(cubic(), 8000.0)
    with rejects(InputError, "young_modulus", "elastic"):
        replace(crystal, young_modulus=0.8 * crystal.young_modulus)
    assert replace(crystal, density=7000.0).elastic == crystal.elastic


@pytest.mark.parametrize("element", ["incompatible", "trilinear", "serendipity"])
def test_patch_of_distorted_bricks(make_block: Callable[..., Mesh], element: str) -> None:
    material = anisotropic_material(rotated_matrix(orthotropic_matrix(*LAMINATE), TURN.as_matrix()), 1600.0)
    structure = assemble(make_block((3, 3, 3), (1.0, 1.0, 1.0), 0.15), material, element)  # type: ignore[arg-type]
    outer = structure.mesh.sides("all")[0]
    require_constant_strain(structure, structure.mesh.points, outer.ravel(), material)


@pytest.mark.parametrize(
    ("moduli", "ratios", "shears"),
    [
        ((1.0, 1.0, 0.0), (0.3,) * 3, (1.0,) * 3),
        ((1.0, 100.0, 1.0), (0.9, 0.1, 0.1), (1.0,) * 3),
        ((2e11,) * 3, (0.3,) * 3, (1e11, 1e-320, 1e11)),
        ((2e11,) * 3, (1e308, 0.3, 0.3), (1e11,) * 3),
    ],
)
def test_impossible_constants(moduli: tuple[float, ...], ratios: tuple[float, ...], shears: tuple[float, ...]) -> None:
    with rejects(InputError):
        orthotropic_matrix(moduli, ratios, shears)


@pytest.mark.parametrize("size", [1e-320, 1e308])
def test_the_size_of_the_moduli_does_not_matter(size: float) -> None:
    found = orthotropic_matrix((size,) * 3, (0.0,) * 3, (size,) * 3)
    np.testing.assert_allclose(found, np.diag([size] * 6), rtol=1e-9)


@pytest.mark.parametrize("change", [(0, 1, 1e12), (0, 0, -1e12), (0, 0, np.nan)])
def test_impossible_matrices(change: tuple[int, int, float]) -> None:
    row, column, value = change
    matrix = cubic()
    matrix[row, column] = value
    with rejects(InputError, "elastic"):
        anisotropic_material(matrix, 8000.0)
