"""Where the picture of a structure shows each load: forces at their nodes, distributed loads by their resultants."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.model.layout import GroupForce, Layout, NodeGroup

# chosen: below this fraction of its parts a resultant says little, as of the pressure in a bore or of a rotating disk
_CANCELLED = 0.1
_LEVEL = 0.01  # chosen: of the size of what is loaded; nodes of a flat face count as level


@dataclass(frozen=True)
class LoadMark:
    """The arrow of a load: the user's name, its nodes, its vector (3,) N, and whether it is constant."""

    name: str
    group: NodeGroup
    vector: FloatArray
    is_constant: bool


def force_marks(layout: Layout, forces: tuple[GroupForce, ...], is_constant: bool) -> Iterator[LoadMark]:
    """The arrows of forces at node groups of the layout; those of 0 N have none."""
    for force in forces:
        if force.amplitude != 0.0:
            vector = np.multiply(force.amplitude, force.direction)
            yield LoadMark(_name_of(force.node_group), layout.node_groups[force.node_group], vector, is_constant)


def distributed_marks(loads: Mapping[str, FloatArray], points: FloatArray) -> Iterator[LoadMark]:
    """The arrows of distributed loads, section -> (n_nodes, 3) N, on nodes at ``points`` (n_nodes, 3) m.

    Each shows the resultant, at the loaded node that comes first along it, because the middle of a body is hidden.

    Where the parts cancel each other (both sides of a clamped stack, a bore), the forces towards +x, -x, +y, ... have
    an arrow each.
    """
    for section, forces in loads.items():
        name, sizes = section.partition(".")[2] or section, np.linalg.norm(forces, axis=1)
        parts = [forces]
        if np.linalg.norm(forces.sum(axis=0)) < _CANCELLED * sizes.sum():
            axis = np.abs(forces).argmax(axis=1)
            towards = 2 * axis + (np.take_along_axis(forces, axis[:, None], axis=1)[:, 0] < 0.0)
            parts = [np.where((towards == each)[:, None], forces, 0.0) for each in range(6)]
        for part in parts:
            if np.linalg.norm(part, axis=1).sum() > _CANCELLED * sizes.sum():
                yield LoadMark(name, NodeGroup.single(_first_node(part, points)), part.sum(axis=0), True)


def _first_node(forces: FloatArray, points: FloatArray) -> int:
    """The loaded node that is first along the resultant; of several, the one nearest to the middle of the forces."""
    size, along = np.linalg.norm(forces, axis=1), forces.sum(axis=0)
    loaded = np.flatnonzero(size)
    depth = points[loaded] @ along / np.linalg.norm(along)
    level = _LEVEL * float(np.linalg.norm(np.ptp(points[loaded], axis=0)))
    first = loaded[depth <= depth.min() + level]
    middle = size @ points / size.sum()
    return int(first[np.linalg.norm(points[first] - middle, axis=1).argmin()])


def _name_of(node_group: str) -> str:
    """The user's name of a load, or the name of a node group of the two blades in words."""
    return node_group.partition(".")[2] or node_group.replace("_", " ")
