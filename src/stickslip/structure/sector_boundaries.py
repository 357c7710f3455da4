"""The symmetry of a sector from its boundaries, and the mesh of a sector with the next one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import scipy.spatial
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, argument_error, finite_array, whole_number
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.mesh import IntArray, Mesh, node_numbers

AxisName = Literal["x", "y", "z"]
Axis = AxisName | tuple[ArrayLike, ArrayLike]

# chosen: nodes of the two boundaries match if their distance after the rotation is below this fraction of the smallest
# distance between two nodes of a boundary. Text files of meshes have six digits or more.
MATCH = 1e-2
# chosen: two nodes of a boundary are at one position if their distance is below this fraction of its size.
SAME_POSITION = 1e-6
# chosen: difference of the number of sectors that the angle gives from a whole number, relative to that number.
WHOLE = 1e-4
# chosen: a node is on the axis if its distance from it is below this fraction of the largest one.
ON_AXIS = 1e-9


def cyclic_symmetry(
    points: ArrayLike, left: ArrayLike, right: ArrayLike, sectors: int | None = None, axis: Axis | None = None
) -> CyclicSymmetry:
    """The symmetry that two boundaries of a sector have.

    Parameters
    ----------
    points:
        (n, 3) m positions of the nodes of the sector.
    left, right:
        nodes of the two boundaries, in any order.
    sectors:
        number of sectors; None computes it from the angle between the boundaries.
    axis:
        "x", "y" or "z" through the origin, or a point (3,) m and a direction (3,); None tries these three axes.

    Raises
    ------
    InputError
        for boundaries that no rotation by a fraction of a circle maps on each other, several axes that do, an axis or a
        number of sectors that contradicts the boundaries, and a node on the axis.
    """
    nodes = finite_array("points", points)
    first, second = (_nodes_of(name, value, len(nodes)) for name, value in (("left", left), ("right", right)))
    _require_two_boundaries(first, second)
    if first.size != second.size:
        raise InputError(
            f"left has {first.size} nodes and right {second.size}: the boundaries of a sector must match node by node. "
            "Mesh both boundaries alike, or tie them (tied_symmetry; in a study file structure.tied = true).",
            arguments=["left", "right"],
        )
    return symmetry_of_boundaries(nodes, first, second, axis, sectors, lambda about: _matched(nodes, about))


def symmetry_of_boundaries(
    points: FloatArray,
    left: IntArray,
    right: IntArray,
    axis: Axis | None,
    sectors: int | None,
    connected: Callable[[CyclicSymmetry], CyclicSymmetry],
) -> CyclicSymmetry:
    """The symmetry of two boundaries that ``connected`` gives for one about an axis, whose nodes have no order yet; it
    raises InputError if they do not fit. Other arguments and errors are those of :func:`cyclic_symmetry`."""
    _require_two_boundaries(left, right)
    if sectors is not None:
        whole_number("sectors", sectors, 2)
    if axis is not None:
        return connected(_about(points, left, right, _checked_axis(axis), sectors))
    answers, reasons = [], []
    for name in ("x", "y", "z"):
        try:
            answers.append(connected(_about(points, left, right, _checked_axis(name), sectors)))
        except InputError as error:
            reasons.append(str(error))
    if len(answers) > 1:
        # Half a turn about the line in the middle between two plane boundaries maps them on each other too.
        answers = [each for each in answers if each.sectors > 2] or answers
    if len(answers) > 1:
        raise InputError(
            "axis is not given, and a rotation about more than one of the axes x, y, z maps the left boundary on the "
            "right one. Give axis.",
            arguments=["axis"],
        )
    if not answers:
        raise InputError(
            "axis is not given, and no rotation about the axes x, y or z through the origin maps the left boundary on "
            f"the right one. About z: {reasons[2]} For another axis give a point and a direction.",
            arguments=["axis", "left", "right", *(() if sectors is None else ("sectors",))],
        )
    return answers[0]


def _nodes_of(name: str, value: ArrayLike, count: int) -> IntArray:
    return np.unique(np.atleast_1d(node_numbers(name, value, count)))


def _require_two_boundaries(left: IntArray, right: IntArray) -> None:
    for name, nodes in (("left", left), ("right", right)):
        if not nodes.size:
            raise InputError(f"{name} has no nodes; give the nodes of that boundary of the sector.", arguments=[name])
    common = np.intersect1d(left, right)
    if common.size:
        raise InputError(
            f"node {common[0]} belongs to both boundaries of the sector ({common.size} nodes do). A node on the axis "
            "has no neighbour in the next sector: leave a hole around the axis, and remove other common nodes from one "
            "boundary.",
            arguments=["left", "right"],
        )


def _checked_axis(axis: Axis) -> tuple[FloatArray, FloatArray]:
    """A point of the axis and its direction, a unit vector. Raises InputError."""
    if isinstance(axis, str):
        if axis not in ("x", "y", "z"):
            raise argument_error("axis", f"axis is {axis!r}, but it must be x, y, z, or a point and a direction.")
        return np.zeros(3), np.eye(3)["xyz".index(axis)]
    try:
        point, direction = (finite_array("axis", each) for each in axis)
    except (TypeError, ValueError) as error:
        raise argument_error(
            "axis", "axis must be x, y, z, or a point (3,) in m and a direction (3,), such as ((0, 0, 0), (0, 0, 1))."
        ) from error
    if point.shape != (3,) or direction.shape != (3,) or not direction.any():
        raise argument_error(
            "axis",
            f"axis must be a point (3,) in m and a direction (3,) that is not zero, but the shapes are {point.shape} "
            f"and {direction.shape}.",
        )
    return point, direction / np.linalg.norm(direction)


def _about(
    points: FloatArray, left: IntArray, right: IntArray, axis: tuple[FloatArray, FloatArray], sectors: int | None
) -> CyclicSymmetry:
    """The symmetry about an axis, whose direction the rotation from left to right determines, without an order of the
    nodes. Raises InputError."""
    point, direction = axis
    _require_off_axis(points, np.concatenate([left, right]), point, direction)
    angle = _angle(points[left], points[right], point, direction)
    if angle < 0.0:
        angle, direction = -angle, -direction
    return CyclicSymmetry(_count(angle, sectors), point, direction, left, right, len(points))


def _matched(points: FloatArray, symmetry: CyclicSymmetry) -> CyclicSymmetry:
    """With the nodes of the right boundary in the order of those of the left one. Raises InputError."""
    left, right, count = symmetry.left, symmetry.right, symmetry.sectors
    require_distinct(points, left, "left")
    distance, partner = scipy.spatial.cKDTree(points[right]).query(symmetry.rotated(points[left]))
    spacing = _spacing(points[left])
    worst = int(distance.argmax())
    if distance[worst] > MATCH * spacing or np.unique(partner).size != partner.size:
        place = ", ".join(f"{1e3 * each:.6g}" for each in points[left[worst]])
        raise InputError(
            f"the boundaries do not match: node {left[worst]} of left at ({place}) mm, rotated by "
            f"{360.0 / count:.6g} degrees, is {1e3 * distance[worst]:.3g} mm from the nearest node of right, but "
            f"nodes must match to {1e3 * MATCH * spacing:.2g} mm. Mesh both boundaries alike, check the axis, or tie "
            "them (tied_symmetry; in a study file structure.tied = true).",
            arguments=["left", "right"],
        )
    return replace(symmetry, right=right[partner])


def require_distinct(points: FloatArray, nodes: IntArray, name: str) -> None:
    """Raise InputError for two nodes of a boundary at one position, which two bodies that meet there have."""
    if len(nodes) < 2:
        return
    distance, nearest = scipy.spatial.cKDTree(points[nodes]).query(points[nodes], k=2)
    closest = int(distance[:, 1].argmin())
    if distance[closest, 1] <= SAME_POSITION * float(np.linalg.norm(np.ptp(points[nodes], axis=0))):
        place = ", ".join(f"{1e3 * each:.6g}" for each in points[nodes[closest]])
        raise InputError(
            f"nodes {nodes[nearest[closest]].min()} and {nodes[nearest[closest]].max()} of {name} are both at "
            f"({place}) mm, so the positions do not show which of them continues in which node of the next sector. "
            "Give bodies that touch on the boundary common nodes, or other nodes at other positions.",
            arguments=[name],
        )


def _count(angle: float, sectors: int | None) -> int:
    """The number of sectors of an angle in rad between the boundaries. Raises InputError."""
    exact = 2.0 * np.pi / angle
    count = round(exact)
    if sectors is not None and count != sectors:
        raise InputError(
            f"sectors is {sectors}, but the angle between the boundaries is {np.degrees(angle):.6g} degrees, that of "
            f"{exact:.6g} sectors. Correct sectors or axis, or give a mesh of one sector.",
            arguments=["sectors"],
        )
    if count < 2 or (sectors is None and abs(exact - count) > WHOLE * exact):
        raise InputError(
            f"the angle between the boundaries is {np.degrees(angle):.6g} degrees, {exact:.6g} times in a circle. It "
            "must divide 360 degrees: check the boundaries, the axis, and that the mesh is a whole sector.",
            arguments=["left", "right"],
        )
    return count


def _require_off_axis(points: FloatArray, nodes: IntArray, point: FloatArray, direction: FloatArray) -> None:
    radius = np.linalg.norm(np.cross(points[nodes] - point, direction), axis=1)
    nearest = int(radius.argmin())
    if radius[nearest] <= ON_AXIS * np.linalg.norm(np.cross(points - point, direction), axis=1).max():
        raise InputError(
            f"node {nodes[nearest]} of a boundary is on the axis, where it has no neighbour in the next sector. Leave "
            "a hole around the axis.",
            arguments=["left", "right"],
        )


def _angle(first: FloatArray, second: FloatArray, point: FloatArray, direction: FloatArray) -> float:
    """The angle in rad, -pi to pi, between the means of two sets of points about an axis. Raises InputError."""
    arms = []
    for points in (first, second):
        arm = points.mean(axis=0) - point
        arms.append(arm - (arm @ direction) * direction)
    sizes = [float(np.linalg.norm(arm)) for arm in arms]
    angle = float(np.arctan2(np.cross(arms[0], arms[1]) @ direction, arms[0] @ arms[1]))
    if min(sizes) == 0.0 or abs(angle) <= WHOLE:
        raise InputError(
            "the boundaries are at the same angle about the axis, so that no rotation leads from one to the other. "
            "Check left, right and axis.",
            arguments=["left", "right", "axis"],
        )
    return angle


def _spacing(points: FloatArray) -> float:
    """The smallest distance between two of the points, m; 1 m for a single one."""
    if len(points) < 2:
        return 1.0
    return float(scipy.spatial.cKDTree(points).query(points, k=2)[0][:, 1].min())


def with_next_sector(mesh: Mesh, symmetry: CyclicSymmetry) -> Mesh:
    """The mesh of this sector and of the next one, to pair faces across the boundary.

    Node n of the next sector has the number ``n + n_nodes``, and its sets have the names "next NAME". The sectors have
    no common nodes, although those of the boundary are at the same positions. Raises InputError for a mesh with another
    number of nodes than that of the symmetry.
    """
    require_mesh_of(mesh, symmetry)
    cells = mesh.cells if isinstance(mesh.cells, tuple) else (mesh.cells,)

    def both(sets: Mapping[str, Any], ahead: Callable[[Any], Any]) -> dict[str, Any]:
        return {**sets, **{f"next {name}": ahead(members) for name, members in sets.items()}}

    counts = [len(block) for block in cells]  # cells of one kind stay together
    bodies = np.split(mesh.body, np.cumsum(counts)[:-1])
    n_bodies = len(mesh.body_names)
    return Mesh(
        np.vstack([mesh.points, symmetry.rotated(mesh.points)]),
        tuple(np.vstack([block, block + mesh.n_nodes]) for block in cells),
        np.concatenate([np.append(body, body + n_bodies) for body in bodies]),
        both(mesh.node_sets, lambda nodes: nodes + mesh.n_nodes),
        (*mesh.body_names, *(f"next {name}" for name in mesh.body_names)),
        both(mesh.face_sets, lambda sides: tuple(side + mesh.n_nodes for side in sides)),
    )


def require_mesh_of(mesh: Mesh, symmetry: CyclicSymmetry) -> None:
    """Raise InputError for a mesh that is not that of a symmetry, and for midside nodes that a boundary lacks."""
    if mesh.n_nodes != symmetry.n_nodes:
        raise InputError(
            f"the mesh has {mesh.n_nodes} nodes, but the symmetry is that of {symmetry.n_nodes} nodes. Give "
            "cyclic_symmetry the points of this mesh; a 20-node element adds midside nodes (structure.mesh).",
            arguments=["symmetry"],
        )
    for name, nodes in (("left", symmetry.left), ("right", symmetry.right)):
        on_boundary = np.zeros(mesh.n_nodes, dtype=bool)
        on_boundary[nodes] = True
        for block in mesh.blocks:
            kind = CELL_KINDS[block.kind]
            if not kind.is_quadratic:
                continue
            middle = block.cells[:, -len(kind.edges) :]
            lacks = on_boundary[block.cells[:, kind.edges]].all(axis=2) & ~on_boundary[middle]
            if lacks.any():
                raise InputError(
                    f"{name} contains both ends of an edge but not node {middle[lacks][0]} between them "
                    f"({int(lacks.sum())} such edges): the boundary would be open there. Name the midside nodes too.",
                    arguments=[name],
                )
