"""Mass points and springs at nodes of a mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse

from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Structure
from stickslip.structure.mesh import IntArray


@dataclass(frozen=True)
class Attachments:
    """Mass points and springs that a model adds to the matrices of its solids.

    Parameters
    ----------
    masses:
        (n_nodes,) kg of each node, the same in all directions.
    springs:
        (k, 2) indices among the 3 * n_nodes displacements that each spring connects; the second one is -1 for the
        ground.
    stiffnesses:
        (k,) N/m.
    """

    masses: FloatArray
    springs: IntArray
    stiffnesses: FloatArray

    @property
    def grounded(self) -> IntArray:
        """The displacements with a spring to the ground."""
        return np.unique(self.springs[self.springs[:, 1] < 0, 0])

    def sizes(self) -> tuple[tuple[str, str], ...]:
        """Number and sum of mass points and springs, for a summary of the structure."""
        heavy = np.count_nonzero(self.masses)
        rows = []
        if heavy:
            rows.append(("mass points", f"{heavy} nodes, {self.masses.sum():.4g} kg"))
        if len(self.springs):
            to_ground = int((self.springs[:, 1] < 0).sum())
            rows.append(("springs", f"{to_ground} to the ground, {len(self.springs) - to_ground} between nodes"))
        return tuple(rows)


def attach(structure: Structure, attachments: Attachments | None) -> Structure:
    """The structure with ``M + sum m e e^T`` and ``K + sum k (e_a - e_b)(e_a - e_b)^T`` in its independent unknowns."""
    if attachments is None:
        return structure
    size = structure.full_size
    count = len(attachments.springs)
    first, second = attachments.springs.T
    row = np.arange(count)
    between = second >= 0
    signs = scipy.sparse.csr_matrix(
        (
            np.concatenate([np.ones(count), -np.ones(between.sum())]),
            (np.concatenate([row, row[between]]), np.concatenate([first, second[between]])),
        ),
        shape=(count, size),
    )
    springs = structure.of_unknowns(signs)
    masses = structure.of_unknowns(scipy.sparse.eye(size, format="csr"))
    stiffness = springs.T @ scipy.sparse.diags(attachments.stiffnesses) @ springs
    mass = masses.T @ scipy.sparse.diags(np.repeat(attachments.masses, 3)) @ masses
    return replace(
        structure,
        stiffness=(structure.stiffness + stiffness).tocsr(),
        mass=(structure.mass + mass).tocsr(),
    )
