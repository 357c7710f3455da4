"""The structure for the solver: dense matrices, and the nodes of their unknowns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NoReturn, Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, skew_matrix, symmetric_matrix

# A mode is a body that moves freely if its strain energy is below this fraction of the energy of its displacements with
# neighbours in opposite directions. Round-off is 1e-16 of it, and 1e-12 after a reduction; the lowest bending mode of a
# solid beam 100 times as long as thick, with four elements across, has 1e-9.
RIGID_FRACTION = 1e-10
# chosen: part of the largest entry of a mode that counts as its round-off in other unknowns; eigensolvers leave 1e-14.
ROUND_OFF_PART = 1e-8
# chosen: rows of pairs that differ by less are the same; their entries are parts of unit vectors.
SAME_ROWS = 1e-9


class PairsOfNodes(Protocol):
    """Contact pairs between nodes of a mesh."""

    @property
    def nodes(self) -> NDArray[np.int64]:
        """(k,) the nodes of all pairs, each once."""

    def mesh_operator(self, n_nodes: int) -> Any:
        """csr (3 * n_pairs, 3 * n_nodes) rows t1, t2, n of each pair."""


@dataclass(frozen=True)
class Superelement:
    """Dense matrices of ``M u'' + (C + G) u' + K u = p`` in SI units.

    Parameters
    ----------
    mass, stiffness:
        (n, n), symmetric, kg and N/m in the unknowns' own scaling. Contact stiffness is not in ``stiffness``.
    damping:
        (n, n) N s/m, or None for no damping matrix (modal damping is then an argument of the solver).
    boundary_nodes:
        (n_boundary,) node numbers of the mesh whose displacements are unknowns; node ``boundary_nodes[i]`` owns the
        unknowns ``3*i, 3*i+1, 3*i+2`` (x, y, z). Empty for matrices of a user.
    recovery:
        ``recovery @ reduced`` are the displacements of the full mesh (3 per node, fixed ones zero): an (n_full, n)
        matrix, a :class:`stickslip.structure.recovery.Recovery`, or None.
    positions:
        (n_boundary, 3) m of the boundary nodes, or None.
    node_sets:
        name -> boundary nodes, with the names of the program that made the matrices.
    gyroscopic:
        (n, n) N s/m, skew-symmetric: G of the Coriolis forces in a rotating frame, which do no work, or None. The
        skew-symmetric part ``0.5 * (C - C.T)`` of a damping matrix without symmetry is such a matrix; its symmetric
        part ``0.5 * (C + C.T)`` is ``damping``.
    joint_rows:
        csr (m, 3 * n_nodes), the rows t1, t2, n of contact pairs on the displacements of the mesh whose relative
        displacements are the m unknowns after those of the boundary nodes
        (:mod:`stickslip.structure.relative_reduction`), or None.
    joint_operator:
        (m, n) relative displacements of the ``joint_rows`` from all unknowns, where these rows are not unknowns
        themselves (:mod:`stickslip.structure.partial_reduction`), or None.

    Raises
    ------
    InputError
        for a matrix that is not square, symmetric (skew-symmetric), finite, or not of the size of the mass matrix; for
        boundary nodes that own more unknowns than there are or come twice, positions of another shape, and
        sets with other nodes.
    """

    mass: FloatArray
    stiffness: FloatArray
    damping: FloatArray | None = None
    boundary_nodes: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    recovery: Any = None
    positions: FloatArray | None = None
    node_sets: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    gyroscopic: FloatArray | None = None
    joint_rows: Any = None
    joint_operator: FloatArray | None = None

    def __post_init__(self) -> None:
        mass = symmetric_matrix("mass", self.mass)
        for name in ("stiffness", "damping", "gyroscopic"):
            value = getattr(self, name)
            if value is None:
                continue
            matrix = (skew_matrix if name == "gyroscopic" else symmetric_matrix)(name, value)
            if matrix.shape != mass.shape:
                raise InputError(
                    f"{name} has shape {matrix.shape}, but mass has shape {mass.shape}; all matrices of one "
                    "superelement must have the same size.",
                    arguments=[name],
                )
            object.__setattr__(self, name, matrix)
        object.__setattr__(self, "mass", mass)
        self._require_nodes()

    def __repr__(self) -> str:
        nodes = self.boundary_nodes.size
        return (
            f"Superelement({self.size} unknowns: {nodes} boundary nodes and {self.size - 3 * nodes} other unknowns; "
            f"{'no ' if self.damping is None else ''}damping matrix{'' if self.gyroscopic is None else ', gyroscopic'})"
        )

    def _require_nodes(self) -> None:
        """Raise InputError where boundary nodes, positions and node sets do not fit together."""
        nodes = self.boundary_nodes
        if 3 * nodes.size > self.size:
            raise InputError(
                f"boundary_nodes has {nodes.size} nodes, which have {3 * nodes.size} unknowns, but the matrices have "
                f"{self.size}; each boundary node has three of them.",
                arguments=["boundary_nodes"],
            )
        unique, count = np.unique(nodes, return_counts=True)
        if (count > 1).any():
            raise InputError(
                f"boundary_nodes names node {unique[count.argmax()]} {count.max()} times; name it once.",
                arguments=["boundary_nodes"],
            )
        if self.positions is not None:
            positions = finite_array("positions", self.positions)
            if positions.shape != (nodes.size, 3):
                raise InputError(
                    f"positions must have shape ({nodes.size}, 3), x, y, z in m of each boundary node, but the shape "
                    f"is {positions.shape}.",
                    arguments=["positions"],
                )
            object.__setattr__(self, "positions", positions)
        for name, members in self.node_sets.items():
            unknown = np.setdiff1d(members, nodes)
            if unknown.size:
                raise InputError(
                    f"node set '{name}' names node {unknown[0]}, which is not one of the {nodes.size} boundary nodes "
                    f"({unknown.size} of {len(members)} are not)."
                )

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return int(self.mass.shape[0])

    @property
    def velocity_matrix(self) -> FloatArray:
        """(n, n) N s/m, the sum of the damping and the gyroscopic matrix; zero without both."""
        total = np.zeros_like(self.mass)
        for matrix in (self.damping, self.gyroscopic):
            if matrix is not None:
                total += matrix
        return total

    def unknowns_of(self, node: int) -> NDArray[np.int64]:
        """The three unknowns (x, y, z) of a boundary node with this number in the mesh. Raises InputError."""
        position = np.flatnonzero(self.boundary_nodes == node)
        if position.size != 1:
            raise InputError(
                f"node {node} is not one of the {self.boundary_nodes.size} boundary nodes.", arguments=["node"]
            )
        return np.asarray(3 * position[0] + np.arange(3), dtype=np.int64)

    @property
    def row_size(self) -> int:
        """Number n of entries of a row of an output or a pair."""
        return self.size

    def operator(self, pairs: PairsOfNodes) -> FloatArray:
        """(3 * n_pairs, n) rows t1, t2, n of pairs from the unknowns; n > 0 closes.

        Raises InputError when a node of a pair is not among the boundary nodes, and for other pairs than those whose
        relative displacements are unknowns.
        """
        if self.joint_rows is not None:
            return self._joint_operator(pairs)
        boundary, nodes = self.boundary_nodes, pairs.nodes
        missing = np.setdiff1d(nodes, boundary)
        if missing.size:
            raise InputError(
                f"node {missing[0]} of a contact pair is not a boundary node of the superelement ({missing.size} of "
                f"{nodes.size} are not); reduce again with FacePairs.nodes among the boundary_nodes."
            )
        full = pairs.mesh_operator(int(boundary.max()) + 1)
        matrix = np.zeros((full.shape[0], self.size))
        matrix[:, : 3 * len(boundary)] = full[:, (3 * boundary[:, None] + np.arange(3)).ravel()].toarray()
        return matrix

    @property
    def joint_unknowns(self) -> NDArray[np.int64]:
        """(m,) the unknowns that are relative displacements of contact pairs; empty in most superelements."""
        if self.joint_rows is None or self.joint_operator is not None:
            return np.empty(0, dtype=np.int64)
        return 3 * self.boundary_nodes.size + np.arange(self.joint_rows.shape[0])

    def _joint_operator(self, pairs: PairsOfNodes) -> FloatArray:
        """:meth:`operator` of the pairs whose relative displacements are unknowns."""
        n_nodes = self.joint_rows.shape[1] // 3
        rows = pairs.mesh_operator(n_nodes) if pairs.nodes.max() < n_nodes else None
        if rows is None or rows.shape != self.joint_rows.shape or abs(rows - self.joint_rows).max() > SAME_ROWS:
            raise InputError(
                f"the superelement contains the relative displacements of its own {self.joint_rows.shape[0] // 3} "
                "contact pairs, but these pairs differ from them; reduce again with these pairs.",
                arguments=["pairs"],
            )
        if self.joint_operator is not None:
            return self.joint_operator
        matrix = np.zeros((self.joint_unknowns.size, self.size))
        matrix[np.arange(len(matrix)), self.joint_unknowns] = 1.0
        return matrix

    @property
    def has_all_pairs(self) -> bool:
        """Whether each of its pairs has unknowns, so that it can be tied."""
        return self.joint_operator is None

    def with_rayleigh_damping(self, mass_factor: float, stiffness_factor: float) -> Superelement:
        """With the damping ``mass_factor M + stiffness_factor K`` (1/s and s) beside its own. Raises InputError for a
        factor below zero."""
        damping = rayleigh_damping_matrix(self, mass_factor, stiffness_factor)
        return replace(self, damping=damping if self.damping is None else damping + self.damping)

    def without_recovery(self) -> Superelement:
        """Without what only the motion of the mesh requires."""
        return replace(self, recovery=None)

    def mean_structure(self) -> Superelement:
        """This one: its motions that are constant in time have the same matrices."""
        return self

    def require_structure(self) -> Superelement:
        """This one: for analyses of single matrices."""
        return self

    def require_sector(self) -> NoReturn:
        """A superelement is not a sector of a disk: raises InputError."""
        raise InputError("a superelement is not a sector of a disk; give a CyclicSector.", arguments=["superelement"])

    def selector(self, node: int, direction: tuple[float, float, float] | FloatArray) -> FloatArray:
        """The row (n,) of the displacement of a boundary node along ``direction`` (unit vector x, y, z)."""
        row = np.zeros(self.size)
        row[self.unknowns_of(node)] = np.asarray(direction, dtype=float)
        return row


def require_no_gyroscopic(superelement: Superelement, analysis: str) -> None:
    """Raise InputError for a superelement with Coriolis forces, which an ``analysis`` or a format cannot contain."""
    if superelement.gyroscopic is not None:
        raise InputError(
            f"superelement has a gyroscopic matrix (Coriolis forces), which {analysis} does not contain. Use "
            "forced_response, or a superelement without it, such as that of at(speed_rpm, coriolis=False).",
            arguments=["superelement"],
        )


def moves_freely(stiffness: Any, modes: FloatArray) -> NDArray[np.bool_]:
    """(k,) whether modes (n, k) are without strain except for round-off: ``phi^T K phi <= 1e-10 |phi|^T |K| |phi|``.

    ``stiffness`` (n, n) may be sparse. The measure is relative to the stiffness of the unknowns of each mode: an
    elastic mode may have any low frequency, and a light free body may be beside stiff ones.
    """
    energy = np.abs((modes.conj() * (stiffness @ modes)).sum(axis=0))
    # Unknowns that a mode does not move contain round-off, whose energy is not below a fraction of itself.
    size = np.maximum(np.abs(modes), ROUND_OFF_PART * np.abs(modes).max(axis=0, initial=0.0))
    return np.asarray(energy <= RIGID_FRACTION * (size * (abs(stiffness) @ size)).sum(axis=0))


def require_moving(moving: NDArray[np.bool_], n_pairs: int) -> NDArray[np.bool_]:
    """The mask (n_pairs,) of pairs that move. Raises InputError for another shape or type."""
    mask = np.asarray(moving)
    if mask.shape != (n_pairs,) or mask.dtype != bool:
        raise InputError(
            f"moving must be an array of {n_pairs} True or False, one for each pair, but it has shape {mask.shape} and "
            f"type {mask.dtype}.",
            arguments=["moving"],
        )
    return mask


def require_rayleigh_factors(mass_factor: float, stiffness_factor: float) -> None:
    """Raise InputError unless both factors of ``mass_factor M + stiffness_factor K`` (1/s and s) are 0 or above."""
    factors = finite_array("Rayleigh damping factors", [mass_factor, stiffness_factor])
    if (factors < 0).any():
        raise InputError(
            f"Rayleigh damping factors must not be negative, but mass_factor is {mass_factor:g} 1/s and "
            f"stiffness_factor is {stiffness_factor:g} s.",
            arguments=["mass_factor", "stiffness_factor"],
        )


class MassAndStiffness(Protocol):
    """Matrices (n, n) of a structure, real or Hermitian."""

    @property
    def mass(self) -> NDArray[Any]: ...

    @property
    def stiffness(self) -> NDArray[Any]: ...


def rayleigh_damping_matrix(matrices: MassAndStiffness, mass_factor: float, stiffness_factor: float) -> NDArray[Any]:
    """``C = mass_factor M + stiffness_factor K`` (n, n) N s/m; the springs of the contact are not in K.

    ``mass_factor`` in 1/s and ``stiffness_factor`` in s, both not negative; InputError otherwise.
    """
    require_rayleigh_factors(mass_factor, stiffness_factor)
    return np.asarray(mass_factor * matrices.mass + stiffness_factor * matrices.stiffness)
