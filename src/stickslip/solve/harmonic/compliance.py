"""Response of the structure with stuck contacts to forces on the pairs, harmonic by harmonic.

``k`` contains the springs of the pairs that are closed at rest; pairs that are open there have none until they close.
With ``Kbar = K + B^T k B`` and ``Z_h(w) = Kbar - (h w)^2 M + i h w C`` the compliance of the pairs is ``A_h(w) = B
Z_h^-1 B^T`` and the linear stuck response ``r_h = B Z_h^-1 P_h``. Both come from the modes of the stuck structure
(``gain.py``). The mean (h = 0) is different where sliders are released: a stuck pair then carries no mean traction (its
slider is at the mean displacement), so ``k`` contains only the normal springs there.
"""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.sparse.linalg

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.damping import (
    changed_basis,
    damping_root,
    diagonal_modal_damping,
    modal_basis,
    modal_damping,
    stuck_stiffness_matrix,
)
from stickslip.solve.harmonic.gain import CoupledGain, DiagonalGain, ModalGain, SelfExcitation
from stickslip.solve.harmonic.harmonic_modes import (
    HarmonicModes,
    IndexArray,
    LowRankCompliance,
    NewtonOperator,
    SharedModes,
)
from stickslip.solve.harmonic.operator_products import Rows, as_rows, at_unknowns, times
from stickslip.solve.harmonic.support import (
    KnownFactors,
    ModalStatic,
    StaticResponse,
    mean_factor,
    require_stable_without_contact,
    require_support_at_rest,
    restrained,
)
from stickslip.structure.superelement import Superelement

Origin = tuple[Superelement, float, float | None]

# In Newton's matrix of a structure with many modes, those above this multiple of the highest harmonic are springs: an
# error of 1/30^2 of their part of the matrix alone, which costs no accuracy (the residual has their inertia, see
# kept_modes) and hardly an iteration, unless the contact is a thousand times stiffer than the structure: where that
# opens, the compliance of the fast modes and that of the springs cancel to less than this error, and Newton's method
# converges linearly or not at all.
NEAR_RANGE = 30.0
# chosen: a structure with no more modes than this has all of them in Newton's matrix. With damping that couples them
# their gains take 2 ms with 108 modes, as long as the rest of an iteration of a small joint.
FEW_MODES = 120
# chosen: modes whose compliance times the contact stiffness is below this remain for the iteration, which converges
# with it (440 pairs: 26 of 42 near modes, one iteration more); and number of shapes of the mean, of 10 above 0.1.
STRONG = 0.1
MEAN_SHAPES = 30
MEAN_TOLERANCE = 1e-3  # chosen: far below the part that remains for the iteration


@dataclass(frozen=True)
class ExternalForce:
    """The external force in the modes of the stuck structure; it has no mean."""

    modal: FloatArray  # (2H, n) modal forces of the harmonics

    def times(self, factor: float) -> ExternalForce:
        """The force with another size."""
        return ExternalForce(factor * self.modal)

    def plus(self, other: ExternalForce) -> ExternalForce:
        """The sum of two forces."""
        return ExternalForce(self.modal + other.modal)


class StuckMean(Protocol):
    """The response of a stuck structure on the mean: its pairs, and their compliance (m, m) there."""

    @property
    def pairs(self) -> ContactPairs: ...
    @property
    def mean(self) -> StaticResponse: ...
    @property
    def mean_restraint(self) -> float: ...
    @property
    def mean_contact(self) -> FloatArray: ...


