"""The constants that friction needs of each pair, and how many pairs one thread takes at a time."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

# chosen: with fewer pairs, to share them among threads costs more than it gains (some 12 us a pair, 50 us a share).
PAIRS_OF_A_SHARE = 14
# chosen: with more shares, the interpreter's own time for each is no longer small; with fewer, threads wait at the end.
MOST_SHARES = 16


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


def pairs_of_a_share(count: int) -> int:
    """How many of ``count`` pairs a thread takes at a time."""
    return max(PAIRS_OF_A_SHARE, -(-count // MOST_SHARES))
