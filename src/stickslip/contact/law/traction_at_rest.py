"""The traction at rest of laws with friction along t1 and t2: released, or a residual traction that a pair retains."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.law import BoolArray
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array


class TractionAtRest(ABC):
    """Part of a law with friction along t1 and t2. None as ``residual_traction`` (p, 2) N is released."""

    residual_traction: FloatArray | None = None

    @property
    @abstractmethod
    def n_pairs(self) -> int:
        """Number p of pairs."""

    @property
    def released(self) -> bool:
        """True if each period starts at the mean of the motion, so that a traction at rest has no effect."""
        return self.residual_traction is None

    @property
    def resting_traction(self) -> FloatArray:
        """(p, 2) N along t1, t2 at rest: the residual traction; zero if released."""
        return np.zeros((self.n_pairs, 2)) if self.residual_traction is None else self.residual_traction

    def frictional(self) -> BoolArray:
        """(p, 3) True along t1 and t2."""
        return np.tile([True, True, False], (self.n_pairs, 1))

    def undetermined(self) -> BoolArray:
        """(p, 3) True along t1 and t2 if released: the force does not depend on the mean there."""
        return self.frictional() & self.released


def traction_of_pairs(traction: ArrayLike, n_pairs: int) -> FloatArray:
    """A residual traction (p, 2) N as an array. Raises InputError for another shape and for entries not finite."""
    residual = finite_array("residual_traction", traction)
    if residual.shape != (n_pairs, 2):
        raise InputError(
            f"residual_traction must have shape ({n_pairs}, 2), N along t1 and t2 of each pair, but its shape is "
            f"{residual.shape}.",
            arguments=["residual_traction"],
        )
    return residual