class Compliance:
    """The response of the stuck structure; m = 3 * n_pairs rows t1, t2, n of each pair, n unknowns and as many modes.

    Coefficients are (2H+1, ...) in the order mean, cos 1, sin 1, ...; ``amplitude`` (2H, n) are those of the modes,
    without mean. The modes are mass-normalised: the Euclidean norm of an amplitude is the mass norm of its motion.
    """

    def __init__(self, stuck: StuckMean, modes: HarmonicModes, gain: ModalGain) -> None:
        self.harmonics = gain.harmonics
        springs = stuck.pairs.resting_stiffness().reshape(-1, 3) * restrained(stuck.pairs)
        self._restraint = stuck.mean_restraint * springs[:, :2]
        self.gain = gain
        self._modes = modes
        self._mean, self._stuck = stuck.mean, stuck

    @cached_property
    def _operator(self) -> Rows:
        return as_rows(self._stuck.pairs.operator)

    @property
    def _mean_contact(self) -> FloatArray:
        """(m, m) compliance of the pairs on the mean."""
        return self._stuck.mean_contact

    def excited(self, by: SelfExcitation) -> Compliance:
        """The compliance under a self-excitation."""
        changed = copy(self)
        changed.__dict__.pop("_transposed_gain", None)  # it belongs to the gain without self-excitation
        changed.gain = self.gain.excited(by)
        return changed

    def restraint_force(self, mean_relative: FloatArray) -> FloatArray:
        """(..., n_pairs, 2) N along t1, t2 of the restraint at mean relative displacements (..., 3 n_pairs)."""
        shape = (*mean_relative.shape[:-1], -1, 3)
        return np.asarray(self._restraint * mean_relative.reshape(shape)[..., :2])

    def external(self, force: FloatArray) -> ExternalForce:
        """The modal form of a force (2H+1, n) without mean."""
        return ExternalForce(self._modes.of_force(force[1:]))

    def amplitude(self, omega: float, external: ExternalForce | None, deviation: FloatArray) -> FloatArray:
        """Modal amplitudes (2H, n) under an external force and ``-B^T deviation``, deviation (2H+1, m)."""
        force = -self._modes.of_contact(deviation[1:])
        if external is not None:
            force += external.modal
        return self.gain.answer(omega, force)

    def relative(self, amplitude: FloatArray, deviation: FloatArray) -> FloatArray:
        """``B u`` (2H+1, m) of amplitudes, with the mean under the deviation."""
        answer = np.empty((amplitude.shape[0] + 1, self._operator.shape[0]))
        answer[0] = -(self._mean_contact @ deviation[0]) if deviation[0].any() else 0.0
        self._modes.relative(amplitude, answer[1:])
        return answer

    def relative_of(self, motion: FloatArray) -> FloatArray:
        """(m,) relative displacements of a motion (n,) in the modes."""
        return np.asarray(self._shared.contact @ motion)

    def amplitude_transposed(self, omega: float, weights: FloatArray) -> FloatArray:
        """Derivative (2H+1, m) of ``sum(weights * amplitude)`` by the deviation, for weights (2H, n)."""
        modal = self.adjoint_amplitude(omega, weights)
        return np.vstack([np.zeros((1, self._operator.shape[0])), -(modal @ self._shared.contact.T)])

    def adjoint_amplitude(self, omega: float, weights: FloatArray) -> FloatArray:
        """Derivative (2H, n) of ``sum(weights * amplitude)`` by the modal forces, for weights (2H, n).

        The adjoint of a gain is the conjugate one of the transposed matrices: the sines change sign twice.
        """
        flipped = weights.copy()
        flipped[1::2] *= -1.0
        modal = self._transposed_gain.answer(omega, flipped)
        modal[1::2] *= -1.0
        return modal

    def mean_transposed(self, output: FloatArray) -> FloatArray:
        """Derivative (m,) of the mean of ``output @ u`` by the mean of the deviation."""
        return np.asarray(-(self._operator @ self._mean.solve(output)))

    def mean_relative(self, force: FloatArray) -> FloatArray:
        """(m,) mean relative displacements under mean forces (m,) on the pairs."""
        return np.asarray(self._mean_contact @ force)

    def output_modes(self, output: FloatArray) -> FloatArray:
        """The row ``output`` (n,) of the unknowns in modal coordinates, (n,)."""
        return np.asarray(output @ self._shared.modes)

    def displacement(self, amplitude: FloatArray, deviation: FloatArray) -> FloatArray:
        """All unknowns (..., 2H+1, n) of amplitudes (..., 2H, n) and deviations (..., 2H+1, m)."""
        shape = amplitude.shape
        answer = np.empty((*shape[:-2], shape[-2] + 1, self._operator.shape[1]))
        force = -at_unknowns(deviation[..., 0, :], self._operator)
        answer[..., 0, :] = self._mean.solve(force.T).T
        answer[..., 1:, :] = self._modes.displacement(amplitude)
        return answer

    def newton(self, omega: float, columns: IndexArray) -> NewtonOperator:
        """A for the Newton matrix at ``omega``, for deviations on ``columns``."""
        return self._modes.newton(self._mean_contact, columns, self.gain.near(omega))

    def low_rank(
        self, omega: float, rows: IndexArray, columns: IndexArray, stiffness: float
    ) -> LowRankCompliance | None:
        """The part of :meth:`newton` in some rows whose products with a contact ``stiffness`` in N/m are not small.

        None if the harmonics have different modes.
        """
        return self._modes.low_rank(rows, columns, self.gain.near(omega), STRONG / stiffness)

    @cached_property
    def _transposed_gain(self) -> ModalGain:
        return self.gain.transposed()

    @property
    def _shared(self) -> SharedModes:
        """Modes that all harmonics share; analyses of an output do not accept others."""
        assert isinstance(self._modes, SharedModes)
        return self._modes


