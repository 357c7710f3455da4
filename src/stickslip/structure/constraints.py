"""Exact elimination of linear equations between displacements: ``u = T q`` with independent displacements ``q``.

The equations are eliminated one after the other, as in Gauss' method: each one gives one unknown by others, and
replaces it in all further ones. Reference nodes and rotations are eliminated first, so that the independent unknowns
are displacements of the mesh; then the unknown that the file makes dependent; nodes that must remain come last. With
``u = T q`` the motion of the tied structure is ``T^T M T q'' + T^T K T q = T^T p``, without penalty or multiplier, and
a rigid motion that satisfies the equations remains without strain.
"""

from __future__ import annotations

import heapq
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.equations import Equations, Key
from stickslip.structure.mesh import IntArray

_ROUND_OFF = 1e-11  # part of the largest term of a sum below which it is zero
_PIVOT = 0.01  # smallest part of the largest coefficient of an equation that an unknown of preference must have
_MOST_TERMS = 30_000_000  # chosen: T then takes 0.5 GB


@dataclass(frozen=True)
class Constraints:
    """Displacements ``u = T q`` (size,) of a mesh from independent ones ``q = u[free_unknowns]``.

    Parameters
    ----------
    transformation:
        csr T (size, n_free); a dependent displacement that is zero has an empty row.
    free_unknowns:
        (n_free,) numbers of the independent displacements, rising.
    reference:
        csr (n_further, size): the further unknowns of the equations from independent displacements.
    further:
        key of each further unknown -> its row of ``reference``; those that nothing fixes are not in it.
    n_redundant:
        equations that follow from others or from constraints.
    """

    transformation: Any
    free_unknowns: IntArray
    reference: Any
    further: dict[Key, int] = field(default_factory=dict)
    n_redundant: int = 0

    @property
    def size(self) -> int:
        """Number of displacements of the mesh."""
        return int(self.transformation.shape[0])

    @property
    def dependent_unknowns(self) -> IntArray:
        """Displacements that follow others, rising; not those that are zero."""
        follows = np.diff(self.transformation.indptr) > 0
        follows[self.free_unknowns] = False
        return np.flatnonzero(follows)

    @property
    def zero_unknowns(self) -> IntArray:
        """Displacements that are zero, by constraints of their own or by what they follow; rising."""
        return np.flatnonzero(np.diff(self.transformation.indptr) == 0)

    def leaders(self, unknown: int) -> IntArray:
        """The independent displacements that one displacement follows."""
        row = slice(*self.transformation.indptr[unknown : unknown + 2])
        return np.asarray(self.free_unknowns[self.transformation.indices[row]])

    def rows(self, unknowns: ArrayLike) -> Any:
        """csr (k, size) of displacements of the mesh from independent ones, which are in their columns."""
        part = self.transformation[np.asarray(unknowns)].tocoo()
        return scipy.sparse.csr_matrix(
            (part.data, (part.row, self.free_unknowns[part.col])), shape=(part.shape[0], self.size)
        )


def eliminate(equations: Equations, fixed_unknowns: ArrayLike = (), avoided: Collection[int] = ()) -> Constraints:
    """Solve equations for as many unknowns as there are independent equations.

    Parameters
    ----------
    fixed_unknowns:
        displacements of the mesh that are zero.
    avoided:
        displacements that remain independent wherever another unknown of the equation can follow instead: those of
        contact, force and output nodes.

    Raises InputError if the elimination couples too many unknowns.
    """
    work = _Elimination(equations, fixed_unknowns, frozenset(avoided))
    widest: dict[int, int] = {}
    for row in equations.rows:
        widest[row.owner] = max(widest.get(row.owner, 0), len(row.terms))
    for row in sorted(equations.rows, key=lambda each: (widest[each.owner], each.owner)):
        work.take(row.terms, row.dependent)
    work.resolve()
    return work.constraints()


