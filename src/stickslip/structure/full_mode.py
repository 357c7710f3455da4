"""The mode of a full model that a mode of its reduction stands for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.joined import NodePairs, stiffness_with_springs

# chosen: modes of the full model about the frequency of the reduced one.
NEAREST = 12
# chosen: modes within this part of a frequency count as one. A reduction may mix the shapes of such neighbours.
ONE_FREQUENCY = 0.01
# chosen: the shift of the Lanczos iteration over the square of the frequency. At the square itself, a mode without any
# error of the reduction would make the matrix singular.
_SHIFT = 0.999


@dataclass(frozen=True)
class FullMode:
    """The mode of the full model with the largest part of a motion.

    frequency_hz:
        Hz.
    mac:
        0 to 1, the modal assurance criterion with mass: the part of the kinetic energy of the motion in this mode and
        in those within ``ONE_FREQUENCY`` of its frequency.
    """

    frequency_hz: float
    mac: float


def closest_full_mode(
    structure: Structure, pairs: NodePairs, springs: FloatArray, motion: FloatArray, frequency_hz: float
) -> FullMode:
    """The mode, among the ``NEAREST`` to a frequency, that a ``motion`` (3 * n_nodes,) m of the mesh resembles most.

    The pairs are on ``springs`` (3 * n_pairs,) N/m, t1, t2, n of each. The work is one factor of the matrices, as for
    the lowest modes. Raises ConvergenceError, SingularMatrixError.
    """
    stiffness = stiffness_with_springs(structure, pairs.mesh_operator(structure.mesh.n_nodes), springs)
    count = min(NEAREST, stiffness.shape[0] - 1)
    shift = _SHIFT * (2.0 * math.pi * frequency_hz) ** 2
    near_hz, modes = natural_frequencies(stiffness, structure.mass, count, shift)
    free = motion[structure.free_unknowns]
    weighted = structure.mass @ free
    parts = (weighted @ modes) ** 2 / float(free @ weighted)
    closest = int(parts.argmax())
    together = np.abs(near_hz - near_hz[closest]) <= ONE_FREQUENCY * near_hz[closest]
    return FullMode(float(near_hz[closest]), float(parts[together].sum()))
