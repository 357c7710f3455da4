"""The compliance in the Newton matrix of a large joint, with that of the far modes in single precision.

Its products read two matrices (m, k) from memory, many megabytes each, which takes most of the time of a curve. With
numbers of half the length, that of the far modes takes half the time or less. Newton's matrix contains springs for far
modes anyway (:data:`stickslip.solve.harmonic.compliance.NEAR_RANGE`), an error of 1e-3; that of 1e-7 changes neither
the solution nor the number of steps. The mean must not be rounded as a whole: a body that only friction supports is so
soft on it that the rounded matrix leaves 7e-5 of the right-hand side (440 pairs; 3e-10 with the far modes alone
rounded).

The mean compliance differs from that of the far modes by few soft shapes: the near modes, and the motions that lack
springs on the mean. One matrix with these shapes in double precision therefore serves for all coefficients
(:func:`mean_difference`), and a product reads a third of the numbers: 990 pairs 36 MB instead of 108 MB.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse.linalg
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.gain import ComplexArray, adjoint_gain, times_gain, with_gain
from stickslip.solve.harmonic.row_products import row_products

SingleArray = NDArray[np.float32]
IndexArray = NDArray[np.int64]

# chosen: with more columns than this share of all, products with all of them cost less than to take these out.
MANY_COLUMNS = 0.5
# chosen: shapes of the difference; and the largest eigenvalue beside them, over that of the far modes, whose own
# neglected inertia is as large. 440 pairs, of which none lacks springs on the mean: 18 are above it.
DIFFERENCE_SHAPES = 60
DIFFERENCE_REST = 1e-3
SPARE_SHAPES = 20  # chosen: random shapes beside so many, so that their space contains the softest ones nearly
SHAPE_TOLERANCE = 1e-6  # chosen: far below DIFFERENCE_REST


@dataclass(frozen=True)
class MeanDifference:
    """``L R^T`` in m/N, what the mean compliance has beside that of the far modes: (m, q) and (k, q)."""

    left: FloatArray
    right: FloatArray

    def on(self, columns: IndexArray) -> MeanDifference:
        """The difference for deviations on some rows."""
        return MeanDifference(self.left, self.right[columns])


def mean_difference(mean: FloatArray, far: FloatArray) -> MeanDifference | None:
    """The difference of two symmetric compliances (m, m), None if it has more soft shapes than DIFFERENCE_SHAPES."""
    count, difference = min(DIFFERENCE_SHAPES, len(far) - 1), mean - far
    random = np.random.default_rng(0)  # the same in every run

    def largest(matrix: FloatArray, number: int) -> tuple[FloatArray, FloatArray]:
        start = random.standard_normal(len(far))
        values, shapes = scipy.sparse.linalg.eigsh(matrix, number, which="LM", v0=start, tol=SHAPE_TOLERANCE)
        return values, shapes

    limit = DIFFERENCE_REST * np.abs(largest(far, 1)[0][0])
    # The singular values of a part are no larger than those of the whole: this tells a joint whose pairs lack springs
    # on the mean within two products with the matrix, where the iteration takes hundreds.
    basis = np.linalg.qr(difference @ random.standard_normal((len(far), min(count + SPARE_SHAPES, len(far)))))[0]
    if np.linalg.svd(basis.T @ difference, compute_uv=False)[count - 1] > limit:
        return None
    values, shapes = largest(difference, count)
    if np.abs(values).min() > limit:
        return None
    return MeanDifference(shapes * values, shapes)


@dataclass(frozen=True)
class LargeNewtonCompliance:
    """``A`` of modes that all harmonics share, see :class:`stickslip.solve.harmonic.harmonic_modes.NewtonOperator`.

    The mean is the far compliance and a difference, or a matrix (m, k). The static compliance ``far_rows`` of the far
    modes contains ``columns`` alone (m, k), or all of them (m, m) where that costs less than to take them out, which
    each change of a contact state requires again.
    """

    mean_part: MeanDifference | FloatArray
    far_rows: SingleArray
    columns: IndexArray
    left: FloatArray  # (m, p) near modes at all rows
    right: FloatArray  # (k, p) near modes at the columns
    gain: ComplexArray  # (H, p) or (H, p, p)

    @property
    def mean(self) -> FloatArray:
        """(k, m) A of the mean."""
        if isinstance(self.mean_part, MeanDifference):
            return np.asarray(self._far_columns().T + self.mean_part.right @ self.mean_part.left.T)
        return self.mean_part.T

    def apply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation: (2H+1, m) from (2H+1, k)."""
        near = times_gain(self.gain, deviation[1:] @ self.right) @ self.left.T
        if isinstance(self.mean_part, MeanDifference):
            answer = self._of_far(deviation)
            answer[0] += self.mean_part.left @ (deviation[0] @ self.mean_part.right)
            answer[1:] += near
            return answer
        return np.vstack([row_products(self.mean_part, deviation[:1]), near + self._of_far(deviation[1:])])

    def apply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: (2H+1, k) from (2H+1, m); that of complex amplitudes is the adjoint."""
        answer = np.asarray(weights.astype(np.float32) @ self.far_rows, dtype=float)
        if self._has_others:
            answer = answer[:, self.columns]
        if isinstance(self.mean_part, MeanDifference):
            answer[0] += self.mean_part.right @ (weights[0] @ self.mean_part.left)
        else:
            answer[0] = weights[0] @ self.mean_part
        answer[1:] += times_gain(adjoint_gain(self.gain), weights[1:] @ self.left) @ self.right.T
        return answer

    def block(self, order: int, rows: IndexArray) -> ComplexArray:
        """``A_h`` (rows, k) of harmonic ``order`` >= 1."""
        return with_gain(self.gain[order - 1], self.left[rows], self.right) + self._far_columns(rows)

    @property
    def _has_others(self) -> bool:
        """Whether ``far_rows`` has more columns than ``columns``."""
        return int(self.far_rows.shape[1]) != self.columns.size

    def _of_far(self, deviation: FloatArray) -> FloatArray:
        """(c, m) displacements of the far modes under deviations (c, k)."""
        if not self._has_others:
            return row_products(self.far_rows, deviation)
        wide = np.zeros((len(deviation), self.far_rows.shape[1]))
        wide[:, self.columns] = deviation
        return row_products(self.far_rows, wide)

    def _far_columns(self, rows: IndexArray | slice = slice(None)) -> SingleArray:
        """(rows, k) of the far compliance."""
        return self.far_rows[rows][:, self.columns] if self._has_others else self.far_rows[rows]
