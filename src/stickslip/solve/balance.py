"""The balance of one frequency: R(x) = x - r(w) + A(w) d(x), and its Newton system reduced to the moving pairs.

``x`` holds the Fourier coefficients of the relative displacements of all pairs, ``r`` those of the linear structure
with every contact stuck, ``d`` the deviation of the contact force from ``preload + k x``. A pair that sticks through
the whole period has ``d = 0``, and its normal row has ``d = 0`` until it opens, so with ``D = dd/dx``

    (I + A D) dx = -R   <=>   (I + D A) dd = -D R,   dx = -R - A dd

needs only the rows of ``dd`` that are not zero: two tangential rows for each pair that moves, and the normal row where
the pair separates. Everything else follows by back substitution; nothing is approximated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.interface.contact_pairs import ContactPairs
from stickslip.interface.friction import HarmonicForce, Update, harmonic_force, harmonic_tangent
from stickslip.solve.compliance import Compliance
from stickslip.validation import FloatArray

SEPARATING = 2


@dataclass(frozen=True)
class Trial:
    """A trial solution and what follows from it; coefficients (2H+1, m) with m = 3 * n_pairs rows t1, t2, n."""

    omega: float
    load: float
    relative: FloatArray
    deviation: FloatArray
    contact: HarmonicForce
    residual: FloatArray

    @property
    def error(self) -> float:
        """Norm of the residual relative to the norm of the relative displacement."""
        scale = float(np.linalg.norm(self.relative))
        return float(np.linalg.norm(self.residual)) / scale if scale > 0 else float(np.linalg.norm(self.residual))


@dataclass(frozen=True)
class ActiveRows:
    """Rows of the contact coefficients that the reduced Newton system keeps."""

    pairs: NDArray[np.int64]  # pairs that move
    inputs: NDArray[np.int64]  # their 3 rows each: what the force depends on
    outputs: NDArray[np.int64]  # rows where the deviation is not zero
    output_position: NDArray[np.int64]  # position of each output among 3 * len(pairs) rows

    @classmethod
    def of(cls, contact: HarmonicForce) -> ActiveRows:
        """Two tangential rows of every pair that moves, and the normal row of those that separate."""
        moving = np.flatnonzero(contact.deviates)
        keep = np.ones((moving.size, 3), dtype=bool)
        keep[:, 2] = contact.state[moving] == SEPARATING
        inputs = (3 * moving[:, None] + np.arange(3)).ravel()
        position = np.flatnonzero(keep.ravel())
        return cls(moving, inputs, inputs[position], position)


class Balance:
    """One structure, one joint, one excitation: residuals and Newton systems at any frequency.

    Parameters
    ----------
    compliance:
        answer of the stuck structure (m rows, n unknowns).
    pairs:
        contact pairs.
    force:
        (2H+1, n) N, coefficients of the external force.
    samples:
        time samples per period for the friction law.
    update:
        "tractrix" or "radial".
    """

    def __init__(
        self, compliance: Compliance, pairs: ContactPairs, force: FloatArray, samples: int, update: Update
    ) -> None:
        self.compliance = compliance
        self.pairs = pairs
        self.force = force
        self.samples = samples
        self.update = update
        self.harmonics = compliance.harmonics
        # Springs of a stuck pair, (2H+1, m). On the mean a stuck pair has no traction: its slider sits at the mean.
        springs = pairs.stuck_stiffness().reshape(-1, 3)
        self._springs = np.repeat(springs.reshape(1, -1), 2 * self.harmonics + 1, axis=0)
        self._springs[0] = (springs * np.array([0.0, 0.0, 1.0])).ravel()

    @property
    def rows(self) -> int:
        """Number m of rows of relative displacement."""
        return 3 * self.pairs.n_pairs

    def linear(self, omega: float, load: float = 1.0) -> FloatArray:
        """Relative displacement (2H+1, m) with every contact stuck, under ``load`` times the force."""
        return self.relative_of(omega, load * self.force, np.zeros((2 * self.harmonics + 1, self.rows)))

    def relative_of(self, omega: float, force: FloatArray, deviation: FloatArray) -> FloatArray:
        """``B u`` (2H+1, m) for given external force and deviation."""
        return self.compliance.displacement(omega, force, deviation) @ self.pairs.operator.T

    def evaluate(self, relative: FloatArray, omega: float, load: float = 1.0) -> Trial:
        """Contact force, deviation and residual of a trial."""
        coefficients = np.ascontiguousarray(relative.T).reshape(self.pairs.n_pairs, 3, -1)
        contact = harmonic_force(coefficients, self.pairs, self.samples, update=self.update)
        deviation = contact.force.reshape(self.rows, -1).T - self._springs * relative
        # Where the pair sticks, or never opens, the deviation is zero by definition: round-off must not enter.
        deviation[:, np.repeat(~contact.deviates, 3)] = 0.0
        deviation[:, 2::3][:, contact.state != SEPARATING] = 0.0
        residual = relative - self.relative_of(omega, load * self.force, deviation)
        return Trial(omega, load, relative, deviation, contact, residual)

    def frequency_slope(self, trial: Trial) -> FloatArray:
        """dR/dw (2H+1, m) at fixed x."""
        slope = self.compliance.displacement_slope(trial.omega, trial.load * self.force, trial.deviation)
        return -slope @ self.pairs.operator.T

    def load_slope(self, trial: Trial) -> FloatArray:
        """dR/d load (2H+1, m) at fixed x."""
        return -self.linear(trial.omega)

    def newton_system(self, trial: Trial) -> NewtonSystem:
        """The reduced, bordered linear system at a trial."""
        return NewtonSystem(self, trial)

    def deviation_tangent(self, active: ActiveRows, relative: FloatArray) -> FloatArray:
        """D (n_moving, 3, 2H+1, 3, 2H+1): derivative of the deviation of the moving pairs."""
        coefficients = np.ascontiguousarray(relative.T).reshape(self.pairs.n_pairs, 3, -1)
        tangent = harmonic_tangent(coefficients, self.pairs, self.samples, active.pairs, update=self.update)
        springs = self._springs.T.reshape(self.pairs.n_pairs, 3, -1)[active.pairs]
        for axis in range(3):
            for order in range(2 * self.harmonics + 1):
                tangent[:, axis, order, axis, order] -= springs[:, axis, order]
        return tangent


class NewtonSystem:
    """Solves the Newton equations of a trial together with one more unknown (a frequency or a load).

    The unknowns are ``dd`` (2H+1, outputs) and the parameter step; the border row is ``weights . dx + weight * dp``.
    """

    def __init__(self, balance: Balance, trial: Trial) -> None:
        self._balance = balance
        self._trial = trial
        self._active = ActiveRows.of(trial.contact)
        self._columns = 2 * balance.harmonics + 1
        size = self._active.outputs.size
        # (outputs * (2H+1)) rows of D over (2H+1, inputs): deviation coefficients from displacement coefficients.
        self._tangent = balance.deviation_tangent(self._active, trial.relative) if size else np.empty((0, 3, 0, 3, 0))
        self._matrix = self._reduced_matrix() if size else np.zeros((0, 0))

    @property
    def size(self) -> int:
        """Number of unknowns of the reduced system."""
        return int(self._matrix.shape[0])

    def _tangent_apply(self, relative: FloatArray) -> FloatArray:
        """D @ relative: (2H+1, outputs) from (2H+1, m)."""
        active = self._active
        local = relative[:, active.inputs].T.reshape(active.pairs.size, 3, self._columns)
        force: FloatArray = np.einsum("iapbq,ibq->iap", self._tangent, local, optimize=True)
        return force.reshape(-1, self._columns)[active.output_position].T

    def _reduced_matrix(self) -> FloatArray:
        """I + D A on the output rows; order of unknowns: (2H+1, outputs) row-major."""
        active, compliance, omega = self._active, self._balance.compliance, self._trial.omega
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
        matrix = matrix.transpose(1, 0, 2, 3).reshape(n_col * n_out, n_col * n_out)
        matrix = np.ascontiguousarray(matrix)
        matrix[np.diag_indices(matrix.shape[0])] += 1.0
        return matrix

    def _scatter(self, outputs: FloatArray) -> FloatArray:
        """(2H+1, m) from values on the output rows (2H+1, outputs)."""
        full = np.zeros((self._columns, self._balance.rows))
        full[:, self._active.outputs] = outputs
        return full

    def _comply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation, (2H+1, m)."""
        return -self._balance.relative_of(self._trial.omega, np.zeros_like(self._balance.force), deviation)

    def _comply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: each A_h is complex symmetric, so flipping the sign of the sines before and after does it."""
        flipped = weights.copy()
        flipped[2::2] *= -1.0
        answer = self._comply(flipped)
        answer[2::2] *= -1.0
        return answer

    def factor(self, slope: FloatArray, weights: FloatArray, weight: float) -> BorderedFactor:
        """Factor the system bordered by dR/dp = ``slope`` and the row ``weights . dx + weight dp``."""
        size = self.size
        bordered = np.empty((size + 1, size + 1))
        bordered[:size, :size] = self._matrix
        bordered[:size, size] = self._tangent_apply(slope).ravel() if size else 0.0
        bordered[size, :size] = -self._comply_transposed(weights)[:, self._active.outputs].ravel()
        bordered[size, size] = weight - float((weights * slope).sum())
        return BorderedFactor(
            self, scipy.linalg.lu_factor(bordered, overwrite_a=True, check_finite=False), slope, weights
        )


class BorderedFactor:
    """A factored Newton system with one border; solves for steps of all rows and of the parameter."""

    def __init__(
        self,
        system: NewtonSystem,
        factor: tuple[FloatArray, NDArray[np.int32]],
        slope: FloatArray,
        weights: FloatArray,
    ) -> None:
        self._system = system
        self._factor = factor
        self._slope = slope
        self._weights = weights

    def solve(self, residual: FloatArray, constraint: float) -> tuple[FloatArray, float]:
        """Steps (2H+1, m) and dp with ``R + R_x dx + R_p dp = 0`` and ``weights . dx + weight dp = constraint``."""
        system = self._system
        size = system.size
        right = np.empty(size + 1)
        right[:size] = -system._tangent_apply(residual).ravel() if size else 0.0
        right[size] = constraint + float((self._weights * residual).sum())
        answer = scipy.linalg.lu_solve(self._factor, right, check_finite=False)
        parameter = float(answer[size])
        step = -residual - self._slope * parameter
        if size:
            outputs = answer[:size].reshape(step.shape[0], -1)
            step -= system._comply(system._scatter(outputs))
        return step, parameter
