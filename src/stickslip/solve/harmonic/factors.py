"""Factors of Newton matrices, and the iteration that uses them as preconditioners."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs  # small systems: scipy's own calls around them cost as much again

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.gmres import gmres

Product = Callable[[FloatArray], FloatArray]

# chosen: most systems that use a factor until one is tried without it, which costs some percent of them then.
MOST_WAITS = 32


class Inverse(Protocol):
    """A solver of a linear system, exact or approximate."""

    def solve(self, right: FloatArray) -> FloatArray:
        """The solution (n,) for a right-hand side."""
        ...


class Factor:
    """The LU factor of a square matrix, in its place: LAPACK reads rows as columns, so it factors the transpose.

    A singular matrix gives solutions that are not finite.
    """

    def __init__(self, matrix: FloatArray) -> None:
        self._factor = dgetrf(matrix.T, overwrite_a=True)[:2]

    def solve(self, right: FloatArray) -> FloatArray:
        """The solution (n,) for a right-hand side."""
        return np.asarray(dgetrs(*self._factor, right, trans=1)[0])

    def solve_transposed(self, right: FloatArray) -> FloatArray:
        """The solution (n,) of the transposed matrix."""
        return np.asarray(dgetrs(*self._factor, right)[0])


class BlockFactor:
    """The factors of the diagonal blocks of a matrix.

    Parameters
    ----------
    blocks:
        their rows, which together are all rows of the matrix, and the block of these rows and columns.
    """

    def __init__(self, blocks: Sequence[tuple[NDArray[np.int64], FloatArray]]) -> None:
        self._parts = [(rows, Factor(block)) for rows, block in blocks]

    def solve(self, right: FloatArray) -> FloatArray:
        """The solution (n,) of the matrix without what is outside of its blocks."""
        answer = np.empty_like(right)
        for rows, factor in self._parts:
            answer[rows] = factor.solve(right[rows])
        return answer


class LastFactor:
    """The last factored bordered system of a curve, as a preconditioner of the next ones.

    Rows that it does not have stay as they are. A curve stores no other large factor: steps that wait for another
    attempt have systems, and the factor of each of them would take up to 0.5 GB.
    """

    def __init__(self) -> None:
        self._factor: Inverse | None = None
        self._keys = np.empty(0, dtype=np.int64)
        self._owner: object = None
        self._wait, self._used, self._released = 1, 0, False

    def copy(self) -> LastFactor:
        """The same factor, for systems of another thread."""
        return copy.copy(self)

    def store(self, factor: Inverse, keys: NDArray[np.int64], owner: object = None) -> None:
        """The factor of a system with rows ``keys``, in their order (see :meth:`BorderedSystem.keys`); exact for its
        ``owner``."""
        self._factor, self._keys, self._owner = factor, keys, owner
        if self._released:
            self.was_needed()

    def of(self, owner: object) -> Factor | None:
        """The factor of an owner, None if another one has replaced it."""
        return self._factor if self._owner is owner and isinstance(self._factor, Factor) else None

    def forget(self) -> None:
        """Release a factor that no longer helps."""
        self._factor = self._owner = None

    def tried_without(self, solve: Callable[[], FloatArray | None]) -> FloatArray | None:
        """The answer of ``solve`` without the factor, if that is doubtful; None where it is needed, or not doubtful."""
        if not self.is_doubtful():
            return None
        answer = solve()
        if answer is None:
            self.was_needed()
        else:
            self.was_needless()
        return answer

    def is_doubtful(self) -> bool:
        """Whether the next system is tried without the factor: that one system was hard says little about the others.

        True for the first use, later after 2, 4 ... uses (at most ``MOST_WAITS``), twice as many each time when the
        factor was needed or had to be made again.
        """
        if self._factor is None:
            return False
        self._used += 1
        return self._used >= self._wait

    def was_needed(self) -> None:
        """A system could not be solved without the factor: wait twice as long until the next trial."""
        self._wait, self._used, self._released = min(2 * self._wait, MOST_WAITS), 0, False

    def was_needless(self) -> None:
        """A system could be solved without the factor: so are the next ones."""
        self.forget()
        self._released = True

    def inverse(self, keys: NDArray[np.int64]) -> Product | None:
        """The inverse of the stored system on the rows of another one, None without a stored system."""
        factor = self._factor
        if factor is None:
            return None
        _, here, there = np.intersect1d(keys, self._keys, assume_unique=True, return_indices=True)

        def apply(vector: FloatArray) -> FloatArray:
            answer, known = vector.copy(), np.zeros(self._keys.size)
            known[there] = answer[here]
            answer[here] = factor.solve(known)[there]
            return answer

        return apply


def iterated(
    apply: Product, right: FloatArray, tolerance: float, iterations: int, inverse: Product | None = None
) -> FloatArray | None:
    """The solution (n,) by GMRES with at most so many iterations, or None.

    An ``inverse`` acts first on the unknowns, so that the tolerance remains that of the system.
    """
    product = apply if inverse is None else lambda vector: apply(inverse(vector))
    answer = gmres(product, right, tolerance, iterations)
    return answer if answer is None or inverse is None else np.asarray(inverse(answer))
