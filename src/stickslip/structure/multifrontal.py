"""Cholesky factor of a sparse stiffness by dense fronts, which condenses other matrices to a boundary on its way.

The nodes of a mesh are eliminated set by set (:mod:`stickslip.structure.dissection`). The *front* of a set contains its
unknowns ``p`` and all later unknowns ``r`` that they act on; both are dense, so the work are products of dense
matrices:

    L_pp L_pp^T = F_pp,   L_rp = F_rp L_pp^-T,   U = F_rr - L_rp L_rp^T,

and U goes to the front of the first unknown of r (I. S. Duff, J. K. Reid, The multifrontal solution of indefinite
sparse symmetric linear equations, ACM Trans. Math. Softw. 9 (1983) 302-325). Unknowns of a boundary are not eliminated:
what reaches them is the Schur complement, ``K_bb - K_bi K_ii^-1 K_ib``. A mass follows the constraint modes of
each front, ``W = F_pp^-1 F_pr``: ``U_M = G_rr - G_rp W - W^T G_pr + W^T G_pp W``. Constraint modes of constraint modes
are constraint modes, so the boundary receives ``Psi^T M Psi`` of all constraint modes Psi without computing any of them
(R. J. Guyan, AIAA J. 3 (1965) 380, front by front).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from scipy.linalg.blas import dsyr2k, dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf
from threadpoolctl import threadpool_limits

from stickslip.core.compiled import njit
from stickslip.core.errors import SingularMatrixError
from stickslip.core.threads import in_threads
from stickslip.core.validation import FloatArray
from stickslip.structure.dissection import nested_dissection
from stickslip.structure.mesh import IntArray
from stickslip.structure.triangular import WIDEST_PANEL, TriangularFactor

# chosen: a larger front is worked on by several threads, so many rows at a time. The division does not depend on the
# number of threads, and neither do the digits; those of the symmetric products of OpenBLAS do not either (tested).
COLUMNS = 256
LARGE_FRONT = 1024


def condensed(
    matrices: Sequence[Any],
    node: IntArray,
    position: FloatArray,
    boundary: IntArray,
    interior: IntArray,
    beside: int = 0,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> tuple[TriangularFactor, list[FloatArray]]:
    """The factor of ``K_ii``, and each matrix condensed to the boundary with the constraint modes of K.

    Parameters
    ----------
    matrices:
        csr (n, n), real and symmetric: the stiffness K, then others.
    node, position:
        (n,) node of each unknown, and (n_nodes, 3) m position of each node.
    boundary, interior:
        unknowns that remain, and unknowns that are eliminated.
    beside:
        number of rows and columns, zero, that the dense matrices have after those of the boundary.
    threads, progress:
        threads of large fronts; ``progress`` receives the completed fraction of the unknowns.

    Returns
    -------
    factor, condensed
        (k + beside, k + beside) dense matrices ``T^T A T`` with ``T = [I; -K_ii^-1 K_ib]``.

    Raises
    ------
    SingularMatrixError
        if ``K_ii`` is not positive definite.
    """
    sets = _fronts_of(matrices, node, position, interior)
    order = np.concatenate([*sets, boundary]) if sets else boundary
    ordered = [_upper(matrix, order) for matrix in matrices]
    elimination = _Elimination(ordered, len(interior), len(boundary), beside, threads)
    first = 0
    for members in sets:
        elimination.eliminate(first, first + len(members))
        first += len(members)
        if progress is not None:
            progress(first / max(len(interior), 1))
    place = np.empty(matrices[0].shape[0], dtype=np.int64)
    place[interior] = np.arange(len(interior))
    row = np.empty(len(interior), dtype=np.int32)
    row[place[order[: len(interior)]]] = np.arange(len(interior))
    return elimination.factor(row), elimination.boundary_matrices()


def _fronts_of(matrices: Sequence[Any], node: IntArray, position: FloatArray, interior: IntArray) -> list[IntArray]:
    """The interior unknowns of each front, in the order of elimination."""
    used, place = np.unique(node[interior], return_inverse=True)
    unknowns = scipy.sparse.csr_matrix((np.ones(len(interior), np.int32), (place, np.arange(len(interior)))))
    neighbours = scipy.sparse.csr_matrix((len(used), len(used)), dtype=np.int32)
    for matrix in matrices:
        inner = matrix[interior][:, interior]
        pattern = scipy.sparse.csr_matrix((np.ones(inner.nnz, np.int32), inner.indices, inner.indptr), inner.shape)
        neighbours = neighbours + unknowns @ pattern @ unknowns.T
    starts, members = unknowns.indptr, interior[unknowns.indices]
    return [
        np.concatenate([members[starts[each] : starts[each + 1]] for each in front])
        for front in nested_dissection(neighbours.tocsr(), position[used])
    ]


def _upper(matrix: Any, order: IntArray) -> Any:
    """The upper triangle, with sorted columns, of a sparse symmetric matrix in another order."""
    upper = scipy.sparse.triu(matrix[order][:, order], format="csr")
    upper.sort_indices()
    return upper


@dataclass
class _Waiting:
    """What an eliminated front leaves for a later one: its rows and the lower triangles of its matrices."""

    rows: IntArray
    updates: list[FloatArray]


@dataclass
class _Panel:
    """Neighbouring columns of L D L^T, see :class:`TriangularFactor`: its numbers, the rows below, and D."""

    first: int
    values: FloatArray
    rows: IntArray
    diagonal: FloatArray


def _panels(first: int, own: FloatArray, below: FloatArray, later: IntArray) -> list[_Panel]:
    """The panels of a front whose Cholesky factor (p, p) is the lower triangle of ``own``, and (r, p) ``below``."""
    roots, panels = own.diagonal(), []
    for start in range(0, len(own), WIDEST_PANEL):
        stop = min(start + WIDEST_PANEL, len(own))
        values = np.vstack([own[start:, start:stop], below[:, start:stop]]) / roots[start:stop]
        rows = np.append(first + np.arange(stop, len(own)), later)
        panels.append(_Panel(first + start, values, rows, roots[start:stop] ** 2))
    return panels


class _Elimination:
    """The elimination of one front after the other."""

    def __init__(self, matrices: Sequence[Any], n_interior: int, n_boundary: int, beside: int, threads: int) -> None:
        self._matrices, self._interior, self._threads = matrices, n_interior, threads
        self._size = n_interior + n_boundary
        self._local = np.empty(self._size, dtype=np.int64)
        self._waiting: dict[int, list[_Waiting]] = {}  # by the first row, which is one of a later front
        self._boundary = [np.zeros((n_boundary + beside, n_boundary + beside)) for _ in matrices]
        self._panels: list[_Panel] = []
        boundary = np.arange(n_interior, self._size)
        self._local[boundary] = boundary - n_interior
        none = np.empty((0, 0))
        for matrix, whole in zip(matrices, self._boundary, strict=True):
            _add_rows(
                matrix.indptr, matrix.indices, matrix.data, n_interior, self._size, self._local, n_boundary, whole, none
            )

    def eliminate(self, first: int, stop: int) -> None:
        """Eliminate the unknowns of rows ``first`` to ``stop``."""
        arrived = [each for row in range(first, stop) for each in self._waiting.pop(row, [])]
        reached = [matrix.indices[matrix.indptr[first] : matrix.indptr[stop]] for matrix in self._matrices]
        rows = np.unique(np.concatenate([*reached, *(each.rows for each in arrived)]))
        later = rows[np.searchsorted(rows, stop) :].astype(np.int64)
        own, rest = stop - first, len(later)
        self._local[first:stop] = np.arange(own)
        self._local[later] = own + np.arange(rest)
        fronts = [(np.zeros((own, own)), np.zeros((rest, own)), np.zeros((rest, rest))) for _ in self._matrices]
        for matrix, (corner, below, _) in zip(self._matrices, fronts, strict=True):
            _add_rows(matrix.indptr, matrix.indices, matrix.data, first, stop, self._local, own, corner, below)
        while arrived:
            child = arrived.pop()
            for update, front in zip(child.updates, fronts, strict=True):
                _add_update(update, self._local[child.rows], own, *front)
        constraint = self._factored(*fronts[0], fronts[1:])
        for front in fronts[1:]:
            self._condensed(*front, constraint)
        inside = int(np.searchsorted(later, self._interior))
        self._panels += _panels(first, fronts[0][0], fronts[0][1][:inside], later[:inside])
        self._leave(_Waiting(later, [update for _, _, update in fronts]), inside)

    def factor(self, row: NDArray[np.int32]) -> TriangularFactor:
        """The factor of the interior, complete; ``row`` (n_interior,) is the row of each unknown. Empties this one."""
        panels, self._panels = self._panels, []
        firsts = [each.first for each in panels]
        row_starts = np.cumsum([0, *(len(each.rows) for each in panels)])
        value_starts = np.cumsum([0, *(each.values.size for each in panels)])
        rows, values = np.empty(row_starts[-1], dtype=np.int32), np.empty(value_starts[-1])
        diagonal = np.concatenate([each.diagonal for each in panels])
        for k in range(len(panels) - 1, -1, -1):  # each panel is released once it is copied
            panel = panels.pop()
            rows[row_starts[k] : row_starts[k + 1]] = panel.rows
            values[value_starts[k] : value_starts[k + 1]] = panel.values.ravel()
        return TriangularFactor(
            np.array([*firsts, self._interior]), row_starts, rows, value_starts, values, diagonal, row
        )

    def boundary_matrices(self) -> list[FloatArray]:
        """The condensed matrices, complete."""
        for matrix in self._boundary:
            for start in range(0, len(matrix), COLUMNS):
                stop = min(start + COLUMNS, len(matrix))
                matrix[start:stop, stop:] = matrix[stop:, start:stop].T
                block = matrix[start:stop, start:stop]
                block[...] = np.tril(block) + np.tril(block, -1).T
        return self._boundary

    def _leave(self, left: _Waiting, inside: int) -> None:
        """Store what a front leaves; what reaches the boundary alone is added to it at once."""
        if inside:
            self._waiting.setdefault(int(left.rows[0]), []).append(left)
            return
        for update, whole in zip(left.updates, self._boundary, strict=True):
            none = np.empty((0, 0))
            _add_update(update, left.rows - self._interior, len(whole), whole, none, none)

    def _factored(self, own: FloatArray, below: FloatArray, rest: FloatArray, others: Sequence[Any]) -> FloatArray:
        """Factor a front in its place; returns ``W^T`` (r, p), or nothing where no other matrix needs it."""
        _, failure = dpotrf(own.T, lower=0, overwrite_a=1, clean=0)
        if failure:
            raise SingularMatrixError("a stiffness matrix is singular, or not positive definite.")
        constraint = np.empty((len(below) if others else 0, own.shape[1]))

        def solve(rows: slice) -> None:
            part = below[rows]
            part[...] = dtrsm(1.0, own.T, part.T, side=0, lower=0, trans_a=1, overwrite_b=1).T
            if others:
                constraint[rows] = dtrsm(1.0, own.T, part.T, side=0, lower=0).T

        self._by_blocks(solve, len(below))
        with self._library_threads(len(below)):
            dsyrk(-1.0, below.T, 1.0, rest.T, trans=1, lower=0, overwrite_c=1)
        return constraint

    def _condensed(self, own: FloatArray, below: FloatArray, rest: FloatArray, constraint: FloatArray) -> None:
        """``G_rr - G_rp W - W^T G_pr + W^T G_pp W`` in the place of G_rr, with ``W^T`` given."""
        corner = np.tril(own) + np.tril(own, -1).T

        def half(rows: slice) -> None:
            below[rows] -= 0.5 * (constraint[rows] @ corner)

        self._by_blocks(half, len(below))
        with self._library_threads(len(below)):
            dsyr2k(-1.0, below.T, constraint.T, 1.0, rest.T, trans=1, lower=0, overwrite_c=1)

    def _library_threads(self, count: int) -> AbstractContextManager[Any]:
        """The threads of one product of the library for so many rows.

        Its symmetric products have the same digits with any number of threads, its other products have not.
        """
        limited: AbstractContextManager[Any] = threadpool_limits(limits=self._threads if count > LARGE_FRONT else 1)
        return limited

    def _by_blocks(self, work: Callable[[slice], None], count: int) -> None:
        """Call ``work`` for blocks of rows or columns, in threads if there are many."""
        if count <= LARGE_FRONT:
            work(slice(0, count))
            return
        in_threads(
            lambda start: work(slice(start, min(start + COLUMNS, count))), range(0, count, COLUMNS), self._threads
        )


@njit(cache=True, nogil=True)
def _add_rows(
    pointers: IntArray,
    columns: IntArray,
    values: FloatArray,
    first: int,
    stop: int,
    local: IntArray,
    own: int,
    corner: FloatArray,
    below: FloatArray,
) -> None:
    """Add the entries of rows ``first`` to ``stop`` of an upper triangle to the lower triangle of a front."""
    for row in range(first, stop):
        column = row - first
        for k in range(pointers[row], pointers[row + 1]):
            place = local[columns[k]]
            if place < own:
                corner[place, column] += values[k]
            else:
                below[place - own, column] += values[k]


@njit(cache=True, nogil=True)
def _add_update(
    update: FloatArray, place: IntArray, own: int, corner: FloatArray, below: FloatArray, rest: FloatArray
) -> None:
    """Add the lower triangle that a front left to the front of a later one; ``place`` ascends."""
    inside = np.searchsorted(place, own)
    for i in range(len(place)):
        if i < inside:
            target = corner[place[i]]
            for j in range(i + 1):
                target[place[j]] += update[i, j]
            continue
        target = below[place[i] - own]
        for j in range(inside):
            target[place[j]] += update[i, j]
        target = rest[place[i] - own]
        for j in range(inside, i + 1):
            target[place[j] - own] += update[i, j]
