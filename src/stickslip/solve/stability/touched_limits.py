"""Where stuck pairs touch their friction limit: what a disturbance changes there if their sliders follow.

A touching pair that sticks has the traction ``T_(j-1) + k (dx_j - dx_(j-1))``. Where its slider follows, the law gives
it another one. With the deviation d of the traction from the resting springs and the step of the law at a touch
(:mod:`stickslip.contact.law.linear_steps`) the difference is

    c_j = (keep_j - 1) d_(j-1) + (by_end_j - k) dx_j + (by_start_j + keep_j k) dx_(j-1)

Slip takes traction away: the slider follows if c_j is against the traction, and the disturbance moves away from the
limit if it has the direction of the traction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.law import BoolArray, IndexArray
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.validation import FloatArray

# A direction in which the step of a touch changes less than this fraction of the spring is round-off; pairs that the
# solution calls stuck may creep by 2e-5 of their motion (:mod:`stickslip.solve.stability.neutral`).
CHANGES = 1e-4


@dataclass(frozen=True)
class TouchedLimits:
    """t directions at touches, in the order of their steps; a touch of two independent sliders has two.

    Attributes
    ----------
    step:
        (t,) 1 to n, the sample at which the step ends; n is sample 0 of the next period.
    pair:
        (t,) places among the k pairs of the steps.
    direction:
        (t, 2) unit vectors along which a slider that follows changes the traction.
    unit:
        (t,) root of N/m: a change of the traction over it is the root of an energy.
    by_memory, by_end, by_start:
        (t, 2), (t, 3), (t, 3) what of the change the deviation before the step and the displacements after and before
        it cause.
    """

    step: IndexArray
    pair: IndexArray
    direction: FloatArray
    unit: FloatArray
    by_memory: FloatArray
    by_end: FloatArray
    by_start: FloatArray

    @classmethod
    def of(cls, steps: LinearSteps, touching: IndexArray, springs: FloatArray) -> TouchedLimits:
        """Those of the pairs ``touching`` (q,) among the k of ``steps`` with resting ``springs`` (k, 3) N/m."""
        one = np.eye(2)
        step, place = np.nonzero((steps.keep[:, touching] != one).any(axis=(2, 3)))
        step[step == 0] = len(steps.keep)
        order = np.argsort(step, kind="stable")
        step, pair = step[order], touching[place[order]]
        at = step % len(steps.keep)
        own = np.zeros((step.size, 2, 3))
        own[:, (0, 1), (0, 1)] = springs[pair, :2]
        keep = steps.keep[at, pair]
        stiffest = np.maximum(springs[pair, :2].max(axis=1), np.finfo(float).tiny)
        change = [keep - one, steps.by_end[at, pair] - own, steps.by_start[at, pair] + keep @ own]
        whole = np.concatenate([change[0], *(each / stiffest[:, None, None] for each in change[1:])], axis=2)
        directions, sizes, _ = np.linalg.svd(whole, full_matrices=False)
        touch, which = np.nonzero(sizes > CHANGES)
        direction = directions[touch, :, which]
        return cls(
            step[touch], pair[touch], direction, np.sqrt(stiffest[touch]),
            *(np.einsum("ta,tab->tb", direction, each[touch]) for each in change),
        )  # fmt: skip

    def sense(self, traction: FloatArray) -> FloatArray:
        """(t,) the sign of the change by a slider that follows, 0 if it is across the traction, from the ``traction``
        (n, k, 2) N of the motion."""
        here = traction[self.step % len(traction), self.pair]
        along = np.einsum("ta,ta->t", here, self.direction)
        return np.where(np.abs(along) > CHANGES * np.linalg.norm(here, axis=1), -np.sign(along), 0.0)

    def changed(self, steps: LinearSteps, springs: FloatArray, follow: BoolArray) -> LinearSteps:
        """The ``steps`` in which touching pairs stick, except at the touches where their sliders ``follow`` (t,)."""
        keep, by_end, by_start = steps.keep.copy(), steps.by_end.copy(), steps.by_start.copy()
        pairs = np.unique(self.pair)
        keep[:, pairs], by_end[:, pairs], by_start[:, pairs] = np.eye(2), 0.0, 0.0
        for axis in range(2):
            by_end[:, pairs, axis, axis], by_start[:, pairs, axis, axis] = springs[pairs, axis], -springs[pairs, axis]
        at, direction = (self.step[follow] % len(keep), self.pair[follow]), self.direction[follow, :, None]
        memory = self.by_memory[follow, None]
        # The memory of a step is the traction, which contains the resting springs.
        start = self.by_start[follow, None].copy()
        start[:, :, :2] -= memory * springs[self.pair[follow], None, :2]
        for whole, change in ((keep, memory), (by_end, self.by_end[follow, None]), (by_start, start)):
            np.add.at(whole, at, direction * change)
        return LinearSteps(keep, by_end, by_start, steps.normal)
