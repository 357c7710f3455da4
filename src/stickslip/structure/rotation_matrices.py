"""Matrices of a mesh in a frame that rotates at a constant speed, each for a speed of 1 rad/s.

With the speed W and the unit vector a of the axis, the displacements u in the rotating frame satisfy

    M u'' + W G u' + (K + W^2 (K_g - M_a)) u = W^2 f

(G. Genta, Dynamics of Rotating Systems, 2005, ch. 2; M. Geradin, D. Rixen, Mechanical Vibrations, 3rd ed., 2015, sec.
2.11). G are the Coriolis forces (:func:`coriolis_matrix`), M_a the spin softening (:func:`softening_matrix`), K_g the
stiffness of the stress that the centrifugal load f causes (:func:`stress_stiffness_matrix`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.core.validation import FloatArray
from stickslip.structure.body_load import cell_masses
from stickslip.structure.elasticity import Material, Structure, scattered
from stickslip.structure.incompatible_brick import incompatible_stress_stiffness
from stickslip.structure.mesh import Mesh
from stickslip.structure.shapes import stiffness_rule, stress_stiffness
from stickslip.structure.stress import cell_groups, cell_stress

_TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])  # positions of xx, yy, zz, xy, yz, zx


def nodal_mass(mesh: Mesh, materials: Sequence[Material]) -> Any:
    """csr (n_nodes, n_nodes) kg: the consistent mass of one direction, ``integral of density N_i N_j dV``."""
    mass = scipy.sparse.csr_matrix((mesh.n_nodes, mesh.n_nodes))
    for cells, part in cell_masses(mesh, materials):
        mass = mass + scattered(part, cells, mesh.n_nodes)
    return mass


def coriolis_matrix(mass: Any, axis: FloatArray) -> Any:
    """csr (3 * n_nodes, 3 * n_nodes) kg: ``G = 2 integral of density N^T [a x] N dV``, skew-symmetric.

    ``mass`` is that of :func:`nodal_mass`, ``axis`` a unit vector. Times the speed in rad/s and a velocity it is the
    Coriolis force ``2 density a x u'`` on the left-hand side of the equation of motion; it does no work.
    """
    return scipy.sparse.kron(mass, 2.0 * np.cross(axis, np.eye(3)).T, format="csr")


def softening_matrix(mass: Any, axis: FloatArray) -> Any:
    """csr (3 * n_nodes, 3 * n_nodes) kg: ``M_a = integral of density N^T (1 - a a^T) N dV``, symmetric.

    The centrifugal force grows with the displacement from the axis, so that the stiffness loses this matrix times the
    square of the speed in rad/s. Arguments as in :func:`coriolis_matrix`.
    """
    return scipy.sparse.kron(mass, np.eye(3) - np.outer(axis, axis), format="csr")


def stress_stiffness_matrix(structure: Structure, displacement: FloatArray) -> Any:
    """csr (3 * n_nodes, 3 * n_nodes) N/m: ``K_g = integral of grad N^T stress grad N dV``, symmetric.

    The stress is the linear one of the static displacements (3 * n_nodes,) m, so K_g is proportional to them: tension
    stiffens a structure against motion across it. Source: K.-J. Bathe, Finite Element Procedures, 2nd ed. (2014), sec.
    6.3.4.
    """
    total = scipy.sparse.csr_matrix((structure.full_size, structure.full_size))
    of_node = displacement.reshape(-1, 3)
    for cells, body in cell_groups(structure):
        moved = of_node[cells].reshape(len(cells), -1, 1)
        points = stiffness_rule(cells.shape[1])[0]
        stress = cell_stress(structure, cells, body, moved, points)[:, :, _TENSOR, 0]
        corners = structure.mesh.points[cells]
        if cells.shape[1] == 8 and "incompatible" in structure.element:
            elastic = structure.materials[body].elastic_matrix()
            local = incompatible_stress_stiffness(corners, elastic, stress)
        else:
            local = stress_stiffness(corners, stress)
        rows = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), -1)
        total = total + scattered(local, rows, structure.full_size)
    return total
