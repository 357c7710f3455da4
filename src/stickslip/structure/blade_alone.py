"""The blade of a sector alone, its root fixed: what mistuning changes (:func:`stickslip.blade_alone` computes it).

With the root fixed the unknowns b of a blade have the modes ``K_bb phi_j = lambda_j M_bb phi_j``. A motion u of the
sector, beyond the static one that its root imposes, has the coordinates ``q_j = phi_j^T K_b u / lambda_j``, where the
rows K_b of the stiffness of the sector belong to these unknowns. If the modulus of one blade is ``(1 + delta)^2`` times
that of the others, so are all lambda_j, and the strain energy of the sector changes by

    1/2 sum_j lambda_j (2 delta + delta^2) |q_j|^2,

except for the part of the blade that the motion of its root deforms.

Source: S.-H. Lim, R. Bladh, M. P. Castanier, C. Pierre, Compact, generalized component mode mistuning representation
for modeling bladed disk vibration, AIAA J. 45 (2007) 2285-2298.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.structure.cyclic_sector import Matrix

# chosen: blades of one disk differ by percents at most, so a larger deviation is a percentage or a frequency.
LARGEST_DEVIATION = 0.3


@dataclass(frozen=True)
class BladeAlone:
    """Modes of the blade of a sector with its root fixed.

    Attributes
    ----------
    frequency_hz:
        (k,) Hz, natural frequencies of the blade alone.
    participation:
        nodal diameter -> (k, n): coordinates q of these modes (mass-normalised) for the unknowns of the reduced sector.
    """

    frequency_hz: FloatArray
    participation: Mapping[int, Matrix]

    def __repr__(self) -> str:
        listed = ", ".join(f"{each:.6g}" for each in self.frequency_hz)
        return f"BladeAlone({listed} Hz)"

    def in_wave(self, waves: int, sectors: int) -> Matrix:
        """(k, n) participation in the wave of any number of waves: in the other direction it is the conjugate one."""
        rest = waves % sectors
        part = self.participation[min(rest, sectors - rest)]
        return part if 2 * rest <= sectors else part.conj()

    def stiffness_changes(self, deviations: ArrayLike, sectors: int) -> FloatArray:
        """(N, k) (rad/s)^2, ``lambda_j (2 delta + delta^2)`` of each blade.

        ``deviations`` (N,) or (N, k): relative deviations of the blade-alone natural frequencies; 0.02 is 2 %. Raises
        InputError for another shape and for a deviation above 0.3.
        """
        delta = finite_array("deviations", deviations)
        count = self.frequency_hz.size
        if delta.shape not in ((sectors,), (sectors, count)):
            raise InputError(
                f"deviations has shape {delta.shape}, but it must be ({sectors},), a relative deviation of each blade, "
                f"or ({sectors}, {count}), one for each of its {count} modes.",
                arguments=["deviations"],
            )
        worst = float(np.abs(delta).max())
        if worst > LARGEST_DEVIATION:
            raise InputError(
                f"deviations contains {worst:g}, but a relative deviation of a natural frequency is at most "
                f"{LARGEST_DEVIATION}: 2 % is 0.02.",
                arguments=["deviations"],
            )
        by_mode = delta[:, None] if delta.ndim == 1 else delta
        return np.asarray((2.0 * np.pi * self.frequency_hz) ** 2 * by_mode * (2.0 + by_mode))
