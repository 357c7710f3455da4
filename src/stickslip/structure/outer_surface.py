"""The outer surface of a mesh as plain polygons, and a coarser one of large meshes, for pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.structure.cell_kinds import CORNERS_OF_SIDE, outer_sides
from stickslip.structure.mesh import IntArray, Mesh

Flags = NDArray[np.bool_]

_GROWTH = 1.25  # chosen: factor on the cells of the grid in each step, until few enough sides remain
_AROUND = 0.25  # chosen: of the size of the contact; sides nearer than this are its surroundings


@dataclass(frozen=True)
class OuterSurface:
    """Sides (m, 4) between points (n, 3) m, seen from outside, with the body (m,) and the contact face (m,) of each.

    A triangle repeats its last corner; without midside nodes; ``face`` is -1 outside the contact. ``node`` (n,) is the
    number of each point in the mesh.
    """

    points: FloatArray
    sides: IntArray
    body: IntArray
    face: IntArray
    node: IntArray


def outer_surface(
    mesh: Mesh, contact_sets: Sequence[Sequence[str]] = (), contact_nodes: Sequence[IntArray] = ()
) -> OuterSurface:
    """All sides of only one cell.

    For each contact face ``contact_sets`` are the names of its sets in the mesh, and ``contact_nodes`` (k,) the nodes
    of its pairs: a side of these sets is part of the face if all of its corners are such nodes.

    Raises InputError for a set that does not exist or spans no side.
    """
    blocks = [(_corners(sides), owners) for sides, owners in outer_sides(mesh.cell_arrays())]
    corners = np.concatenate([sides for sides, _ in blocks])
    body = mesh.body[np.concatenate([owners for _, owners in blocks])]
    face = np.full(len(corners), -1, dtype=np.int64)
    for number, (names, nodes) in enumerate(zip(contact_sets, contact_nodes, strict=True)):
        for name in names:
            wanted = np.concatenate([_corners(sides) for sides in mesh.sides(name)])
            wanted = wanted[np.isin(wanted, nodes).all(axis=1)]
            face[_among(corners, wanted, mesh.n_nodes)] = number
    node, position = np.unique(corners, return_inverse=True)
    return OuterSurface(mesh.points[node], position.reshape(corners.shape).astype(np.int64), body, face, node)


def _corners(sides: IntArray) -> IntArray:
    """Corners (m, 4) of sides (m, 3 | 4 | 6 | 8)."""
    if CORNERS_OF_SIDE[sides.shape[1]] == 4:
        return sides[:, :4]
    return sides[:, [0, 1, 2, 2]]


def _among(corners: IntArray, wanted: IntArray, n_nodes: int) -> IntArray:
    """Indices of the sides ``corners`` (m, 4) that are among ``wanted`` (k, 4), regardless of the first corner."""
    member = np.zeros(n_nodes, dtype=bool)
    member[wanted] = True
    near = np.flatnonzero(member[corners].all(axis=1))
    both = np.sort(np.concatenate([wanted, corners[near]]), axis=1)
    # A triangle repeats one corner, any of the three once its corners are sorted.
    both = np.where(np.diff(both, axis=1, append=-1) == 0, -1, both)
    both.sort(axis=1)
    _, group = np.unique(both, axis=0, return_inverse=True)
    group = group.ravel()
    return near[np.isin(group[len(wanted) :], group[: len(wanted)])]


def coarsened(surface: OuterSurface, most: int) -> OuterSurface:
    """A surface of at most ``most`` sides: points in one cell of a grid become one, and sides without area are removed.

    Of such points the one farthest from the middle of its body remains, so that corners and outlines stay. Points of
    different bodies or contact faces are not merged. Half of the number is for sides around the contact, so that they
    stay fine. A surface with no more sides than ``most`` is returned unchanged.
    """
    if len(surface.sides) <= most:
        return surface
    near_points, near_sides = _around_contact(surface)
    leader, room = np.arange(len(surface.points)), most
    for points, there, share in ((near_points, near_sides, 0.5), (~near_points, ~near_sides, 1.0)):
        leader, count = _merged(surface, leader, points, there, int(share * room))
        room -= count
    is_areal = _spans_an_area(leader[surface.sides])
    used, position = np.unique(leader[surface.sides[is_areal]], return_inverse=True)
    sides = position.reshape(-1, 4).astype(np.int64)
    return OuterSurface(surface.points[used], sides, surface.body[is_areal], surface.face[is_areal], surface.node[used])


def _around_contact(surface: OuterSurface) -> tuple[Flags, Flags]:
    """Points and sides near the contact faces; the points include all corners of the sides."""
    points, contact = np.zeros(len(surface.points), dtype=bool), surface.face >= 0
    if contact.any():
        places = surface.points[surface.sides[contact]].reshape(-1, 3)
        low, high = places.min(axis=0), places.max(axis=0)
        reach = _AROUND * float(np.linalg.norm(high - low))
        points = ((surface.points > low - reach) & (surface.points < high + reach)).all(axis=1)
    sides = np.asarray(points[surface.sides].any(axis=1))
    points[surface.sides[sides]] = True
    return points, sides


def _merged(surface: OuterSurface, leader: IntArray, points: Flags, sides: Flags, most: int) -> tuple[IntArray, int]:
    """``leader`` (n,), the point that replaces each, with ``points`` merged until at most ``most`` of ``sides`` span an
    area, and the number of these."""
    count = int(sides.sum())
    if count <= most:
        return leader, count
    tag = np.zeros((len(surface.points), 2), dtype=np.int64)
    tag[surface.sides] = np.column_stack([surface.body, surface.face])[:, None, :]
    corners = surface.points[surface.sides[sides]]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1).sum()
    cell = float(np.sqrt(area / max(most, 1)))
    members = np.flatnonzero(points)
    members = members[np.argsort(-_distance_from_middle(surface.points, tag[:, 0])[members], kind="stable")]
    place = surface.points[members] - surface.points.min(axis=0)
    while count > most:
        key = np.column_stack([np.floor(place / cell).astype(np.int64), tag[members]])
        _, first, position = np.unique(key, axis=0, return_index=True, return_inverse=True)
        leader = leader.copy()
        leader[members] = members[first[position.ravel()]]
        count = int(_spans_an_area(leader[surface.sides[sides]]).sum())
        cell *= _GROWTH
    return leader, count


def _distance_from_middle(points: FloatArray, body: IntArray) -> FloatArray:
    """(n,) m from the middle of the box around the body of each point."""
    distance = np.zeros(len(points))
    for number in np.unique(body):
        here = points[body == number]
        distance[body == number] = np.linalg.norm(here - 0.5 * (here.min(axis=0) + here.max(axis=0)), axis=1)
    return distance


def _spans_an_area(sides: IntArray) -> Flags:
    """(m,) whether sides (m, 4) have three different corners or more in their order around."""
    around = (sides == np.roll(sides, -1, axis=1)).sum(axis=1)
    return np.asarray((around < 2) & (sides[:, 0] != sides[:, 2]) & (sides[:, 1] != sides[:, 3]))
