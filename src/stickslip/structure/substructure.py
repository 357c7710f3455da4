"""A reduced structure as a study uses it: a superelement, or a sector of a disk."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.cyclic_sector import CyclicSector
from stickslip.structure.superelement import PairsOfNodes, Superelement


class Substructure(Protocol):
    """What :class:`Superelement` and :class:`CyclicSector` have in common.

    Methods that are valid for only one of them raise InputError in the other one. The solver asks
    :func:`stickslip.solve.curve_structures.curve_structure` for the balances.
    """

    @property
    def size(self) -> int:
        """Number of unknowns n."""

    @property
    def row_size(self) -> int:
        """Number of entries of a row of an output or a pair."""

    @property
    def has_all_pairs(self) -> bool:
        """Whether each of its pairs has unknowns, so that it can be tied."""

    def operator(self, pairs: PairsOfNodes) -> FloatArray:
        """(3 * n_pairs, row_size) relative displacements t1, t2, n of pairs. Raises InputError."""

    def with_rayleigh_damping(self, mass_factor: float, stiffness_factor: float) -> Substructure:
        """With the damping ``mass_factor M + stiffness_factor K`` (1/s and s) beside its own. Raises InputError."""

    def without_recovery(self) -> Substructure:
        """Without what only the motion of the mesh requires, to send it to another process."""

    def mean_structure(self) -> Superelement:
        """The matrices of motions that are constant in time: those of a structure, or of nodal diameter 0 of a disk."""

    def require_structure(self) -> Superelement:
        """The single matrices of a structure. Raises InputError for a sector."""

    def require_sector(self) -> CyclicSector:
        """The matrices of each nodal diameter. Raises InputError for a structure."""


def rows_of_mean(rows: FloatArray, size: int) -> FloatArray:
    """Rows (..., n) of the n = ``size`` unknowns of :meth:`Substructure.mean_structure` from those (..., row_size).

    Rows of a sector have the unknowns of this sector and of the next one, which do not differ in a constant motion.
    """
    return np.asarray(rows.reshape(*rows.shape[:-1], -1, size).sum(axis=-2))
