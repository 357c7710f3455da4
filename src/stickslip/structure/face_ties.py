"""Ties of nodes to faces with other nodes: each node follows the displacement of the nearest point of the face.

The nearest point x of a side is where the distance is normal to the side, ``(x_s - x) . dx/dxi = 0``. Its shape
functions ``N_k`` give ``u_s = sum N_k u_k``. A node at a distance ``g n`` from the side also follows its rotation,

    u_s = sum N_k u_k - g sum (grad N_k) (n . u_k),

so that rigid motions of the face move the node exactly and no part of the mesh has to be moved. A node beyond the edge
of the face by less than the tolerance has the shape functions of the nearest side beyond its border. Displacements of
the nodes then agree with the face; between nodes faces with different meshes can open or overlap. A field of constant
strain satisfies the ties exactly, but the forces that they transmit are only those of equilibrium for linear sides
whose dependent side is the finer one; docs/ties.md gives the size of the error.

Source: CalculiX and Abaqus tie nodes to faces in this way (G. Dhondt, The Finite Element Method for Three-Dimensional
Thermomechanical Applications, 2004).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from stickslip.core.validation import FloatArray
from stickslip.structure.cell_kinds import CORNERS_OF_SIDE
from stickslip.structure.equations import Equations
from stickslip.structure.mesh import IntArray
from stickslip.structure.shapes import side_shape_functions

RELATIVE_TOLERANCE = 0.05  # of the mean edge of the face, the default of Abaqus
_STEPS = 25  # Gauss-Newton on a curved side converges linearly, with the ratio of gap and radius
_CONVERGED = 1e-12  # step in reference coordinates
_FARTHEST = 1.5  # reference coordinates: beyond, a distorted side folds back
_NO_GAP = 1e-9  # fraction of the size of a side below which a node is on it
_POINTS_AT_ONCE = 20_000  # chosen to bound the memory


@dataclass(frozen=True)
class TiedNodes:
    """Nodes (k,) tied to sides: ``u = sum blocks[i, j] @ u[leaders[i, j]]``.

    Parameters
    ----------
    nodes:
        (k,) dependent nodes.
    leaders, blocks:
        (k, 8) nodes of the side of each, filled up with its first node, and (k, 8, 3, 3) weights, there zero.
    distance:
        (k,) m from the nearest point of the face.
    untied:
        (j,) nodes beyond the tolerance.
    tolerance:
        m.
    """

    nodes: IntArray
    leaders: IntArray
    blocks: FloatArray
    distance: FloatArray
    untied: IntArray
    tolerance: float

    def words(self, dependent: str, independent: str, before: int) -> str:
        """Number of tied nodes and of others, for a message; ``before`` of them are dependent already."""
        limit = f"{1e3 * self.tolerance:.4g} mm"
        words = (
            f"{self.nodes.size - before} nodes of '{dependent}' follow '{independent}'; the largest distance is "
            f"{1e3 * self.distance.max(initial=0.0):.3g} mm"
        )
        words += f"; {self.untied.size} nodes beyond {limit} remain free" if self.untied.size else ""
        return words + (f"; {before} nodes follow something else already" if before else "")


def tie_nodes(
    points: FloatArray, nodes: IntArray, sides: Sequence[IntArray], tolerance: float | None = None
) -> TiedNodes:
    """Tie nodes (k,) of a mesh with ``points`` (n, 3) to a face of ``sides``, arrays (m, 3 | 4 | 6 | 8).

    ``tolerance`` is the largest distance in m; by default ``RELATIVE_TOLERANCE`` times the mean edge of the face.
    Nodes of the face itself are neither tied nor untied.
    """
    edge = mean_edge(points, sides)
    limit = RELATIVE_TOLERANCE * edge if tolerance is None else tolerance
    wanted = np.setdiff1d(nodes, np.concatenate([each.ravel() for each in sides]))
    best = np.full(len(wanted), np.inf)
    leaders = np.zeros((len(wanted), 8), dtype=np.int64)
    blocks = np.zeros((len(wanted), 8, 3, 3))
    for group in sides:
        width = group.shape[1]
        corners = points[group]
        centre = corners.mean(axis=1)
        radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
        tree = cKDTree(centre)
        for start in range(0, len(wanted), _POINTS_AT_ONCE):
            some = np.arange(start, min(start + _POINTS_AT_ONCE, len(wanted)))
            near = tree.query_ball_point(points[wanted[some]], float(radius.max()) + limit)
            node = np.repeat(some, [len(each) for each in near])
            side = np.fromiter((each for part in near for each in part), dtype=np.int64, count=len(node))
            close = np.linalg.norm(points[wanted[node]] - centre[side], axis=1) <= radius[side] + limit
            node, side = node[close], side[close]
            if not node.size:
                continue
            where = _nearest(corners[side], points[wanted[node]])
            distance = _distance(corners[side], points[wanted[node]], where)
            order = np.lexsort((side, distance, node))
            chosen = order[np.unique(node[order], return_index=True)[1]]
            chosen = chosen[(distance[chosen] <= limit) & (distance[chosen] < best[node[chosen]])]
            at = node[chosen]
            best[at] = distance[chosen]
            leaders[at] = group[side[chosen], :1]
            leaders[at, :width] = group[side[chosen]]
            blocks[at] = 0.0
            blocks[at, :width] = _blocks(corners[side[chosen]], points[wanted[at]], where[chosen], radius[side[chosen]])
    tied = np.isfinite(best)
    best[best <= _NO_GAP * edge] = 0.0  # round-off
    return TiedNodes(wanted[tied], leaders[tied], blocks[tied], best[tied], wanted[~tied], limit)


def add_tie(equations: Equations, owner: int, tied: TiedNodes) -> int:
    """Write the equations of tied nodes; returns the number of nodes that were dependent before, which do not follow
    again."""
    before = 0
    for node, leaders, blocks in zip(tied.nodes.tolist(), tied.leaders, tied.blocks, strict=True):
        if any(equations.depends(3 * node + axis) for axis in range(3)):
            before += 1
            continue
        columns = 3 * leaders[:, None] + np.arange(3)
        for axis in range(3):
            used = blocks[:, axis] != 0.0
            terms = [(3 * node + axis, -1.0), *zip(columns[used].tolist(), blocks[:, axis][used].tolist(), strict=True)]
            equations.add(terms, 3 * node + axis, owner)
    return before


def mean_edge(points: FloatArray, sides: Sequence[IntArray]) -> float:
    """m, mean distance of neighbouring corners of sides."""
    lengths = []
    for group in sides:
        corners = points[group[:, : CORNERS_OF_SIDE[group.shape[1]]]]
        lengths.append(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).ravel())
    return float(np.concatenate(lengths).mean())


def _nearest(corners: FloatArray, points: FloatArray) -> FloatArray:
    """(c, 2) reference coordinates of the nearest points of sides (c, k, 3), which may be beyond their borders."""
    width = corners.shape[1]
    where = np.full((len(corners), 2), 1.0 / 3.0 if width in (3, 6) else 0.0)
    active = np.arange(len(corners))
    for _ in range(_STEPS):
        values, gradients = side_shape_functions(width, where[active])
        off = points[active] - np.einsum("ck,ckx->cx", values, corners[active])
        tangents = np.einsum("cka,ckx->cax", gradients, corners[active])
        metric = np.einsum("cax,cbx->cab", tangents, tangents)
        step = np.linalg.solve(metric, np.einsum("cax,cx->ca", tangents, off)[..., None])[..., 0]
        where[active] = np.clip(where[active] + step, -_FARTHEST, _FARTHEST)
        active = active[np.abs(step).max(axis=1) > _CONVERGED]
        if not active.size:
            break
    return where


def _distance(corners: FloatArray, points: FloatArray, where: FloatArray) -> FloatArray:
    """(c,) m from points to sides without what is beyond their borders."""
    width = corners.shape[1]
    if width in (3, 6):
        inside = np.maximum(where, 0.0)
        inside = inside / np.maximum(inside.sum(axis=1), 1.0)[:, None]
    else:
        inside = np.clip(where, -1.0, 1.0)
    values, _ = side_shape_functions(width, inside)
    return np.asarray(np.linalg.norm(points - np.einsum("ck,ckx->cx", values, corners), axis=1))


def _blocks(corners: FloatArray, points: FloatArray, where: FloatArray, radius: FloatArray) -> FloatArray:
    """(c, k, 3, 3) weights of the nodes of each side."""
    values, gradients = side_shape_functions(corners.shape[1], where)
    tangents = np.einsum("cka,ckx->cax", gradients, corners)
    metric = np.einsum("cax,cbx->cab", tangents, tangents)
    along = np.einsum("cka,cab,cbx->ckx", gradients, np.linalg.inv(metric), tangents)
    normal = np.cross(tangents[:, 0], tangents[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    gap = np.einsum("cx,cx->c", points - np.einsum("ck,ckx->cx", values, corners), normal)
    gap[np.abs(gap) <= _NO_GAP * radius] = 0.0
    values[np.abs(values) < 1e-14] = 0.0  # a node at a node follows it alone
    return np.asarray(
        values[:, :, None, None] * np.eye(3) - gap[:, None, None, None] * along[:, :, :, None] * normal[:, None, None]
    )
