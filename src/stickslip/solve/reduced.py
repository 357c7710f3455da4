"""Solve the reduced Newton system (I + D A) dd = -D R, with the frequency as one more unknown.

A small system is factored. A large one is solved by GMRES without ever forming the matrix: A is applied through the
modes of the stuck structure and D pair by pair. The structure around a joint is stiff compared with what friction lets
go, so I + D A is well conditioned (170 on the two-blade model with all pairs slipping) and some thirty iterations
suffice; where they do not, the matrix is formed and factored.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.sparse.linalg import LinearOperator, gmres

from stickslip.solve.balance import ActiveRows, Balance, Trial
from stickslip.validation import FloatArray

# Below this size a factor costs less than some tens of iterations.
DIRECT_SIZE = 300
# Accuracy of the iteration; Newton then gains at least this factor in each step.
ITERATION_TOLERANCE = 1e-7
MAX_ITERATIONS = 120


@dataclass(frozen=True)
class Step:
    """A solution of the Newton system: changes of x, of the deviation (both (2H+1, m)) and of the frequency."""

    relative: FloatArray
    deviation: FloatArray
    omega: float


class NewtonSystem:
    """The Newton equations of a trial: unknowns ``dd`` on the rows where the deviation can change, (2H+1, outputs)."""

    def __init__(self, balance: Balance, trial: Trial) -> None:
        self._balance = balance
        self._trial = trial
        self.active = ActiveRows.of(trial.contact)
        self._columns = 2 * balance.harmonics + 1
        self._tangent = balance.deviation_tangent(self.active, trial.relative)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self._columns * self.active.outputs.size

    def deviation_change(self, relative: FloatArray) -> FloatArray:
        """D @ relative: (size,) from (2H+1, m)."""
        active = self.active
        local = relative[:, active.inputs].reshape(self._columns, active.pairs.size, 3)
        local = local.transpose(1, 2, 0).reshape(active.pairs.size, 3 * self._columns, 1)
        force = (self._tangent.reshape(active.pairs.size, 3 * self._columns, 3 * self._columns) @ local).reshape(
            -1, self._columns
        )
        return np.asarray(force[active.output_position].T).ravel()

    def scatter(self, unknowns: FloatArray) -> FloatArray:
        """(2H+1, m) with the unknowns (size,) in their rows."""
        full = np.zeros((self._columns, self._balance.rows))
        full[:, self.active.outputs] = unknowns.reshape(self._columns, -1)
        return full

    def comply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation, (2H+1, m)."""
        return -self._balance.compliance.relative(self._trial.omega, None, deviation)

    def comply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: each A_h is complex symmetric, so flipping the sign of the sines before and after does it."""
        flipped = weights.copy()
        flipped[2::2] *= -1.0
        answer = self.comply(flipped)
        answer[2::2] *= -1.0
        return answer

    def apply(self, unknowns: FloatArray) -> FloatArray:
        """(I + D A) @ unknowns."""
        return np.asarray(unknowns + self.deviation_change(self.comply(self.scatter(unknowns))))

    def matrix(self) -> FloatArray:
        """I + D A (size, size)."""
        active, compliance, omega = self.active, self._balance.compliance, self._trial.omega
        n_pairs, n_out, n_col = active.pairs.size, active.outputs.size, self._columns
        product = np.empty((n_pairs, 3 * n_col, n_col, n_out))
        tangent = self._tangent.reshape(n_pairs, 3 * n_col, 3, n_col)
        mean = compliance.mean_block(active.inputs, active.outputs).reshape(n_pairs, 3, n_out)
        np.matmul(tangent[:, :, :, 0], mean, out=product[:, :, 0])
        for order in range(1, self._balance.harmonics + 1):
            block = compliance.block(omega, order, active.inputs, active.outputs).reshape(n_pairs, 3, n_out)
            cosine, sine = 2 * order - 1, 2 * order
            # Complex amplitudes are c - i s, so x_c = a d_c + b d_s and x_s = a d_s - b d_c for A = a + i b.
            both = np.concatenate([tangent[:, :, :, cosine], tangent[:, :, :, sine]], axis=2)
            real, imaginary = block.real, block.imag
            product[:, :, cosine] = both @ np.concatenate([real, -imaginary], axis=1)
            product[:, :, sine] = both @ np.concatenate([imaginary, real], axis=1)
        matrix = product.reshape(n_pairs * 3, n_col, n_col, n_out)[active.output_position]
        matrix = np.ascontiguousarray(matrix.transpose(1, 0, 2, 3)).reshape(n_col * n_out, n_col * n_out)
        matrix[np.diag_indices(matrix.shape[0])] += 1.0
        return matrix


def _gmres(system: NewtonSystem, right: FloatArray) -> FloatArray | None:
    """The solution of ``(I + D A) y = right``, or None if it was not reached."""
    if not right.any():
        return np.zeros(system.size)
    operator = LinearOperator((system.size, system.size), matvec=lambda v: system.apply(v.ravel()), dtype=float)
    answer, failure = gmres(operator, right, rtol=ITERATION_TOLERANCE, atol=0.0, restart=MAX_ITERATIONS, maxiter=2)
    return None if failure else np.asarray(answer)


class BorderedSystem(ABC):
    """A Newton system with one border: ``R_x dx + R_w dw = -R`` and ``weights . dx + weight dw = constraint``."""

    def __init__(self, system: NewtonSystem, slope: FloatArray, weights: FloatArray, weight: float) -> None:
        self._system, self._slope, self._weights = system, slope, weights
        # With dx = -R - R_w dw - A dd the border row acts on the unknowns dd and dw:
        self._row = -system.comply_transposed(weights)[:, system.active.outputs].ravel()
        self._corner = weight - float((weights * slope).sum())
        self._column = system.deviation_change(slope)

    def solve(self, residual: FloatArray, constraint: float) -> Step:
        """The step for a residual (2H+1, m) and a value of the constraint."""
        right = -self._system.deviation_change(residual)
        unknowns, omega = self._unknowns(right, constraint + float((self._weights * residual).sum()))
        deviation = self._system.scatter(unknowns)
        relative = -residual - self._slope * omega - self._system.comply(deviation)
        return Step(relative, deviation, omega)

    @abstractmethod
    def _unknowns(self, right: FloatArray, constraint: float) -> tuple[FloatArray, float]:
        """dd (size,) and dw for the right-hand sides of the rows and of the border."""


class FactoredSystem(BorderedSystem):
    """The bordered matrix, factored."""

    def __init__(self, system: NewtonSystem, slope: FloatArray, weights: FloatArray, weight: float) -> None:
        super().__init__(system, slope, weights, weight)
        size = system.size
        bordered = np.empty((size + 1, size + 1))
        bordered[:size, :size] = system.matrix()
        bordered[:size, size] = self._column
        bordered[size, :size] = self._row
        bordered[size, size] = self._corner
        self._factor = scipy.linalg.lu_factor(bordered, overwrite_a=True, check_finite=False)

    def _unknowns(self, right: FloatArray, constraint: float) -> tuple[FloatArray, float]:
        answer = scipy.linalg.lu_solve(self._factor, np.append(right, constraint), check_finite=False)
        return answer[:-1], float(answer[-1])


class IteratedSystem(BorderedSystem):
    """The border eliminated: one iterative solution for each right-hand side; a factor from the first that fails."""

    def __init__(self, system: NewtonSystem, slope: FloatArray, weights: FloatArray, weight: float) -> None:
        super().__init__(system, slope, weights, weight)
        self._weight = weight
        self._factored: FactoredSystem | None = None
        self._column_answer = _gmres(system, self._column)

    def _unknowns(self, right: FloatArray, constraint: float) -> tuple[FloatArray, float]:
        if self._factored is None and self._column_answer is not None:
            plain = _gmres(self._system, right)
            if plain is not None:
                schur = self._corner - float(self._row @ self._column_answer)
                omega = (constraint - float(self._row @ plain)) / schur
                return plain - omega * self._column_answer, omega
        self._factored = self._factored or FactoredSystem(self._system, self._slope, self._weights, self._weight)
        return self._factored._unknowns(right, constraint)


def bordered_system(
    balance: Balance, trial: Trial, slope: FloatArray, weights: FloatArray, weight: float
) -> BorderedSystem:
    """The Newton system of ``trial`` bordered by dR/dw = ``slope`` and the row ``weights . dx + weight dw``."""
    system = NewtonSystem(balance, trial)
    kind = FactoredSystem if system.size <= DIRECT_SIZE else IteratedSystem
    return kind(system, slope, weights, weight)
