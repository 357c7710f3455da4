"""Disturbances that remain on one side and grow although, or because, sliders follow them at touched limits.

At each touch the slider follows if the disturbance exceeds the limit and sticks if not, so a periodic motion with t
touches has a march for each of 2^t choices, and each is that of some directions alone. A real multiplier above 0 is one
of the motion if its disturbance, with one of its signs, exceeds exactly the limits at which the sliders follow it.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from stickslip.contact.law.law import BoolArray, IndexArray
from stickslip.core.validation import FloatArray
from stickslip.solve.stability.disturbances import ComplexArray, DisturbanceModes, is_real

# chosen: a smaller growth in a period is within the error of the samples.
GROWS = 1e-3
# A change of traction at a touch, over the root of the spring, that is smaller than this fraction of the root of the
# energy of a disturbance is round-off.
BEYOND = 1e-6
# Choices of touches at which sliders follow. LEADING multipliers lead to others: on three rattling dampers of the
# torture set these find 25 of the 27 points at which some choice grows, but neither all touches nor none, among 979
# points with touches; with 0.9 26, for three times as many choices of the benchmark blades.
MOST_CHOICES, LEADING = 8, 0.98


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
        if not leading.size:
            continue
        beyond = modes.changes[:, leading].real * sense[:, None]
        both = np.concatenate([beyond, -beyond], axis=1)
        fits = (both[follow] > -BEYOND).all(axis=0) & (both[~follow] < BEYOND).all(axis=0)
        values = np.tile(modes.values[leading], 2)
        growing = fits & (values.real > 1.0 + GROWS)
        if growing.any():
            return np.asarray(values[growing])
        waiting += [exceeded > BEYOND for exceeded in both.T]
    return np.zeros(0, dtype=complex)


def growing(values: ComplexArray) -> IndexArray:
    """The places of multipliers of disturbances that grow to one side."""
    return np.flatnonzero(is_to_one_side(values) & (values.real > 1.0 + GROWS))


def is_to_one_side(values: ComplexArray) -> BoolArray:
    """Which multipliers are those of a disturbance that remains on one side: real ones above 0."""
    return is_real(values) & (values.real > 0.0)
