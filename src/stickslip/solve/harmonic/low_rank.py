"""The Newton matrix with a compliance of low rank, inverted exactly: the preconditioner of large joints.

The contact of a joint is soft compared with the material around a pair. With contact springs k, the eigenvalues of ``k
A`` are therefore small, except for a few dozen shapes in which bodies move and bend as wholes: the modes near the
excitation, and the softest shapes of the mean. With these alone, ``A_0 = L G L^T``, the bordered matrix has the inverse
of Sherman, Morrison and Woodbury. For ``(I + D A_0) v + c p = r`` and ``l v + s p = r_p`` the amplitudes ``z = G L^T
v`` satisfy

    z + G L^T D L z + G L^T c p = G L^T r,   -l D L z + (s - l c) p = r_p - l r,   v = r - D L z - c p,

a system of some 200 unknowns. With a compliance ``A_l`` within groups of pairs as well
(:mod:`stickslip.solve.harmonic.local_inverse`), ``D L``, c and r are those after the inverse of ``I + D A_l``. What
remains for GMRES is ``D (A - A_0)``, which is small: 440 pairs take 7 iterations instead of 30 to 1e-3, and 9 instead
of 36 to 1e-8 (docs/performance.md).
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from stickslip.core.compiled import njit
from stickslip.core.threads import in_shares
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import ActiveRows
from stickslip.solve.harmonic.factors import Factor
from stickslip.solve.harmonic.harmonic_modes import IndexArray, LowRankCompliance
from stickslip.solve.harmonic.local_inverse import LocalInverse

# chosen: unknowns of one share of the products of D with the shapes, whose arrays remain in the cache.
OUTPUTS_AT_ONCE = 256


class ReducedEquations(Protocol):
    """The Newton equations ``I + D A``, see :class:`stickslip.solve.harmonic.reduced.NewtonSystem`."""

    active: ActiveRows
    columns: int
    size: int
    tangent: FloatArray

    def change_of_inputs(self, inputs: FloatArray) -> FloatArray: ...


class LowRankInverse:
    """The inverse of ``[I + D A_0, c; l, s]``.

    Parameters
    ----------
    system:
        the equations with D.
    compliance:
        A_0.
    columns, lines, corner:
        (b, size) c, (b, size) l and (b, b) s of b borders.
    """

    def __init__(
        self,
        system: ReducedEquations,
        compliance: LowRankCompliance,
        columns: FloatArray,
        lines: FloatArray,
        corner: FloatArray,
    ) -> None:
        self._local = None if compliance.local is None else LocalInverse(system, compliance.local)
        self._system, self._compliance, self._lines, self._columns = system, compliance, lines, columns
        self._shapes = tuple(map(np.ascontiguousarray, (compliance.mean, compliance.left)))  # once for all shares
        if self._local is None:
            products = self._products_in_shares()
        else:
            change = self._change_of_shapes(0, system.active.outputs.size)
            change = self._local.solve(change.reshape(system.size, -1)).reshape(change.shape)
            products = self._products(change, slice(None))
            self._columns = self._local.solve(columns.T).T
        n_shapes, borders = products.shape[1], len(columns)
        matrix = np.empty((n_shapes + borders, n_shapes + borders))
        matrix[:n_shapes, :n_shapes] = np.eye(n_shapes) + self._with_gain(products[:n_shapes])
        for i, column in enumerate(self._columns):
            matrix[:n_shapes, n_shapes + i] = compliance.amplitude(column.reshape(system.columns, -1))
        matrix[n_shapes:, :n_shapes] = -products[n_shapes:]
        matrix[n_shapes:, n_shapes:] = corner - lines @ self._columns.T
        self._factor = Factor(matrix)

    def solve(self, right: FloatArray) -> FloatArray:
        """The solution (size + b,) for a right-hand side; not finite where the matrix is singular."""
        system, compliance = self._system, self._compliance
        inner, border = right[: system.size], right[system.size :]
        if self._local is not None:
            inner = self._local.solve(inner)
        shapes = compliance.amplitude(inner.reshape(system.columns, -1))
        answer = self._factor.solve(np.append(shapes, border - self._lines @ inner))
        amplitude, parameters = answer[: shapes.size], answer[shapes.size :]
        change = system.change_of_inputs(compliance.relative(amplitude))
        if self._local is not None:
            change = self._local.solve(change)
        return np.append(inner - change - parameters @ self._columns, parameters)

    def _products_in_shares(self) -> FloatArray:
        """:meth:`_products` of all unknowns. ``D L`` of all of them, hundreds of megabytes, is never written; the
        shares are added in their order, so the digits do not depend on the threads."""
        count = self._system.active.outputs.size
        parts: dict[int, FloatArray] = {}

        def work(start: int, stop: int) -> None:
            for begin in range(start, stop, OUTPUTS_AT_ONCE):
                end = min(begin + OUTPUTS_AT_ONCE, stop)
                parts[begin] = self._products(self._change_of_shapes(begin, end), slice(begin, end))

        in_shares(work, count, OUTPUTS_AT_ONCE)
        return np.asarray(sum(parts[begin] for begin in sorted(parts)))

    def _products(self, change: FloatArray, unknowns: slice) -> FloatArray:
        """``L^T`` and the lines of the borders times ``D L`` (2H+1, r, j) of some unknowns: (c_0 + 2 H c + b, j)."""
        compliance, count = self._compliance, change.shape[2]
        modal = np.matmul(compliance.right[unknowns].T, change[1:])
        width, own = change.shape[:2]
        lines = self._lines.reshape(-1, width, self._system.active.outputs.size)[:, :, unknowns]
        of_lines = lines.reshape(-1, width * own) @ change.reshape(-1, count)
        return np.vstack([compliance.mean_right[unknowns].T @ change[0], modal.reshape(-1, count), of_lines])

    def _with_gain(self, products: FloatArray) -> FloatArray:
        """``G`` times products (c_0 + 2 H c, j) with L^T; that of the mean is 1."""
        compliance, count = self._compliance, products.shape[1]
        n_mean = compliance.mean_right.shape[1]
        modal = products[n_mean:].reshape(self._system.columns - 1, -1, count)
        cosine, sine = modal[0::2], modal[1::2]
        gain = compliance.gain
        times = np.multiply if gain.ndim == 2 else np.matmul
        real, imaginary = (part[:, :, None] if gain.ndim == 2 else part for part in (gain.real, gain.imag))
        answer = np.empty_like(modal)
        answer[0::2] = times(real, cosine) + times(imaginary, sine)
        answer[1::2] = times(real, sine) - times(imaginary, cosine)
        return np.vstack([products[:n_mean], answer.reshape(-1, count)])

    def _change_of_shapes(self, start: int, stop: int) -> FloatArray:
        """``D L`` (2H+1, r, c_0 + 2 H c) of the unknowns ``start`` to ``stop``."""
        system, (mean, left) = self._system, self._shapes
        active, width = system.active, system.columns
        tangent = system.tangent.reshape(active.pairs.size, 3, width, 3, width)
        answer = np.empty((width, stop - start, mean.shape[1] + (width - 1) * left.shape[1]))
        _changes(tangent, active.output_position[start:stop], mean, left, answer)
        return answer


@njit(cache=True, nogil=True, fastmath={"contract"})
def _changes(tangent: FloatArray, position: IndexArray, mean: FloatArray, left: FloatArray, answer: FloatArray) -> None:
    """``D L`` (2H+1, r, c_0 + 2 H c) of some unknowns.

    From D (n_moving, 3, 2H+1, 3, 2H+1), the ``position`` (r,) of each unknown among the 3 n_moving rows, and L of the
    mean (3 n_moving, c_0) and of the harmonics (3 n_moving, c).
    """
    width, n_mean, n_left = tangent.shape[2], mean.shape[1], left.shape[1]
    for k in range(len(position)):
        pair, axis = position[k] // 3, position[k] % 3
        numbers = tangent[pair, axis]
        mean_x, mean_y, mean_z = mean[3 * pair], mean[3 * pair + 1], mean[3 * pair + 2]
        x, y, z = left[3 * pair], left[3 * pair + 1], left[3 * pair + 2]
        for row in range(width):
            target = answer[row, k]
            a, b, c = numbers[row, 0, 0], numbers[row, 1, 0], numbers[row, 2, 0]
            for i in range(n_mean):
                target[i] = a * mean_x[i] + b * mean_y[i] + c * mean_z[i]
            for column in range(1, width):
                a, b, c = numbers[row, 0, column], numbers[row, 1, column], numbers[row, 2, column]
                part = target[n_mean + (column - 1) * n_left : n_mean + column * n_left]
                for i in range(n_left):
                    part[i] = a * x[i] + b * y[i] + c * z[i]
