"""Coulomb friction of contact pairs over one period: force, tangent and dissipated energy of the periodic state.

    N = max(N0 + kn n, 0),   |T| <= mu N,   T = K (s - w),   dw/dt along T and only where |T| = mu N,   T = 0 if N = 0

s = (t1, t2) is the relative tangential displacement of a pair, n its closing, w the slider, K = diag(k1, k2). The
slider starts at the mean of s (released pair: one that sticks all period carries T = K (s - mean s)), or at its
position at rest (residual traction T0 retained: T = T0 + K s, s relative to rest). Cycles then lead to the true
periodic state. Derivations, sign conventions and sources: docs/theory_friction.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.law.coulomb_energy import dissipate_pairs
from stickslip.contact.law.coulomb_kernel import CodeArray
from stickslip.contact.law.coulomb_normal_tangent import normal_tangents
from stickslip.contact.law.coulomb_period import settle_pairs
from stickslip.contact.law.coulomb_series import (
    SMALLEST_LIMIT,
    Springs,
    Tractions,
    add_drifts,
    fill_limits,
    fill_normal_forces,
    fill_tractions,
    series,
)
from stickslip.contact.law.coulomb_tangent import Basis, traction_tangents
from stickslip.contact.law.law import ContactCycle
from stickslip.core.errors import InputError
from stickslip.core.fourier import analysis_matrix, synthesis_matrix
from stickslip.core.threads import in_shares
from stickslip.core.validation import FloatArray, finite_array, require_choice

Update = Literal["tractrix", "radial"]
# chosen: with fewer pairs, to share them among threads costs more than it gains (some 12 us a pair, 50 us a share).
PAIRS_OF_A_SHARE = 14
# chosen: with more shares, the interpreter's own time for each is no longer small; with fewer, threads wait at the end.
MOST_SHARES = 16
MIN_SAMPLES = 8  # of a period; chosen: fewer cannot resolve a stick-slip cycle


class FrictionConstants(Protocol):
    """The constants of friction under any normal force; see :class:`stickslip.contact.law.friction_law.FrictionLaw`."""

    @property
    def n_pairs(self) -> int: ...
    @property
    def tangential_springs(self) -> FloatArray: ...
    @property
    def friction_coefficient(self) -> FloatArray: ...
    @property
    def closed_at_rest(self) -> NDArray[np.bool_]: ...
    @property
    def released(self) -> bool: ...
    @property
    def resting_traction(self) -> FloatArray: ...


class CoulombConstants(FrictionConstants, Protocol):
    """Those with linear normal springs; see :class:`stickslip.contact.law.coulomb.CoulombLaw`."""

    @property
    def normal_stiffness(self) -> FloatArray: ...
    @property
    def offset_force(self) -> FloatArray: ...
    @property
    def normal_load(self) -> FloatArray: ...


@dataclass(frozen=True)
class HarmonicForce:
    """Fourier coefficients of the contact force of each pair in its periodic state.

    Attributes
    ----------
    force:
        (n_pairs, 3, 2 * harmonics + 1) N: T1, T2 and N, each less its value at rest (residual traction, static load),
        in the order mean, cos 1, sin 1, ...
    state:
        (n_pairs,) 0 stuck, 1 stick-slip, 2 separating.
    deviates:
        (n_pairs,) False exactly where the force is that of small motions about the rest: the stuck springs of a closed
        pair (released: with the slider at the mean), zero for a pair that is open at rest and stays open.
    closure:
        (n_pairs,) ``|T_end - T_start| / max(mu N)`` of the last period; 0 where a pair sticks or opens.
    period_start:
        (n_pairs, 4) N, the forces at the start and at the end of the last cycle, for :func:`harmonic_tangent`.
    """

    force: FloatArray
    state: CodeArray
    deviates: NDArray[np.bool_]
    closure: FloatArray
    period_start: FloatArray


def harmonic_force(
    coefficients: ArrayLike, pairs: CoulombConstants, samples: int, update: Update = "tractrix"
) -> HarmonicForce:
    """Contact force coefficients for displacement coefficients (alternating frequency-time method).

    Parameters
    ----------
    coefficients:
        (n_pairs, 3, 2 * harmonics + 1) m: t1, t2, n of each pair in the order mean, cos 1, sin 1, ...
    samples:
        samples of the period, at least ``2 * harmonics + 1`` and 8.
    update:
        "tractrix", exact for a step of linear motion and linearly varying normal load, or "radial" (backward Euler).
        Pairs with different tangential stiffness along t1 and t2 use the associated return with either name.

    Raises
    ------
    InputError
        for a wrong shape, too few samples or an unknown update. Entries need not be finite: for a solver that diverges
        the result is NaN.
    """
    displacement = _coefficients(coefficients, pairs.n_pairs, samples)
    require_choice("update", update, get_args(Update))
    limits = np.empty((pairs.n_pairs, samples))
    waves, weights = series(displacement.shape[2] // 2, samples)
    friction, stiffness, offset = pairs.friction_coefficient, pairs.normal_stiffness, pairs.offset_force
    filled, fill_friction = _filling_tractions(displacement, limits, pairs, update)

    def fill(start: int, stop: int) -> None:
        fill_limits(displacement, friction, stiffness, offset, waves, limits, start, stop)
        fill_friction(start, stop)
        fill_normal_forces(
            displacement, limits, friction, stiffness, offset, pairs.normal_load, weights, filled.force, start, stop
        )

    in_shares(fill, pairs.n_pairs, _pairs_of_a_share(pairs.n_pairs))
    return HarmonicForce(*filled)


def harmonic_tangent(
    coefficients: ArrayLike,
    pairs: CoulombConstants,
    samples: int,
    select: ArrayLike,
    update: Update = "tractrix",
    period_start: FloatArray | None = None,
) -> FloatArray:
    """Exact derivative of :func:`harmonic_force` for the pairs ``select`` (indices or a mask of pairs).

    Returns an array (n_select, 3, 2 H + 1, 3, 2 H + 1) in N/m: entry [i, a, p, b, q] is the derivative of force
    coefficient p in direction a by displacement coefficient q in direction b. The dependence of the periodic slider
    start on the motion is included. With ``period_start``, from
    :func:`harmonic_force` of the same coefficients, the periodic state is not computed again.
    """
    displacement = _coefficients(coefficients, pairs.n_pairs, samples)
    require_choice("update", update, get_args(Update))
    chosen = np.arange(pairs.n_pairs)[np.asarray(select)]
    width = displacement.shape[2]
    tangent = np.zeros((len(chosen), 3, width, 3, width))
    if not len(chosen):
        return tangent
    if period_start is None:
        period_start = harmonic_force(displacement, pairs, samples, update).period_start
    limits, basis, stiffness = np.empty((pairs.n_pairs, samples)), _basis(width // 2, samples), pairs.normal_stiffness
    fill_limits(
        displacement, pairs.friction_coefficient, stiffness, pairs.offset_force, basis.waves, limits, 0, pairs.n_pairs
    )
    slopes = np.repeat((pairs.friction_coefficient * stiffness)[:, None], samples, axis=1)
    friction_tangent(displacement, limits, slopes, pairs, chosen, update, period_start, tangent)
    normal_tangents(limits, stiffness, basis, chosen, tangent)
    return tangent


def friction_force(
    displacement: FloatArray, limits: FloatArray, pairs: FrictionConstants, update: Update
) -> HarmonicForce:
    """Contact forces of which the normal ones are not yet filled.

    ``displacement`` (n_pairs, 3, 2H+1) m, ``limits`` (n_pairs, n) N with their sign, at the samples of the period.
    """
    filled, fill = _filling_tractions(displacement, limits, pairs, update)
    in_shares(fill, len(displacement), _pairs_of_a_share(len(displacement)))
    return HarmonicForce(*filled)


def _filling_tractions(
    displacement: FloatArray, limits: FloatArray, pairs: FrictionConstants, update: Update
) -> tuple[Tractions, Callable[[int, int], None]]:
    """Arrays for :func:`friction_force`, and what fills them from one pair to another."""
    count, width = len(displacement), displacement.shape[2]
    filled = Tractions(
        np.empty((count, 3, width)),
        np.empty(count, dtype=np.int8),
        np.empty(count, dtype=np.bool_),
        np.empty(count),
        np.empty((count, 4)),
    )
    fourier, springs = series(width // 2, limits.shape[1]), _springs(pairs)
    tractrix, released = update == "tractrix", pairs.released

    def fill(start: int, stop: int) -> None:
        fill_tractions(displacement, limits, springs, tractrix, released, fourier, filled, start, stop)

    return filled, fill


def friction_tangent(
    displacement: FloatArray,
    limits: FloatArray,
    limit_slopes: FloatArray,
    pairs: FrictionConstants,
    chosen: NDArray[np.int64],
    update: Update,
    period_start: FloatArray,
    tangent: FloatArray,
) -> None:
    """Fill the rows of T1 and T2 of ``tangent`` (k, 3, 2H+1, 3, 2H+1) N/m, zero on entry, of the pairs ``chosen``.

    ``limit_slopes`` (n_pairs, n) N/m: derivative of the limits by the closing at the samples.
    """
    springs, basis = _springs(pairs), _basis(displacement.shape[2] // 2, limits.shape[1])
    tractrix, released = update == "tractrix", pairs.released

    def differentiate(start: int, stop: int) -> None:
        traction_tangents(
            displacement, limits, springs, limit_slopes, tractrix, released, basis, period_start, chosen, tangent,
            start, stop,
        )  # fmt: skip

    in_shares(differentiate, len(chosen), _pairs_of_a_share(len(chosen)))


def contact_cycle(displacement: ArrayLike, pairs: CoulombConstants, update: Update = "tractrix") -> ContactCycle:
    """Converged period of the contact pairs under an imposed periodic motion.

    Parameters
    ----------
    displacement:
        (n_samples, n_pairs, 3) m: t1, t2 and n of each pair at n_samples equal steps of one period (the end point,
        which equals the first, is omitted). At least 8 samples.
    pairs:
        the constants of the pairs.
    update:
        as in :func:`harmonic_force`.

    Raises
    ------
    InputError
        for a wrong shape, fewer than 8 samples, entries that are not finite, or an unknown update.
    """
    motion = finite_array("displacement", displacement)
    if motion.ndim != 3 or motion.shape[1:] != (pairs.n_pairs, 3):
        raise InputError(
            f"displacement must have shape (n_samples, n_pairs, 3) = (n_samples, {pairs.n_pairs}, 3): t1, t2, n of "
            f"each pair at each sample, but its shape is {motion.shape}.",
            arguments=["displacement"],
        )
    _check_samples(motion.shape[0], MIN_SAMPLES, "displacement", "has")
    return friction_cycle(motion, pairs.offset_force + pairs.normal_stiffness * motion[:, :, 2], pairs, update)


def friction_cycle(
    motion: FloatArray, load: FloatArray, pairs: FrictionConstants, update: Update = "tractrix"
) -> ContactCycle:
    """The period of a motion (n, n_pairs, 3) m under normal forces ``load`` (n, n_pairs) N, below zero in a gap."""
    require_choice("update", update, get_args(Update))
    springs = pairs.tangential_springs
    tangential = motion[:, :, :2]
    middle = tangential.mean(axis=0)
    closed = np.concatenate([tangential - middle, tangential[:1] - middle])
    paths = np.ascontiguousarray((closed * springs).transpose(1, 2, 0))
    means = np.zeros_like(springs) if pairs.released else springs * middle
    if not pairs.released:
        add_drifts(paths, means, pairs.resting_traction)
    limits = np.ascontiguousarray((pairs.friction_coefficient * load).T)
    count, samples = limits.shape
    ratios, tractrix = _ratios(springs), update == "tractrix"
    forces, modes = np.empty((count, 2, samples)), np.empty((count, samples), dtype=np.int8)
    state, closure = np.empty(count, dtype=np.int8), np.empty(count)

    def settle(start: int, stop: int) -> None:
        part = slice(start, stop)
        settle_pairs(
            paths[part], means[part], limits[part], ratios[part], tractrix,
            forces[part], modes[part], state[part], closure[part],
        )  # fmt: skip

    in_shares(settle, count, _pairs_of_a_share(count))
    closure /= np.maximum(limits.max(axis=1), SMALLEST_LIMIT)
    force = np.empty_like(motion)
    force[:, :, :2] = forces.transpose(2, 0, 1)
    force[:, :, 2] = np.maximum(load, 0.0)
    energy = np.zeros(count)
    dissipate_pairs(paths, limits, springs, tractrix, forces, modes, state, energy)
    return ContactCycle(force, tangential - force[:, :, :2] / springs, state, energy, closure)


def _springs(pairs: FrictionConstants) -> Springs:
    """The constants that compiled functions take."""
    stiffness = pairs.tangential_springs
    return Springs(stiffness, _ratios(stiffness), pairs.resting_traction, pairs.closed_at_rest)


@lru_cache(maxsize=32)
def _basis(harmonics: int, samples: int) -> Basis:
    """The Fourier basis with the running sums that the tangent needs."""
    synthesis = synthesis_matrix(harmonics, samples)
    analysis = np.ascontiguousarray(analysis_matrix(harmonics, samples).T)
    products = analysis[:, :, None] * synthesis[:, None, :]
    shares = np.arange(samples) / samples
    return Basis(
        series(harmonics, samples).waves,
        synthesis,
        analysis,
        np.concatenate([np.zeros_like(analysis[:1]), np.cumsum(analysis, axis=0)]),
        np.concatenate([np.zeros_like(products[:1]), np.cumsum(products, axis=0)]),
        np.concatenate([np.zeros_like(analysis[:1]), np.cumsum(shares[:, None] * analysis, axis=0)]),
    )


def _ratios(springs: FloatArray) -> FloatArray:
    """Tangential stiffness over the larger of the two, (n_pairs, 2); equal stiffness gives exactly 1."""
    ratios: FloatArray = springs / springs.max(axis=1, keepdims=True)
    return ratios


def _coefficients(coefficients: ArrayLike, n_pairs: int, samples: int) -> FloatArray:
    """Check the shape of displacement coefficients against the pairs and the number of samples."""
    array = np.ascontiguousarray(coefficients, dtype=float)
    if array.ndim != 3 or array.shape[:2] != (n_pairs, 3) or array.shape[2] % 2 == 0 or array.shape[2] < 3:
        raise InputError(
            f"coefficients must have shape (n_pairs, 3, 2 * harmonics + 1) = ({n_pairs}, 3, odd number above 1), but "
            f"its shape is {array.shape}.",
            arguments=["coefficients"],
        )
    _check_samples(samples, max(MIN_SAMPLES, array.shape[2]), "samples", "is")
    return array


def _check_samples(samples: int, least: int, argument: str, verb: str) -> None:
    if samples < least:
        raise InputError(
            f"{argument} {verb} {samples} samples per period, but at least {least} are required (2 * harmonics + 1, "
            "and 8). Friction forces have kinks: use 256, or 512 and more with separation.",
            arguments=[argument],
        )


def _pairs_of_a_share(count: int) -> int:
    """How many of ``count`` pairs a thread takes at a time."""
    return max(PAIRS_OF_A_SHARE, -(-count // MOST_SHARES))
