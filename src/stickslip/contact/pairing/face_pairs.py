"""Contact pairs of one or more faces: positions, areas, directions and relative motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, positive_number, require_positive
from stickslip.structure.mesh import IntArray
from stickslip.structure.superelement import Superelement

_ROUND_OFF = 1e-9  # allowed error of sums of weights and products of unit vectors


@dataclass(frozen=True)
class FacePairs:
    """Contact pairs of one or more faces; each side of a pair is a node, a point among nodes, or the ground.

    The normal of a pair points out of the first body (the damper) towards the second (a blade). Relative displacement
    is that of the first against the second body, so a first body that moves along its outward normal closes the pair:
    ``n = normal . (u_first - u_second) > 0`` closes, with ``u = sum of weight * u of the nodes``.

    Parameters
    ----------
    first_nodes, first_weights:
        (n_pairs, a) node numbers and weights. The weights of a pair sum to 1; a node itself has one weight of 1. An
        entry of weight 0 only fills the row; its node number has no meaning.
    second_nodes, second_weights:
        (n_pairs, b) the same of the second body; all weights of a pair are 0 where its partner is the rigid ground.
    gap:
        (n_pairs,) m along the normal before any load: above 0 open, 0 in contact, below 0 the bodies overlap.
    points:
        (n_pairs, 3) m, on the first body.
    area:
        (n_pairs,) m2, the part of the face that each pair represents.
    normal:
        (n_pairs, 3) unit vectors out of the first body.
    tangent1, tangent2:
        (n_pairs, 3) unit vectors in the face: up the slope (along z, or along x on a face that looks along z) unless
        chosen, and across it. Mirrored faces have mirrored tangents, so they need not form a right-handed set with the
        normal.
    face:
        (n_pairs,) number of the face.
    face_position:
        (n_pairs, 2) m along tangent1 and tangent2 from the middle of the face's box, for maps.

    Raises
    ------
    InputError
        for arrays whose shapes do not fit, weights that do not sum to 1 (or to 0 on the ground), an area that is not
        above 0, and directions that are not unit vectors at right angles.
    """

    first_nodes: IntArray
    first_weights: FloatArray
    second_nodes: IntArray
    second_weights: FloatArray
    gap: FloatArray
    points: FloatArray
    area: FloatArray
    normal: FloatArray
    tangent1: FloatArray
    tangent2: FloatArray
    face: IntArray
    face_position: FloatArray

    def __post_init__(self) -> None:
        n_pairs = self.n_pairs
        for name, shape in (
            ("gap", (n_pairs,)), ("points", (n_pairs, 3)), ("area", (n_pairs,)), ("normal", (n_pairs, 3)),
            ("tangent1", (n_pairs, 3)), ("tangent2", (n_pairs, 3)), ("face", (n_pairs,)),
            ("face_position", (n_pairs, 2)),
        ):  # fmt: skip
            if finite_array(name, getattr(self, name)).shape != shape:
                raise InputError(
                    f"{name} must have shape {shape}, but its shape is {np.shape(getattr(self, name))}.",
                    arguments=[name],
                )
        require_positive("area", self.area, "It is the area of the face in m2 that a pair represents.")
        self._require_weights()
        directions = self._directions()
        product = directions @ directions.swapaxes(1, 2)
        if np.abs(product - np.eye(3)).max(initial=0.0) > _ROUND_OFF:
            raise InputError(
                "normal, tangent1 and tangent2 of each pair must be unit vectors at right angles.",
                arguments=["normal", "tangent1", "tangent2"],
            )

    def _require_weights(self) -> None:
        for side, sums in (("first", (1.0,)), ("second", (0.0, 1.0))):
            nodes, weights = getattr(self, f"{side}_nodes"), finite_array(f"{side}_weights", self._weights(side))
            if weights.ndim != 2 or len(weights) != self.n_pairs or np.shape(nodes) != weights.shape:
                raise InputError(
                    f"{side}_nodes and {side}_weights must both have shape ({self.n_pairs}, k), the nodes of each pair "
                    f"and their weights, but their shapes are {np.shape(nodes)} and {weights.shape}.",
                    arguments=[f"{side}_nodes", f"{side}_weights"],
                )
            total = weights.sum(axis=1)
            wrong = np.flatnonzero(np.min([np.abs(total - allowed) for allowed in sums], axis=0) > _ROUND_OFF)
            if wrong.size:
                allowed = " or, on the ground, 0" if side == "second" else ""
                raise InputError(
                    f"{side}_weights of pair {wrong[0]} sum to {total[wrong[0]]:g}; they must sum to 1{allowed}.",
                    arguments=[f"{side}_weights"],
                )

    def _weights(self, side: str) -> FloatArray:
        return np.asarray(getattr(self, f"{side}_weights"))

    def _directions(self) -> FloatArray:
        """(n_pairs, 3, 3) rows t1, t2, n."""
        return np.stack([self.tangent1, self.tangent2, self.normal], axis=1)

    @property
    def n_pairs(self) -> int:
        """Number of pairs."""
        return len(self.area)

    @property
    def is_matching(self) -> bool:
        """Whether every pair joins one node to one node."""
        return all((np.count_nonzero(self._weights(side), axis=1) == 1).all() for side in ("first", "second"))

    @property
    def first_node(self) -> IntArray:
        """(n_pairs,) the node of the first body. Raises InputError where it is a point among several nodes."""
        return self._single("first")

    @property
    def second_node(self) -> IntArray:
        """(n_pairs,) the node of the second body. Raises InputError where there is not exactly one."""
        return self._single("second")

    def _single(self, side: str) -> IntArray:
        used = np.count_nonzero(self._weights(side), axis=1)
        other = np.flatnonzero(used != 1)
        if other.size:
            what = "the rigid ground" if used[other[0]] == 0 else f"a point among {used[other[0]]} nodes"
            raise InputError(
                f"the {side} side of contact pair {other[0]} is {what}, not one node ({other.size} of {self.n_pairs} "
                f"pairs are like this); use {side}_nodes with {side}_weights."
            )
        column = np.abs(self._weights(side)).argmax(axis=1)
        return np.asarray(getattr(self, f"{side}_nodes")[np.arange(self.n_pairs), column])

    @property
    def nodes(self) -> IntArray:
        """(k,) the nodes of all pairs, each once and in order: the contact part of a boundary set."""
        used = [getattr(self, f"{side}_nodes")[self._weights(side) != 0.0] for side in ("first", "second")]
        return np.unique(np.concatenate(used)).astype(np.int64)

    def subset(self, chosen: NDArray[np.bool_]) -> FacePairs:
        """The pairs of a mask (n_pairs,), with the same numbers of faces."""
        return FacePairs(*(getattr(self, item.name)[chosen] for item in fields(FacePairs)))

    @staticmethod
    def concatenate(parts: Sequence[FacePairs]) -> FacePairs:
        """Pairs of several faces in one object; face numbers continue from part to part. Raises InputError if empty."""
        if not parts:
            raise InputError("FacePairs.concatenate has no faces; give it at least one FacePairs.")
        wide = {side: max(part._weights(side).shape[1] for part in parts) for side in ("first", "second")}
        renumbered = []
        n_faces = 0
        for part in parts:
            renumbered.append(replace(part._widened(**wide), face=part.face + n_faces))
            n_faces += int(part.face.max()) + 1
        return FacePairs(
            *(np.concatenate([getattr(part, item.name) for part in renumbered]) for item in fields(FacePairs))
        )

    def _widened(self, first: int, second: int) -> FacePairs:
        """The same pairs with rows of nodes filled up to these widths by entries of weight 0."""
        rows = {}
        for side, width in (("first", first), ("second", second)):
            for name in (f"{side}_nodes", f"{side}_weights"):
                array = getattr(self, name)
                rows[name] = np.pad(array, ((0, 0), (0, width - array.shape[1])))
        return replace(self, **rows)

    def mesh_operator(self, n_nodes: int) -> Any:
        """csr (3 * n_pairs, 3 * n_nodes): rows t1, t2, n of each pair from the displacements of the full mesh."""
        directions = self._directions()

        def part(nodes: IntArray, weights: FloatArray) -> Any:
            pair, column = np.nonzero(weights)
            rows = np.broadcast_to((3 * pair[:, None] + np.arange(3))[:, :, None], (len(pair), 3, 3))
            columns = np.broadcast_to((3 * nodes[pair, column][:, None] + np.arange(3))[:, None, :], rows.shape)
            entries = weights[pair, column][:, None, None] * directions[pair]
            shape = (3 * self.n_pairs, 3 * n_nodes)
            return scipy.sparse.csr_matrix((entries.ravel(), (rows.ravel(), columns.ravel())), shape=shape)

        return part(self.first_nodes, self.first_weights) - part(self.second_nodes, self.second_weights)

    def operator(self, superelement: Superelement) -> FloatArray:
        """(3 * n_pairs, n) rows t1, t2, n of each pair from the unknowns of a superelement; n > 0 closes.

        Raises InputError when a node of a pair is not among ``superelement.boundary_nodes``.
        """
        return superelement.operator(self)

    def springs(self, normal_per_area: float, tangential_per_area: float) -> FloatArray:
        """(3 * n_pairs,) N/m, t1, t2, n of each pair, from stiffness per area in N/m3. Raises InputError below 0."""
        for name, value in (("normal_per_area", normal_per_area), ("tangential_per_area", tangential_per_area)):
            positive_number(name, value, "N/m3: it is a stiffness per area")
        return np.outer(self.area, [tangential_per_area, tangential_per_area, normal_per_area]).ravel()
