"""Contact pairs between faces: coincident nodes, faces whose meshes do not match, and faces on the rigid ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.pairing.local_axes import local_tangents, map_position
from stickslip.contact.pairing.pairing_result import GROUND, Pairing, Unpaired, write_pairs
from stickslip.contact.pairing.projection import BEYOND_EDGE, PAIRED, Projection, project
from stickslip.contact.pairing.segmentation import IntegrationPoints, cut_points, whole_side_points
from stickslip.contact.pairing.surface_mesh import SurfaceMesh
from stickslip.core.errors import InputError, concerning
from stickslip.core.validation import FloatArray, positive_number, real_number, require_choice
from stickslip.structure.mesh import IntArray, Mesh

__all__ = ["FacePairs", "Pairing", "pair_faces", "pair_surfaces", "pair_with_ground", "write_pairs"]

Points = Literal["nodes", "quadrature"]
Adjust = Literal["measured", "closed"]

# Defaults as fractions of a length; pair_surfaces gives the reasons.
_SEARCH_FRACTION, _EDGE_FRACTION, _GAP_FRACTION = 0.2, 0.01, 1e-6
_SMALLEST_WEIGHT = 1e-10  # shape functions below it are round-off at a node
_SMALLEST_UNCOVERED = 1e-9  # fraction of a side; less is round-off of the clipping
_COARSER = 1.2  # chosen: ratio of side lengths above which the first face counts as the coarser one


def pair_faces(
    mesh: Mesh, first_set: str, second_set: str, tolerance: float = 1e-7, tangent: ArrayLike | None = None
) -> FacePairs:
    """Pair each node of one face with the node of another body's face at the same position.

    Parameters
    ----------
    first_set:
        node set of the face whose area and outward normal are used (the damper's); its order is that of the pairs.
    second_set:
        node set of the opposite face.
    tolerance:
        m, the largest distance between the two nodes of a pair; the pair then has no gap.
    tangent:
        (3,) direction of tangent1, projected on the face (:func:`stickslip.contact.pairing.local_axes.local_tangents`).

    Raises
    ------
    InputError
        when a set is missing, empty or contains no complete cell side, when the sets share a node, and when a node of
        either set has no partner within the tolerance.
    """
    positive_number("tolerance", tolerance, "m: it is the distance that counts as zero")
    face = SurfaceMesh.of(mesh, first_set)
    second = mesh.node_set(second_set)
    _require_own_nodes(first_set, face.nodes, second_set, second)
    _require_partners(mesh, second_set, second, first_set, face.nodes, tolerance)
    partner = _require_partners(mesh, first_set, face.nodes, second_set, second, tolerance)
    places = _node_places(face)
    one = np.ones((len(partner), 1))
    return _face_pairs(places, second[partner][:, None], one, np.zeros(len(partner)), tangent)


def pair_surfaces(
    mesh: Mesh,
    first: str,
    second: str,
    *,
    points: Points = "nodes",
    search_distance: float | None = None,
    edge_tolerance: float | None = None,
    gap_tolerance: float | None = None,
    tangent: ArrayLike | None = None,
    adjust: Adjust = "measured",
) -> Pairing:
    """Pair points of one face with their projections along their normals on another body's face.

    The meshes of the faces need not match. The ray from each point p along the smoothed normal n intersects the second
    face at ``p + gap n``; the second side of the pair moves with the shape functions of the cell side there. Forces and
    moments of the two bodies balance to round-off. Points without a partner do not take part in the contact, their area
    is not distributed among the others, and the result lists them with the reason.

    Parameters
    ----------
    first, second:
        face sets or node sets. Areas, normals and directions are those of the first one.
    points:
        ``nodes``: the nodes of the first face with their tributary areas; as many pairs as nodes, so this is the choice
        for large models. Take the finer face as the first. A uniform pressure is somewhat uneven on the second face,
        less with a finer first face (docs/pairing.md has figures). ``quadrature``: integration points in the cells into
        which the sides of both faces cut each other (``segmentation.py``); this transfers a uniform pressure to
        round-off where the sides are triangles or parallelograms, but gives 5 to 20 times as many pairs.
    search_distance:
        m, the largest distance along the normal, apart or overlapping; by default a fifth of the mean side length of
        the coarser face, more than the distance of flat sides from a curved face.
    edge_tolerance:
        m, the largest distance of a point with a partner from the edge of the second face; by default a hundredth of
        the mean side length of the first face.
    gap_tolerance:
        m, smaller gaps count as zero; by default 1e-6 of the size of the first face.
    tangent:
        (3,) direction of tangent1, projected on the face (:func:`stickslip.contact.pairing.local_axes.local_tangents`).
    adjust:
        ``measured`` takes the gap of the meshes; ``closed`` sets every gap to zero, for faces in contact whose
        distances come from the meshes alone (flat sides of a curved face).

    Raises
    ------
    InputError
        for an unknown choice, a distance that is not above 0, faces that share a node, a set without complete sides, a
        tangent along a normal, a second face in layers, and faces without any pair.
    """
    require_choice("points", points, get_args(Points))
    require_choice("adjust", adjust, get_args(Adjust))
    with concerning("first"):
        whole = SurfaceMesh.of(mesh, first)
    with concerning("second"):
        whole_other = SurfaceMesh.of(mesh, second)
    _require_own_nodes(first, whole.nodes, second, whole_other.nodes)
    length, other_length = (float(np.sqrt(surface.side_area.mean())) for surface in (whole, whole_other))
    search = _length("search_distance", search_distance, _SEARCH_FRACTION * max(length, other_length))
    edge = _length("edge_tolerance", edge_tolerance, _EDGE_FRACTION * length)
    none = _length("gap_tolerance", gap_tolerance, _GAP_FRACTION * whole.size)
    face, away = _touching_parts(whole, whole_other, search, edge)
    other, other_away = _touching_parts(whole_other, whole, search, edge)

    nodes = _node_places(face)
    node_projection = project(nodes.points, nodes.normal, other, search, edge)
    if points == "nodes":
        places, projection = nodes, node_projection
        missed = Unpaired.of(places.node, places.points, places.normal, places.area, projection)
    else:
        cut = cut_points(face, other, search)
        places = _side_places(face, cut)
        projection = project(places.points, places.normal, other, search, edge)
        missed = Unpaired.joined(
            Unpaired.of(places.node, places.points, places.normal, places.area, projection),
            _uncovered(face, cut, nodes, node_projection),
        )
    missed = Unpaired.joined(missed, away)
    paired = np.flatnonzero(projection.reason == PAIRED)
    if not paired.size:
        finite = np.abs(missed.gap[np.isfinite(missed.gap)])
        distance = f"{1e3 * finite.min():.3g} mm" if finite.size else "not defined"
        raise InputError(
            f"no position on face '{first}' has a partner on face '{second}'. Positions on '{first}': "
            f"{missed.counts()}. The smallest distance along the normal is {distance} (search_distance "
            f"{1e3 * search:.3g} mm), the smallest overhang {1e3 * missed.overhang.min():.3g} mm (edge_tolerance "
            f"{1e3 * edge:.3g} mm). Check the sets and the positions of the bodies, or raise the tolerance that is too "
            "small.",
            ("first", "second"),
        )
    gap = np.where(np.abs(projection.gap[paired]) <= none, 0.0, projection.gap[paired])
    weights = np.where(np.abs(projection.weights[paired]) < _SMALLEST_WEIGHT, 0.0, projection.weights[paired])
    weights /= weights.sum(axis=1, keepdims=True)
    closed = np.zeros_like(gap) if adjust == "closed" else gap
    opposite = _node_places(other)
    return Pairing(
        first=first,
        second=second,
        points=points,
        adjust=adjust,
        pairs=_face_pairs(places.only(paired), other.sides[projection.side[paired]], weights, closed, tangent),
        measured_gap=gap,
        overhang=projection.overhang[paired],
        unpaired_first=missed,
        unpaired_second=Unpaired.joined(
            Unpaired.of(
                opposite.node, opposite.points, opposite.normal, opposite.area,
                project(opposite.points, opposite.normal, face, search, edge),
            ),
            other_away,
        ),
        first_area=whole.area,
        second_area=whole_other.area,
        search_distance=search,
        edge_tolerance=edge,
        gap_tolerance=none,
        facet_height=face.facet_height + other.facet_height,
        node_count=len(face.nodes),
        has_midside_nodes=bool((face.width > 4).any()),
        is_first_coarser=length > _COARSER * other_length,
    )  # fmt: skip


def _touching_parts(face: SurfaceMesh, other: SurfaceMesh, search: float, edge: float) -> tuple[SurfaceMesh, Unpaired]:
    """The parts of a face between sharp edges that have a partner on the other face, and the nodes of the rest.

    The contact body of a Nastran deck has all sides of a solid. Those round the edge of the contact must not turn the
    smoothed normals at the edge, nor add their area to its nodes. A face whose parts all lack partners stays whole; the
    message that there are no pairs then lists its nodes.
    """
    part = face.smooth_parts
    count = int(part.max()) + 1
    touches = np.zeros(count, dtype=bool)
    for number in range(count if count > 1 else 0):
        one = face.only(np.flatnonzero(part == number))
        points, normal = (
            np.vstack([one.points[one.nodes], one.centre]),
            np.vstack([one.normal[one.nodes], one.side_normal]),
        )
        touches[number] = (project(points, normal, other, search, edge).reason == PAIRED).any()
    kept = touches[part]
    if kept.all() or not kept.any():
        return face, Unpaired.none()
    return face.only(np.flatnonzero(kept)), Unpaired.on_other_parts(face.only(np.flatnonzero(~kept)))


def pair_with_ground(
    mesh: Mesh, first: str, *, points: Points = "nodes", gap: float = 0.0, tangent: ArrayLike | None = None
) -> Pairing:
    """Pair a face with a rigid, fixed ground of the same shape, at a distance of ``gap`` (m) along the normal.

    ``points`` and ``tangent`` are those of :func:`pair_surfaces`; the integration points are those of complete sides.
    Raises InputError for an unknown choice, a gap that is not a number, a set without complete sides, and a tangent
    along a normal.
    """
    require_choice("points", points, get_args(Points))
    distance = real_number("gap", gap)
    with concerning("first"):
        face = SurfaceMesh.of(mesh, first)
    places = _node_places(face) if points == "nodes" else _side_places(face, whole_side_points(face))
    count = len(places.area)
    gaps = np.full(count, distance)
    nowhere = np.zeros((count, 1), dtype=np.int64)
    return Pairing(
        first=first,
        second=GROUND,
        points=points,
        adjust="measured",
        pairs=_face_pairs(places, nowhere, np.zeros((count, 1)), gaps, tangent),
        measured_gap=gaps,
        overhang=np.zeros(count),
        unpaired_first=Unpaired.none(),
        unpaired_second=Unpaired.none(),
        first_area=face.area,
        second_area=0.0,
        search_distance=0.0,
        edge_tolerance=0.0,
        gap_tolerance=0.0,
        facet_height=0.0,
        node_count=len(face.nodes),
        has_midside_nodes=bool((face.width > 4).any()),
        is_first_coarser=False,
    )


@dataclass(frozen=True)
class _Places:
    """Points of the first face before they are paired."""

    node: IntArray  # (q,) node number, -1 inside a side
    nodes: IntArray  # (q, a)
    weights: FloatArray  # (q, a)
    points: FloatArray  # (q, 3)
    normal: FloatArray  # (q, 3)
    area: FloatArray  # (q,)

    def only(self, members: IntArray) -> _Places:
        return _Places(*(value[members] for value in vars(self).values()))


def _node_places(face: SurfaceMesh) -> _Places:
    nodes = face.nodes
    return _Places(
        nodes, nodes[:, None], np.ones((len(nodes), 1)), face.points[nodes], face.normal[nodes], face.node_area
    )


def _side_places(face: SurfaceMesh, integration: IntegrationPoints) -> _Places:
    normal = face.interpolate(face.normal, integration.side, integration.weights)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    inside = np.full(len(integration.side), -1)
    return _Places(
        inside, face.sides[integration.side], integration.weights, integration.points, normal, integration.area
    )


def _uncovered(face: SurfaceMesh, cut: IntegrationPoints, nodes: _Places, projection: Projection) -> Unpaired:
    """Sides that are only partly in cells: their missing area, at their middle.

    Reason, gap and overhang are those of the farthest node of the side; a side whose nodes all have partners is over a
    hole of the second face, beyond an edge.
    """
    missing = face.side_area - np.bincount(cut.side, cut.area, minlength=len(face.sides))
    sides = np.flatnonzero((1.0 - cut.covered > _SMALLEST_UNCOVERED) & (missing > 0.0))
    position = np.zeros(len(face.points), dtype=np.int64)
    position[nodes.node] = np.arange(len(nodes.node))
    corners = position[face.sides[sides]]
    missed = projection.reason[corners] != PAIRED
    worst = np.where(missed, projection.overhang[corners], -1.0).argmax(axis=1)
    at = corners[np.arange(len(sides)), worst]
    reason = np.where(missed.any(axis=1), projection.reason[at], BEYOND_EDGE)
    return Unpaired(
        np.full(len(sides), -1),
        face.centre[sides],
        face.side_normal[sides],
        missing[sides],
        reason,
        projection.gap[at],
        projection.overhang[at],
    )


def _face_pairs(
    places: _Places, second_nodes: IntArray, second_weights: FloatArray, gap: FloatArray, tangent: ArrayLike | None
) -> FacePairs:
    """Pairs of one face; rows of nodes are cut to the columns with nonzero weights."""
    with concerning("tangent"):
        tangent1, tangent2 = local_tangents(places.points, places.normal, places.area, tangent)
    rows: dict[str, Any] = {}
    for side, nodes, weights in (
        ("first", places.nodes, places.weights),
        ("second", second_nodes, second_weights),
    ):
        used = 1 + int(np.flatnonzero(weights.any(axis=0)).max(initial=0))
        rows |= {f"{side}_nodes": nodes[:, :used], f"{side}_weights": weights[:, :used]}
    return FacePairs(
        **rows,
        gap=gap,
        points=places.points,
        area=places.area,
        normal=places.normal,
        tangent1=tangent1,
        tangent2=tangent2,
        face=np.zeros(len(gap), dtype=np.int64),
        face_position=map_position(places.points, tangent1, tangent2, places.area),
    )


def _length(name: str, value: float | None, default: float) -> float:
    return default if value is None else positive_number(name, value, "m")


def _require_own_nodes(first_name: str, first: IntArray, second_name: str, second: IntArray) -> None:
    shared = np.intersect1d(first, second)
    if shared.size:
        raise InputError(
            f"node sets '{first_name}' and '{second_name}' both contain node {shared[0]} ({shared.size} nodes in all); "
            "the two sides of a joint require separate nodes.",
            ("first", "second"),
        )


def _require_partners(
    mesh: Mesh, name: str, nodes: IntArray, other_name: str, others: IntArray, tolerance: float
) -> IntArray:
    """Positions in ``others`` of the node nearest to each of ``nodes``; raises InputError beyond the tolerance."""
    distance, partner = cKDTree(mesh.points[others]).query(mesh.points[nodes])
    alone = np.flatnonzero(distance > tolerance)
    if alone.size:
        x, y, z = 1e3 * mesh.points[nodes[alone[0]]]
        raise InputError(
            f"node {nodes[alone[0]]} of node set '{name}' at ({x:.4g}, {y:.4g}, {z:.4g}) mm has no partner in node set "
            f"'{other_name}': the nearest one is {1e3 * distance[alone[0]]:.3g} mm away and the tolerance is "
            f"{1e3 * tolerance:.3g} mm ({alone.size} of {len(nodes)} nodes have none). Make the two face meshes match."
        )
    return np.asarray(partner, dtype=np.int64)
