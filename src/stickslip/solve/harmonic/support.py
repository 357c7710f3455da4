"""What supports the bodies of a structure: their static response to mean forces, and their support at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.threads import library_threads
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.operator_products import (
    Rows,
    add_springs,
    as_rows,
    at_squares,
    at_unknowns,
    both_sides,
    times,
)
from stickslip.structure.superelement import Superelement

# A body that only friction supports (a free damper along its axis) has no unique mean position where its pairs follow a
# law without a walk (docs/theory.md). A spring of this fraction of the tangential contact stiffness, on the mean alone,
# restrains it there; results do not depend on it.
MEAN_RESTRAINT = 1e-6
# Reciprocal condition number below which the scaled mean system counts as singular; chosen: five digits below
# MEAN_RESTRAINT.
SINGULAR_MEAN = 1e-11
# chosen: vectors and steps of the iteration for motions that friction alone resists. Two bodies have twelve of them,
# and all but a few other eigenvalues are below 0.04 (docs/performance.md), so that 1e-8 of their part remains.
SUBSPACE, SUBSPACE_STEPS = 16, 6
# chosen: rows of a large matrix at a time, so that no other array is as large.
ROWS = 256


class StaticResponse(Protocol):
    """The static response of a structure with springs on its pairs, ``(K + B^T k B)^-1``."""

    def solve(self, force: FloatArray) -> FloatArray:
        """Static displacement under forces (n,) or (n, k)."""

    def at_pairs(self, operator: Rows) -> FloatArray:
        """``B (K + B^T k B)^-1 B^T`` (m, m) of the rows B (m, n) of an operator."""


@dataclass(frozen=True)
class StaticFactor:
    """Static response of the structure with springs on its pairs: a Cholesky factor of ``K + B^T k B``, scaled."""

    _scale: FloatArray
    _factor: Any

    @classmethod
    def build(cls, superelement: Superelement, pairs: ContactPairs, springs: FloatArray) -> StaticFactor:
        """The factor with ``springs`` (n_pairs, 3) N/m along t1, t2, n. Raises InputError where it is singular."""
        factor = cls.attempt(superelement, pairs, springs)
        if factor is None:
            raise InputError(
                "the structure with all contacts closed and stuck is singular to working accuracy: some body can move "
                "freely, or the contact is many orders stiffer than the structure. Constrain the body, check that the "
                "contact operator couples it to the other bodies, or lower the contact stiffness: a joint a thousand "
                "times stiffer than the parts that it connects is rigid."
            )
        return factor

    @classmethod
    def attempt(cls, superelement: Superelement, pairs: ContactPairs, springs: FloatArray) -> StaticFactor | None:
        """As :meth:`build`, or None where the structure is singular to working accuracy."""
        return cls.in_place_of(add_springs(superelement.stiffness.copy(), pairs.operator, springs.ravel()))

    @classmethod
    def of_matrix(cls, stiffness: FloatArray) -> StaticFactor | None:
        """The factor of a stiffness (n, n), or None if it is not positive definite to working accuracy."""
        return cls.in_place_of(stiffness.copy())

    @classmethod
    def in_place_of(cls, matrix: FloatArray) -> StaticFactor | None:
        """As :meth:`of_matrix`; the factor takes the place of the matrix, which a large structure has no second of."""
        if not (np.diag(matrix) > 0.0).all():
            return None
        scale = 1.0 / np.sqrt(np.diag(matrix))
        matrix *= scale
        matrix *= scale[:, None]
        norm = max(float(np.abs(part).sum(axis=1).max()) for part in np.array_split(matrix, 1 + len(matrix) // ROWS))
        # The transpose of a symmetric matrix by rows is one by columns, which the library does not copy.
        with library_threads(len(matrix)):
            factor, failure = scipy.linalg.lapack.dpotrf(matrix.T, lower=1, clean=0, overwrite_a=1)
        if failure or scipy.linalg.lapack.dpocon(factor, norm, uplo="L")[0] <= SINGULAR_MEAN:
            return None
        return cls(scale, (factor, True))

    def solve(self, force: FloatArray) -> FloatArray:
        """See :class:`StaticResponse`."""
        scale = self._scale if force.ndim == 1 else self._scale[:, None]
        given = scale * force
        answer = scipy.linalg.cho_solve(self._factor, given, overwrite_b=True, check_finite=False)
        answer *= scale
        return np.asarray(answer)

    def at_pairs(self, operator: Rows) -> FloatArray:
        """See :class:`StaticResponse`.

        The inverse takes a third of the operations of solutions for all rows (LAPACK dpotri).
        """
        with library_threads(len(self._factor[0])):
            inverse, failure = scipy.linalg.lapack.dpotri(self._factor[0], lower=1)
        assert not failure  # the factor has no zero on its diagonal
        inverse = inverse.T  # by rows, with the upper triangle
        for start in range(0, len(inverse), ROWS):
            stop = min(start + ROWS, len(inverse))
            inverse[stop:, start:stop] = inverse[start:stop, stop:].T
            block = inverse[start:stop, start:stop]
            block[...] = np.triu(block) + np.triu(block, 1).T
        inverse *= self._scale
        inverse *= self._scale[:, None]
        return both_sides(operator, inverse)


@dataclass(frozen=True)
class ModalStatic:
    """Static response from all modes of the structure with its springs, ``phi diag(1/w^2) phi^T``: the frequencies (n,)
    in rad/s and the mass-normalised modes (n, n)."""

    circular_frequency: FloatArray
    modes: FloatArray

    @classmethod
    def of_modes(cls, circular_frequency: FloatArray, modes: FloatArray) -> ModalStatic | None:
        """The response, None where the structure is singular to working accuracy."""
        lowest, highest = float(circular_frequency[0]), float(circular_frequency[-1])
        return cls(circular_frequency, modes) if lowest**2 > SINGULAR_MEAN * highest**2 else None

    def solve(self, force: FloatArray) -> FloatArray:
        """See :class:`StaticResponse`."""
        modal = (force.T @ self.modes) / self.circular_frequency**2
        return np.asarray(self.modes @ modal.T)

    def at_pairs(self, operator: Rows) -> FloatArray:
        """See :class:`StaticResponse`: a product of two matrices, a fifth of the time of a factor and its inverse."""
        shapes = times(operator, self.modes) / self.circular_frequency
        return np.asarray(shapes @ shapes.T)


@dataclass(frozen=True)
class KnownFactors:
    """Factors of a structure that exist already: with all springs at rest, and with those of its pairs that no friction
    carries (None: some body would move freely without friction). The first is None if it does not exist yet."""

    stuck: StaticResponse | None
    without_friction: StaticFactor | None


def only_friction_supports(superelement: Superelement, pairs: ContactPairs) -> bool:
    """Whether some body would move freely without friction, to working accuracy."""
    return factor_without_friction(superelement, pairs) is None


def restrained(pairs: ContactPairs) -> NDArray[np.bool_]:
    """(n_pairs, 3) True where the restraint of the mean acts if friction alone supports a body."""
    return np.asarray(pairs.frictional() & ~pairs.walking())


def mean_factor(
    superelement: Superelement, pairs: ContactPairs, known: KnownFactors | None = None
) -> tuple[StaticResponse, float]:
    """The response to mean forces, and its restraint; springs without a mean do not act here.

    ``known`` factors are not computed again.

    A body that only friction supports has ``MEAN_RESTRAINT`` on the mean, also with residual tractions, which vanish
    when all its pairs slip; pairs that may walk need none. Raises InputError if the structure stays singular.
    """
    springs, undetermined, restricted = (
        pairs.resting_stiffness().reshape(-1, 3),
        pairs.undetermined(),
        restrained(pairs),
    )
    superelement = superelement.mean_structure()
    without_friction = factor_without_friction(superelement, pairs) if known is None else known.without_friction
    restraint = MEAN_RESTRAINT if without_friction is None and restricted.any() else 0.0
    if without_friction is not None and (undetermined == pairs.frictional()).all():
        return without_friction, restraint
    if known is not None and known.stuck is not None and restraint == 0.0 and not undetermined.any():
        return known.stuck, restraint
    return StaticFactor.build(superelement, pairs, springs * (~undetermined + restraint * restricted)), restraint


def factor_without_friction(superelement: Superelement, pairs: ContactPairs) -> StaticFactor | None:
    """The factor without the springs of friction, None where some body would move freely."""
    springs = pairs.resting_stiffness().reshape(-1, 3)
    return StaticFactor.attempt(superelement.mean_structure(), pairs, springs * ~pairs.frictional())


def needs_friction(superelement: Superelement, pairs: ContactPairs, stuck: StaticFactor) -> bool:
    """Whether a motion found here shows that some body would move freely without friction, as
    :func:`only_friction_supports` would say; False leaves it open.

    Such a motion v strains the springs of friction alone, so that ``Kbar^-1 B^T k_f B v = v`` with the ``stuck``
    stiffness, and no eigenvalue is larger. A few steps of a subspace iteration find it, which take far less time than
    the factor of a large joint. With unit diagonal, the quotient ``v^T K v / v^T diag(K) v`` of the stiffness K without
    friction is an upper bound of its reciprocal condition number.
    """
    operator, springs = as_rows(pairs.operator), pairs.resting_stiffness()
    released = pairs.frictional().ravel()
    diagonal = np.diag(superelement.stiffness) + at_squares(operator, springs * ~released)
    if not released.any() or not (diagonal > 0.0).all():
        return False
    block = np.random.default_rng(0).standard_normal((superelement.size, SUBSPACE))  # the same in every run
    for _ in range(SUBSPACE_STEPS):
        block = np.linalg.qr(block)[0]
        released_force = (springs * released)[:, None] * times(operator, block)
        block = stuck.solve(np.ascontiguousarray(at_unknowns(released_force.T, operator).T))
    block = np.linalg.qr(block)[0]

    def strain(motion: FloatArray) -> FloatArray:
        relative = times(operator, motion)
        resting = (springs * ~released)[:, None] * relative
        return np.asarray(motion.T @ (superelement.stiffness @ motion) + relative.T @ resting)

    softest = block @ scipy.linalg.eigh(strain(block), block.T @ (diagonal[:, None] * block))[1][:, :1]
    # the quotient of this motion has the round-off of its own strain, not of that of the others
    return float(strain(softest)[0, 0]) <= SINGULAR_MEAN * float(diagonal @ softest[:, 0] ** 2)


def require_support_at_rest(superelement: Superelement, pairs: ContactPairs) -> None:
    """Raise InputError for a body that only pairs with a gap could support: it has no state at rest."""
    closed = pairs.closed_at_rest
    if closed.all():
        return
    springs = pairs.resting_stiffness().reshape(-1, 3)
    if StaticFactor.attempt(superelement, pairs, springs) is None:
        raise InputError(
            f"preload is zero or negative (a gap) at {int((~closed).sum())} of {closed.size} pairs, and the others do "
            "not support each body: displacements are relative to a state at rest, which does not exist. Press at "
            "least some pairs of each body together, or constrain the body.",
            ("preload",),
        )


def require_stable_without_contact(superelement: Superelement) -> None:
    """Raise InputError for Coriolis forces on a structure whose stiffness without contact is not positive definite."""
    if StaticFactor.of_matrix(superelement.stiffness) is None:
        raise InputError(
            "superelement has a gyroscopic matrix, but its stiffness without contact is not positive definite: a body "
            "moves freely, or spin softening exceeds the stiffness. Constrain each body, or give a lower speed.",
            arguments=["superelement"],
        )
