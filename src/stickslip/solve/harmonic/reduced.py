"""Solve the reduced Newton system (I + D A) dd = -D R, bordered by k parameters and as many scalar equations.

A small system is factored. A large one is solved by GMRES without ever forming the matrix: A is a static compliance
plus a few modes, D works pair by pair. The structure around a joint is stiff compared with the stiffness that slip
releases, so I + D A is well conditioned (170 on the two-blade model with all pairs slipping) and a dozen iterations
give the digits that one Newton step can use. Where they do not (a light body that bounces on its contacts), the blocks
of few harmonics on the diagonal of the matrix are factored and precondition the system: the coupling of the harmonics
is what the iteration adds. Only if that fails the whole matrix is formed and factored. What was factored then
preconditions the systems of the next steps, which differ little from it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import ActiveRows, Balance, Trial
from stickslip.solve.harmonic.factors import BlockFactor, Factor, LastFactor, Product, iterated
from stickslip.solve.harmonic.harmonic_modes import LARGE_ROWS
from stickslip.solve.harmonic.low_rank import LowRankInverse
from stickslip.solve.path.problem import Step

# Below this size a factor, which serves for all right-hand sides, costs less than the iterations (measured: 0.9 ms with
# 330 rows, where 17 iterations cost 1.3 ms and 31 cost 5.6 ms). MAX_ITERATIONS chosen: ten times the usual number; a
# factor follows.
DIRECT_SIZE = 500
MAX_ITERATIONS = 120
# chosen: twice the usual largest number of iterations with the factor of an earlier system.
PRECONDITIONED_ITERATIONS = 60
# chosen: iterations without a factor after which it is needed. On the two-blade model a dozen are usual, and each takes
# a third of the time of one with the factors of its blocks.
TRIAL_ITERATIONS = 40
# chosen: a block on the diagonal has one harmonic, or as many as have no more than this number of rows (110 pairs that
# all separate, 46 harmonics, 26,600 rows: 79 iterations to 1e-6 with blocks of one harmonic, which take 1.7 s, 72 with
# blocks of two and 51 with blocks of five, which take 12 s; none in 240 iterations without).
BLOCK_ROWS = 1000
# chosen: a larger matrix is not factored as a whole (8000 rows: 20 s and 0.5 GB); the step then fails.
MOST_ROWS = 8000
ANSWER_TOLERANCE = 1e-6  # chosen: digits of the answers to borders, which all solutions with one matrix share


@dataclass(frozen=True)
class Row:
    """A scalar equation beside the balance, ``relative . dx + deviation . dd + parameters . dp = value``.

    ``relative`` and ``deviation`` are (2H+1, m), zero where None; ``parameters`` is (k,).
    """

    parameters: FloatArray
    relative: FloatArray | None = None
    deviation: FloatArray | None = None


class NewtonSystem:
    """The Newton equations of a trial: unknowns ``dd`` on the rows where the deviation can change, (2H+1, outputs)."""

    def __init__(self, balance: Balance, trial: Trial) -> None:
        self.active = ActiveRows.of(trial.contact)
        self.columns = 2 * balance.harmonics + 1
        self.rows = balance.rows
        self.tangent = balance.deviation_tangent(self.active, trial)
        self.compliance = balance.compliance.newton(trial.omega, self.active.outputs)
        self._balance, self._omega = balance, trial.omega
        self.size = self.columns * self.active.outputs.size  # number of unknowns

    def low_rank_inverse(self, columns: FloatArray, lines: FloatArray, corner: FloatArray) -> LowRankInverse | None:
        """The preconditioner of a large joint, with borders (:class:`LowRankInverse`); None for others."""
        stiffness = float(self._balance.springs.max(initial=0.0))
        if self.rows < LARGE_ROWS or not stiffness or not self.size:
            return None
        active = self.active
        compliance = self._balance.compliance.low_rank(self._omega, active.inputs, active.outputs, stiffness)
        return None if compliance is None else LowRankInverse(self, compliance, columns, lines, corner)

    def deviation_change(self, relative: FloatArray) -> FloatArray:
        """D @ relative: (size,) from (2H+1, m)."""
        return self.change_of_inputs(relative[:, self.active.inputs])

    def change_of_inputs(self, inputs: FloatArray) -> FloatArray:
        """D @ relative: (size,) from the rows (2H+1, 3 n_moving) of the moving pairs."""
        active, width = self.active, 3 * self.columns
        local = inputs.reshape(self.columns, active.pairs.size, 3)
        local = local.transpose(1, 2, 0).reshape(active.pairs.size, width, 1)
        force = (self.tangent.reshape(active.pairs.size, width, width) @ local).reshape(-1, self.columns)
        return np.asarray(force[active.output_position].T).ravel()

    def deviation_change_transposed(self, unknowns: FloatArray) -> FloatArray:
        """D^T @ unknowns: (2H+1, m) from (size,)."""
        active, width = self.active, 3 * self.columns
        local = np.zeros((3 * active.pairs.size, self.columns))
        local[active.output_position] = unknowns.reshape(self.columns, -1).T
        tangent = self.tangent.reshape(active.pairs.size, width, width)
        moved = (local.reshape(active.pairs.size, 1, width) @ tangent).reshape(-1, self.columns)
        full = np.zeros((self.columns, self.rows))
        full[:, active.inputs] = moved.T
        return full

    def comply(self, unknowns: FloatArray) -> FloatArray:
        """A @ unknowns: (2H+1, m) from (size,)."""
        return self.compliance.apply(unknowns.reshape(self.columns, -1))

    def scatter(self, unknowns: FloatArray) -> FloatArray:
        """(2H+1, m) with the unknowns (size,) in their rows."""
        full = np.zeros((self.columns, self.rows))
        full[:, self.active.outputs] = unknowns.reshape(self.columns, -1)
        return full

    def apply(self, unknowns: FloatArray) -> FloatArray:
        """(I + D A) @ unknowns."""
        inputs = self.compliance.apply_at(unknowns.reshape(self.columns, -1), self.active.inputs)
        return np.asarray(unknowns + self.change_of_inputs(inputs))

    def matrix(self, borders: int = 0, columns: slice | None = None) -> FloatArray:
        """I + D A (size, size), with so many rows and columns beside it that are not filled.

        With ``columns`` the block of these coefficients alone: with a cosine also its sine. The whole is the largest
        array of a curve: each block goes to its place at once, since new memory takes as long as a factor.
        """
        active, compliance = self.active, self.compliance
        first, last, _ = (columns or slice(None)).indices(self.columns)
        n_pairs, n_out, n_col, n_all = active.pairs.size, active.outputs.size, last - first, self.columns
        size = n_col * n_out
        matrix = np.empty((size + borders, size + borders))
        blocks = matrix[:size, :size].reshape(n_col, n_out, n_col, n_out)  # no copy: it splits both axes
        tangent = self.tangent.reshape(n_pairs, 3, n_all, 3, n_all)[:, :, first:last]
        tangent = tangent.reshape(n_pairs, 3 * n_col, 3, n_all)

        def fill(column: int, tangents: FloatArray, compliances: FloatArray) -> None:
            product = (tangents @ compliances).reshape(n_pairs * 3, n_col, n_out)
            blocks[:, :, column - first] = product[active.output_position].transpose(1, 0, 2)

        if first == 0:
            fill(0, tangent[:, :, :, 0], compliance.mean[:, active.inputs].T.reshape(n_pairs, 3, n_out))
        for order in range(first // 2 + 1, last // 2 + 1):
            block = compliance.block(order, active.inputs).reshape(n_pairs, 3, n_out)
            cosine, sine = 2 * order - 1, 2 * order
            # Complex amplitudes are c - i s, so x_c = a d_c + b d_s and x_s = a d_s - b d_c for A = a + i b.
            both = np.concatenate([tangent[:, :, :, cosine], tangent[:, :, :, sine]], axis=2)
            real, imaginary = block.real, block.imag
            fill(cosine, both, np.concatenate([real, -imaginary], axis=1))
            fill(sine, both, np.concatenate([imaginary, real], axis=1))
        diagonal = np.arange(size)
        matrix[diagonal, diagonal] += 1.0
        return matrix

    def blocks(self) -> list[slice]:
        """The coefficients of the blocks on the diagonal that are factored alone, see BLOCK_ROWS."""
        each = max(1, int(BLOCK_ROWS / (2 * max(self.active.outputs.size, 1))))  # harmonics
        firsts = [0, *range(2 * each + 1, self.columns, 2 * each)]
        return [slice(*ends) for ends in zip(firsts, [*firsts[1:], self.columns], strict=True)]


class BorderedSystem:
    """A Newton system with k borders: ``R_x dx + R_p dp = -R`` and k rows, see :class:`Row`.

    With ``dx = -R - R_p dp - A dd`` the unknowns are ``dd`` and ``dp``. Each border is scaled to unit length, so that
    one tolerance serves for all rows.

    Parameters
    ----------
    slopes:
        (k, 2H+1, m), the derivatives R_p.
    rows:
        k of them.
    last:
        the last factored system of the curve, which this system uses and replaces.
    """

    def __init__(
        self, system: NewtonSystem, slopes: Sequence[FloatArray], rows: Sequence[Row], last: LastFactor | None = None
    ) -> None:
        self.system = system
        self._last = last or LastFactor()
        self._slopes, self._rows = slopes, rows
        columns = [system.deviation_change(slope) for slope in slopes]
        scales = [_inverse(math.sqrt(float(np.vdot(column, column)))) for column in columns]
        lines, corner, lengths = [], [], []
        for row in rows:
            line, part = np.zeros(system.size), row.parameters.tolist()
            if row.relative is not None:
                line -= system.compliance.apply_transposed(row.relative).ravel()
                part = [at - float(np.vdot(row.relative, slope)) for at, slope in zip(part, slopes, strict=True)]
            if row.deviation is not None:
                line += row.deviation[:, system.active.outputs].ravel()
            part = [scale * at for scale, at in zip(scales, part, strict=True)]
            lengths.append(_inverse(math.hypot(math.sqrt(float(np.vdot(line, line))), *part)))
            lines.append(lengths[-1] * line)
            corner.append([lengths[-1] * at for at in part])
        self._column_scale, self._row_scale = scales, lengths
        self._columns = np.array([scale * column for scale, column in zip(scales, columns, strict=True)])
        self._columns = self._columns.reshape(len(rows), system.size)
        self._lines = np.array(lines).reshape(len(rows), system.size)
        self._corner = np.array(corner).reshape(len(rows), len(slopes))
        self._factor: Factor | None = None  # of a small system; a large one is only in ``last``
        self._name = object()
        self._approximate: tuple[LowRankInverse | None] | None = None

    def solve(self, residual: FloatArray, values: FloatArray, tolerance: float) -> Step:
        """The step for a residual (2H+1, m) and the values (k,) of the rows, to a relative ``tolerance``.

        ``Step.detail`` is the change (2H+1, m) of the deviation. Not finite where the system is singular.
        """
        system = self.system
        right = np.empty(system.size + len(self._rows))
        np.negative(system.deviation_change(residual), out=right[: system.size])
        for i, (row, scale, value) in enumerate(zip(self._rows, self._row_scale, values, strict=True)):
            along = 0.0 if row.relative is None else float(np.vdot(row.relative, residual))
            right[system.size + i] = scale * (float(value) + along)
        answer = None
        if system.size > DIRECT_SIZE and self._last.of(self._name) is None:
            answer = self._iterated(right, tolerance)
        if answer is None:
            answer = self._factored(right)
        if not np.isfinite(answer).all():
            nowhere = np.full_like(residual, np.nan)
            return Step(nowhere, np.full(len(self._rows), np.nan), nowhere)
        inner = answer[: system.size]
        parameters = np.asarray(self._column_scale) * answer[system.size :]
        relative = -residual
        for slope, change in zip(self._slopes, parameters, strict=True):
            relative -= slope * float(change)
        return Step(relative - system.comply(inner), parameters, system.scatter(inner))

    def solve_transposed(self, deviation: FloatArray, parameters: FloatArray) -> FloatArray:
        """(size,) multipliers of the Newton equations for weights (2H+1, m) of ``dd`` and (k,) of ``dp``.

        Their product with a right-hand side of these equations is the change of the weighted sum of the solution.
        """
        system = self.system
        right = np.append(deviation[:, system.active.outputs].ravel(), np.asarray(self._column_scale) * parameters)
        return self._whole_factor().solve_transposed(right)[: system.size]

    def multipliers(self, relative: FloatArray, deviation: FloatArray, parameters: FloatArray) -> FloatArray:
        """(2H+1, m) multipliers z of the balance for weights (2H+1, m) of ``dx`` and of ``dd``, and (k,) of ``dp``.

        If the residual R grows by e, the weighted sum of the solution changes by ``-z . e``, with the rows unchanged;
        the rows may contain ``relative`` parts only.
        """
        system = self.system
        by_deviation = deviation[:, system.active.outputs] - system.compliance.apply_transposed(relative)
        by_parameters = [
            at - float(np.vdot(relative, slope)) for at, slope in zip(parameters, self._slopes, strict=True)
        ]
        right = np.append(by_deviation.ravel(), np.asarray(self._column_scale) * by_parameters)
        answer = self._whole_factor().solve_transposed(right)
        result = relative + system.deviation_change_transposed(answer[: system.size])
        for row, scale, multiplier in zip(self._rows, self._row_scale, answer[system.size :], strict=True):
            assert row.relative is not None
            assert row.deviation is None
            result -= scale * float(multiplier) * row.relative
        return result

    def _apply(self, unknowns: FloatArray) -> FloatArray:
        """The bordered matrix @ unknowns (size + k,)."""
        size = self.system.size
        inner, border = unknowns[:size], unknowns[size:]
        answer = np.empty_like(unknowns)
        np.add(self.system.apply(inner), border @ self._columns, out=answer[:size])
        answer[size:] = self._lines @ inner + self._corner @ border
        return answer

    def keys(self) -> NDArray[np.int64]:
        """A number for each row: that of its coefficient and contact row, then negative ones of the borders.

        Systems with other harmonics have the same numbers for what they have in common.
        """
        system = self.system
        inner = np.arange(system.columns)[:, None] * system.rows + system.active.outputs
        return np.append(inner.ravel(), -1 - np.arange(len(self._rows)))

    def _iterated(self, right: FloatArray, tolerance: float) -> FloatArray | None:
        """The solution by GMRES, None if it did not converge."""
        return self._solved(self._apply, self.keys(), right, tolerance)

    def _solved(
        self, apply: Product, keys: NDArray[np.int64], right: FloatArray, tolerance: float
    ) -> FloatArray | None:
        """The solution of a matrix with rows ``keys`` by GMRES, None if it did not converge.

        With the last factor if there is one and it is needed, else without; then with the blocks of the matrix.
        """
        if not right.any():
            return np.zeros_like(right)
        answer = self._last.tried_without(lambda: iterated(apply, right, tolerance, TRIAL_ITERATIONS))
        if answer is not None:
            return answer
        inverse = self._last.inverse(keys)
        low_rank = None if inverse else self._low_rank(keys.size - self.system.size)
        near = inverse if low_rank is None else low_rank.solve
        most = MAX_ITERATIONS if near is None else PRECONDITIONED_ITERATIONS
        answer = iterated(apply, right, tolerance, most, near)
        blocks = self.system.blocks()
        if answer is not None or len(blocks) == 1:
            return answer
        self._last.forget()
        factor = self._block_factor(blocks, borders=keys.size - self.system.size)
        answer = iterated(apply, right, tolerance, MAX_ITERATIONS, factor.solve)
        if answer is not None:
            self._last.store(factor, keys)
        return answer

    def _low_rank(self, borders: int) -> LowRankInverse | None:
        """The inverse with a compliance of low rank of so many borders, computed once."""
        if self._approximate is None:
            beside = slice(0, borders)
            self._approximate = (
                self.system.low_rank_inverse(self._columns[beside], self._lines[beside], self._corner[beside, beside]),
            )
        return self._approximate[0]

    def _block_factor(self, blocks: Sequence[slice], borders: int) -> BlockFactor:
        """The factor of blocks of coefficients, of which the first one has the borders, if any."""
        system, parts = self.system, []
        outputs = system.active.outputs.size
        for columns in blocks:
            beside = 0 if columns.start else borders
            rows = np.arange(columns.start * outputs, columns.stop * outputs)
            block = system.matrix(beside, columns)
            if beside:
                self._border(block, rows)
                rows = np.append(rows, system.size + np.arange(beside))
            parts.append((rows, block))
        return BlockFactor(parts)

    def _border(self, matrix: FloatArray, rows: NDArray[np.int64] | slice) -> None:
        """Fill the borders of a matrix of some inner rows."""
        count = len(self._rows)
        inner = len(matrix) - count
        matrix[:inner, inner:], matrix[inner:, :inner] = self._columns[:, rows].T, self._lines[:, rows]
        matrix[inner:, inner:] = self._corner

    def _factored(self, right: FloatArray) -> FloatArray:
        """The solution with the factor of the whole matrix; not finite for a matrix too large for that."""
        if self.system.size > MOST_ROWS:
            return np.full_like(right, np.nan)
        return self._whole_factor().solve(right)

    def _whole_factor(self) -> Factor:
        """The factor of the bordered matrix."""
        factor, large = self._factor or self._last.of(self._name), self.system.size > DIRECT_SIZE
        if factor is None:
            if large:
                self._last.forget()  # before the next one takes as much memory
            bordered = self.system.matrix(borders=len(self._rows))
            self._border(bordered, slice(None))
            # A singular matrix gives a step that is not finite; Newton ends there and reports it.
            factor = Factor(bordered)
            if large:
                self._last.store(factor, self.keys(), self._name)
            else:
                self._factor = factor
        return factor


class EliminatedSystem(BorderedSystem):
    """A bordered system whose inner matrix ``I + D A`` is regular, so that GMRES solves it alone.

    Several borders have no common scale: in a nonlinear mode that is nearly linear they are almost independent of the
    inner unknowns, and one tolerance for all rows leaves no digits for the parameters. Here the parameters follow from
    the small system of the borders, exactly but for the answers of the inner matrix to them.
    """

    def __init__(
        self, system: NewtonSystem, slopes: Sequence[FloatArray], rows: Sequence[Row], last: LastFactor | None = None
    ) -> None:
        super().__init__(system, slopes, rows, last)
        self._answers: FloatArray | None = None  # (k, size) of the inner matrix to the borders
        self._inner_factor: Factor | None = None

    def _iterated(self, right: FloatArray, tolerance: float) -> FloatArray:
        size = self.system.size
        if self._answers is None:
            finest = min(tolerance, ANSWER_TOLERANCE)
            self._answers = np.array([self._inner(column, finest) for column in self._columns])
        inner = self._inner(right[:size], tolerance)
        corner = self._corner - self._lines @ self._answers.T
        border = Factor(corner).solve(right[size:] - self._lines @ inner)
        return np.append(inner - border @ self._answers, border)

    def _inner(self, right: FloatArray, tolerance: float) -> FloatArray:
        """The answer of the inner matrix, which is factored where GMRES does not converge."""
        keys = self.keys()[: self.system.size]
        if self._inner_factor is None:
            answer = self._solved(self.system.apply, keys, right, tolerance)
            if answer is not None:
                return answer
            self._last.forget()
            self._inner_factor = Factor(self.system.matrix())
            self._last.store(self._inner_factor, keys)
        return self._inner_factor.solve(right)


def _inverse(length: float) -> float:
    """1 / length, and 1 where the length is zero."""
    return 1.0 / length if length > 0.0 else 1.0
