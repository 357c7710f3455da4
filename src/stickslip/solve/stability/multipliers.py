"""The Floquet multipliers of one periodic motion: eigenvalues of the march over one period."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import BoolArray, ContactCycle, ContactState
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.fourier import synthesis_matrix
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.stability.contact_steps import linear_steps
from stickslip.solve.stability.disturbances import ComplexArray, Disturbances, stuck_multipliers
from stickslip.solve.stability.model import StabilityModel
from stickslip.solve.stability.one_sided import GROWS, growing_to_one_side, grows_to_one_side, is_to_one_side

# A pair that slips by less than this fraction of its motion sticks under a disturbance of 1 %, and its slip is often
# within what the harmonics neglect: at 3e-5 time integration leaves a motion with multipliers inside of the circle by
# the 1.058 of a structure in which the pair sticks (test_touching_pairs.py).
BARELY = 1e-2


class PointMultipliers:
    """The multipliers of a solution, from a march over a period in so many samples.

    A pair that sticks through the period is its springs: its slider is no state and has no multiplier 1. Neutral
    disturbances are omitted.

    A slider that has shaken down and only touches its limit follows a disturbance that goes farther, and does not come
    back. So it follows one that grows to one side, of a real multiplier above 0. One that changes its sign or rotates
    moves it once and does not touch it again until it is larger: of these, the multipliers of touching pairs that stick
    decide.

    Attributes
    ----------
    values:
        the largest first; all that matter, and often more.
    is_held_by_touches:
        whether sliders that follow would have a multiplier outside of the circle that changes its sign or rotates.
    nearly_touches:
        whether a disturbance of BARELY of the motion of a stuck pair takes it to a limit that it does not touch.
    """

    def __init__(self, model: StabilityModel, pairs: ContactPairs, trial: Trial, samples: int) -> None:
        self._model, self._pairs, self._trial = model, pairs, trial
        self._moving = np.flatnonzero(trial.contact.moves.any(axis=1))
        self._touching = self._moving[:0]
        self.is_held_by_touches = False
        if not self._moving.size:
            self.values = stuck_multipliers(model, trial.omega)
            return
        self._motion = _motion(pairs, trial, samples)
        self._steps = linear_steps(pairs, self._motion)
        self._sticks = trial.contact.state[self._moving] == ContactState.STUCK
        touching = self._sticks & (self._steps.keep[:, self._moving] != np.eye(2)).any(axis=(0, 2, 3))
        self._touching = self._moving[touching]
        self._disturbances = self._of(self._steps, touching)
        self.values = self._if_all_follow
        to_one_side = is_to_one_side(self.values)
        if self._touching.size and (np.abs(self.values[~to_one_side]) > 1.0).any():
            sticking = self._if_none_follows
            self.is_held_by_touches = True
            self.values = _sorted(np.concatenate([self.values[to_one_side], sticking[~is_to_one_side(sticking)]]))

    def growing_otherwise(self) -> tuple[ComplexArray, bool]:
        """Multipliers outside of the circle, beyond round-off, that ``values`` do not have, and whether the verdict is
        in doubt.

        ``values`` are those of sliders that follow at all touches. A real multiplier of another choice of touches grows
        if its disturbance, with one sign, exceeds exactly the limits at which sliders follow it. If one grows where all
        stick, but exceeds limits, these may hold it. One that changes its sign or rotates grows if sliders stick; that
        of sliders that follow does not, so the verdict depends on the size of the disturbance. One that is larger than
        the slip of pairs meets a structure in which these stick too.
        """
        certain, in_doubt = np.zeros(0, dtype=complex), False
        if not self._moving.size:
            return certain, in_doubt
        if self._touching.size:
            sticking = self._if_none_follows
            certain = self._growing_to_one_side()
            in_doubt = grows_to_one_side(sticking) and not certain.size
            others = sticking[~is_to_one_side(sticking)]
            others = others[np.abs(others) > 1.0 + GROWS]
            certain, in_doubt = np.concatenate([certain, others]), in_doubt or others.size > 0
        if not certain.size and not in_doubt:
            barely = self._barely_slipping()
            if barely.any():
                barely[self._touching] = True
                in_doubt = bool((np.abs(self._if_they_stick(barely)) > 1.0 + GROWS).any())
        return certain, in_doubt

    def grows_in_doubt(self) -> bool:
        """Whether multipliers of sliders that follow grow beyond round-off, but no disturbance with one sign exceeds
        exactly the limits at which they follow it."""
        if not self._touching.size or not grows_to_one_side(self._if_all_follow):
            return False
        return not self._growing_to_one_side().size

    @property
    def nearly_touches(self) -> bool:
        """See above; where no pair moves it is not asked, nor of laws that have no coefficient of friction."""
        if not self._moving.size:
            return False
        stuck = np.flatnonzero(self._trial.contact.state == ContactState.STUCK)
        springs = self._pairs.resting_stiffness().reshape(-1, 3)[stuck, :2]
        change = (springs * np.ptp(self._motion[:, stuck, :2], axis=0)).max(axis=1)
        force = self._cycle.force[:, stuck]
        distance = self._pairs.friction_coefficient[stuck] * force[:, :, 2] - np.linalg.norm(force[:, :, :2], axis=2)
        lowest = (distance <= np.roll(distance, 1, axis=0)) & (distance <= np.roll(distance, -1, axis=0))
        touched = (self._steps.keep[:, stuck] != np.eye(2)).any(axis=(2, 3))
        touched |= np.roll(touched, 1, axis=0) | np.roll(touched, -1, axis=0)
        return bool((lowest & ~touched & (distance < BARELY * change)).any())

    @property
    def _if_all_follow(self) -> ComplexArray:
        """The multipliers if sliders of touching pairs follow at all touches."""
        return self._disturbances.modes(np.ones(self._disturbances.n_touches, dtype=bool)).values

    @property
    def _if_none_follows(self) -> ComplexArray:
        """The multipliers if touching pairs stick."""
        return self._disturbances.modes(np.zeros(self._disturbances.n_touches, dtype=bool)).values

    def _of(self, steps: LinearSteps, touching: BoolArray) -> Disturbances:
        return Disturbances(self._model, steps, self._moving, self._sticks, touching, self._trial.omega)

    @cached_property
    def _cycle(self) -> ContactCycle:
        """The periodic state."""
        return self._pairs.cycle(self._motion)

    def _growing_to_one_side(self) -> ComplexArray:
        sense = self._disturbances.limits.sense(self._cycle.force[:, self._disturbances.pairs, :2])
        return growing_to_one_side(self._disturbances, sense)

    def _if_they_stick(self, directions: BoolArray) -> ComplexArray:
        """The multipliers if pairs stick through the period in some ``directions`` (n_pairs, 2)."""
        keep = self._steps.keep.copy()
        pairs, axes = np.nonzero(directions)
        keep[:, pairs, axes] = np.eye(2)[axes]
        disturbances = self._of(replace(self._steps, keep=keep), np.zeros(self._moving.size, dtype=bool))
        return disturbances.modes(np.zeros(0, dtype=bool)).values

    def _barely_slipping(self) -> BoolArray:
        """(n_pairs, 2) directions in which pairs that move slip by less than BARELY of their motion: both of a pair, or
        those of a law whose directions do not know of each other."""
        way, size = np.ptp(self._cycle.slider, axis=0), np.ptp(self._motion[:, :, :2], axis=0)
        slips = self._moving[self._trial.contact.state[self._moving] == ContactState.STICK_SLIP]
        answer = np.zeros(way.shape, dtype=bool)
        answer[slips] = (way[slips].max(axis=1) < BARELY * size[slips].max(axis=1))[:, None]
        coupling = np.abs(self._steps.keep[:, slips][:, :, [0, 1], [1, 0]]) if slips.size else np.zeros((1, 0, 2))
        apart = slips[~coupling.any(axis=(0, 2))]
        answer[apart] |= way[apart] < BARELY * size[apart]
        return answer


def _motion(pairs: ContactPairs, trial: Trial, samples: int) -> FloatArray:
    """(samples, n_pairs, 3) m, the relative motion of a solution."""
    coefficients = trial.relative.T.reshape(pairs.n_pairs, 3, -1)
    harmonics = coefficients.shape[2] // 2
    return np.moveaxis(coefficients @ synthesis_matrix(harmonics, samples).T, 2, 0)


def _sorted(values: ComplexArray) -> ComplexArray:
    """The largest first."""
    return values[np.argsort(-np.abs(values), kind="stable")]
