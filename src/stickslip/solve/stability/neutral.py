"""Disturbances that neither grow nor decay because no force answers them: their multipliers are exactly 1.

Two kinds exist, and both are known before the march:

* A pair that has shaken down touches its limit without slip. What it loses there lies along its slip direction; a
  combination ``w`` of its deviations that no step changes stays for ever, so ``w`` is a left eigenvector of the march:

      w^T keep_j = w^T,   w^T by_end_j = w^T k,   w^T by_start_j = -w^T k   in each step j

* A body that friction alone supports, each of whose pairs slips, moves along with its sliders: where it rests, or walks
  to, is not determined. This displacement is a right eigenvector.

The march without these has all other multipliers, exactly. So no multiplier has to be compared with 1, and one that
crosses 1 at a fold cannot be taken for a neutral one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.law import BoolArray, IndexArray
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.validation import FloatArray
from stickslip.solve.stability.model import FREE_STIFFNESS, StabilityModel

# A combination is conserved if no step changes more than this fraction of it: round-off at a touch. The second number
# is for pairs that the solution calls stuck. They may creep: between the samples of the march they slip by up to 2e-5
# of their motion on the torture set, and the multiplier of what they conserve is as close to 1.
CONSERVED, CONSERVED_STUCK = 1e-7, 1e-4


@dataclass(frozen=True)
class Neutral:
    """Neutral disturbances of the states of one march, in the units of the march.

    Attributes
    ----------
    conserved:
        (size, a) orthonormal left eigenvectors.
    free:
        (size, b) orthonormal right eigenvectors in the space across ``conserved``.
    """

    conserved: FloatArray
    free: FloatArray

    def before(self, states: FloatArray) -> FloatArray:
        """States (size, c) without conserved parts, which a march keeps out."""
        return states - self.conserved @ (self.conserved.T @ states)

    def after(self, states: FloatArray) -> FloatArray:
        """States (size, c) after a march without conserved parts and free motions."""
        left = self.before(states)
        return left - self.free @ (self.free.T @ left)


def neutral_disturbances(
    model: StabilityModel, steps: LinearSteps, moving: IndexArray, sticks: BoolArray, omega: float, scale: FloatArray
) -> Neutral:
    """Those of a march over ``steps`` of the ``moving`` pairs (k,) under an excitation at ``omega`` rad/s.

    ``sticks`` (k,) are the pairs that the solution calls stuck; ``scale`` (size,) the units of the states ``(q, v, s,
    d)`` of the march (:class:`Period`).
    """
    pairs, combinations = _conserved(steps, model.springs[moving, :2], np.where(sticks, CONSERVED_STUCK, CONSERVED))
    conserved = np.zeros((scale.size, len(pairs)))
    for column, (pair, combination) in enumerate(zip(pairs, combinations, strict=True)):
        rows = scale.size - 2 * moving.size + 2 * pair + np.arange(2)
        conserved[rows, column] = combination * scale[rows]
    conserved, _ = np.linalg.qr(conserved)
    free, _ = np.linalg.qr(_free_motions(model, steps, moving, omega) / scale[:, None])
    # A body that is free takes along what its pairs conserve.
    _, sizes, turn = np.linalg.svd(conserved.T @ free)
    return Neutral(conserved, free @ turn[int((sizes > CONSERVED).sum()) :].T)


def _conserved(steps: LinearSteps, springs: FloatArray, accuracy: FloatArray) -> tuple[IndexArray, FloatArray]:
    """The pairs (a,) of conserved combinations (a, 2), to an ``accuracy`` (k,); a pair may have two. ``springs`` (k, 2)
    N/m are those at rest."""
    lost = steps.keep - np.eye(2)
    candidates = np.flatnonzero(_smallest(lost)[0][:, 0] <= accuracy**2)
    own = np.zeros((candidates.size, 2, 3))
    own[:, (0, 1), (0, 1)] = springs[candidates]
    unit = np.maximum(springs[candidates].max(axis=1), np.finfo(float).tiny)[:, None, None]
    changes = [lost[:, candidates]]
    changes += [(steps.by_end[:, candidates] - own) / unit, (steps.by_start[:, candidates] + own) / unit]
    squares, directions = _smallest(np.concatenate(changes, axis=3))
    pair, which = np.nonzero(squares <= accuracy[candidates, None] ** 2 * np.maximum(squares[:, 1:], 1.0))
    return candidates[pair], directions[pair, :, which]


def _smallest(changes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Squares (k, 2), ascending, of what changes (n, k, 2, c) do to combinations of both rows, and these (k, 2, 2)."""
    rows = changes.transpose(1, 2, 0, 3).reshape(changes.shape[1], 2, changes.shape[0] * changes.shape[3])
    squares, directions = np.linalg.eigh(rows @ rows.transpose(0, 2, 1))
    return squares, directions


def _free_motions(model: StabilityModel, steps: LinearSteps, moving: IndexArray, omega: float) -> FloatArray:
    """(size, b) states of displacements that no spring resists, with the sliders moved along."""
    if not model.free.size:
        return np.zeros((2 * model.frequency.size + model.far_contact.shape[1] + 2 * moving.size, 0))
    relative = (model.near_contact @ model.free).reshape(*model.springs.shape, model.free.shape[1])
    slides = (steps.by_end[..., :2] == -steps.by_start[..., :2]).all(axis=(0, 2))
    # The largest stiffness of each direction against a constant displacement: none where sliders follow.
    resisting = model.springs.copy()
    resisting[moving] = np.abs(np.dstack([steps.by_end[..., 0, 0], steps.by_end[..., 1, 1], steps.normal])).max(axis=0)
    resisting[moving, :2] *= ~slides
    squares, turn = np.linalg.eigh(np.einsum("kaf,ka,kag->fg", relative, resisting, relative))
    free = turn[:, squares < FREE_STIFFNESS * omega**2]
    deviation = -(model.springs[moving, :2] * slides)[:, :, None] * (relative[moving, :2] @ free)
    p, r = model.frequency.size, model.far_contact.shape[1]
    return np.vstack(
        [model.free @ free, np.zeros((p + r, free.shape[1])), deviation.reshape(2 * moving.size, free.shape[1])]
    )
