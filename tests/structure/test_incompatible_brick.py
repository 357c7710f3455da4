import numpy as np

from solid_cells import CORNERS
from stickslip.structure.elasticity import Material
from stickslip.structure.incompatible_brick import incompatible_stiffness
from stickslip.structure.shapes import compatible_stiffness

ELASTIC = Material(young_modulus=3.0, poisson_ratio=0.0).elastic_matrix()


def test_pure_bending_of_a_rectangular_brick_is_exact() -> None:
    lengths = np.array([3.0, 1.0, 0.5])
    corners = 0.5 * CORNERS * lengths
    curvature = 0.2
    # u = k x z; the exact w = -k x^2 / 2 is equal at all corners, so it needs the internal modes.
    bending = np.zeros((8, 3))
    bending[:, 0] = curvature * corners[:, 0] * corners[:, 2]
    moved = bending.ravel()
    energy = 0.5 * moved @ incompatible_stiffness(corners[None], ELASTIC)[0] @ moved
    inertia = lengths[1] * lengths[2] ** 3 / 12.0
    np.testing.assert_allclose(energy, 0.5 * 3.0 * inertia * curvature**2 * lengths[0], rtol=1e-12)
    locked = 0.5 * moved @ compatible_stiffness(corners[None], ELASTIC)[0] @ moved
    assert locked > 10.0 * energy


def test_never_stiffer_than_the_trilinear_brick() -> None:
    corners = CORNERS + 0.2 * np.random.default_rng(3).uniform(-1.0, 1.0, (4, 8, 3))
    difference = compatible_stiffness(corners, ELASTIC) - incompatible_stiffness(corners, ELASTIC)
    assert np.linalg.eigvalsh(difference).min() > -1e-12


def test_stiffness_does_not_depend_on_the_order_of_the_corners() -> None:
    corners = CORNERS + 0.2 * np.random.default_rng(3).uniform(-1.0, 1.0, (8, 3))
    turned = np.array([4, 0, 3, 7, 5, 1, 2, 6])
    unknowns = (3 * turned[:, None] + np.arange(3)).ravel()
    stiffness = incompatible_stiffness(corners[None], ELASTIC)[0]
    rotated = incompatible_stiffness(corners[turned][None], ELASTIC)[0]
    np.testing.assert_allclose(rotated, stiffness[np.ix_(unknowns, unknowns)], atol=1e-12)
