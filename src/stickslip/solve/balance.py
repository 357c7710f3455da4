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
        return self.compliance.relative(omega, load * self.force, np.zeros((2 * self.harmonics + 1, self.rows)))

    def evaluate(self, relative: FloatArray, omega: float, load: float = 1.0) -> Trial:
        """Contact force, deviation and residual of a trial."""
        coefficients = np.ascontiguousarray(relative.T).reshape(self.pairs.n_pairs, 3, -1)
        contact = harmonic_force(coefficients, self.pairs, self.samples, update=self.update)
        deviation = contact.force.reshape(self.rows, -1).T - self._springs * relative
        # Where the pair sticks the tangential deviation is zero by definition, where it never opens the normal one is
        # that of its gap (zero under preload): round-off must not enter.
        still, closed = ~contact.deviates, contact.state != SEPARATING
        deviation[:, 0::3][:, still] = 0.0
        deviation[:, 1::3][:, still] = 0.0
        deviation[:, 2::3][:, closed] = 0.0
        deviation[0, 2::3][closed] = np.minimum(self.pairs.preload, 0.0)[closed]
        residual = relative - self.compliance.relative(omega, load * self.force, deviation)
        return Trial(omega, load, relative, deviation, contact, residual)

    def displacement(self, trial: Trial) -> FloatArray:
        """All unknowns (2H+1, n) of a trial."""
        return self.compliance.displacement(trial.omega, trial.load * self.force, trial.deviation)

    def displacement_change(self, trial: Trial, deviation: FloatArray, omega: float) -> FloatArray:
        """Change (2H+1, n) of :meth:`displacement` for small changes of the deviation and of the frequency."""
        slope = self.compliance.displacement_slope(trial.omega, trial.load * self.force, trial.deviation)
        return self.compliance.displacement(trial.omega, np.zeros_like(self.force), deviation) + slope * omega

    def frequency_slope(self, trial: Trial) -> FloatArray:
        """dR/dw (2H+1, m) at fixed x."""
        slope = self.compliance.displacement_slope(trial.omega, trial.load * self.force, trial.deviation)
        return -slope @ self.pairs.operator.T

    def deviation_tangent(self, active: ActiveRows, relative: FloatArray) -> FloatArray:
        """D (n_moving, 3, 2H+1, 3, 2H+1): derivative of the deviation of the moving pairs."""
        coefficients = np.ascontiguousarray(relative.T).reshape(self.pairs.n_pairs, 3, -1)
        tangent = harmonic_tangent(coefficients, self.pairs, self.samples, active.pairs, update=self.update)
        springs = self._springs.T.reshape(self.pairs.n_pairs, 3, -1)[active.pairs]
        for axis in range(3):
            for order in range(2 * self.harmonics + 1):
                tangent[:, axis, order, axis, order] -= springs[:, axis, order]
        return tangent
