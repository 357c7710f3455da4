"""Shape functions, quadrature and strain matrices of bricks on the reference cube [-1, 1]^3."""

from __future__ import annotations

import numpy as np

from stickslip.errors import InputError
from stickslip.structure.mesh import CORNERS, EDGES
from stickslip.validation import FloatArray

NODES = np.vstack([CORNERS, CORNERS[EDGES].mean(axis=1)])


def gauss_points(order: int) -> tuple[FloatArray, FloatArray]:
    """Points (order^3, 3) and weights (order^3,) of the Gauss product rule with ``order`` points a direction."""
    abscissa, weight = np.polynomial.legendre.leggauss(order)
    points = np.stack(np.meshgrid(abscissa, abscissa, abscissa, indexing="ij"), axis=-1).reshape(-1, 3)
    weights = np.einsum("i,j,k->ijk", weight, weight, weight).ravel()
    return points, weights


def shape_functions(n_nodes: int, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values (q, k) and gradients (q, k, 3) of the 8-node or 20-node brick at points (q, 3), in VTK node order.

    The functions are those of scikit-fem (``ElementHex1``, ``ElementHexS2``), whose reference cube is [0, 1]^3 and
    whose nodes come in another order: nodes are matched by their reference coordinates.
    """
    from skfem import ElementHex1, ElementHexS2

    element = ElementHex1() if n_nodes == 8 else ElementHexS2()
    distance = np.abs(0.5 * (1.0 + NODES[:n_nodes, None, :]) - element.doflocs[None, :, :]).max(axis=2)
    unit_points = 0.5 * (1.0 + points.T)
    basis = [element.lbasis(unit_points, int(position)) for position in distance.argmin(axis=1)]
    values = np.stack([value for value, _ in basis], axis=1)
    gradients = 0.5 * np.stack([gradient.T for _, gradient in basis], axis=1)
    return values, gradients


def jacobians(corners: FloatArray, gradients: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Jacobian (m, 3, 3), d x_j / d xi_i, and determinant (m,) at one reference point.

    ``corners`` (m, k, 3) are the nodes of the cells, ``gradients`` (k, 3) those of the shape functions at the point.
    Raises InputError where the determinant is not positive.
    """
    jacobian = np.einsum("ka,mkb->mab", gradients, corners)
    determinant = np.linalg.det(jacobian)
    bad = np.flatnonzero(determinant <= 0.0)
    if bad.size:
        raise InputError(
            f"cell {bad[0]} is folded: its Jacobian is {determinant[bad[0]]:.3g} m3 at an integration point and must "
            "be above 0. Check its nodes, midside nodes included."
        )
    return jacobian, determinant


def strain_matrix(gradients: FloatArray) -> FloatArray:
    """(m, 6, 3k) matrix from nodal displacements to strain xx, yy, zz, xy, yz, zx (engineering shear).

    ``gradients`` (m, k, 3) are d N / d x of each function in each cell.
    """
    n_cells, n_functions, _ = gradients.shape
    strain = np.zeros((n_cells, 6, n_functions, 3))
    x, y, z = gradients[..., 0], gradients[..., 1], gradients[..., 2]
    strain[:, 0, :, 0] = x
    strain[:, 1, :, 1] = y
    strain[:, 2, :, 2] = z
    strain[:, 3, :, 0], strain[:, 3, :, 1] = y, x
    strain[:, 4, :, 1], strain[:, 4, :, 2] = z, y
    strain[:, 5, :, 2], strain[:, 5, :, 0] = x, z
    return strain.reshape(n_cells, 6, 3 * n_functions)


def compatible_stiffness(cells: FloatArray, elastic: FloatArray, order: int) -> FloatArray:
    """(m, 3k, 3k) stiffness ``integral of B^T D B`` of 8-node or 20-node bricks, N/m.

    ``cells`` (m, k, 3) node coordinates in m, ``elastic`` (6, 6) Pa, ``order`` Gauss points a direction.
    """
    n_nodes = cells.shape[1]
    points, weights = gauss_points(order)
    _, gradients = shape_functions(n_nodes, points)
    stiffness = np.zeros((len(cells), 3 * n_nodes, 3 * n_nodes))
    for gradient, weight in zip(gradients, weights, strict=True):
        jacobian, determinant = jacobians(cells, gradient)
        strain = strain_matrix(gradient @ np.linalg.inv(jacobian).swapaxes(1, 2))
        stiffness += strain.swapaxes(1, 2) @ ((weight * determinant)[:, None, None] * (elastic @ strain))
    return stiffness


def consistent_mass(cells: FloatArray, density: float, order: int) -> FloatArray:
    """(m, k, k) mass ``integral of density N_i N_j``, kg, the same for each of the three directions."""
    n_nodes = cells.shape[1]
    points, weights = gauss_points(order)
    values, gradients = shape_functions(n_nodes, points)
    mass = np.zeros((len(cells), n_nodes, n_nodes))
    for value, gradient, weight in zip(values, gradients, weights, strict=True):
        _, determinant = jacobians(cells, gradient)
        mass += (density * weight * determinant)[:, None, None] * np.outer(value, value)
    return mass
