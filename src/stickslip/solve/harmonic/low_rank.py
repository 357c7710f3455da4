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

# chosen: unknowns of one share of the products of D with the shapes.
OUTPUTS_AT_ONCE = 128


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
        self._system, self._compliance, self._lines = system, compliance, lines
        of_unknowns = self._change_of_shapes().reshape(system.size, -1)
        if self._local is not None:
            of_unknowns, columns = self._local.solve(of_unknowns), self._local.solve(columns.T).T
        self._columns = columns
        n_shapes, borders = of_unknowns.shape[1], len(columns)
        inner = of_unknowns.reshape(system.columns, -1, n_shapes)
        matrix = np.empty((n_shapes + borders, n_shapes + borders))
        matrix[:n_shapes, :n_shapes] = np.eye(n_shapes) + self._amplitudes(inner)
        for i, column in enumerate(columns):
            matrix[:n_shapes, n_shapes + i] = compliance.amplitude(column.reshape(system.columns, -1))
        matrix[n_shapes:, :n_shapes] = -(lines @ of_unknowns)
        matrix[n_shapes:, n_shapes:] = corner - lines @ columns.T
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

    def _change_of_shapes(self) -> FloatArray:
        """``D L`` (2H+1, k, c_0 + 2 H c)."""
        system, compliance = self._system, self._compliance
        active, width = system.active, system.columns
        tangent = system.tangent.reshape(active.pairs.size, 3, width, 3, width)
        n_shapes = compliance.mean.shape[1] + (width - 1) * compliance.left.shape[1]
        answer = np.empty((width, active.outputs.size, n_shapes))
        arrays = tangent, active.output_position, *map(np.ascontiguousarray, (compliance.mean, compliance.left)), answer
        in_shares(lambda start, stop: _changes(*arrays, start, stop), active.outputs.size, OUTPUTS_AT_ONCE)
        return answer

    def _amplitudes(self, change: FloatArray) -> FloatArray:
        """``G L^T`` of columns (2H+1, k, j): (c_0 + 2 H c, j)."""
        compliance, count = self._compliance, change.shape[2]
        modal = np.empty((len(change) - 1, compliance.right.shape[1], count))

        def project(start: int, stop: int) -> None:
            for row in range(start, stop):
                np.matmul(compliance.right.T, change[1 + row], out=modal[row])

        in_shares(project, len(modal), 1)
        cosine, sine = modal[0::2], modal[1::2]
        gain = compliance.gain
        times = np.multiply if gain.ndim == 2 else np.matmul
        real, imaginary = (part[:, :, None] if gain.ndim == 2 else part for part in (gain.real, gain.imag))
        answer = np.empty_like(modal)
        answer[0::2] = times(real, cosine) + times(imaginary, sine)
        answer[1::2] = times(real, sine) - times(imaginary, cosine)
        return np.vstack([compliance.mean_right.T @ change[0], answer.reshape(-1, count)])


@njit(cache=True, nogil=True, fastmath={"contract"})
def _changes(
    tangent: FloatArray,
    position: IndexArray,
    mean: FloatArray,
    left: FloatArray,
    answer: FloatArray,
    start: int,
    stop: int,
) -> None:
    """``D L`` (2H+1, k, c_0 + 2 H c) of the unknowns ``start`` to ``stop``.

    From D (n_moving, 3, 2H+1, 3, 2H+1), the ``position`` (k,) of each unknown among the 3 n_moving rows, and L of the
    mean (3 n_moving, c_0) and of the harmonics (3 n_moving, c).
    """
    width, n_mean, n_left = tangent.shape[2], mean.shape[1], left.shape[1]
    for k in range(start, stop):
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
