"""Stress of a mesh from its displacements: at points of the cells, and at nodes as means over cells of one body."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, finite_array
from stickslip.structure.cell_kinds import KIND_OF_SIZE
from stickslip.structure.elasticity import Structure
from stickslip.structure.incompatible_brick import incompatible_strain
from stickslip.structure.mesh import IntArray
from stickslip.structure.shapes import gauss_points, jacobians, shape_functions, stiffness_rule, strain_matrix

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
_CELLS_AT_ONCE = 1000  # chosen to bound the memory: 27 points of 20-node bricks


@dataclass(frozen=True, eq=False)
class NodalStress:
    """Stress at the nodes of a mesh, one row for each node of each body.

    node, body:
        (p,) node and body of each row; a node that two bodies share has two rows, because stress jumps there.
    stress:
        (p, 6, k) Pa, components xx, yy, zz, xy, yz, zx, for k columns of displacements.
    """

    node: IntArray
    body: IntArray
    stress: FloatArray

    __repr__ = short_repr

    def at_nodes(self, values: FloatArray, n_nodes: int) -> FloatArray:
        """(n_nodes,) the largest of ``values`` (p,) at each node, over its bodies."""
        largest = np.full(n_nodes, -np.inf)
        np.maximum.at(largest, self.node, values)
        return largest


def nodal_stress(structure: Structure, displacement: FloatArray) -> NodalStress:
    """Stress ``D B u`` at the nodes, from displacements (3 * n_nodes, k) m (node, then x, y, z).

    In each cell the stress at its integration points (:func:`stress_points`) is fitted by the functions of
    :func:`nodal_fit` and evaluated at the nodes; a node has the unweighted mean over the cells of one body.
    Incompatible bricks include the strain of their bubbles.

    Raises InputError for displacements of another shape, and for a structure without materials.
    """
    mesh = structure.mesh
    array = finite_array("displacement", displacement)
    if array.ndim != 2 or array.shape[0] != structure.full_size:
        raise InputError(
            f"displacement must have shape ({structure.full_size}, k), three displacements for each of {mesh.n_nodes} "
            f"nodes, but its shape is {array.shape}.",
            arguments=["displacement"],
        )
    if len(structure.materials) <= int(mesh.body.max()):
        raise InputError(
            "the structure has no materials, so its stress is unknown. Make it with assemble or assemble_bodies."
        )
    of_node = array.reshape(mesh.n_nodes, 3, -1)
    keys = [np.unique(block.body[:, None] * mesh.n_nodes + block.cells) for block in mesh.blocks]
    rows = np.unique(np.concatenate(keys))
    total, count = np.zeros((len(rows), 6, array.shape[1])), np.zeros(len(rows))
    for cells, body in cell_groups(structure):
        n_nodes = cells.shape[1]
        points = stress_points(n_nodes)
        fit = nodal_fit(n_nodes)
        moved = of_node[cells].reshape(len(cells), 3 * n_nodes, -1)
        inner = cell_stress(structure, cells, body, moved, points)
        at = np.searchsorted(rows, body * mesh.n_nodes + cells)
        np.add.at(total, at, np.einsum("nq,mqic->mnic", fit, inner, optimize=True))
        np.add.at(count, at, 1.0)
    body_of_row, node = np.divmod(rows, mesh.n_nodes)
    return NodalStress(node, body_of_row, total / count[:, None, None])


def cell_stress(
    structure: Structure, cells: IntArray, body: int, displacement: FloatArray, points: FloatArray
) -> FloatArray:
    """(m, q, 6, c) Pa in cells (m, k) of one body at reference points (q, 3).

    ``displacement`` (m, 3k, c) m are those of the nodes of each cell (node, then x, y, z).
    """
    elastic = structure.materials[body].elastic_matrix()
    corners = structure.mesh.points[cells]
    strains = _strain(corners, elastic, points, incompatible="incompatible" in structure.element)
    return np.stack([elastic @ (strain @ displacement) for strain in strains], axis=1)


def stress_points(n_nodes: int) -> FloatArray:
    """(q, 3) reference points at which the stress of a cell with ``n_nodes`` nodes is evaluated.

    Those of its stiffness: 1 (tetra), 4 (tetra10), 9 (wedge15), 8 and 27 (bricks); of the wedge with 6 nodes the two
    points on its axis, where its strain, constant over the triangle but for the part along the axis, is most accurate.
    """
    if n_nodes != 6:
        return stiffness_rule(n_nodes)[0]
    along = np.unique(gauss_points(2)[0][:, 2])
    return np.column_stack([np.full((2, 2), 1.0 / 3.0), along])


def nodal_fit(n_nodes: int) -> FloatArray:
    """(k, q) values at the nodes of a cell from values at :func:`stress_points`, by least squares.

    Functions of the fit: 1 (tetra), 1 and z (wedge), linear (tetra10), linear over the triangle times linear along z
    (wedge15), trilinear (8-node brick), and the shape functions of the 20-node brick.
    """
    points, nodes = stress_points(n_nodes), KIND_OF_SIZE[n_nodes].nodes
    return np.asarray(_fitted(n_nodes, nodes) @ np.linalg.pinv(_fitted(n_nodes, points)))


def _fitted(n_nodes: int, points: FloatArray) -> FloatArray:
    """(q, f) values of the functions of the fit."""
    if n_nodes == 4:
        return np.ones((len(points), 1))
    if n_nodes == 6:
        return np.column_stack([np.ones(len(points)), points[:, 2]])
    return shape_functions({10: 4, 15: 6}.get(n_nodes, n_nodes), points)[0]


def _strain(corners: FloatArray, elastic: FloatArray, points: FloatArray, incompatible: bool) -> Iterator[FloatArray]:
    """(m, 6, 3k) strain matrices of cells (m, k, 3) at each point."""
    n_nodes = corners.shape[1]
    if n_nodes == 8 and incompatible:
        yield from incompatible_strain(corners, elastic, points)
        return
    for gradient in shape_functions(n_nodes, points)[1]:
        jacobian, _ = jacobians(corners, gradient)
        yield strain_matrix(gradient @ np.linalg.inv(jacobian).swapaxes(1, 2))


def cell_groups(structure: Structure) -> Iterator[tuple[IntArray, int]]:
    """Cells (m, k) of one kind and one body, not too many at a time."""
    for block in structure.mesh.blocks:
        for body in np.unique(block.body):
            cells = block.cells[block.body == body]
            for start in range(0, len(cells), _CELLS_AT_ONCE):
                yield cells[start : start + _CELLS_AT_ONCE], int(body)
