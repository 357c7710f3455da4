"""Disturbances that remain on one side and grow although, or because, sliders follow them at touched limits.

At each touch the slider follows if the disturbance exceeds the limit and sticks if not, so a periodic motion with t
touches has a march for each of 2^t choices, and each is that of some directions alone. A real multiplier above 0 is one
of the motion if its disturbance, with one of its signs, exceeds exactly the limits at which the sliders follow it.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.stability.disturbances import RITZ_TOLERANCE, ComplexArray, DisturbanceModes, is_real

# chosen: a smaller growth in a period is within the error of the samples.
GROWS = 1e-3
# A change of traction at a touch, over the root of the spring, that is smaller than this fraction of the root of the
# energy of a disturbance is within the error of the iteration for large joints.
BEYOND = RITZ_TOLERANCE
# Choices of touches that the search tries, and the multipliers that lead to others. On the dampers 5 and 8 of the
# torture set, with 571 points with touches, it finds 14 of the 18 points at which some choice grows, but neither all
# touches nor none do. Eight choices and 0.98 find no more, and take five times as long on the default study.
MOST_CHOICES, LEADING = 4, 0.99


class ChosenTouches(Protocol):
    """Marches with sliders that follow at some of t touches (:class:`Disturbances`)."""

    @property
    def n_touches(self) -> int:
        """Number t of touches."""

    def modes(self, follow: BoolArray) -> DisturbanceModes:
        """Eigenvalues and changes of the march whose sliders ``follow`` (t,)."""


def growing_to_one_side(touches: ChosenTouches, sense: FloatArray) -> ComplexArray:
    """Real multipliers above 1 of disturbances that, with one sign, exceed exactly the limits at which the sliders
    follow it; empty if the choices tried have none.

    The first choices are no touch and all; the next are the limits that leading disturbances of a choice exceed.
    ``sense`` (t,) is that of the changes by sliders that follow (:meth:`TouchedLimits.sense`).
    """
    waiting = [np.zeros(touches.n_touches, dtype=bool), np.ones(touches.n_touches, dtype=bool)]
    tried = set[bytes]()
    while waiting and len(tried) < MOST_CHOICES:
        follow = waiting.pop(0)
        if follow.tobytes() in tried:
            continue
        tried.add(follow.tobytes())
        modes = touches.modes(follow)
        leading = np.flatnonzero(is_to_one_side(modes.values) & (modes.values.real > LEADING))
        beyond = modes.changes[:, leading].real * sense[:, None]
        both = np.concatenate([beyond, -beyond], axis=1)
        fits = (both[follow] > -BEYOND).all(axis=0) & (both[~follow] < BEYOND).all(axis=0)
        values = modes.values[leading[fits.reshape(2, -1).any(axis=0)]]
        if grows_to_one_side(values):
            return np.asarray(values[values.real > 1.0 + GROWS])
        waiting += [exceeded > BEYOND for exceeded in both.T]
    return np.zeros(0, dtype=complex)


def grows_to_one_side(values: ComplexArray) -> bool:
    """Whether a disturbance with one of these multipliers grows and remains on one side."""
    return bool((is_to_one_side(values) & (values.real > 1.0 + GROWS)).any())


def is_to_one_side(values: ComplexArray) -> BoolArray:
    """Which multipliers are those of a disturbance that remains on one side: real ones above 0."""
    return is_real(values) & (values.real > 0.0)
