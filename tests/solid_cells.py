"""Shared by the tests on solid cells: corners of a brick, bricks cut into other cells, the patch test."""

import numpy as np
import pytest
import scipy.sparse.linalg

from stickslip.core.validation import FloatArray
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.elasticity import Material, Structure

CORNERS = CELL_KINDS["hexahedron"].nodes
# A brick in six tetrahedra around its diagonal 0-6, in two wedges, or as it is. Neighbouring bricks are cut along the
# same lines where they have the same order of nodes.
PARTS = {
    "tetra": [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]],
    "wedge": [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]],
    "hexahedron": [list(range(8))],
}


def require_constant_strain(structure: Structure, points: FloatArray, outer: np.ndarray, material: Material) -> None:
    """Inner nodes follow a linear displacement of the outer ones, and the energy is that of its strain."""
    gradient = np.array([[1.0, 0.4, -0.2], [0.3, -0.5, 0.7], [0.1, 0.6, 0.8]])
    exact = (points @ gradient.T).ravel()
    inner = np.ones(len(points), dtype=bool)
    inner[outer] = False
    free = np.repeat(inner, 3)
    assert free.sum() >= 24
    held = structure.stiffness[free][:, ~free] @ exact[~free]
    solved = scipy.sparse.linalg.spsolve(structure.stiffness[free][:, free].tocsc(), -held)
    np.testing.assert_allclose(solved, exact[free], atol=1e-10)
    strain = 0.5 * (gradient + gradient.T)
    voigt = np.array([*np.diag(strain), *(2.0 * strain[[0, 1, 2], [1, 2, 0]])])
    volume = structure.mass[::3, ::3].sum() / material.density
    energy = 0.5 * exact @ structure.stiffness @ exact
    assert energy == pytest.approx(0.5 * volume * voigt @ material.elastic_matrix() @ voigt, rel=1e-10)
