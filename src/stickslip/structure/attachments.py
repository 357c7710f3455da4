"""Mass points and springs at nodes of a mesh, and at reference nodes that its ties and couplings move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.constraints import Constraints
from stickslip.structure.elasticity import Structure
from stickslip.structure.equations import Key
from stickslip.structure.mesh import IntArray

_MOST_ENTRIES = 20_000_000  # chosen: of the mass and stiffness of reference nodes, 0.3 GB each


@dataclass(frozen=True)
class Attachments:
    """Mass points and springs that a model adds to the matrices of its solids.

    Parameters
    ----------
    masses:
        (n_nodes,) kg of each node, the same in all directions.
    springs:
        (k, 2) unknowns that each spring connects: indices among the 3 * n_nodes displacements, from there on among
        ``further``; the second one is -1 for the ground.
    stiffnesses:
        (k,) N/m, for rotations N m/rad.
    further:
        (label, direction) of displacements 0 to 2 and rotations 3 to 5 of reference nodes.
    further_mass:
        (f, f) mass matrix of ``further``: kg, kg m and kg m2.
    """

    masses: FloatArray
    springs: IntArray
    stiffnesses: FloatArray
    further: tuple[Key, ...] = ()
    further_mass: FloatArray = field(default_factory=lambda: np.empty((0, 0)))

    @property
    def size(self) -> int:
        """Number of displacements of the mesh."""
        return 3 * len(self.masses)

    @property
    def reference_mass(self) -> float:
        """kg at reference nodes."""
        along_x = [place for place, (_, direction) in enumerate(self.further) if direction == 0]
        return float(self.further_mass.diagonal()[along_x].sum())

    def supports(self, fixed_unknowns: IntArray, constraints: Constraints | None) -> tuple[IntArray, Any]:
        """Displacements of the mesh that constraints or springs support, and csr (k, size) rows of the further unknowns
        with a spring to the ground, None without any."""
        constrained = np.unique(self.springs[self.springs[:, 1] < 0, 0])
        supported = np.union1d(fixed_unknowns, constrained[constrained < self.size]).astype(np.int64)
        of_references = constrained[constrained >= self.size] - self.size
        if constraints is None or not of_references.size:
            return supported, None
        return supported, self.further_rows(constraints)[of_references]

    def further_rows(self, constraints: Constraints) -> Any:
        """csr (f, size) of ``further`` from independent displacements of the mesh.

        Raises InputError for an unknown with a mass or a spring that neither the mesh moves nor a constraint fixes.
        """
        used = np.zeros(len(self.further), dtype=bool)
        used[self.springs[self.springs >= self.size] - self.size] = True
        used |= self.further_mass.any(axis=0)
        rows = []
        for key, is_used in zip(self.further, used, strict=True):
            row = constraints.further.get(key, -1)
            if is_used and row < 0:
                label, direction = key
                raise InputError(
                    f"the reference node {label} has a mass or a spring along direction {direction + 1}, but its "
                    "coupling does not move it there. Couple all six directions to nodes of a face, or remove it."
                )
            rows.append(row)
        at = np.array(rows, dtype=np.int64)
        chosen = scipy.sparse.csr_matrix(
            (np.ones((at >= 0).sum()), (np.flatnonzero(at >= 0), at[at >= 0])),
            shape=(len(at), constraints.reference.shape[0]),
        )
        return chosen @ constraints.reference

    def translation_inertia(self, constraints: Constraints | None) -> FloatArray | float:
        """(size, 3) kg: ``M r`` of the reference nodes for translations r by 1 along x, y, z; 0 without any."""
        if constraints is None or not self.further:
            return 0.0
        moved = np.array([[float(direction == axis) for axis in range(3)] for _, direction in self.further])
        return np.asarray(self.further_rows(constraints).T @ (self.further_mass @ moved))

    def sizes(self) -> Iterator[tuple[str, str]]:
        """Number and sum of mass points and springs, for a summary of the structure."""
        heavy = np.count_nonzero(self.masses)
        if heavy:
            yield "mass points", f"{heavy} nodes, {self.masses.sum():.4g} kg"
        nodes = {label for label, _ in self.further}
        if self.further_mass.any():
            yield "mass points at reference nodes", f"{len(nodes)} nodes, {self.reference_mass:.4g} kg"
        if len(self.springs):
            to_ground = int((self.springs[:, 1] < 0).sum())
            yield "springs", f"{to_ground} to the ground, {len(self.springs) - to_ground} between nodes"


def attach(structure: Structure, attachments: Attachments | None) -> Structure:
    """The structure with ``M + E^T m E`` and ``K + sum k (e_a - e_b)(e_a - e_b)^T`` in its independent unknowns.

    ``E`` are the displacements of the mesh and the further unknowns of reference nodes. Raises InputError for a
    reference node that the mesh does not move, and for one that too many nodes move.
    """
    if attachments is None:
        return structure
    size, count = structure.full_size, len(attachments.springs)
    unknowns = structure.of_unknowns(scipy.sparse.eye(size, format="csr"))
    if attachments.further and structure.constraints is not None:
        further = attachments.further_rows(structure.constraints)
        _require_few(attachments.further, further)
        unknowns = scipy.sparse.vstack([unknowns, structure.of_unknowns(further)]).tocsr()
    first, second = attachments.springs.T
    row = np.arange(count)
    between = second >= 0
    signs = scipy.sparse.csr_matrix(
        (
            np.concatenate([np.ones(count), -np.ones(between.sum())]),
            (np.concatenate([row, row[between]]), np.concatenate([first, second[between]])),
        ),
        shape=(count, unknowns.shape[0]),
    )
    springs = signs @ unknowns
    masses = scipy.sparse.block_diag(
        [scipy.sparse.diags(np.repeat(attachments.masses, 3)), attachments.further_mass], format="csr"
    )
    stiffness = springs.T @ scipy.sparse.diags(attachments.stiffnesses) @ springs
    mass = unknowns.T @ masses @ unknowns
    return replace(
        structure,
        stiffness=(structure.stiffness + stiffness).tocsr(),
        mass=(structure.mass + mass).tocsr(),
    )


def _require_few(keys: Sequence[Key], rows: Any) -> None:
    """Raise InputError for a reference node whose mass would fill too much of the matrices."""
    for key, count in zip(keys, np.diff(rows.indptr), strict=True):
        if int(count) ** 2 > _MOST_ENTRIES:
            raise InputError(
                f"the reference node {key[0]} has a mass or a spring and follows {count} displacements, which would "
                f"fill {int(count) ** 2} entries of the matrices. At most {_MOST_ENTRIES} are possible: couple it to "
                "fewer nodes, or make the coupling rigid."
            )
