"""Where stuck pairs touch their friction limit, and whether a disturbance goes beyond it there.

A touching pair that sticks has the traction ``T + k dx``. It slips where the law gives it another one, so that with the
step of the law at a touch (:mod:`stickslip.contact.law.linear_steps`)

    c = (keep_j - 1) k dx_(j-1) + (by_end_j - k) dx_j + (by_start_j + k) dx_(j-1)

the disturbance dx exceeds the limit if c is against the traction T_j, because slip takes traction away, and moves away
from the limit if c has the direction of T_j.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import BoolArray, ContactCycle, IndexArray
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.validation import FloatArray

# A traction that a disturbance brings beyond a limit by this fraction of its own change does not slip: round-off.
BEYOND = 1e-6


@dataclass(frozen=True)
class TouchedLimits:
    """The touches of t steps with their pairs.

    Attributes
    ----------
    pairs:
        (q,) the touching pairs.
    samples:
        (s,) samples 1 to n, sorted, at which displacements are required.
    before, here, place:
        (t,) places in ``samples`` of the start and the end of each step, and of the pair in ``pairs``; the start of the
        first step is the end of the period before, -1.
    keep, by_end, by_start:
        (t, 2, 2), (t, 2, 3), (t, 2, 3) N/m of each step.
    traction:
        (t, 2) N at its end.
    springs:
        (t, 2) N/m of the stuck pair.
    """

    pairs: IndexArray
    samples: IndexArray
    before: IndexArray
    here: IndexArray
    place: IndexArray
    keep: FloatArray
    by_end: FloatArray
    by_start: FloatArray
    traction: FloatArray
    springs: FloatArray

    @classmethod
    def of(cls, pairs: ContactPairs, cycle: ContactCycle, steps: LinearSteps, touching: IndexArray) -> TouchedLimits:
        """Those of the pairs ``touching`` (q,) in a ``cycle`` of all pairs."""
        count = len(cycle.force)
        touched = (steps.keep[:, touching] != np.eye(2)).any(axis=(2, 3))
        step, place = np.nonzero(touched)
        which = touching[place]
        end = np.where(step == 0, count, step)
        samples = np.unique(np.concatenate([end, np.where(end == 1, count, end - 1)]))
        before = np.where(end == 1, -1, np.searchsorted(samples, end - 1))
        traction = cycle.force[step, which, :2]
        springs = pairs.resting_stiffness().reshape(-1, 3)[which, :2]
        return cls(
            touching, samples, before, np.searchsorted(samples, end), place,
            steps.keep[step, which], steps.by_end[step, which], steps.by_start[step, which], traction, springs,
        )  # fmt: skip

    def is_left_by(self, motion: FloatArray, multipliers: FloatArray) -> BoolArray:
        """(c,) whether with one sign a disturbance comes to no limit.

        ``motion`` (s, q, 3, c) m is that of c disturbances in which these pairs stick, ``multipliers`` (c,) are their
        growth in the period.
        """
        end = motion[self.here, self.place]
        start = motion[self.before, self.place]
        start[self.before == -1] /= multipliers
        springs = self.springs[:, :, None]
        kept = springs * start[:, :2]
        change = self.keep @ kept - springs * end[:, :2] + self.by_end @ end + self.by_start @ start
        loss = -np.einsum("ta,tac->tc", self.traction, change)
        size = np.linalg.norm(self.traction, axis=1)[:, None] * np.linalg.norm(springs * end[:, :2], axis=1)
        exceeds = [(sign * loss > BEYOND * size).any(axis=0) for sign in (1.0, -1.0)]
        return np.asarray(~exceeds[0] | ~exceeds[1])
