"""The stuck structure of a large joint with its soft modes alone, without the others.

All n modes of a structure take about 10 n^3 operations, and those of a joint of 5,000 pairs more than an hour. The
balance of a curve requires few of them (:mod:`stickslip.solve.harmonic.kept_modes`): the modes up to KEPT_RANGE times
the excitation, here from a block Lanczos iteration, and of the others only their static compliance, which is that of
the structure less that of the kept shapes,

    A_s = B Kbar^-1 B^T - sum_kept c_j c_j^T / w_j^2.

``Kbar^-1`` comes from one Cholesky factor (n^3 / 3 operations), its rows at the pairs from the inverse (2/3 n^3). The
added shapes are those of :mod:`stickslip.solve.harmonic.kept_modes`, as vectors of the unknowns: the static responses
``Kbar^-1 f`` to the force and to each unknown on which no pair depends, and those to their inertia, without the kept
modes. The shapes of the free structure near the excitation join them, so that they are exact in the landmarks too.

``A_s`` has single precision. It is the smaller part: ``k A_s`` is about 0.01, so that its rounding of 6e-8 is 1e-9 of a
motion. The sum of both parts on the mean is the mean compliance but for this. Displacements come from the factor in
double precision, so the residual of the equation of motion at a point contains this error and that of the inertia.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.block_lanczos import NO_DIRECTION, Operator, TooManyModes, lowest_modes
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic.compliance import (
    MEAN_SHAPES,
    StuckStructure,
    require_one_size,
)
from stickslip.solve.harmonic.damping import modal_damping
from stickslip.solve.harmonic.harmonic_modes import LARGE_ROWS
from stickslip.solve.harmonic.kept_modes import (
    KEPT_RANGE,
    MOST_KEPT,
    SAME_SHAPE,
    KeptCompliance,
    KeptModes,
)
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.solve.harmonic.operator_products import add_springs, as_rows, at_unknowns, times
from stickslip.solve.harmonic.resonances import NEAR_MODES
from stickslip.solve.harmonic.support import (
    ROWS,
    KnownFactors,
    StaticFactor,
    mean_factor,
    require_support_at_rest,
)
from stickslip.structure.superelement import Superelement

# chosen: modes of the structure without contact up to this multiple of the highest excitation; the force has its exact
# static response and the first order of its inertia beside them, so that 1e-8 of their response remains.
FREE_RANGE = 100.0
# chosen: vectors at a time of the block Lanczos iteration, for dense factors.
COLUMNS = 32
# chosen: as in :func:`stickslip.solve.harmonic.damping.modal_basis`, over the largest ratio of the diagonals.
NEGATIVE = 1e-8


@dataclass(frozen=True)
class SoftStructure(StuckStructure):
    """A stuck structure whose p ``modes`` are the soft ones and added shapes, above them in frequency.

    Attributes
    ----------
    static:
        the factor of ``Kbar``.
    rest:
        (m, m) m/N, ``A_s``.
    free:
        the structure without contact, in its own soft modes.
    """

    static: StaticFactor
    rest: NDArray[np.float32]
    free: LinearLimit

    @property
    def has_same_mean(self) -> bool:
        """Whether the mean has the compliance of the harmonics at rest."""
        return self.mean is self.static

    @cached_property
    def kept(self) -> KeptModes:
        """The modes as the balance uses them."""
        return KeptModes(
            self.modes, self.contact_modes, self.circular_frequency, self.modal_damping, self.static, self.rest,
            self.has_same_mean,
        )  # fmt: skip

    @cached_property
    def mean_shapes(self) -> FloatArray:
        """See :class:`StuckStructure`; with the same mean the kept modes contain them nearly."""
        if not self.has_same_mean:
            return super().mean_shapes
        shapes, sizes, _ = scipy.linalg.svd(self.contact_modes / self.circular_frequency, full_matrices=False)
        return np.asarray(shapes[:, :MEAN_SHAPES] * sizes[:MEAN_SHAPES])

    def soft_compliance(self, harmonics: int) -> KeptCompliance:
        """The compliance for a number of harmonics."""
        return KeptCompliance(self, self.kept, harmonics)


def soft_static(superelement: Superelement, pairs: ContactPairs) -> StaticFactor | None:
    """The factor of the stuck stiffness for :func:`soft_structure`; None where all modes serve as well or are required.

    These are a joint of few rows, one with many unknowns on which no pair depends, and a damping or gyroscopic matrix,
    which may couple all modes; and a singular stiffness.
    """
    require_one_size(superelement, pairs)
    if 3 * pairs.n_pairs < LARGE_ROWS or superelement.damping is not None or superelement.gyroscopic is not None:
        return None
    if 2 * _alone(pairs).size > int(MOST_KEPT * superelement.size):
        return None
    springs = pairs.resting_stiffness()
    return StaticFactor.in_place_of(add_springs(superelement.stiffness.copy(), pairs.operator, springs))


def soft_structure(
    superelement: Superelement,
    pairs: ContactPairs,
    force: ExcitationForce,
    highest_omega: float,
    modal_damping_ratio: float | None,
    static: StaticFactor,
    without_friction: StaticFactor | None,
) -> SoftStructure | None:
    """The stuck structure of a large joint in its soft modes; None where these, with the loads, are many.

    ``static`` is that of :func:`soft_static`, ``without_friction`` that of
    :func:`stickslip.solve.harmonic.support.factor_without_friction`. Raises InputError as
    :func:`stickslip.solve.harmonic.compliance.stuck_structure` does.
    """
    size, operator = superelement.size, as_rows(pairs.operator)
    most = int(MOST_KEPT * size)
    loads = _loads(pairs, force)
    if 2 * loads.shape[1] > most:
        return None
    require_support_at_rest(superelement, pairs)
    mean, restraint = mean_factor(superelement, pairs, KnownFactors(static, without_friction))

    def weigh(block: FloatArray) -> FloatArray:
        return superelement.mass @ block

    try:
        squares, modes = lowest_modes(
            static.solve, weigh, size, limit=(KEPT_RANGE * highest_omega) ** 2, most=most - 2 * loads.shape[1],
            columns=COLUMNS,
        )  # fmt: skip
        free = soft_free_limit(superelement, force, highest_omega, most)
    except TooManyModes:
        return None
    near = free.modes[:, free.circular_frequency <= NEAR_MODES * highest_omega]
    first = static.solve(loads)
    beside = shapes_beside([first, static.solve(weigh(first)), near], modes, weigh)
    springs = pairs.resting_stiffness()
    stiff = superelement.stiffness @ beside + at_unknowns(springs * times(operator, beside).T, operator).T
    added, turn = scipy.linalg.eigh(beside.T @ stiff)
    shapes = np.hstack([modes, beside @ turn])
    frequency = np.sqrt(np.append(squares, added))
    ratio = 0.0 if modal_damping_ratio is None else modal_damping_ratio
    rest = static.at_pairs(operator)
    contact = times(operator, shapes) / frequency
    for start in range(0, len(rest), ROWS):
        rest[start : start + ROWS] -= contact[start : start + ROWS] @ contact.T
    return SoftStructure(
        pairs, mean, restraint, frequency, shapes, modal_damping(frequency, ratio, highest_omega), highest_omega,
        (superelement, highest_omega, modal_damping_ratio), static, rest.astype(np.float32), free,
    )  # fmt: skip


def _loads(pairs: ContactPairs, force: ExcitationForce) -> FloatArray:
    """(n, l) the loads whose response is exact to the first order of inertia: those of the force, and of each unknown
    on which no pair depends."""
    alone = _alone(pairs)
    units = np.zeros((pairs.operator.shape[1], alone.size))
    units[alone, np.arange(alone.size)] = 1.0
    arrays = [array[1:][array[1:].any(axis=1)].T for _, array in force.terms]
    return np.hstack([units, *arrays])


def _alone(pairs: ContactPairs) -> NDArray[np.int64]:
    """The unknowns on which no pair depends."""
    return np.flatnonzero(~pairs.operator.any(axis=0))


def soft_free_limit(superelement: Superelement, force: ExcitationForce, highest_omega: float, most: int) -> LinearLimit:
    """The structure without contact in its modes up to FREE_RANGE times the excitation, and in the static responses to
    the force with their inertia; undamped.

    Raises InputError for a stiffness with a clearly negative eigenvalue, and TooManyModes.
    """
    shift = -(highest_omega**2)
    matrix = superelement.stiffness.copy()
    for start in range(0, len(matrix), ROWS):
        matrix[start : start + ROWS] -= shift * superelement.mass[start : start + ROWS]
    factor = StaticFactor.in_place_of(matrix)
    largest = float((np.diag(superelement.stiffness) / np.diag(superelement.mass)).max())
    lowest = shift
    if factor is not None:

        def weigh(block: FloatArray) -> FloatArray:
            return superelement.mass @ block

        squares, modes = lowest_modes(
            factor.solve, weigh, superelement.size, limit=(FREE_RANGE * highest_omega) ** 2, shift=shift, most=most,
            columns=COLUMNS,
        )  # fmt: skip
        lowest = float(squares[0]) if squares.size else 0.0
    if factor is None or lowest < -NEGATIVE * largest:
        raise InputError(
            f"the stiffness matrix has the negative eigenvalue {lowest:.3g} (rad/s)^2 or a lower one; a structure at "
            "rest must be positive semi-definite. Check for a wrong sign or for unknowns in another order than in the "
            "mass matrix."
        )
    loads = np.hstack([array[1:][array[1:].any(axis=1)].T for _, array in force.terms])
    first = factor.solve(loads)
    beside = shapes_beside([first, factor.solve(weigh(first))], modes, weigh)
    added, turn = scipy.linalg.eigh(beside.T @ (superelement.stiffness @ beside))
    frequency = np.sqrt(np.maximum(np.append(squares, added), 0.0))
    shapes = np.hstack([modes, beside @ turn])
    return LinearLimit.undamped(frequency, shapes, superelement.stiffness)


def shapes_beside(vectors: list[FloatArray], modes: FloatArray, weigh: Operator) -> FloatArray:
    """(n, q) M-orthonormal shapes that span the parts of vectors (n, k) that are M-orthogonal to modes (n, p)."""
    weighted = weigh(modes)
    given = np.hstack(vectors)
    given = given / np.linalg.norm(given, axis=0)

    def beside(shapes: FloatArray) -> FloatArray:
        """The part of shapes that the modes lack."""
        for _ in range(2):
            shapes = shapes - modes @ (weighted.T @ shapes)
        return shapes

    parts = beside(given)
    size = np.linalg.norm(parts, axis=0)
    parts = parts[:, size > SAME_SHAPE] / size[size > SAME_SHAPE]
    if not parts.shape[1]:
        return np.asarray(parts)
    basis = beside(scipy.linalg.orth(parts, rcond=SAME_SHAPE))
    for _ in range(2):  # the second time for the round-off of shapes that M nearly makes dependent
        squares, turns = scipy.linalg.eigh(basis.T @ weigh(basis))
        chosen = squares > NO_DIRECTION * squares[-1]
        basis = basis @ (turns[:, chosen] / np.sqrt(squares[chosen]))
    return np.asarray(basis)
