"""Ties, rigid bodies, couplings and equations of a model file, by node labels, in its own units."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.cell_kinds import IntArray

# Directions 0, 1, 2 are displacements along x, y, z, and 3, 4, 5 rotations about them.
Term = tuple[int, int, float]  # label, direction, coefficient


@dataclass(frozen=True)
class RawEquation:
    """``sum coefficient * displacement = 0`` in basic directions; the first term is dependent unless ``is_free``."""

    what: str
    terms: tuple[Term, ...]
    line: int
    is_free: bool = False

    def scaled(self, factor: float) -> RawEquation:
        """A homogeneous equation remains the same."""
        return self


@dataclass(frozen=True)
class RawRigid:
    """Nodes (k,) that follow the reference node as a rigid body along ``directions`` 0 to 5.

    ``rotation`` is the label of a node whose displacements are the rotations, or None. With ``face`` the nodes are
    those of this face set.
    """

    what: str
    reference: int
    nodes: IntArray
    directions: tuple[int, ...]
    line: int
    rotation: int | None = None
    face: str = ""


@dataclass(frozen=True)
class RawDistributing:
    """A reference node that follows the weighted mean of nodes (k,), along ``directions`` 0 to 5.

    ``weights`` (k,), or None: the area of each node in the face set ``face``, or equal ones.
    """

    what: str
    reference: int
    nodes: IntArray
    directions: tuple[int, ...]
    line: int
    weights: FloatArray | None = None
    face: str = ""


@dataclass(frozen=True)
class RawTie:
    """Nodes of the set ``dependent`` that follow the face set ``independent``; ``tolerance`` None: the default."""

    what: str
    dependent: str
    independent: str
    tolerance: float | None
    line: int


@dataclass
class RawTies:
    """All ties of a file. ``frames`` are the directions 1, 2, 3 (3, 3) of nodes that have their own, as rows."""

    equations: list[RawEquation] = field(default_factory=list)
    rigid: list[RawRigid] = field(default_factory=list)
    distributing: list[RawDistributing] = field(default_factory=list)
    faces: list[RawTie] = field(default_factory=list)

    def any(self) -> bool:
        """Whether there is one."""
        return bool(self.equations or self.rigid or self.distributing or self.faces)


def basic_terms(frames: Mapping[int, FloatArray], label: int, direction: int, coefficient: float) -> Iterator[Term]:
    """A term along a direction of a node in basic directions."""
    frame = frames.get(label)
    if frame is None:
        yield label, direction, coefficient
        return
    first = 3 * (direction // 3)
    for axis, share in enumerate(frame[direction - first].tolist()):
        if share != 0.0:
            yield label, first + axis, coefficient * share


def combined(terms: Iterable[Term]) -> tuple[Term, ...]:
    """Terms with those of the same displacement added, in their order, without zeros."""
    total: dict[tuple[int, int], float] = {}
    for label, direction, coefficient in terms:
        total[label, direction] = total.get((label, direction), 0.0) + coefficient
    return tuple((label, direction, value) for (label, direction), value in total.items() if value != 0.0)


def linearised(what: str, rows: list[list[tuple[int, FloatArray]]], line: int) -> Iterator[RawEquation]:
    """Equations ``sum gradient . u = 0`` from the gradients (3,) of conditions on nodes by label."""
    for row in rows:
        terms = combined(
            (label, axis, float(gradient[axis])) for label, gradient in row for axis in np.argsort(-np.abs(gradient))
        )
        if terms:
            yield RawEquation(what, terms, line)


def equal_distance(first: int, second: int, arm: FloatArray) -> list[list[tuple[int, FloatArray]]]:
    """Condition that two nodes, the first at ``arm`` (3,) from the second, remain at their distance."""
    return [[(first, arm), (second, -arm)]]


def one_plane(labels: list[int], places: FloatArray) -> list[list[tuple[int, FloatArray]]]:
    """Conditions that nodes remain in the plane of the first three: ``(x - a) . ((b - a) x (c - a)) = 0``."""
    a, b, c = places[:3]
    rows = []
    for label, place in zip(labels[3:], places[3:], strict=True):
        arm = place - a
        of_b, of_c, of_node = np.cross(c - a, arm), np.cross(arm, b - a), np.cross(b - a, c - a)
        rows.append([(label, of_node), (labels[0], -(of_b + of_c + of_node)), (labels[1], of_b), (labels[2], of_c)])
    return rows


def one_line(labels: list[int], places: FloatArray) -> list[list[tuple[int, FloatArray]]]:
    """Conditions that nodes remain on the line of the first two: two components of ``(x - a) x (b - a) = 0``."""
    along = places[1] - places[0]
    rows = []
    for label, place in zip(labels[2:], places[2:], strict=True):
        arm = place - places[0]
        for axis in np.argsort(np.abs(along))[:2]:
            unit = np.eye(3)[axis]
            of_node, of_b = np.cross(along, unit), -np.cross(arm, unit)
            rows.append([(label, of_node), (labels[0], -(of_node + of_b)), (labels[1], of_b)])
    return rows