@dataclass(frozen=True)
class StuckStructure:
    """The structure with every contact that is closed at rest stuck, for balances with any number of harmonics."""

    pairs: ContactPairs
    mean: StaticResponse
    mean_restraint: float
    circular_frequency: FloatArray  # (n,) rad/s, ascending
    modes: FloatArray  # (n, n), mass-normalised
    modal_damping: FloatArray  # (n,) if the modes diagonalise it, else (n, n); with the gyroscopic matrix, if any
    highest_omega: float  # rad/s
    origin: (
        Origin  # superelement, highest circular frequency, and damping ratio of the modes, that it was computed from
    )
    # another one, whose modes these were computed in
    reference: StuckStructure | None = field(default=None, kw_only=True)
    # whether some body moves freely without friction, as far as that is known
    floats: bool = field(default=False, kw_only=True)

    def needs_friction(self, superelement: Superelement, pairs: ContactPairs) -> bool:
        """Whether some body of these matrices, and of others where springs alone differ, moves freely without
        friction; False leaves it open."""
        return (
            self.floats
            and self.has_matrices_of(superelement, pairs)
            and np.array_equal(self.pairs.frictional(), pairs.frictional())
            and np.array_equal(self.pairs.resting_stiffness() > 0.0, pairs.resting_stiffness() > 0.0)
        )

    def is_of(self, origin: Origin, pairs: ContactPairs) -> bool:
        """Whether the structure of other pairs has these modes: the same matrices, positions and springs at rest."""
        own = self.pairs
        return (
            self.has_matrices_of(origin[0], pairs)
            and self.origin[2] == origin[2]
            and np.array_equal(own.resting_stiffness(), pairs.resting_stiffness())
            and np.array_equal(restrained(own), restrained(pairs))
        )

    def has_matrices_of(self, superelement: Superelement, pairs: ContactPairs) -> bool:
        """Whether another structure has the same matrices and positions of pairs; springs may differ."""
        return self.origin[0] is superelement and np.array_equal(self.pairs.operator, pairs.operator)

    @cached_property
    def damping(self) -> FloatArray:
        """(n, n) N s/m, symmetric, also with modal damping ratios."""
        root = self.damping_root
        if root is not None:
            return np.asarray(root @ root.T)
        damping = self.origin[0].damping
        return np.zeros(self.modes.shape) if damping is None else damping

    @cached_property
    def damping_root(self) -> FloatArray | None:
        """(n, p) whose product with its transpose is the damping of modal ratios, of p modes; None for a matrix."""
        _, highest_omega, ratio = self.origin
        if ratio is None:
            return None
        # The diagonal of modal_damping would be this too, but with the round-off of Coriolis forces, of either sign.
        return damping_root(self.mass, self.modes, modal_damping(self.circular_frequency, ratio, highest_omega))

    @property
    def mass(self) -> FloatArray:
        """(n, n) kg."""
        return self.origin[0].mass

    @property
    def velocity_matrix(self) -> FloatArray:
        """(n, n) N s/m, the damping and the gyroscopic matrix."""
        gyroscopic = self.origin[0].gyroscopic
        return self.damping if gyroscopic is None else self.damping + gyroscopic

    @cached_property
    def contact_modes(self) -> FloatArray:
        """(m, n) relative displacements of the modes, for every number of harmonics."""
        return times(self.pairs.operator, self.modes)

    @cached_property
    def mean_contact(self) -> FloatArray:
        """(m, m) compliance of the pairs on the mean."""
        return self.mean.at_pairs(self.pairs.operator)

    @cached_property
    def mean_shapes(self) -> FloatArray:
        """(m, c) softest shapes of the pairs on the mean, whose product with its transpose is their compliance."""
        size, whole = len(self.mean_contact), self.mean_contact
        count = min(MEAN_SHAPES, size - 1)
        start = np.random.default_rng(0).standard_normal(size)  # the same in every run
        squares, shapes = scipy.sparse.linalg.eigsh(whole, count, v0=start, tol=MEAN_TOLERANCE)
        return np.asarray(shapes * np.sqrt(np.maximum(squares, 0.0)))

    def compliance(self, harmonics: int, near_range: float | None = None) -> Compliance:
        """The compliance for a number of harmonics; modes above ``near_range`` are springs in Newton's matrix.

        None is :func:`usual_near_range`.
        """
        if near_range is None:
            near_range = usual_near_range(self.circular_frequency.size)
        near = int(np.searchsorted(self.circular_frequency, near_range * harmonics * self.highest_omega))
        kind = DiagonalGain if self.modal_damping.ndim == 1 else CoupledGain
        gain = kind(self.circular_frequency, self.modal_damping, harmonics, near)
        modes = SharedModes(self.modes, self.contact_modes, self.circular_frequency, near, lambda: self.mean_shapes)
        return Compliance(self, modes, gain)


