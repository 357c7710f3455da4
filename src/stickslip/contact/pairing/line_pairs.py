"""Contact pairs along a line on which two bodies have nodes at the same positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.pairing.local_axes import local_tangents, map_position
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, positive_number
from stickslip.structure.mesh import Mesh


def pair_lines(
    mesh: Mesh,
    first_set: str,
    second_set: str,
    normal: ArrayLike,
    width: float,
    drop: float = 0.0,
    tolerance: float = 1e-7,
) -> FacePairs:
    """Pair the nodes of two straight lines, one of each body, in the order along the line.

    Parameters
    ----------
    first_set, second_set:
        node sets of the lines of bricks; those of the first body (the damper) and their partners.
    normal:
        (3,) direction out of the first body.
    width:
        m, of the strip that the line stands for: the area of a pair is its part of the length times this.
    drop:
        m, gap at both ends of the line by a parabolic crown of the first body; 0 in the middle.
    tolerance:
        m, the largest distance between the two nodes of a pair.

    Raises
    ------
    InputError
        for a set that is missing or has less than two nodes, and for nodes without a partner.
    """
    positive_number("width", width, "m")
    first, second = mesh.node_set(first_set), mesh.node_set(second_set)
    if len(first) != len(second) or len(first) < 2:
        raise InputError(
            f"the lines '{first_set}' and '{second_set}' have {len(first)} and {len(second)} nodes; they must have "
            "the same number, at least 2.",
            arguments=["first_set", "second_set"],
        )
    along = mesh.points[first] - mesh.points[first].mean(axis=0)
    direction = np.linalg.svd(along, full_matrices=False)[2][0]
    direction *= np.sign(direction[np.abs(direction).argmax()])
    first, second = (nodes[np.argsort(mesh.points[nodes] @ direction)] for nodes in (first, second))
    distance = np.linalg.norm(mesh.points[first] - mesh.points[second], axis=1)
    if distance.max() > tolerance:
        at = int(distance.argmax())
        raise InputError(
            f"node {first[at]} of '{first_set}' is {1e3 * distance[at]:.3g} mm from its partner in '{second_set}'; "
            f"they must coincide within {1e3 * tolerance:g} mm.",
            arguments=["first_set", "second_set"],
        )
    points = mesh.points[first]
    position = points @ direction
    position = position - 0.5 * (position[0] + position[-1])
    area = width * node_lengths(position, has_midside_nodes=mesh.bricks().shape[1] == 20)
    unit = np.asarray(normal, dtype=float) / np.linalg.norm(normal)
    normals = np.tile(unit, (len(first), 1))
    tangent1, tangent2 = local_tangents(points, normals, area)
    one = np.ones((len(first), 1))
    return FacePairs(
        first_nodes=first[:, None],
        first_weights=one,
        second_nodes=second[:, None],
        second_weights=one,
        gap=crown_drop(position, float(np.ptp(position)), drop),
        points=points,
        area=area,
        normal=normals,
        tangent1=tangent1,
        tangent2=tangent2,
        face=np.zeros(len(first), dtype=np.int64),
        face_position=map_position(points, tangent1, tangent2, area),
    )


def crown_drop(position: ArrayLike, length: float, drop: float) -> FloatArray:
    """Distance (k,) in m of a crowned cylinder from the straight one at positions (k,) in m from its middle.

    The profile is a parabola: 0 in the middle, ``drop`` at both ends of the ``length``.
    """
    return np.asarray(drop * (2.0 * np.asarray(position, dtype=float) / length) ** 2)


def node_lengths(position: FloatArray, has_midside_nodes: bool) -> FloatArray:
    """Length (k,) in m that each node of a line stands for, as elements distribute a uniform load on it."""
    lengths = np.zeros(position.size)
    if has_midside_nodes:
        sides = position[2::2] - position[:-2:2]
        for start, weight in ((0, 1.0 / 6.0), (1, 4.0 / 6.0), (2, 1.0 / 6.0)):
            lengths[start : start + 2 * sides.size : 2] += weight * sides
        return lengths
    sides = np.diff(position)
    lengths[:-1] += 0.5 * sides
    lengths[1:] += 0.5 * sides
    return lengths
