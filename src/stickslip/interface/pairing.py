"""Pairs of coincident nodes of two faces: where they are, which area and directions they have, how they move apart."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from stickslip.errors import InputError
from stickslip.interface.face_pairs import FacePairs
from stickslip.structure.faces import face_geometry
from stickslip.structure.finite_element_mesh import AnyMesh
from stickslip.structure.mesh import IntArray
from stickslip.validation import FloatArray, finite_array, require_positive

__all__ = ["FacePairs", "pair_faces"]


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
        first_nodes=first[:, None],
        first_weights=np.ones((len(first), 1)),
        second_nodes=second[partner][:, None],
        second_weights=np.ones((len(first), 1)),
        gap=np.zeros(len(first)),
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
