"""A law linearised along a periodic motion, sample by sample: what a small disturbance of the motion does to its force.

The harmonic balance needs the derivative of the periodic force. A disturbance need not be periodic: it grows or decays,
and what a slider remembers of it is a state of its own. So the stability of a motion needs the law step by step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray


@dataclass(frozen=True)
class LinearSteps:
    """Derivatives of the steps of p pairs between n samples of a period; entry j is the step that ends at sample j.

    A disturbance dx of the displacement t1, t2, n and dT of the tangential force, which is the memory, obeys

        dT_j = keep_j dT_(j-1) + by_end_j dx_j + by_start_j dx_(j-1),   dN_j = normal_j dn_j

    Attributes
    ----------
    keep:
        (n, p, 2, 2): the identity while a pair sticks, zero while it is open.
    by_end, by_start:
        (n, p, 2, 3) N/m.
    normal:
        (n, p) N/m, the mean over the half steps on both sides of the sample, so that a pair that lifts off between
        samples has the part of its spring that acts.
    """

    keep: FloatArray
    by_end: FloatArray
    by_start: FloatArray
    normal: FloatArray

    __repr__ = short_repr


@runtime_checkable
class SteppedLaw(Protocol):
    """A law whose steps along a period have derivatives, by which stability is computed."""

    def linear_steps(self, displacement: FloatArray) -> LinearSteps:
        """The steps along the periodic state under a motion (n, p, 3) m."""
