"""Loads on every cell of a mesh: the centrifugal load of a rotation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.shapes import consistent_mass

_CELLS_AT_ONCE = 2000  # chosen to bound the memory


def centrifugal_load(
    mesh: Mesh,
    materials: Sequence[Material],
    axis: FloatArray,
    point: FloatArray,
    masses: FloatArray | None = None,
) -> FloatArray:
    """(3 * n_nodes,) N of every node at a rotation of 1 rad/s: ``integral of density N^T r dV``.

    r is the vector from the axis through ``point`` (3,) m along the unit vector ``axis`` (3,), interpolated by the
    shape functions, so that ``f = M r`` with the consistent mass of all nodes, including constrained ones. Multiply by
    the square of the speed. ``materials`` are one for each body, in their order; ``masses`` (n_nodes,) kg are mass
    points.
    """
    arm = mesh.points - point
    return _inertia(mesh, materials, arm - np.outer(arm @ axis, axis), masses).ravel()


def translation_inertia(mesh: Mesh, materials: Sequence[Material], masses: FloatArray | None = None) -> FloatArray:
    """(3 * n_nodes, 3) kg: ``M r`` for translations r of all nodes, including constrained ones, by 1 along x, y, z.

    ``M`` is the consistent mass with the mass points ``masses`` (n_nodes,) kg. Times an acceleration of the support it
    is the force that the support exerts through the inertia of the structure.
    """
    carried = _inertia(mesh, materials, np.ones((mesh.n_nodes, 1)), masses)
    return np.asarray(np.kron(carried, np.eye(3)))


def _inertia(mesh: Mesh, materials: Sequence[Material], field: FloatArray, masses: FloatArray | None) -> FloatArray:
    """``M field`` of a field (n_nodes, k) with the consistent mass of all nodes and their mass points."""
    load = np.zeros_like(field) if masses is None else masses[:, None] * field
    for cells, mass in cell_masses(mesh, materials):
        np.add.at(load, cells, np.einsum("mij,mjx->mix", mass, field[cells]))
    return load


def cell_masses(mesh: Mesh, materials: Sequence[Material]) -> Iterator[tuple[IntArray, FloatArray]]:
    """Cells (m, k) of one kind, not too many at a time, and their consistent masses (m, k, k) kg."""
    for block in mesh.blocks:
        density = np.array([material.density for material in materials])[block.body]
        for start in range(0, len(block.cells), _CELLS_AT_ONCE):
            part = slice(start, start + _CELLS_AT_ONCE)
            cells = block.cells[part]
            yield cells, consistent_mass(mesh.points[cells], 1.0) * density[part, None, None]
