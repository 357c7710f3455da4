"""Coulomb friction of contact pairs over one period: force, tangent and dissipated energy of the periodic state.

    N = max(N0 + kn n, 0),   |T| <= mu N,   T = K (s - w),   dw/dt along T and only where |T| = mu N,   T = 0 if N = 0

s = (t1, t2) is the relative tangential displacement of a pair, n its closing, w the slider, K = diag(k1, k2). The
slider starts at the mean of s (released pair: one that sticks all period carries T = K (s - mean s)), or at its
position at rest (residual traction T0 retained: T = T0 + K s, s relative to rest). Cycles then lead to the true
periodic state. Derivations, sign conventions and sources: docs/theory_friction.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.law.coulomb_energy import dissipate_pairs
from stickslip.contact.law.coulomb_events import corrected_limits
from stickslip.contact.law.coulomb_kernel import CodeArray
from stickslip.contact.law.coulomb_normal_tangent import normal_tangents
from stickslip.contact.law.coulomb_period import CYCLES, settle_pairs
from stickslip.contact.law.coulomb_tangent import Basis, traction_tangents
from stickslip.contact.law.law import ContactCycle
from stickslip.core.errors import InputError
from stickslip.core.fourier import analysis_matrix, synthesis_matrix
from stickslip.core.threads import in_shares
from stickslip.core.validation import FloatArray, finite_array, require_choice

Update = Literal["tractrix", "radial"]
# Floor of a divisor: a pair that is never closed has no positive limit.
SMALLEST_LIMIT = 1e-300
# chosen: with fewer pairs, to share them among threads costs more than it gains (some 12 us a pair, 50 us a share).
PAIRS_OF_A_SHARE = 14
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


@dataclass(frozen=True)
class FrictionPeriods:
    """Periodic states, pair by pair: forces T and samples for sums (n_pairs, 2, n) N, step codes (n_pairs, n)."""

    forces: FloatArray
    samples: FloatArray
    modes: CodeArray
    state: CodeArray
    deviates: NDArray[np.bool_]
    closure: FloatArray
    starts: FloatArray


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
    limits = _limits(displacement, pairs, samples)
    force = np.empty_like(displacement)
    force[:, :2], deviates, periods = friction_force(displacement, limits, pairs, update)
    force[:, 2] = pairs.normal_stiffness[:, None] * displacement[:, 2]
    force[:, 2, 0] += np.minimum(
        pairs.offset_force, 0.0
    )  # a gap that stays closed: N = k_n n - gap force, zero at rest
    opens = (limits <= 0.0).any(axis=1)
    if opens.any():
        pressed = np.empty((int(opens.sum()), samples))
        corrected_limits(limits[opens], pressed)
        normal = pressed / pairs.friction_coefficient[opens, None]
        analysis = analysis_matrix(displacement.shape[2] // 2, samples)
        force[opens, 2] = (normal - pairs.normal_load[opens, None]) @ analysis.T
    return HarmonicForce(force, periods.state, deviates, periods.closure, periods.starts)


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
    limits = _limits(displacement, pairs, samples)
    if period_start is None:
        period_start = harmonic_force(displacement, pairs, samples, update).period_start
    tangent = np.zeros((len(chosen), 3, width, 3, width))
    normal_tangents(limits[chosen], pairs.normal_stiffness[chosen], _basis(width // 2, samples), tangent)
    slopes = np.repeat((pairs.friction_coefficient * pairs.normal_stiffness)[:, None], samples, axis=1)
    friction_tangent(displacement, limits, slopes, pairs, chosen, update, period_start, tangent)
    return tangent


def friction_force(
    displacement: FloatArray, limits: FloatArray, pairs: FrictionConstants, update: Update
) -> tuple[FloatArray, NDArray[np.bool_], FrictionPeriods]:
    """Traction coefficients (n_pairs, 2, 2H+1) N less those at rest, which pairs deviate, and their periodic states.

    ``displacement`` (n_pairs, 3, 2H+1) m, ``limits`` (n_pairs, n) N with their sign, at the samples of the period.
    """
    samples, width = limits.shape[1], displacement.shape[2]
    paths, means = _sampled_paths(displacement, pairs, samples)
    periods = _periods(paths, means, limits, pairs, update)
    force = (periods.samples.reshape(-1, samples) @ analysis_matrix(width // 2, samples).T).reshape(-1, 2, width)
    deviates = np.where(pairs.closed_at_rest, periods.deviates, (limits > 0.0).any(axis=1))
    stuck = ~deviates & pairs.closed_at_rest
    force[stuck] = pairs.tangential_springs[stuck, :, None] * displacement[stuck, :2]
    if pairs.released:
        force[stuck, :, 0] = 0.0
    else:
        force[~stuck, :, 0] -= pairs.resting_traction[~stuck]
    return force, deviates, periods


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
    samples = limits.shape[1]
    paths, means = _sampled_paths(displacement, pairs, samples)
    springs = pairs.tangential_springs[chosen]
    ratios, basis = _ratios(springs), _basis(displacement.shape[2] // 2, samples)

    def differentiate(start: int, stop: int) -> None:
        part = chosen[start:stop]
        traction_tangents(
            paths[part], means[part], limits[part], ratios[start:stop], springs[start:stop], limit_slopes[part],
            update == "tractrix", pairs.released, basis, period_start[part], tangent[start:stop],
        )  # fmt: skip

    in_shares(differentiate, len(chosen), PAIRS_OF_A_SHARE)


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
    springs = pairs.tangential_springs
    tangential = motion[:, :, :2]
    middle = tangential.mean(axis=0)
    closed = np.concatenate([tangential - middle, tangential[:1] - middle])
    paths, means = _drifting(np.ascontiguousarray((closed * springs).transpose(1, 2, 0)), springs * middle, pairs)
    limits = np.ascontiguousarray((pairs.friction_coefficient * load).T)
    periods = _periods(paths, means, limits, pairs, update)
    force = np.empty_like(motion)
    force[:, :, :2] = periods.forces.transpose(2, 0, 1)
    force[:, :, 2] = np.maximum(load, 0.0)
    energy = np.zeros(pairs.n_pairs)
    dissipate_pairs(paths, limits, springs, update == "tractrix", periods.forces, periods.modes, periods.state, energy)
    return ContactCycle(force, tangential - force[:, :, :2] / springs, periods.state, energy, periods.closure)


def _periods(
    paths: FloatArray, means: FloatArray, limits: FloatArray, pairs: FrictionConstants, update: Update
) -> FrictionPeriods:
    """March all pairs to their periodic states."""
    require_choice("update", update, get_args(Update))
    n_pairs, samples = limits.shape
    periods = FrictionPeriods(
        np.empty((n_pairs, 2, samples)),
        np.empty((n_pairs, 2, samples)),
        np.empty((n_pairs, samples), dtype=np.int8),
        np.empty(n_pairs, dtype=np.int8),
        np.empty(n_pairs, dtype=np.bool_),
        np.empty(n_pairs),
        np.empty((n_pairs, 4)),
    )
    ratios = _ratios(pairs.tangential_springs)

    def settle(start: int, stop: int) -> None:
        part = slice(start, stop)
        settle_pairs(
            paths[part], means[part], limits[part], ratios[part], update == "tractrix",
            periods.forces[part], periods.samples[part], periods.modes[part], periods.state[part],
            periods.deviates[part], periods.closure[part], periods.starts[part],
        )  # fmt: skip

    in_shares(settle, n_pairs, PAIRS_OF_A_SHARE)
    periods.closure[:] /= np.maximum(limits.max(axis=1), SMALLEST_LIMIT)
    return periods


def _drifting(paths: FloatArray, means: FloatArray, pairs: FrictionConstants) -> tuple[FloatArray, FloatArray]:
    """Paths (n_pairs, 2, n + 1) K (s - mean s), changed in their place, and means (n_pairs, 2) K mean s, as the sliders
    see them.

    A released slider is at the mean. Else the path begins with the traction at rest, and drifts: each cycle adds the
    same part of the mean displacement.
    """
    if pairs.released:
        return paths, np.zeros_like(means)
    paths += pairs.resting_traction[:, :, None]
    paths += (means / CYCLES)[:, :, None] * np.linspace(0.0, 1.0, paths.shape[2])
    return paths, means


def _sampled_paths(displacement: FloatArray, pairs: FrictionConstants, samples: int) -> tuple[FloatArray, FloatArray]:
    """Tangential paths and means (:func:`_drifting`)."""
    synthesis = synthesis_matrix(displacement.shape[2] // 2, samples)
    elastic = pairs.tangential_springs[:, :, None] * displacement[:, :2]
    closed = np.vstack([synthesis[:, 1:], synthesis[:1, 1:]])
    paths = (elastic[:, :, 1:].reshape(-1, elastic.shape[2] - 1) @ closed.T).reshape(-1, 2, samples + 1)
    return _drifting(paths, elastic[:, :, 0], pairs)


def _limits(displacement: FloatArray, pairs: CoulombConstants, samples: int) -> FloatArray:
    """(n_pairs, n) mu (N0 + kn n)."""
    load = pairs.normal_stiffness[:, None] * displacement[:, 2]
    load[:, 0] += pairs.offset_force
    limits = pairs.friction_coefficient[:, None] * load
    return np.asarray(limits @ synthesis_matrix(displacement.shape[2] // 2, samples).T)


@lru_cache(maxsize=32)
def _basis(harmonics: int, samples: int) -> Basis:
    """The Fourier basis with the running sums that the tangent needs."""
    synthesis = synthesis_matrix(harmonics, samples)
    analysis = np.ascontiguousarray(analysis_matrix(harmonics, samples).T)
    products = analysis[:, :, None] * synthesis[:, None, :]
    shares = np.arange(samples) / samples
    return Basis(
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
    array = np.asarray(coefficients, dtype=float)
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
