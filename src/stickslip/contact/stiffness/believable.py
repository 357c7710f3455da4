"""Whether a law of contact stiffness is believable: comparison with the law that boundary elements confirm.

Persson's law with one patch and plastic waves is within a factor 2 of boundary elements in nearly all cases
(docs/theory_stiffness_laws.md). Two methods of measurement differ by 3 on one contact (Mulvihill et al., Exp. Mech. 53
(2013) 1245), so the band about it is 1/3 to 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.stiffness.persson import PerssonStiffness
from stickslip.contact.stiffness.stiffness_law import StiffnessLaw

BAND = 3.0  # two methods of measurement differ by this factor (Mulvihill et al., Exp. Mech. 53 (2013) 1245)


@dataclass(frozen=True)
class Believable:
    """The stiffness per area of one pressure by a law and by Persson's, N/m3."""

    pressure: float  # Pa
    chosen: float
    persson: float

    @property
    def ratio(self) -> float:
        """The law over Persson's law."""
        return self.chosen / self.persson

    @property
    def band(self) -> tuple[float, float]:
        """The believable band in N/m3."""
        return self.persson / BAND, self.persson * BAND

    @property
    def is_inside(self) -> bool:
        """Whether the law is in the band."""
        return self.band[0] <= self.chosen <= self.band[1]

    def message(self, name: str) -> str:
        """A message on a stiffness outside of the band; ``name`` of the law."""
        if self.chosen == 0.0:
            comparison = "gives no stiffness instead of"
        elif self.ratio >= 1.0:
            comparison = f"gives {1e-9 * self.chosen:.3g} N/mm3, {self.ratio:.3g} times"
        else:
            comparison = f"gives {1e-9 * self.chosen:.3g} N/mm3, 1/{1.0 / self.ratio:.3g} of"
        low, high = self.band
        return (
            f"Believable band: under {1e-6 * self.pressure:.3g} MPa {name} {comparison} "
            f"the {1e-9 * self.persson:.3g} N/mm3 of Persson's law, which boundary elements confirm; "
            f"believable are {1e-9 * low:.3g} to {1e-9 * high:.3g} N/mm3. "
            'Choose law = "persson", or give a measured stiffness.'
        )


def compared(law: StiffnessLaw, persson: PerssonStiffness, pressure: float) -> Believable:
    """A law against Persson's at one pressure in Pa."""
    at = np.array([pressure])
    return Believable(pressure, float(law.normal(at)[0]), float(persson.normal(at)[0]))
