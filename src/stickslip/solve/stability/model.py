"""The structure in the modes that matter for stability: near coordinates with inertia, far ones as static flexibility.

A disturbance of a periodic motion that may grow moves the structure in the modes that the motion excites; all others
follow it as springs. The near coordinates are those of the stuck structure up to a multiple of the excitation, and what
the modes of the structure without (and with all) springs of the moving pairs have beyond them: where a joint slides the
structure moves in those. The remaining flexibility at the moving pairs is exact but for its stiffest patterns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.compliance import StuckStructure
from stickslip.solve.harmonic.damping import DAMPED_RANGE

# Modes up to this multiple of the excitation have inertia, and those up to twice the highest harmonic if modal damping
# reaches them (DAMPED_RANGE). At the excitation a mode above moves by 1 % less than with its inertia.
NEAR_RANGE, NEAR_HARMONICS = 10.0, 2.0
# The part of a mode without springs that the stuck near modes do not contain has inertia if its mass-weighted length is
# above this: below, it would change the frequency of the mode by less than half its square, 5e-5.
SMALLEST_PART = 0.01
# A pattern of contact displacements whose flexibility is less than this fraction of that of its contact springs is
# rigid: less than a tenth of the slip of that pattern. MOST_FLEXIBLE patterns are exact whatever their size, so that
# small joints lose nothing. With the 53 patterns above 2 % instead of 12, multipliers of the default two-blade case
# change by less than 3e-4.
SMALLEST_FLEXIBILITY, MOST_FLEXIBLE = 0.1, 12
# A direction without friction is free if its stiffness is below this fraction of its inertia at the excitation. The
# near coordinates contain free motions but for SMALLEST_FREE_PART (round-off), so that no force answers them.
FREE_STIFFNESS, SMALLEST_FREE_PART = 1e-7, 1e-10


@dataclass(frozen=True)
class StabilityModel:
    """Near coordinates q and far patterns s of a joint with m = 3 n_pairs rows.

        q'' + damping q' + diag(frequency^2) q = -near_contact^T d,   s = -far_contact^T d
        x = near_contact q + far_contact s

    with the deviation d (m,) of the contact force from ``springs x``. The mass matrix and the stiffness of the far
    patterns are the identity.

    Attributes
    ----------
    frequency:
        (p,) rad/s, the first ``modes`` of them those of the stuck structure; the others are fast coordinates, which
        move much where the joint slides and stick as a rule.
    damping:
        (p, p) 1/s.
    near_contact, far_contact:
        (m, p) and (m, r).
    springs:
        (n_pairs, 3) N/m, the resting springs, which are in ``frequency``.
    modes:
        number of stuck modes among the near coordinates.
    free:
        (p, f) motions of the near coordinates without any spring in the moving directions; mostly none.
    """

    frequency: FloatArray
    damping: FloatArray
    near_contact: FloatArray
    far_contact: FloatArray
    springs: FloatArray
    modes: int
    free: FloatArray


def stability_model(
    stuck: StuckStructure, harmonics: int, moves: BoolArray, hidden_springs: FloatArray
) -> StabilityModel:
    """The model of a curve whose pairs move in the rows ``moves`` (n_pairs, 3).

    ``hidden_springs`` (n_pairs, 3) N/m are those that act at some point in addition to the resting springs.
    """
    springs = stuck.pairs.resting_stiffness().reshape(-1, 3)
    limit = min(max(NEAR_RANGE, NEAR_HARMONICS * harmonics), DAMPED_RANGE) * stuck.highest_omega
    frequency, contact = stuck.circular_frequency, stuck.contact_modes
    modes = int(np.searchsorted(frequency, limit, side="right"))
    rows = np.flatnonzero(moves.ravel())
    added, free = _sliding_part(
        frequency, modes, limit, contact[rows], [-springs.ravel()[rows], hidden_springs.ravel()[rows]],
        FREE_STIFFNESS * stuck.highest_omega**2,
    )  # fmt: skip
    stiffness, turn = scipy.linalg.eigh(added.T @ (frequency[modes:, None] ** 2 * added))
    added = added @ turn
    basis = np.zeros((frequency.size, modes + added.shape[1]))
    basis[range(modes), range(modes)] = 1.0
    basis[modes:, modes:] = added
    if stuck.modal_damping.ndim == 1:
        damping = basis.T @ (stuck.modal_damping[:, None] * basis)
    else:
        damping = basis.T @ stuck.modal_damping @ basis
    scale = (springs + hidden_springs).ravel()[rows]
    far = np.zeros((contact.shape[0], 0))
    patterns = _flexibility(frequency[modes:], added, contact[rows, modes:], np.where(scale > 0.0, scale, 1.0))
    far = np.zeros((contact.shape[0], patterns.shape[1]))
    far[rows] = patterns
    return StabilityModel(
        np.concatenate([frequency[:modes], np.sqrt(stiffness)]), damping, np.ascontiguousarray(contact @ basis), far,
        springs, modes, basis.T @ free,
    )  # fmt: skip


def _sliding_part(
    frequency: FloatArray, modes: int, limit: float, contact: FloatArray, changes: Sequence[FloatArray], free: float
) -> tuple[FloatArray, FloatArray]:
    """(n - modes, w) orthonormal parts, in the far stuck modes, of the modes up to ``limit`` with other springs, and
    (n, f) those of them with a stiffness below ``free`` in 1/s2, which the parts contain completely.

    ``contact`` (k, n) are the relative displacements of the stuck modes on k rows, ``changes`` (k,) N/m each.
    """
    parts, motions = [np.zeros((frequency.size - modes, 0))], np.zeros((frequency.size, 0))
    for change in changes:
        if not change.any():
            continue
        stiffness = contact.T @ (change[:, None] * contact)
        stiffness[np.diag_indices_from(stiffness)] += frequency**2
        # Rigid motions may have slightly negative squares by round-off.
        _, shapes = scipy.linalg.eigh(stiffness, subset_by_value=(-np.inf, limit**2))
        parts.append(shapes[modes:])
        # The eigenvalues have the round-off of the highest mode, these quotients have not.
        squares = np.einsum("nf,nf->f", shapes, frequency[:, None] ** 2 * shapes)
        squares += np.einsum("kf,kf->f", contact @ shapes, change[:, None] * (contact @ shapes))
        motions = np.hstack([motions, shapes[:, squares < free]])
    exact = _orthonormal(motions[modes:], SMALLEST_FREE_PART)
    others = np.hstack(parts)
    return np.hstack([exact, _orthonormal(others - exact @ (exact.T @ others), SMALLEST_PART)]), motions


def _orthonormal(parts: FloatArray, smallest: float) -> FloatArray:
    """An orthonormal basis of columns (n, c), without directions below a size."""
    directions, sizes, _ = np.linalg.svd(parts, full_matrices=False)
    return np.asarray(directions[:, sizes > smallest])


def _flexibility(frequency: FloatArray, added: FloatArray, contact: FloatArray, springs: FloatArray) -> FloatArray:
    """(k, r) patterns whose outer product is the static compliance of the far modes less that of ``added``.

    ``frequency`` (f,) and ``contact`` (k, f) are those of the far modes; ``springs`` (k,) N/m are the scale.
    """
    rooted = (contact / frequency).T
    basis, _ = np.linalg.qr(frequency[:, None] * added)
    rooted -= basis @ (basis.T @ rooted)
    rooted *= np.sqrt(springs)
    sizes, shapes = scipy.linalg.eigh(rooted.T @ rooted)
    first = min(int(np.searchsorted(sizes, SMALLEST_FLEXIBILITY)), max(sizes.size - MOST_FLEXIBLE, 0))
    chosen = np.maximum(sizes[first:], 0.0)
    return np.asarray(np.sqrt(chosen) * shapes[:, first:] / np.sqrt(springs)[:, None])
