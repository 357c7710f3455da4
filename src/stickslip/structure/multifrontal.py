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
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse
from scipy.linalg.blas import dsyr2k, dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf
from threadpoolctl import threadpool_limits

from stickslip.core.compiled import njit
from stickslip.core.errors import SingularMatrixError
from stickslip.core.threads import in_threads
from stickslip.core.validation import FloatArray
from stickslip.structure.dissection import nested_dissection
from stickslip.structure.mesh import IntArray
from stickslip.structure.triangular import WIDEST_PANEL, IndexArray, TriangularFactor

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
    row = np.empty(matrices[0].shape[0], dtype=np.int32)
    row[order] = np.arange(len(order))
    fronts = _planned(ordered, [len(members) for members in sets])
    elimination = _Elimination(ordered, _empty_factor(fronts, row[interior]), len(boundary), beside, threads)
    for front in fronts:
        elimination.eliminate(front)
        if progress is not None:
            progress(front.stop / len(interior))
    return elimination.factor, elimination.boundary_matrices()


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

    rows: IndexArray
    updates: list[FloatArray]


@dataclass(frozen=True)
class _Front:
    """The rows ``first`` to ``stop`` that a front eliminates, and the later ones that they act on."""

    first: int
    stop: int
    later: IndexArray


def _planned(matrices: Sequence[Any], sizes: Sequence[int]) -> list[_Front]:
    """The fronts of upper triangles, with so many rows each: what elimination fills in, before any number is known."""
    fronts: list[_Front] = []
    arriving: dict[int, list[IndexArray]] = {}  # later rows of fronts, by the first of them
    first = 0
    for size in sizes:
        stop = first + size
        arrived = [rows for row in range(first, stop) for rows in arriving.pop(row, [])]
        reached = [matrix.indices[matrix.indptr[first] : matrix.indptr[stop]] for matrix in matrices]
        rows = np.unique(np.concatenate([*reached, *arrived]))
        later = rows[np.searchsorted(rows, stop) :].astype(np.int32)
        if len(later):
            arriving.setdefault(int(later[0]), []).append(later)
        fronts.append(_Front(first, stop, later))
        first = stop
    return fronts


def _empty_factor(fronts: Sequence[_Front], place: IndexArray) -> TriangularFactor:
    """A factor with room for the numbers of all fronts, panel by panel; ``place`` (n,) is the row of each unknown.

    The panels of large meshes take most of the memory: they are written to where they remain, and never copied.
    """
    size = len(place)
    firsts, below = [], []
    for front in fronts:
        inside = front.later[: np.searchsorted(front.later, size)]
        for start in range(front.first, front.stop, WIDEST_PANEL):
            stop = min(start + WIDEST_PANEL, front.stop)
            firsts.append(start)
            below.append(np.append(np.arange(stop, front.stop, dtype=np.int32), inside))
    bounds = np.array([*firsts, size])
    width, count = np.diff(bounds), np.array([len(each) for each in below], dtype=np.int64)
    row_starts, value_starts = (np.append(0, np.cumsum(each)) for each in (count, width * (width + count)))
    rows = np.concatenate(below) if below else np.empty(0, dtype=np.int32)
    return TriangularFactor(bounds, row_starts, rows, value_starts, np.empty(value_starts[-1]), np.empty(size), place)


class _Elimination:
    """The elimination of one front after the other, which fills an empty factor."""

    def __init__(
        self, matrices: Sequence[Any], factor: TriangularFactor, n_boundary: int, beside: int, threads: int
    ) -> None:
        self.factor = factor
        self._matrices, self._interior, self._threads = matrices, len(factor.place), threads
        size = self._interior + n_boundary
        self._local = np.empty(size, dtype=np.int64)
        self._waiting: dict[int, list[_Waiting]] = {}  # by the first row, which is one of a later front
        self._boundary = [np.zeros((n_boundary + beside, n_boundary + beside)) for _ in matrices]
        boundary = np.arange(self._interior, size)
        self._local[boundary] = boundary - self._interior
        none = np.empty((0, 0))
        for matrix, whole in zip(matrices, self._boundary, strict=True):
            _add_rows(
                matrix.indptr, matrix.indices, matrix.data, self._interior, size, self._local, n_boundary, whole, none
            )

    def eliminate(self, front: _Front) -> None:
        """Eliminate the unknowns of a front."""
        first, stop, later = front.first, front.stop, front.later
        arrived = [each for row in range(first, stop) for each in self._waiting.pop(row, [])]
        own, rest = stop - first, len(later)
        self._local[first:stop] = np.arange(own)
        self._local[later] = own + np.arange(rest)
        parts = [(np.zeros((own, own)), np.zeros((rest, own)), np.zeros((rest, rest))) for _ in self._matrices]
        for matrix, (corner, below, _) in zip(self._matrices, parts, strict=True):
            _add_rows(matrix.indptr, matrix.indices, matrix.data, first, stop, self._local, own, corner, below)
        while arrived:
            child = arrived.pop()
            for update, part in zip(child.updates, parts, strict=True):
                _add_update(update, self._local[child.rows], own, *part)
        constraint = self._factored(*parts[0], parts[1:])
        inside = int(np.searchsorted(later, self._interior))
        self._store(first, parts[0][0], parts[0][1][:inside])
        for part in parts[1:]:
            self._condensed(*part, constraint)
        self._leave(_Waiting(later, [update for _, _, update in parts]), inside)

    def _store(self, first: int, own: FloatArray, below: FloatArray) -> None:
        """Write L and D of a front: its Cholesky factor is the lower triangle of ``own`` (p, p), and ``below``."""
        roots, factor = own.diagonal(), self.factor
        factor.diagonal[first : first + len(own)] = roots**2
        for start in range(0, len(own), WIDEST_PANEL):
            stop = min(start + WIDEST_PANEL, len(own))
            panel = int(np.searchsorted(factor.firsts, first + start))
            bounds = factor.value_starts[panel : panel + 2]
            numbers = factor.values[bounds[0] : bounds[1]].reshape(-1, stop - start)
            np.divide(own[start:, start:stop], roots[start:stop], out=numbers[: len(own) - start])
            np.divide(below[:, start:stop], roots[start:stop], out=numbers[len(own) - start :])

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
        if not len(below):  # the last front of a mesh without a boundary
            return constraint
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

        Its symmetric products have the same digits with any number of threads, its other products have not. A small
        front has the threads of the caller: to set their number takes 3 ms, longer than most of its products.
        """
        if count <= LARGE_FRONT:
            return nullcontext()
        limited: AbstractContextManager[Any] = threadpool_limits(limits=self._threads)
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
