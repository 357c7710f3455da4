"""The symmetry of a sector whose boundaries do not match: nodes of the right one follow the sides of the left one.

A node of the right boundary is rotated back by one sector. There it follows the nearest point of the left boundary by
the shape functions of its side (:mod:`stickslip.structure.face_ties`), in the axes of the next sector, and one phase
lag later: ``u_right = e^{i phi} R W u_left``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse

from stickslip.core.errors import InputError, concerning
from stickslip.core.validation import FloatArray, positive_number
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.face_ties import TiedNodes, tie_nodes
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.sector_boundaries import Axis, require_distinct, symmetry_of_boundaries


def tied_symmetry(
    mesh: Mesh,
    left: str,
    right: str,
    sectors: int | None = None,
    axis: Axis | None = None,
    tolerance: float | None = None,
) -> CyclicSymmetry:
    """The symmetry of a sector whose boundaries need not match node by node.

    Parameters
    ----------
    mesh:
        of the sector.
    left, right:
        node or face sets of the boundaries. The nodes of the right one follow the left one: the right one should be the
        finer mesh (docs/ties.md).
    sectors, axis:
        as in :func:`cyclic_symmetry`. Boundaries that are not plane may have means at other angles if their meshes
        differ; ``sectors`` is required then.
    tolerance:
        m, largest distance of a node from the other boundary; None for 5 % of the mean edge of the other boundary.

    Raises
    ------
    InputError
        for sets that do not exist or have no sides, boundaries with common nodes or on the axis, an angle that does not
        divide a circle, several axes that fit, and a node farther from the other boundary than the tolerance.
    """
    sides = []
    for argument, name in (("left", left), ("right", right)):
        with concerning(argument):
            sides.append(mesh.sides(name))
    first, second = (np.unique(np.concatenate([each.ravel() for each in every])) for every in sides)
    require_distinct(mesh.points, first, "left")
    if tolerance is not None:
        positive_number("tolerance", tolerance, "m")

    def tied(about: CyclicSymmetry) -> CyclicSymmetry:
        back = about.rotated(mesh.points[second], -1)
        ahead = about.rotated(mesh.points[first])
        follow = _tied(mesh.points, second, back, sides[0], tolerance, ("right", "left"))
        _tied(mesh.points, first, ahead, sides[1], tolerance, ("left", "right"))
        return replace(about, weights=_weights(follow, first, second))

    return symmetry_of_boundaries(mesh.points, first, second, axis, sectors, tied)


def _tied(
    points: FloatArray,
    nodes: IntArray,
    places: FloatArray,
    sides: tuple[IntArray, ...],
    tolerance: float | None,
    names: tuple[str, str],
) -> TiedNodes:
    """Nodes (k,) of one boundary, rotated to ``places`` (k, 3), on the sides of the other one. Raises InputError."""
    moved = points.copy()
    moved[nodes] = places
    follow = tie_nodes(moved, nodes, sides, tolerance)
    if follow.untied.size:
        place = ", ".join(f"{1e3 * each:.6g}" for each in points[follow.untied[0]])
        raise InputError(
            f"node {follow.untied[0]} of the {names[0]} boundary at ({place}) mm is, rotated by one sector, more than "
            f"{1e3 * follow.tolerance:.3g} mm from the {names[1]} boundary ({follow.untied.size} of {nodes.size} nodes "
            "are). The boundaries must be the same surface: check the sets and the axis, or give a larger tolerance.",
            arguments=["left", "right"],
        )
    return follow


def _weights(follow: TiedNodes, left: IntArray, right: IntArray) -> scipy.sparse.csr_matrix:
    """csr (3 m, 3 k) from the blocks of tied nodes, which are the nodes ``right`` in their order."""
    node, leader, row, column = np.nonzero(follow.blocks)
    of_left = np.searchsorted(left, follow.leaders[node, leader])
    return scipy.sparse.csr_matrix(
        (follow.blocks[node, leader, row, column], (3 * node + row, 3 * of_left + column)),
        shape=(3 * right.size, 3 * left.size),
    )
