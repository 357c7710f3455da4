"""Orthotropic and anisotropic elasticity: elastic matrices, their rotation, and isotropic averages.

Strains are in the order xx, yy, zz, xy, yz, zx, with engineering shear.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.material import Material, isotropic_averages

# Axes of each strain of the order above.
_AXES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
_SYMMETRIC = 1e-6  # largest relative difference of components that are equal
LARGEST_CONTRAST = 1e9  # chosen: of moduli; no material has more, and more leaves no digits to their ratios
_SMALLEST = 1e-9  # ratio of the smallest to the largest eigenvalue below which a material has no stiffness


def orthotropic_matrix(
    young_moduli: Sequence[float], poisson_ratios: Sequence[float], shear_moduli: Sequence[float]
) -> FloatArray:
    """(6, 6) Pa in the axes 1, 2, 3 of the material.

    Parameters
    ----------
    young_moduli:
        E1, E2, E3 in Pa.
    poisson_ratios:
        nu12, nu13, nu23: the contraction along the second axis under tension along the first one, so that
        nu21 = nu12 E2 / E1.
    shear_moduli:
        G12, G13, G23 in Pa.

    Raises
    ------
    InputError
        for constants of which the elastic energy is not positive.
    """
    (e1, e2, e3), (nu12, nu13, nu23), (g12, g13, g23) = young_moduli, poisson_ratios, shear_moduli
    smallest, largest = min(e1, e2, e3, g12, g13, g23), max(e1, e2, e3, g12, g13, g23)
    if not 0.0 < smallest <= largest <= LARGEST_CONTRAST * smallest:
        raise InputError(
            "Young's moduli and shear moduli of an orthotropic material must be above 0, and the largest at most "
            f"{LARGEST_CONTRAST:g} times the smallest; they are {smallest:g} to {largest:g}."
        )
    compliance = np.diag([largest / modulus for modulus in (e1, e2, e3, g12, g23, g13)])  # times the largest modulus
    for (row, column), ratio in (((0, 1), nu12), ((0, 2), nu13), ((1, 2), nu23)):
        compliance[row, column] = compliance[column, row] = -ratio * compliance[row, row]
    if not np.linalg.eigvalsh(compliance)[0] > 0.0:
        raise InputError(
            f"Poisson's ratios {nu12:g}, {nu13:g}, {nu23:g} do not fit Young's moduli {e1:g}, {e2:g}, {e3:g}: the "
            "elastic energy would be negative. Ratios nu12 and nu13 belong to tension along axis 1, nu23 along axis 2."
        )
    with np.errstate(over="ignore"):
        return np.asarray(largest * np.linalg.inv(compliance))


def rotated_matrix(elastic: ArrayLike, axes: ArrayLike) -> FloatArray:
    """(6, 6) Pa in x, y, z from that in axes 1, 2, 3: unit vectors in x, y, z, the rows of ``axes`` (3, 3)."""
    turn = np.asarray(axes, dtype=float)
    local = np.empty((3, 3, 3, 3))
    matrix = np.asarray(elastic, dtype=float)
    for row, (i, j) in enumerate(_AXES):
        for column, (k, m) in enumerate(_AXES):
            local[i, j, k, m] = local[j, i, k, m] = local[i, j, m, k] = local[j, i, m, k] = matrix[row, column]
    turned = np.einsum("ai,bj,ck,dl,abcd->ijkl", turn, turn, turn, turn, local, optimize=True)
    first, second = np.array(_AXES).T
    return np.asarray(turned[first[:, None], second[:, None], first, second])


def anisotropic_material(elastic: ArrayLike, density: float) -> Material:
    """Material with the elastic matrix (6, 6) Pa in x, y, z, and its density in kg/m3.

    ``young_modulus`` and ``poisson_ratio`` are its averages over all directions (:func:`isotropic_averages`), which the
    contact stiffness of rough faces uses.

    Raises InputError for a matrix that is not finite, not symmetric, or whose elastic energy is not positive.
    """
    matrix = np.asarray(elastic, dtype=float)
    largest = float(np.abs(matrix).max())
    if matrix.shape != (6, 6) or not np.isfinite(largest) or np.abs(matrix - matrix.T).max() > _SYMMETRIC * largest:
        raise InputError("the elastic matrix must have 6 x 6 finite numbers and be symmetric.", arguments=["elastic"])
    matrix = 0.5 * (matrix + matrix.T)
    eigenvalues = np.linalg.eigvalsh(matrix)
    if not eigenvalues[0] > _SMALLEST * eigenvalues[-1]:
        raise InputError(
            f"the elastic matrix has the eigenvalue {eigenvalues[0]:.4g} Pa (largest: {eigenvalues[-1]:.4g} Pa). All "
            "must be above 0: check the order of the constants.",
            arguments=["elastic"],
        )
    return Material(*isotropic_averages(matrix), density, elastic=tuple(map(tuple, matrix.tolist())))
