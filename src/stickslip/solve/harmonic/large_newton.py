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
from stickslip.solve.harmonic.row_products import row_products, sums_of_rows

SingleArray = NDArray[np.float32]
IndexArray = NDArray[np.int64]

# chosen: with more columns than this share of all, products of all rows take less time than sums of these columns.
MANY_COLUMNS = 0.5
# chosen: shapes of the difference; and the largest eigenvalue beside them, over that of the far modes, whose own
# neglected inertia is as large. 440 pairs, of which none lacks springs on the mean: 18 are above it.
DIFFERENCE_SHAPES = 60
DIFFERENCE_REST = 1e-3
SPARE_SHAPES = 20  # chosen: random shapes beside so many, so that their space contains the softest ones nearly
SHAPE_TOLERANCE = 1e-6  # chosen: far below DIFFERENCE_REST


@dataclass(frozen=True)
class MeanDifference:
    """``S diag(w) S^T`` in m/N, what the mean compliance has beside that of the far modes: shapes S (m, q), w (q,)."""

    shapes: FloatArray
    weights: FloatArray


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
    return MeanDifference(shapes, values)


@dataclass(frozen=True)
class LargeNewtonCompliance:
    """``A`` of modes that all harmonics share, see :class:`stickslip.solve.harmonic.harmonic_modes.NewtonOperator`.

    The mean is the far compliance and a difference, or a matrix of its own. Both matrices are symmetric, so products
    with few of their rows or columns read these rows alone, and none of them is copied when pairs begin or cease to
    move. A difference whose shapes are the near modes is part of their products.
    """

    mean_part: MeanDifference | FloatArray  # the latter (m, m)
    far: SingleArray  # (m, m) static compliance of the far modes
    columns: IndexArray
    left: FloatArray  # (m, p) near modes at all rows
    right: FloatArray  # (k, p) near modes at the columns
    gain: ComplexArray  # (H, p) or (H, p, p)

    @property
    def mean(self) -> FloatArray:
        """(k, m) A of the mean."""
        if isinstance(self.mean_part, MeanDifference):
            shapes, weights = self.mean_part.shapes, self.mean_part.weights
            return np.asarray(self.far[self.columns] + (shapes[self.columns] * weights) @ shapes.T)
        return np.asarray(self.mean_part[self.columns])

    def apply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation: (2H+1, m) from (2H+1, k)."""
        if self.columns.size > MANY_COLUMNS * len(self.far):
            return self._at(deviation, None)
        if isinstance(self.mean_part, MeanDifference):
            answer = sums_of_rows(self.far, deviation, self.columns)
        else:
            mean, others = deviation[:1], deviation[1:]
            parts = sums_of_rows(self.mean_part, mean, self.columns), sums_of_rows(self.far, others, self.columns)
            answer = np.vstack(parts)
        return self._with_near(answer, deviation, None)

    def apply_at(self, deviation: FloatArray, rows: IndexArray) -> FloatArray:
        """A @ deviation at some rows: (2H+1, r) from (2H+1, k)."""
        return self._at(deviation, rows)

    def apply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: (2H+1, k) from (2H+1, m); that of complex amplitudes is the adjoint."""
        answer = self._of_matrices(weights, self.columns)
        amplitude = self._amplitude(weights @ self.left, adjoint_gain(self.gain))
        answer += row_products(self.left, amplitude, self.columns)
        if isinstance(other := self._other_difference, MeanDifference):
            answer[0] += other.shapes[self.columns] @ (other.weights * (weights[0] @ other.shapes))
        return answer

    def block(self, order: int, rows: IndexArray) -> ComplexArray:
        """``A_h`` (rows, k) of harmonic ``order`` >= 1."""
        return with_gain(self.gain[order - 1], self.left[rows], self.right) + self.far[np.ix_(rows, self.columns)]

    def _at(self, deviation: FloatArray, rows: IndexArray | None) -> FloatArray:
        """A @ deviation at some rows, or at all."""
        wide = np.zeros((len(deviation), len(self.far)))
        wide[:, self.columns] = deviation
        return self._with_near(self._of_matrices(wide, rows), deviation, rows)

    def _of_matrices(self, force: FloatArray, rows: IndexArray | None) -> FloatArray:
        """(2H+1, r) displacements of both matrices under forces (2H+1, m)."""
        if isinstance(self.mean_part, MeanDifference):
            return row_products(self.far, force, rows)
        return np.vstack([row_products(self.mean_part, force[:1], rows), row_products(self.far, force[1:], rows)])

    @property
    def _other_difference(self) -> MeanDifference | None:
        """The difference of the mean in other shapes than the near modes; None without one."""
        part = self.mean_part
        return part if isinstance(part, MeanDifference) and part.shapes is not self.left else None

    def _amplitude(self, force: FloatArray, gain: ComplexArray) -> FloatArray:
        """(2H+1, p) amplitudes of the near modes under forces on them; their mean is that of the difference."""
        answer = np.zeros_like(force)
        if isinstance(self.mean_part, MeanDifference) and self.mean_part.shapes is self.left:
            answer[0] = self.mean_part.weights * force[0]
        answer[1:] = times_gain(gain, force[1:])
        return answer

    def _with_near(self, answer: FloatArray, deviation: FloatArray, rows: IndexArray | None) -> FloatArray:
        """An answer at some rows, None for all, with the near modes, and with the difference of the mean."""
        answer += row_products(self.left, self._amplitude(deviation @ self.right, self.gain), rows)
        if isinstance(other := self._other_difference, MeanDifference):
            # of all rows, then the chosen ones: a copy of the shapes at these takes longer than the product
            mean = other.shapes @ (other.weights * (deviation[0] @ other.shapes[self.columns]))
            answer[0] += mean if rows is None else mean[rows]
        return answer
