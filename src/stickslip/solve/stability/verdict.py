"""What the multipliers of one point say: how many are outside of the unit circle, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.stability.disturbances import SMALLEST_SIZE, ComplexArray, is_real

# A point with a larger multiplier is unstable whatever the error by samples, so it needs no second number of samples:
# its others, near the circle, change no verdict, only where their numbers change along an unstable part.
SURELY_OUTSIDE = 1.5
# A multiplier with more harmonics has an error of this multiple of its change: pairs that rattle open and close at
# other instants with each number of harmonics. On twins 5 of the torture set all multipliers are inside of the circle
# with 11 and 22 harmonics, by 0.049 and then 0.025; with 33 and 44 one has the size 1.23, and time integration leaves
# the motion.
CHANGE_FACTOR = 2.0
# Round-off of the march, where no contact changes.
ROUND_OFF = 1e-7


class Counts(NamedTuple):
    """Multipliers outside of the unit circle: real ones above 1, below -1, and complex ones."""

    positive: int
    negative: int
    complex: int


@dataclass(frozen=True)
class Verdict:
    """The multipliers of a point and their errors (of each).

    ``in_doubt``: pairs that touch their limits or hardly slip leave it open whether a disturbance grows;
    ``is_held_by_limits``: if pairs that touch their limits, or nearly so, slipped, one may (both from
    :class:`stickslip.solve.stability.multipliers.PointMultipliers`).
    """

    values: ComplexArray
    errors: FloatArray
    in_doubt: bool = False
    is_held_by_limits: bool = False

    @property
    def _real(self) -> BoolArray:
        return is_real(self.values)

    @property
    def is_surely_unstable(self) -> bool:
        """Whether a multiplier is outside of the unit circle by more than any error."""
        return bool((np.abs(self.values) > SURELY_OUTSIDE).any())

    @property
    def undecided(self) -> bool:
        """Whether a multiplier is closer to the unit circle than its error, and no other one decides, or a disturbance
        to one side may grow; folds decide about a real one near 1."""
        if self.in_doubt:
            return True
        if self.is_surely_unstable:
            return False
        beside_fold = self._real & (self.values.real > 0.0)
        unsure = np.abs(np.abs(self.values) - 1.0) <= self.errors
        return bool((unsure & ~beside_fold).any())

    def settles(self, stable: bool) -> bool:
        """Whether a verdict remains if each multiplier moves by its error; folds decide about real ones above 0."""
        sizes = np.abs(self.values)
        unsure = (np.abs(sizes - 1.0) <= self.errors) & ~(self._real & (self.values.real > 0.0))
        return not unsure.any() or (not stable and bool((sizes > 1.0 + self.errors).any()))

    def counts(self) -> Counts:
        """How many multipliers are outside of the unit circle."""
        outside = np.abs(self.values) > 1.0 + ROUND_OFF
        positive = outside & self._real & (self.values.real > 0.0)
        negative = outside & self._real & ~positive
        return Counts(int(positive.sum()), int(negative.sum()), int((outside & ~self._real).sum()))

    def near_one(self, distance: float) -> bool:
        """Whether a real multiplier is within a distance of 1, or its error."""
        return bool(self._near_one(distance).any())

    def possible(self, distance: float) -> range:
        """Numbers of real multipliers above 1, if those within a distance of 1, or their error, may be on either side,
        and a complex pair there may be two real ones on both sides."""
        near = self._near_one(distance)
        beyond = int((self._real & (self.values.real > 1.0) & ~near).sum())
        return range(beyond, beyond + int(near.sum()) + int(self.has_pair_near_one(distance)) + 1)

    def has_pair_near_one(self, distance: float) -> bool:
        """Whether a complex pair is within a distance of 1: errors may have made it of two real ones."""
        return bool((~self._real & (np.abs(self.values - 1.0) <= distance)).any())

    def confirms(self, stable: bool, distance: float) -> bool:
        """Whether these multipliers allow a verdict; folds decide about real ones within a distance of 1."""
        counts, positive = self.counts(), self.possible(distance)
        others = counts.negative + counts.complex
        return not (others or positive[0]) if stable else bool(others or positive[-1])

    def moved_from(self, fewer: Verdict) -> Verdict:
        """The same multipliers, those that matter with the errors that their changes from ``fewer`` harmonics show.

        A complex pair leaves the circle by a change of its size, or after it met on the real axis, so a change of its
        angle counts only if it may reach this axis, and then once: most of such a change goes along the circle.
        """
        nearest = fewer.values[np.abs(self.values[:, None] - fewer.values).argmin(axis=1)]
        moved = np.abs(self.values - nearest)
        resized = CHANGE_FACTOR * np.abs(np.abs(self.values) - np.abs(nearest))
        errors = np.where(CHANGE_FACTOR * moved >= np.abs(self.values.imag), np.maximum(moved, resized), resized)
        return replace(self, errors=np.where(np.abs(self.values) > SMALLEST_SIZE, errors, self.errors))

    def with_others(self, values: ComplexArray, errors: FloatArray) -> Verdict:
        """The same with further multipliers."""
        together = np.concatenate([self.values, values])
        order = np.argsort(-np.abs(together), kind="stable")
        return replace(self, values=together[order], errors=np.concatenate([self.errors, errors])[order])

    def _near_one(self, distance: float) -> BoolArray:
        """Which are real and within a distance of 1, or their error."""
        return np.asarray(self._real & (np.abs(self.values - 1.0) <= np.maximum(self.errors, distance)))


def distances_to(values: ComplexArray, others: ComplexArray) -> FloatArray:
    """(k,) the distance of each value from the nearest of the others."""
    return np.asarray(np.abs(values[:, None] - others).min(axis=1, initial=np.inf))
