"""Shape functions, quadrature and strain matrices on the reference cells of ``cell_kinds``."""

from __future__ import annotations

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.cell_kinds import KIND_OF_SIZE

Rule = tuple[FloatArray, FloatArray]  # points (q, 3) and weights (q,) on the reference cell

# Degree of the polynomials that a rule integrates exactly on tetrahedra, and on the triangle of wedges. Stiffness: the
# strain of a straight cell squared; mass: the product of two functions, with room for the Jacobian of a curved cell.
_STIFFNESS_DEGREE = {4: 1, 10: 2, 6: 2, 15: 2}
_MASS_DEGREE = {4: 2, 10: 6, 6: 2, 15: 5}
_STIFFNESS_ORDER = {8: 2, 20: 3, 6: 2, 15: 3}  # Gauss points a direction of bricks, and along wedges
_MASS_ORDER = 3


def stiffness_rule(n_nodes: int) -> Rule:
    """Rule for the stiffness of a cell with ``n_nodes`` nodes: 1 (tetra), 4 (tetra10), 6 and 9 (wedges), 8 and 27."""
    return _rule(n_nodes, _STIFFNESS_DEGREE.get(n_nodes, 0), _STIFFNESS_ORDER.get(n_nodes, 0))


def mass_rule(n_nodes: int) -> Rule:
    """Rule for the consistent mass of a cell with ``n_nodes`` nodes, exact for straight cells."""
    return _rule(n_nodes, _MASS_DEGREE.get(n_nodes, 0), _MASS_ORDER)


def _rule(n_nodes: int, degree: int, order: int) -> Rule:
    """Tabulated rule (tetrahedra), rule of the triangle times Gauss rule (wedges), or Gauss product rule (bricks)."""
    if n_nodes in (8, 20):
        return gauss_points(order)
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTet, RefTri

    if n_nodes in (4, 10):
        points, weights = get_quadrature(RefTet, degree)
        return points.T, weights
    triangle, area = get_quadrature(RefTri, degree)
    abscissa, weight = np.polynomial.legendre.leggauss(order)
    points = np.column_stack([np.repeat(triangle.T, order, axis=0), np.tile(abscissa, len(area))])
    return points, np.outer(area, weight).ravel()


def gauss_points(order: int) -> Rule:
    """Points (order^3, 3) and weights (order^3,) of the Gauss product rule with ``order`` points a direction."""
    abscissa, weight = np.polynomial.legendre.leggauss(order)
    points = np.stack(np.meshgrid(abscissa, abscissa, abscissa, indexing="ij"), axis=-1).reshape(-1, 3)
    weights = np.einsum("i,j,k->ijk", weight, weight, weight).ravel()
    return points, weights


