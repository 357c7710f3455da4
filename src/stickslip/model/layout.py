"""The objects of a study on its structure: the same few data for every kind of structure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from stickslip.contact.pairing.pairing import FacePairs
from stickslip.core.plausible import OddValue
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import BaseMotion
from stickslip.structure.elasticity import Material, Structure
from stickslip.structure.mesh import IntArray
from stickslip.structure.rotating import RotatingBodies
from stickslip.structure.sector_structure import SectorStructure
from stickslip.structure.superelement import Superelement

AnyStructure = Structure | RotatingBodies | Superelement | SectorStructure
Direction = tuple[float, float, float]
Derived = tuple[str, str | float | int, str, str]


@dataclass(frozen=True)
class NodeGroup:
    """Nodes (k,) of a force or a displacement output, and the weight of each (k,); the weights sum to 1.

    The weights distribute a force over the nodes, and a displacement is the weighted mean. In a reduction a single node
    keeps its displacements, without approximation by modes; several nodes are projected on the reduced basis
    (:meth:`stickslip.structure.recovery.Recovery.project`).

    A dependent node or a reference node has ``blocks`` (k, 3, 3) instead: its displacement is ``sum blocks @ u`` of the
    nodes that it follows, ``position`` (3,) m is its own, and ``weights`` are the mean of the diagonal of each block.
    """

    nodes: IntArray
    weights: FloatArray
    blocks: FloatArray | None = None
    position: FloatArray | None = None

    @classmethod
    def single(cls, node: int) -> NodeGroup:
        """The group of one node."""
        return cls(np.array([node], dtype=np.int64), np.ones(1))

    @classmethod
    def equal(cls, nodes: IntArray) -> NodeGroup:
        """A group with equal weights."""
        return cls(nodes, np.full(nodes.size, 1.0 / nodes.size))

    @classmethod
    def following(cls, rows: Any, position: FloatArray) -> NodeGroup:
        """A node whose displacement x, y, z is ``rows @ u``, csr (3, 3 * n_nodes) of independent displacements."""
        entries = rows.tocoo()
        nodes, place = np.unique(entries.col // 3, return_inverse=True)
        blocks = np.zeros((nodes.size, 3, 3))
        blocks[place, entries.row, entries.col % 3] = entries.data
        return cls(nodes.astype(np.int64), np.einsum("kaa->k", blocks) / 3.0, blocks, position)

    @property
    def is_single(self) -> bool:
        """Whether it is one independent node."""
        return bool(self.nodes.size == 1) and self.blocks is None

    def unit_loads(self, size: int) -> FloatArray:
        """(size, 3) N of a force of 1 N along x, y, z on all displacements; the transpose gives its displacement."""
        loads = np.zeros((size, 3))
        for axis in range(3):
            if self.blocks is None:
                loads[3 * self.nodes + axis, axis] = self.weights
                continue
            for column in range(3):
                loads[3 * self.nodes + column, axis] = self.blocks[:, axis, column]
        return loads

    def mean_place(self, points: FloatArray) -> FloatArray:
        """(3,) m of the group on a mesh with ``points`` (n, 3)."""
        return np.asarray(self.weights @ points[self.nodes]) if self.position is None else self.position

    def mean_of(self, vectors: FloatArray) -> FloatArray:
        """(3, ...) the displacement of the group from those of the nodes (n, 3, ...)."""
        if self.blocks is None:
            return np.asarray(np.tensordot(self.weights, vectors[self.nodes], 1))
        return np.asarray(np.einsum("kab,kb...->a...", self.blocks, vectors[self.nodes]))


@dataclass(frozen=True)
class Layout:
    """Joints and node groups of a study on its structure.

    Parameters
    ----------
    face_pairs:
        contact pairs of all faces, in the order of the faces.
    face_names:
        name of each face in reports.
    face_materials:
        (first, second) material of each face; the roughness law needs both.
    node_groups:
        name -> nodes of a force or a response.
    unit_loads:
        section of a distributed static load -> (3 * n_nodes, k) N of the whole mesh for each unit of its sizes: a
        rotation of 1 rad/s, a gravity of 1 m/s2 along x, y, z, a pressure of 1 Pa.
    base_inertia:
        (3 * n_nodes, 3) kg, the force on the whole mesh that resists an acceleration of 1 m/s2 along x, y, z, or None
        where the support does not move.
    facts:
        (name, value, unit, explanation) of the layout.
    messages:
        warnings for the user: what the model lacks, suspicious values.
    body_names:
        names of the bodies of the mesh, empty where there is none.
    contact_sets:
        for each face its sets in the mesh: two, or one with the ground; empty without a mesh.
    odd_values:
        values of the structure that only a wrong unit explains.
    line_width:
        m, of the strip that each contact line stands for; None where the bodies touch on faces.
    file_numbers:
        (n_nodes,) and (n_cells,) numbers of nodes and cells in the mesh file; None without a file.
    blade_nodes:
        nodes of the blade of a sector beyond its root, whose frequencies differ in a mistuned disk; None for any other.
    notes:
        what was read from a model file and assumed about it.
    """

    face_pairs: FacePairs
    face_names: tuple[str, ...]
    face_materials: tuple[tuple[Material, Material], ...]
    node_groups: Mapping[str, NodeGroup]
    unit_loads: Mapping[str, FloatArray] = field(default_factory=dict)
    base_inertia: FloatArray | None = None
    facts: tuple[Derived, ...] = ()
    messages: tuple[str, ...] = ()
    body_names: tuple[str, ...] = ()
    contact_sets: tuple[tuple[str, ...], ...] = ()
    odd_values: tuple[OddValue, ...] = ()
    line_width: float | None = None
    file_numbers: tuple[IntArray, IntArray] | None = None
    blade_nodes: IntArray | None = None
    notes: tuple[str, ...] = ()

    @cached_property
    def boundary_nodes(self) -> IntArray:
        """Nodes that keep their displacements in a reduction: those of contact pairs, and of groups of one node."""
        return np.union1d(self.face_pairs.nodes, self.single_nodes).astype(np.int64)

    @cached_property
    def single_nodes(self) -> IntArray:
        """(k,) nodes of groups of one node, each once and in order."""
        single = [node_group.nodes for node_group in self.node_groups.values() if node_group.is_single]
        return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *single])).astype(np.int64)

    def most_unknowns(self, n_modes: int) -> int:
        """Of a reduction of a mesh to the boundary nodes and ``n_modes`` modes; one to relative motion has fewer."""
        return 3 * self.boundary_nodes.size + n_modes

    def distributed_forces(self, sizes: Mapping[str, tuple[float, ...]]) -> dict[str, FloatArray]:
        """Section -> (n_nodes, 3) N of each distributed static load, from section -> its sizes (k,)."""
        return {section: (self.unit_loads[section] @ np.array(size)).reshape(-1, 3) for section, size in sizes.items()}


class Setup(Protocol):
    """A structure before its matrices are made, with the layout of its study; a plain object that can be pickled."""

    @property
    def layout(self) -> Layout: ...

    def assemble(self) -> AnyStructure:
        """The matrices; for small matrices a superelement. Raises InputError."""

    def most_unknowns(self, n_modes: int) -> int:
        """The number of unknowns that a reduction with ``n_modes`` modes does not exceed."""

    def sizes(self) -> tuple[tuple[str, str], ...]:
        """(name, value) rows on the size of the model."""

    def write_places(self, folder: Path) -> tuple[Path, ...]:
        """Write the positions of the joints for ParaView; returns the files. Raises InputError."""


@dataclass(frozen=True)
class GroupForce:
    """A force of ``amplitude`` N along a unit vector on a node group; a harmonic one times ``sin(harmonic w t +
    phase)``."""

    node_group: str
    direction: Direction
    amplitude: float
    phase: float = 0.0
    harmonic: int = 1


@dataclass(frozen=True)
class GroupUnbalance:
    """A rotating unbalance of ``mass_times_radius`` kg m at a node group; it turns to the right about a unit vector."""

    node_group: str
    axis: Direction
    mass_times_radius: float

    @property
    def turning(self) -> tuple[FloatArray, FloatArray]:
        """(3,) unit vectors across the axis: the direction of the unbalance at t = 0, and a quarter of a turn later.

        The first is the global axis x, y or z that is most across, without its part along the axis.
        """
        axis = np.asarray(self.axis)
        first = np.eye(3)[np.abs(axis).argmin()]
        first = first - (first @ axis) * axis
        first /= np.linalg.norm(first)
        return first, np.cross(axis, first)


@dataclass(frozen=True)
class BaseMotionOfSupport:
    """All constrained nodes move by ``amplitude cos(w t)``, m/s2 or m, along a unit vector."""

    direction: Direction
    amplitude: float
    kind: BaseMotion


@dataclass(frozen=True)
class Output:
    """The displacement of a node group along a unit vector."""

    node_group: str
    direction: Direction