def usual_near_range(n_modes: int) -> float:
    """The range of the modes that are not springs in Newton's matrix, over the highest harmonic."""
    return math.inf if n_modes <= FEW_MODES else NEAR_RANGE


def stuck_structure(
    superelement: Superelement,
    pairs: ContactPairs,
    highest_omega: float,
    modal_damping_ratio: float | None,
    known: StuckStructure | None = None,
    factors: KnownFactors | None = None,
) -> StuckStructure:
    """Modes, damping and static response of the stuck structure.

    ``modal_damping_ratio`` gives the stuck modes one ratio (see :func:`stickslip.solve.harmonic.damping.modal_damping`;
    ``highest_omega`` in rad/s is the highest excitation); None uses ``superelement.damping`` (zero if absent).
    A ``known`` structure, also for another highest excitation, gives its modes and static response if they are the
    same; where springs alone differ, its modes, or those of its reference, are the coordinates in which the others are
    computed. ``factors`` exist already. Raises InputError for an operator of another size, for both kinds of damping at
    once, or a singular structure.
    """
    n = superelement.size
    require_one_size(superelement, pairs)
    origin = superelement, highest_omega, modal_damping_ratio
    if known is not None and known.is_of(origin, pairs):
        known = replace(known, pairs=pairs, highest_omega=highest_omega, origin=origin)
        if modal_damping_ratio is None:
            return known
        damping = modal_damping(known.circular_frequency, modal_damping_ratio, highest_omega)
        return replace(known, modal_damping=damping)
    if modal_damping_ratio is not None and superelement.damping is not None:
        raise InputError(
            "give either a damping matrix in the superelement or modal_damping_ratio, not both.",
            arguments=["modal_damping_ratio"],
        )
    if superelement.gyroscopic is not None:
        require_stable_without_contact(superelement)
    require_support_at_rest(superelement, pairs)
    reference = None if known is None else known.reference or known
    if reference is not None and reference.has_matrices_of(superelement, pairs):
        springs = pairs.resting_stiffness() - reference.pairs.resting_stiffness()
        frequency, modes = changed_basis(
            reference.circular_frequency, reference.modes, reference.contact_modes, springs
        )
        if factors is not None and factors.stuck is None:
            factors = replace(factors, stuck=ModalStatic.of_modes(frequency, modes))
        mean, restraint = mean_factor(superelement, pairs, factors)
    else:
        reference = None
        mean, restraint = mean_factor(superelement, pairs, factors)
        frequency, modes = modal_basis(superelement.mass, stuck_stiffness_matrix(superelement, pairs))
    modal: FloatArray | None
    if modal_damping_ratio is not None:
        modal = modal_damping(frequency, modal_damping_ratio, highest_omega)
    elif superelement.damping is None:
        modal = np.zeros(n)
    else:
        modal = diagonal_modal_damping(superelement.damping, modes)
        if modal is None:
            modal = modes.T @ superelement.damping @ modes
    if superelement.gyroscopic is not None:
        modal = (np.diag(modal) if modal.ndim == 1 else modal) + modes.T @ superelement.gyroscopic @ modes
    return StuckStructure(
        pairs, mean, restraint, frequency, modes, modal, highest_omega, origin, reference=reference,
        floats=factors is not None and factors.without_friction is None,
    )  # fmt: skip


def require_one_size(superelement: Superelement, pairs: ContactPairs) -> None:
    """Raise InputError for an operator of another size than the structure, and for a sector in its place."""
    n = len(superelement.mass)  # a sector of a disk has a size, but no mass matrix: it raises its own error
    if pairs.operator.shape[1] != n:
        raise InputError(
            f"operator has {pairs.operator.shape[1]} columns, but the superelement has {n} unknowns; "
            "operator must have shape (3 * n_pairs, n).",
            arguments=["operator"],
        )
