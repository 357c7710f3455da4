"""Lowest modes by a Lanczos iteration with blocks of vectors.

A factor of many megabytes is read from memory for each solution, which takes as long for one vector as for many. The
iteration of :mod:`stickslip.structure.lanczos` solves for one vector at a time; this one for a block. It builds an
M-orthonormal basis V of the Krylov space of ``T = (K - s M)^-1 M``, which is self-adjoint for M, and takes the Ritz
pairs in it (G. H. Golub, R. Underwood, The block Lanczos method for computing eigenvalues, in Mathematical Software
III, Academic Press 1977). With the next block Q,

    T V = V H + Q R E^T,   H = V^T M T V,

the residual of a Ritz pair ``(x, V y)`` of H is ``|R y_last|``. All vectors remain orthogonal (full
reorthogonalisation): the bases are small beside the matrices.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg

from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray

Operator = Callable[[FloatArray], FloatArray]

# chosen: as many solutions at a time read the factor as often as one; more make a larger basis. 30 modes of 440 pairs
# take 176 vectors in 20 solutions, with 16 columns 272 in 15; single vectors take 142 solutions.
COLUMNS = 8
MORE_ROOM = 64  # chosen: vectors in one array of the basis
# chosen: residual of a Ritz value x of T, over x, and over the largest one (round-off of the solutions). The error of x
# is its square, that of a vector this over the relative distance to the next solution.
TOLERANCE, ROUND_OFF = 1e-10, 1e-15
# chosen: directions of a block with a smaller square of the length, over the largest one, are round-off.
NO_DIRECTION = 1e-13
# chosen: part of H that round-off may make asymmetric; solutions with 16 digits have 1e-12.
ASYMMETRY = 1e-4
# chosen: blocks after a second random one, which finds solutions as multiple as a block is wide.
MORE_BLOCKS = 2


class TooManyModes(Exception):
    """More solutions up to a limit than wanted."""


def lowest_modes(
    solve: Operator,
    weigh: Operator,
    size: int,
    *,
    count: int | None = None,
    limit: float | None = None,
    shift: float = 0.0,
    most: int | None = None,
    columns: int = COLUMNS,
) -> tuple[FloatArray, FloatArray]:
    """The lowest solutions of ``K v = x M v``: x ascending (k,) and mass-normalised v (n, k).

    Parameters
    ----------
    solve, weigh:
        ``(K - s M)^-1 A`` and ``M A`` of blocks A (n, c); K and M are real and symmetric, ``K - s M`` and M positive
        definite.
    size:
        n.
    count, limit:
        the number k of solutions, or all with x up to this limit: one of both.
    shift:
        s, below all solutions.
    most:
        with a limit, the number of solutions up to it above which none are computed: TooManyModes.
    columns:
        vectors of a block. Solutions that are multiple up to twice as often are all found.

    Raises
    ------
    ConvergenceError
        if the solutions are not those of a symmetric matrix, by round-off.
    """
    assert (count is None) != (limit is None)
    random, krylov = np.random.default_rng(0), _Krylov(solve, weigh, size)  # the same in every run
    krylov.append(solve(weigh(random.standard_normal((size, min(columns, size))))))
    lower = np.inf if limit is None else 1.0 / (limit - shift)
    searched_again: int | None = None
    while True:
        krylov.step()
        values, turns, residuals = krylov.ritz()
        allowed = TOLERANCE * values + ROUND_OFF * values[0]
        # a Ritz value that is not sure to be beyond the limit counts as wanted
        wanted = count if limit is None else int((values + residuals >= lower).sum())
        assert wanted is not None
        # there are at least as many solutions up to the limit as Ritz values
        if most is not None and limit is not None and int((values >= lower).sum()) > most:
            raise TooManyModes
        enough = wanted < values.size or krylov.is_whole
        if enough and (residuals[:wanted] <= allowed[:wanted]).all():
            searched_again = 0 if searched_again is None else searched_again + 1
            if searched_again >= MORE_BLOCKS or krylov.is_whole:
                kept = wanted if limit is None else int((values >= lower).sum())
                return shift + 1.0 / values[:kept], krylov.vectors(turns[:, :kept])
            if searched_again == 0:
                krylov.append(solve(weigh(random.standard_normal((size, columns)))))


class _Vectors:
    """Vectors (n,) as rows of a growing matrix V^T (k, n), in arrays of ``MORE_ROOM`` rows that are never copied.

    Those of a million unknowns take gigabytes; memory of rows that are not written yet is not taken.
    """

    def __init__(self, size: int) -> None:
        self._size, self._count = size, 0
        self._parts: list[FloatArray] = []

    def append(self, rows: FloatArray) -> None:
        """Add rows (c, n)."""
        while len(rows):
            used = self._count - MORE_ROOM * (len(self._parts) - 1)
            if not self._parts or used == MORE_ROOM:
                self._parts.append(np.empty((MORE_ROOM, self._size)))
                used = 0
            fitting = rows[: MORE_ROOM - used]
            self._parts[-1][used : used + len(fitting)] = fitting
            self._count += len(fitting)
            rows = rows[len(fitting) :]

    def between(self, start: int, stop: int) -> FloatArray:
        """Rows ``start`` to ``stop``, a copy."""
        pieces = [part[max(start - first, 0) : max(stop - first, 0)] for first, part in self._written()]
        return np.vstack([np.empty((0, self._size)), *pieces])

    def products(self, block: FloatArray) -> FloatArray:
        """``V^T block`` (k, c) of (n, c)."""
        return np.vstack([np.empty((0, block.shape[1])), *(part @ block for _, part in self._written())])

    def combined(self, turns: FloatArray) -> FloatArray:
        """``V turns`` (n, c) of coefficients (m, c) of the first m vectors."""
        answer = np.zeros((self._size, turns.shape[1]))
        for first, part in self._written():
            factors = turns[first : first + len(part)]
            answer += part[: len(factors)].T @ factors
        return answer

    def _written(self) -> list[tuple[int, FloatArray]]:
        """The first row of each array, and its rows."""
        firsts = [MORE_ROOM * k for k in range(len(self._parts))]
        return [(first, part[: self._count - first]) for first, part in zip(firsts, self._parts, strict=True)]


class _Krylov:
    """A growing basis V, the products M V, and the projection of T."""

    def __init__(self, solve: Operator, weigh: Operator, size: int) -> None:
        self._solve, self._weigh, self._size = solve, weigh, size
        self._basis, self._weighted = _Vectors(size), _Vectors(size)
        self._width, self._stepped, self._last = 0, 0, 0  # vectors; those T was applied to, and the last of these
        self._projection = np.zeros((0, 0))  # H of the vectors that T was applied to
        self._coupling = np.zeros((0, 0))  # R: of the last of these to the vectors after them

    @property
    def is_whole(self) -> bool:
        """Whether the basis is the whole space and T was applied to all of it."""
        return self._stepped == self._width == self._size

    def append(self, block: FloatArray, first_pass: bool = True) -> None:
        """Add the part of a block (n, c) that the basis lacks; after a first pass if the block has none yet."""
        room = self._size - self._width
        if not room:
            return
        # The columns may differ by many orders in size: an orthonormal basis of them before the second pass.
        part = self._without(block, self._weighted.products(block)) if first_pass else block
        basis = np.linalg.qr(part[:, :room])[0]
        basis = self._without(basis, self._weighted.products(basis))
        weighted = self._weigh(basis)
        for _ in range(2):  # the second time for the round-off of a block that M nearly makes dependent
            squares, turns = scipy.linalg.eigh(basis.T @ weighted)
            chosen = squares > NO_DIRECTION * squares[-1]
            turns = turns[:, chosen] / np.sqrt(squares[chosen])
            basis, weighted = basis @ turns, weighted @ turns
        self._basis.append(basis.T)
        self._weighted.append(weighted.T)
        self._width += basis.shape[1]

    def _without(self, block: FloatArray, products: FloatArray) -> FloatArray:
        """The part of a block that is M-orthogonal to the basis, to the round-off of the block."""
        return np.asarray(block - self._basis.combined(products))

    def step(self) -> None:
        """Apply T to the vectors that it was not applied to, and add what the basis lacks."""
        before, width = self._stepped, self._width
        if before == width:
            return
        images = self._solve(np.ascontiguousarray(self._weighted.between(before, width).T))
        products = self._weighted.products(images)
        own = products[before:]
        if not np.abs(own - own.T).max() <= ASYMMETRY * np.abs(own).max():
            raise ConvergenceError(
                f"the lowest natural frequencies of a structure with {self._size} unknowns cannot be computed: the "
                "solutions with its stiffness have no digits. Its entries most likely differ too much in size: check "
                "the units of Young's modulus, density, lengths and contact stiffness."
            )
        rest = self._without(images, products)
        self.append(rest, first_pass=False)
        self._coupling = self._weighted.between(width, self._width) @ rest
        projection = np.zeros((width, width))
        projection[:before, :before] = self._projection
        projection[:, before:] = products
        projection[before:, :before] = products[:before].T
        self._projection = 0.5 * (projection + projection.T)
        self._stepped, self._last = width, width - before

    def ritz(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The Ritz values of T, largest first, their vectors in the basis, and their residuals in the norm of M."""
        values, turns = scipy.linalg.eigh(self._projection)
        values, turns = values[::-1], turns[:, ::-1]
        residuals = np.linalg.norm(self._coupling @ turns[len(turns) - self._last :], axis=0)
        return values, turns, residuals

    def vectors(self, turns: FloatArray) -> FloatArray:
        """(n, k) of coefficients in the basis."""
        return self._basis.combined(turns)
