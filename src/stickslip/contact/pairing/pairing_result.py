"""The result of pairing two faces: pairs, points without a partner and why, tolerances; as rows, warnings and VTU."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.pairing.projection import LARGEST_ANGLE_DEG, OTHER_PART, PAIRED, REASONS, Projection
from stickslip.contact.pairing.surface_mesh import SurfaceMesh
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.export import write_points
from stickslip.structure.mesh import IntArray

# What tables of derived quantities say of those of :meth:`Pairing.summary`.
FROM_PAIRING = "from the pairing of the faces"

GROUND = "ground"
MANY_PAIRS = 1000  # the solver's cost grows with the square of the pairs, and memory as well


@dataclass(frozen=True)
class Unpaired:
    """Points of a face without a partner.

    Parameters
    ----------
    node:
        (k,) node number, -1 for a point inside a side.
    points, normal:
        (k, 3) m, and unit vectors out of the face.
    area:
        (k,) m2 that each point represents.
    reason:
        (k,) positions in :data:`stickslip.contact.pairing.projection.REASONS`.
    gap:
        (k,) m along the normal to the other face, infinite where the normal does not intersect it.
    overhang:
        (k,) m beyond the edge of the other face, seen along the normal.
    """

    node: IntArray
    points: FloatArray
    normal: FloatArray
    area: FloatArray
    reason: IntArray
    gap: FloatArray
    overhang: FloatArray

    @staticmethod
    def of(
        node: IntArray, points: FloatArray, normal: FloatArray, area: FloatArray, projection: Projection
    ) -> Unpaired:
        """Those of the projected points that have no partner in ``projection``."""
        alone = projection.reason != PAIRED
        return Unpaired(
            *(
                value[alone]
                for value in (node, points, normal, area, projection.reason, projection.gap, projection.overhang)
            )
        )

    @staticmethod
    def on_other_parts(sides: SurfaceMesh) -> Unpaired:
        """The nodes of sides round a sharp edge of the face, where nothing has a partner."""
        count = len(sides.nodes)
        return Unpaired(
            sides.nodes, sides.points[sides.nodes], sides.normal[sides.nodes], sides.node_area,
            np.full(count, OTHER_PART), np.full(count, np.inf), np.zeros(count),
        )  # fmt: skip

    @staticmethod
    def none() -> Unpaired:
        """No points."""
        number, one, three = np.empty(0, dtype=np.int64), np.empty(0), np.empty((0, 3))
        return Unpaired(number, three, three, one, number, one, one)

    @staticmethod
    def joined(first: Unpaired, second: Unpaired) -> Unpaired:
        """Both together."""
        return Unpaired(
            *(np.concatenate(both) for both in zip(vars(first).values(), vars(second).values(), strict=True))
        )

    def without(self, reason: int) -> Unpaired:
        """Those with other reasons."""
        return Unpaired(*(value[self.reason != reason] for value in vars(self).values()))

    def __len__(self) -> int:
        return len(self.node)

    @property
    def reasons(self) -> tuple[str, ...]:
        """The reason of each point in words."""
        return tuple(REASONS[reason] for reason in self.reason)

    @property
    def largest_overhang(self) -> float:
        """m; 0 if nothing lies beyond an edge."""
        return float(self.overhang.max(initial=0.0))

    def counts(self) -> str:
        """The number of unpaired points for each reason, as part of a sentence."""
        number = np.bincount(self.reason, minlength=len(REASONS))
        return ", ".join(f"{number[reason]} {REASONS[reason]}" for reason in range(1, len(REASONS)) if number[reason])


@dataclass(frozen=True)
class Pairing:
    """Pairs of one interface, and everything that a reader needs to judge them.

    Parameters
    ----------
    first, second:
        names of the faces; ``second`` is "ground" for a rigid ground.
    points, adjust:
        the options: "nodes" or "quadrature", "measured" or "closed".
    pairs:
        the contact pairs.
    measured_gap, overhang:
        (n_pairs,) m: the gap before ``adjust`` and the gap tolerance, and the distance beyond the edge of the second
        face.
    unpaired_first, unpaired_second:
        points without a partner; those of the second face are always nodes.
    first_area, second_area:
        m2 of the whole faces.
    search_distance, edge_tolerance, gap_tolerance:
        m, arguments or defaults; 0 for the ground.
    facet_height:
        m, distance of the flat sides of both faces, together, from their curved shape; smaller gaps have no meaning.
    node_count:
        number of nodes of the first face, the largest number of pairs with ``points="nodes"``.
    has_midside_nodes, is_first_coarser:
        whether the first face has sides with midside nodes, and larger sides than the second face.
    warnings:
        sentences.
    """

    first: str
    second: str
    points: str
    adjust: str
    pairs: FacePairs
    measured_gap: FloatArray
    overhang: FloatArray
    unpaired_first: Unpaired
    unpaired_second: Unpaired
    first_area: float
    second_area: float
    search_distance: float
    edge_tolerance: float
    gap_tolerance: float
    facet_height: float
    node_count: int
    has_midside_nodes: bool
    is_first_coarser: bool

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of uncovered area, overlap, gaps of facets, coarse sides and many pairs."""
        return tuple(self._warnings())

    def _warnings(self) -> Iterator[str]:
        alone, gap = self.unpaired_first, self.pairs.gap
        names = f"'{self.first}' and '{self.second}'"
        own = alone.without(OTHER_PART)
        if len(own):
            area = float(own.area.sum())
            yield (
                f"{1e6 * area:.4g} mm² of face '{self.first}' ({100 * area / self.first_area:.3g} %) has no partner on "
                f"'{self.second}' and carries no load: {own.counts()}. If this part should touch, look at its "
                "positions in the VTU file of the pairs, and check search_distance and edge_tolerance."
            )
        overlap = np.flatnonzero(gap < 0.0)
        if overlap.size:
            x, y, z = 1e3 * self.pairs.points[gap.argmin()]
            yield (
                f"{names} overlap at {overlap.size} of {gap.size} pairs, by up to {-1e3 * gap.min():.3g} mm at "
                f"({x:.4g}, {y:.4g}, {z:.4g}) mm: an interference fit loads the pairs. If the overlap comes from the "
                'meshes alone, set adjust = "closed".'
            )
        largest = float(np.abs(gap).max())
        if 0.0 < largest <= self.facet_height:
            yield (
                f"the gaps between {names} reach {1e3 * largest:.3g} mm, not more than the distance of their flat "
                f"sides from the curved faces ({1e3 * self.facet_height:.3g} mm): they may come from the meshes alone. "
                'If the faces touch, set adjust = "closed"; if the gaps are real, refine the mesh or use midside nodes.'
            )
        if self.points == "nodes" and self.is_first_coarser:
            yield (
                f"the sides of '{self.first}' are larger than those of '{self.second}', so nodes of the second face "
                'between its nodes carry no load. Use the finer face as the first one, or points = "quadrature".'
            )
        if self.points == "nodes" and self.has_midside_nodes:
            yield (
                f"face '{self.first}' has midside nodes, and its tributary areas do not correspond to the nodal forces "
                "of a uniform pressure: stiff contact springs make its pressure uneven from node to node. Use points = "
                '"quadrature", or a face without midside nodes as the first one, if single pressures matter.'
            )
        if self.points == "quadrature" and gap.size > max(MANY_PAIRS, self.node_count):
            yield (
                f'points = "quadrature" makes {gap.size} contact pairs between {names}, and the time and memory of the '
                f'solver grow with them; points = "nodes" makes at most {self.node_count}.'
            )

    def summary(self) -> tuple[tuple[str, str | float, str], ...]:
        """Rows label, value, unit of a report."""
        gap, unpaired_1, unpaired_2 = self.measured_gap, self.unpaired_first, self.unpaired_second
        rows: list[tuple[str, str | float, str]] = [
            ("first face", self.first, ""),
            ("second face", self.second, ""),
            ("points of the first face", self.points, ""),
            ("contact pairs", self.pairs.n_pairs, ""),
            ("pairs of node and node", int(self._node_to_node().sum()), ""),
            ("area of the first face", 1e6 * self.first_area, "mm²"),
            ("area of the pairs", 1e6 * float(self.pairs.area.sum()), "mm²"),
            ("area without a partner", 1e6 * float(unpaired_1.area.sum()), "mm²"),
            ("initial gap", "set to zero" if self.adjust == "closed" else "as measured", ""),
            ("smallest measured gap (below 0: overlap)", 1e3 * float(gap.min()), "mm"),
            ("largest measured gap", 1e3 * float(gap.max()), "mm"),
        ]
        if self.second == GROUND:
            return tuple(rows)
        for name, alone in ((self.first, unpaired_1), (self.second, unpaired_2)):
            rows.append((f"positions on '{name}' without a partner", alone.counts() or "none", ""))
        return (
            *rows,
            ("area of the second face", 1e6 * self.second_area, "mm²"),
            ("area of the second face without a partner", 1e6 * float(unpaired_2.area.sum()), "mm²"),
            ("largest overhang of pairs beyond the edge", 1e3 * float(self.overhang.max()), "mm"),
            ("largest overhang of positions without a partner", 1e3 * unpaired_1.largest_overhang, "mm"),
            ("distance of flat sides from curved faces, about", 1e3 * self.facet_height, "mm"),
            ("tolerance: search distance along the normal", 1e3 * self.search_distance, "mm"),
            ("tolerance: beyond the edge", 1e3 * self.edge_tolerance, "mm"),
            ("tolerance: gap that counts as zero", 1e3 * self.gap_tolerance, "mm"),
            ("tolerance: angle between the faces", LARGEST_ANGLE_DEG, "deg"),
        )

    def _node_to_node(self) -> FloatArray:
        pairs = self.pairs
        return np.asarray(
            (np.count_nonzero(pairs.first_weights, axis=1) == 1) & (np.count_nonzero(pairs.second_weights, axis=1) == 1)
        )


