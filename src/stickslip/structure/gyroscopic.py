"""Natural frequencies of structures with Coriolis forces, from the modes without them."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

ComplexArray = NDArray[np.complex128]


def gyroscopic_modes(circular_frequency: FloatArray, coupling: NDArray[Any]) -> tuple[FloatArray, ComplexArray]:
    """Frequencies and modes of ``q'' + G q' + diag(w^2) q = 0``.

    With ``y = (q', w q)`` the equation is ``y' = S y`` with the skew-symmetric ``S = [-G, -w; w, 0]``, whose
    eigenvalues ``i v`` are those of a Hermitian matrix, also if some w are zero. Source: L. Meirovitch, A new method of
    solution of the eigenvalue problem for gyroscopic systems, AIAA J. 12 (1974) 1337-1342.

    Parameters
    ----------
    circular_frequency:
        (n,) rad/s, w of the modes without Coriolis forces.
    coupling:
        (n, n) 1/s, G in these mass-normalised modes: skew-symmetric, or skew-Hermitian for a sector of a disk, whose
        waves in the other direction have the conjugate one.

    Returns
    -------
    frequency, shapes:
        (n,) rad/s, ascending, and (n, n) complex amplitudes q of ``q e^(i v t)``, a column for each, with ``v^2 |q|^2 +
        |w q|^2 = 2 v^2``: mass-normalised where G is zero.
    """
    n = circular_frequency.size
    elastic = np.diag(circular_frequency)
    skew = np.block([[-coupling, -elastic], [elastic, np.zeros((n, n))]])
    values, vectors = scipy.linalg.eigh(-1j * skew)
    return np.maximum(values[n:], 0.0), np.asarray(np.sqrt(2.0) * vectors[:n, n:])
