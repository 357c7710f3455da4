"""The modes of a structure without contact, which the cases of one structure share."""

from __future__ import annotations

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.damping import modal_basis

# chosen: a larger structure takes more memory than the modes of the next case take time.
LARGEST_SHARED = 2000


class _LastModes:
    """The modes of the last structure without contact, for the next case of a sweep, a band or a ridge.

    Cases of another process come with copies of their matrices, and a caller may change arrays, so these are copied,
    and compared by their entries: 2 ms for 700 unknowns, whose modes take 100 ms.
    """

    def __init__(self) -> None:
        self._known: tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray]] | None = None

    def of(self, mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
        """As :func:`modal_basis`; the arrays are not to be changed."""
        known = self._known
        if known is not None and np.array_equal(known[0], mass) and np.array_equal(known[1], stiffness):
            return known[2]
        basis = modal_basis(mass, stiffness)
        self._known = (mass.copy(), stiffness.copy(), basis) if len(mass) <= LARGEST_SHARED else None
        return basis


_LAST = _LastModes()


def free_modes(mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Frequencies (n,) in rad/s and mass-normalised modes (n, n) of matrices (n, n), without another computation for
    those of the last call."""
    return _LAST.of(mass, stiffness)