def write_pairs(path: str | Path, pairings: Sequence[Pairing]) -> Path:
    """Write pairs and unpaired points of interfaces as points of one .vtu file, for ParaView.

    Fields: ``interface`` (its number), ``side`` (1: first face, 2: second face), ``reason`` (0 paired; 1 beyond the
    edge, 2 farther than the search distance, 3 on sides that do not face each other, 4 round a sharp edge), ``gap mm``
    (NaN without an intersection), ``overhang mm``, ``area mm2``, ``normal``, and ``tangent 1`` (zero for unpaired
    points). Raises InputError for no pairings, another suffix, or a folder that cannot be written.
    """
    if not pairings:
        raise InputError("write_pairs has no pairings; give it at least one Pairing.")
    columns: dict[str, list[FloatArray]] = {}
    for number, pairing in enumerate(pairings):
        pairs = pairing.pairs
        paired = Unpaired(
            np.full(pairs.n_pairs, -1), pairs.points, pairs.normal, pairs.area,
            np.full(pairs.n_pairs, PAIRED), pairing.measured_gap, pairing.overhang,
        )  # fmt: skip
        for side, places in ((1, paired), (1, pairing.unpaired_first), (2, pairing.unpaired_second)):
            tangent = pairs.tangent1 if places is paired else np.zeros((len(places), 3))
            fields = {
                "points": places.points,
                "interface": np.full(len(places), number),
                "side": np.full(len(places), side),
                "reason": places.reason,
                "gap mm": np.where(np.isfinite(places.gap), 1e3 * places.gap, np.nan),
                "overhang mm": 1e3 * places.overhang,
                "area mm2": 1e6 * places.area,
                "normal": places.normal,
                "tangent 1": tangent,
            }
            for name, values in fields.items():
                columns.setdefault(name, []).append(values)
    joined = {name: np.concatenate(values) for name, values in columns.items()}
    return write_points(path, joined.pop("points"), joined)
