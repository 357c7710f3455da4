"""One face of a body for contact: its cell sides, the area of its nodes, and its smoothed normal."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.faces import face_geometry, node_geometry, side_geometry
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.shapes import side_shape_functions
from stickslip.structure.side_parts import SIDE_BORDER

SHARP_EDGE_DEG = (
    60.0  # chosen: a larger angle between two sides is an edge, as of a box; facets of round faces turn less
)
_ROUND_OFF = 1e-12  # of the size of a face
WIDEST_SIDE = 8  # nodes; rows of sides with fewer are filled up


@dataclass(frozen=True)
class SurfaceMesh:
    """The sides of a named face set or node set.

    Sides of different widths are in one table, so that one number identifies a side. The smoothed normal of a node is
    the area-weighted mean of the sides around it; between nodes it is interpolated by the shape functions and
    normalised, so that it turns steadily over flat facets.

    Parameters
    ----------
    name:
        name of the set.
    points:
        (n_nodes, 3) m of the whole mesh.
    nodes:
        (k,) nodes of the face.
    node_area:
        (k,) m2 that each represents; sums to the area of the face.
    normal:
        (n_nodes, 3) smoothed outward unit normal, zero off the face.
    sides:
        (m, 8) nodes of each side, filled up with its first node.
    width:
        (m,) number of nodes of each side: 3, 4, 6 or 8.
    """

    name: str
    points: FloatArray
    nodes: IntArray
    node_area: FloatArray
    normal: FloatArray
    sides: IntArray
    width: IntArray

    @staticmethod
    def of(mesh: Mesh, name: str) -> SurfaceMesh:
        """The face ``name`` of a mesh.

        Raises InputError for a set without complete sides, or with a node that is on none.
        """
        nodes, area, direction = face_geometry(mesh, name)
        isolated = np.flatnonzero(area <= 0.0)
        if isolated.size:
            raise InputError(
                f"node {nodes[isolated[0]]} of node set '{name}' belongs to no cell side in the set; a face set must "
                "contain each node of its sides and no other nodes."
            )
        normal = np.zeros((mesh.n_nodes, 3))
        normal[nodes] = direction
        groups = mesh.sides(name)
        filled = [np.hstack([side, np.repeat(side[:, :1], WIDEST_SIDE - side.shape[1], axis=1)]) for side in groups]
        width = np.concatenate([np.full(len(side), side.shape[1]) for side in groups])
        return SurfaceMesh(name, mesh.points, nodes, area, normal, np.concatenate(filled).astype(np.int64), width)

    def only(self, members: IntArray) -> SurfaceMesh:
        """The face that consists of the sides ``members`` alone: area and normal of its nodes are those of them."""
        sides, width = self.sides[members], self.width[members]
        groups = [sides[at, :each] for each, at in self.by_width(members)]
        area, normal = node_geometry(self.points, groups)
        nodes = self.nodes[np.isin(self.nodes, sides)]
        return SurfaceMesh(self.name, self.points, nodes, area[nodes], normal, sides, width)

    @cached_property
    def area(self) -> float:
        """m2 of the whole face."""
        return float(self.node_area.sum())

    @cached_property
    def size(self) -> float:
        """m, diagonal of the box around the face."""
        corners = self.points[self.nodes]
        return float(np.linalg.norm(corners.max(axis=0) - corners.min(axis=0)))

    @cached_property
    def side_area(self) -> FloatArray:
        """(m,) m2 of each side."""
        return self._side_facts[0]

    @cached_property
    def side_normal(self) -> FloatArray:
        """(m, 3) mean outward unit normal of each side, not smoothed."""
        return self._side_facts[1]

    @cached_property
    def _side_facts(self) -> tuple[FloatArray, FloatArray]:
        area, normal = np.empty(len(self.sides)), np.empty((len(self.sides), 3))
        for width, members in self.by_width(np.arange(len(self.sides))):
            share, normal[members] = side_geometry(self.points[self.sides[members, :width]])
            area[members] = share.sum(axis=1)
        return area, normal

    @cached_property
    def smooth_parts(self) -> IntArray:
        """(m,) number of the part of each side: sharp edges and gaps divide the face into parts."""
        corners = np.where(np.isin(self.width, (3, 6)), 3, 4)
        edges, side = [], []
        for count in (3, 4):
            members = np.flatnonzero(corners == count)
            ring = self.sides[members, :count]
            edges.append(np.sort(np.stack([ring, np.roll(ring, -1, axis=1)], axis=2), axis=2).reshape(-1, 2))
            side.append(np.repeat(members, count))
        edge = np.unique(np.concatenate(edges), axis=0, return_inverse=True)[1].ravel()
        owner = np.concatenate(side)
        order = np.argsort(edge, kind="stable")
        shared = np.flatnonzero(np.diff(edge[order]) == 0)
        one, two = owner[order[shared]], owner[order[shared + 1]]
        smooth = np.einsum("ex,ex->e", self.side_normal[one], self.side_normal[two]) > np.cos(
            np.radians(SHARP_EDGE_DEG)
        )
        count = len(self.sides)
        joined = coo_matrix((np.ones(int(smooth.sum())), (one[smooth], two[smooth])), shape=(count, count))
        return np.asarray(connected_components(joined, directed=False)[1], dtype=np.int64)

    @cached_property
    def centre(self) -> FloatArray:
        """(m, 3) m, middle of the nodes of each side."""
        return self._balls[0]

    @cached_property
    def radius(self) -> FloatArray:
        """(m,) m, of the ball around ``centre`` that contains the nodes of each side."""
        return self._balls[1]

    @cached_property
    def _balls(self) -> tuple[FloatArray, FloatArray]:
        used = np.arange(WIDEST_SIDE) < self.width[:, None]
        corners = self.points[self.sides]
        centre = np.einsum("mk,mkx->mx", used, corners) / self.width[:, None]
        return centre, np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)

    @cached_property
    def facet_height(self) -> float:
        """m, approximate distance of flat sides from a curved face: chord . change of the normal / 8 (arc and chord).

        Sides with midside nodes follow the curve and do not count; 0 where all sides have them.
        """
        height = 0.0
        for width, members in self.by_width(np.arange(len(self.sides))):
            if width > 4:
                continue
            nodes = self.sides[members, :width]
            for step in range(1, width // 2 + 1):
                other = np.roll(nodes, step, axis=1)
                chord = self.points[nodes] - self.points[other]
                turn = self.normal[nodes] - self.normal[other]
                height = max(height, float(np.abs(np.einsum("mkx,mkx->mk", chord, turn)).max()) / 8.0)
        return height if height > _ROUND_OFF * self.size else 0.0

    def by_width(self, sides: IntArray) -> list[tuple[int, IntArray]]:
        """Positions in ``sides`` (q,), numbers of sides, grouped by the number of nodes of the side."""
        width = self.width[sides]
        return [(int(each), np.flatnonzero(width == each)) for each in np.unique(width)]

    def shape_weights(self, sides: IntArray, where: FloatArray) -> FloatArray:
        """(q, 8) shape functions of sides (q,) at reference coordinates (q, 2), zero where a row is filled up."""
        weights = np.zeros((len(sides), WIDEST_SIDE))
        for width, members in self.by_width(sides):
            weights[members, :width] = side_shape_functions(width, where[members])[0]
        return weights

    def border(self, sides: IntArray) -> FloatArray:
        """(q, 8, 3) m: the nodes of sides (q,) in the order of their border; shorter borders repeat the last node."""
        order = np.array([np.pad(at, (0, WIDEST_SIDE - len(at)), mode="edge") for at in SIDE_BORDER.values()])
        row = np.searchsorted(list(SIDE_BORDER), self.width[sides])
        return self.points[np.take_along_axis(self.sides[sides], order[row], axis=1)]

    def interpolate(self, values: FloatArray, sides: IntArray, weights: FloatArray) -> FloatArray:
        """(q, d) values at points with ``weights`` (q, 8) in sides (q,), from values (n_nodes, d) at the nodes."""
        return np.asarray(np.einsum("qk,qkx->qx", weights, values[self.sides[sides]]))
