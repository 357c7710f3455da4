"""Natural frequencies of a mesh with Coriolis forces."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import natural_frequencies
from stickslip.structure.gyroscopic import gyroscopic_modes

# chosen: modes without Coriolis forces in which those with them are computed: this multiple of the number, and more.
BASIS_FACTOR, BASIS_MORE = 2, 12


def whirling_frequencies(stiffness: Any, mass: Any, gyroscopic: Any, count: int) -> FloatArray:
    """(count,) Hz, the lowest natural frequencies of ``M u'' + G u' + K u = 0`` with sparse matrices (n, n).

    They are computed in the ``2 count + 12`` lowest modes without G. G is skew-Hermitian. Raises InputError, see
    :func:`stickslip.structure.elasticity.natural_frequencies`.
    """
    # An iteration for complex matrices cannot give the last two modes.
    more = min(BASIS_FACTOR * count + BASIS_MORE, stiffness.shape[0] - 2)
    frequency_hz, modes = natural_frequencies(stiffness, mass, max(more, count))
    coupling = modes.conj().T @ (gyroscopic @ modes)
    return gyroscopic_modes(2.0 * np.pi * frequency_hz, coupling)[0][:count] / (2.0 * np.pi)
