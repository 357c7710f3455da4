"""8-node brick with incompatible modes, which bends without the shear locking of the trilinear brick."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.shapes import gauss_points, in_each_direction, jacobians, shape_functions, strain_matrix


def incompatible_stiffness(cells: FloatArray, elastic: FloatArray) -> FloatArray:
    """(m, 24, 24) stiffness of bricks with corners ``cells`` (m, 8, 3) in m and elastic matrix (6, 6) in Pa; N/m.

    The displacement is the trilinear one plus the internal bubbles ``1 - xi^2``, ``1 - eta^2``, ``1 - zeta^2`` for each
    direction. Their nine amplitudes a carry no load and are eliminated in each cell: ``K = K_uu - K_ua K_aa^-1 K_au``.
    Bubble gradients use the Jacobian of the cell's centre, scaled by the ratio of determinants, so that their strain
    integrates to zero and a distorted cell still reproduces constant strain.

    Source: R. L. Taylor, P. J. Beresford, E. L. Wilson, A non-conforming element for stress analysis,
    Int. J. Numer. Methods Eng. 10 (1976) 1211-1219.
    """
    full = _full_stiffness(cells, elastic)
    condensed = full[:, :24, :24] + full[:, 24:, :24].swapaxes(1, 2) @ _amplitudes(full)
    return np.asarray(0.5 * (condensed + condensed.swapaxes(1, 2)))


def incompatible_strain(cells: FloatArray, elastic: FloatArray, points: FloatArray) -> Iterator[FloatArray]:
    """For each of the reference points (q, 3): the matrix (m, 6, 24) from nodal displacements to the strain there.

    The strain contains that of the bubbles, with their amplitudes ``a = -K_aa^-1 K_au u``; its components are those of
    :func:`strain_matrix`.
    """
    amplitudes = _amplitudes(_full_stiffness(cells, elastic))
    for strain, _ in _strains(cells, points):
        yield strain[:, :, :24] + strain[:, :, 24:] @ amplitudes


def incompatible_stress_stiffness(cells: FloatArray, elastic: FloatArray, stress: FloatArray) -> FloatArray:
    """(m, 24, 24) N/m of bricks under the stress (m, 8, 3, 3) Pa at the points of the stiffness.

    ``T^T (integral of grad N stress grad N^T dV) T`` with the functions N of nodes and bubbles, and T their amplitudes
    for unit displacements of the nodes: to first order in the stress, so that it is proportional to it.
    """
    points, weights = gauss_points(2)
    full = np.zeros((len(cells), 11, 11))
    for at, (gradients, determinant) in enumerate(_gradients(cells, points)):
        weighted = (weights[at] * determinant)[:, None, None] * stress[:, at]
        full += gradients @ weighted @ gradients.swapaxes(1, 2)
    amplitudes = _amplitudes(_full_stiffness(cells, elastic))
    follows = np.concatenate([np.tile(np.eye(24), (len(cells), 1, 1)), amplitudes], axis=1)
    return np.asarray(follows.swapaxes(1, 2) @ in_each_direction(full) @ follows)


def _full_stiffness(cells: FloatArray, elastic: FloatArray) -> FloatArray:
    """(m, 33, 33) N/m of the 24 displacements and the 9 amplitudes of the bubbles."""
    points, weights = gauss_points(2)
    full = np.zeros((len(cells), 33, 33))
    for (strain, determinant), weight in zip(_strains(cells, points), weights, strict=True):
        full += strain.swapaxes(1, 2) @ ((weight * determinant)[:, None, None] * (elastic @ strain))
    return full


def _amplitudes(full: FloatArray) -> FloatArray:
    """(m, 9, 24) amplitudes of the bubbles, which carry no load, for unit displacements of the nodes."""
    return np.asarray(-np.linalg.solve(full[:, 24:, 24:], full[:, 24:, :24]))


def _strains(cells: FloatArray, points: FloatArray) -> Iterator[tuple[FloatArray, FloatArray]]:
    """At each of the points (q, 3): strain matrix (m, 6, 33) of displacements and bubbles, and determinant (m,)."""
    for gradients, determinant in _gradients(cells, points):
        yield strain_matrix(gradients), determinant


def _gradients(cells: FloatArray, points: FloatArray) -> Iterator[tuple[FloatArray, FloatArray]]:
    """At each of the points (q, 3): gradients (m, 11, 3) of the functions of nodes and bubbles, determinant (m,)."""
    _, gradients = shape_functions(8, points)
    _, centre_gradient = shape_functions(8, np.zeros((1, 3)))
    centre_jacobian, centre_determinant = jacobians(cells, centre_gradient[0])
    centre_inverse = np.linalg.inv(centre_jacobian).swapaxes(1, 2)
    for point, gradient in zip(points, gradients, strict=True):
        jacobian, determinant = jacobians(cells, gradient)
        compatible = gradient @ np.linalg.inv(jacobian).swapaxes(1, 2)
        ratio = (centre_determinant / determinant)[:, None, None]
        bubbles = ratio * (np.diag(-2.0 * point) @ centre_inverse)
        yield np.concatenate([compatible, bubbles], axis=1), determinant
