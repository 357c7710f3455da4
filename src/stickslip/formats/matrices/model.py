"""Large matrices that another program made, with the node and direction of each unknown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, finite_array
from stickslip.formats.matrices.checks import checked_matrix
from stickslip.structure.mesh import IntArray

DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz", "other")
OTHER = 6  # direction of an unknown that is no displacement or rotation


@dataclass(frozen=True)
class MatrixModel:
    """Sparse matrices of ``M u'' + C u' + K u = p`` in SI units; contact is not in them.

    Parameters
    ----------
    stiffness, mass:
        (n, n), N/m and kg for displacements; rotations are in rad, other unknowns keep their own scaling.
    damping:
        (n, n) N s/m, or None.
    node:
        (n,) node number of each unknown, as the source counts them; below 0 for unknowns without a node.
    direction:
        (n,) 0, 1, 2 displacement along x, y, z; 3, 4, 5 rotation about x, y, z; 6 anything else (mode amplitudes).
    node_labels, position:
        (k,) node numbers, and their positions (k, 3) m, or None.
    node_sets:
        name -> node numbers.
    messages:
        messages on changes to the matrices.

    Raises
    ------
    InputError
        for matrices that are not square, of one size, finite, symmetric (a single stored triangle is completed) and
        positive semidefinite, as far as cheap checks show; for an unknown that comes twice, an unknown without
        stiffness, a direction outside 0 to 6, and positions that are not (k, 3) or name a node twice.
    """

    stiffness: Any
    mass: Any
    damping: Any = None
    node: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    direction: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    node_labels: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    position: FloatArray | None = None
    node_sets: Mapping[str, IntArray] = field(default_factory=dict)
    messages: tuple[str, ...] = ()

    __repr__ = short_repr

    def __post_init__(self) -> None:
        messages = list(self.messages)
        size = int(np.shape(self.stiffness)[0]) if np.ndim(self.stiffness) else 0
        node, direction = self._unknowns(size)
        for name in ("stiffness", "mass", "damping"):
            value = getattr(self, name)
            if value is None and name == "damping":
                continue
            if np.shape(value) != (size, size):
                raise InputError(
                    f"{name} has shape {np.shape(value)}, but stiffness has {size} rows; all matrices of one model "
                    "must be square and have the same unknowns."
                )
            matrix, message = checked_matrix(name, value, node, direction)
            messages += [message] if message else []
            object.__setattr__(self, name, matrix)
        object.__setattr__(self, "messages", tuple(messages))
        self._require_positions()

    def _unknowns(self, size: int) -> tuple[IntArray, IntArray]:
        """Node and direction of each unknown after checking them; raises InputError."""
        node, direction = np.asarray(self.node), np.asarray(self.direction)
        if not node.size and not direction.size:
            # Without a map the name of an unknown is its index, without a direction.
            node, direction = np.arange(size), np.full(size, OTHER)
        for name, array in (("node", node), ("direction", direction)):
            if array.shape != (size,) or not np.issubdtype(array.dtype, np.integer):
                raise InputError(
                    f"{name} must contain {size} whole numbers, one for each row of stiffness, but its shape is "
                    f"{array.shape} and its type {array.dtype}."
                )
        bad = np.flatnonzero((direction < 0) | (direction > OTHER))
        if bad.size:
            raise InputError(f"direction[{bad[0]}] is {direction[bad[0]]}; it must be from 0 (x) to {OTHER} (other).")
        motion = direction != OTHER
        pairs, count = np.unique(np.column_stack([node, direction])[motion], axis=0, return_counts=True)
        if (count > 1).any():
            twice = pairs[count.argmax()]
            raise InputError(
                f"node {twice[0]} has direction {DIRECTIONS[twice[1]]} in {count.max()} rows; each unknown must occur "
                "once. Look for two maps in one file, or a map of other matrices."
            )
        object.__setattr__(self, "node", node.astype(np.int64))
        object.__setattr__(self, "direction", direction.astype(np.int64))
        return self.node, self.direction

    def _require_positions(self) -> None:
        if self.position is None:
            return
        position = finite_array("position", self.position)
        labels = np.asarray(self.node_labels, dtype=np.int64)
        if position.shape != (len(labels), 3) or len(np.unique(labels)) != len(labels):
            raise InputError(
                f"position must have shape ({len(labels)}, 3), x, y, z in m of each node in node_labels, and each node "
                f"must occur once, but its shape is {position.shape} for {len(np.unique(labels))} different nodes."
            )
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "node_labels", labels)

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return int(self.stiffness.shape[0])

    @property
    def free_unknowns(self) -> IntArray:
        """(n,) position of each unknown among the displacements: all are free."""
        return np.arange(self.size)

    @property
    def full_size(self) -> int:
        """Number of displacements that a recovery gives: all unknowns."""
        return self.size

    def unknowns_of(self, nodes: ArrayLike) -> IntArray:
        """(k, 3) unknowns x, y, z of nodes (k,); raises InputError for a node without all three."""
        wanted = np.asarray(nodes, dtype=np.int64).ravel()
        position = np.full((3, wanted.size), -1, dtype=np.int64)
        for axis in range(3):
            rows = np.flatnonzero(self.direction == axis)
            order = rows[np.argsort(self.node[rows])]
            at = np.searchsorted(self.node[order], wanted)
            there = at < order.size
            there[there] = self.node[order[at[there]]] == wanted[there]
            position[axis, there] = order[at[there]]
        missing = np.flatnonzero((position < 0).any(axis=0))
        if missing.size:
            node = wanted[missing[0]]
            has = ", ".join(DIRECTIONS[axis] for axis in self.direction[self.node == node]) or "no unknowns"
            raise InputError(
                f"node {node} must have unknowns along x, y and z, but it has {has} ({missing.size} of {wanted.size} "
                "nodes lack some). Contact, force and output nodes must be free in the source, and its unknown map "
                "must be given."
            )
        return position.T

    def expand(self, vectors: FloatArray) -> FloatArray:
        """Displacements (n, ...) from the unknowns (n, ...): they are equal, because none is constrained."""
        return vectors

    def gather(self, load: FloatArray) -> FloatArray:
        """Forces (n, ...) on the unknowns: they are equal, because none is constrained."""
        return load

    def positions_of(self, nodes: ArrayLike) -> FloatArray | None:
        """(k, 3) m of nodes, None without positions. Raises InputError for a missing node."""
        if self.position is None:
            return None
        wanted = np.asarray(nodes, dtype=np.int64)
        missing = np.setdiff1d(wanted, self.node_labels)
        if missing.size:
            raise InputError(
                f"the position of node {missing[0]} is not given ({missing.size} of {wanted.size} are not)."
            )
        order = np.argsort(self.node_labels)
        return self.position[order[np.searchsorted(self.node_labels, wanted, sorter=order)]]
