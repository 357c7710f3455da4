"""Pairs of coincident nodes of two faces: where they are, which area and directions they have, how they move apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import scipy.sparse
from scipy.spatial import cKDTree

from stickslip.errors import InputError
from stickslip.structure.faces import face_geometry
from stickslip.structure.finite_element_mesh import AnyMesh
from stickslip.structure.mesh import IntArray
from stickslip.structure.superelement import Superelement
from stickslip.validation import FloatArray, finite_array, require_positive


@dataclass(frozen=True)
class FacePairs:
    """Coincident node pairs of one or more faces.

    The first body is the one whose outward normal is kept (the damper), the second the other one (a blade). Relative
    displacement is that of the first against the second body, so a first body that moves along its outward normal
    closes the pair: ``n = normal . (u_first - u_second) > 0`` closes.

    Parameters
    ----------
    first_node, second_node:
        (n_pairs,) node numbers.
    points:
        (n_pairs, 3) m.
    area:
        (n_pairs,) m2, the part of the face that each pair stands for; sums to the area of the faces.
    normal:
        (n_pairs, 3) unit vectors out of the first body.
    tangent1, tangent2:
        (n_pairs, 3) unit vectors in the face: up the slope (along z, or along x on a face that looks along z), and
        across it. They mirror with the face, so they need not form a right-handed set with the normal.
    face:
        (n_pairs,) number of the face.
    face_position:
        (n_pairs, 2) m along tangent1 and tangent2 from the middle of the face's box, for maps.
    """

    first_node: IntArray
    second_node: IntArray
    points: FloatArray
    area: FloatArray
    normal: FloatArray
    tangent1: FloatArray
    tangent2: FloatArray
    face: IntArray
    face_position: FloatArray

    @property
    def n_pairs(self) -> int:
        """Number of pairs."""
        return len(self.first_node)

    @property
    def nodes(self) -> IntArray:
        """(2 * n_pairs,) the first nodes, then the second ones: the contact part of a boundary set."""
        return np.concatenate([self.first_node, self.second_node])

    @staticmethod
    def concatenate(parts: Sequence[FacePairs]) -> FacePairs:
        """Pairs of several faces in one object; faces are numbered on from part to part. Raises InputError if empty."""
        if not parts:
            raise InputError("FacePairs.concatenate got no faces; give it at least one FacePairs.")
        renumbered = []
        n_faces = 0
        for part in parts:
            renumbered.append(replace(part, face=part.face + n_faces))
            n_faces += int(part.face.max()) + 1
        return FacePairs(
            *(np.concatenate([getattr(part, item.name) for part in renumbered]) for item in fields(FacePairs))
        )

    def mesh_operator(self, n_nodes: int) -> Any:
        """csr (3 * n_pairs, 3 * n_nodes): rows t1, t2, n of each pair from the displacements of the full mesh."""
        directions = np.stack([self.tangent1, self.tangent2, self.normal], axis=1)
        rows = np.broadcast_to(np.arange(3 * self.n_pairs).reshape(-1, 3, 1), directions.shape)

        def part(nodes: IntArray) -> Any:
            columns = np.broadcast_to((3 * nodes[:, None] + np.arange(3))[:, None, :], directions.shape)
            entries = (directions.ravel(), (rows.ravel(), columns.ravel()))
            return scipy.sparse.csr_matrix(entries, shape=(3 * self.n_pairs, 3 * n_nodes))

        return part(self.first_node) - part(self.second_node)

    def operator(self, superelement: Superelement) -> FloatArray:
        """(3 * n_pairs, n) rows t1, t2, n of each pair from the unknowns of a superelement; n > 0 closes.

        Raises InputError when a node of a pair is not among ``superelement.boundary_nodes``.
        """
        boundary = superelement.boundary_nodes
        missing = np.setdiff1d(self.nodes, boundary)
        if missing.size:
            raise InputError(
                f"node {missing[0]} of a contact pair is not a boundary node of the superelement ({missing.size} of "
                f"{2 * self.n_pairs} are not); reduce again with FacePairs.nodes among the boundary_nodes."
            )
        full = self.mesh_operator(int(boundary.max()) + 1)
        matrix = np.zeros((3 * self.n_pairs, superelement.size))
        matrix[:, : 3 * len(boundary)] = full[:, (3 * boundary[:, None] + np.arange(3)).ravel()].toarray()
        return matrix

    def springs(self, normal_per_area: float, tangential_per_area: float) -> FloatArray:
        """(3 * n_pairs,) N/m, t1, t2, n of each pair, from stiffness per area in N/m3. Raises InputError below 0."""
        for name, value in (("normal_per_area", normal_per_area), ("tangential_per_area", tangential_per_area)):
            require_positive(name, finite_array(name, value), "It is a stiffness per area in N/m3.")
        return np.outer(self.area, [tangential_per_area, tangential_per_area, normal_per_area]).ravel()


def pair_faces(mesh: AnyMesh, first_set: str, second_set: str, tolerance: float = 1e-7) -> FacePairs:
    """Pair each node of one face with the node of another body's face at the same place.

    Parameters
    ----------
    first_set:
        node set of the face whose area and outward normal are used (the damper's); its order is that of the pairs.
    second_set:
        node set of the opposite face.
    tolerance:
        m, the largest distance between the two nodes of a pair.

    Raises
    ------
    InputError
        when a set is missing, empty or holds no whole cell side, when the sets share a node, and when a node of
        either set has no partner within the tolerance.
    """
    require_positive("tolerance", finite_array("tolerance", tolerance), "It is the distance in m that counts as none.")
    first, area, normal = face_geometry(mesh, first_set)
    second = mesh.node_set(second_set)
    shared = np.intersect1d(first, second)
    if shared.size:
        raise InputError(
            f"node sets '{first_set}' and '{second_set}' share node {shared[0]} ({shared.size} in all); the two sides "
            "of a joint need nodes of their own."
        )
    _require_partners(mesh, second_set, second, first_set, first, tolerance)
    partner = _require_partners(mesh, first_set, first, second_set, second, tolerance)
    isolated = np.flatnonzero(area <= 0.0)
    if isolated.size:
        raise InputError(
            f"node {first[isolated[0]]} of node set '{first_set}' belongs to no side of a cell that lies in the set; "
            "a face set must hold every node of its sides and nothing else."
        )
    tangent1, tangent2 = _tangents(normal, area)
    points = mesh.points[first]
    position = np.column_stack([points @ _mean(tangent1, area), points @ _mean(tangent2, area)])
    return FacePairs(
        first_node=first,
        second_node=second[partner],
        points=points,
        area=area,
        normal=normal,
        tangent1=tangent1,
        tangent2=tangent2,
        face=np.zeros(len(first), dtype=np.int64),
        face_position=position - 0.5 * (position.min(axis=0) + position.max(axis=0)),
    )


def _require_partners(
    mesh: AnyMesh, name: str, nodes: IntArray, other_name: str, others: IntArray, tolerance: float
) -> IntArray:
    """Positions in ``others`` of the node nearest to each of ``nodes``; raises InputError beyond the tolerance."""
    distance, partner = cKDTree(mesh.points[others]).query(mesh.points[nodes])
    lone = np.flatnonzero(distance > tolerance)
    if lone.size:
        x, y, z = 1e3 * mesh.points[nodes[lone[0]]]
        raise InputError(
            f"node {nodes[lone[0]]} of node set '{name}' at ({x:.4g}, {y:.4g}, {z:.4g}) mm has no partner in node set "
            f"'{other_name}': the nearest one is {1e3 * distance[lone[0]]:.3g} mm away and the tolerance is "
            f"{1e3 * tolerance:.3g} mm ({lone.size} of {len(nodes)} nodes have none). Make the two face meshes match."
        )
    return np.asarray(partner, dtype=np.int64)


def _mean(vectors: FloatArray, weight: FloatArray) -> FloatArray:
    """Unit vector (3,) along the weighted mean of vectors (k, 3)."""
    mean = weight @ vectors
    return np.asarray(mean / np.linalg.norm(mean))


def _tangents(normal: FloatArray, area: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit vectors (k, 3) in the face at each node; the choice is made once for the face by its mean normal."""
    face_normal = _mean(normal, area)
    upward = np.array([1.0, 0.0, 0.0]) if abs(face_normal[2]) > 0.99 else np.array([0.0, 0.0, 1.0])
    tangent1 = upward - (normal @ upward)[:, None] * normal
    tangent1 /= np.linalg.norm(tangent1, axis=1, keepdims=True)
    tangent2 = np.cross(normal, tangent1)
    face_tangent2 = _mean(tangent2, area)
    # The leading component is made positive, so that mirrored faces get mirrored tangents.
    return tangent1, tangent2 * np.sign(face_tangent2[np.abs(face_tangent2).argmax()])