class _Elimination:
    """Expressions of dependent unknowns, in the order in which they were found."""

    def __init__(self, equations: Equations, fixed_unknowns: ArrayLike, avoided: frozenset[int]) -> None:
        self._equations = equations
        self._size = 3 * equations.n_nodes
        self._fixed = {int(each) for each in np.asarray(fixed_unknowns, dtype=np.int64)} | equations.fixed
        self._avoided = avoided
        self._expression: dict[int, dict[int, float]] = {}
        self._order: dict[int, int] = {}
        self._redundant = 0
        self._terms = 0

    def take(self, terms: dict[int, float], declared: int) -> None:
        """Solve one equation for one of its unknowns."""
        row = self._substituted(terms)
        if not row:
            self._redundant += 1
            return
        pivot = self._pivot(row, declared)
        scale = -1.0 / row.pop(pivot)
        self._expression[pivot] = {unknown: scale * value for unknown, value in row.items()}
        self._order[pivot] = len(self._order)
        self._count(len(row))

    def _count(self, terms: int) -> None:
        self._terms += terms
        if self._terms > _MOST_TERMS:
            raise InputError(
                f"ties, rigid bodies and couplings connect more than {_MOST_TERMS} pairs of unknowns, too many for an "
                "exact elimination. Distribute couplings over fewer nodes."
            )

    def _substituted(self, terms: dict[int, float]) -> dict[int, float]:
        """Terms without fixed and dependent unknowns.

        An expression contains only unknowns that became dependent after its own. Therefore each dependent unknown is
        replaced once if they are taken in this order.
        """
        row: dict[int, float] = {}
        largest: dict[int, float] = {}
        waiting: list[tuple[int, int]] = []
        queued: set[int] = set()

        def add(unknown: int, value: float) -> None:
            if unknown in self._fixed:
                return
            row[unknown] = row.get(unknown, 0.0) + value
            largest[unknown] = max(largest.get(unknown, 0.0), abs(value))
            if unknown in self._order and unknown not in queued:
                queued.add(unknown)
                heapq.heappush(waiting, (self._order[unknown], unknown))

        for unknown, value in terms.items():
            add(unknown, value)
        while waiting:
            _, unknown = heapq.heappop(waiting)
            factor = row.pop(unknown)
            if abs(factor) > _ROUND_OFF * largest[unknown]:
                for other, value in self._expression[unknown].items():
                    add(other, factor * value)
        return {unknown: value for unknown, value in row.items() if abs(value) > _ROUND_OFF * largest[unknown]}

    def _pivot(self, row: dict[int, float], declared: int) -> int:
        """The unknown to solve for: a further one, else that of the file, else the largest that need not remain."""
        further = {
            unknown: abs(value) / self._equations.lengths[unknown - self._size]
            for unknown, value in row.items()
            if unknown >= self._size
        }
        if further:
            return max(further, key=further.__getitem__)
        limit = _PIVOT * max(map(abs, row.values()))
        if abs(row.get(declared, 0.0)) >= limit and declared not in self._avoided:
            return declared
        usable = [unknown for unknown, value in row.items() if abs(value) >= limit]
        return max(usable, key=lambda unknown: (unknown not in self._avoided, abs(row[unknown]), -unknown))

    def resolve(self) -> None:
        """Write every expression in independent unknowns alone."""
        self._terms = 0
        for unknown in sorted(self._order, key=self._order.__getitem__, reverse=True):
            self._expression[unknown] = self._substituted(self._expression[unknown])
            self._count(len(self._expression[unknown]))

    def constraints(self) -> Constraints:
        """The result after :meth:`resolve`."""
        free = np.ones(self._size, dtype=bool)
        free[[each for each in (*self._fixed, *self._order) if each < self._size]] = False
        free_unknowns = np.flatnonzero(free)
        column = np.full(self._size, -1, dtype=np.int64)
        column[free_unknowns] = np.arange(len(free_unknowns))
        of_mesh = [each for each in self._order if each < self._size]
        row, leader, value = self._triplets(of_mesh)
        entries = np.concatenate([np.ones(len(free_unknowns)), value])
        rows = np.concatenate([free_unknowns, np.array(of_mesh, dtype=np.int64)[row]])
        columns = np.concatenate([np.arange(len(free_unknowns)), column[leader]])
        transformation = scipy.sparse.csr_matrix((entries, (rows, columns)), shape=(self._size, len(free_unknowns)))
        return Constraints(transformation, free_unknowns, *self._reference(), self._redundant)

    def _triplets(self, unknowns: list[int]) -> tuple[IntArray, IntArray, FloatArray]:
        """Position of the unknown, independent unknown, and coefficient of each term."""
        counts = [len(self._expression[each]) for each in unknowns]
        leaders = [leader for each in unknowns for leader in self._expression[each]]
        values = [value for each in unknowns for value in self._expression[each].values()]
        return (
            np.repeat(np.arange(len(unknowns)), np.array(counts, dtype=np.int64)),
            np.array(leaders, dtype=np.int64),
            np.array(values, dtype=float),
        )

    def _reference(self) -> tuple[Any, dict[Key, int]]:
        """Rows of the further unknowns that the mesh moves, and the row of each by its key."""
        moved = {
            key: number
            for key, number in self._equations.further.items()
            if number in self._fixed
            or (number in self._order and all(each < self._size for each in self._expression[number]))
        }
        driven = [number for number in moved.values() if number in self._order]
        row, leader, value = self._triplets(driven)
        at = {number: position for position, number in enumerate(moved.values())}
        rows = np.array([at[number] for number in driven], dtype=np.int64)[row]
        matrix = scipy.sparse.csr_matrix((value, (rows, leader)), shape=(len(moved), self._size))
        return matrix, {key: at[number] for key, number in moved.items()}
