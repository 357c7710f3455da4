"""8-node brick with incompatible modes, which bends without the shear locking of the trilinear brick."""

from __future__ import annotations

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.shapes import gauss_points, jacobians, shape_functions, strain_matrix


def incompatible_stiffness(cells: FloatArray, elastic: FloatArray) -> FloatArray:
    """(m, 24, 24) stiffness of bricks with corners ``cells`` (m, 8, 3) in m and elastic matrix (6, 6) in Pa; N/m.

    The displacement is the trilinear one plus the internal bubbles ``1 - xi^2``, ``1 - eta^2``, ``1 - zeta^2`` for each
    direction. Their nine amplitudes a carry no load and are eliminated in each cell: ``K = K_uu - K_ua K_aa^-1 K_au``.
    Bubble gradients use the Jacobian of the cell's centre, scaled by the ratio of determinants, so that their strain
    integrates to zero and a distorted cell still reproduces constant strain.

    Source: R. L. Taylor, P. J. Beresford, E. L. Wilson, A non-conforming element for stress analysis,
    Int. J. Numer. Methods Eng. 10 (1976) 1211-1219.
    """
    points, weights = gauss_points(2)
    _, gradients = shape_functions(8, points)
    _, centre_gradient = shape_functions(8, np.zeros((1, 3)))
    centre_jacobian, centre_determinant = jacobians(cells, centre_gradient[0])
    centre_inverse = np.linalg.inv(centre_jacobian).swapaxes(1, 2)

    full = np.zeros((len(cells), 33, 33))
    for point, gradient, weight in zip(points, gradients, weights, strict=True):
        jacobian, determinant = jacobians(cells, gradient)
        compatible = gradient @ np.linalg.inv(jacobian).swapaxes(1, 2)
        ratio = (centre_determinant / determinant)[:, None, None]
        bubbles = ratio * (np.diag(-2.0 * point) @ centre_inverse)
        strain = strain_matrix(np.concatenate([compatible, bubbles], axis=1))
        full += strain.swapaxes(1, 2) @ ((weight * determinant)[:, None, None] * (elastic @ strain))
    coupling = full[:, 24:, :24]
    condensed = full[:, :24, :24] - coupling.swapaxes(1, 2) @ np.linalg.solve(full[:, 24:, 24:], coupling)
    return np.asarray(0.5 * (condensed + condensed.swapaxes(1, 2)))