def shape_functions(n_nodes: int, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values (q, k) and gradients (q, k, 3) of the cell with ``n_nodes`` nodes at points (q, 3), in VTK node order.

    The functions are those of scikit-fem, whose reference cube is [0, 1]^3 and whose nodes come in another order: nodes
    are matched by their reference coordinates. The 15-node wedge, which it lacks, is :func:`_wedge15`.
    """
    if n_nodes == 15:
        return _wedge15(points)
    from skfem import ElementHex1, ElementHexS2, ElementTetP1, ElementTetP2, ElementWedge1

    element = {4: ElementTetP1, 10: ElementTetP2, 6: ElementWedge1, 8: ElementHex1, 20: ElementHexS2}[n_nodes]()
    # Where the reference coordinate here runs from -1 to 1, that of scikit-fem runs from 0 to 1.
    centred = {4: [0.0, 0.0, 0.0], 10: [0.0, 0.0, 0.0], 6: [0.0, 0.0, 1.0]}.get(n_nodes, [1.0, 1.0, 1.0])
    start = np.array(centred)
    scale = 1.0 - 0.5 * start
    distance = np.abs(scale * (start + KIND_OF_SIZE[n_nodes].nodes[:, None, :]) - element.doflocs[None, :, :])
    unit_points = (scale * (start + points)).T
    basis = [element.lbasis(unit_points, int(position)) for position in distance.max(axis=2).argmin(axis=1)]
    values = np.stack([np.broadcast_to(value, len(points)) for value, _ in basis], axis=1)
    gradients = scale * np.stack([gradient.T for _, gradient in basis], axis=1)
    return values, gradients


def _wedge15(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Serendipity functions of the 15-node wedge, in area coordinates L of the triangle and z from -1 to 1.

    Corners ``L (1 + s z) (2 L - 2 + s z) / 2`` with s = -1 below and 1 above, middles of the triangles' edges
    ``2 L_i L_j (1 + s z)``, middles of the edges along z ``L (1 - z^2)``.
    """
    area = np.column_stack([1.0 - points[:, 0] - points[:, 1], points[:, 0], points[:, 1]])
    z = points[:, 2]
    slope = np.array([[-1.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    along = np.array([0.0, 0.0, 1.0])
    values, gradients = np.zeros((len(points), 15)), np.zeros((len(points), 15, 3))
    for first in range(3):
        second = (first + 1) % 3
        mine, other = area[:, first], area[:, second]
        for sign, corner, edge in ((-1.0, first, 6 + first), (1.0, 3 + first, 9 + first)):
            end = 1.0 + sign * z
            bracket = 2.0 * mine - 2.0 + sign * z
            values[:, corner] = 0.5 * mine * end * bracket
            gradients[:, corner] = np.outer(0.5 * end * (bracket + 2.0 * mine), slope[first])
            gradients[:, corner] += np.outer(0.5 * mine * sign * (bracket + end), along)
            values[:, edge] = 2.0 * mine * other * end
            gradients[:, edge] = np.outer(2.0 * other * end, slope[first]) + np.outer(2.0 * mine * end, slope[second])
            gradients[:, edge] += np.outer(2.0 * sign * mine * other, along)
        values[:, 12 + first] = mine * (1.0 - z**2)
        gradients[:, 12 + first] = np.outer(1.0 - z**2, slope[first]) + np.outer(-2.0 * mine * z, along)
    return values, gradients


# A side is a face of a reference cell: z = -1 of the brick, z = 0 of the tetrahedron. Side -> cell, its nodes in it.
_SIDE_OF = {3: (4, [0, 1, 2]), 6: (10, [0, 1, 2, 4, 5, 6]), 4: (8, [0, 1, 2, 3]), 8: (20, [0, 1, 2, 3, 8, 9, 10, 11])}


def side_rule(n_nodes: int) -> Rule:
    """Points (q, 2) and weights (q,) on the triangle ``x, y >= 0, x + y <= 1`` (3, 6 nodes) or square (4, 8 nodes)."""
    return triangle_rule(5) if n_nodes in (3, 6) else square_rule(3)


def triangle_rule(degree: int) -> Rule:
    """Points (q, 2) and weights (q,) that sum to 1/2 on the reference triangle: 3 points for degree 2, 6 for 4."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    points, weights = get_quadrature(RefTri, degree)
    return points.T, weights


def square_rule(order: int) -> Rule:
    """Gauss product rule on [-1, 1]^2: points (order^2, 2) and weights (order^2,) that sum to 4."""
    abscissa, weight = np.polynomial.legendre.leggauss(order)
    points = np.column_stack([np.repeat(abscissa, order), np.tile(abscissa, order)])
    return points, np.outer(weight, weight).ravel()


def side_shape_functions(n_nodes: int, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values (q, k) and gradients (q, k, 2) of a cell side with k = ``n_nodes`` nodes at points (q, 2) of it.

    Corners come first, counter-clockwise, then the middles of the edges between them.
    """
    cell, nodes = _SIDE_OF[n_nodes]
    height = -1.0 if n_nodes in (4, 8) else 0.0
    values, gradients = shape_functions(cell, np.column_stack([points, np.full(len(points), height)]))
    return values[:, nodes], gradients[:, nodes, :2]


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
            f"cell {bad[0]} is folded: its Jacobian is {determinant[bad[0]]:.3g} m3 at an integration point, but it "
            "must be above 0. Check its nodes, including midside nodes."
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


def compatible_stiffness(cells: FloatArray, elastic: FloatArray) -> FloatArray:
    """(m, 3k, 3k) stiffness ``integral of B^T D B`` of cells of one kind, N/m.

    ``cells`` (m, k, 3) node coordinates in m, whose number k gives the kind; ``elastic`` (6, 6) Pa.
    """
    n_nodes = cells.shape[1]
    points, weights = stiffness_rule(n_nodes)
    _, gradients = shape_functions(n_nodes, points)
    stiffness = np.zeros((len(cells), 3 * n_nodes, 3 * n_nodes))
    for gradient, weight in zip(gradients, weights, strict=True):
        jacobian, determinant = jacobians(cells, gradient)
        strain = strain_matrix(gradient @ np.linalg.inv(jacobian).swapaxes(1, 2))
        stiffness += strain.swapaxes(1, 2) @ ((weight * determinant)[:, None, None] * (elastic @ strain))
    return stiffness


def consistent_mass(cells: FloatArray, density: float) -> FloatArray:
    """(m, k, k) mass ``integral of density N_i N_j`` of cells (m, k, 3), kg, the same for each direction."""
    n_nodes = cells.shape[1]
    points, weights = mass_rule(n_nodes)
    values, gradients = shape_functions(n_nodes, points)
    mass = np.zeros((len(cells), n_nodes, n_nodes))
    for value, gradient, weight in zip(values, gradients, weights, strict=True):
        _, determinant = jacobians(cells, gradient)
        mass += (density * weight * determinant)[:, None, None] * np.outer(value, value)
    return mass


def in_each_direction(scalar: FloatArray) -> FloatArray:
    """(m, 3k, 3k) matrices of displacements whose three directions have the same matrix (m, k, k) and do not couple."""
    n_cells, size, _ = scalar.shape
    return np.asarray(np.einsum("mij,ab->miajb", scalar, np.eye(3)).reshape(n_cells, 3 * size, 3 * size))


def stress_stiffness(cells: FloatArray, stress: FloatArray) -> FloatArray:
    """(m, 3k, 3k) N/m: ``integral of grad N stress grad N^T dV`` of cells (m, k, 3), the same for each direction.

    ``stress`` (m, q, 3, 3) Pa is that at the points of :func:`stiffness_rule`. Source: K.-J. Bathe, Finite Element
    Procedures, 2nd ed. (2014), sec. 6.3.4, K_NL of the total Lagrangian formulation.
    """
    n_nodes = cells.shape[1]
    points, weights = stiffness_rule(n_nodes)
    scalar = np.zeros((len(cells), n_nodes, n_nodes))
    for at, gradient in enumerate(shape_functions(n_nodes, points)[1]):
        jacobian, determinant = jacobians(cells, gradient)
        slope = gradient @ np.linalg.inv(jacobian).swapaxes(1, 2)
        scalar += slope @ ((weights[at] * determinant)[:, None, None] * stress[:, at]) @ slope.swapaxes(1, 2)
    return in_each_direction(scalar)
