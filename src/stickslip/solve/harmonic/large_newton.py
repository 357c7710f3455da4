"""The compliance in the Newton matrix of a large joint, with that of the far modes in single precision.

Its products read two matrices (m, k) from memory, many megabytes each, which takes most of the time of a curve. With
numbers of half the length, that of the far modes takes half the time or less. Newton's matrix contains springs for far
modes anyway (:data:`stickslip.solve.harmonic.compliance.NEAR_RANGE`), an error of 1e-3; that of 1e-7 changes neither
the solution nor the number of steps. The mean has double precision: a body that only friction supports is so soft on
the mean that the rounded matrix leaves 7e-5 of the right-hand side (440 pairs; 3e-10 with the far modes alone rounded).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.gain import ComplexArray, adjoint_gain, times_gain, with_gain
from stickslip.solve.harmonic.row_products import row_products

SingleArray = NDArray[np.float32]
IndexArray = NDArray[np.int64]


@dataclass(frozen=True)
class LargeNewtonCompliance:
    """``A`` of modes that all harmonics share, see :class:`stickslip.solve.harmonic.harmonic_modes.NewtonOperator`."""

    mean_rows: FloatArray  # (m, k)
    far_rows: SingleArray  # (m, k) static compliance of the far modes
    left: FloatArray  # (m, p) near modes at all rows
    right: FloatArray  # (k, p) near modes at the columns
    gain: ComplexArray  # (H, p) or (H, p, p)

    @property
    def mean(self) -> FloatArray:
        """(k, m) A of the mean."""
        return self.mean_rows.T

    def apply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation: (2H+1, m) from (2H+1, k)."""
        answer = times_gain(self.gain, deviation[1:] @ self.right) @ self.left.T
        answer += row_products(self.far_rows, deviation[1:])
        return np.vstack([row_products(self.mean_rows, deviation[:1]), answer])

    def apply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: (2H+1, k) from (2H+1, m); that of complex amplitudes is the adjoint."""
        near = times_gain(adjoint_gain(self.gain), weights[1:] @ self.left)
        far = weights[1:].astype(np.float32) @ self.far_rows
        return np.vstack([weights[:1] @ self.mean_rows, far + near @ self.right.T])

    def block(self, order: int, rows: IndexArray) -> ComplexArray:
        """``A_h`` (rows, k) of harmonic ``order`` >= 1."""
        return with_gain(self.gain[order - 1], self.left[rows], self.right) + self.far_rows[rows]
